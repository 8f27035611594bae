//! What a gate sees of a pixel that belongs to something else.

use nalgebra::{DMatrix, DVector, Vector2};
use vislam::filtering::{chi_square_quantile, innovation_squared};

use super::draws::{Linear, Plan, SIGMA, Track};
use crate::chapter::Chapter;
use crate::random::Random;

/// By how much the last pixel of a track is wrong.
const WRONG: f64 = 20.0;

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("outlier_px", WRONG, "px", 0);
    for (names, sights) in [
        (["outlier_along_2", "outlier_across_2", "gate_2"], 2),
        (["outlier_along_3", "outlier_across_3", "gate_3"], 3),
        (["outlier_along_8", "outlier_across_8", "gate_8"], 8),
    ] {
        let [along, across] =
            [Direction::Along, Direction::Across].map(|to| innovation(sights, to));
        let gate = chi_square_quantile(0.99, 2 * sights - 3).expect("a probability");
        for (name, value) in names.into_iter().zip([along, across, gate]) {
            chapter.number(name, value, "", 1);
        }
    }
}

#[derive(Clone, Copy)]
enum Direction {
    Along,
    Across,
}

/// The normalized innovation squared of a track without noise but for its last pixel, which is wrong
/// along the epipolar line of the first one or across it. The poses are known to a centimetre and a
/// milliradian.
fn innovation(sights: usize, direction: Direction) -> f64 {
    let plan = Plan { off: 0.0, landmark_off: 0.0, ..Plan::new(sights) };
    let mut track = Track::drawn(&mut Random::new(9), plan);
    track.camera = vislam::reprojection::Pinhole { fx: 250.0, fy: 250.0, cx: 320.0, cy: 240.0 };
    let cameras: Vec<_> =
        track.true_poses.iter().map(|pose| pose.at_rest().pose() * track.rig).collect();
    let seen =
        |k: usize, point| track.camera.project(&cameras[k].inverse(), point).expect("it is ahead");
    let last = sights - 1;
    let pixels: Vec<Vector2<f64>> = (0..sights).map(|k| seen(k, &track.true_landmark)).collect();
    // Along the first ray the landmark moves along the last picture's epipolar line.
    let ray = track.true_landmark - cameras[0].translation.vector;
    let line = seen(last, &(track.true_landmark + 1e-3 * ray)) - pixels[last];
    let line = line.normalize();
    let way = match direction {
        Direction::Along => line,
        Direction::Across => Vector2::new(-line.y, line.x),
    };
    for (k, pixel) in pixels.into_iter().enumerate() {
        track.sights[k].pixel = pixel;
    }
    track.sights[last].pixel += WRONG * way;
    let camera = (&track.camera, SIGMA);
    track.landmark =
        vislam::msckf::landmark(&track.sights, &track.rig, camera, 1e-3).expect("the rays meet");
    let rows = Linear::projected(&track.linearized());
    let variances = DVector::from_fn(6 * sights, |at, _| if at % 6 < 3 { 1e-6 } else { 1e-4 });
    let p = DMatrix::from_diagonal(&variances);
    innovation_squared(&p, &rows.by_poses, &rows.residual).expect("a covariance")
}
