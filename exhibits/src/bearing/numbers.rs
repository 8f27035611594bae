//! The numbers that the chapter quotes.

use nalgebra::{Isometry3, Rotation3, Vector2, Vector3};
use vislam::bearing::{
    depth_sigma, disparity, inverse_depth_sigma, parallax, stretch_shift,
    transfer_by_infinite_homography,
};

use super::NOWHERE;
use super::noise::{Pair, quantile};
use super::worked::{BASELINE, CAMERA, POINT, second_from_first};
use crate::chapter::Chapter;

const SHORT_BASELINE: f64 = 0.1;

/// Registers the numbers.
pub fn numbers(chapter: &mut Chapter) {
    two_views(chapter);
    stretched(chapter);
    depth_sigmas(chapter);
    angles(chapter);
    motions(chapter);
    far_away(chapter);
}

fn two_views(chapter: &mut Chapter) {
    chapter.number("fx", CAMERA.fx, "px", 0);
    chapter.number("fy", CAMERA.fy, "px", 0);
    chapter.number("cx", CAMERA.cx, "px", 0);
    chapter.number("cy", CAMERA.cy, "px", 0);
    chapter.number("point_x", POINT.x, "m", 1);
    chapter.number("point_y", POINT.y, "m", 1);
    chapter.number("point_z", POINT.z, "m", 0);
    chapter.number("baseline", BASELINE, "m", 1);
    let first = seen(&Isometry3::identity(), &POINT);
    let second = seen(&second_from_first(BASELINE), &POINT);
    chapter.number("u0", first.x, "px", 0);
    chapter.number("v0", first.y, "px", 0);
    chapter.number("u1", second.x, "px", 0);
    chapter.number("v1", second.y, "px", 0);
    chapter.number("second_x", POINT.x - BASELINE, "m", 1);
    chapter.number("disparity_px", first.x - second.x, "px", 0);
}

fn stretched(chapter: &mut Chapter) {
    let stretch = 1.1;
    let stretched = stretch * POINT;
    chapter.number("stretch_percent", 100.0 * (stretch - 1.0), "%", 0);
    chapter.number("stretched_x", stretched.x, "m", 2);
    chapter.number("stretched_z", stretched.z, "m", 1);
    chapter.number("stretched_second_x", stretched.x - BASELINE, "m", 2);
    chapter.number("stretched_u0", seen(&Isometry3::identity(), &stretched).x, "px", 0);
    chapter.number("stretched_u1", seen(&second_from_first(BASELINE), &stretched).x, "px", 3);
    let move_px = stretch_shift(&CAMERA, BASELINE, POINT.z, stretch);
    chapter.number("stretch_move_px", move_px, "px", 2);

    chapter.number("short_baseline", SHORT_BASELINE, "m", 1);
    chapter.number("one_metre_near_px", contradiction(BASELINE, -1.0), "px", 0);
    chapter.number("one_metre_far_px", contradiction(BASELINE, 1.0), "px", 2);
    chapter.number("one_metre_near_short_px", contradiction(SHORT_BASELINE, -1.0), "px", 0);
    chapter.number("one_metre_far_short_px", contradiction(SHORT_BASELINE, 1.0), "px", 2);
}

fn depth_sigmas(chapter: &mut Chapter) {
    let sigma = |baseline, depth| depth_sigma(&CAMERA, baseline, depth, 1.0);
    chapter.number("sigma_z_cm", 100.0 * sigma(BASELINE, 5.0), "cm", 1);
    chapter.number("sigma_z_10", sigma(BASELINE, 10.0), "m", 1);
    chapter.number("sigma_z_50", sigma(BASELINE, 50.0), "m", 1);
    chapter.number("sigma_z_short", sigma(SHORT_BASELINE, 5.0), "m", 3);
    chapter.number("sqrt2", Pair::worked().disparity_sigma(), "px", 2);
    chapter.number("sigma_z_both_cm", 100.0 * Pair::worked().depth_sigma(), "cm", 1);
}

fn angles(chapter: &mut Chapter) {
    let pixel_angle = 1.0 / CAMERA.fx;
    chapter.number("pixel_angle_mrad", 1e3 * pixel_angle, "mrad", 1);
    chapter.number("pixel_angle_deg", pixel_angle.to_degrees(), "°", 2);
    let angle = |point: &Vector3<f64>, baseline: f64| {
        parallax(point, &Vector3::zeros(), &(baseline * Vector3::x())).to_degrees()
    };
    chapter.number("parallax_deg", angle(&POINT, BASELINE), "°", 1);
    chapter.number("parallax_short_deg", angle(&POINT, SHORT_BASELINE), "°", 1);
    chapter.number("parallax_50_deg", angle(&(50.0 * Vector3::z()), BASELINE), "°", 2);
    // Relative depth error is pixel angle over parallax, so a tenth asks for ten pixel angles.
    chapter.number("parallax_for_tenth_deg", (10.0 * pixel_angle).to_degrees(), "°", 1);
    chapter.number("parallax_for_hundredth_deg", (100.0 * pixel_angle).to_degrees(), "°", 0);
    chapter.number("baseline_for_tenth_50", 50.0 * 10.0 * pixel_angle, "m", 2);
}

fn motions(chapter: &mut Chapter) {
    let turn_deg: f64 = 10.0;
    chapter.number("turn_deg", turn_deg, "°", 0);
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), turn_deg.to_radians());
    let centre = Vector2::new(CAMERA.cx, CAMERA.cy);
    let turned = transfer_by_infinite_homography(&CAMERA, &turn, &centre).unwrap_or(NOWHERE);
    chapter.number("turn_move_px", (turned - centre).norm(), "px", 1);

    let sideways = 0.1;
    chapter.number("sideways_cm", 100.0 * sideways, "cm", 0);
    chapter.number("sideways_5_px", disparity(&CAMERA, sideways, 5.0), "px", 0);
    chapter.number("sideways_50_px", disparity(&CAMERA, sideways, 50.0), "px", 1);
}

const FAR: f64 = 40.0;
const VERY_FAR: f64 = 100.0;
const FAR_DRAWS: usize = 100_000;
const FAR_SEED: u64 = 20;

fn far_away(chapter: &mut Chapter) {
    let pair = Pair::at_depth(FAR);
    let sigma = pair.depth_sigma();
    chapter.number("far_depth", FAR, "m", 0);
    chapter.number("far_draws", FAR_DRAWS as f64, "", 0);
    chapter.number("far_disparity_px", disparity(&CAMERA, BASELINE, FAR), "px", 0);
    chapter.number("far_sigma_z", sigma, "m", 1);

    let mut depths: Vec<f64> = pair.depths(FAR_SEED).take(FAR_DRAWS).collect();
    chapter.number("far_median", quantile(&mut depths, 0.5), "m", 1);
    chapter.number("far_p05", quantile(&mut depths, 0.05), "m", 1);
    chapter.number("far_p95", quantile(&mut depths, 0.95), "m", 1);
    let above = percentage(&depths, |z| z > FAR + 2.0 * sigma);
    let below = percentage(&depths, |z| z < FAR - 2.0 * sigma);
    chapter.number("far_above_two_sigma_percent", above, "%", 1);
    chapter.number("far_below_two_sigma_percent", below, "%", 1);

    let inverse_depths: Vec<f64> = pair.inverse_depths(FAR_SEED).take(FAR_DRAWS).collect();
    let sigma = inverse_depth_sigma(&CAMERA, BASELINE, pair.disparity_sigma());
    let above = percentage(&inverse_depths, |rho| rho > 1.0 / FAR + 2.0 * sigma);
    let below = percentage(&inverse_depths, |rho| rho < 1.0 / FAR - 2.0 * sigma);
    chapter.number("far_rho_above_two_sigma_percent", above, "%", 1);
    chapter.number("far_rho_below_two_sigma_percent", below, "%", 1);

    let very_far: Vec<f64> = Pair::at_depth(VERY_FAR).depths(FAR_SEED).take(FAR_DRAWS).collect();
    chapter.number("very_far_depth", VERY_FAR, "m", 0);
    chapter.number("very_far_disparity_px", disparity(&CAMERA, BASELINE, VERY_FAR), "px", 0);
    chapter.number("very_far_beyond_percent", percentage(&very_far, f64::is_infinite), "%", 1);
}

fn percentage(values: &[f64], counts: impl Fn(f64) -> bool) -> f64 {
    let counted = values.iter().filter(|value| counts(**value)).count();
    100.0 * counted as f64 / values.len() as f64
}

/// Pixels by which the second camera contradicts a depth that is wrong by `error` metres at the
/// worked geometry.
fn contradiction(baseline: f64, error: f64) -> f64 {
    stretch_shift(&CAMERA, baseline, POINT.z, (POINT.z + error) / POINT.z).abs()
}

fn seen(camera_from_world: &Isometry3<f64>, point: &Vector3<f64>) -> Vector2<f64> {
    CAMERA.project(camera_from_world, point).unwrap_or(NOWHERE)
}
