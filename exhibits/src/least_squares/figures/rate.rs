//! How fast Gauss-Newton arrives when measurements contradict each other more and more.

use crate::figure::{self, Draw, Figure, SERIES, letters_right_of, powers};
use crate::least_squares::worked::{self, GUESS, contradicting};

/// By which the contradictions of the garden are multiplied.
const FACTORS: [f64; 4] = [0.0, 1.0, 10.0, 30.0];
const STEPS: usize = 12;
/// Distances below this many metres are rounding.
const ROUNDING: f64 = 1e-14;

/// Distances of the iterates from the estimate, in metres.
fn distances(factor: f64) -> Vec<f64> {
    let tapes = contradicting(factor);
    let estimate = worked::estimate(&worked::garden());
    let mut spot = GUESS;
    let mut distances = Vec::new();
    for _ in 0..=STEPS {
        let distance = (spot - estimate).norm();
        if distance < ROUNDING {
            break;
        }
        distances.push(distance);
        spot = worked::stepped(&tapes, &spot);
    }
    distances
}

/// What the theorem says of the distances, from the third iterate on.
fn by_theorem(factor: f64, distances: &[f64]) -> Vec<(f64, f64)> {
    let estimate = worked::estimate(&worked::garden());
    let rate = worked::rate(&contradicting(factor), &estimate);
    let later = (2..distances.len().max(2)).map(|step| {
        let distance = distances[2] * rate.powi(step as i32 - 2);
        (step as f64, distance.log10())
    });
    later.filter(|place| place.1 > ROUNDING.log10()).collect()
}

pub fn rate() -> Figure {
    let series = FACTORS.map(distances);
    let cells = |of: usize| {
        let mut cells = powers(1, series[of].iter().copied());
        cells.resize(STEPS + 1, "below 1e-14".to_owned());
        cells
    };
    let columns = vec![
        ("iteration", (0..=STEPS).map(|step| step.to_string()).collect()),
        ("without contradictions (m)", cells(0)),
        ("as measured (m)", cells(1)),
        ("10 times (m)", cells(2)),
        ("30 times (m)", cells(3)),
    ];
    Figure::new(820, columns, |drawing| {
        let x_axis = ("iteration", -0.3..14.2, 8);
        let y_axis = ("log\u{2081}\u{2080} of distance (m)", -14.5..0.5, 6);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, (factor, distances)) in FACTORS.into_iter().zip(&series).enumerate() {
            if factor > 0.0 {
                chart.line(by_theorem(factor, distances), SERIES[index], 4)?;
            }
            let places = distances.iter().enumerate();
            let mut places = places.map(|(step, distance)| (step as f64, distance.log10()));
            chart.marks(places.clone(), index)?;
            let (last, height) = places.next_back().unwrap_or((0.0, 0.0));
            let (name, beside) = if factor == 0.0 {
                ("none".to_owned(), (last - 1.5, height - 1.0))
            } else {
                (format!("{factor} \u{d7}"), (last + 0.4, height))
            };
            chart.write(&name, beside, letters_right_of(SERIES[index]))?;
        }
        Ok(())
    })
}
