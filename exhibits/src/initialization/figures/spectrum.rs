//! Singular values of the linear equations as a motion goes on, for four motions.

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_right_of, powers};
use crate::initialization::motions::{equations, motions};
use vislam::simulation::Trajectory;

const LEAST: f64 = 1e-8;

fn seconds() -> impl Iterator<Item = f64> + Clone {
    (5..=50).map(|tenth| 0.1 * f64::from(tenth))
}

/// Ten values at each time, descending. What is lost to rounding stands at the lower edge.
fn spectra(motion: Trajectory) -> Vec<Vec<f64>> {
    let of = |seconds| {
        let spectrum = equations(motion, seconds).spectrum();
        spectrum.iter().map(|value| value.max(LEAST)).collect()
    };
    seconds().map(of).collect()
}

/// Three motions whose scale is open beside one whose scale is not.
fn shown() -> [(&'static str, Trajectory); 4] {
    let [eight, rising, _, straight] = motions();
    [eight, rising, ("level turn", Trajectory::level_turn(1.0, 0.5)), straight]
}

pub fn spectrum() -> Figure {
    let spectra = shown().map(|(name, motion)| (name, spectra(motion)));
    // The table has every fourth of the times.
    let each = || {
        spectra
            .iter()
            .flat_map(|(name, of)| seconds().zip(of).step_by(4).map(move |at| (*name, at)))
    };
    let names = each().map(|(name, _)| name.replace(',', ";"));
    let value = |which: usize| powers(1, each().map(move |(_, (_, of))| of[which]));
    let columns = vec![
        ("motion", names.collect()),
        ("time (s)", decimals(1, each().map(|(_, (time, _))| time))),
        ("greatest", value(0)),
        ("third", value(2)),
        ("fifth", value(4)),
        ("seventh", value(6)),
        ("ninth", value(8)),
        ("least", value(9)),
    ];
    Figure::new(1900, columns, |drawing| {
        for (panel, (name, spectra)) in drawing.split_evenly((4, 1)).iter().zip(&spectra) {
            let x_title = if *name == "constant velocity" { "time (s)" } else { "" };
            let y_axis = ("log\u{2081}\u{2080}", LEAST.log10() - 0.6..1.9, 5);
            let mut chart = figure::axes(panel, (x_title, 0.4..5.05, 6), y_axis)?;
            for which in 0..10 {
                let points = seconds().zip(spectra).map(|(time, of)| (time, of[which].log10()));
                if which < 9 {
                    chart.line(points, INK, 2)?;
                } else {
                    let points: Vec<_> = points.collect();
                    chart.line(points.iter().copied(), SERIES[1], 5)?;
                    chart.marks(points.into_iter().step_by(5), 1)?;
                }
            }
            chart.write(name, (0.5, 1.2), letters_right_of(INK))?;
            chart.write("least of ten", (3.9, 1.2), letters_right_of(SERIES[1]))?;
        }
        Ok(())
    })
}
