//! Deviations of rotation, velocity and position over time, from each source and from both.

use plotters::coord::combinators::IntoLogRange;
use plotters::style::Color;
use vislam::inertial::{ImuBias, ImuNoise, ImuSample};
use vislam::preintegration::{Deltas, Preintegrator};

use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, geometric, letters_right_of,
};
use crate::inertial::rules::exponent;
use crate::preintegration::noise::growth::{G, crossovers, sources};
use crate::preintegration::noise::runs::{DT, at_rest, rest};
use crate::preintegration::oracle::{errors, parts};
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
fn deltas(readings: impl Iterator<Item = ImuSample>) -> Vec<Deltas> {
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
            for (square, part) in squares.iter_mut().zip(parts(&errors(clean, &run))) {
                *square += part.norm_squared();
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
        let curve = geometric(10.0, 200.0, 24).map(f64::round);
        let curve = curve.map(|n| (n * DT, at_rest(&noise, DT, n as usize).sigmas()));
        Source { name, noise, curve: curve.collect(), scatter: scatter(&noise, seed) }
    })
}

pub fn growth() -> Figure {
    let sources = computed();
    let each = || {
        let of = |(index, source)| marks(index).map(move |mark| (source, mark));
        sources.iter().enumerate().flat_map(of)
    };
    let time = |mark: usize| MARKS[mark] as f64 * DT;
    let formula = |quantity: usize| {
        let sigmas = each().map(|(of, mark)| at_rest(&of.noise, DT, MARKS[mark]).sigmas());
        decimals(4, sigmas.map(|sigmas| QUANTITIES[quantity].1 * sigmas[quantity]))
    };
    let in_runs = |quantity: usize| {
        let scatter = each().map(|(of, mark)| of.scatter[mark][quantity]);
        decimals(4, scatter.map(|scatter| QUANTITIES[quantity].1 * scatter))
    };
    let columns = vec![
        ("source of noise", each().map(|(of, _)| of.name.to_owned()).collect()),
        ("time (s)", decimals(3, each().map(|(_, mark)| time(mark)))),
        ("rotation by the formula (mrad)", formula(0)),
        ("rotation in runs (mrad)", in_runs(0)),
        ("velocity by the formula (cm/s)", formula(1)),
        ("velocity in runs (cm/s)", in_runs(1)),
        ("position by the formula (cm)", formula(2)),
        ("position in runs (cm)", in_runs(2)),
    ];
    Figure::new(2020, columns, |drawing| {
        let (rotation, rest) = drawing.split_vertically(520);
        let (velocity, position) = rest.split_vertically(700);
        panel(&rotation, &sources, 0, "")?;
        panel(&velocity, &sources, 1, "")?;
        panel(&position, &sources, 2, "time (s)")
    })
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
        chart.line([(cross, low), (cross, sigma)], INK, 3)?;
        let place = (1.08 * cross, 2.2 * low);
        chart.write(&format!("{cross:.2} s"), place, letters_right_of(INK))?;
        // Below the others, and wide enough to be seen beside them.
        chart.line(curve(&sources[2]), SERIES[2].mix(0.35), 18)?;
    } else {
        let place = (NAMES_FROM, NAMES[0][0]);
        chart.write("accelerometer: nothing", place, letters_right_of(INK))?;
    }
    for (index, source) in sources.iter().enumerate() {
        if quantity == 0 && index != 1 {
            continue;
        }
        if index < 2 {
            chart.line(curve(source), SERIES[index], 5)?;
        }
        let places = marks(index).map(|mark| (mark, unit * source.scatter[mark][quantity]));
        chart.marks(places.map(|(mark, scatter)| (MARKS[mark] as f64 * DT, scatter)), index)?;
        let name = format!("{}: {}", source.name, slope(source, quantity, index));
        let mark = (NAMES_FROM, NAMES[quantity][index]);
        chart.key(index, &name, mark, 1.12 * NAMES_FROM)?;
    }
    Ok(())
}

/// The slope from one second on, where there is one.
fn slope(source: &Source, quantity: usize, index: usize) -> String {
    if index == 2 {
        return "bends".to_owned();
    }
    let late = source.curve.iter().filter(|(t, _)| *t >= 1.0);
    let (times, sigmas): (Vec<_>, Vec<_>) = late.map(|(t, sigmas)| (*t, sigmas[quantity])).unzip();
    format!("slope {:.2}", exponent(&times, &sigmas))
}
