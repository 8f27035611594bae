//! The numbers that the chapter quotes.

use nalgebra::{DMatrix, Matrix2, Vector2, Vector3};
use vislam::bearing::back_project;
use vislam::least_squares::Spectrum;

use super::mixing::{
    CONSISTENT, Convention, Experiment, FAR_START, NOISELESS, OUTCOME_ANGLES, OUTCOMES,
    RATE_ANGLES, RATES, SKEWED, largest_shift, predicted_rate,
};
use super::worked::{CAMERA, EUROC_SIZE, POINT, blocks, both_blocks, euroc, one_coefficient};
use crate::chapter::Chapter;
use crate::comparison::inverse;

/// Registers the numbers.
pub fn numbers(chapter: &mut Chapter) {
    worked_example(chapter);
    reading(chapter);
    ranks(chapter);
    bent_image(chapter);
    folded_image(chapter);
    mixed_rates(chapter);
    mixed_outcomes(chapter);
}

fn worked_example(chapter: &mut Chapter) {
    chapter.number("fx", CAMERA.fx, "px", 0);
    chapter.number("cx", CAMERA.cx, "px", 0);
    chapter.number("cy", CAMERA.cy, "px", 0);
    chapter.number("x", POINT.x, "m", 1);
    chapter.number("y", POINT.y, "m", 1);
    chapter.number("z", POINT.z, "m", 0);
    let (block, jacobian) = blocks(&POINT);
    chapter.number("focal_over_depth", jacobian[(0, 0)], "px/m", 0);
    chapter.number("u_by_z", jacobian[(0, 2)], "px/m", 1);
    chapter.number("v_by_z", jacobian[(1, 2)], "px/m", 1);
    chapter.number("u_by_turn_x", block[(0, 3)], "px/rad", 2);
    chapter.number("u_by_turn_y", block[(0, 4)], "px/rad", 2);
    chapter.number("u_by_turn_z", block[(0, 5)], "px/rad", 2);
    chapter.number("v_by_turn_x", block[(1, 3)], "px/rad", 2);
    chapter.number("v_by_turn_y", block[(1, 4)], "px/rad", 2);
    chapter.number("v_by_turn_z", block[(1, 5)], "px/rad", 2);
}

fn reading(chapter: &mut Chapter) {
    let (block, _) = blocks(&POINT);
    let (turn, forward) = (block.column(4), block.column(2));
    chapter.number("milliradian_px", 1e-3 * turn.x, "px", 2);
    chapter.number("centimetre_u_px", 1e-2 * forward.x.abs(), "px", 3);
    chapter.number("centimetre_px", 1e-2 * forward.norm(), "px", 3);
    let ratio = turn.x / forward.x.abs();
    chapter.number("ratio", ratio, "m/rad", 0);
    chapter.number("ratio_to_centimetre", ratio * 1e-3 / 1e-2, "cm/mrad", 1);
    let (far, _) = blocks(&(10.0 * POINT));
    chapter.number("ratio_far", far[(0, 4)] / far[(0, 2)].abs(), "m/rad", 0);
    let offset = Vector3::new(POINT.x, POINT.y, 10.0 * POINT.z);
    let (far, _) = blocks(&offset);
    chapter.number("ratio_far_offset", far[(0, 4)] / far[(0, 2)].abs(), "m/rad", 0);
    chapter.number("far_z", offset.z, "m", 0);
    // On the axis the turn does the same at every depth, the step what it does at a metre, over Z.
    let (axis, _) = blocks(&Vector3::z());
    let equal_depth = (1e-2 * axis[(0, 0)]) / (1e-3 * axis[(0, 4)]);
    chapter.number("equal_depth", equal_depth, "m", 0);
    chapter.number("equal_depth_tenth", 0.1 * equal_depth, "m", 0);
    chapter.number("equal_depth_ten_times", 10.0 * equal_depth, "m", 0);
}

fn rank(jacobian: &DMatrix<f64>) -> usize {
    let spectrum = Spectrum::of(jacobian).expect("zeros are told apart from what is seen");
    jacobian.ncols() - spectrum.zeros
}

/// Ranks of the pose blocks of one, two, three and four points, stacked.
fn ranks(chapter: &mut Chapter) {
    let pixels =
        [(100.0, 80.0, 4.0), (500.0, 120.0, 7.0), (260.0, 400.0, 5.0), (480.0, 380.0, 6.0)];
    let names = ["rank_1", "rank_2", "rank_3", "rank_4"];
    let mut stacked = DMatrix::zeros(2 * names.len(), 6);
    for (index, (u, v, depth)) in pixels.into_iter().enumerate() {
        let (block, _) = blocks(&back_project(&CAMERA, &Vector2::new(u, v), depth));
        stacked.rows_mut(2 * index, 2).copy_from(&block);
        let seen = stacked.rows(0, 2 * index + 2).into_owned();
        chapter.number(names[index], rank(&seen) as f64, "", 0);
    }
    chapter.number("free_of_nine", 9.0 - rank(&both_blocks(&POINT)) as f64, "", 0);
}

fn bent_image(chapter: &mut Chapter) {
    let camera = euroc();
    let corner = Vector2::zeros();
    let ideal = camera.unproject(&corner).expect("the lens shows the corner");
    let undistorted = camera.pinhole.project_cam(&ideal.push(1.0)).expect("it is in front");
    chapter.number("corner_move_px", (undistorted - corner).norm(), "px", 0);
    chapter.number("corner_angle_deg", ideal.norm().atan().to_degrees(), "°", 0);
    let focal = Matrix2::new(camera.pinhole.fx, 0.0, 0.0, camera.pinhole.fy);
    let growth = focal * inverse(camera.lens.jacobian(&ideal)) * inverse(focal);
    let along = growth.singular_values();
    chapter.number("corner_noise_radial", along.max(), "px", 1);
    chapter.number("corner_noise_across", along.min(), "px", 1);
}

fn folded_image(chapter: &mut Chapter) {
    let (camera, lens) = (euroc(), one_coefficient());
    let [k1, k2, ..] = camera.lens.coefficients();
    chapter.number("k1", k1, "", 3);
    chapter.number("k2", k2, "", 3);
    let fold = lens.monotonic_radius();
    chapter.number("fold_radius", fold, "", 3);
    chapter.number("fold_deg", fold.atan().to_degrees(), "°", 0);
    let shown = lens.distort(&Vector2::new(fold, 0.0)).x;
    chapter.number("fold_shown", shown, "", 3);

    let (width, height) = EUROC_SIZE;
    let pixels = (0..width as i32).flat_map(|u| (0..height as i32).map(move |v| [u, v]));
    let outside = pixels.filter(|pixel| {
        let [u, v] = pixel.map(f64::from);
        let ray = back_project(&camera.pinhole, &Vector2::new(u, v), 1.0);
        ray.x.hypot(ray.y) > shown
    });
    let percent = 100.0 * outside.count() as f64 / (width * height);
    chapter.number("fold_outside_percent", percent, "%", 0);

    let ghost_deg: f64 = 60.0;
    let ghost = lens.distort(&Vector2::new(ghost_deg.to_radians().tan(), 0.0)).x;
    chapter.number("ghost_deg", ghost_deg, "°", 0);
    chapter.number("ghost_px", camera.pinhole.fx * ghost, "px", 0);
}

fn mixed_rates(chapter: &mut Chapter) {
    let named = [
        (0, "angle_14", "predicted_14", "measured_14"),
        (2, "angle_40", "predicted_40", "measured_40"),
        (4, "angle_55", "predicted_55", "measured_55"),
        (6, "angle_70", "predicted_70", "measured_70"),
    ];
    for (index, angle, predicted, measured) in named {
        chapter.number(angle, RATE_ANGLES[index], "°", 0);
        chapter.number(predicted, predicted_rate(RATE_ANGLES[index]), "", 2);
        chapter.number(measured, RATES[index], "", 2);
    }
    chapter.number("critical_deg", 2.0 * 0.5_f64.asin().to_degrees(), "°", 0);
    let steps_for_a_digit = -1.0 / predicted_rate(RATE_ANGLES[4]).log10();
    chapter.number("steps_for_digit_55", steps_for_a_digit, "", 0);
    let experiment = Experiment::new(0.0, RATE_ANGLES[0], FAR_START);
    let errors = experiment.errors(Convention::Consistent, &experiment.truth(), 6);
    let steps = errors.iter().position(|error| *error < 1e-9).unwrap_or(errors.len());
    chapter.number("consistent_steps", steps as f64, "", 0);
    chapter.number("start_cm", 100.0 * FAR_START, "cm", 0);
}

fn mixed_outcomes(chapter: &mut Chapter) {
    chapter.number("optimum_rmse", CONSISTENT.rmse, "px", 3);
    chapter.number("optimum_steps", CONSISTENT.iterations as f64, "", 0);
    let (slow, stalled) = (&OUTCOMES[3], &OUTCOMES[4]);
    chapter.number("slow_deg", OUTCOME_ANGLES[3], "°", 0);
    chapter.number("slow_steps", slow.iterations as f64, "", 0);
    chapter.number("slow_rmse", slow.rmse, "px", 3);
    chapter.number("stall_deg", OUTCOME_ANGLES[4], "°", 0);
    chapter.number("stall_rmse", stalled.rmse, "px", 2);
    chapter.number("stall_steps", stalled.iterations as f64, "", 0);
    chapter.number("stall_gradient", stalled.gradient_norm, "", 0);
    chapter.number("stall_cm", 100.0 * stalled.distance, "cm", 0);
    chapter.number("stall_noiseless_rmse", NOISELESS.rmse, "px", 2);
    let truth = Experiment::new(1.0, OUTCOME_ANGLES[0], FAR_START);
    let noise_itself = largest_shift(&truth.optimum(), &truth.truth());
    chapter.number("noise_mm", 1e3 * noise_itself, "mm", 0);

    let names = [("skew_mm_14", "skew_rmse_14"), ("skew_mm_70", "skew_rmse_70")];
    for ((shift, rmse), (shift_name, rmse_name)) in SKEWED.into_iter().zip(names) {
        chapter.number(shift_name, 1e3 * shift, "mm", 0);
        chapter.number(rmse_name, rmse, "px", 3);
    }
}
