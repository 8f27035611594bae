//! What the theorems of the chapter assume, with cases on which they fail without it.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Rotation3, SVector, UnitQuaternion, Vector3, Vector6};
use vislam::two_views::{StereoPinhole, essential_matrix, scale_direction};

use super::worked::{BASELINE, CAMERA, POINT};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};

const STAYING: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);
const ASIDE: Vector3<f64> = Vector3::new(0.3, -0.1, 0.2);
const TURN: Vector3<f64> = Vector3::new(0.1, -0.2, 0.05);

pub fn counterexamples(chapter: &mut Chapter) {
    chapter.counterexample("essential-five", "moved", five_degrees, [ASIDE, STAYING]);

    let one = motion(ASIDE, TURN);
    let turned = Rotation3::new(PI * ASIDE.normalize()) * Rotation3::new(TURN);
    let other = Isometry3::from_parts((-ASIDE).into(), turned.into());
    let resting = [motion(STAYING, TURN), motion(STAYING, -TURN)];
    chapter.counterexample("essential-poses", "moved", one_of_four, [[one, other], resting]);
    let longer = [one, motion(2.0 * ASIDE, TURN)];
    chapter.counterexample("essential-poses", "equal", one_of_four, [[one, other], longer]);

    let free = Growth { rows: 2, held: false };
    let stereo = Growth { rows: 3, held: false };
    let held = Growth { rows: 2, held: true };
    chapter.counterexample("scale-null", "single-lenses", no_pixel_moves, [free, stereo]);
    chapter.counterexample("scale-null", "all-free", no_pixel_moves, [free, held]);

    chapter.counterexample("turn-any", "turned", any_baseline_fits, [STAYING, ASIDE]);
    chapter.counterexample("turn-any", "all-baselines", no_parallax, [STAYING, ASIDE]);
}

fn motion(translation: Vector3<f64>, turn: Vector3<f64>) -> Isometry3<f64> {
    Isometry3::new(translation, turn)
}

fn five_degrees(translation: Vector3<f64>) -> Comparison {
    let against = "the rank of the derivative by turn and translation, less one for scale";
    let slopes = differences::<9, 6>(1e-4, |change| {
        let turn = Rotation3::new(change.fixed_rows::<3>(3).into_owned()) * Rotation3::new(TURN);
        let translation = translation + change.fixed_rows::<3>(0);
        let moved = Isometry3::from_parts(translation.into(), turn.into());
        SVector::from_column_slice(essential_matrix(&moved).as_slice())
    });
    let rank = slopes.rank(1e-6) as f64;
    Comparison::absolute(against, 0.1, "degrees of freedom").once(5.0, rank - 1.0)
}

/// Takes two motions with essential matrices that are equal, up to sign or up to another factor.
fn one_of_four([one, other]: [Isometry3<f64>; 2]) -> Comparison {
    let axis = one.translation.vector.try_normalize(0.0).unwrap_or_default();
    let rotations = [0.0, PI].map(|angle| UnitQuaternion::new(angle * axis) * one.rotation);
    let distances = rotations.iter().flat_map(|rotation| {
        [1.0, -1.0].map(|sign| {
            let four = Isometry3::from_parts((sign * one.translation.vector).into(), *rotation);
            (four.to_homogeneous() - other.to_homogeneous()).norm()
        })
    });
    let nearest = distances.fold(f64::INFINITY, f64::min);
    Comparison::absolute("the nearest of the four motions", 1e-12, "entries").once(nearest, 0.0)
}

/// Which rows of a stereo observation are looked at, and whether its camera stays where it is while
/// the world grows.
#[derive(Clone, Copy)]
struct Growth {
    rows: usize,
    held: bool,
}

fn no_pixel_moves(case: Growth) -> Comparison {
    let pose = motion(ASIDE, TURN);
    let stereo = StereoPinhole { camera: CAMERA, baseline: BASELINE };
    let twist = if case.held { Vector6::zeros() } else { scale_direction(&pose) };
    let seen = stereo.project_with_jacobians(&pose, &POINT).expect("the point is in front");
    let moves = (seen.by_pose * twist + seen.by_point * POINT).rows(0, case.rows).into_owned();
    Comparison::absolute("zero", 1e-10, "px").once(moves, vec![0.0; case.rows])
}

/// The direction of the worked point before and after a turn with a translation.
fn directions(translation: Vector3<f64>) -> [Vector3<f64>; 2] {
    let pose = motion(translation, TURN);
    [pose.rotation * POINT, pose.rotation * POINT + translation].map(|point| point.normalize())
}

fn any_baseline_fits(translation: Vector3<f64>) -> Comparison {
    let [before, after] = directions(translation);
    let volume = |baseline: Vector3<f64>| after.dot(&baseline.cross(&before));
    Comparison::absolute("zero, for three baselines", 1e-12, "m³")
        .each(0..3, |axis| (volume(Vector3::ith(axis, 1.0)), 0.0))
}

/// The equation holds for the true translation in either case, and for all others after a turn.
fn no_parallax(translation: Vector3<f64>) -> Comparison {
    let parallax = |[before, after]: [Vector3<f64>; 2]| before.cross(&after).norm();
    Comparison::absolute("zero", 1e-12, "sine of the parallax")
        .once(parallax(directions(translation)), 0.0)
}
