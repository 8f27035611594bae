//! What is asked about an answer, and on which instances.

use nalgebra::{DMatrix, DVector, Isometry3, RowDVector};

use super::*;
use crate::Exercise;
use crate::answer::Transport;
use crate::camera::{Camera, point_in_view};
use crate::check::{Check, Failure, Misconception, compare, compare_number, readable, show_list};
use crate::checking::FACTORIZATIONS;
use crate::draw::Draw;

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "null_space",
    title: "Null-space projection of a track",
    chapter: "msckf",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &[],
    forbidden: FACTORIZATIONS,
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    TURNED_BACK, "turned_back":
        "This turns by the right angle in the other direction. Put c and s into c b − s a: what \
         becomes of the second number?";
    FIRST_NUMBER_GONE, "first_number_gone":
        "Sine and cosine are exchanged, so it is the first number that vanishes. Which of the two \
         should be left?";
    PROJECTOR, "projector":
        "2M rows came back: this is I − H_f H_f⁺, which takes the landmark away and keeps the \
         number of rows. Three of its directions are empty. What is the covariance of the noise in \
         these rows, and can it be inverted?";
    PSEUDO_INVERSE_ROWS, "pseudo_inverse_rows":
        "The landmark is gone, and these are rows of I − H_f H_f⁺. They are not orthonormal: what \
         is the covariance of Nᵀ ν, and is it what the next update takes it for?";
    RESIDUAL_NOT_ROTATED, "residual_not_rotated":
        "The residual's numbers are those that came in, with three left out. Every rotation mixes \
         two equations: what belongs to an equation besides its coefficients?";
    STATES_NOT_ROTATED, "states_not_rotated":
        "The rows of H_x are those that came in, with three left out. Every rotation mixes two \
         equations: does an equation end where its coefficients of the landmark do?";
    FIRST_THREE_KEPT, "first_three_kept":
        "The rows in which the landmark still stands were kept. After the rotations H_f is a \
         triangle with zeros below: where are the equations that do not speak of the landmark?";
    FROM_THE_TOP, "from_the_top":
        "These rotations of neighbouring rows began at the top. Each of them moves what it takes out \
         of a row into the row above, where a zero had been made already: at which end should they \
         begin?";
    STALE_ROW, "stale_row":
        "The upper row of the rotations is a copy from before the first of them. After one rotation \
         it has changed: with which numbers should the next one begin?";
    OVERWRITTEN_ROW, "overwritten_row":
        "The second row of a rotation was made of the first one as it is afterwards. \
         c a + s b and c b − s a mean the same a: when is it read, and when is it overwritten?";
    RANK_TWO, "rank_two":
        "The rays of this track do not fix the landmark: it can move along one direction without \
         any pixel changing. If one takes three rows away and the landmark had a say in two only, \
         what else was taken away?";
    ABSOLUTE_RANK, "absolute_rank":
        "The verdict depends on the unit in which the landmark is written. A singular value has \
         one: with what should it be compared?";
    OTHER_WAY, "other_way":
        "The correction has the opposite sign. The residual is predicted less measured, and a move \
         of the states adds H_x δx to it: should H_x δx be the residual or its negative?";
    LANDMARK_KNOWN, "landmark_known":
        "This correction believes the landmark to be exactly where it was linearized, and is too \
         sure of the states. Which of the two pairs, with or without the landmark, belongs here?";
    WRONG_RIGHT_SIDE, "wrong_right_side":
        "The matrix of the correction is made of the projected rows, and its right side is not. Which \
         residual belongs to Nᵀ H_x, and what is left of r?";
    PRIOR_INVERTED, "prior_inverted":
        "The prior was added as a covariance. What of two independent sources is added, their \
         covariances or what they know?";
}

/// A track, linearized.
#[derive(Debug, Clone)]
pub struct Case {
    /// H_x, with six columns for each pose and perhaps others.
    pub by_states: DMatrix<f64>,
    /// H_f.
    pub by_landmark: DMatrix<f64>,
    /// r.
    pub residual: DVector<f64>,
    /// What is known of the states.
    pub prior_information: DMatrix<f64>,
}

/// Of what tracks are drawn.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// In how many pictures the landmark is seen.
    pub pictures: usize,
    /// How far off it is, in metres.
    pub depth: f64,
    /// How far apart the cameras are, in metres.
    pub baseline: f64,
    /// Columns of H_x for other states, which no pixel depends on.
    pub others: usize,
}

/// The range of the public instances, but for the number of pictures.
const PUBLIC: Range = Range { pictures: 4, depth: 4.0, baseline: 1.0, others: 0 };

impl Case {
    /// A landmark that cameras see which have moved and turned; without a baseline they have only
    /// turned.
    pub fn drawn(draw: &mut Draw, range: Range) -> Self {
        let Range { pictures, depth, baseline, others } = range;
        let camera = Camera::drawn(draw).pinhole();
        let point = point_in_view(draw, depth, 1.2 * depth);
        let columns = others + 6 * pictures;
        let mut by_states = DMatrix::zeros(2 * pictures, columns);
        let mut by_landmark = DMatrix::zeros(2 * pictures, 3);
        for index in 0..pictures {
            // Cameras stand near the origin and turn a little: the landmark stays in view.
            let rotation = draw.rotation(0.02..0.2);
            let centre = baseline * draw.vector(0.5..1.0);
            let camera_from_world =
                Isometry3::from_parts((-(rotation * centre)).into(), rotation.into());
            let (by_pose, by_point) =
                camera.jacobians(&camera_from_world, &point).unwrap_or_default();
            by_states.view_mut((2 * index, others + 6 * index), (2, 6)).copy_from(&by_pose);
            by_landmark.fixed_view_mut::<2, 3>(2 * index, 0).copy_from(&by_point);
        }
        let mixing = DMatrix::from_fn(columns, columns, |row, column| {
            f64::from(u8::from(row == column)) + 0.3 * draw.normal() / (columns as f64).sqrt()
        });
        let known = DVector::from_fn(columns, |_, _| 10.0_f64.powf(draw.uniform(0.0..2.0)));
        Self {
            by_states,
            by_landmark,
            residual: DVector::from_fn(2 * pictures, |_, _| 3.0 * draw.normal()),
            prior_information: mixing.transpose() * DMatrix::from_diagonal(&known) * mixing,
        }
    }

    /// The same landmark in another unit, of which one of this is so many.
    fn in_units_of(&self, unit: f64) -> Self {
        Self { by_landmark: unit * &self.by_landmark, ..self.clone() }
    }

    /// The same track with other columns for the states.
    fn with_states(&self, by_states: DMatrix<f64>) -> Self {
        Self { by_states, ..self.clone() }
    }

    fn rows(&self) -> usize {
        self.by_landmark.nrows()
    }

    /// Blocks of the normal equations with the landmark in them: A, W and B, the gradients a of the
    /// states and b of the landmark. The landmark is written in coordinates in which its columns are orthonormal:
    /// the states do not notice, and little parallax costs no digits.
    fn equations(&self) -> [DMatrix<f64>; 5] {
        let basis = self.by_landmark.clone().qr().q();
        let (states, landmark) = (self.by_states.transpose(), basis.transpose());
        let residual = column(&self.residual);
        [
            &states * &self.by_states,
            &states * &basis,
            &landmark * &basis,
            &states * &residual,
            &landmark * &residual,
        ]
    }

    /// What is left of information, gradient and cost when the landmark is eliminated.
    fn eliminated(&self) -> [DMatrix<f64>; 3] {
        let [a, w, b, states, landmark] = self.equations();
        // Tracks of cases fix their landmark, so B has an inverse.
        let inverse = b.try_inverse().unwrap_or_else(|| DMatrix::repeat(3, 3, f64::NAN));
        let square = DMatrix::repeat(1, 1, self.residual.norm_squared());
        [
            a - &w * &inverse * w.transpose(),
            states - &w * &inverse * &landmark,
            square - landmark.transpose() * &inverse * &landmark,
        ]
    }

    /// The step of an adjustment that keeps the landmark, in its states.
    fn adjusted(&self, prior: &DMatrix<f64>) -> DVector<f64> {
        let [a, w, b, states, landmark] = self.equations();
        let size = a.nrows();
        let mut whole = DMatrix::zeros(size + 3, size + 3);
        whole.view_mut((0, 0), (size, size)).copy_from(&(a + prior));
        whole.view_mut((0, size), (size, 3)).copy_from(&w);
        whole.view_mut((size, 0), (3, size)).copy_from(&w.transpose());
        whole.view_mut((size, size), (3, 3)).copy_from(&b);
        let mut gradient = DVector::zeros(size + 3);
        gradient.rows_mut(0, size).copy_from(&states.column(0));
        gradient.rows_mut(size, 3).copy_from(&landmark.column(0));
        solved(whole, &-gradient).rows(0, size).into_owned()
    }
}

/// A way to rotate rows that goes wrong.
#[derive(Clone, Copy, PartialEq)]
enum Slip {
    FromTheTop,
    Stale,
    /// Of neighbouring rows from the bottom, or of the pivot's row with each one below it.
    Overwritten {
        neighbours: bool,
    },
}

impl Slip {
    const ALL: [(Self, &Misconception); 4] = [
        (Self::FromTheTop, &FROM_THE_TOP),
        (Self::Stale, &STALE_ROW),
        (Self::Overwritten { neighbours: true }, &OVERWRITTEN_ROW),
        (Self::Overwritten { neighbours: false }, &OVERWRITTEN_ROW),
    ];

    /// What comes of an identity whose rows are turned with those of a matrix, below the third.
    fn rows(self, by_landmark: &DMatrix<f64>) -> DMatrix<f64> {
        let count = by_landmark.nrows();
        let mut table = DMatrix::zeros(count, 3 + count);
        table.columns_mut(0, 3).copy_from(by_landmark);
        table.columns_mut(3, count).fill_with_identity();
        for column in 0..3 {
            let copy = table.row(column).into_owned();
            let from_below = self == Self::Overwritten { neighbours: true };
            for step in column + 1..count {
                let lower = if from_below { count + column - step } else { step };
                let neighbours = from_below || self == Self::FromTheTop;
                let upper = if neighbours { lower - 1 } else { column };
                let stale = (self == Self::Stale).then_some(&copy);
                self.turn(&mut table, column, [upper, lower], stale);
            }
        }
        table.view((3, 3), (count - 3, count)).into_owned()
    }

    /// Turns two rows, the first of which may be a copy.
    fn turn(
        self,
        table: &mut DMatrix<f64>,
        column: usize,
        [upper, lower]: [usize; 2],
        copy: Option<&RowDVector<f64>>,
    ) {
        let first = copy.cloned().unwrap_or_else(|| table.row(upper).into_owned());
        let second = table.row(lower).into_owned();
        let length = first[column].hypot(second[column]);
        let (c, s) = (first[column] / length, second[column] / length);
        let changed = c * &first + s * &second;
        let read = if let Self::Overwritten { .. } = self { &changed } else { &first };
        table.set_row(lower, &(c * second - s * read));
        table.set_row(upper, &changed);
    }
}

/// A vector as a matrix of one column.
fn column(vector: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_column_slice(vector.len(), 1, vector.as_slice())
}

/// The solution of a linear system, and no numbers where there is none.
fn solved(matrix: DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let size = right.len();
    matrix.lu().solve(right).unwrap_or_else(|| DVector::repeat(size, f64::NAN))
}

/// The instances that students have.
fn cases() -> Vec<Case> {
    let mut draw = Draw::new(5);
    [4, 2, 3, 7]
        .into_iter()
        .map(|pictures| Case::drawn(&mut draw, Range { pictures, ..PUBLIC }))
        .collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("a_rotation_leaves_the_length_and_a_zero", |answer| {
            let pairs = [[3.0, 4.0], [-1.0, 2.0], [0.5, -7.0], [0.0, 2.0], [-3.0, 0.0], [0.0, 0.0]];
            pairs.iter().try_for_each(|pair| rotation(answer, *pair))
        }),
        Check::new("what_is_left_does_not_speak_of_the_landmark", |answer| {
            cases().iter().try_for_each(|case| landmark_gone(answer, case))
        }),
        Check::new("the_rows_are_orthonormal", |answer| {
            cases().iter().try_for_each(|case| orthonormal(answer, case))
        }),
        Check::new("it_knows_what_elimination_leaves", |answer| {
            cases().iter().try_for_each(|case| information(answer, case))
        }),
        Check::new("a_track_that_does_not_fix_its_landmark_is_refused", |answer| {
            let mut draw = Draw::new(6);
            let mut track =
                |pictures, baseline| Case::drawn(&mut draw, Range { pictures, baseline, ..PUBLIC });
            let (seen, turned, once) = (track(4, 1.0), track(4, 0.0), track(1, 1.0));
            refusal(answer, &Tracks::drawn(&mut draw, &seen, &turned))?;
            refusal(answer, &Tracks::drawn(&mut draw, &seen, &once))
        }),
        Check::new("the_correction_is_that_of_an_adjustment_which_keeps_the_landmark", |answer| {
            cases().iter().try_for_each(|case| corrected(answer, case))
        }),
    ]
}

/// The rotation of a pair of numbers.
///
/// # Errors
///
/// A failure when it is no rotation, or not the one that leaves a length and a zero.
pub fn rotation(answer: &dyn Transport, [a, b]: [f64; 2]) -> Result<(), Failure> {
    let (c, s) = Answer(answer).givens(&a, &b)?;
    let length = f64::hypot(a, b);
    match length == 0.0 {
        true => show_list("the pair (c, s) where there is nothing to turn", &[c, s], &[1.0, 0.0]),
        false => {
            show_list("what is left of (a, b)", &[c * a + s * b, c * b - s * a], &[length, 0.0])
        }
    }
    let near = |x: f64, y: f64, scale: f64| (x - y).abs() <= 1e-12 * scale + f64::MIN_POSITIVE;
    let turns =
        |c: f64, s: f64| near(c * a + s * b, length, length) && near(c * b - s * a, 0.0, length);
    let numbers = format!(
        "a {}, b {}: c {}, s {}\nc² + s² {}, c a + s b {}, c b − s a {}; √(a² + b²) {}",
        readable(a),
        readable(b),
        readable(c),
        readable(s),
        readable(c * c + s * s),
        readable(c * a + s * b),
        readable(c * b - s * a),
        readable(length)
    );
    let failure = if !near(c * c + s * s, 1.0, 1.0) {
        Failure::new("c and s are not cosine and sine of an angle: c² + s² should be one.")
    } else if length == 0.0 {
        if near(c, 1.0, 1.0) {
            return Ok(());
        }
        Failure::new("There is nothing to turn, and the answer should be (1, 0).")
    } else if turns(c, s) {
        return Ok(());
    } else if turns(c, -s) {
        Failure::known(&TURNED_BACK)
    } else if turns(s, c) || turns(s, -c) {
        Failure::known(&FIRST_NUMBER_GONE)
    } else if turns(-c, -s) {
        Failure::new("The second number vanishes, and the first is the length with a minus sign.")
    } else {
        Failure::new("This rotation leaves something else than the length and a zero.")
    };
    Err(failure.with_numbers(numbers))
}

/// The answer on a track that fixes its landmark, if it has the size it should have.
fn projected(answer: &dyn Transport, case: &Case) -> Result<Projected, Failure> {
    complete(case, asked(answer, case)?)
}

/// The answer on any track.
fn asked(answer: &dyn Transport, case: &Case) -> Result<Option<Projected>, Failure> {
    let Case { by_states, by_landmark, residual, .. } = case;
    Ok(Answer(answer).project_out(by_states, by_landmark, residual)?)
}

/// What came back for a track that fixes its landmark, if it has the size it should have.
fn complete(case: &Case, obtained: Option<Projected>) -> Result<Projected, Failure> {
    let Case { by_states, by_landmark, .. } = case;
    let Some((states, rest)) = obtained else {
        let sigmas = by_landmark.singular_values();
        return Err(Failure::new(format!(
            "This track was refused, and its landmark is fixed: the singular values of H_f are {}, \
             {} and {}.",
            readable(sigmas[0]),
            readable(sigmas[1]),
            readable(sigmas[2])
        )));
    };
    let (rows, columns, left) = (case.rows(), by_states.ncols(), case.rows() - 3);
    let expected = ((left, columns), left);
    if (states.shape(), rest.len()) == expected {
        if states.iter().chain(&rest).all(|entry| entry.is_finite()) {
            return Ok((states, rest));
        }
        return Err(Failure::new("An entry is not finite; every entry must be."));
    }
    let knows = |information: &DMatrix<f64>| {
        states.ncols() == columns
            && (states.transpose() * &states - information).amax() <= 1e-7 * information.amax()
    };
    let [information, ..] = case.eliminated();
    let whole = by_states.transpose() * by_states;
    if states.nrows() == rows && knows(&information) {
        return Err(Failure::known(&PROJECTOR));
    }
    if states.nrows() == 3 && knows(&(whole - information)) {
        return Err(Failure::known(&FIRST_THREE_KEPT));
    }
    Err(Failure::new(format!(
        "H_x has {rows} rows and {columns} columns, so Nᵀ H_x should be {left}×{columns} and Nᵀ r \
         have {left} numbers. What came back is {}×{} and {}.",
        states.nrows(),
        states.ncols(),
        rest.len()
    )))
}

/// Whether a matrix is rows of another that follow each other, the last or the first of them.
fn rows_of(matrix: &DMatrix<f64>, whole: &DMatrix<f64>) -> bool {
    let count = matrix.nrows();
    let same = |first: usize| {
        (matrix - whole.rows(first, count)).amax() <= 1e-9 * matrix.amax().max(f64::MIN_POSITIVE)
    };
    matrix.amax() > 0.0 && (same(0) || same(whole.nrows() - count))
}

/// A projection of states, landmark and an identity beside one another shows which Nᵀ was applied to
/// the states: what comes back must be Nᵀ H_x, zeros, and Nᵀ.
struct Shown {
    by_states: DMatrix<f64>,
    by_landmark: DMatrix<f64>,
    rows: DMatrix<f64>,
    residual: DVector<f64>,
}

impl Shown {
    fn by(answer: &dyn Transport, case: &Case) -> Result<Self, Failure> {
        let (count, columns) = (case.rows(), case.by_states.ncols());
        let mut beside = DMatrix::zeros(count, columns + 3 + count);
        beside.columns_mut(0, columns).copy_from(&case.by_states);
        beside.columns_mut(columns, 3).copy_from(&case.by_landmark);
        beside.columns_mut(columns + 3, count).fill_with_identity();
        let (table, residual) = projected(answer, &case.with_states(beside))?;
        let part = |first: usize, width: usize| table.columns(first, width).into_owned();
        Ok(Self {
            by_states: part(0, columns),
            by_landmark: part(columns, 3),
            rows: part(columns + 3, count),
            residual,
        })
    }

    /// Whether rows came in and went out as they were.
    fn untouched(&self, case: &Case) -> Option<&'static Misconception> {
        if rows_of(&self.by_states, &case.by_states) {
            return Some(&STATES_NOT_ROTATED);
        }
        rows_of(&column(&self.residual), &column(&case.residual)).then_some(&RESIDUAL_NOT_ROTATED)
    }

    /// A slip of the rotations that leaves these rows, up to their signs.
    fn slip(&self, case: &Case) -> Option<&'static Misconception> {
        let alike = |slip: Slip| {
            let rows = slip.rows(&case.by_landmark);
            let near = |row: usize| {
                let (a, b) = (self.rows.row(row), rows.row(row));
                (a - b).amax().min((a + b).amax()) <= 1e-9 * b.amax()
            };
            (0..rows.nrows()).all(near)
        };
        Slip::ALL.iter().find(|(slip, _)| alike(*slip)).map(|(_, known)| *known)
    }

    /// The failure, or a better one where a slip of the rotations is known.
    fn or_slip(&self, failure: Failure, case: &Case) -> Failure {
        match self.slip(case) {
            Some(known) if failure.misconception.is_none() => {
                Failure { numbers: failure.numbers, ..Failure::known(known) }
            }
            _ => failure,
        }
    }

    /// Whether the landmark is gone.
    fn landmark_gone(&self, case: &Case) -> Result<(), Failure> {
        let (gone, landmark) = (&self.by_landmark, &case.by_landmark);
        let [before, after] = [landmark.norm(), gone.norm()];
        let what = "the pair of norms, of H_f and of what is left of it,";
        show_list(what, &[before, after], &[before, 0.0]);
        if gone.norm() <= 1e-11 * landmark.norm() {
            return Ok(());
        }
        let all = landmark.transpose() * landmark;
        let failure = if (gone.transpose() * gone - &all).amax() <= 1e-9 * all.amax() {
            Failure::known(&FIRST_THREE_KEPT)
        } else {
            Failure::new(
                "The landmark is not gone: with H_f in the place of H_x, zeros should be left.",
            )
        };
        let norms = |matrix: &DMatrix<f64>| {
            let each = matrix.column_iter().map(|one| format!("{:>12}", readable(one.norm())));
            each.collect::<String>()
        };
        Err(failure.with_numbers(format!(
            "norms of the landmark's columns\n    H_f {}\n Nᵀ H_f {}",
            norms(landmark),
            norms(gone)
        )))
    }

    /// Whether one Nᵀ was applied to all that came in, and has something in every row.
    fn applied(&self, case: &Case) -> Result<(), Failure> {
        let Self { by_states, rows, residual, .. } = self;
        let empty = |row: usize| rows.row(row).norm() < 1e-6;
        if (0..rows.nrows()).any(empty) {
            return Err(Failure::new("A row of Nᵀ, of the projection of an identity, is empty."));
        }
        // The table is too wide to read.
        compare(
            "Nᵀ H_x, with the Nᵀ of an identity beside it,",
            by_states,
            &(rows * &case.by_states),
        )
        .within(1e-9)
        .judge()
        .map_err(|failure| failure.with_numbers(""))?;
        compare("Nᵀ r, with the Nᵀ of an identity,", residual, &(rows * &case.residual))
            .within(1e-9)
            .judge()
    }
}

/// The projection without the landmark, beside that of the landmark alone and of an identity.
///
/// # Errors
///
/// A failure when something of the landmark is left, which names what was not rotated where that
/// is known.
pub fn landmark_gone(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let shown = Shown::by(answer, case)?;
    if let Some(misconception) = shown.untouched(case) {
        return Err(Failure::known(misconception));
    }
    shown
        .landmark_gone(case)
        .map_err(|failure| shown.or_slip(failure, case))
        .and_then(|()| shown.applied(case))
        .map_err(|failure| after_rotation(answer, failure))
}

/// What is wrong, or that it waits for the rotations.
fn after_rotation(answer: &dyn Transport, failure: Failure) -> Failure {
    failure.unless("givens", || {
        [[3.0, 4.0], [-1.0, 2.0], [0.0, 2.0], [-3.0, 0.0]]
            .iter()
            .try_for_each(|pair| rotation(answer, *pair))
    })
}

/// What is wrong, or that it waits for the rotations or for the projection.
fn after_projection(answer: &dyn Transport, case: &Case, failure: Failure) -> Failure {
    let failure = after_rotation(answer, failure);
    failure.unless("project_out", || {
        landmark_gone(answer, case)?;
        orthonormal(answer, case)?;
        information(answer, case)
    })
}

/// The rows of Nᵀ themselves, by a projection of the identity.
///
/// # Errors
///
/// A failure when they are not orthonormal, or not at right angles to the landmark.
pub fn orthonormal(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let shown = Shown::by(answer, case)?;
    let rows = &shown.rows;
    let (count, landmark) = (rows.nrows(), &case.by_landmark);
    let inverse = (landmark.transpose() * landmark).try_inverse();
    let identity = DMatrix::<f64>::identity(case.rows(), case.rows());
    let complement = inverse.map(|inverse| &identity - landmark * inverse * landmark.transpose());
    let of_complement = complement.is_some_and(|complement| {
        let near = |first| (rows - complement.rows(first, count)).amax() < 1e-7;
        near(0) || near(3)
    });
    compare(
        "Nᵀ N, of the projection of an identity,",
        &(rows * rows.transpose()),
        &DMatrix::<f64>::identity(count, count),
    )
    .within(1e-10)
    .judge()
    .map_err(|failure| match of_complement {
        true => Failure { numbers: failure.numbers, ..Failure::known(&PSEUDO_INVERSE_ROWS) },
        false => after_rotation(answer, shown.or_slip(failure, case)),
    })?;
    if (rows * landmark).norm() <= 1e-11 * landmark.norm() {
        return Ok(());
    }
    Err(Failure::new("The rows of Nᵀ are orthonormal, and Nᵀ H_f is not zero."))
}

/// What the projected equations know, against the elimination of the landmark.
///
/// # Errors
///
/// A failure when information, gradient or cost differ.
pub fn information(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let projected = projected(answer, case)?;
    knowing(case, &projected).map_err(|failure| after_rotation(answer, failure))
}

fn knowing(case: &Case, (states, rest): &Projected) -> Result<(), Failure> {
    let [information, gradient, square] = case.eliminated();
    let obtained = states.transpose() * states;
    let difference = &obtained - &information;
    if difference.amax() > 1e-8 * information.amax() {
        // The whole is too large to read: six rows and columns about the worst entry.
        let (row, column) = difference.abs().iamax_full();
        let begin = |index: usize| (index / 6 * 6).min(information.nrows() - 6);
        let block = |matrix: &DMatrix<f64>| {
            matrix.fixed_view::<6, 6>(begin(row), begin(column)).into_owned()
        };
        let what = format!(
            "the information (Nᵀ H_x)ᵀ (Nᵀ H_x), of which these are six rows from {} and six columns \
             from {},",
            begin(row),
            begin(column)
        );
        compare(&what, &block(&obtained), &block(&information)).within(1e-8).judge()?;
    }
    compare("the gradient (Nᵀ H_x)ᵀ (Nᵀ r)", &(states.transpose() * rest), &gradient)
        .within(1e-8)
        .judge()?;
    let obtained = rest.norm_squared();
    // Little may be left of the residual, and the elimination subtracts it from the whole.
    if (obtained - square[(0, 0)]).abs() <= 1e-8 * case.residual.norm_squared() {
        return Ok(());
    }
    compare_number("the square of Nᵀ r", obtained, square[(0, 0)]).within(1e-8).judge()
}

/// A track that fixes its landmark and one that does not, each in several units of the landmark, in
/// any order.
#[derive(Debug, Clone)]
pub struct Tracks(Vec<Track>);

#[derive(Debug, Clone)]
struct Track {
    case: Case,
    fixed: bool,
    unit: Unit,
}

/// In which the landmark is written.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Unit {
    Usual,
    Other,
    /// One in which H_f is zero.
    Infinite,
}

impl Tracks {
    /// The two tracks in units of a draw, and an order of it.
    pub fn drawn(draw: &mut Draw, seen: &Case, unseen: &Case) -> Self {
        let mut tracks = Vec::new();
        let mut add = |case, fixed, unit| tracks.push(Track { case, fixed, unit });
        add(seen.clone(), true, Unit::Usual);
        add(unseen.clone(), false, Unit::Usual);
        add(seen.in_units_of(1e-12), true, Unit::Other);
        add(unseen.in_units_of(1e9), false, Unit::Other);
        add(seen.in_units_of(0.0), false, Unit::Infinite);
        for _ in 0..draw.index(2..6) {
            let (unit, fixed) = (draw.uniform(0.5..2.0), draw.index(0..2) == 0);
            let again = if fixed { seen } else { unseen };
            add(again.in_units_of(unit), fixed, Unit::Usual);
        }
        draw.shuffle(&mut tracks);
        Self(tracks)
    }
}

/// Which of some tracks are refused, and what comes of the others.
///
/// # Errors
///
/// A failure when a track is refused that fixes its landmark, or one is not that does not.
pub fn refusal(answer: &dyn Transport, Tracks(tracks): &Tracks) -> Result<(), Failure> {
    let mut all = Vec::new();
    for track in tracks {
        all.push((track, asked(answer, &track.case)?));
    }
    let refused = all.iter().map(|(_, obtained)| f64::from(obtained.is_none()));
    let refusable = tracks.iter().map(|track| f64::from(!track.fixed));
    let (refused, refusable): (Vec<_>, Vec<_>) = (refused.collect(), refusable.collect());
    show_list("the list of tracks, one where a track is refused,", &refused, &refusable);
    let (fixed, free): (Vec<_>, Vec<_>) = all.into_iter().partition(|(track, _)| track.fixed);
    for (track, obtained) in fixed.iter().filter(|(track, _)| track.unit == Unit::Usual) {
        complete(&track.case, obtained.clone())?;
    }
    let accepted = |unit| free.iter().any(|(track, it)| track.unit == unit && it.is_some());
    if accepted(Unit::Usual) {
        return Err(Failure::known(&RANK_TWO));
    }
    if fixed.iter().any(|(_, obtained)| obtained.is_none()) || accepted(Unit::Other) {
        return Err(Failure::known(&ABSOLUTE_RANK));
    }
    if accepted(Unit::Infinite) {
        return Err(Failure::new(
            "H_f is zero here, no pixel depends on the landmark, and the track was not refused.",
        ));
    }
    for (Track { case, .. }, obtained) in fixed {
        knowing(case, &complete(case, obtained)?)?;
    }
    tracks.iter().try_for_each(|track| made(answer, track))
}

/// Whether there is a correction where there should be one, and nowhere else.
fn made(answer: &dyn Transport, Track { case, fixed, .. }: &Track) -> Result<(), Failure> {
    let Case { by_states, by_landmark, residual, prior_information } = case;
    let obtained =
        Answer(answer).correction(prior_information, by_states, by_landmark, residual)?;
    match (fixed, obtained) {
        (true, None) => Err(Failure::new(NO_CORRECTION)),
        (false, Some(_)) => Err(Failure::new(CORRECTION)),
        _ => Ok(()),
    }
}

const CORRECTION: &str =
    "A correction was made of a track whose landmark is not fixed, and there should be none.";

const NO_CORRECTION: &str = "There is no correction, although the track fixes its landmark and the \
                             prior alone would hold all the states.";

/// The correction against a step that keeps the landmark.
///
/// # Errors
///
/// A failure, which names what the correction is instead where that is known.
pub fn corrected(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { by_states, by_landmark, residual, prior_information } = case;
    let obtained =
        Answer(answer).correction(prior_information, by_states, by_landmark, residual)?;
    let Some(obtained) = obtained else {
        return Err(Failure::new(NO_CORRECTION));
    };
    let [a, _, _, states, _] = case.equations();
    let known = solved(a + prior_information, &-states.column(0));
    let [left, ..] = case.eliminated();
    let size = prior_information.nrows();
    let covariance =
        prior_information.clone().try_inverse().unwrap_or_else(|| DMatrix::zeros(size, size));
    let expected = case.adjusted(prior_information);
    compare("the correction", &obtained, &expected)
        .within(1e-7)
        .or(&OTHER_WAY, &-&expected)
        .or(&LANDMARK_KNOWN, &known)
        .or(&PRIOR_INVERTED, &case.adjusted(&covariance))
        .or(&WRONG_RIGHT_SIDE, &solved(left + prior_information, &-states.column(0)))
        .judge()
        .map_err(|failure| after_projection(answer, case, failure))
}
