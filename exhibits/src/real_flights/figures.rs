//! The figures of the section, from the accepted record.

use plotters::coord::combinators::IntoLogRange;
use plotters::style::RGBColor;
use vislam::inertial::ImuNoise;

use super::intervals::LENGTHS;
use super::live::faults;
use super::record::{LATER, accepted_value};
use crate::chapter::Chapter;
use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, geometric, letters_right_of, plain,
};

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("errors", flight_errors);
    chapter.figure("wander", flight_wander);
    chapter.figure("leica", flight_leica);
}

/// The value of the record for each length.
fn of(name: &str) -> Vec<(f64, f64)> {
    let value = |index: usize| (LENGTHS[index], accepted_value(&format!("{name}_{index}")));
    (0..LENGTHS.len()).map(value).collect()
}

/// The same as cells.
fn cells(name: &str) -> Vec<String> {
    decimals(3, of(name).into_iter().map(|(_, value)| value))
}

/// A line through points, marks at them or both, and their name if they have one.
struct Entry {
    name: &'static str,
    points: Vec<(f64, f64)>,
    marks: Option<usize>,
    colour: RGBColor,
    width: u32,
}

fn marks(name: &'static str, series: usize, points: Vec<(f64, f64)>) -> Entry {
    Entry { name, points, marks: Some(series), colour: SERIES[series], width: 0 }
}

fn line(name: &'static str, colour: RGBColor, width: u32, points: Vec<(f64, f64)>) -> Entry {
    Entry { name, points, marks: None, colour, width }
}

impl Entry {
    fn draw(&self, chart: &mut impl Draw, line: &[(f64, f64)], marks: &[(f64, f64)]) -> Drawn {
        if self.width > 0 {
            chart.line(line.iter().copied(), self.colour, self.width)?;
        }
        self.marks.map_or(Ok(()), |series| chart.marks(marks.iter().copied(), series))
    }
}

/// Logarithmic axes with entries; their names stand in a column at the upper left.
fn panel(
    drawing: &Drawing,
    (x_title, times): (&str, [f64; 2]),
    (y_title, values): (&str, [f64; 2]),
    entries: &[Entry],
) -> Drawn {
    let x_axis = (x_title, (times[0]..times[1]).log_scale(), 6);
    let y_axis = (y_title, (values[0]..values[1]).log_scale(), 5);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    let at = |range: [f64; 2], share: f64| range[0] * (range[1] / range[0]).powf(share);
    for (row, entry) in entries.iter().filter(|entry| !entry.name.is_empty()).enumerate() {
        let height = at(values, 0.94 - 0.095 * row as f64);
        let sample = [0.01, 0.04, 0.07].map(|share| (at(times, share), height));
        entry.draw(&mut chart, &sample, &sample[1..2])?;
        chart.write(entry.name, (at(times, 0.10), height), letters_right_of(entry.colour))?;
    }
    entries.iter().try_for_each(|entry| entry.draw(&mut chart, &entry.points, &entry.points))
}

const LENGTH: &str = "length of the intervals (s)";
/// Seconds that are shown where the lengths are those of the record.
const SHOWN: [f64; 2] = [0.08, 2.5];

/// Errors of one flight, and what they are made of.
fn flight_errors() -> Figure {
    let columns = vec![
        (LENGTH, plain(LENGTHS)),
        ("attitude by the Euler rule (mrad)", cells("v1_attitude_euler")),
        ("by the midpoint rule (mrad)", cells("v1_attitude")),
        ("predicted (mrad)", cells("v1_attitude_predicted")),
        ("velocity by the Euler rule (cm/s)", cells("v1_velocity_euler")),
        ("by the midpoint rule (cm/s)", cells("v1_velocity")),
        ("predicted (cm/s)", cells("v1_velocity_predicted")),
        ("position by the Euler rule (cm)", cells("v1_position_euler")),
        ("by the midpoint rule (cm)", cells("v1_position")),
        ("predicted (cm)", cells("v1_position_predicted")),
        ("velocity: tilted world (cm/s)", cells("v1_velocity_gravity")),
        ("attitude (cm/s)", cells("v1_velocity_attitude")),
        ("rest (cm/s)", cells("v1_velocity_rest")),
        ("position: tilted world (cm)", cells("v1_position_gravity")),
        ("attitude (cm)", cells("v1_position_attitude")),
        ("rest (cm)", cells("v1_position_rest")),
    ];
    Figure::new(1980, columns, |drawing| {
        let (attitude, below) = drawing.split_vertically(660);
        let (velocity, position) = below.split_vertically(640);
        let wander = faults().attitude;
        let wandering = geometric(0.1, 20.0, 30).map(|t| (t, 1e3 * wander.spread(t).sqrt()));
        let entries = [
            marks("Euler rule", 0, of("v1_attitude_euler")),
            marks("midpoint rule", 1, of("v1_attitude")),
            line("wander of the ground truth", SERIES[2], 5, wandering.collect()),
            line("predicted from the readings", INK, 6, of("v1_attitude_predicted")),
        ];
        panel(&attitude, ("", SHOWN), ("attitude (mrad)", [0.05, 60.0]), &entries)?;
        let share = |name: &'static str, series: usize, points| Entry {
            width: 4,
            ..marks(name, series, points)
        };
        let entries = |part: &str| {
            let of = |kind: &str| of(&format!("v1_{part}{kind}"));
            [
                share("tilted world", 3, of("_gravity")),
                share("attitude", 4, of("_attitude")),
                share("rest", 2, of("_rest")),
                line("", INK, 6, of("_predicted")),
                marks("", 0, of("_euler")),
                marks("", 1, of("")),
            ]
        };
        let velocity_axis = ("velocity (cm/s)", [0.015, 60.0]);
        panel(&velocity, ("", SHOWN), velocity_axis, &entries("velocity"))?;
        let unnamed = entries("position").map(|entry| Entry { name: "", ..entry });
        panel(&position, (LENGTH, SHOWN), ("position (cm)", [0.0004, 20.0]), &unnamed)
    })
}

/// The error of attitude from a twentieth of a second to a minute.
fn flight_wander() -> Figure {
    let later = LATER.map(|(seconds, name)| (seconds, accepted_value(name)));
    let mut seen = [of("v1_attitude"), later.to_vec()].concat();
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let wander = faults().attitude;
    let model = |t: f64| 1e3 * wander.spread(t).sqrt();
    let white = |t: f64| 1e3 * ImuNoise::euroc().gyro * (3.0 * t).sqrt();
    let columns = vec![
        ("time (s)", seen.iter().map(|(t, _)| format!("{t}")).collect()),
        ("error of attitude (mrad)", decimals(3, seen.iter().map(|(_, error)| *error))),
        ("wander fitted to it (mrad)", decimals(3, seen.iter().map(|(t, _)| model(*t)))),
        ("predicted from the readings (mrad)", decimals(3, seen.iter().map(|(t, _)| white(*t)))),
    ];
    let times = geometric(0.04, 2000.0, 60);
    let entries = [
        line(
            "wander of the ground truth",
            SERIES[2],
            5,
            times.clone().map(|t| (t, model(t))).collect(),
        ),
        line("predicted from the readings", INK, 6, times.map(|t| (t, white(t))).collect()),
        marks("seen", 1, seen),
    ];
    Figure::new(780, columns, |drawing| {
        panel(drawing, (LENGTH, [0.035, 100.0]), ("attitude (mrad)", [0.02, 60.0]), &entries)
    })
}

/// Velocity and position of both flights.
fn flight_leica() -> Figure {
    let columns = vec![
        (LENGTH, plain(LENGTHS)),
        ("velocity in MH_05 (cm/s)", cells("mh_velocity")),
        ("in V1_01 (cm/s)", cells("v1_velocity")),
        ("predicted (cm/s)", cells("v1_velocity_predicted")),
        ("position in MH_05 (cm)", cells("mh_position")),
        ("in V1_01 (cm)", cells("v1_position")),
        ("predicted (cm)", cells("v1_position_predicted")),
    ];
    let entries = |part: &str| {
        [
            marks("MH_05, laser tracker", 3, of(&format!("mh_{part}"))),
            marks("V1_01, motion capture", 1, of(&format!("v1_{part}"))),
            line("predicted from the readings", INK, 6, of(&format!("v1_{part}_predicted"))),
        ]
    };
    Figure::new(1280, columns, |drawing| {
        let (above, below) = drawing.split_vertically(620);
        let velocity = ("velocity (cm/s)", [0.06, 60.0]);
        panel(&above, ("", SHOWN), velocity, &entries("velocity"))?;
        let position = ("position (cm)", [0.003, 100.0]);
        panel(&below, (LENGTH, SHOWN), position, &entries("position"))
    })
}
