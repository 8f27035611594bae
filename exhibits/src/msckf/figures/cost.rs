//! Time over the length of a track, the number of tracks and the window, from the accepted record.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals, plain};
use crate::msckf::cost::{FEATURES, LENGTHS, WINDOWS, recorded};
use crate::record::accepted;

pub fn cost() -> Figure {
    let without = accepted("msckf_cost", "features_0");
    let features = recorded("features", &FEATURES).into_iter();
    let curves = [
        recorded("length", &LENGTHS),
        features.map(|(count, time)| (count, time - without)).collect(),
        recorded("window", &WINDOWS),
    ];
    let names: [&str; 3] =
        ["projection, by sights", "tracks of a picture, by their number", "correction, by poses"];
    let exponents = ["exponent_length", "exponent_features", "exponent_window"];
    let cells = || {
        curves.iter().zip(names).flat_map(|(curve, name)| curve.iter().map(move |at| (name, at)))
    };
    let columns = vec![
        ("what", cells().map(|(name, _)| name.to_owned()).collect()),
        ("size", plain(cells().map(|(_, (size, _))| *size))),
        ("time (us)", decimals(1, cells().map(|(_, (_, time))| *time))),
    ];
    Figure::new(860, columns, |drawing| {
        let times = || curves.iter().flatten().map(|(_, time)| *time);
        let lowest = times().fold(f64::INFINITY, f64::min);
        let highest = times().fold(0.0_f64, f64::max);
        let x_axis = ("sights, tracks or poses", (5.0..220.0).log_scale(), 4);
        let y_axis = ("µs", (0.5 * lowest..20.0 * highest).log_scale(), 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, (curve, exponent)) in curves.iter().zip(exponents).enumerate() {
            chart.line(curve.iter().copied(), SERIES[index], 4)?;
            chart.marks(curve.iter().copied(), index)?;
            let slope = accepted("msckf_cost", exponent);
            let height = highest * [10.0, 4.0, 1.6][index];
            let name = format!("{}: exponent {slope:.1}", names[index]);
            chart.key(index, &name, (6.0, height), 6.8)?;
        }
        Ok(())
    })
}
