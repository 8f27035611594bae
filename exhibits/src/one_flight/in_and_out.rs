//! What goes into an estimate of the flight and what comes out, side by side.

use std::ops::Range;

use plotters::chart::ChartBuilder;
use plotters::element::Rectangle;
use plotters::style::Color;
use vislam::inertial::StampedSample;

use super::followed::{DRAWN, ENLARGED, EVERY, last_known};
use super::from_above::{At, ellipse, is_inside};
use super::{SECONDS, path, picture_at, recording};
use crate::figure::{Chart, Draw, Drawing, Drawn, Figure, INK, SERIES, letters_around};

/// How long the tracks and the readings are that are drawn, in seconds.
const TRACKED: f64 = 0.5;
const READ: f64 = 5.0;
/// Every so manieth reading is drawn.
const THINNED: usize = 20;
/// The forces that the panel reaches over, in m/s².
const FORCES: [f64; 2] = [-6.0, 15.0];
/// Half of what the map shows, in metres, across.
const REACH: f64 = 6.8;

/// Pixels, readings, and what an odometry makes of them.
pub fn in_and_out() -> Figure {
    let (tracks, forces) = (tracks(), forces());
    let figure = Figure::new(460, vec![], |drawing| {
        let panels = drawing.split_evenly((1, 3));
        pixels(&panels[0], &tracks)?;
        readings(&panels[1], &forces)?;
        map(&panels[2])
    });
    let columns =
        vec!["what is drawn", "u (px), time (s) or x (m)", "v (px), force (m/s²) or y (m)"];
    Figure { columns, rows: rows(&tracks, &forces), ..figure }
}

/// The newest pixels, some of the readings, and what came of them.
fn rows(tracks: &[Vec<At>], forces: &[Vec<At>; 3]) -> Vec<Vec<String>> {
    let row = |name: &str, (x, y): At| vec![name.to_owned(), format!("{x:.2}"), format!("{y:.2}")];
    let newest = tracks.iter().step_by(2).filter_map(|track| Some(row("pixel", *track.last()?)));
    let axes = ["force ahead", "force to the left", "force up"].into_iter().zip(forces);
    let read = axes.flat_map(|(name, line)| line.iter().step_by(10).map(move |at| row(name, *at)));
    let (places, points) = last_known();
    let known = places.iter().step_by(EVERY).map(|(at, _)| row("trajectory", (at.x, at.y)));
    let every = points.len().div_ceil(10).max(1);
    let mapped = points.iter().step_by(every).map(|at| row("landmark", (at.x, at.y)));
    newest.chain(read).chain(known).chain(mapped).collect()
}

/// The last pixels of every track of the last picture.
fn tracks() -> Vec<Vec<At>> {
    let last = picture_at(SECONDS);
    let pictures = &recording().pictures[last - picture_at(TRACKED)..=last];
    let of = |track: usize| {
        let seen = pictures.iter().flat_map(|picture| &picture.features);
        let own = seen.filter(|feature| feature.track == track);
        own.map(|feature| (feature.pixel.x, feature.pixel.y)).collect()
    };
    recording().pictures[last].features.iter().map(|feature| of(feature.track)).collect()
}

/// The last readings of the accelerometer, along each axis of the body.
fn forces() -> [Vec<At>; 3] {
    let from = 1e9 * (SECONDS - READ);
    let last = recording().readings.iter().filter(|reading| reading.nanoseconds as f64 >= from);
    let last: Vec<_> = last.step_by(THINNED).collect();
    [0, 1, 2].map(|axis| {
        let of = |reading: &&StampedSample| {
            (1e-9 * reading.nanoseconds as f64, reading.sample.accelerometer[axis])
        };
        last.iter().map(of).collect()
    })
}

/// A panel with a name above and a frame of four by three below.
fn framed(
    panel: &Drawing,
    name: &str,
    paint: impl FnOnce(&mut Chart<'_, Range<f64>, Range<f64>>) -> Drawn,
) -> Drawn {
    let mut chart = ChartBuilder::on(panel).margin(8).build_cartesian_2d(-0.03..4.03, -0.1..4.1)?;
    chart.write(name, (2.0, 3.7), letters_around(INK))?;
    chart.draw_series([Rectangle::new([(0.0, 0.0), (4.0, 3.0)], INK.mix(0.5).stroke_width(2))])?;
    paint(&mut chart)
}

fn pixels(panel: &Drawing, tracks: &[Vec<At>]) -> Drawn {
    framed(panel, "pixels", |chart| {
        let place = |(u, v): &At| (u / 160.0, 3.0 - v / 160.0);
        for track in tracks {
            chart.line(track.iter().map(place), INK.mix(0.5), 3)?;
            chart.dots(track.last().map(place), 6, SERIES[1])?;
        }
        Ok(())
    })
}

fn readings(panel: &Drawing, forces: &[Vec<At>; 3]) -> Drawn {
    framed(panel, "readings", |chart| {
        for (axis, line) in forces.iter().enumerate() {
            let place = |(t, force): &At| {
                let [low, high] = FORCES;
                (4.0 * (t - SECONDS + READ) / READ, 3.0 * (force - low) / (high - low))
            };
            chart.line(line.iter().map(place), SERIES[axis], 4)?;
        }
        Ok(())
    })
}

fn map(panel: &Drawing) -> Drawn {
    let place = |(x, y): At| (2.0 + 2.0 * x / REACH, 1.5 + 2.0 * y / REACH);
    let (places, points) = last_known();
    let points = points.iter().map(|at| (at.x, at.y)).filter(is_inside);
    framed(panel, "trajectory and map", |chart| {
        let truth = path(SECONDS - DRAWN, SECONDS).map(|at| place((at.x, at.y)));
        chart.line(truth, INK.mix(0.5), 2)?;
        chart.dots(points.map(place), 4, SERIES[1])?;
        for (at, covariance) in places.iter().skip(EVERY - 1).step_by(EVERY) {
            let covariance = covariance.fixed_view::<2, 2>(0, 0).into_owned();
            let outline = ellipse((at.x, at.y), &covariance, ENLARGED);
            chart.line(outline.into_iter().map(place), SERIES[0], 2)?;
        }
        chart.line(places.iter().map(|(at, _)| place((at.x, at.y))), SERIES[0], 4)
    })
}
