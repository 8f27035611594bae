//! Deviations of rotation, velocity and position over time, from each source and from both.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::{ImuBias, ImuNoise};
use vislam::preintegration::{Deltas, Preintegrator};

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};
use crate::preintegration::noise::growth::{slope, sources};
use crate::preintegration::noise::runs::{DT, at_rest, errors, rest};
use crate::random::Random;

/// Numbers of readings after which runs are looked at.
const MARKS: [usize; 9] = [6, 13, 28, 60, 120, 240, 480, 960, 2000];
const RUNS: usize = 300;
/// What the three quantities are called, with their unit, its size, and the range that is shown.
const QUANTITIES: [(&str, f64, f64, f64); 3] = [
    ("rotation (mrad)", 1e3, 0.2, 30.0),
    ("velocity (cm/s)", 1e2, 0.04, 150.0),
    ("position (cm)", 1e2, 4e-4, 600.0),
];

/// The deltas after each of the marks.
fn deltas(readings: impl Iterator<Item = vislam::inertial::ImuSample>) -> Vec<Deltas> {
    let mut integrator = Preintegrator::new(&ImuBias::default(), &ImuNoise::mems())
        .expect("the densities are those of a sensor");
    let mut found = Vec::new();
    for (index, reading) in readings.enumerate() {
        integrator.integrate(&reading, DT).expect("the reading is finite");
        if MARKS.contains(&(index + 1)) {
            found.push(integrator.finish().expect("there is a step").deltas);
        }
    }
    found
}

/// Root mean square errors over runs and axes: for each mark those of the three quantities.
fn scatter(noise: &ImuNoise, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed);
    let last = MARKS[MARKS.len() - 1];
    let clean = deltas((0..last).map(|_| rest()));
    let mut squares = vec![[0.0; 3]; MARKS.len()];
    for _ in 0..RUNS {
        let bias = ImuBias::default();
        let noisy = (0..last).map(|_| noise.corrupt(&rest(), &bias, DT, || random.normal(1.0)));
        for ((squares, run), clean) in squares.iter_mut().zip(deltas(noisy)).zip(&clean) {
            let error = errors(clean, &run);
            for (quantity, square) in squares.iter_mut().enumerate() {
                *square += error.fixed_rows::<3>(3 * quantity).norm_squared();
            }
        }
    }
    let root = |square: f64| (square / (3.0 * RUNS as f64)).sqrt();
    squares.into_iter().map(|of| of.map(root)).collect()
}

/// A source with its name, the formula as a curve and the scatter of runs.
struct Source {
    name: &'static str,
    curve: Vec<(f64, [f64; 3])>,
    scatter: Vec<[f64; 3]>,
}

fn computed() -> [Source; 3] {
    let mut seed = 470;
    sources(&ImuNoise::mems()).map(|(name, noise)| {
        seed += 1;
        let curve = (0..=24).map(|step| {
            let steps = (4.0 * 500_f64.powf(f64::from(step) / 24.0)).round();
            (steps * DT, at_rest(&noise, DT, steps as usize).sigmas())
        });
        Source { name, curve: curve.collect(), scatter: scatter(&noise, seed) }
    })
}

pub fn growth() -> Figure {
    let sources = computed();
    let rows = MARKS.iter().enumerate().flat_map(|(mark, steps)| {
        sources.iter().map(move |source| {
            let time = *steps as f64 * DT;
            let mut row = vec![format!("{time:.3}"), source.name.to_owned()];
            let (_, formula) = nearest(&source.curve, time);
            for (quantity, (_, unit, ..)) in QUANTITIES.iter().enumerate() {
                let scatter = unit * source.scatter[mark][quantity];
                row.extend([format!("{:.4}", unit * formula[quantity]), format!("{scatter:.4}")]);
            }
            row
        })
    });
    Figure {
        columns: vec![
            "time (s)",
            "source of noise",
            "rotation by the formula (mrad)",
            "rotation in runs (mrad)",
            "velocity by the formula (cm/s)",
            "velocity in runs (cm/s)",
            "position by the formula (cm)",
            "position in runs (cm)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1760, |drawing| {
            let (rotation, rest) = drawing.split_vertically(540);
            let (velocity, position) = rest.split_vertically(560);
            panel(&rotation, &sources, 0, "")?;
            panel(&velocity, &sources, 1, "")?;
            panel(&position, &sources, 2, "time (s)")
        }),
    }
}

/// The formula at a time, on the straight line between places of the curve, as logarithms.
fn nearest(curve: &[(f64, [f64; 3])], time: f64) -> (f64, [f64; 3]) {
    let after = curve.partition_point(|(at, _)| *at < time).clamp(1, curve.len() - 1);
    let ((t0, a), (t1, b)) = (curve[after - 1], curve[after]);
    let part = (time / t0).ln() / (t1 / t0).ln();
    let between = |k: usize| if a[k] == 0.0 { 0.0 } else { a[k] * (b[k] / a[k]).powf(part) };
    (time, [0, 1, 2].map(between))
}

/// Where the name of a source stands, for each quantity.
const NAMES: [[(f64, f64); 3]; 3] = [
    [(0.025, 3.2), (0.025, 16.0), (0.025, 7.2)],
    [(0.025, 12.0), (0.025, 75.0), (0.025, 30.0)],
    [(0.025, 15.0), (0.025, 250.0), (0.025, 60.0)],
];

fn panel(drawing: &Drawing, sources: &[Source; 3], quantity: usize, time: &str) -> Drawn {
    let (title, unit, low, high) = QUANTITIES[quantity];
    let x_axis = (time, (0.017..13.0).log_scale(), 4);
    let mut chart = figure::axes(drawing, x_axis, (title, (low..high).log_scale(), 5))?;
    for (index, source) in sources.iter().enumerate() {
        if source.curve[0].1[quantity] == 0.0 || (quantity == 0 && index == 2) {
            continue;
        }
        let colour = SERIES[index];
        let curve = source.curve.iter().map(|(t, sigmas)| (*t, unit * sigmas[quantity]));
        chart.draw_series(LineSeries::new(curve, colour.stroke_width(5)))?;
        let marks = MARKS.iter().zip(&source.scatter);
        chart.draw_series(marks.map(|(steps, scatter)| {
            EmptyElement::at((*steps as f64 * DT, unit * scatter[quantity])) + marker(index)
        }))?;
        let place = NAMES[quantity][index];
        chart.draw_series([EmptyElement::at(place) + marker(index)])?;
        let name = format!("{}: {}", source.name, exponent(source, quantity, index));
        let beside = (1.15 * place.0, place.1);
        chart.draw_series([Text::new(name, beside, letters_right_of(colour))])?;
    }
    if quantity == 0 {
        let place = NAMES[0][2];
        let remark = Text::new("accelerometer: none", place, letters_right_of(INK));
        chart.draw_series([remark])?;
    }
    Ok(())
}

/// The slope of the last decade, where there is one.
fn exponent(source: &Source, quantity: usize, index: usize) -> String {
    if index == 2 {
        return "bends".to_owned();
    }
    let late = source.curve.iter().filter(|(t, _)| *t >= 1.0);
    let places: Vec<_> = late.map(|(t, sigmas)| (t.ln(), sigmas[quantity].ln())).collect();
    format!("slope {:.2}", slope(&places))
}
