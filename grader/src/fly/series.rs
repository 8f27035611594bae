//! An answer to one flight beside the truth: errors, and what they are worth by its own covariances.

use nalgebra::{Matrix3, Matrix6, Rotation3, SMatrix, Vector3};
use vislam::filtering::{BlockNees, Freedom, StateError, align, attitude_in_world};
use vislam::inertial::NavState;
use vislam::manifold::so3;
use vislam::observability::Similarity;

use super::flights::Graded;
use super::reference::Line;

/// So many sweeps find the singular values of three columns, and many more than are needed.
const SWEEPS: usize = 200;
/// When the parts of a state are looked at, in seconds: late enough that something has been learnt.
pub const TIMES: [f64; 3] = [10.0, 15.0, 20.0];
/// A line may be so far off such a time, in seconds: an answer may end as early.
const NEAR: f64 = 0.16;
/// Of lines that are nearer to each other, in seconds, some are left out, so that an answer with a line for each
/// reading is measured like one with a line for each picture.
const LEAST_APART: f64 = 0.075;

/// One line of an answer in the world of the truth.
#[derive(Debug, Clone, Copy)]
pub struct Beside {
    /// Since the beginning of the flight.
    pub seconds: f64,
    /// What was estimated, laid onto the truth where the answer begins.
    pub estimate: NavState,
    /// The truth.
    pub truth: NavState,
    /// The true angular velocity, in the body, in rad/s.
    pub turning: Vector3<f64>,
    /// The covariance of a turn in the body and of the position in the world of the truth.
    pub covariance: Matrix6<f64>,
}

impl Beside {
    /// What has to be added to the estimate.
    pub fn error(&self) -> StateError {
        StateError::between(&self.estimate, &self.truth)
    }

    /// The standard deviations of the tilt on an axis, of the yaw, and of the position in all.
    pub fn sigmas(&self) -> [f64; 3] {
        let turn: Matrix3<f64> = self.covariance.fixed_view::<3, 3>(0, 0).into();
        let turn = attitude_in_world(&self.estimate, &turn);
        let position = self.covariance.fixed_view::<3, 3>(3, 3).trace();
        [0.5 * (turn.m11 + turn.m22), turn.m33, position].map(f64::sqrt)
    }

    /// The normalized errors squared of tilt, yaw and position; `None` where the covariance is none.
    pub fn nees(&self) -> Option<[f64; 3]> {
        let mut covariance = SMatrix::<f64, 9, 9>::identity();
        let place = |coordinate: usize| if coordinate < 3 { coordinate } else { coordinate + 3 };
        for (row, column) in (0..6).flat_map(|row| (0..6).map(move |column| (row, column))) {
            covariance[(place(row), place(column))] = self.covariance[(row, column)];
        }
        let estimate = NavState { velocity: self.truth.velocity, ..self.estimate };
        let nees = BlockNees::of(&estimate, &self.truth, &covariance).ok()?;
        Some([nees.tilt, nees.yaw, nees.position])
    }
}

/// An answer to one flight beside the truth.
#[derive(Debug, Clone)]
pub struct Series {
    /// Its lines.
    pub lines: Vec<Beside>,
    /// What takes the body as it was estimated to the body as it was, in the body, when the positions say how
    /// the worlds are turned to each other.
    turns: Vec<Rotation3<f64>>,
    /// The root mean square of what is left of the position errors when yaw and position were aligned
    /// over the whole flight, in metres.
    pub aligned: f64,
    /// How long the estimated path is beside the true one: the factor that fits best, less one.
    pub scale: f64,
}

impl Series {
    /// Lays an answer onto the truth by yaw and position of its first line; `None` when it has no two
    /// lines or numbers that are not finite.
    pub fn of(flight: &Graded, lines: &[Line]) -> Option<Self> {
        let lines = thinned(flight, lines);
        let states: Vec<NavState> = lines.iter().map(|line| line.state).collect();
        let truth: Vec<NavState> =
            lines.iter().map(|line| flight.truth(line.nanoseconds)).collect();
        let first = Similarity::between(states.first()?, truth.first()?);
        let turn = first.rotation;
        let beside = lines.iter().zip(&truth).map(|(line, truth)| {
            let mut spread = Matrix6::identity();
            spread.fixed_view_mut::<3, 3>(3, 3).copy_from(turn.matrix());
            Beside {
                seconds: flight.seconds(line.nanoseconds),
                estimate: first.state(&line.state, &Vector3::zeros(), &Vector3::zeros()),
                truth: *truth,
                turning: flight.turning(line.nanoseconds),
                covariance: spread * line.covariance * spread.transpose(),
            }
        });
        // A body that is said not to have moved is laid on by its first line alone.
        let alignment = align(&states, &truth, Freedom::Four).unwrap_or(first);
        let turns = states.iter().zip(&truth).map(|(state, truth)| {
            truth.world_from_body.inverse() * alignment.rotation * state.world_from_body
        });
        let (turns, lines) = (turns.collect(), beside.collect());
        let (aligned, scale) = after_alignment(&alignment, &states, &truth)?;
        Some(Self { lines, turns, aligned, scale })
    }

    /// The line nearest to a time, if one is near.
    pub fn at(&self, seconds: f64) -> Option<&Beside> {
        let off = |line: &&Beside| (line.seconds - seconds).abs();
        let near = self.lines.iter().min_by(|one, other| off(one).total_cmp(&off(other)));
        near.filter(|line| off(line) <= NEAR)
    }

    /// The turn that takes the body as it was estimated to the body as it was, where it is the same all
    /// along, and by how much it scatters, in radians.
    pub fn turn_in_body(&self) -> (Rotation3<f64>, f64) {
        let mean = nearest(&self.turns.iter().map(|turn| *turn.matrix()).sum());
        let off = |turn: &Rotation3<f64>| so3::local(&mean, turn).norm_squared();
        let squares: f64 = self.turns.iter().map(off).sum();
        (mean, (squares / self.turns.len() as f64).sqrt())
    }
}

/// Lines about as far apart as pictures.
fn thinned(flight: &Graded, lines: &[Line]) -> Vec<Line> {
    let mut last = f64::NEG_INFINITY;
    let is_next = |line: &&Line| {
        let seconds = flight.seconds(line.nanoseconds);
        let is_next = seconds - last >= LEAST_APART;
        if is_next {
            last = seconds;
        }
        is_next
    };
    lines.iter().filter(is_next).copied().collect()
}

/// The rotation nearest to a matrix, whatever the matrix is.
fn nearest(matrix: &Matrix3<f64>) -> Rotation3<f64> {
    let svd = matrix.try_svd(true, true, f64::EPSILON, SWEEPS);
    let Some((u, v)) = svd.and_then(|svd| Some((svd.u?, svd.v_t?.transpose()))) else {
        return Rotation3::identity();
    };
    let sign = (u * v.transpose()).determinant().signum();
    let mirrored = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign));
    Rotation3::from_matrix_unchecked(u * mirrored * v.transpose())
}

/// The root mean square of the position errors after an alignment of yaw and position, and by how much the
/// path has grown.
fn after_alignment(
    alignment: &Similarity,
    states: &[NavState],
    truth: &[NavState],
) -> Option<(f64, f64)> {
    let moved: Vec<Vector3<f64>> =
        states.iter().map(|state| alignment.point(&state.position)).collect();
    let count = states.len() as f64;
    let centre = |places: &mut dyn Iterator<Item = Vector3<f64>>| {
        places.fold(Vector3::zeros(), |sum, place| sum + place) / count
    };
    let (a, b) =
        (centre(&mut moved.iter().copied()), centre(&mut truth.iter().map(|state| state.position)));
    let (mut left, mut along, mut size) = (0.0, 0.0, 0.0);
    for (place, truth) in moved.iter().zip(truth) {
        left += (place - truth.position).norm_squared();
        along += (place - a).dot(&(truth.position - b));
        size += (truth.position - b).norm_squared();
    }
    (size > 0.0).then(|| ((left / count).sqrt(), along / size - 1.0))
}
