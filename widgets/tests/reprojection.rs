//! The widget of the two conventions shows what the library makes of one problem, and its controls do what they say.

use approx::assert_relative_eq;
use nalgebra::{DMatrix, DVector};
use vislam::bundle_adjustment::{BaReport, Camera, PosedPinhole, TinyBa};
use vislam::least_squares::Options;
use vislam::manifold::se3;
use widgets::reprojection::{Reprojection, STEPS, street, to_side};
use widgets::{Player, Session, Widget};

const ARROWS: usize = 0;
const CONSISTENT: usize = 1;
const MIXED: usize = 2;
const CONSISTENT_ERROR: usize = 3;
const MIXED_ERROR: usize = 4;
const LEFT: usize = 5;
const PREDICTED: usize = 6;

fn shown(settings: &[(&str, f64)]) -> Vec<f64> {
    let mut session = Session::<Reprojection>::with(settings).expect("controls");
    session.readings().into_iter().map(|(_, value)| value).collect()
}

#[test]
fn the_consistent_optimizer_ends_where_the_solver_of_the_library_ends() {
    for angle in [0.0, 40.0, 110.0] {
        let scene = street(f64::to_radians(angle), 1.5, 2.0);
        let mut problem: TinyBa<PosedPinhole, 6> = scene.problem;
        let report: BaReport = problem.solve(&Options::default()).expect("two cameras are held");
        let rmse = 1.5 * (2.0 * report.cost / problem.factors.len() as f64).sqrt();
        let shown = shown(&[("angle", angle), ("noise", 1.5), ("step", STEPS as f64)]);
        assert_relative_eq!(shown[CONSISTENT], rmse, max_relative = 1e-6);
        assert!(shown[CONSISTENT_ERROR] < 1e-5, "{}", shown[CONSISTENT_ERROR]);
    }
}

#[test]
fn on_the_right_both_are_the_same_and_arrows_differ_by_second_order_only() {
    for step in 0..5 {
        let shown = shown(&[("step", f64::from(step)), ("side", 1.0), ("angle", 100.0)]);
        assert_eq!(shown[CONSISTENT], shown[MIXED]);
        assert_eq!(shown[CONSISTENT_ERROR], shown[MIXED_ERROR]);
        assert_eq!(shown[PREDICTED], 0.0);
    }
    for axis in 0..6 {
        let differ = |side: f64| shown(&[("axis", f64::from(axis)), ("side", side)])[ARROWS];
        assert!(differ(1.0) < 10.0, "{axis}");
        // The world is turned about x: for that axis both sides are nearly one.
        let is_common = axis % 3 == 0;
        assert!(is_common || differ(0.0) > 2.0 * differ(1.0), "{axis}");
    }
}

#[test]
fn in_another_world_the_consistent_optimizer_takes_the_same_steps() {
    for step in [1.0, 2.0] {
        let rmse = |angle: f64| shown(&[("angle", angle), ("step", step)])[CONSISTENT];
        assert_relative_eq!(rmse(0.0), rmse(110.0), max_relative = 1e-9);
    }
}

/// Residuals, and their Jacobian for steps of the cameras on a side.
fn linearized(problem: &TinyBa<PosedPinhole, 6>, side: f64) -> (DVector<f64>, DMatrix<f64>) {
    let (cameras, rows) = (problem.cameras.len(), 2 * problem.factors.len());
    let mut residual = DVector::zeros(rows);
    let mut jacobian = DMatrix::zeros(rows, 6 * cameras + 3 * problem.points.len());
    for (number, factor) in problem.factors.iter().enumerate() {
        let (row, weight) = (2 * number, factor.inverse_sigma);
        let camera = problem.cameras[factor.keyframe];
        let seen = camera.differentiate(&problem.points[factor.point]).expect("it is in front");
        residual.rows_mut(row, 2).copy_from(&(weight * (seen.pixel - factor.pixel)));
        let by_camera = weight * seen.by_camera * to_side(&camera.camera_from_world, side);
        if !problem.fixed[factor.keyframe] {
            jacobian.view_mut((row, 6 * factor.keyframe), (2, 6)).copy_from(&by_camera);
        }
        let column = 6 * cameras + 3 * factor.point;
        jacobian.view_mut((row, column), (2, 3)).copy_from(&(weight * seen.by_point));
    }
    (residual, jacobian)
}

#[test]
fn a_mixed_step_is_what_its_own_jacobian_asks_for() {
    for (angle, side) in [(40.0, 1.0), (70.0, 0.4)] {
        let mut problem = street(f64::to_radians(angle), 1.0, 2.0).problem;
        let (residual, jacobian) = linearized(&problem, side);
        let step = jacobian.svd(true, true).solve(&-residual, 1e-9).expect("both bases");
        let cameras = 6 * problem.cameras.len();
        for (number, camera) in problem.cameras.iter_mut().enumerate() {
            *camera = camera.retract(&step.fixed_rows::<6>(6 * number).into_owned());
        }
        for (number, point) in problem.points.iter_mut().enumerate() {
            *point += step.fixed_rows::<3>(cameras + 3 * number);
        }
        let (residual, _) = linearized(&problem, side);
        let rmse = (residual.norm_squared() / problem.factors.len() as f64).sqrt();
        let settings = [("angle", angle), ("side", 1.0 - side), ("noise", 1.0), ("step", 1.0)];
        assert_relative_eq!(shown(&settings)[MIXED], rmse, max_relative = 1e-8);
    }
}

#[test]
fn without_noise_a_mixed_step_leaves_what_the_theorem_says() {
    for (angle, side) in [(20.0, 1.0), (40.0, 1.0), (50.0, 1.0), (80.0, 0.5)] {
        let shown = shown(&[
            ("angle", angle),
            ("side", 1.0 - side),
            ("start", 0.5),
            ("step", if angle < 30.0 { 8.0 } else { 12.0 }),
        ]);
        let modulus = 2.0 * (f64::to_radians(angle) * side / 2.0).sin();
        assert_relative_eq!(shown[PREDICTED], modulus, max_relative = 1e-9);
        assert_relative_eq!(shown[LEFT], modulus, max_relative = 0.15);
    }
}

#[test]
fn the_mixed_optimizer_comes_to_the_same_minimum_or_nowhere() {
    let end = |angle: f64| shown(&[("angle", angle), ("side", 0.0), ("step", STEPS as f64)]);
    let slow = end(20.0);
    assert!(slow[MIXED_ERROR] < 1e-2 && slow[MIXED_ERROR] > slow[CONSISTENT_ERROR]);
    let lost = end(90.0);
    assert!(lost[CONSISTENT_ERROR] < 1e-6);
    assert!(lost[MIXED_ERROR].is_nan() || lost[MIXED_ERROR] > 100.0, "{}", lost[MIXED_ERROR]);
}

#[test]
fn sides_lead_from_the_right_to_the_left() {
    let pose = street(1.0, 0.0, 1.0).true_cameras[1].camera_from_world;
    assert_relative_eq!(to_side(&pose, 1.0), se3::adjoint(&pose.inverse()), epsilon = 1e-12);
    let half = to_side(&pose, 0.5);
    assert_relative_eq!(half * half, to_side(&pose, 1.0), epsilon = 1e-12);
}

#[test]
fn no_setting_of_the_controls_stops_it() {
    let mut session = Session::<Reprojection>::new();
    let controls = Reprojection::FACE.controls;
    for combination in 0..3_usize.pow(controls.len() as u32) {
        let mut rest = combination;
        for control in controls {
            session.set(control.name, [control.least, control.start, control.most][rest % 3]);
            rest /= 3;
        }
        let readings = session.readings();
        for at in [ARROWS, CONSISTENT, CONSISTENT_ERROR, PREDICTED] {
            assert!(readings[at].1.is_finite(), "{} {:?}", readings[at].0, session.controls());
        }
        assert!(session.numbers().len() < 5000);
    }
}

#[test]
#[ignore = "says how long an update takes; run it in release"]
fn time_of_an_update() {
    let mut session = Session::<Reprojection>::new();
    for name in ["side", "angle"] {
        let begin = std::time::Instant::now();
        for k in 0..200 {
            session.set(name, f64::from(k) * if name == "side" { 0.005 } else { 0.6 });
            session.numbers();
        }
        println!("{name}: {:?}", begin.elapsed() / 200);
    }
}
