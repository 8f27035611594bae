//! What a first-order correction leaves, over how far the bias has moved.

use nalgebra::Vector3;
use plotters::coord::combinators::IntoLogRange;
use vislam::inertial::{GRAVITY, ImuBias};
use vislam::preintegration::correct_for_bias;
use vislam::simulation::Trajectory;

use crate::figure::{self, Draw, Figure, INK, SERIES, letters_right_of, plain};
use crate::preintegration::sums::oracle::{gyro_bias, summed};

/// Sizes of the move of the gyroscope's bias, in rad/s.
const SIZES: [f64; 9] = [0.003, 0.005, 0.009, 0.015, 0.025, 0.04, 0.07, 0.12, 0.2];

/// The error of the position in metres, for a second of readings at 200 Hz.
pub fn left_by(motion: &Trajectory, axis: &Vector3<f64>, size: f64) -> f64 {
    let samples = motion.samples(&GRAVITY, 0.005, 200);
    let summed = |bias: ImuBias| summed(&samples, 0.005, &bias);
    let (sums, again) = (summed(ImuBias::default()), summed(gyro_bias(size * axis)));
    (correct_for_bias(&sums, &again.bias).position - again.deltas.position).norm()
}

pub fn correction() -> Figure {
    let (ahead, up) = (Vector3::x(), Vector3::z());
    let eight = Trajectory::figure_eight();
    let (level, spot) = (Trajectory::level_turn(1.0, 0.5), Trajectory::turn_on_the_spot(0.5));
    let left = |motion, axis| SIZES.map(|size| left_by(motion, axis, size));
    // The last has no mark, as it is nothing.
    let series = [
        ("figure-eight, about ahead", left(&eight, &ahead)),
        ("level turn, about ahead", left(&level, &ahead)),
        ("on the spot, about ahead", left(&spot, &ahead)),
        ("figure-eight, about up", left(&eight, &up)),
        ("level turn, about up", left(&level, &up)),
        ("on the spot, about up", left(&spot, &up)),
    ];
    let cells = |index: usize| {
        let cell =
            |error| if error < 1e-13 { "below 1e-13".to_owned() } else { format!("{error:.2e}") };
        series[index].1.map(cell).to_vec()
    };
    let columns = vec![
        ("move of the bias (rad/s)", plain(SIZES)),
        ("figure-eight about ahead (m)", cells(0)),
        ("level turn about ahead (m)", cells(1)),
        ("on the spot about ahead (m)", cells(2)),
        ("figure-eight about up (m)", cells(3)),
        ("level turn about up (m)", cells(4)),
        ("on the spot about up (m)", cells(5)),
    ];
    Figure::new(1060, columns, |drawing| {
        let x_axis = ("move of the gyroscope's bias (rad/s)", (2e-3..0.3).log_scale(), 4);
        let y_axis = ("position error (µm)", (0.03..3e6).log_scale(), 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.line([(0.02, 0.15), (0.2, 15.0)], INK, 3)?;
        chart.write("slope 2", (0.08, 0.9), letters_right_of(INK))?;
        for (index, (name, errors)) in series.iter().take(5).enumerate() {
            let places = SIZES.iter().zip(errors).map(|(size, error)| (*size, 1e6 * error));
            chart.line(places.clone(), SERIES[index], 4)?;
            // Three of the lines lie close together: their marks take turns.
            let (skip, every) = if index < 3 { (index, 3) } else { (0, 1) };
            chart.marks(places.skip(skip).step_by(every), index)?;
            chart.key(index, name, (2.4e-3, 1e6 / 3.2_f64.powi(index as i32)), 2.7e-3)?;
        }
        Ok(())
    })
}
