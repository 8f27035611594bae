//! What is asked about an answer, and on which instances.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{
    DMatrix, Matrix3, Point3, Rotation3, SMatrix, Similarity3, UnitQuaternion, Vector3,
};
use vislam::inertial::{GRAVITY, ImuBias};
use vislam::manifold::so3;
use vislam::preintegration::imu_residual;
use vislam::simulation::{EulerAngles, ScalarTrajectory, Trajectory};

use super::*;
use crate::Exercise;
use crate::answer::{Spoiled, Transport};
use crate::check::{Check, Failure, Misconception, compare, show_list};
use crate::draw::Draw;
use crate::navigation::given;
use crate::picture::{Dots, Picture};

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "scale_and_gravity",
    title: "Scale from inertial readings",
    chapter: "observability",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Deltas", "Interval", "State", "Vector9", "Window"],
    forbidden: &[
        "factors",
        "imu_residual",
        "least_squares",
        "linearize",
        "observability",
        "predict",
        "simulation",
    ],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    SCALED_ABOUT_ORIGIN, "scaled_about_origin":
        "The window grew about the origin of the world, and its first state has moved. A prior \
         pins that state: what would it say to this window? About which point may everything else \
         grow?";
    VELOCITIES_OMITTED, "velocities_omitted":
        "The positions grow and the velocities do not. The states are as many seconds apart as \
         before: how fast must a body be to go twice as far in the same time?";
    POINTS_OMITTED, "points_omitted":
        "The states are apart farther and the landmarks are where they were. Along which ray does \
         the second state see them now?";
    GRAVITY_SCALED, "gravity_scaled":
        "Gravity grows with the window here. A unit of length is ours to choose, but does a \
         stone fall faster because we draw the map larger?";
    DELTAS_SCALED, "deltas_scaled":
        "A measured delta grows with the window. When an optimizer tries another scale, what \
         happens to the numbers that the sensor has written down?";
    ROTATION_SCALED, "rotation_scaled":
        "The rotation's residual stands among what grows. Which lengths are there in an angle?";
    HALF_FORGOTTEN, "half_forgotten":
        "In the position a half is missing. How fast is a body on average that begins at rest and \
         gains a t in t seconds, and how far does it get?";
    TIME_FORGOTTEN, "time_forgotten":
        "A bound lacks the time. The tolerance is in m/s²: what makes m/s of it, and what metres?";
    REST_FIXED, "rest_fixed":
        "Wherever there is gravity the scale is called fixed, for a body at rest too. What does its \
         accelerometer read, and what is left of that, in velocity and in position, when gravity \
         is taken into account?";
    GRAVITY_ALONE, "gravity_alone":
        "Scale is called free exactly where nothing weighs. A body at constant velocity weighs \
         something: add what gravity does in the interval to what the accelerometer adds up to. \
         What is left that could fix the scale?";
    SILENT_ACCELEROMETER, "silent_accelerometer":
        "Scale is called free exactly where the accelerometer adds up to nothing. When does it \
         read nothing in a world with gravity, and what does the velocity do then?";
    ROTATION_FIXES_SCALE, "rotation_fixes_scale":
        "A turning body at constant velocity is said to know its scale. With gravity taken into \
         account in the right frame, which number in metres has turning added?";
    VELOCITY_ALONE, "velocity_alone":
        "Only the velocity was asked. A body that is as fast at the end as at the beginning may \
         have sped up and slowed down between: which other number of the interval knows of it?";
    EITHER_SUFFICES, "either_suffices":
        "An interval is said to leave the scale free when its velocity or its position says so. \
         Who decides when the other one objects?";
    ONE_INTERVAL_SUFFICES, "one_interval_suffices":
        "One interval that leaves the scale free was taken for enough. The window has one scale \
         for all its intervals: who decides when one of them objects?";
    GRAVITY_IN_BODY, "gravity_in_body":
        "The verdicts are wrong where the body is tilted. The deltas stand in the first body frame \
         and gravity in the world: which way does the rotation take it?";
}

impl Spoiled for Window {
    fn spoiled(number: f64) -> Self {
        let vector = Vector3::repeat(number);
        let state = State {
            world_from_body: Rotation3::from_matrix_unchecked(Matrix3::repeat(number)),
            velocity: vector,
            position: vector,
        };
        let states = if number == 0.0 { Vec::new() } else { vec![state] };
        Self { states, landmarks: Vec::spoiled(number) }
    }
}

impl Window {
    /// States on a figure-eight that begins anywhere, and landmarks around it.
    pub fn drawn(draw: &mut Draw, states: usize, landmarks: usize, away: [f64; 2]) -> Self {
        let (start, offset) = (draw.uniform(0.0..10.0), draw.vector(away[0]..away[1]));
        let state = |k: usize| {
            let state = State::of(&Trajectory::figure_eight().at(start + 0.5 * k as f64).state);
            State { position: state.position + offset, ..state }
        };
        Self {
            states: (0..states).map(state).collect(),
            landmarks: (0..landmarks).map(|_| offset + draw.vector(4.0..9.0)).collect(),
        }
    }

    /// The window after a similarity of space: velocities go from where a body is to where it
    /// would be after a second.
    fn after(&self, similarity: &Similarity3<f64>) -> Self {
        let point = |p: &Vector3<f64>| similarity.transform_point(&Point3::from(*p)).coords;
        let state = |state: &State| State {
            velocity: point(&(state.position + state.velocity)) - point(&state.position),
            position: point(&state.position),
            ..*state
        };
        Self {
            states: self.states.iter().map(state).collect(),
            landmarks: self.landmarks.iter().map(point).collect(),
        }
    }

    /// Every number of it, three in a row, with names of the rows.
    fn rows(&self) -> (Vec<String>, DMatrix<f64>) {
        let (mut names, mut rows) = (Vec::new(), Vec::new());
        for (k, state) in self.states.iter().enumerate() {
            names.extend(["p", "v", "rot"].map(|name| format!("{name} {k}")));
            rows.extend([state.position, state.velocity, so3::log(&state.world_from_body)]);
        }
        for (j, landmark) in self.landmarks.iter().enumerate() {
            names.push(format!("P {j}"));
            rows.push(*landmark);
        }
        (names, DMatrix::from_fn(rows.len(), 3, |row, column| rows[row][column]))
    }

    /// The direction in which a state sees a landmark.
    fn ray(&self, state: usize, landmark: usize) -> Vector3<f64> {
        let state = &self.states[state];
        (state.world_from_body.inverse() * (self.landmarks[landmark] - state.position)).normalize()
    }

    /// The first state and landmark, counted from zero, of which another window has another
    /// picture.
    fn other_picture(&self, other: &Self) -> Option<(usize, usize)> {
        let all =
            (0..self.states.len()).flat_map(|k| (0..self.landmarks.len()).map(move |j| (k, j)));
        all.into_iter().find(|&(k, j)| (self.ray(k, j) - other.ray(k, j)).norm() > 1e-9)
    }

    /// What it looks like from above. Lines lead to where half a second takes the states; landmarks
    /// have none.
    fn plan(&self, name: &str) -> Dots {
        let seen = |p: Vector3<f64>| [p.x, p.y];
        let states = self.states.iter();
        let points = states.clone().map(|state| state.position).chain(self.landmarks.clone());
        let later = states.map(|state| state.position + 0.5 * state.velocity);
        Dots::new(name, points.map(seen)).with_ways(later.map(seen))
    }
}

/// The instances that students have.
fn windows() -> Vec<(Window, f64)> {
    let mut draw = Draw::new(9);
    let scales = [2.0, 0.5, 1.3, 3.0, 0.8];
    scales.map(|scale| (Window::drawn(&mut draw, 4, 6, [5.0, 15.0]), scale)).into()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("a_larger_window_makes_the_same_pictures", |answer| {
            windows().iter().try_for_each(|(window, scale)| larger(answer, window, *scale))
        }),
        Check::new("the_residual_is_a_part_that_grows_and_a_part_that_stays", |answer| {
            let mut draw = Draw::new(10);
            (0..20).try_for_each(|_| split(answer, &Pair::drawn(&mut draw, [0.3, 1.5])))
        }),
        Check::new("the_verdict_is_that_of_the_residual_when_it_grows", |answer| {
            verdicts(answer, &Flights::drawn(&mut Draw::new(11), [0.4, 0.7]))
        }),
    ]
}

/// The larger window against a similarity of space.
///
/// # Errors
///
/// A failure, which says what has grown and what has not where that is known.
pub fn larger(answer: &dyn Transport, window: &Window, scale: f64) -> Result<(), Failure> {
    let obtained = Answer(answer).scaled_window(window, &scale)?;
    let count = |window: &Window| (window.states.len(), window.landmarks.len());
    if count(&obtained) != count(window) {
        let ((states, landmarks), (k, j)) = (count(window), count(&obtained));
        return Err(Failure::new(format!(
            "The window has {states} states and {landmarks} landmarks; {k} and {j} came back."
        )));
    }
    let about = |centre: &Vector3<f64>| {
        let shift = centre - scale * centre;
        window.after(&Similarity3::from_parts(shift.into(), UnitQuaternion::identity(), scale))
    };
    let expected = about(&window.states[0].position);
    let with_velocities = |grown: &Window| {
        let mut grown = grown.clone();
        for (state, before) in grown.states.iter_mut().zip(&window.states) {
            state.velocity = before.velocity;
        }
        grown
    };
    let same_points = Window { landmarks: window.landmarks.clone(), ..expected.clone() };
    let (names, rows) = expected.rows();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    compare("the larger window", &obtained.rows().1, &rows)
        .within(1e-9)
        .labelled(&names, &["x", "y", "z"])
        .or(&SCALED_ABOUT_ORIGIN, &about(&Vector3::zeros()).rows().1)
        .or(&VELOCITIES_OMITTED, &with_velocities(&expected).rows().1)
        .or(&POINTS_OMITTED, &same_points.rows().1)
        .judge()
        .map_err(|failure| seen(failure, window, &obtained))
        .map_err(|failure| {
            failure.with_picture(Picture {
                title: "From above: landmarks, and states with their way of half a second"
                    .to_owned(),
                axes: ["x, m".to_owned(), "y, m".to_owned()],
                expected: expected.plan("expected"),
                obtained: obtained.plan("obtained"),
                downward: false,
            })
        })
}

/// A failure that says which picture has changed, where it says nothing better.
fn seen(failure: Failure, window: &Window, obtained: &Window) -> Failure {
    let finite = obtained.rows().1.iter().all(|number| number.is_finite());
    match (failure.misconception, window.other_picture(obtained)) {
        (None, Some((k, j))) if finite => {
            let sentence = format!(
                "{} State {k} sees landmark {j} in another direction than before, and every \
                 picture should stay what it is.",
                failure.sentence
            );
            Failure { sentence, ..failure }
        }
        _ => failure,
    }
}

/// Two states and what the readings between them say.
#[derive(Debug, Clone, Copy)]
pub struct Pair {
    /// The readings.
    pub deltas: Deltas,
    /// The state at the beginning.
    pub first: State,
    /// The state at the end.
    pub second: State,
    /// In the world, in m/s².
    pub gravity: Vector3<f64>,
}

impl Pair {
    /// States that need not agree with the readings, as far apart as a number of the range, in
    /// seconds.
    pub fn drawn(draw: &mut Draw, duration: [f64; 2]) -> Self {
        Self {
            deltas: Deltas::drawn(draw, duration),
            first: State::drawn(draw),
            second: State::drawn(draw),
            gravity: draw.vector(4.0..12.0),
        }
    }

    /// The residual of the states when lengths and velocities have grown by factors.
    fn residual(&self, lengths: f64, velocities: f64) -> Vector9 {
        let grown = |state: &State| State {
            velocity: velocities * state.velocity,
            position: lengths * state.position,
            ..*state
        };
        let (first, second) = (grown(&self.first).nav(), grown(&self.second).nav());
        let sums = self.deltas.preintegrated();
        imu_residual(&sums, &first, &second, &self.gravity, &ImuBias::default())
    }
}

/// The two parts of the residual against residuals of grown states.
///
/// # Errors
///
/// A failure, which says what stands in the wrong part where that is known.
pub fn split(answer: &dyn Transport, pair: &Pair) -> Result<(), Failure> {
    let Pair { deltas, first, second, gravity } = pair;
    let (grows, stays) = Answer(answer).split_residual(deltas, first, second, gravity)?;
    let whole = pair.residual(1.0, 1.0);
    // Whatever stays, the rest is what grows.
    let parts = |stays: &Vector9| SMatrix::<f64, 9, 2>::from_columns(&[whole - stays, *stays]);
    let none = Deltas { velocity: Vector3::zeros(), position: Vector3::zeros(), ..*deltas };
    let right = pair.residual(0.0, 0.0);
    let without_rotation = Vector9::from_fn(|row, _| if row < 3 { 0.0 } else { right[row] });
    let no_deltas = Pair { deltas: none, ..*pair }.residual(0.0, 0.0);
    let weightless = Pair { gravity: Vector3::zeros(), ..*pair }.residual(0.0, 0.0);
    let heavy = Pair { gravity: 2.0 * gravity, ..*pair }.residual(0.0, 0.0);
    // Wrong in one of the two lines, of the velocity and of the position.
    let in_rows = |at: usize, other: &Vector9| {
        Vector9::from_fn(|row, _| if row / 3 * 3 == at { other[row] } else { right[row] })
    };
    let half_forgotten = SMatrix::<f64, 9, 2>::from_columns(&[whole - right, in_rows(6, &heavy)]);
    let obtained = SMatrix::<f64, 9, 2>::from_columns(&[grows, stays]);
    compare("the residual in two parts", &obtained, &parts(&right))
        .within(1e-9)
        .labelled(&ROWS, &["times s", "stays"])
        .or(&DELTAS_SCALED, &parts(&no_deltas))
        .or(&DELTAS_SCALED, &parts(&in_rows(3, &no_deltas)))
        .or(&DELTAS_SCALED, &parts(&in_rows(6, &no_deltas)))
        .or(&GRAVITY_SCALED, &parts(&weightless))
        .or(&GRAVITY_SCALED, &parts(&in_rows(3, &weightless)))
        .or(&GRAVITY_SCALED, &parts(&in_rows(6, &weightless)))
        .or(&HALF_FORGOTTEN, &half_forgotten)
        .or(&ROTATION_SCALED, &parts(&without_rotation))
        .or(&VELOCITIES_OMITTED, &parts(&pair.residual(0.0, 1.0)))
        .judge()
        .map_err(|failure| given(failure, deltas, [first, second], gravity))
}

const ROWS: [&str; 9] =
    ["r_phi x", "r_phi y", "r_phi z", "r_v x", "r_v y", "r_v z", "r_p x", "r_p y", "r_p z"];

/// A motion as the function sees it.
#[derive(Debug, Clone)]
pub struct Flight {
    /// What it is, for a sentence.
    pub name: &'static str,
    /// What its sensor says.
    pub intervals: Vec<Interval>,
    /// In the world, in m/s².
    pub gravity: Vector3<f64>,
}

impl Flight {
    /// The readings of a motion from one time to the next, from its formulas.
    fn new(name: &'static str, motion: &Trajectory, gravity: &Vector3<f64>, times: &[f64]) -> Self {
        let between = |pair: &[f64]| {
            let (first, last) = (motion.at(pair[0]).state, motion.at(pair[1]).state);
            let (body_from_world, t) = (first.world_from_body.inverse(), pair[1] - pair[0]);
            let (v, p) = (first.velocity, first.position);
            let deltas = Deltas {
                duration: t,
                rotation: body_from_world * last.world_from_body,
                velocity: body_from_world * (last.velocity - v - t * gravity),
                position: body_from_world * (last.position - p - t * v - 0.5 * t * t * gravity),
            };
            Interval { world_from_first: first.world_from_body, deltas }
        };
        let intervals = times.windows(2).map(between).collect();
        Self { name, intervals, gravity: *gravity }
    }

    /// By how much the residual of each interval changes when states that agree with the readings
    /// are made larger by one part of themselves: velocity and position.
    fn changes(&self, gravity: &Vector3<f64>) -> Vec<[f64; 2]> {
        let change = |interval: &Interval| {
            let first = State {
                world_from_body: interval.world_from_first,
                velocity: Vector3::new(1.0, -2.0, 0.5),
                position: Vector3::zeros(),
            };
            let (deltas, gravity) = (interval.deltas, *gravity);
            let second = deltas.lead(&first, &gravity);
            let pair = Pair { deltas, first, second, gravity };
            let change = pair.residual(2.0, 2.0) - pair.residual(1.0, 1.0);
            [change.fixed_rows::<3>(3).norm(), change.fixed_rows::<3>(6).norm()]
        };
        self.intervals.iter().map(change).collect()
    }

    /// Whether each interval leaves the scale free.
    fn free(&self, gravity: &Vector3<f64>, tolerance: f64) -> Vec<bool> {
        self.judged(gravity, |change, t| {
            change[0] <= tolerance * t && change[1] <= 0.5 * tolerance * t * t
        })
    }

    /// What is said of each interval by its changes and its duration.
    fn judged(&self, gravity: &Vector3<f64>, judge: impl Fn([f64; 2], f64) -> bool) -> Vec<bool> {
        let changes = self.changes(gravity).into_iter().zip(&self.intervals);
        changes.map(|(change, interval)| judge(change, interval.deltas.duration)).collect()
    }
}

/// A body that stands as nobody would put it.
fn tilted() -> EulerAngles {
    EulerAngles {
        yaw: ScalarTrajectory::constant(1.3),
        pitch: ScalarTrajectory::constant(0.5),
        roll: ScalarTrajectory::constant(-0.7),
    }
}

/// Motions at constant velocity.
fn steady(draw: &mut Draw, t: f64) -> Vec<Flight> {
    let (nothing, times) = (Vector3::zeros(), [0.0, t, 2.0 * t]);
    let turning = EulerAngles {
        yaw: ScalarTrajectory { rate: draw.uniform(0.5..1.0), ..tilted().yaw },
        pitch: ScalarTrajectory::wave(0.4, draw.uniform(0.8..1.5), 0.3),
        roll: ScalarTrajectory::wave(0.5, draw.uniform(0.8..1.5), 1.0),
    };
    let ahead = draw.vector(1.0..5.0);
    let straight = |angles| Trajectory::constant_velocity(&ahead, angles);
    let rest = Trajectory { angles: tilted(), ..Trajectory::hover() };
    vec![
        Flight::new("at rest, level", &Trajectory::hover(), &GRAVITY, &times),
        Flight::new("at rest, tilted", &rest, &GRAVITY, &times),
        Flight::new("straight ahead", &straight(tilted()), &GRAVITY, &times),
        Flight::new("straight ahead and turning", &straight(turning), &GRAVITY, &times),
        Flight::new("straight ahead where nothing weighs", &straight(tilted()), &nothing, &times),
    ]
}

/// Motions that accelerate all the time.
fn pushed(draw: &mut Draw, t: f64) -> Vec<Flight> {
    let (nothing, times) = (Vector3::zeros(), [0.0, t, 2.0 * t]);
    let faster = Trajectory::constant_acceleration(&draw.vector(0.5..3.0), tilted());
    let falling = Trajectory::constant_acceleration(&GRAVITY, tilted());
    let level = Trajectory::level_turn(draw.uniform(1.0..4.0), draw.uniform(0.4..1.0));
    let ahead = Trajectory::constant_velocity(&draw.vector(1.0..5.0), tilted());
    let mut later = Flight::new("straight ahead, then faster", &ahead, &GRAVITY, &times);
    let end = Flight::new("", &faster, &GRAVITY, &times);
    later.intervals.splice(1.., end.intervals.into_iter().skip(1));
    vec![
        Flight::new("faster and faster", &faster, &GRAVITY, &times),
        Flight::new("faster and faster where nothing weighs", &faster, &nothing, &times),
        Flight::new("falling freely", &falling, &GRAVITY, &times),
        Flight::new("a level turn", &level, &GRAVITY, &times),
        later,
    ]
}

/// Motions of one oscillation, of so many seconds.
fn to_and_fro(t: f64) -> Vec<Flight> {
    let rocking = |phase: f64| Trajectory {
        position: [
            ScalarTrajectory { rate: 1.0, ..ScalarTrajectory::wave(0.3, TAU / t, phase) },
            ScalarTrajectory::linear(0.5),
            ScalarTrajectory::default(),
        ],
        angles: tilted(),
        ..Trajectory::default()
    };
    let (full_speed, turning_point) = (rocking(0.0), rocking(FRAC_PI_2));
    let (whole, halves) = ([0.0, t], [0.0, 0.5 * t, t]);
    vec![
        Flight::new("to and fro, from full speed", &full_speed, &GRAVITY, &whole),
        Flight::new("to and fro, from a turning point", &turning_point, &GRAVITY, &whole),
        Flight::new("the same, with a state halfway", &turning_point, &GRAVITY, &halves),
    ]
}

/// Motions whose changes come near to what is tolerated: of both kinds, of position alone, and of
/// velocity alone, and in an interval of more than a second.
fn near(tolerance: f64, t: f64) -> Vec<Flight> {
    // An oscillation that lasts as long as the interval changes the position alone, and what an
    // acceleration adds to the position can be taken off by one.
    let coordinate = |acceleration: f64, displaced: f64| ScalarTrajectory {
        acceleration,
        ..ScalarTrajectory::wave(-displaced * t * t / (2.0 * TAU), TAU / t, 0.0)
    };
    let lasting = |name, coordinate, t| {
        let position = [ScalarTrajectory::linear(1.0), coordinate, ScalarTrajectory::default()];
        Flight::new(
            name,
            &Trajectory { position, angles: tilted(), ..Trajectory::default() },
            &GRAVITY,
            &[0.0, t],
        )
    };
    let flight = |name, coordinate| lasting(name, coordinate, t);
    let (less, more) = (0.8 * tolerance, 1.25 * tolerance);
    vec![
        flight("four fifths of the tolerance", coordinate(less, 0.0)),
        flight("five quarters of the tolerance", coordinate(more, 0.0)),
        flight("four fifths, in position alone", coordinate(0.0, less)),
        flight("five quarters, in position alone", coordinate(0.0, more)),
        flight("four fifths, in velocity alone", coordinate(less, -less)),
        flight("five quarters, in velocity alone", coordinate(more, -more)),
        lasting("four fifths of the tolerance, for longer", coordinate(less, 0.0), 5.0 * t),
    ]
}

/// Motions of all kinds that matter.
#[derive(Debug, Clone)]
pub struct Flights {
    /// The motions.
    pub all: Vec<Flight>,
    /// In m/s².
    pub tolerance: f64,
}

impl Flights {
    /// Motions of each kind, in intervals as long as numbers of the range, in seconds. There is one
    /// of each and some again, in any order, so that how many are free says nothing.
    pub fn drawn(draw: &mut Draw, duration: [f64; 2]) -> Self {
        let tolerance = draw.uniform(0.02..0.08);
        let mut all = Self::one_of_each(draw, duration, tolerance);
        let mut again = Self::one_of_each(draw, duration, tolerance);
        draw.shuffle(&mut again);
        again.truncate(draw.index(1..11));
        all.extend(again);
        draw.shuffle(&mut all);
        Self { all, tolerance }
    }

    fn one_of_each(draw: &mut Draw, duration: [f64; 2], tolerance: f64) -> Vec<Flight> {
        let t = draw.uniform(duration[0]..duration[1]);
        let mut all = steady(draw, t);
        all.extend(pushed(draw, t));
        all.extend(to_and_fro(t));
        all.extend(near(tolerance, t));
        all
    }

    /// What a way of judging says of every motion.
    fn judged(&self, judge: impl Fn(&Flight) -> bool) -> Vec<bool> {
        self.all.iter().map(judge).collect()
    }

    /// What known ways of judging wrongly say.
    fn known(&self) -> Vec<(&'static Misconception, Vec<bool>)> {
        let tolerance = self.tolerance;
        let right =
            |flight: &Flight| flight.free(&flight.gravity, tolerance).iter().all(|free| *free);
        let turned = |flight: &Flight| {
            flight.intervals.iter().any(|one| so3::log(&one.deltas.rotation).norm() > 1e-6)
        };
        // A way of judging intervals by what velocity and position change, and by the duration.
        let by = |judge: fn([f64; 2], f64, f64) -> bool| {
            self.judged(|flight| {
                let free = flight.judged(&flight.gravity, |change, t| judge(change, t, tolerance));
                free.iter().all(|free| *free)
            })
        };
        let untransposed = |flight: &Flight| {
            let mut other = flight.clone();
            for interval in &mut other.intervals {
                interval.world_from_first = interval.world_from_first.inverse();
            }
            right(&other)
        };
        vec![
            (&HALF_FORGOTTEN, by(|[v, p], t, most| v <= most * t && p <= most * t * t)),
            (&TIME_FORGOTTEN, by(|[v, p], t, most| v <= most && p <= 0.5 * most * t * t)),
            (&TIME_FORGOTTEN, by(|[v, p], t, most| v <= most * t && p <= 0.5 * most * t)),
            (&TIME_FORGOTTEN, by(|[v, p], t, most| v <= most * t && p <= 0.5 * most)),
            (&TIME_FORGOTTEN, by(|[v, p], t, most| v <= most && p <= 0.5 * most * t)),
            (&TIME_FORGOTTEN, by(|[v, p], _, most| v <= most && p <= 0.5 * most)),
            (&REST_FIXED, self.judged(|flight| flight.gravity.norm() == 0.0 && right(flight))),
            (&GRAVITY_ALONE, self.judged(|flight| flight.gravity.norm() < tolerance)),
            (
                &SILENT_ACCELEROMETER,
                self.judged(|flight| {
                    flight.free(&Vector3::zeros(), tolerance).iter().all(|free| *free)
                }),
            ),
            (&ROTATION_FIXES_SCALE, self.judged(|flight| right(flight) && !turned(flight))),
            (&VELOCITY_ALONE, by(|[v, _], t, most| v <= most * t)),
            (&EITHER_SUFFICES, by(|[v, p], t, most| v <= most * t || p <= 0.5 * most * t * t)),
            (
                &ONE_INTERVAL_SUFFICES,
                self.judged(|flight| {
                    flight.free(&flight.gravity, tolerance).iter().any(|free| *free)
                }),
            ),
            (&GRAVITY_IN_BODY, self.judged(untransposed)),
        ]
    }
}

/// The verdicts on all motions together, so that a guess is found out.
///
/// # Errors
///
/// A failure that names the motions judged wrongly, and the way of judging where that is known.
pub fn verdicts(answer: &dyn Transport, flights: &Flights) -> Result<(), Failure> {
    let ask = |flight: &Flight| {
        Answer(answer).scale_is_free(&flight.intervals, &flight.gravity, &flights.tolerance)
    };
    let obtained: Vec<bool> = flights.all.iter().map(ask).collect::<Result<_, _>>()?;
    let free = |flight: &Flight| flight.free(&flight.gravity, flights.tolerance);
    let expected = flights.judged(|flight| free(flight).iter().all(|free| *free));
    let numbers =
        |verdicts: &[bool]| -> Vec<f64> { verdicts.iter().map(|free| f64::from(*free)).collect() };
    show_list(
        "the list of verdicts, one where the scale is free,",
        &numbers(&obtained),
        &numbers(&expected),
    );
    if obtained == expected {
        return Ok(());
    }
    let known = flights.known();
    let rest_is_fixed = flights
        .all
        .iter()
        .zip(&obtained)
        .any(|(flight, free)| flight.name.starts_with("at rest") && !free);
    let failure = match known.iter().find(|(_, judged)| *judged == obtained) {
        Some((misconception, _)) => Failure::known(misconception),
        None if rest_is_fixed => Failure::new(
            "A body at rest is judged fixed: what does its accelerometer read, and in which frame?",
        ),
        None => Failure::new(
            "Some motions are judged wrongly. Write down for one of them what the velocity and \
             the position do in an interval beyond coasting, \
             and how that compares with the tolerance.",
        ),
    };
    let word = |free: bool| if free { "free" } else { "fixed" };
    let mut numbers = format!("{:44}{:>10}{:>10}\n", "", "expected", "obtained");
    for (flight, (expected, obtained)) in flights.all.iter().zip(expected.into_iter().zip(obtained))
    {
        let mark = if expected == obtained { ' ' } else { '*' };
        numbers +=
            &format!("{:44}{:>10}{:>10}{mark}\n", flight.name, word(expected), word(obtained));
    }
    Err(failure.with_numbers(numbers))
}
