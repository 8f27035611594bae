//! The chapter's theorems, tried with their conditions and without them.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix3, Matrix4, Vector3, Vector4, Vector6};
use vislam::manifold::{se3, so3};

use super::oracle::{exponential_of, series};
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
    let exponential = series(&matrix);
    let product = exponential.transpose() * exponential;
    let against = Comparison::absolute("an orthogonal matrix", 1e-12, "");
    against.once(product, Matrix3::<f64>::identity()).once(exponential.determinant(), 1.0)
}

/// Whether an orthogonal matrix moves some unit vector by nothing.
fn leaves_an_axis(matrix: Matrix3<f64>) -> Comparison {
    let against = "zero, the least that a unit vector is moved by";
    let least = (matrix - Matrix3::identity()).singular_values().min();
    Comparison::absolute(against, 1e-12, "").once(least, 0.0)
}

/// Whether the logarithm finds every vector along z, of this length and either sign, whose rotation
/// is the one of the vector forwards.
fn has_one_vector(angle: f64) -> Comparison {
    let forwards = angle * Vector3::z();
    let rotation = so3::exp(&forwards);
    let same = |v: &Vector3<f64>| (so3::exp(v).matrix() - rotation.matrix()).norm() < 1e-9;
    let candidates = [forwards, -forwards].into_iter().filter(same);
    let against = Comparison::absolute("the logarithm", 1e-9, "rad");
    against.each(candidates, |candidate| (candidate, so3::log(&rotation)))
}

/// Whether a turn by ten degrees changes its side as the theorem says, past an orthogonal matrix.
fn changes_its_frame(matrix: Matrix3<f64>) -> Comparison {
    let phi = 10_f64.to_radians() * Vector3::x();
    let left = series(&so3::hat(&(matrix * phi))) * matrix;
    let against = Comparison::absolute("the same step on the other side", 1e-12, "");
    against.once(left, matrix * series(&so3::hat(&phi)))
}

/// Whether a change of a quarter turn's vector, of this length, moves the body as the right Jacobian
/// says.
fn moves_by_the_jacobian(length: f64) -> Comparison {
    let (phi, delta) = (FRAC_PI_2 * Vector3::z(), length * Vector3::x());
    let step = so3::local(&so3::exp(&phi), &so3::exp(&(phi + delta)));
    let against = Comparison::absolute("the step between the rotations", 1e-9, "rad");
    against.once(so3::right_jacobian(&phi) * delta, step)
}

/// Whether a twist changes its side as the theorem says, past a pose that also scales by a factor.
fn twist_changes_its_frame(scale: f64) -> Comparison {
    let pose = se3::exp(&Vector6::new(1.0, -2.0, 0.5, 0.3, 0.8, -0.4));
    let xi = Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.2);
    let scaling = Matrix4::from_diagonal(&Vector4::new(scale, scale, scale, 1.0));
    let map = pose.to_homogeneous() * scaling;
    let left = exponential_of(&(se3::adjoint(&pose) * xi)) * map;
    let against = Comparison::absolute("the same step on the other side", 1e-12, "");
    against.once(left, map * exponential_of(&xi))
}
