//! Ways to the chapter's results that do not use its formulas, and random problems to try them on.

use nalgebra::{Matrix2, Matrix3, Rotation3, SMatrix, SVector, Vector2, Vector3, Vector6};

use crate::comparison::inverse;
use crate::random::Random;

/// Six whitened residuals, linear in three unknowns.
#[derive(Clone)]
pub struct Fit {
    pub j: SMatrix<f64, 6, 3>,
    pub r: SVector<f64, 6>,
}

impl Fit {
    /// Unknowns in units that differ by a factor of up to ten.
    pub fn random(random: &mut Random) -> Self {
        let units = [(); 3].map(|()| random.logarithmic(0.3..3.0));
        let common = SVector::<f64, 6>::from_fn(|_, _| random.normal(1.0));
        let j = SMatrix::from_fn(|row, column| units[column] * (random.normal(1.0) + common[row]));
        Self { j, r: SVector::from_fn(|_, _| random.normal(2.0)) }
    }

    pub fn hessian(&self) -> Matrix3<f64> {
        self.j.transpose() * self.j
    }

    pub fn diagonal(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.hessian().diagonal())
    }

    pub fn gradient(&self) -> Vector3<f64> {
        self.j.transpose() * self.r
    }

    /// The step with a matrix added to H.
    pub fn damped_by(&self, matrix: Matrix3<f64>) -> Vector3<f64> {
        -inverse(self.hessian() + matrix) * self.gradient()
    }

    /// The step by the normal equations, with a damping.
    pub fn step(&self, damping: f64) -> Vector3<f64> {
        let factor = (self.hessian() + damping * self.diagonal()).cholesky();
        factor.map_or(Vector3::repeat(f64::NAN), |factor| -factor.solve(&self.gradient()))
    }

    /// Half of δᵀ (λ D δ − g), with the two signs as given.
    pub fn predicted_decrease(&self, damping: f64, of_gradient: f64, of_damping: f64) -> f64 {
        let step = self.step(damping);
        let damped = of_damping * damping * self.diagonal() * step;
        0.5 * step.dot(&(damped + of_gradient * self.gradient()))
    }

    pub fn by_singular_values(&self) -> Vector3<f64> {
        self.j.svd(true, true).solve(&-self.r, 1e-14).expect("both factors are there")
    }

    /// The residual less its parts along the columns of J.
    pub fn orthogonal_part(&self) -> SVector<f64, 6> {
        let mut axes: Vec<SVector<f64, 6>> = Vec::new();
        for column in self.j.column_iter() {
            let mut axis = column.into_owned();
            // Twice, because once leaves rounding errors along the earlier ones.
            for _ in 0..2 {
                axis = axes.iter().fold(axis, |rest, other| rest - other.dot(&rest) * other);
            }
            axes.push(axis.normalize());
        }
        axes.iter().fold(self.r, |rest, axis| rest - axis.dot(&rest) * axis)
    }

    /// The damped step as an undamped one: for every unknown, one more measurement that says it
    /// should not move.
    pub fn with_measurements_of_zero(&self, damping: f64) -> Vector3<f64> {
        let mut j = self.j.fixed_resize::<9, 3>(0.0);
        for unknown in 0..3 {
            j[(6 + unknown, unknown)] = damping.sqrt() * self.j.column(unknown).norm();
        }
        let r = self.r.fixed_resize::<9, 1>(0.0);
        j.svd(true, true).solve(&-r, 1e-14).expect("both factors are there")
    }

    /// The scatter of the estimates from unit noise in the residuals.
    pub fn scatter(&self, random: &mut Random, draws: usize) -> Matrix3<f64> {
        let inverse = self.j.pseudo_inverse(1e-14).expect("the tolerance is positive");
        let mut scatter = Matrix3::zeros();
        for _ in 0..draws {
            let error = inverse * SVector::<f64, 6>::from_fn(|_, _| random.normal(1.0));
            scatter += error * error.transpose() / draws as f64;
        }
        scatter
    }
}

/// A rotation to be found from directions d known in the body and z measured in the world.
pub struct Rotated {
    pub rotation: Rotation3<f64>,
    directions: [[Vector3<f64>; 2]; 4],
    whitener: Matrix3<f64>,
}

impl Rotated {
    pub fn random(random: &mut Random) -> Self {
        let (rotation, truth) = (random.rotation(3.0), random.rotation(3.0));
        let directions = [(); 4].map(|()| {
            let direction = random.direction(1.0);
            [direction, truth * direction + random.direction(0.05)]
        });
        Self { rotation, directions, whitener: Matrix3::from_fn(|_, _| random.normal(3.0)) }
    }

    pub fn cost(&self, rotation: &Rotation3<f64>) -> f64 {
        let residuals = self.directions.iter().map(|[body, world]| rotation * body - world);
        0.5 * residuals.map(|residual| (self.whitener * residual).norm_squared()).sum::<f64>()
    }

    /// The sum of Jᵀ r, both whitened, for a Jacobian of one direction.
    pub fn gradient(
        &self,
        jacobian: fn(&Rotation3<f64>, &Vector3<f64>) -> Matrix3<f64>,
    ) -> Vector3<f64> {
        let parts = self.directions.iter().map(|[body, world]| {
            let residual = self.whitener * (self.rotation * body - world);
            (self.whitener * jacobian(&self.rotation, body)).transpose() * residual
        });
        parts.sum()
    }
}

pub fn random_covariance<const N: usize>(random: &mut Random) -> SMatrix<f64, N, N> {
    let root = SMatrix::<f64, N, N>::from_fn(|_, _| random.normal(1.0));
    root * root.transpose() + 0.2 * SMatrix::identity()
}

pub fn twist(random: &mut Random, size: f64) -> Vector6<f64> {
    Vector6::from_fn(|_, _| random.uniform(-size..size))
}

pub fn second_differences(
    function: impl Fn(Vector2<f64>) -> f64,
    at: Vector2<f64>,
    step: f64,
) -> Matrix2<f64> {
    Matrix2::from_fn(|row, column| {
        let [first, second] = [row, column].map(|axis| Vector2::ith(axis, step));
        let (together, apart) = (first + second, first - second);
        let around = function(at + together) - function(at + apart) - function(at - apart)
            + function(at - together);
        around / (4.0 * step * step)
    })
}

/// Density, up to a factor, of a normal number whose precision is itself uncertain: gamma
/// distributed with c² − 1 degrees of freedom and the mean that makes its scale c.
pub fn mixture(scale: f64, value: f64) -> f64 {
    let freedom = scale * scale - 1.0;
    let density = |precision: f64| {
        let gamma = precision.powf(0.5 * freedom - 1.0) * (-0.5 * scale * scale * precision).exp();
        precision.sqrt() * (-0.5 * value * value * precision).exp() * gamma
    };
    // The substitution precision = exp(t) gives both ends to the trapezium rule.
    let (lowest, highest, steps) = (-25.0_f64, 8.0_f64, 20_000);
    let width = (highest - lowest) / f64::from(steps);
    let at = |step: i32| (lowest + width * f64::from(step)).exp();
    (0..=steps).map(|step| width * at(step) * density(at(step))).sum()
}
