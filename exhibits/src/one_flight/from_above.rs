//! The room from above, with the truth and what is known of it so far.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use plotters::style::{Color, RGBAColor};

use crate::figure::{self, Draw, Drawn, Figure, INK, SERIES, letters_right_of};

/// The axes of all these pictures, in metres, with room for words above.
const ACROSS: [f64; 2] = [-6.6, 6.6];
const UP: [f64; 2] = [-4.9, 6.4];
/// Where the words begin, and how far apart their columns and lines are, in metres.
const WORDS: [f64; 4] = [-6.3, 5.9, 6.4, 0.75];
/// At most so many rows are in the table, as many for each layer.
const ROWS: usize = 60;
/// How many standard deviations an ellipse reaches.
const SIGMAS: f64 = 3.0;

/// A place from above, in metres.
pub type At = (f64, f64);

/// Whether a place is between the axes, and below the words.
pub fn is_inside((x, y): &At) -> bool {
    (ACROSS[0]..ACROSS[1]).contains(x) && (UP[0]..-UP[0]).contains(y)
}

/// A part of what is seen from above.
pub struct Layer {
    name: String,
    /// The series whose colour it has; what is true is thin and grey.
    series: Option<usize>,
    shape: Shape,
}

enum Shape {
    Line(Vec<At>),
    Points(Vec<At>),
    Rays(Vec<[At; 2]>),
    Ellipses(f64, Vec<(At, Matrix2<f64>)>),
}

impl Layer {
    /// Where the body, or its camera, truly was.
    pub fn truth<'a>(places: impl IntoIterator<Item = &'a Vector3<f64>>) -> Self {
        let shape = Shape::Line(from_above(places));
        Self { name: "truth".to_owned(), series: None, shape }
    }

    /// Where landmarks truly are.
    pub fn landmarks<'a>(places: impl IntoIterator<Item = &'a Vector3<f64>>) -> Self {
        let shape = Shape::Points(from_above(places).into_iter().filter(is_inside).collect());
        Self { name: "landmarks".to_owned(), series: None, shape }
    }

    /// A line that is estimated.
    pub fn line<'a>(
        name: &str,
        series: usize,
        places: impl IntoIterator<Item = &'a Vector3<f64>>,
    ) -> Self {
        let shape = Shape::Line(from_above(places));
        Self { name: name.to_owned(), series: Some(series), shape }
    }

    /// Points that are estimated, as far as they are in the room.
    pub fn points<'a>(
        name: &str,
        series: usize,
        places: impl IntoIterator<Item = &'a Vector3<f64>>,
    ) -> Self {
        let shape = Shape::Points(from_above(places).into_iter().filter(is_inside).collect());
        Self { name: name.to_owned(), series: Some(series), shape }
    }

    /// Lines of sight, each from a place to another one.
    pub fn rays(name: &str, series: usize, rays: &[[Vector3<f64>; 2]]) -> Self {
        let rays = rays.iter().map(|ray| ray.map(|end| (end.x, end.y))).collect();
        Self { name: name.to_owned(), series: Some(series), shape: Shape::Rays(rays) }
    }

    /// Ellipses of the covariances of places, so many times as large.
    pub fn ellipses<'a>(
        times: f64,
        series: usize,
        places: impl IntoIterator<Item = (&'a Vector3<f64>, Matrix3<f64>)>,
    ) -> Self {
        let flat = |(place, covariance): (&Vector3<f64>, Matrix3<f64>)| {
            ((place.x, place.y), covariance.fixed_view::<2, 2>(0, 0).into_owned())
        };
        let name = match times {
            1.0 => "three σ".to_owned(),
            _ => format!("three σ, {times} times as large"),
        };
        let shape = Shape::Ellipses(times, places.into_iter().map(flat).collect());
        Self { name, series: Some(series), shape }
    }

    fn colour(&self) -> RGBAColor {
        self.series.map_or(INK.mix(0.5), |series| SERIES[series].mix(1.0))
    }

    fn draw(&self, chart: &mut impl Draw) -> Drawn {
        match (&self.shape, self.series) {
            (Shape::Line(places), series) => {
                let width = if series.is_some() { 5 } else { 3 };
                chart.line(places.iter().copied(), self.colour(), width)
            }
            (Shape::Points(places), series) => {
                let radius = if series.is_some() { 8 } else { 5 };
                chart.dots(places.iter().copied(), radius, self.colour())
            }
            (Shape::Rays(rays), _) => {
                rays.iter().try_for_each(|ray| chart.line(*ray, self.colour(), 2))
            }
            (Shape::Ellipses(times, places), _) => {
                places.iter().try_for_each(|(at, covariance)| {
                    chart.line(ellipse(*at, covariance, *times), self.colour(), 3)
                })
            }
        }
    }

    /// Draws a sample of it at a place, and says what it is.
    fn explain(&self, chart: &mut impl Draw, (x, y): At) -> Drawn {
        let sample = match &self.shape {
            Shape::Line(_) => Shape::Line(vec![(x, y), (x + 0.5, y)]),
            Shape::Points(_) => Shape::Points(vec![(x + 0.25, y)]),
            Shape::Rays(_) => Shape::Rays(vec![[(x, y), (x + 0.5, y)]]),
            Shape::Ellipses(..) => {
                let small = Matrix2::from_diagonal_element((0.2 / SIGMAS).powi(2));
                Shape::Ellipses(1.0, vec![((x + 0.25, y), small)])
            }
        };
        Self { shape: sample, name: String::new(), ..*self }.draw(chart)?;
        let ink = self.series.map_or(INK, |series| SERIES[series]);
        chart.write(&self.name, (x + 0.65, y), letters_right_of(ink))
    }

    /// Its places for the table: of a ray the far end, of an ellipse the middle.
    fn rows(&self, most: usize) -> Vec<Vec<String>> {
        let places: Vec<At> = match &self.shape {
            Shape::Line(places) | Shape::Points(places) => places.clone(),
            Shape::Rays(rays) => rays.iter().map(|ray| ray[1]).collect(),
            Shape::Ellipses(_, places) => places.iter().map(|(at, _)| *at).collect(),
        };
        let every = places.len().div_ceil(most).max(1);
        let row = |(x, y): &At| vec![self.name.clone(), format!("{x:.3}"), format!("{y:.3}")];
        places.iter().step_by(every).map(row).collect()
    }
}

/// The room from above: the first of these layers lies on all others.
pub fn room(layers: &[Layer]) -> Figure {
    let height = (1070.0 * (UP[1] - UP[0]) / (ACROSS[1] - ACROSS[0])) as u32 + 150;
    let figure = Figure::new(height, vec![], |drawing| {
        let (across, up) = (ACROSS[0]..ACROSS[1], UP[0]..UP[1]);
        let mut chart = figure::axes(drawing, ("x (m)", across, 6), ("y (m)", up, 6))?;
        let [left, top, column, line] = WORDS;
        layers.iter().rev().try_for_each(|layer| layer.draw(&mut chart))?;
        layers.iter().enumerate().try_for_each(|(at, layer)| {
            let place = (left + column * (at % 2) as f64, top - line * (at / 2) as f64);
            layer.explain(&mut chart, place)
        })
    });
    let columns = vec!["what is drawn", "x (m)", "y (m)"];
    Figure {
        columns,
        rows: layers.iter().flat_map(|layer| layer.rows(ROWS / layers.len())).collect(),
        ..figure
    }
}

fn from_above<'a>(places: impl IntoIterator<Item = &'a Vector3<f64>>) -> Vec<At> {
    places.into_iter().map(|place| (place.x, place.y)).collect()
}

/// The outline of an ellipse.
pub fn ellipse(centre: At, covariance: &Matrix2<f64>, times: f64) -> Vec<At> {
    let Some(root) = covariance.cholesky() else { return vec![] };
    let point = |step: i32| {
        let (sine, cosine) = (TAU * f64::from(step) / 40.0).sin_cos();
        let off = SIGMAS * times * (root.l() * Vector2::new(cosine, sine));
        (centre.0 + off.x, centre.1 + off.y)
    };
    (0..=40).map(point).collect()
}
