//! Filter, fixed-lag smoother and batch on one small posterior: a body on a line, and marks that it sees for a while.

use nalgebra::{DMatrix, DVector};
use vislam::filtering::{Form, correct};

use crate::chapter::Chapter;
use crate::comparison::Comparison;

/// Places of the body, one a picture; marks follow them in the vector of all.
const PLACES: usize = 6;
/// The first and the last picture that shows each mark.
const TRACKS: [[usize; 2]; 2] = [[1, 3], [2, 4]];
const ALL: usize = PLACES + TRACKS.len();
/// How many places the smoother keeps.
const KEPT: usize = 4;
/// Measured steps, and how far off each mark was measured, in units of their noise.
const STEPS: [f64; PLACES - 1] = [1.1, 0.7, 1.4, 0.9, 1.2];
const SEEN: [[f64; 3]; 2] = [[3.1, 2.2, 1.6], [4.3, 2.7, 2.1]];
/// Standard deviations.
const FIRST: f64 = 0.5;
const STEP: f64 = 0.4;
const PIXEL: f64 = 0.2;

pub fn counterexamples(chapter: &mut Chapter) {
    let kept = Line { bend: 0.0, until: 5, again: false };
    for (condition, dropped) in [
        ("affine", Line { bend: 0.2, ..kept }),
        ("same", Line { until: 3, ..kept }),
        ("once", Line { again: true, ..kept }),
    ] {
        chapter.counterexample("three-orders", condition, same_estimate, [kept, dropped]);
    }
}

/// How the line is measured, and when the estimators are asked.
#[derive(Clone, Copy)]
struct Line {
    /// How strongly a measured distance bends, per unit.
    bend: f64,
    /// The picture after which they are asked.
    until: usize,
    /// Whether the smoother takes the last pixel of a mark once more, for a mark begun anew.
    again: bool,
}

/// A whitened row: its product with all variables should be a number.
type Row = (DVector<f64>, f64);

impl Line {
    fn first() -> Row {
        (DVector::from_fn(ALL, |at, _| if at == 0 { 1.0 / FIRST } else { 0.0 }), 0.0)
    }

    fn step(to: usize) -> Row {
        let mut row = DVector::zeros(ALL);
        (row[to - 1], row[to]) = (-1.0 / STEP, 1.0 / STEP);
        (row, STEPS[to - 1] / STEP)
    }

    /// The pixel of a mark in a picture, linearized at an estimate.
    fn pixel(&self, picture: usize, mark: usize, at: &DVector<f64>) -> Row {
        let away = at[PLACES + mark] - at[picture];
        let slope = 1.0 + 2.0 * self.bend * away;
        let off = away + self.bend * away * away - SEEN[mark][picture - TRACKS[mark][0]];
        let mut row = DVector::zeros(ALL);
        (row[picture], row[PLACES + mark]) = (-slope / PIXEL, slope / PIXEL);
        let should = row.dot(at) - off / PIXEL;
        (row, should)
    }

    fn marks(picture: usize) -> impl Iterator<Item = usize> {
        (0..TRACKS.len())
            .filter(move |mark| (TRACKS[*mark][0]..=TRACKS[*mark][1]).contains(&picture))
    }

    /// All rows at once, linearized again until nothing moves.
    fn batch(&self) -> [f64; 2] {
        let mut at = DVector::from_fn(ALL, |k, _| if k < PLACES { k as f64 } else { 5.0 });
        let mut posterior = Posterior::default();
        for _ in 0..50 {
            posterior = Posterior::default();
            posterior.add(&Self::first());
            for picture in 1..=self.until {
                posterior.add(&Self::step(picture));
                Self::marks(picture)
                    .for_each(|mark| posterior.add(&self.pixel(picture, mark, &at)));
            }
            posterior.solve(&mut at);
        }
        posterior.of(self.until)
    }

    /// Each row when its picture comes; places leave when they are old, marks when they were last seen.
    fn smoother(&self) -> [f64; 2] {
        let (mut posterior, mut at) = (Posterior::default(), DVector::zeros(ALL));
        posterior.add(&Self::first());
        for picture in 1..=self.until {
            at[picture] = at[picture - 1] + STEPS[picture - 1];
            posterior.add(&Self::step(picture));
            for mark in Self::marks(picture) {
                if picture == TRACKS[mark][0] {
                    at[PLACES + mark] = at[picture] + SEEN[mark][0];
                }
                let row = self.pixel(picture, mark, &at);
                posterior.add(&row);
                if self.again && picture == TRACKS[mark][1] {
                    posterior.add(&row);
                }
            }
            posterior.solve(&mut at);
            if picture >= KEPT {
                let oldest = picture - KEPT;
                posterior.marginalize(oldest);
                let ended = (0..TRACKS.len()).filter(|mark| TRACKS[*mark][1] <= oldest);
                ended.for_each(|mark| posterior.marginalize(PLACES + mark));
            }
        }
        posterior.of(self.until)
    }

    /// A covariance of the places; a track corrects it when it has ended, its mark projected out.
    fn filter(&self) -> [f64; 2] {
        let (mut at, mut covariance) = (DVector::zeros(ALL), DMatrix::zeros(1, 1));
        covariance[(0, 0)] = FIRST * FIRST;
        for picture in 1..=self.until {
            at[picture] = at[picture - 1] + STEPS[picture - 1];
            covariance = covariance.insert_row(picture, 0.0).insert_column(picture, 0.0);
            let cross = covariance.column(picture - 1).into_owned();
            covariance.column_mut(picture).copy_from(&cross);
            covariance.row_mut(picture).copy_from(&cross.transpose());
            covariance[(picture, picture)] = cross[picture - 1] + STEP * STEP;
            for mark in (0..TRACKS.len()).filter(|mark| TRACKS[*mark][1] == picture) {
                self.correct(mark, &mut at, &mut covariance);
            }
        }
        [at[self.until], covariance[(self.until, self.until)]]
    }

    fn correct(&self, mark: usize, at: &mut DVector<f64>, covariance: &mut DMatrix<f64>) {
        let [from, to] = TRACKS[mark];
        let places = covariance.nrows();
        at[PLACES + mark] = at[from] + SEEN[mark][0];
        let rows: Vec<Row> = (from..=to).map(|picture| self.pixel(picture, mark, at)).collect();
        let jacobian = DMatrix::from_fn(rows.len(), places, |row, column| rows[row].0[column]);
        let by_mark = DVector::from_fn(rows.len(), |row, _| rows[row].0[PLACES + mark]);
        let residual = DVector::from_fn(rows.len(), |row, _| rows[row].0.dot(at) - rows[row].1);
        let unit = by_mark.normalize();
        let project = DMatrix::identity(rows.len(), rows.len()) - &unit * unit.transpose();
        let (jacobian, residual) = (&project * jacobian, &project * residual);
        let correction = correct(covariance, &jacobian, &residual, Form::Joseph);
        let step = correction.expect("a covariance").step;
        (0..places).for_each(|place| at[place] += step[place]);
    }
}

/// The information of all rows so far.
struct Posterior {
    matrix: DMatrix<f64>,
    vector: DVector<f64>,
}

impl Default for Posterior {
    fn default() -> Self {
        Self { matrix: DMatrix::zeros(ALL, ALL), vector: DVector::zeros(ALL) }
    }
}

impl Posterior {
    fn add(&mut self, (row, should): &Row) {
        self.matrix += row * row.transpose();
        self.vector += row * *should;
    }

    /// The variables that rows name.
    fn present(&self) -> Vec<usize> {
        (0..ALL).filter(|at| self.matrix[(*at, *at)] > 0.0).collect()
    }

    fn solved(&self) -> (Vec<usize>, DVector<f64>, DMatrix<f64>) {
        let present = self.present();
        let matrix = self.matrix.select_rows(&present).select_columns(&present);
        let covariance = matrix.try_inverse().expect("everything is determined");
        let mean = &covariance * self.vector.select_rows(&present);
        (present, mean, covariance)
    }

    fn solve(&self, at: &mut DVector<f64>) {
        let (present, mean, _) = self.solved();
        present.iter().zip(mean.iter()).for_each(|(variable, mean)| at[*variable] = *mean);
    }

    fn marginalize(&mut self, gone: usize) {
        let column = self.matrix.column(gone).into_owned();
        let (pivot, value) = (column[gone], self.vector[gone]);
        self.matrix -= &column * column.transpose() / pivot;
        self.vector -= &column * (value / pivot);
        self.matrix.column_mut(gone).fill(0.0);
        self.matrix.row_mut(gone).fill(0.0);
        self.vector[gone] = 0.0;
    }

    /// Mean and variance of a variable.
    fn of(&self, variable: usize) -> [f64; 2] {
        let (present, mean, covariance) = self.solved();
        let at = present.iter().position(|at| *at == variable).expect("it is present");
        [mean[at], covariance[(at, at)]]
    }
}

fn same_estimate(line: Line) -> Comparison {
    let against = "the batch of all rows";
    let batch = line.batch();
    let both = [line.filter(), line.smoother()];
    Comparison::absolute(against, 1e-9, "").each(both, |estimate| (estimate, batch))
}
