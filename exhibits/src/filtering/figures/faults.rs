//! Which statistic catches which fault, at which length of a flight.

use plotters::element::Rectangle;
use plotters::style::Color;

use crate::figure::{
    Draw, Figure, GRID, INK, PAPER, SERIES, decimals, letters_around, letters_right_of, plain,
};
use crate::filtering::faults::{FILTERS, LENGTHS, tested};

const NAMES: [&str; 7] = [
    "map: as stated",
    "map: pixels twice as noisy",
    "map: inertial noise a quarter",
    "map: attitude not coupled",
    "displacement: as stated",
    "displacement: attitude not coupled",
    "displacement: clones untied",
];
const HEADS: [&str; 5] = ["yaw", "tilt", "velocity", "position", "NIS"];

pub fn faults() -> Figure {
    let tested = tested();
    let each = || (0..FILTERS.len()).flat_map(|filter| (0..4).map(move |length| (filter, length)));
    let of = |at: usize| {
        decimals(
            2,
            each().map(|(filter, length)| tested[filter][length][at].value).collect::<Vec<_>>(),
        )
    };
    let columns = vec![
        ("filter", plain(each().map(|(filter, _)| NAMES[filter]))),
        ("length (s)", plain(each().map(|(_, length)| LENGTHS[length]))),
        ("NEES of yaw", of(0)),
        ("of tilt", of(1)),
        ("of velocity", of(2)),
        ("of position", of(3)),
        ("NIS", of(4)),
    ];
    Figure::new(1400, columns, |drawing| {
        let mut chart = plotters::chart::ChartBuilder::on(drawing)
            .margin(20)
            .build_cartesian_2d(0.0..20.0, 14.9..0.0)?;
        for (statistic, head) in HEADS.into_iter().enumerate() {
            chart.write(head, (4.0 * statistic as f64 + 2.0, 0.45), letters_around(INK))?;
        }
        for (filter, name) in NAMES.into_iter().enumerate() {
            let top = 1.0 + 2.0 * filter as f64;
            chart.write(name, (0.05, top + 0.35), letters_right_of(INK))?;
            for (length, statistics) in tested[filter].iter().enumerate() {
                for (statistic, tested) in statistics.iter().enumerate() {
                    let left = 4.0 * statistic as f64 + 0.95 * length as f64 + 0.05;
                    let corners = [(left, top + 0.75), (left + 0.85, top + 1.75)];
                    let (colour, sign) = match tested.verdict() {
                        1 => (SERIES[1], "+"),
                        -1 => (SERIES[0], "\u{2212}"),
                        _ => (GRID, ""),
                    };
                    let filled =
                        if sign.is_empty() { colour.stroke_width(3) } else { colour.filled() };
                    chart.draw_series([Rectangle::new(corners, filled)])?;
                    let middle = (left + 0.42, top + 1.25);
                    chart.write(sign, middle, letters_around(PAPER))?;
                }
            }
        }
        Ok(())
    })
}
