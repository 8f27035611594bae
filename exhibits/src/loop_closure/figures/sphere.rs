//! A sphere by odometry, by the chord, and at the minimum.

use nalgebra::Isometry3;
use plotters::chart::ChartBuilder;

use crate::figure::{Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_around};
use crate::loop_closure::sphere::searches;

/// One pose in so many has a row of data.
const ROWS: usize = 7;

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
    Figure::new(620, columns, |drawing| {
        for (panel, (name, poses, colour)) in drawing.split_evenly((1, 3)).iter().zip(panels) {
            paint(panel, name, poses, colour)?;
        }
        Ok(())
    })
}

/// The poses from the side, in a square around them.
fn paint(
    drawing: &Drawing,
    name: &str,
    poses: &[Isometry3<f64>],
    colour: plotters::style::RGBColor,
) -> Drawn {
    let place = |pose: &Isometry3<f64>| (pose.translation.x, pose.translation.z);
    let ends = |axis: usize| {
        let numbers = poses.iter().map(|pose| pose.translation.vector[axis]);
        numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], n| [low.min(n), high.max(n)])
    };
    let (x, z) = (ends(0), ends(2));
    let half = 0.55 * (x[1] - x[0]).max(z[1] - z[0]);
    let (x, z) = (0.5 * (x[0] + x[1]), 0.5 * (z[0] + z[1]));
    let mut chart = ChartBuilder::on(drawing)
        .margin(10)
        .build_cartesian_2d(x - half..x + half, z - half..z + 1.5 * half)?;
    chart.line(poses.iter().map(place), colour, 3)?;
    chart.write(name, (x, z + 1.3 * half), letters_around(INK))
}
