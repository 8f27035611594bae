//! Numbers in sentences: the example by hand, what corrections leave out, the bias that nobody
//! estimates, and the rules.

use nalgebra::{Matrix3, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuSample};
use vislam::manifold::so3;
use vislam::preintegration::{Rule, correct_for_bias};
use vislam::simulation::Trajectory;

use super::bias::correction_error_term;
use super::figures::{TRUE_BIAS, at_guess, left_by, unaware};
use super::oracle::{gyro_bias, summed};
use super::rules::errors;
use crate::chapter::Chapter;

pub fn numbers(chapter: &mut Chapter) {
    by_hand(chapter);
    corrections(chapter);
    guesses(chapter);
    rules(chapter);
}

/// Of the example: rad/s, seconds, Hz, and the bias in rad/s.
const RATE: f64 = 0.51;
const DURATION: f64 = 2.0;
const SAMPLING: f64 = 200.0;
const MOVE: f64 = 0.01;

fn by_hand(chapter: &mut Chapter) {
    let count = (DURATION * SAMPLING).round() as usize;
    let reading = ImuSample { gyro: RATE * Vector3::z(), accelerometer: -GRAVITY };
    let summed = |bias: &ImuBias| summed(&vec![reading; count], 1.0 / SAMPLING, bias);
    let sums = summed(&ImuBias::default());
    let corrected = correct_for_bias(&sums, &gyro_bias(MOVE * Vector3::z()));
    let jacobian: Matrix3<f64> = sums.bias_jacobian.fixed_view::<3, 3>(0, 0).into();
    chapter.number("hand_rate", RATE, "rad/s", 2);
    chapter.number("hand_time", DURATION, "s", 0);
    chapter.number("hand_count", count as f64, "", 0);
    chapter.number("hand_move", MOVE, "rad/s", 2);
    chapter.number("hand_angle", so3::log(&sums.deltas.rotation).z, "rad", 2);
    chapter.number("hand_step", MOVE * DURATION, "rad", 2);
    chapter.number("hand_corrected", so3::log(&corrected.rotation).z, "rad", 2);
    chapter.number("hand_along", jacobian[(2, 2)], "s", 0);
    chapter.number("hand_across", jacobian[(0, 0)], "s", 2);
    chapter.number("hand_beside", jacobian[(1, 0)].abs(), "s", 2);

    // The same correction about an axis across that of the turn.
    let across = gyro_bias(MOVE * Vector3::x());
    let truth = summed(&across).deltas.rotation;
    let right = so3::local(&truth, &correct_for_bias(&sums, &across).rotation).norm();
    let naive = so3::retract(&sums.deltas.rotation, &(-DURATION * across.gyro));
    chapter.number("hand_right_mrad", 1e3 * right, "mrad", 2);
    chapter.number("hand_naive_mrad", 1e3 * so3::local(&truth, &naive).norm(), "mrad", 1);
}

fn corrections(chapter: &mut Chapter) {
    let (speed, rate, size) = (1.0, 0.5, 0.1);
    let turn = Trajectory::level_turn(speed, rate);
    let (up, ahead) = (Vector3::z(), Vector3::x());
    let inward = Vector3::y() * speed * rate;
    let by_formula = |force: &Vector3<f64>, axis: &Vector3<f64>| {
        1e3 * correction_error_term(force, &(size * axis), 1.0)
    };
    chapter.number("turn_speed", speed, "m/s", 0);
    chapter.number("turn_rate", rate, "rad/s", 1);
    chapter.number("turn_inward", speed * rate, "m/s²", 1);
    chapter.number("move", size, "rad/s", 1);
    chapter.number("move_deg", size.to_degrees(), "°/s", 0);
    chapter.number("left_up_mm", 1e3 * left_by(&turn, &up, size), "mm", 3);
    chapter.number("left_up_formula_mm", by_formula(&inward, &up), "mm", 3);
    chapter.number("left_ahead_mm", 1e3 * left_by(&turn, &ahead, size), "mm", 1);
    chapter.number("left_ahead_formula_mm", by_formula(&(inward - GRAVITY), &ahead), "mm", 1);
    let eight = Trajectory::figure_eight();
    chapter.number("left_eight_up_mm", 1e3 * left_by(&eight, &up, size), "mm", 1);
    chapter.number("left_eight_ahead_mm", 1e3 * left_by(&eight, &ahead, size), "mm", 1);
    let ratio = left_by(&turn, &up, size) / left_by(&turn, &up, size / 10.0);
    chapter.number("left_ratio", ratio, "", 0);
}

fn guesses(chapter: &mut Chapter) {
    let (sums, bias) = (unaware(1.0), TRUE_BIAS);
    let [sigmas, squared] = at_guess(&sums, 0.0);
    chapter.number("guess_bias", bias, "rad/s", 2);
    chapter.number("guess_turn_mrad", 1e3 * bias, "mrad", 0);
    chapter.number("guess_sigma_mrad", 1e3 * sums.sigmas()[0], "mrad", 1);
    chapter.number("guess_sigmas", sigmas.abs(), "", 1);
    chapter.number("guess_squared", squared, "", 0);
    let [long, _] = at_guess(&unaware(10.0), 0.0);
    chapter.number("guess_long_sigmas", long.abs(), "", 0);
    // A guess off by this much is one standard deviation off.
    chapter.number("guess_known_mrad", 1e3 * sums.sigmas()[0], "mrad/s", 1);
}

fn rules(chapter: &mut Chapter) {
    let (euler, midpoint) = (errors(Rule::Euler, 200), errors(Rule::Midpoint, 200));
    chapter.number("euler_rotation_mrad", 1e3 * euler[0], "mrad", 1);
    chapter.number("euler_velocity_mm", 1e3 * euler[1], "mm/s", 0);
    chapter.number("euler_position_mm", 1e3 * euler[2], "mm", 0);
    chapter.number("midpoint_rotation_urad", 1e6 * midpoint[0], "µrad", 1);
    chapter.number("midpoint_velocity_um", 1e6 * midpoint[1], "µm/s", 0);
    chapter.number("midpoint_position_um", 1e6 * midpoint[2], "µm", 0);
    let order = |rule, which: usize| (errors(rule, 400)[which] / errors(rule, 800)[which]).log2();
    chapter.number("euler_order", order(Rule::Euler, 2), "", 2);
    chapter.number("midpoint_order", order(Rule::Midpoint, 2), "", 2);
}
