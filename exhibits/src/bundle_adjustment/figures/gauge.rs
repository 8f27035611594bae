//! One estimate in three gauges.

use crate::bundle_adjustment::gauge::{CAMERAS, covariances};
use crate::figure::{self, Draw, Figure, SERIES, decimals};

const NAMES: [&str; 3] = ["camera 0 held", "camera 4 held", "shortest"];

pub fn gauge() -> Figure {
    let of_gauge =
        |gauge| -> Vec<f64> { (0..CAMERAS).map(|k| covariances().position_mm(gauge, k)).collect() };
    let sigmas = [0, 1, 2].map(of_gauge);
    let cells = |gauge: usize| decimals(2, sigmas[gauge].iter().copied());
    let columns = vec![
        ("camera", (0..CAMERAS).map(|camera| camera.to_string()).collect()),
        ("with camera 0 held (mm)", cells(0)),
        ("with camera 4 held (mm)", cells(1)),
        ("with nothing held and shortest steps (mm)", cells(2)),
    ];
    Figure::new(780, columns, |drawing| {
        let highest = sigmas.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
        let x_axis = ("camera", -0.4..7.4, 8);
        let y_axis = ("position, standard deviation (mm)", -0.06 * highest..1.42 * highest, 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, of) in sigmas.iter().enumerate() {
            let places = || of.iter().enumerate().map(|(camera, sigma)| (camera as f64, *sigma));
            chart.line(places(), SERIES[index], 4)?;
            chart.marks(places(), index)?;
            // A legend above the curves.
            let (x, y) = (2.55 * index as f64 - 0.15, 1.32 * highest);
            chart.key(index, NAMES[index], (x, y), x + 0.17)?;
        }
        Ok(())
    })
}
