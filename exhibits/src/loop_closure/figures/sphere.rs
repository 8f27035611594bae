//! A sphere by odometry, by the chord, and at the minimum.

use nalgebra::Isometry3;
use plotters::chart::ChartBuilder;
use plotters::style::RGBColor;

use crate::figure::{Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_around};
use crate::loop_closure::sphere::searches;

/// One pose in so many has a row of data.
const ROWS: usize = 7;
/// The length of the bar in metres.
const BAR: f64 = 10.0;

pub fn sphere() -> Figure {
    let [odometry, chordal] = searches();
    let panels = [
        ("odometry", &odometry.begin, SERIES[1]),
        ("chordal start", &chordal.begin, SERIES[2]),
        ("minimum", &chordal.found, SERIES[0]),
    ];
    let axis = |poses: &[Isometry3<f64>], axis: usize| {
        decimals(2, poses.iter().step_by(ROWS).map(move |pose| pose.translation.vector[axis]))
    };
    let columns = vec![
        ("odometry x (m)", axis(panels[0].1, 0)),
        ("odometry z (m)", axis(panels[0].1, 2)),
        ("chordal start x (m)", axis(panels[1].1, 0)),
        ("chordal start z (m)", axis(panels[1].1, 2)),
        ("minimum x (m)", axis(panels[2].1, 0)),
        ("minimum z (m)", axis(panels[2].1, 2)),
    ];
    Figure::new(480, columns, |drawing| {
        let scale = panels.iter().map(|(_, poses, _)| extent(poses)).fold(0.0, f64::max);
        for (panel, (name, poses, colour)) in drawing.split_evenly((1, 3)).iter().zip(panels) {
            paint(panel, name, poses, (colour, scale))?;
        }
        Ok(())
    })
}

/// The ends of poses along an axis.
fn ends(poses: &[Isometry3<f64>], axis: usize) -> [f64; 2] {
    let numbers = poses.iter().map(|pose| pose.translation.vector[axis]);
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], n| [low.min(n), high.max(n)])
}

/// How wide poses are from the side, or how tall.
fn extent(poses: &[Isometry3<f64>]) -> f64 {
    [0, 2].map(|axis| ends(poses, axis)).iter().fold(0.0, |most, [a, b]| most.max(b - a))
}

/// The poses from the side, at a scale at which so many metres are as wide as the panel.
fn paint(
    drawing: &Drawing,
    name: &str,
    poses: &[Isometry3<f64>],
    (colour, scale): (RGBColor, f64),
) -> Drawn {
    let place = |pose: &Isometry3<f64>| (pose.translation.x, pose.translation.z);
    let [x, z] = [0, 2].map(|axis| ends(poses, axis)).map(|[low, high]| 0.5 * (low + high));
    let (width, height) = drawing.dim_in_pixel();
    let across = 0.55 * scale;
    let up = across * f64::from(height) / f64::from(width);
    let mut chart =
        ChartBuilder::on(drawing).build_cartesian_2d(x - across..x + across, z - up..z + up)?;
    chart.line(poses.iter().map(place), colour, 3)?;
    chart.write(name, (x, z + 0.88 * up), letters_around(INK))?;
    let bar = z - 0.92 * up;
    chart.line([(x - 0.5 * BAR, bar), (x + 0.5 * BAR, bar)], INK, 5)?;
    chart.write(&format!("{BAR} m"), (x, bar + 0.12 * up), letters_around(INK))
}
