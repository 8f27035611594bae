//! What a factor of factrs says, asked of the factor itself: its sums and its covariance are private, and both stand in
//! what it gives the solver.

use factrs::containers::Factor;
use factrs::core::Values;
use factrs::linalg::{Matrix, MatrixX, VectorX};
use factrs::residuals::ImuPreintegrator;
use factrs::traits::Variable;
use factrs::variables::{ImuBias, MatrixLieGroup, SE3, VectorVar3};
use nalgebra::{Rotation3, Vector3};
use vislam::inertial::NavState;
use vislam::preintegration::Matrix15;

use crate::convert;
use crate::graph::{B, V, X};

/// Where a body that was at rest at the origin without bias is at the end of the readings, and the covariance of the
/// residual there, in the order of the residual.
#[derive(Debug, Clone)]
pub struct Said {
    pub state: NavState,
    pub covariance: Matrix15,
}

impl Said {
    /// What the sums would say as a factor between the keyframes.
    pub fn by(sums: ImuPreintegrator) -> Self {
        Self::after(&SE3::identity(), sums)
    }

    /// The same of a body whose first pose is another one.
    pub fn after(first: &SE3, sums: ImuPreintegrator) -> Self {
        Self::of(first, &sums.build(X(0), V(0), B(0), X(1), V(1), B(1)))
    }

    // ANCHOR: said
    /// Steps to where the residual is zero. There the residual falls by one as the second state grows by one, so that
    /// the Jacobian that the solver gets is minus the matrix that whitens.
    fn of(first: &SE3, factor: &Factor) -> Self {
        let mut second = (SE3::identity(), VectorVar3::identity(), ImuBias::identity());
        let mut jacobian = MatrixX::zeros(15, 15);
        for _ in 0..STEPS {
            let linear = factor.linearize(&values(first, &second));
            for (block, column) in [(3, 0), (4, 6), (5, 9)] {
                let block = linear.a.get_block(block);
                jacobian.columns_mut(column, block.ncols()).copy_from(&block);
            }
            let inverse =
                jacobian.clone().try_inverse().expect("each residual depends on the second state");
            let step: VectorX = inverse * &linear.b;
            second.0 = second.0.oplus(step.rows(0, 6));
            second.1 = second.1.oplus(step.rows(6, 3));
            second.2 = second.2.oplus(step.rows(9, 6));
        }
        Self {
            state: convert::our_state(&second.0, &second.1),
            covariance: covariance(&second.0, &jacobian),
        }
    }
    // ANCHOR_END: said
}

const STEPS: usize = 8;

fn values(first: &SE3, (pose, velocity, bias): &(SE3, VectorVar3, ImuBias)) -> Values {
    let mut values = Values::new();
    values.insert(X(0), first.clone());
    values.insert(V(0), VectorVar3::identity());
    values.insert(B(0), ImuBias::identity());
    values.insert(X(1), pose.clone());
    values.insert(V(1), velocity.clone());
    values.insert(B(1), bias.clone());
    values
}

/// From the Jacobian by (turn, place in the body frame, velocity, biases) at a residual of zero, in the order
/// (turn, velocity, place, biases) of the residual.
fn covariance(second: &SE3, jacobian: &MatrixX) -> Matrix15 {
    let mut whitening = Matrix::<15, 15>::from_iterator(jacobian.iter().copied());
    let place = jacobian.fixed_columns::<3>(3) * second.rot().to_matrix().transpose();
    whitening.fixed_columns_mut::<3>(3).copy_from(&jacobian.fixed_columns::<3>(6));
    whitening.fixed_columns_mut::<3>(6).copy_from(&place);
    let information = whitening.transpose() * whitening;
    let covariance = information.try_inverse().expect("the covariance was inverted to get here");
    convert::our_matrix(&covariance)
}

impl Said {
    /// The rotation vector of the turn.
    pub fn turn(&self) -> Vector3<f64> {
        self.state.world_from_body.scaled_axis()
    }

    /// The angle between this turn and another, in radians.
    pub fn angle_to(&self, other: &Rotation3<f64>) -> f64 {
        self.state.world_from_body.angle_to(other)
    }
}
