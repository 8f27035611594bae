//! Deviations of rotation, velocity and position over time, from each source and from both.

use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::{ImuBias, ImuNoise};
use vislam::preintegration::{Deltas, Preintegrator};

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_right_of, marker};
use crate::preintegration::noise::growth::{G, crossovers, slope, sources};
use crate::preintegration::noise::runs::{DT, at_rest, errors, rest};
use crate::random::Random;

/// Numbers of readings after which runs are looked at; each source in turn has a mark.
const MARKS: [usize; 18] =
    [10, 14, 19, 26, 35, 48, 65, 89, 122, 166, 226, 309, 421, 575, 784, 1070, 1460, 1990];
const RUNS: usize = 300;
/// What the three quantities are called, with their unit, its size, and the range that is shown.
const QUANTITIES: [(&str, f64, f64, f64); 3] = [
    ("rotation (mrad)", 1e3, 0.4, 30.0),
    ("velocity (cm/s)", 1e2, 0.007, 150.0),
    ("position (cm)", 1e2, 1e-4, 600.0),
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

/// The places in [`MARKS`] at which a source is shown.
fn marks(source: usize) -> impl Iterator<Item = usize> {
    (source..MARKS.len()).step_by(3)
}

/// A source with its name, the formula as a curve and the scatter of runs.
struct Source {
    name: &'static str,
    noise: ImuNoise,
    curve: Vec<(f64, [f64; 3])>,
    scatter: Vec<[f64; 3]>,
}

fn computed() -> [Source; 3] {
    let mut seed = 470;
    sources(&ImuNoise::mems()).map(|(name, noise)| {
        seed += 1;
        let curve = (0..=24).map(|step| {
            let steps = (10.0 * 200_f64.powf(f64::from(step) / 24.0)).round();
            (steps * DT, at_rest(&noise, DT, steps as usize).sigmas())
        });
        Source { name, noise, curve: curve.collect(), scatter: scatter(&noise, seed) }
    })
}

pub fn growth() -> Figure {
    let sources = computed();
    let rows = sources.iter().enumerate().flat_map(|(index, source)| {
        marks(index).map(move |mark| {
            let steps = MARKS[mark];
            let mut row = vec![source.name.to_owned(), format!("{:.3}", steps as f64 * DT)];
            let formula = at_rest(&source.noise, DT, steps).sigmas();
            for (quantity, (_, unit, ..)) in QUANTITIES.iter().enumerate() {
                let scatter = unit * source.scatter[mark][quantity];
                row.extend([format!("{:.4}", unit * formula[quantity]), format!("{scatter:.4}")]);
            }
            row
        })
    });
    Figure {
        columns: vec![
            "source of noise",
            "time (s)",
            "rotation by the formula (mrad)",
            "rotation in runs (mrad)",
            "velocity by the formula (cm/s)",
            "velocity in runs (cm/s)",
            "position by the formula (cm)",
            "position in runs (cm)",
        ],
        rows: rows.collect(),
        svg: figure::draw(2020, |drawing| {
            let (rotation, rest) = drawing.split_vertically(520);
            let (velocity, position) = rest.split_vertically(700);
            panel(&rotation, &sources, 0, "")?;
            panel(&velocity, &sources, 1, "")?;
            panel(&position, &sources, 2, "time (s)")
        }),
    }
}

/// Where the names of the sources stand, for each quantity.
const NAMES: [[f64; 3]; 3] = [[11.0, 18.0, 1.0], [12.5, 70.0, 29.0], [17.0, 220.0, 61.0]];
const NAMES_FROM: f64 = 0.055;

fn panel(drawing: &Drawing, sources: &[Source; 3], quantity: usize, time: &str) -> Drawn {
    let (title, unit, low, high) = QUANTITIES[quantity];
    let x_axis = (time, (0.04..13.0).log_scale(), 4);
    let mut chart = figure::axes(drawing, x_axis, (title, (low..high).log_scale(), 5))?;
    let curve = |source: &Source| -> Vec<(f64, f64)> {
        source.curve.iter().map(|(t, sigmas)| (*t, unit * sigmas[quantity])).collect()
    };
    if quantity > 0 {
        let cross = crossovers(&ImuNoise::mems(), G)[quantity - 1];
        let steps = (cross / DT).round() as usize;
        let sigma = unit * at_rest(&ImuNoise::mems(), DT, steps).sigmas()[quantity];
        let line = [(cross, low), (cross, sigma)];
        chart.draw_series([PathElement::new(line, INK.stroke_width(3))])?;
        let place = (1.08 * cross, 2.2 * low);
        chart.draw_series([Text::new(format!("{cross:.2} s"), place, letters_right_of(INK))])?;
        // Below the others, and wide enough to be seen beside them.
        let both = LineSeries::new(curve(&sources[2]), SERIES[2].mix(0.35).stroke_width(18));
        chart.draw_series(both)?;
    } else {
        let place = (NAMES_FROM, NAMES[0][0]);
        let remark = Text::new("accelerometer: nothing", place, letters_right_of(INK));
        chart.draw_series([remark])?;
    }
    for (index, source) in sources.iter().enumerate() {
        if quantity == 0 && index != 1 {
            continue;
        }
        let colour = SERIES[index];
        if index < 2 {
            chart.draw_series(LineSeries::new(curve(source), colour.stroke_width(5)))?;
        }
        chart.draw_series(marks(index).map(|mark| {
            let place = (MARKS[mark] as f64 * DT, unit * source.scatter[mark][quantity]);
            EmptyElement::at(place) + marker(index)
        }))?;
        let place = (NAMES_FROM, NAMES[quantity][index]);
        chart.draw_series([EmptyElement::at(place) + marker(index)])?;
        let name = format!("{}: {}", source.name, exponent(source, quantity, index));
        let beside = (1.12 * place.0, place.1);
        chart.draw_series([Text::new(name, beside, letters_right_of(colour))])?;
    }
    Ok(())
}

/// The slope from one second on, where there is one.
fn exponent(source: &Source, quantity: usize, index: usize) -> String {
    if index == 2 {
        return "bends".to_owned();
    }
    let late = source.curve.iter().filter(|(t, _)| *t >= 1.0);
    let places: Vec<_> = late.map(|(t, sigmas)| (t.ln(), sigmas[quantity].ln())).collect();
    format!("slope {:.2}", slope(&places))
}
