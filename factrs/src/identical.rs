//! The graph of the very factors that the book's library has.

use factrs::containers::FactorBuilder;
use factrs::core::{GaussianNoise, Graph, SO3};
use factrs::linalg::{Const, ForwardProp, Matrix, Numeric, Vector3, VectorX};
use factrs::residuals::Residual6;
use factrs::traits::Variable;
use factrs::variables::{ImuBias, MatrixLieGroup, SE3, VectorVar3};
use vislam::inertial::GRAVITY;
use vislam::preintegration::CombinedPreintegrated;

use crate::convert;
use crate::graph::{B, V, X, add_pixels, add_priors};
use crate::two_keyframes::{HUBER, Scene};

// ANCHOR: inertial
/// What two states and biases say of the interval between them, less what the book's sums say: turn, velocity, position
/// and the step of both biases.
#[derive(Clone, Debug)]
pub struct Inertial {
    pub duration: f64,
    pub rotation: SO3,
    pub velocity: Vector3,
    pub position: Vector3,
    pub bias: ImuBias,
    pub bias_jacobian: Matrix<9, 6>,
    pub gravity: Vector3,
}

#[factrs::mark]
impl Residual6 for Inertial {
    type V1 = SE3;
    type V2 = VectorVar3;
    type V3 = ImuBias;
    type V4 = SE3;
    type V5 = VectorVar3;
    type V6 = ImuBias;
    type DimIn = Const<30>;
    type DimOut = Const<15>;
    type Differ = ForwardProp<Const<30>>;

    fn residual6<T: Numeric>(
        &self,
        first: SE3<T>,
        first_velocity: VectorVar3<T>,
        bias: ImuBias<T>,
        second: SE3<T>,
        second_velocity: VectorVar3<T>,
        later: ImuBias<T>,
    ) -> VectorX<T> {
        // ANCHOR: compared
        let (t, g) = (T::from(self.duration), self.gravity.cast::<T>());
        let shift = self.bias_jacobian.cast::<T>() * bias.ominus(&self.bias.cast::<T>());
        let shift = VectorX::from_column_slice(shift.as_slice());
        let turned = SO3::exp(shift.rows(0, 3));
        let rotation = self.rotation.cast::<T>().compose(&turned);
        let velocity = self.velocity.cast::<T>() + shift.fixed_rows::<3>(3);
        let position = self.position.cast::<T>() + shift.fixed_rows::<3>(6);

        let body = first.rot().inverse();
        let faster = second_velocity.0 - first_velocity.0 - g * t;
        let farther = second.xyz() - first.xyz() - first_velocity.0 * t - g * t * t * T::from(0.5);
        let phi = body.compose(second.rot()).ominus_right(&rotation);
        let velocity = body.apply(faster.as_view()) - velocity;
        let position = body.apply(farther.as_view()) - position;
        let parts = [phi.as_slice(), velocity.as_slice(), position.as_slice()].concat();
        let walk = later.ominus(&bias);
        VectorX::from_iterator(15, parts.into_iter().chain(walk.iter().copied()))
        // ANCHOR_END: compared
    }
}
// ANCHOR_END: inertial

impl From<&CombinedPreintegrated> for Inertial {
    fn from(CombinedPreintegrated { sums, .. }: &CombinedPreintegrated) -> Self {
        Self {
            duration: sums.duration,
            rotation: convert::rotation(&sums.deltas.rotation.into()),
            velocity: convert::vector(&sums.deltas.velocity),
            position: convert::vector(&sums.deltas.position),
            bias: convert::bias(&sums.bias),
            bias_jacobian: convert::matrix(&sums.bias_jacobian),
            gravity: convert::vector(&GRAVITY),
        }
    }
}

/// The measurements alone: readings as the book sums them up, and pixels.
pub fn measured(scene: &Scene, threshold: f64) -> Graph {
    let mut graph = Graph::new();
    let sums = scene.preintegrated().expect("the readings can be summed up");
    let covariance = convert::matrix(&sums.covariance());
    let noise = GaussianNoise::<15>::from_matrix_cov(covariance.as_view());
    let noise = noise.expect("two hundred readings leave no direction without variance");
    let factor =
        FactorBuilder::new6(Inertial::from(&sums), X(0), V(0), B(0), X(1), V(1), B(1)).noise(noise);
    graph.add_factor(factor.build());
    add_pixels(&mut graph, scene, threshold);
    graph
}

/// Measurements and priors.
pub fn graph(scene: &Scene) -> Graph {
    let mut graph = measured(scene, HUBER);
    add_priors(&mut graph, scene);
    graph
}
