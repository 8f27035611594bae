//! In which cells the standard filter's yaw leaves its band, and what the policies cost in accuracy there.

use plotters::chart::ChartBuilder;
use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::consistency::Policy;

use crate::consistency::map::{Cell, PIXELS, SENSORS, STARTS, band};
use crate::figure::{
    Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_around, letters_around_of,
    letters_right_of,
};

/// What is drawn of each cell: the title, the series, the policy, and what of it.
const SHOWN: [([&str; 2], usize, Policy, &str); 4] = [
    (["standard", "NEES"], 0, Policy::Standard, "yaw"),
    (["standard", "error"], 0, Policy::Standard, "error"),
    (["first est.", "error"], 1, Policy::FirstEstimates, "error"),
    (["right-inv.", "error"], 3, Policy::RightInvariant, "error"),
];
/// An error that is larger than that of the filter that knows the truth by more than this part is
/// dark.
const WORSE: f64 = 0.05;
/// Where the cells begin, behind what is said of their row.
const LEFT: f64 = -5.5;
/// Between the fields of what is shown and those of what is shown next.
const GAP: f64 = 0.35;
/// Height of the numbers in the fields, of which the longest has three digits.
const NUMBERS: f64 = 32.0;

/// A sensor: a row for each number of kept landmarks, length of tracks and window, and in it for each
/// thing that is shown a field for each noise of the pixels.
fn panel(drawing: &Drawing, (sensor, start): (&str, &str)) -> Drawn {
    let cells: Vec<Cell> = shown(start).filter(|cell| cell.sensor == sensor).collect();
    let rows = cells.len() / PIXELS.len();
    let group = PIXELS.len() as f64 + GAP;
    let (width, above) = (SHOWN.len() as f64 * group, rows as f64);
    let mut chart =
        ChartBuilder::on(drawing).margin(10).build_cartesian_2d(LEFT..width, -0.3..above + 3.2)?;
    chart.write(sensor, (LEFT, above + 2.6), letters_right_of(INK))?;
    for (at, head) in ["kept", "track", "poses"].into_iter().enumerate() {
        chart.write(head, (LEFT + 0.85 + 1.75 * at as f64, above + 0.5), letters_around(INK))?;
    }
    for (number, (titles, series, ..)) in SHOWN.iter().enumerate() {
        let middle = group * number as f64 + 1.5;
        chart.write(titles[0], (middle, above + 2.6), letters_around(SERIES[*series]))?;
        chart.write(titles[1], (middle, above + 1.6), letters_around(INK))?;
        for (at, pixels) in PIXELS.iter().enumerate() {
            let place = (group * number as f64 + at as f64 + 0.5, above + 0.5);
            chart.write(pixels, place, letters_around(INK))?;
        }
    }
    for (number, cell) in cells.iter().enumerate() {
        let (row, column) = ((rows - 1 - number / PIXELS.len()) as f64, number % PIXELS.len());
        if column == 0 {
            let of_row = [cell.kept.to_string(), cell.track(), cell.clones.to_string()];
            for (at, text) in of_row.iter().enumerate() {
                let place = (LEFT + 0.85 + 1.75 * at as f64, row + 0.5);
                chart.write(text, place, letters_around(INK))?;
            }
        }
        for (shown, (_, series, policy, what)) in SHOWN.iter().enumerate() {
            let left = group * shown as f64 + column as f64;
            let value = cell.recorded(*policy, what);
            let (is_bad, text) = if *what == "yaw" {
                let digits = usize::from(value < 9.95);
                (!band().contains(value), format!("{value:.digits$}"))
            } else {
                let percent = (100.0 * (value - 1.0)).round() as i64;
                (value > 1.0 + WORSE, percent.to_string().replace('-', "−"))
            };
            let corners = [(left + 0.03, row + 0.06), (left + 0.97, row + 0.94)];
            let shade = SERIES[*series].mix(if is_bad { 0.55 } else { 0.12 });
            chart.draw_series([Rectangle::new(corners, shade.filled())])?;
            chart.write(&text, (left + 0.5, row + 0.5), letters_around_of(NUMBERS, INK))?;
        }
    }
    Ok(())
}

/// The cells of a start, each once.
fn shown(start: &str) -> impl Iterator<Item = Cell> {
    let is_shown = move |cell: &Cell| cell.start.0 == start && cell.twin().is_none();
    Cell::all().into_iter().filter(is_shown)
}

pub fn estimated() -> Figure {
    of_start(STARTS[0].0)
}

pub fn perfect() -> Figure {
    of_start(STARTS[1].0)
}

fn of_start(start: &'static str) -> Figure {
    let cells: Vec<Cell> = shown(start).collect();
    let text = |of: fn(&Cell) -> String| cells.iter().map(of).collect::<Vec<String>>();
    let value = |policy: Policy, what: &str| {
        decimals(2, cells.iter().map(|cell| cell.recorded(policy, what)))
    };
    let columns = vec![
        ("sensor", text(|cell| cell.sensor.to_owned())),
        ("kept", text(|cell| cell.kept.to_string())),
        ("tracks", text(|cell| cell.track())),
        ("poses", text(|cell| cell.clones.to_string())),
        ("pixels (px)", text(|cell| cell.pixels.to_owned())),
        ("NEES of yaw: standard", value(Policy::Standard, "yaw")),
        ("first estimates", value(Policy::FirstEstimates, "yaw")),
        ("FEJ2", value(Policy::Fej2, "yaw")),
        ("constrained", value(Policy::ObservabilityConstrained, "yaw")),
        ("right-invariant", value(Policy::RightInvariant, "yaw")),
        ("robocentric", value(Policy::Robocentric, "yaw")),
        ("ideal", value(Policy::Ideal, "yaw")),
        ("error over ideal’s: standard", value(Policy::Standard, "error")),
        ("first estimates", value(Policy::FirstEstimates, "error")),
        ("FEJ2", value(Policy::Fej2, "error")),
        ("constrained", value(Policy::ObservabilityConstrained, "error")),
        ("right-invariant", value(Policy::RightInvariant, "error")),
        ("robocentric", value(Policy::Robocentric, "error")),
    ];
    Figure::new(1160, columns, |drawing| {
        let halves = drawing.split_evenly((2, 1));
        panel(&halves[0], (SENSORS[0], start))?;
        panel(&halves[1], (SENSORS[1], start))
    })
}
