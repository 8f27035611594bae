//! What is asked about an answer, and on which instances.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Matrix3, SMatrix, Vector3};
use vislam::least_squares::Manifold;
use vislam::manifold::so3;

use super::*;
use crate::Exercise;
use crate::answer::Transport;
use crate::check::{Check, Failure, compare};
use crate::draw::Draw;
use crate::navigation::given;

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "residual_jacobian",
    title: "Jacobians of the preintegration residual",
    chapter: "preintegration",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Deltas", "Matrix9", "State", "Vector9"],
    forbidden: &["factors", "imu_residual", "linearize", "observability", "predict", "simulation"],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    GRAVITY_FORGOTTEN, "gravity_forgotten":
        "This is the residual of a world without gravity. The readings of a body at rest sum up to \
         a velocity that points up, and the two states say that it stays at rest: what closes the \
         gap?";
    GRAVITY_SIGN, "gravity_sign":
        "Gravity has the wrong sign. A body that falls freely feels nothing, so its deltas are \
         zero: what has to be taken off its change of velocity, and of position, for the \
         residual to vanish?";
    CARRY_FORGOTTEN, "carry_forgotten":
        "The velocity at the beginning carries the body on for the whole interval, and here it \
         carries nothing. In how many of the three residuals does the first velocity stand?";
    LEFT_IN_THE_WORLD, "left_in_the_world":
        "Velocity and position are seen from the world. In which frame do Δv and Δp stand, and \
         which of the three frames does the specification ask for?";
    UNTRANSPOSED_BLOCK, "untransposed_block":
        "A rotation stands where its transpose belongs. Name the frames on both sides of the \
         product: which coordinates come in, and which should come out?";
    REVERSED, "reversed":
        "Every number has the opposite sign: this is what the readings say less what the states \
         say, or the derivative of that.";
    OTHER_SIDE, "other_side":
        "The rotation's residual stands in the wrong frame, that of the other side of ΔR. Which \
         of ΔR exp(φ) and exp(φ) ΔR does the specification say?";
    ROTATION_REVERSED, "rotation_reversed":
        "The rotation's residual has the opposite sign, and the other two have not. It leads from \
         what the states say to what the readings say: which of the two stands before exp(φ) in \
         the specification?";
    WORLD_STEPS, "world_steps":
        "This is the derivative for v + δv and p + δp, steps in the world, as the book takes them. \
         Put v + R δv into the residual: what meets R there?";
    INVERSE_JACOBIAN_FORGOTTEN, "inverse_jacobian_forgotten":
        "The rotation's block is right only where the residual is zero. A small rotation stands on \
         the right of one that is not small, inside of the logarithm: which matrix takes it to \
         what is added to the logarithm?";
    LEFT_INVERSE_JACOBIAN, "left_inverse_jacobian":
        "The inverse of the left Jacobian stands in the rotation's block. It belongs to a small \
         rotation on the left of one that is not small: on which side of exp(φ) does the step of \
         the first body come out?";
    SKEW_SIGN, "skew_sign":
        "A block by which a rotation of the first body changes velocity or position has the wrong \
         sign. Transposing R exp(φ) puts which of exp(φ) and exp(−φ) before the difference of the \
         states?";
    MEASURED_FOR_STATED, "measured_for_stated":
        "The skews are of the deltas that were measured. They agree with the right ones where the \
         residual is zero, and there alone. Which of the two terms of the residual does a turn of \
         the first body reach?";
    DIFFERENCED, "differenced":
        "This agrees with the derivative, but not beside a half turn and not far from the origin: it \
         was differenced. A derivative is asked for, of a logarithm that jumps at a half turn. Which \
         matrix is it there, and where do the positions stand in it?";
    INVERSE_DICTIONARY, "inverse_dictionary":
        "This goes the other way. A step δv in the world is which step in the body frame? Put that \
         into the derivative that is given.";
    ROTATION_TURNED_TOO, "rotation_turned_too":
        "The columns of the rotation are changed as well. In which of its three parts do the two \
         kinds of steps differ?";
}

/// An interval and what two states and the readings say about it.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// What the readings say.
    pub deltas: Deltas,
    /// The state at the beginning.
    pub first: State,
    /// The state at the end.
    pub second: State,
    /// In the world, in m/s².
    pub gravity: Vector3<f64>,
}

impl Case {
    /// A case whose rotation is off by an angle, and whose interval is as long as numbers of the
    /// ranges, in radians and seconds.
    pub fn drawn(draw: &mut Draw, angle: [f64; 2], duration: [f64; 2]) -> Self {
        let (deltas, first) = (Deltas::drawn(draw, duration), State::drawn(draw));
        let gravity = draw.vector(4.0..12.0);
        let State { world_from_body, velocity, position } = deltas.lead(&first, &gravity);
        let second = State {
            world_from_body: world_from_body * draw.rotation(angle[0]..angle[1]),
            velocity: velocity + draw.vector(1.0..4.0),
            position: position + draw.vector(1.0..4.0),
        };
        Self { deltas, first, second, gravity }
    }

    /// A failure with the case.
    fn shown(&self, failure: Failure) -> Failure {
        given(failure, &self.deltas, [&self.first, &self.second], &self.gravity)
    }

    /// The residual by way of the state to which the deltas lead, from where the second state is
    /// looked at.
    fn residual(&self) -> Vector9 {
        let led = self.deltas.lead(&self.first, &self.gravity);
        let body_from_world = self.first.world_from_body.inverse();
        let phi = so3::local(&led.world_from_body, &self.second.world_from_body);
        let velocity = body_from_world * (self.second.velocity - led.velocity);
        let position = body_from_world * (self.second.position - led.position);
        let rows = [phi, velocity, position];
        Vector9::from_fn(|row, _| rows[row / 3][row % 3])
    }

    /// The derivative of the residual by a step of the first state, by differences of the fourth
    /// order.
    fn slope(&self, step: Steps) -> Matrix9 {
        const H: f64 = 1e-3;
        let here: Vector3<f64> = self.residual().fixed_rows::<3>(0).into();
        let moved = |axis: usize, size: f64| {
            let mut numbers = [0.0; 9];
            numbers[axis] = size;
            let mut residual = Self { first: step.of(&self.first, &numbers), ..*self }.residual();
            let mut phi = residual.fixed_rows_mut::<3>(0);
            // Beyond a half turn the rotation vector jumps to the other side; its slope does not.
            if here.norm() > FRAC_PI_2 && phi.dot(&here) < 0.0 {
                phi *= 1.0 - TAU / phi.norm();
            }
            residual
        };
        let columns = [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|axis| {
            let near = moved(axis, H) - moved(axis, -H);
            let far = moved(axis, 2.0 * H) - moved(axis, -2.0 * H);
            (8.0 * near - far) / (12.0 * H)
        });
        let slope = Matrix9::from_columns(&columns);
        // What differences leave where nothing depends on the step is no number to show.
        let rounding = 1e-11 * slope.amax();
        slope.map(|entry| if entry.abs() < rounding { 0.0 } else { entry })
    }

    /// The case with a rotation that is off by a little less than a half turn, about the same axis.
    fn beside_a_half_turn(&self) -> Self {
        let led = self.deltas.lead(&self.first, &self.gravity).world_from_body;
        let axis = so3::local(&led, &self.second.world_from_body).normalize();
        let world_from_body = so3::retract(&led, &((PI - 1e-8) * axis));
        Self { second: State { world_from_body, ..self.second }, ..*self }
    }

    /// The case so far away that positions have six digits behind the point.
    fn far_off(&self) -> Self {
        let there = |state: &State| {
            let position = state.position + 2.0_f64.powi(33) * Vector3::new(1.0, -1.0, 1.0);
            State { position, ..*state }
        };
        Self { first: there(&self.first), second: there(&self.second), ..*self }
    }

    /// The case without what the velocity carries.
    fn carried_by_nothing(&self) -> Self {
        let carried = self.deltas.duration * self.first.velocity;
        let second = State { position: self.second.position + carried, ..self.second };
        Self { second, ..*self }
    }

    /// The case with the first body turned the other way.
    fn turned_back(&self) -> Self {
        let world_from_body = self.first.world_from_body.inverse();
        Self { first: State { world_from_body, ..self.first }, ..*self }
    }

    /// The case in which the states say what the readings say.
    fn agreed(&self) -> Self {
        Self { second: self.deltas.lead(&self.first, &self.gravity), ..*self }
    }
}

/// How a state moves.
#[derive(Clone, Copy)]
enum Steps {
    Body,
    World,
}

impl Steps {
    fn of(self, state: &State, step: &[f64; 9]) -> State {
        let mut step = *step;
        if let Self::Body = self {
            for at in [3, 6] {
                let turned = state.world_from_body * Vector3::from_column_slice(&step[at..at + 3]);
                step[at..at + 3].copy_from_slice(turned.as_slice());
            }
        }
        State::of(&state.nav().retract(&step))
    }
}

/// Rows or columns of rotation, of velocity, of position.
const PARTS: [usize; 3] = [0, 3, 6];
const ROWS: [&str; 9] =
    ["r_phi x", "r_phi y", "r_phi z", "r_v x", "r_v y", "r_v z", "r_p x", "r_p y", "r_p z"];
const COLUMNS: [&str; 9] =
    ["phi x", "phi y", "phi z", "dv x", "dv y", "dv z", "dp x", "dp y", "dp z"];

/// The instances that students have.
fn cases() -> Vec<Case> {
    let mut draw = Draw::new(8);
    (0..20).map(|_| Case::drawn(&mut draw, [0.4, 1.5], [0.3, 1.5])).collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("the_residual_is_the_way_from_where_the_readings_lead", |answer| {
            cases().iter().try_for_each(|case| way(answer, case))
        }),
        Check::new("the_jacobian_is_the_slope_of_the_residual", |answer| {
            cases().iter().try_for_each(|case| jacobian(answer, case))
        }),
        Check::new("world_steps_are_body_steps_turned", |answer| {
            cases().iter().try_for_each(|case| dictionary(answer, case))
        }),
    ]
}

/// A matrix with the rows of some parts turned.
fn rows_turned<const C: usize>(
    matrix: &SMatrix<f64, 9, C>,
    by: &Matrix3<f64>,
    parts: &[usize],
) -> SMatrix<f64, 9, C> {
    let mut turned = *matrix;
    for at in parts {
        let rows = by * turned.fixed_rows::<3>(*at);
        turned.fixed_rows_mut::<3>(*at).copy_from(&rows);
    }
    turned
}

/// A matrix with the columns of some parts turned.
fn columns_turned(matrix: &Matrix9, by: &Matrix3<f64>, parts: &[usize]) -> Matrix9 {
    rows_turned(&matrix.transpose(), &by.transpose(), parts).transpose()
}

/// The residual against the way from the state to which the readings lead.
///
/// # Errors
///
/// A failure, which names what the residual is instead where that is known.
pub fn way(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { deltas, first, second, gravity } = case;
    let obtained = Answer(answer).residual(deltas, first, second, gravity)?;
    let expected = case.residual();
    let world_from_body = first.world_from_body.matrix();
    let in_world = rows_turned(&expected, world_from_body, &PARTS[1..]);
    let back = case.turned_back().residual();
    let rising = Case { gravity: -gravity, ..*case }.residual();
    // Gravity wrong in one of the two lines that contain it, the rotation reversed alone.
    let in_rows = |at: usize, other: &Vector9| {
        Vector9::from_fn(|row, _| if row / 3 * 3 == at { other[row] } else { expected[row] })
    };
    let half_back = Vector9::from_fn(|row, _| if row < 3 { expected[row] } else { back[row] });
    compare("the residual", &obtained, &expected)
        .within(1e-8)
        .labelled(&ROWS, &[])
        .or(&GRAVITY_FORGOTTEN, &Case { gravity: Vector3::zeros(), ..*case }.residual())
        .or(&GRAVITY_SIGN, &rising)
        .or(&GRAVITY_SIGN, &in_rows(3, &rising))
        .or(&GRAVITY_SIGN, &in_rows(6, &rising))
        .or(&CARRY_FORGOTTEN, &case.carried_by_nothing().residual())
        .or(&LEFT_IN_THE_WORLD, &in_world)
        .or(&UNTRANSPOSED_BLOCK, &back)
        .or(&UNTRANSPOSED_BLOCK, &half_back)
        .or(&REVERSED, &-expected)
        .or(&ROTATION_REVERSED, &in_rows(0, &-expected))
        .or(&OTHER_SIDE, &rows_turned(&expected, deltas.rotation.matrix(), &PARTS[..1]))
        .judge()
        .map_err(|failure| case.shown(failure))
}

/// The Jacobian against differences.
///
/// # Errors
///
/// A failure, which names what the blocks are instead where that is known.
pub fn jacobian(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { deltas, first, second, gravity } = case;
    let obtained = Answer(answer).by_first(deltas, first, second, gravity)?;
    let slope = case.slope(Steps::Body);
    let with = |row: usize, column: usize, block: &Matrix3<f64>| {
        let mut matrix = slope;
        matrix.fixed_view_mut::<3, 3>(row, column).copy_from(block);
        matrix
    };
    let corner = slope.fixed_view::<3, 3>(0, 0).into_owned();
    let phi = case.residual().fixed_rows::<3>(0).into();
    let straight = so3::right_jacobian(&phi);
    let stated = (first.world_from_body.inverse() * second.world_from_body).into_inner();
    let left_inverse = so3::right_jacobian_inverse(&-phi);
    let negated = |parts: &[usize]| {
        let mut matrix = slope;
        for at in parts {
            matrix.fixed_view_mut::<3, 3>(*at, 0).neg_mut();
        }
        matrix
    };
    let measured = {
        let mut matrix = case.agreed().slope(Steps::Body);
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&corner);
        matrix
    };
    let weightless = Case { gravity: Vector3::zeros(), ..*case };
    let rising = Case { gravity: -gravity, ..*case }.slope(Steps::Body);
    let turned_in_rising = |row: usize| with(row, 0, &rising.fixed_view::<3, 3>(row, 0).into());
    compare("the Jacobian", &obtained, &slope)
        .within(1e-7)
        .labelled(&ROWS, &COLUMNS)
        .or(&WORLD_STEPS, &case.slope(Steps::World))
        .or(&INVERSE_JACOBIAN_FORGOTTEN, &with(0, 0, &(straight * corner)))
        .or(&INVERSE_JACOBIAN_FORGOTTEN, &with(0, 0, &(straight * straight * corner)))
        .or(&UNTRANSPOSED_BLOCK, &with(0, 0, &(corner * stated * stated)))
        .or(&LEFT_INVERSE_JACOBIAN, &with(0, 0, &(left_inverse * straight * corner)))
        .or(&SKEW_SIGN, &negated(&PARTS[1..]))
        .or(&SKEW_SIGN, &negated(&PARTS[1..2]))
        .or(&SKEW_SIGN, &negated(&PARTS[2..]))
        .or(&CARRY_FORGOTTEN, &with(6, 3, &Matrix3::zeros()))
        .or(&CARRY_FORGOTTEN, &with(6, 0, &case.carried_by_nothing().leak()))
        .or(&MEASURED_FOR_STATED, &measured)
        .or(&GRAVITY_FORGOTTEN, &weightless.slope(Steps::Body))
        .or(&GRAVITY_SIGN, &rising)
        .or(&GRAVITY_SIGN, &turned_in_rising(3))
        .or(&GRAVITY_SIGN, &turned_in_rising(6))
        .or(&REVERSED, &-slope)
        .judge()
        .map_err(|failure| case.shown(by_blocks(failure, &obtained, &slope)))?;
    derived(answer, case)
}

/// Whether a Jacobian was derived: differences of residuals lose their digits here.
fn derived(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let turned = case.beside_a_half_turn();
    let Case { deltas, first, second, gravity } = &turned.far_off();
    let mut obtained = Answer(answer).by_first(deltas, first, second, gravity)?;
    let slope = turned.slope(Steps::Body);
    // What a turn does to the position contains a difference of two far positions.
    let block = slope.fixed_view::<3, 3>(6, 0);
    obtained.fixed_view_mut::<3, 3>(6, 0).copy_from(&block);
    compare("the Jacobian", &obtained, &slope).within(1e-7).judge().map_err(|failure| {
        let shown = by_blocks(failure, &obtained, &slope);
        Failure { numbers: shown.numbers, ..Failure::known(&DIFFERENCED) }
    })
}

/// A failure that shows the blocks that are wrong, three at most: nine columns are wider than a
/// terminal.
fn by_blocks(failure: Failure, obtained: &Matrix9, expected: &Matrix9) -> Failure {
    const NAMES: [&str; 3] = ["the rotation", "the velocity", "the position"];
    let mut numbers = Vec::new();
    let mut wrong = Vec::new();
    for (row, column) in (0..9).map(|block| (block / 3, block % 3)) {
        let of = |matrix: &Matrix9| matrix.fixed_view::<3, 3>(3 * row, 3 * column).into_owned();
        let (is, should_be) = (of(obtained), of(expected));
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-7 * expected.amax();
        if is.iter().zip(&should_be).all(near) {
            continue;
        }
        let name = format!("{} by {}", NAMES[row], NAMES[column]);
        let block = compare(&name, &is, &should_be)
            .within(1e-7)
            .labelled(&ROWS[3 * row..], &COLUMNS[3 * column..][..3])
            .judge();
        numbers.extend(block.err().map(|block| format!("{name}\n{}", block.numbers)));
        wrong.push(name);
    }
    let failure = match failure.misconception {
        Some(_) => failure,
        None => {
            Failure::new(format!("{} These blocks differ: {}.", failure.sentence, wrong.join(", ")))
        }
    };
    numbers.truncate(3);
    failure.with_numbers(numbers.join("\n"))
}

impl Case {
    /// The derivative of the position's residual by a turn.
    fn leak(&self) -> Matrix3<f64> {
        self.slope(Steps::Body).fixed_view::<3, 3>(6, 0).into_owned()
    }
}

/// The Jacobian of a window that is turned about the vertical and moved, against that of the
/// window as it was.
///
/// # Errors
///
/// A failure when the two differ.
pub fn moved(
    answer: &dyn Transport,
    case: &Case,
    yaw: f64,
    by: &Vector3<f64>,
) -> Result<(), Failure> {
    let turn = so3::exp(&(yaw * case.gravity.normalize()));
    let moved = |state: &State| State {
        world_from_body: turn * state.world_from_body,
        velocity: turn * state.velocity,
        position: turn * state.position + by,
    };
    let elsewhere = Case { first: moved(&case.first), second: moved(&case.second), ..*case };
    let Case { deltas, first, second, gravity } = &elsewhere;
    let obtained = Answer(answer).by_first(deltas, first, second, gravity)?;
    let slope = case.slope(Steps::Body);
    compare("the Jacobian of the window that was moved", &obtained, &slope)
        .within(1e-7)
        .labelled(&ROWS, &COLUMNS)
        .or(&WORLD_STEPS, &elsewhere.slope(Steps::World))
        .judge()
        .map_err(|failure| elsewhere.shown(by_blocks(failure, &obtained, &slope)))?;
    derived(answer, &elsewhere)
}

/// The dictionary between the two kinds of steps, on a derivative found by differences.
///
/// # Errors
///
/// A failure, which names the dictionary that was used instead where that is known.
pub fn dictionary(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let (body, world) = (case.slope(Steps::Body), case.slope(Steps::World));
    let obtained = Answer(answer).by_world_steps(&case.first, &body)?;
    let turn = case.first.world_from_body.matrix();
    compare("the derivative by steps in the world", &obtained, &world)
        .within(1e-7)
        .labelled(&ROWS, &COLUMNS)
        .or(&INVERSE_DICTIONARY, &columns_turned(&body, turn, &PARTS[1..]))
        .or(&ROTATION_TURNED_TOO, &columns_turned(&world, &turn.transpose(), &PARTS[..1]))
        .judge()
        .map_err(|failure| by_blocks(failure, &obtained, &world))
}
