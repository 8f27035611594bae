//! The chapter's theorems, tried with their conditions and without them.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix3, Matrix4, Vector3, Vector6};
use vislam::manifold::{se3, so3};

use super::oracle::{series, twist_matrix};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

/// Registers the counterexamples.
pub fn counterexamples(chapter: &mut Chapter) {
    let skew = so3::hat(&(FRAC_PI_2 * Vector3::z()));
    chapter.counterexample("exp-rotates", "skew", is_a_rotation, [skew, skew.abs()]);

    let turn = *so3::exp(&Vector3::new(0.5, -1.0, 1.5)).matrix();
    let mirror = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0));
    chapter.counterexample("euler", "rotation", leaves_an_axis, [turn, -turn]);
    chapter.counterexample("euler", "short", has_one_vector, [3.0, 4.0]);
    chapter.counterexample("euler", "below-half-turn", has_one_vector, [3.0, PI]);
    chapter.counterexample("so3-adjoint", "rotation", changes_its_frame, [turn, mirror]);
    chapter.counterexample("right-jacobian", "small", moves_by_the_jacobian, [1e-6, 1.0]);
    chapter.counterexample("se3-adjoint", "pose", twist_changes_its_frame, [1.0, 2.0]);
}

/// Whether the exponential of a matrix is orthogonal and has the determinant one.
fn is_a_rotation(matrix: Matrix3<f64>) -> Comparison {
    let mut comparison = Comparison::absolute("an orthogonal matrix", 1e-12, "");
    let exponential = series(&matrix);
    let product = exponential.transpose() * exponential;
    comparison.add(product.as_slice(), Matrix3::<f64>::identity().as_slice());
    comparison.add(&[exponential.determinant()], &[1.0]);
    comparison
}

/// Whether an orthogonal matrix moves some unit vector by nothing.
fn leaves_an_axis(matrix: Matrix3<f64>) -> Comparison {
    let against = "zero, the least that a unit vector is moved by";
    let mut comparison = Comparison::absolute(against, 1e-12, "");
    comparison.add(&[(matrix - Matrix3::identity()).singular_values().min()], &[0.0]);
    comparison
}

/// Whether the logarithm finds every vector along z, of this length and either sign, whose rotation
/// is the one of the vector forwards.
fn has_one_vector(angle: f64) -> Comparison {
    let mut comparison = Comparison::absolute("the logarithm", 1e-9, "rad");
    let rotation = so3::exp(&(angle * Vector3::z()));
    for candidate in [angle * Vector3::z(), -angle * Vector3::z()] {
        if (so3::exp(&candidate).matrix() - rotation.matrix()).norm() < 1e-9 {
            comparison.add(candidate.as_slice(), so3::log(&rotation).as_slice());
        }
    }
    comparison
}

/// Whether a turn by ten degrees changes its side as the theorem says, past an orthogonal matrix.
fn changes_its_frame(matrix: Matrix3<f64>) -> Comparison {
    let mut comparison = Comparison::absolute("the same step on the other side", 1e-12, "");
    let phi = 10_f64.to_radians() * Vector3::x();
    let (right, left) =
        (matrix * series(&so3::hat(&phi)), series(&so3::hat(&(matrix * phi))) * matrix);
    comparison.add(left.as_slice(), right.as_slice());
    comparison
}

/// Whether a change of a quarter turn's vector, of this length, moves the body as the right Jacobian
/// says.
fn moves_by_the_jacobian(length: f64) -> Comparison {
    let mut comparison = Comparison::absolute("the step between the rotations", 1e-9, "rad");
    let (phi, delta) = (FRAC_PI_2 * Vector3::z(), length * Vector3::x());
    let step = so3::local(&so3::exp(&phi), &so3::exp(&(phi + delta)));
    comparison.add((so3::right_jacobian(&phi) * delta).as_slice(), step.as_slice());
    comparison
}

/// Whether a twist changes its side as the theorem says, past a pose that also scales by a factor.
fn twist_changes_its_frame(scale: f64) -> Comparison {
    let mut comparison = Comparison::absolute("the same step on the other side", 1e-12, "");
    let pose = se3::exp(&Vector6::new(1.0, -2.0, 0.5, 0.3, 0.8, -0.4));
    let xi = Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.2);
    let scaling = Matrix4::from_diagonal(&nalgebra::Vector4::new(scale, scale, scale, 1.0));
    let map = pose.to_homogeneous() * scaling;
    let right = map * series(&twist_matrix(&xi));
    let left = series(&twist_matrix(&(se3::adjoint(&pose) * xi))) * map;
    comparison.add(left.as_slice(), right.as_slice());
    comparison
}
