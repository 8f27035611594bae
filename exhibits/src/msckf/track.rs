//! The rows of a track, with its landmark and without.

use nalgebra::{DMatrix, DVector, Vector2, Vector3, Vector4};
use vislam::msckf::LinearizedTrack;

use super::TRACKS;
use super::draws::{Linear, Plan, SIGMA, Track, least};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences};

pub fn exhibits(chapter: &mut Chapter) {
    let formula: AtTruth = |linear, poses, landmark| {
        &linear.residual + &linear.by_poses * poses + &linear.by_landmark * landmark
    };
    let mutants: [(_, AtTruth); 4] = [
        ("sign of the landmark's part", |linear, poses, landmark| {
            &linear.residual + &linear.by_poses * poses - &linear.by_landmark * landmark
        }),
        ("landmark forgotten", |linear, poses, _| &linear.residual + &linear.by_poses * poses),
        ("sign of the poses' part", |linear, poses, landmark| {
            &linear.residual - &linear.by_poses * poses + &linear.by_landmark * landmark
        }),
        ("turn and shift of a pose exchanged", |linear, poses, landmark| {
            let exchanged =
                DVector::from_fn(poses.len(), |row, _| poses[(row / 6) * 6 + (row + 3) % 6]);
            &linear.residual + &linear.by_poses * exchanged + &linear.by_landmark * landmark
        }),
    ];
    chapter.equation("track-linear", track_linear, formula, &mutants);

    let formula: Projected = Linear::projected;
    let mutants: [(_, Projected); 4] = [
        ("three rows left out and nothing turned", |track| Linear::of(track, 3)),
        ("a row of the landmark kept", |track| {
            let mut track = track.clone();
            track.project(f64::INFINITY).expect("nothing is refused");
            Linear::of(&track, 2)
        }),
        ("a column of N too long", |track| {
            altered(Linear::projected(track), |linear| {
                linear.by_poses.row_mut(0).scale_mut(2.0);
                linear.residual[0] *= 2.0;
            })
        }),
        ("residual not turned", |track| {
            let residual = Linear::of(track, 3).residual;
            Linear { residual, ..Linear::projected(track) }
        }),
    ];
    chapter.equation("track-projected", track_projected, formula, &mutants);

    let formula: Sampson = |gradient, off| (gradient.dot(off) / (SIGMA * gradient.norm())).abs();
    let mutants: [(_, Sampson); 3] = [
        ("length of the gradient forgotten", |gradient, off| (gradient.dot(off) / SIGMA).abs()),
        ("length of one picture's part", |gradient, off| {
            (gradient.dot(off) / (SIGMA * gradient.fixed_rows::<2>(0).norm())).abs()
        }),
        ("all of the distance", |_, off| off.norm() / SIGMA),
    ];
    chapter.equation("track-two-sights", track_two_sights, formula, &mutants);
}

type AtTruth = fn(&Linear, &DVector<f64>, &Vector3<f64>) -> DVector<f64>;

fn track_linear(formula: AtTruth) -> Comparison {
    let against = "the residual at the true poses and landmark";
    Comparison::absolute(against, 2e-3, "standard deviations").over(TRACKS, 1, |random| {
        let plan = Plan { off: 1e-4, landmark_off: 1e-4, ..Plan::any(random) };
        let track = Track::drawn(random, plan);
        let linear = Linear::of(&track.linearized(), 0);
        let landmark = track.true_landmark - track.landmark;
        let oracle: Vec<Vector2<f64>> = (track.sights.iter().zip(&track.true_poses))
            .map(|(sight, truth)| {
                let camera_from_world = (truth.at_rest().pose() * track.rig).inverse();
                let seen = track.camera.project(&camera_from_world, &track.true_landmark);
                (seen.expect("it is ahead") - sight.pixel) / SIGMA
            })
            .collect();
        (formula(&linear, &track.pose_errors(), &landmark), oracle)
    })
}

type Projected = fn(&LinearizedTrack) -> Linear;

/// How long the projected rows are at some steps of the poses.
fn track_projected(formula: Projected) -> Comparison {
    let against = "what is left of all rows when the landmark is fitted to them";
    Comparison::relative(against, 1e-9).over(TRACKS, 2, |random| {
        let track = Track::any(random).linearized();
        let (whole, projected) = (Linear::of(&track, 0), formula(&track));
        let poses = whole.by_poses.ncols();
        let steps: Vec<DVector<f64>> =
            (0..4).map(|_| DVector::from_fn(poses, |_, _| random.normal(0.01))).collect();
        let rows =
            |linear: &Linear, step: &DVector<f64>| &linear.residual + &linear.by_poses * step;
        let long: Vec<f64> =
            steps.iter().map(|step| rows(&projected, step).norm_squared()).collect();
        let left: Vec<f64> =
            steps.iter().map(|step| least(&whole.by_landmark, &rows(&whole, step)).1).collect();
        (long, left)
    })
}

type Sampson = fn(&Vector4<f64>, &Vector4<f64>) -> f64;

fn track_two_sights(formula: Sampson) -> Comparison {
    let against = "the one row that two sights leave";
    Comparison::relative(against, 1e-5).over(TRACKS, 3, |random| {
        let track = Track::drawn(random, Plan::new(2));
        let row = Linear::projected(&track.linearized());
        let cameras = [0, 1].map(|k| track.sights[k].pose.at_rest().pose() * track.rig);
        let predicted = cameras.map(|world_from_camera| {
            let seen = track.camera.project(&world_from_camera.inverse(), &track.landmark);
            seen.expect("it is ahead")
        });
        let both = |pair: [Vector2<f64>; 2]| {
            let [one, other] = pair;
            Vector4::new(one.x, one.y, other.x, other.y)
        };
        let predicted = both(predicted);
        let measured = both([0, 1].map(|k| track.sights[k].pixel));
        // How far the two rays are from one plane.
        let baseline = cameras[1].translation.vector - cameras[0].translation.vector;
        let ray = |k: usize, u: f64, v: f64| {
            let camera = &track.camera;
            let direction =
                Vector3::new((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0);
            cameras[k].rotation * direction
        };
        let gradient = differences(1e-3, |step: Vector4<f64>| {
            let pixels = predicted + step;
            let rays = (ray(0, pixels[0], pixels[1]), ray(1, pixels[2], pixels[3]));
            nalgebra::Vector1::new(baseline.cross(&rays.0).dot(&rays.1))
        });
        let gradient = gradient.transpose();
        (formula(&gradient, &(predicted - measured)), row.residual[0].abs())
    })
}

/// Information and gradient of the poses after the elimination of the landmark, by the formula.
pub fn eliminated(linear: &Linear) -> (DMatrix<f64>, DVector<f64>) {
    let Linear { by_landmark: f, by_poses: x, residual: r } = linear;
    let own = f.tr_mul(f).try_inverse().expect("the landmark is seen");
    let across = x.tr_mul(f) * own;
    (x.tr_mul(x) - &across * f.tr_mul(x), x.tr_mul(r) - &across * f.tr_mul(r))
}
