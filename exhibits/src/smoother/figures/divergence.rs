//! What a window and a filter lose of the batch's knowledge, over the time that they take.

use plotters::chart::ChartBuilder;
use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Drawing, Drawn, Figure, SERIES, decimals, letters_around};
use crate::smoother::divergence::{CLONES, LAGS, recorded};

struct At {
    name: &'static str,
    size: String,
    time: f64,
    nats: f64,
    rmse: f64,
}

fn all() -> [Vec<At>; 2] {
    let at = |name, key: String, size: String| {
        let of = |what| recorded(&key, what);
        At { name, size, time: of("time"), nats: of("nats"), rmse: of("rmse") }
    };
    let lags = LAGS.iter().map(|lag| {
        at("smoother", format!("smoother_{lag}"), format!("{} s", 0.1 * f64::from(*lag)))
    });
    let clones =
        CLONES.iter().map(|clones| at("filter", format!("msckf_{clones}"), clones.to_string()));
    [lags.collect(), clones.collect()]
}

/// One of the numbers over the time. Labels stand above the marks, or by the series below them.
fn panel(
    drawing: &Drawing,
    curves: &[Vec<At>; 2],
    (y_title, of): (&str, fn(&At) -> f64),
    sides: [f64; 2],
) -> Drawn {
    let each = || curves.iter().flatten();
    let lowest = each().map(|at| at.time).fold(f64::INFINITY, f64::min);
    let slowest = each().map(|at| at.time).fold(0.0, f64::max);
    let most = each().map(of).fold(0.0, f64::max);
    let x_axis = ("time of a picture (ms)", (0.7 * lowest..1.5 * slowest).log_scale(), 5);
    let mut chart = figure::axes(drawing, x_axis, (y_title, 0.0..1.25 * most, 5))?;
    for (series, curve) in curves.iter().enumerate() {
        chart.line(curve.iter().map(|at| (at.time, of(at))), SERIES[series], 4)?;
        chart.marks(curve.iter().map(|at| (at.time, of(at))), series)?;
        for (number, at) in curve.iter().enumerate() {
            // Where points are close, every other label stands farther off.
            let height = if number % 2 == 1 { 0.15 } else { 0.07 };
            let place = (at.time, of(at) + sides[series] * height * most);
            chart.write(&at.size, place, letters_around(SERIES[series]))?;
        }
    }
    Ok(())
}

pub fn divergence() -> Figure {
    let curves = all();
    let each = || curves.iter().flatten();
    let columns = vec![
        ("estimator", each().map(|at| at.name.to_owned()).collect()),
        ("lag, or poses", each().map(|at| at.size.clone()).collect()),
        ("time of a picture (ms)", decimals(2, each().map(|at| at.time))),
        ("divergence (nats)", decimals(2, each().map(|at| at.nats))),
        ("RMSE of the position (cm)", decimals(2, each().map(|at| at.rmse))),
    ];
    Figure::new(1400, columns, |drawing| {
        let (keys, panels) = drawing.split_vertically(80);
        let mut chart =
            ChartBuilder::on(&keys).margin(10).build_cartesian_2d(0.0..1.0, 0.0..1.0)?;
        chart.key(0, "smoother, by its lag", (0.03, 0.5), 0.05)?;
        chart.key(1, "filter, by its poses", (0.5, 0.5), 0.52)?;
        let halves = panels.split_evenly((2, 1));
        panel(&halves[0], &curves, ("divergence (nats)", |at| at.nats), [1.0, 1.0])?;
        panel(&halves[1], &curves, ("RMSE (cm)", |at| at.rmse), [-1.0, 1.0])
    })
}
