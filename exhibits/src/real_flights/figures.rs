//! The figures of the section, from the accepted record.

use plotters::coord::combinators::{IntoLogRange, LogCoord};
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::style::{Color, RGBColor};
use vislam::inertial::ImuNoise;

use super::intervals::LENGTHS;
use super::live::faults;
use super::record::{ATTITUDE, LATER, LEICA, POSITION, SHARES, VELOCITY, accepted_value};
use crate::chapter::Chapter;
use crate::figure::{self, Chart, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("errors", flight_errors);
    chapter.figure("wander", flight_wander);
    chapter.figure("leica", flight_leica);
}

/// Values of the record for each length.
fn of(names: [&'static str; 4]) -> Vec<(f64, f64)> {
    LENGTHS.into_iter().zip(names.map(accepted_value)).collect()
}

type LogChart<'a> = Chart<'a, LogCoord<f64>, LogCoord<f64>>;

/// Marks of a series, or a line, with its name and where that stands, in shares of the panel.
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

/// A line with marks on it.
fn share(name: &'static str, series: usize, points: Vec<(f64, f64)>) -> Entry {
    Entry { width: 4, ..marks(name, series, points) }
}

fn unnamed(entry: Entry) -> Entry {
    Entry { name: "", ..entry }
}

fn line(name: &'static str, colour: RGBColor, width: u32, points: Vec<(f64, f64)>) -> Entry {
    Entry { name, points, marks: None, colour, width }
}

impl Entry {
    /// A line through points, if the entry has one.
    fn line(&self, chart: &mut LogChart, points: &[(f64, f64)]) -> Drawn {
        if self.width > 0 {
            let style = self.colour.stroke_width(self.width);
            chart.draw_series([PathElement::new(points, style)])?;
        }
        Ok(())
    }

    /// Marks at points, if the entry has some.
    fn marks(&self, chart: &mut LogChart, points: &[(f64, f64)]) -> Drawn {
        if let Some(series) = self.marks {
            let marks = points.iter().map(|at| EmptyElement::at(*at) + marker(series));
            chart.draw_series(marks)?;
        }
        Ok(())
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
        let sample: &[f64] = if entry.width > 0 { &[0.01, 0.04, 0.07] } else { &[0.04] };
        let sample: Vec<(f64, f64)> =
            sample.iter().map(|share| (at(times, *share), height)).collect();
        let middle = [sample[sample.len() / 2]];
        entry.line(&mut chart, &sample)?;
        entry.marks(&mut chart, &middle)?;
        let beside = (at(times, 0.10), height);
        chart.draw_series([Text::new(entry.name, beside, letters_right_of(entry.colour))])?;
    }
    for entry in entries {
        entry.line(&mut chart, &entry.points)?;
        entry.marks(&mut chart, &entry.points)?;
    }
    Ok(())
}

/// Errors of one flight, and what they are made of.
fn flight_errors() -> Figure {
    let kinds = [ATTITUDE, VELOCITY, POSITION];
    let rows = LENGTHS.into_iter().enumerate().map(|(index, seconds)| {
        let errors = kinds.iter().flatten().map(|names| accepted_value(names[index]));
        let mut row = vec![format!("{seconds}")];
        row.extend(errors.map(|error| format!("{error:.3}")));
        let shares = SHARES.iter().flatten().map(|names| accepted_value(names[index]));
        row.extend(shares.map(|share| format!("{share:.3}")));
        row
    });
    Figure {
        columns: vec![
            "length of the intervals (s)",
            "attitude by the Euler rule (mrad)",
            "by the midpoint rule (mrad)",
            "predicted (mrad)",
            "velocity by the Euler rule (cm/s)",
            "by the midpoint rule (cm/s)",
            "predicted (cm/s)",
            "position by the Euler rule (cm)",
            "by the midpoint rule (cm)",
            "predicted (cm)",
            "velocity: tilted world (cm/s)",
            "attitude (cm/s)",
            "rest (cm/s)",
            "position: tilted world (cm)",
            "attitude (cm)",
            "rest (cm)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1980, |drawing| {
            let (attitude, below) = drawing.split_vertically(660);
            let (velocity, position) = below.split_vertically(640);
            let wander = faults().attitude;
            let steps = (0..=30).map(|k| 0.1 * 20_f64.powf(f64::from(k) / 30.0));
            let wandering = steps.map(|t| (t, 1e3 * wander.spread(t).sqrt()));
            let common = |names: [[&'static str; 4]; 3]| {
                [
                    marks("Euler rule", 0, of(names[0])),
                    marks("midpoint rule", 1, of(names[1])),
                    line("predicted from the readings", INK, 6, of(names[2])),
                ]
            };
            let times = [0.08, 2.5];
            let [euler, midpoint, predicted] = common(ATTITUDE);
            let wandering = line("wander of the ground truth", SERIES[2], 5, wandering.collect());
            panel(
                &attitude,
                ("", times),
                ("attitude (mrad)", [0.05, 60.0]),
                &[euler, midpoint, wandering, predicted],
            )?;
            let shares = |part: usize| {
                [
                    share("tilted world", 3, of(SHARES[part][0])),
                    share("attitude", 4, of(SHARES[part][1])),
                    share("rest", 2, of(SHARES[part][2])),
                ]
            };
            let [euler, midpoint, predicted] = common(VELOCITY).map(unnamed);
            let [tilted, turned, rest] = shares(0);
            let entries = [tilted, turned, rest, predicted, euler, midpoint];
            panel(&velocity, ("", times), ("velocity (cm/s)", [0.015, 60.0]), &entries)?;
            let [euler, midpoint, predicted] = common(POSITION).map(unnamed);
            let [tilted, turned, rest] = shares(1).map(unnamed);
            let entries = [tilted, turned, rest, predicted, euler, midpoint];
            let x_axis = ("length of the intervals (s)", times);
            panel(&position, x_axis, ("position (cm)", [0.0004, 20.0]), &entries)
        }),
    }
}

/// The error of attitude from a twentieth of a second to a minute.
fn flight_wander() -> Figure {
    let early = of(ATTITUDE[1]);
    let later = LATER.map(|(seconds, name)| (seconds, accepted_value(name)));
    let mut seen = [early, later.to_vec()].concat();
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let wander = faults().attitude;
    let model = |t: f64| 1e3 * wander.spread(t).sqrt();
    let white = |t: f64| 1e3 * ImuNoise::euroc().gyro * (3.0 * t).sqrt();
    let rows = seen.iter().map(|(seconds, error)| {
        vec![
            format!("{seconds}"),
            format!("{error:.3}"),
            format!("{:.3}", model(*seconds)),
            format!("{:.3}", white(*seconds)),
        ]
    });
    Figure {
        columns: vec![
            "time (s)",
            "error of attitude (mrad)",
            "wander fitted to it (mrad)",
            "predicted from the readings (mrad)",
        ],
        rows: rows.collect(),
        svg: figure::draw(780, |drawing| {
            let steps = (0..=60).map(|k| 0.04 * 2000_f64.powf(f64::from(k) / 60.0));
            let curve = |f: &dyn Fn(f64) -> f64| steps.clone().map(|t| (t, f(t))).collect();
            let entries = [
                line("wander of the ground truth", SERIES[2], 5, curve(&model)),
                line("predicted from the readings", INK, 6, curve(&white)),
                marks("seen", 1, seen.clone()),
            ];
            let x_axis = ("length of the intervals (s)", [0.035, 100.0]);
            panel(drawing, x_axis, ("attitude (mrad)", [0.02, 60.0]), &entries)
        }),
    }
}

/// Velocity and position of both flights.
fn flight_leica() -> Figure {
    let rows = LENGTHS.into_iter().enumerate().map(|(index, seconds)| {
        let names = [LEICA[0], VELOCITY[1], VELOCITY[2], LEICA[1], POSITION[1], POSITION[2]];
        let values = names.map(|names| format!("{:.3}", accepted_value(names[index])));
        [vec![format!("{seconds}")], values.to_vec()].concat()
    });
    Figure {
        columns: vec![
            "length of the intervals (s)",
            "velocity in MH_05 (cm/s)",
            "in V1_01 (cm/s)",
            "predicted (cm/s)",
            "position in MH_05 (cm)",
            "in V1_01 (cm)",
            "predicted (cm)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1280, |drawing| {
            let (above, below) = drawing.split_vertically(620);
            let entries = |part: usize| {
                let first = [VELOCITY, POSITION][part];
                [
                    marks("MH_05, laser tracker", 3, of(LEICA[part])),
                    marks("V1_01, motion capture", 1, of(first[1])),
                    line("predicted from the readings", INK, 6, of(first[2])),
                ]
            };
            let times = [0.08, 2.5];
            panel(&above, ("", times), ("velocity (cm/s)", [0.06, 60.0]), &entries(0))?;
            let x_axis = ("length of the intervals (s)", times);
            panel(&below, x_axis, ("position (cm)", [0.003, 100.0]), &entries(1))
        }),
    }
}
