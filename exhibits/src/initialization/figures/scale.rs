//! The scale over the first five seconds from several starts, simulated and real.

use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_right_of};
use crate::initialization::flights::{FOLLOWED, TIMES};
use crate::initialization::real::{AFTER, SHOWN, accepted_value};
use crate::record::accepted;

/// Errors beyond are cut off, in percent.
const MOST: f64 = 15.0;

/// Error and standard deviation of the scale at a time, in percent.
#[derive(Clone, Copy)]
struct Point {
    seconds: f64,
    error: f64,
    sigma: f64,
}

type Curve = (String, Vec<Point>);

/// Those that were found.
fn found(points: impl Iterator<Item = Point>) -> Vec<Point> {
    points.filter(|point| point.sigma > 0.0).collect()
}

fn simulated() -> Vec<Curve> {
    let of = |number: u64, at: usize, what: &str| {
        accepted("initial_flights", &format!("followed_{number}_{at}_{what}"))
    };
    let curve = |number: u64| {
        let point = |(at, seconds)| Point {
            seconds,
            error: of(number, at, "error"),
            sigma: of(number, at, "sigma"),
        };
        (format!("simulated {}", number + 1), found(TIMES.into_iter().enumerate().map(point)))
    };
    (0..FOLLOWED).map(curve).collect()
}

fn real() -> Vec<Curve> {
    let of = |from: u32, seconds: u32, what: &str| {
        accepted_value(&format!("start_{from}_{seconds}_{what}"))
    };
    let curve = |from: u32| {
        let point = |seconds: u32| Point {
            seconds: f64::from(seconds),
            error: of(from, seconds, "error"),
            sigma: of(from, seconds, "sigma"),
        };
        (format!("from {from} s"), found(AFTER.into_iter().map(point)))
    };
    SHOWN.into_iter().map(curve).collect()
}

/// Bars of a standard deviation each way, a little beside each other.
fn panel(drawing: &Drawing, title: &str, curves: &[Curve]) -> Drawn {
    let y_axis = ("error (%)", -MOST..1.5 * MOST, 7);
    let mut chart = figure::axes(drawing, (title, 0.4..5.4, 6), y_axis)?;
    chart.line([(0.4, 0.0), (5.4, 0.0)], INK, 2)?;
    for (series, (name, points)) in curves.iter().enumerate() {
        let beside = 0.06 * (series as f64 - 1.5);
        let inside = |value: f64| value.clamp(-MOST, MOST);
        for Point { seconds, error, sigma } in points {
            let bar = [error - sigma, error + sigma].map(|end| (seconds + beside, inside(end)));
            chart.line(bar, SERIES[series], 5)?;
            if error.abs() < MOST {
                chart.marks([(seconds + beside, *error)], series)?;
            }
        }
        let (column, row) = ((series % 2) as f64, (series / 2) as f64);
        let at = (1.6 + 1.9 * column, (1.36 - 0.24 * row) * MOST);
        chart.key(series, name, at, at.0 + 0.12)?;
    }
    Ok(())
}

pub fn scale() -> Figure {
    let (simulated, real) = (simulated(), real());
    let each = || {
        simulated
            .iter()
            .chain(&real)
            .flat_map(|(name, points)| points.iter().map(move |point| (name, point)))
    };
    let columns = vec![
        ("start", each().map(|(name, _)| name.clone()).collect()),
        ("seconds after it (s)", decimals(1, each().map(|(_, point)| point.seconds))),
        ("error of the scale (%)", decimals(2, each().map(|(_, point)| point.error))),
        ("reported σ (%)", decimals(2, each().map(|(_, point)| point.sigma))),
    ];
    Figure::new(1400, columns, |drawing| {
        let halves = drawing.split_evenly((2, 1));
        panel(&halves[0], "", &simulated)?;
        panel(&halves[1], "seconds of pictures (s)", &real)?;
        let style = letters_right_of(INK);
        halves[0].draw(&plotters::element::Text::new("simulated", (185, 45), style.clone()))?;
        halves[1].draw(&plotters::element::Text::new("V1_01", (185, 45), style))?;
        Ok(())
    })
}
