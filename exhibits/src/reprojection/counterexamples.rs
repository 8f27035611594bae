//! The chapter's theorems, tried with their conditions and without them.

use std::f64::consts::PI;

use nalgebra::{Isometry3, SMatrix, Vector2, Vector3};
use vislam::manifold::{se3, so3};
use vislam::reprojection::RadialTangential;

use super::after_a_mixed_step;
use super::mixing::{Convention, Experiment, FAR_START, RATE_ANGLES, largest_shift};
use super::oracle::differences;
use super::worked::{CAMERA, POINT, both_blocks, one_coefficient};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::manifold::oracle::twist_of;
use crate::random::Random;

/// Registers the counterexamples.
pub fn counterexamples(chapter: &mut Chapter) {
    chapter.counterexample("four-free", "known", four_directions, [true, false]);
    let around_the_fold: [Shown; 2] = [(one_coefficient, 0.5), (one_coefficient, 1.5)];
    chapter.counterexample("lens-inverse", "definite", shown_once, around_the_fold);
    let around_the_hole: [Shown; 2] = [(with_a_hole, 0.5), (with_a_hole, OUTER)];
    chapter.counterexample("lens-inverse", "convex", shown_once, around_the_hole);
    chapter.counterexample("left-right", "differentiable", left_gives_right, [2.0, PI]);
    let conventions = [Convention::Mixed, Convention::SkewOnly];
    chapter.counterexample("same-optimum", "left-block", ends_at_the_optimum, conventions);
    let kept = MixedStep { points: 20, noise: 0.0, off: 1e-6 };
    for (condition, dropped) in [
        ("noiseless", MixedStep { noise: 1.0, ..kept }),
        ("held", MixedStep { points: 2, ..kept }),
        ("small", MixedStep { off: 0.3, ..kept }),
    ] {
        chapter.counterexample("mixed-rate", condition, mixed_step, [kept, dropped]);
    }

    chapter.number("hole_inner", inner_radius(), "", 2);
    chapter.number("hole_outer", OUTER, "", 2);
}

/// Whether four directions leave the worked point's pixel alone, the point's own counted as well
/// when it is not known.
fn four_directions(is_known: bool) -> Comparison {
    let unknowns = if is_known { 6 } else { 9 };
    let block = both_blocks(&POINT).columns(0, unknowns).into_owned();
    Comparison::absolute("four", 1e-9, "").once((unknowns - block.rank(1e-9)) as f64, 4.0)
}

/// A lens, and the radius of a point that it shows.
type Shown = (fn() -> RadialTangential, f64);

/// Whether the point is the only one of its lens's disc and of itself that is shown where it is.
fn shown_once((lens, radius): Shown) -> Comparison {
    let (lens, point) = (lens(), Vector2::new(radius, 0.0));
    let found = lens.undistort(&lens.distort(&point)).ok();
    Comparison::absolute("the point that is shown there", 1e-9, "").once(found, point)
}

/// A radius beyond the hole of [`with_a_hole`].
const OUTER: f64 = 1.45;

/// A lens whose Jacobian is positive definite on a disc and on all that lies outside of a larger
/// one, a set with a hole.
fn with_a_hole() -> RadialTangential {
    RadialTangential::new(-0.6, 0.13, 0.0, 0.0, 0.0).expect("finite coefficients")
}

fn inner_radius() -> f64 {
    let lens = with_a_hole();
    lens.undistort(&lens.distort(&Vector2::new(OUTER, 0.0))).map_or(f64::NAN, |inner| inner.x)
}

/// Whether the derivatives of a pose's rotation vector by a twist on the left give those by one on
/// the right, at this angle.
fn left_gives_right(angle: f64) -> Comparison {
    let turn = so3::exp(&(angle * Vector3::new(0.6, 0.0, 0.8)));
    let pose = Isometry3::from_parts(Vector3::new(1.0, 2.0, -1.0).into(), turn.into());
    let vector = |pose: Isometry3<f64>| so3::log_quaternion(&pose.rotation);
    let left: SMatrix<f64, 3, 6> = differences(1e-3, |xi| vector(se3::exp(xi) * pose));
    let right: SMatrix<f64, 3, 6> = differences(1e-3, |xi| vector(pose * se3::exp(xi)));
    let against = Comparison::absolute("central differences on the right", 1e-6, "");
    against.once(left * se3::adjoint(&pose), right)
}

/// Whether an optimizer ends where the consistent one does, in metres.
fn ends_at_the_optimum(convention: Convention) -> Comparison {
    let experiment = Experiment::new(1.0, RATE_ANGLES[0], FAR_START);
    let end = experiment.run(convention, 60).values;
    let shift = largest_shift(&end, &experiment.optimum());
    Comparison::absolute("the consistent optimum", 1e-6, "m").once(shift, 0.0)
}

/// One mixed step of a camera that sees so many known points, with noise in pixels, from so far off
/// in metres and radians.
#[derive(Clone, Copy)]
struct MixedStep {
    points: usize,
    noise: f64,
    off: f64,
}

fn mixed_step(case: MixedStep) -> Comparison {
    let mut random = Random::new(15);
    let truth = Isometry3::from_parts(random.direction(2.0).into(), random.rotation(1.0).into());
    let error = twist_of(&random.direction(case.off), &random.direction(case.off));
    let mut see = || (random.point(2.0..10.0), random.direction(case.noise).xy());
    let seen: Vec<_> = (0..case.points).map(|_| see()).collect();
    let after = after_a_mixed_step(&CAMERA, &truth, &error, &seen);
    let predicted = error - se3::adjoint(&truth) * error;
    let against = Comparison::relative("a Gauss-Newton step with the left block", 1e-3);
    against.once(predicted / case.off, after / case.off)
}
