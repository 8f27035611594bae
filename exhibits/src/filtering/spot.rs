//! A spot on the floor, and a measured distance to a post.

use nalgebra::{DMatrix, Matrix2, RowVector2, Vector1, Vector2};
use vislam::filtering::{Belief, Update, UpdateOptions};
use vislam::least_squares::{Factor, Kernel, Key, Problem};

/// Where the spot is believed to be, in metres; the post stands at the origin.
pub const ESTIMATE: Vector2<f64> = Vector2::new(0.6, 0.5);
/// Standard deviations of both coordinates, in metres.
pub const SIGMAS: [f64; 2] = [0.4, 1.0];
/// The distance as measured, and its standard deviation, in metres.
pub const DISTANCE: f64 = 1.6;
pub const SIGMA: f64 = 0.06;

/// The distance of a spot from the origin, as it was measured.
#[derive(Clone, Copy)]
struct Distance(Key<Vector2<f64>>);

impl Factor<1> for Distance {
    type Variables = (Vector2<f64>,);
    type Jacobians = (RowVector2<f64>,);

    fn variables(&self) -> (Key<Vector2<f64>>,) {
        (self.0,)
    }

    fn residual(&self, (spot,): (&Vector2<f64>,)) -> Option<Vector1<f64>> {
        Some(Vector1::new((spot.norm() - DISTANCE) / SIGMA))
    }

    fn linearize(&self, (spot,): (&Vector2<f64>,)) -> Option<(Vector1<f64>, (RowVector2<f64>,))> {
        Some((self.residual((spot,))?, (spot.transpose() / (spot.norm() * SIGMA),)))
    }
}

/// What is believed of the spot, and how that came.
pub struct Believed {
    pub estimate: Vector2<f64>,
    pub covariance: Matrix2<f64>,
    pub update: Update,
}

/// After so many iterations.
pub fn after(iterations: usize) -> Believed {
    let (mut belief, mut problem) = (Belief::new(), Problem::new());
    let own = belief.add(ESTIMATE, &prior()).expect("it fits");
    let variable = problem.add_variable(ESTIMATE);
    problem.add_factor(Distance(variable), Kernel::Squared).expect("it fits");
    let options = UpdateOptions { iterations, ..UpdateOptions::default() };
    let update = belief.update(&problem, &options).expect("the spot is not at the post");
    let covariance = belief.of(own).expect("it is there");
    let covariance = Matrix2::from_fn(|row, column| covariance[(row, column)]);
    Believed { estimate: belief.values()[own], covariance, update }
}

fn prior() -> DMatrix<f64> {
    DMatrix::from_diagonal(&SIGMAS.map(|sigma| sigma * sigma).to_vec().into())
}

pub fn prior_covariance() -> Matrix2<f64> {
    Matrix2::from_diagonal(&SIGMAS.map(|sigma| sigma * sigma).into())
}

/// The cost of a spot, prior and distance together.
pub fn cost(spot: &Vector2<f64>) -> f64 {
    let sigmas: Vector2<f64> = SIGMAS.into();
    let away = (spot - ESTIMATE).component_div(&sigmas);
    0.5 * (away.norm_squared() + ((spot.norm() - DISTANCE) / SIGMA).powi(2))
}
