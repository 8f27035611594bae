//! What is asked about an answer, and on which instances.

use nalgebra::{DMatrix, DVector};

use super::*;
use crate::Exercise;
use crate::answer::{Spoiled, Transport};
use crate::check::{Check, Failure, Misconception, compare};
use crate::checking::FACTORIZATIONS;
use crate::draw::Draw;

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "square_root_prior",
    title: "Square-root prior by rotations",
    chapter: "marginalization",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Prior"],
    forbidden: FACTORIZATIONS,
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    RESIDUAL_NOT_ROTATED, "residual_not_rotated":
        "The offset's numbers are those that came in. A rotation mixes two equations: what belongs \
         to an equation besides its coefficients?";
    OFFSET_SIGN, "offset_sign":
        "The offset has the opposite sign. A measurement says r + J x, and the prior R x − d: where \
         does each of them vanish?";
    HELD, "held":
        "This is what would be known of those that stay if those that go were known exactly. Is a \
         coordinate that leaves the window known, or does it only stop being asked?";
    ROWS_OF_THE_GONE, "rows_of_the_gone":
        "Rows that speak of those that go are in the prior, with these coefficients left out. Which \
         rows of the triangle say something whatever the others may have been?";
    FIRST_COLUMNS, "first_columns":
        "The coordinates in the first columns have been eliminated here, as many as were named. \
         Which columns does `gone` name?";
    PRIOR_FORGOTTEN, "prior_forgotten":
        "This is what the measurements alone say. Where have those who left before put what they \
         knew?";
    PRIOR_SIGN, "prior_sign":
        "The old prior pulls to the other side. Its rows say R x − d and those of the measurements \
         r + J x: which residual has a row of the prior where x is zero?";
    SQUARED, "squared":
        "The large numbers are right, and what is known least has been lost among them. How many \
         digits has a number of single precision, and how many does the square of ten thousand \
         take?";
    SHIFT_SIGN, "shift_sign":
        "The offset has gone the wrong way. Put x = step + y into R x − d: what is subtracted from \
         R y?";
    SHIFT_UNWEIGHTED, "shift_unweighted":
        "The step itself was taken off the offset. In which unit is x, and in which one a whitened \
         residual? What takes the one to the other?";
    OFFSET_NOT_MOVED, "offset_not_moved":
        "The prior has moved along with the estimate. What was known said something of the point \
         where the estimate was: how far from it is the estimate now?";
}

impl Spoiled for Prior {
    fn spoiled(number: f64) -> Self {
        let size = usize::from(number != 0.0);
        Self {
            root: DMatrix::from_element(size, size, number as f32),
            offset: DVector::from_element(size, number as f32),
        }
    }
}

impl Prior {
    fn nothing(size: usize) -> Self {
        Self { root: DMatrix::zeros(size, size), offset: DVector::zeros(size) }
    }

    /// A triangle whose last rows are empty, so that it knows so many directions.
    fn drawn(draw: &mut Draw, size: usize, known: usize) -> Self {
        let mut prior = Self::nothing(size);
        for row in 0..known {
            (row..size).for_each(|column| prior.root[(row, column)] = draw.normal() as f32);
            prior.root[(row, row)] += 2.0_f32.copysign(prior.root[(row, row)]);
            prior.offset[row] = 3.0 * draw.normal() as f32;
        }
        prior
    }
}

/// A Gaussian in double precision: information Λ and Λ times the mean.
#[derive(Debug, Clone)]
struct Known {
    information: DMatrix<f64>,
    vector: DVector<f64>,
}

impl Known {
    fn by_prior(prior: &Prior) -> Self {
        let (root, offset) = (prior.root.map(f64::from), prior.offset.map(f64::from));
        Self { information: root.tr_mul(&root), vector: root.tr_mul(&offset) }
    }

    fn by_rows(rows: &DMatrix<f32>, residual: &DVector<f32>) -> Self {
        let (rows, residual) = (rows.map(f64::from), residual.map(f64::from));
        Self { information: rows.tr_mul(&rows), vector: -rows.tr_mul(&residual) }
    }

    /// With what another one knows of the first coordinates; its vector is multiplied by a sign.
    fn with(mut self, other: &Self, sign: f64) -> Self {
        let count = other.vector.len();
        let mut block = self.information.view_mut((0, 0), (count, count));
        block += &other.information;
        let mut first = self.vector.rows_mut(0, count);
        first += sign * &other.vector;
        self
    }

    fn covariance(&self) -> DMatrix<f64> {
        let size = self.vector.len();
        self.information.clone().try_inverse().unwrap_or_else(|| DMatrix::zeros(size, size))
    }

    fn select(&self, stays: &[usize]) -> Self {
        let information = self.information.select_rows(stays).select_columns(stays);
        Self { information, vector: self.vector.select_rows(stays) }
    }

    /// What is known of some coordinates: their mean, and their block of the covariance.
    fn marginal(&self, stays: &[usize]) -> Self {
        let covariance = self.covariance();
        let mean = (&covariance * &self.vector).select_rows(stays);
        let block = covariance.select_rows(stays).select_columns(stays);
        let of_block = Self { information: block, vector: mean };
        let information = of_block.covariance();
        Self { vector: &information * of_block.vector, information }
    }
}

/// How far single precision may be off in what is known well.
const TOLERANCE: f64 = 1e-4;

/// Whether two matrices agree in their greatest entries.
fn alike(a: &DMatrix<f64>, b: &DMatrix<f64>) -> bool {
    a.shape() == b.shape() && (a - b).amax() <= TOLERANCE * b.amax()
}

/// Refuses a prior of another size.
fn sized(obtained: &Prior, size: usize) -> Result<(), Failure> {
    let ((rows, columns), numbers) = (obtained.root.shape(), obtained.offset.len());
    if (rows, columns, numbers) == (size, size, size) {
        return Ok(());
    }
    Err(Failure::new(format!(
        "A root of {rows}×{columns} and an offset of {numbers} came back, and there should be \
         {size}×{size} and {size}."
    )))
}

/// Refuses a root with numbers below its diagonal.
fn triangular(obtained: &Prior) -> Result<(), Failure> {
    let below = obtained
        .root
        .map(f64::from)
        .lower_triangle()
        .map_with_location(|row, column, entry| if row > column { entry } else { 0.0 });
    if below.amax() <= 1e-6 * f64::from(obtained.root.amax()) {
        return Ok(());
    }
    Err(Failure::new("Below the diagonal of the root stands something that is not zero."))
}

/// Whether each number of an offset came in as it is, but for signs.
fn came_in(offset: &DVector<f32>, numbers: &[f32]) -> bool {
    let same = |a: f32, b: f32| (a.abs() - b.abs()).abs() <= 1e-6 * a.abs();
    let known = |out: &f32| out.is_finite() && numbers.iter().any(|number| same(*out, *number));
    offset.iter().all(known)
}

/// The failure, or a better one when the root is right and the offset consists of these numbers.
fn or_not_rotated(
    failure: Failure,
    obtained: &Prior,
    expected: &Known,
    numbers: &[f32],
) -> Failure {
    let root_is_right = alike(&Known::by_prior(obtained).information, &expected.information);
    if failure.misconception.is_none() && root_is_right && came_in(&obtained.offset, numbers) {
        return Failure { numbers: failure.numbers, ..Failure::known(&RESIDUAL_NOT_ROTATED) };
    }
    failure
}

/// Information and vector of a prior against what should be known, or may be by mistake.
fn knows(
    obtained: &Prior,
    expected: &Known,
    wrong: &[(&'static Misconception, Known)],
) -> Result<(), Failure> {
    let known = Known::by_prior(obtained);
    let mut information =
        compare("the information RᵀR", &known.information, &expected.information).within(TOLERANCE);
    let mut vector = compare("Rᵀd", &known.vector, &expected.vector).within(TOLERANCE);
    for (misconception, wrong) in wrong {
        information = information.or(misconception, &wrong.information);
        vector = vector.or(misconception, &wrong.vector);
    }
    information.judge()?;
    vector.judge()
}

fn negative(known: &Known) -> Known {
    Known { information: known.information.clone(), vector: -&known.vector }
}

/// A prior and a measurement.
#[derive(Debug, Clone)]
pub struct Measured {
    prior: Prior,
    row: DVector<f32>,
    residual: f32,
}

impl Measured {
    /// A prior of some coordinates that knows some directions, and a row with zeros in it.
    pub fn drawn(draw: &mut Draw, size: usize, known: usize) -> Self {
        let prior = Prior::drawn(draw, size, known.min(size));
        let mut row = DVector::from_fn(size, |_, _| draw.normal() as f32);
        for _ in 0..size / 3 {
            row[draw.index(0..size)] = 0.0;
        }
        row[draw.index(0..size)] = draw.uniform(1.0..2.0) as f32;
        Self { prior, row, residual: draw.uniform(2.0..5.0) as f32 }
    }
}

/// The instances of a draw: from a prior that knows nothing to one that knows everything.
pub fn measured(draw: &mut Draw, count: usize, sizes: [usize; 2]) -> Vec<Measured> {
    (0..count)
        .map(|index| {
            let size = draw.index(sizes[0]..sizes[1]);
            Measured::drawn(draw, size, if index % 4 == 0 { 0 } else { index * size / count + 1 })
        })
        .collect()
}

/// A window that slides.
#[derive(Debug, Clone)]
pub struct Window {
    prior: Prior,
    rows: DMatrix<f32>,
    residual: DVector<f32>,
    gone: Vec<usize>,
}

/// Of what windows are drawn.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// Coordinates of the old prior.
    pub old: usize,
    /// New ones.
    pub new: usize,
    /// How many of them go.
    pub gone: usize,
}

impl Window {
    /// A window whose coordinates are known about equally well; the first of them stays.
    pub fn drawn(draw: &mut Draw, range: Range) -> Self {
        let Range { old, new, gone } = range;
        let columns = old + new;
        let rows = DMatrix::from_fn(columns + 6, columns, |_, _| draw.normal() as f32);
        let prior = Prior::drawn(draw, old, old);
        Self::of(draw, prior, rows, gone)
    }

    /// A window without an old prior of whose coordinates some combinations are known a certain
    /// number of times as well as others.
    pub fn stretched(draw: &mut Draw, columns: usize, gone: usize, ratio: f64) -> Self {
        let mut orthonormal =
            |rows: usize| DMatrix::from_fn(rows, columns, |_, _| draw.normal()).qr().q();
        let (left, right) = (orthonormal(columns + 12), orthonormal(columns));
        let last = (columns - 1) as f64;
        let sigmas = DVector::from_fn(columns, |index, _| ratio.powf(-(index as f64) / last));
        let rows = left * DMatrix::from_diagonal(&sigmas) * right.transpose();
        Self::of(draw, Prior::nothing(0), rows.map(|entry| entry as f32), gone)
    }

    fn of(draw: &mut Draw, prior: Prior, rows: DMatrix<f32>, gone: usize) -> Self {
        let truth = DVector::from_fn(rows.ncols(), |_, _| 2.0 * draw.normal() as f32);
        let noise = DVector::from_fn(rows.nrows(), |_, _| draw.normal() as f32);
        let mut others: Vec<usize> = (1..rows.ncols()).collect();
        draw.shuffle(&mut others);
        others.truncate(gone);
        Self { residual: noise - &rows * truth, prior, rows, gone: others }
    }

    fn stays(&self) -> Vec<usize> {
        (0..self.rows.ncols()).filter(|column| !self.gone.contains(column)).collect()
    }

    fn asked(&self, answer: &dyn Transport) -> Result<Prior, Failure> {
        let Self { prior, rows, residual, gone } = self;
        Ok(Answer(answer).slide(prior, rows, residual, gone)?)
    }

    /// All that is known, with the old prior as it is, away, or turned over.
    fn known(&self, sign: f64) -> Known {
        Known::by_rows(&self.rows, &self.residual).with(&Known::by_prior(&self.prior), sign)
    }

    fn given(&self, failure: Failure) -> Failure {
        let (columns, old) = (self.rows.ncols(), self.prior.offset.len());
        failure.given(&[
            ("columns", &columns),
            ("of them in the prior", &old),
            ("gone", &self.gone),
        ])
    }
}

/// The instances of a draw.
pub fn windows(draw: &mut Draw, count: usize) -> Vec<Window> {
    (0..count)
        .map(|index| {
            let old = if index % 3 == 2 { 0 } else { draw.index(2..6) };
            let new = draw.index(3..7);
            let gone = draw.index(1..old + new - 1);
            Window::drawn(draw, Range { old, new, gone })
        })
        .collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("a_row_is_turned_into_the_triangle", absorbs),
        Check::new("what_stays_is_the_marginal", |answer| {
            let mut draw = Draw::new(42);
            windows(&mut draw, 20).iter().try_for_each(|window| slid(answer, window))
        }),
        Check::new("what_is_known_least_keeps_its_digits", |answer| {
            let mut draw = Draw::new(43);
            (0..6).try_for_each(|_| precise(answer, &Window::stretched(&mut draw, 9, 3, 1e4)))
        }),
        Check::new("a_prior_stays_where_it_was_when_the_estimate_moves", |answer| {
            let mut draw = Draw::new(44);
            (0..10).try_for_each(|index| moved(answer, &mut draw, 2 + index / 2))
        }),
    ]
}

/// The rows that students have.
fn absorbs(answer: &dyn Transport) -> Result<(), Failure> {
    let mut draw = Draw::new(41);
    measured(&mut draw, 20, [1, 7]).iter().try_for_each(|case| absorbed(answer, case))
}

/// One measurement more, by what is known afterwards.
///
/// # Errors
///
/// A failure, which names what is known instead where that can be told.
pub fn absorbed(answer: &dyn Transport, measured: &Measured) -> Result<(), Failure> {
    let Measured { prior, row, residual } = measured;
    let obtained = Answer(answer).absorb(prior, row, residual)?;
    sized(&obtained, row.len())?;
    let line = DMatrix::from_fn(1, row.len(), |_, column| row[column]);
    let by_row = |residual: f32| {
        Known::by_rows(&line, &DVector::from_element(1, residual))
            .with(&Known::by_prior(prior), 1.0)
    };
    let wrong = [(&OFFSET_SIGN, by_row(-residual))];
    let expected = by_row(*residual);
    let known = knows(&obtained, &expected, &wrong)
        .map_err(|failure| or_not_rotated(failure, &obtained, &expected, prior.offset.as_slice()));
    known.map_err(|failure| {
        failure.given(&[
            ("prior.root, by columns", &prior.root.as_slice()),
            ("prior.offset", &prior.offset.as_slice()),
            ("row", &row.as_slice()),
            ("residual", residual),
        ])
    })?;
    triangular(&obtained)
}

/// A slide, by what is known of those that stay.
///
/// # Errors
///
/// A failure, which names what is known instead where that can be told.
pub fn slid(answer: &dyn Transport, window: &Window) -> Result<(), Failure> {
    let obtained = window.asked(answer)?;
    marginal(&obtained, window)
        .map_err(|failure| window.given(failure))
        .and_then(|()| triangular(&obtained))
        .map_err(|failure| failure.unless("absorb", || absorbs(answer)))
}

fn marginal(obtained: &Prior, window: &Window) -> Result<(), Failure> {
    let (stays, all) = (window.stays(), window.known(1.0));
    let (expected, held) = (all.marginal(&stays), all.select(&stays));
    let of_the_gone = Known {
        information: &held.information - &expected.information,
        vector: &held.vector - &expected.vector,
    };
    if obtained.root.nrows() != stays.len() && obtained.root.ncols() == stays.len() {
        let root = obtained.root.map(f64::from);
        let information = root.tr_mul(&root);
        if [&held, &of_the_gone].iter().any(|rows| alike(&information, &rows.information)) {
            return Err(Failure::known(&ROWS_OF_THE_GONE));
        }
    }
    sized(obtained, stays.len())?;
    let last: Vec<usize> = (window.gone.len()..window.rows.ncols()).collect();
    let alone = Known::by_rows(&window.rows, &window.residual);
    let turned_over = window.known(-1.0).marginal(&stays);
    let wrong = [
        (&OFFSET_SIGN, negative(&expected)),
        (&OFFSET_SIGN, negative(&turned_over)),
        (&HELD, held),
        (&ROWS_OF_THE_GONE, of_the_gone),
        (&FIRST_COLUMNS, all.marginal(&last)),
        (&PRIOR_FORGOTTEN, alone.marginal(&stays)),
        (&PRIOR_SIGN, turned_over),
    ];
    let numbers = [window.residual.as_slice(), window.prior.offset.as_slice()].concat();
    knows(obtained, &expected, &wrong)
        .map_err(|failure| or_not_rotated(failure, obtained, &expected, &numbers))
}

/// A prior of coordinates some of which are known much better than others, by a slide and by
/// measurements one after the other.
///
/// # Errors
///
/// A failure when what is known least has lost its digits.
pub fn precise(answer: &dyn Transport, window: &Window) -> Result<(), Failure> {
    let (stays, all) = (window.stays(), window.known(1.0));
    whitens(&window.asked(answer)?, &all, &stays)
        .map_err(|failure| failure.unless("absorb", || absorbs(answer)))?;
    let columns = window.rows.ncols();
    let mut prior = Prior::nothing(columns);
    for (row, residual) in window.rows.row_iter().zip(&window.residual) {
        prior = Answer(answer).absorb(&prior, &row.transpose(), residual)?;
    }
    whitens(&prior, &all, &(0..columns).collect::<Vec<_>>())
}

/// Whether a root makes the identity of the covariance, so that all directions count alike.
fn whitens(obtained: &Prior, all: &Known, stays: &[usize]) -> Result<(), Failure> {
    sized(obtained, stays.len())?;
    let covariance = all.covariance();
    let mean = (&covariance * &all.vector).select_rows(stays);
    let block = covariance.select_rows(stays).select_columns(stays);
    let (root, offset) = (obtained.root.map(f64::from), obtained.offset.map(f64::from));
    let whitened = &root * block * root.transpose();
    let identity = DMatrix::<f64>::identity(stays.len(), stays.len());
    compare("R Σ Rᵀ, with the covariance Σ of those that stay,", &whitened, &identity)
        .within(0.02)
        .judge()
        .map_err(|failure| {
            // What is known well is right, beside all that was summed up, and beside the rest.
            let expected = all.marginal(stays).information;
            let off = (root.tr_mul(&root) - &expected).amax();
            match off <= 1e-4 * all.information.amax() && off <= 0.1 * expected.amax() {
                true => Failure { numbers: failure.numbers, ..Failure::known(&SQUARED) },
                false => failure,
            }
        })?;
    compare("the offset", &offset, &(root * mean)).within(0.02).judge()
}

/// A prior of a draw, seen from another point.
///
/// # Errors
///
/// A failure, which names where the offset has gone where that is known.
pub fn moved(answer: &dyn Transport, draw: &mut Draw, size: usize) -> Result<(), Failure> {
    let prior = Prior::drawn(draw, size, size);
    let step = DVector::from_fn(size, |_, _| 2.0 * draw.normal() as f32);
    let obtained = Answer(answer).seen_from(&prior, &step)?;
    sized(&obtained, size)?;
    // The mean is where it was, and is counted from elsewhere.
    let known = Known::by_prior(&prior);
    let (mean, from) = (known.covariance() * &known.vector, step.map(f64::from));
    let about = |mean: DVector<f64>| Known {
        information: known.information.clone(),
        vector: &known.information * mean,
    };
    let pulled = &known.vector - prior.root.map(f64::from).tr_mul(&from);
    let wrong = [
        (&SHIFT_SIGN, about(&mean + &from)),
        (&SHIFT_UNWEIGHTED, Known { vector: pulled, ..known.clone() }),
        (&OFFSET_NOT_MOVED, about(mean.clone())),
        (&OFFSET_SIGN, about(&from - &mean)),
    ];
    knows(&obtained, &about(mean - from), &wrong).map_err(|failure| {
        failure.given(&[
            ("prior.root, by columns", &prior.root.as_slice()),
            ("prior.offset", &prior.offset.as_slice()),
            ("step", &step.as_slice()),
        ])
    })
}
