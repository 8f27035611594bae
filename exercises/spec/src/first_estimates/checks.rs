//! What is asked about an answer, and on which instances.

mod equations;
mod least_change;
mod verdicts;

use nalgebra::{DMatrix, Rotation2, Vector2};

use super::*;
use crate::Exercise;
use crate::answer::Transport;
use crate::check::{Check, Failure, Misconception, compare};
use crate::draw::Draw;

pub use equations::{Equations, equations};
pub use least_change::{Claiming, least_change};
pub use verdicts::{Displaced, KINDS, Kept, chosen, which_is_lost};

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "first_estimates",
    title: "First estimates in the plane",
    chapter: "consistency",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Measurement", "Pose", "Steps", "What", "Window"],
    forbidden: &[
        "consistency",
        "factors",
        "filtering",
        "least_squares",
        "loop_closure",
        "marginalization",
        "msckf",
        "observability",
        "simulation",
    ],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    ONLY_HEADINGS_TURN, "only_headings_turn":
        "The turn changes headings here, and nothing else. Turn a map about its origin: what \
         becomes of a house that does not stand there?";
    LANDMARKS_STAY, "landmarks_stay":
        "The poses turn with the world, and the landmarks stay where they are. Would a body that \
         sees one of them notice?";
    ABOUT_THE_FIRST_POSE, "about_the_first_pose":
        "This turn leaves the first pose where it stands. About which point does the world turn?";
    TURNED_BACK, "turned_back":
        "Places turn from the second axis to the first here. The heading grows: which way does a \
         point on the first axis go?";
    STEPS_IN_THE_WORLD, "steps_in_the_world":
        "A step of a position is taken as if it stood in the world. In whose coordinates does \
         `Steps::Body` have it?";
    ROTATION_INVERTED, "rotation_inverted":
        "The rotation between body and world was taken the other way. R(θ) δp is how a position \
         moves in the world: which δp makes it move by a metre along the first axis?";
    HEADING_SLOPE, "heading_slope":
        "The derivative by the heading has the opposite sign. When a body turns to the left, \
         which way does what it sees go?";
    POINTS_IGNORED, "points_ignored":
        "The derivatives are those at the latest estimates, whatever `points` says. What is \
         `points` for?";
    RESIDUAL_AT_POINTS, "residual_at_points":
        "The residual is that of the estimates at which the derivatives are taken. First \
         estimates make derivatives agree with one another. Which estimates have the error that \
         the next step is to mend?";
    RESIDUAL_SIGN, "residual_sign":
        "The residual has the opposite sign. Is it predicted less measured, or measured less \
         predicted?";
    ANGLE_NOT_WRAPPED, "angle_not_wrapped":
        "A residual of an angle is off by a whole turn. How far apart are headings of 3.1 and \
         −3.1?";
    NOT_WHITENED, "not_whitened":
        "These rows are in metres and radians. What is a row over its standard deviation worth \
         to whoever adds squares?";
    LATEST_OF_ALL, "latest_of_all":
        "This is the latest estimate of everything. Derivatives of kept measurements have been \
         taken elsewhere: do all of them belong to one trajectory now?";
    FIRST_OF_ALL, "first_of_all":
        "This is estimate 0 of everything. Which variables does a kept measurement speak of, and \
         at which of their estimates has it been linearized?";
    LANDMARKS_LATEST, "landmarks_latest":
        "The poses have the estimates of the kept measurements, and the landmarks have their \
         latest. How many variables does a measurement of a landmark have?";
    POSES_LATEST, "poses_latest":
        "The landmarks have the estimates of the kept measurements, and the poses have their \
         latest. How many variables does a measurement of a landmark have?";
    DEPARTURES_LATEST, "departures_latest":
        "A pose from which a kept measurement leads to the next pose is at its latest estimate. \
         Odometry was linearized at two poses: what becomes of the other one?";
    NEVER_REFUSED, "never_refused":
        "Two kept measurements have been linearized at different estimates of the same variable, \
         and one of the two was taken. Can any estimate suit both?";
    DIRECTIONS_FOLLOW, "directions_follow":
        "Every measurement was asked along the directions at its own points, and there no \
         measurement claims anything. Which one direction do all rows have to leave free \
         together?";
    DIRECTIONS_AT_LATEST, "directions_at_latest":
        "The directions are those at the latest estimates. Which trajectory was given?";
    SIGNS_CANCEL, "signs_cancel":
        "Numbers of H n were added up with their signs. Can what one row claims be taken back by \
         another one?";
    ABSOLUTE_THRESHOLD, "absolute_threshold":
        "The verdict changes when all standard deviations are multiplied by the same number. \
         What is claimed, and what would be claimed if nothing cancelled, both change by the \
         square of it: what does not?";
    UNWEIGHTED, "unweighted":
        "These rows are as near as can be when the squares of their entries are counted, those \
         per radian and those per metre alike. What is to be small here, the change of the \
         entries or what it does to errors?";
    COVARIANCE_FOR_INFORMATION, "covariance_for_information":
        "The covariance stands where its inverse should. Should the rows change more where \
         errors are large, or where they are small?";
    GRAM_NOT_INVERTED, "gram_not_inverted":
        "What is taken away is not what was claimed: these rows still claim something. What does \
         a direction twice as long have to change?";
    ONE_BY_ONE, "one_by_one":
        "Each direction was taken away by itself, and all of that together. The directions are \
         not perpendicular: what does taking away the turn do to a shift?";
}

/// A variable as checks have it: a landmark is a pose without a heading.
type Place = Pose;

/// Moves a variable by a step (δθ, δp).
fn stepped(place: &Place, steps: Steps, [turn, x, y]: [f64; 3]) -> Place {
    let by = Vector2::new(x, y);
    let by = match steps {
        Steps::World => by,
        Steps::Body => Rotation2::new(place.heading) * by,
    };
    Pose { heading: place.heading + turn, position: place.position + by }
}

/// The step from one place to another.
fn step_between(from: &Place, to: &Place, steps: Steps) -> [f64; 3] {
    let by = to.position - from.position;
    let by = match steps {
        Steps::World => by,
        Steps::Body => Rotation2::new(-from.heading) * by,
    };
    [to.heading - from.heading, by.x, by.y]
}

/// The derivative of several numbers at zero, by differences of the fourth order.
fn slope(of: &dyn Fn(f64) -> [f64; 3]) -> [f64; 3] {
    const H: f64 = 1e-3;
    let ends = [H, -H, 2.0 * H, -2.0 * H].map(of);
    [0, 1, 2].map(|k| (8.0 * (ends[0][k] - ends[1][k]) - (ends[2][k] - ends[3][k])) / (12.0 * H))
}

/// Shifts of the world by so many metres along an axis, and turns about a centre by so many radians.
fn with_the_world(place: &Place, motion: usize, by: f64, centre: &Vector2<f64>) -> Place {
    match motion {
        2 => {
            let position = centre + Rotation2::new(by) * (place.position - centre);
            Pose { heading: place.heading + by, position }
        }
        axis => Pose { position: place.position + by * Vector2::ith(axis, 1.0), ..*place },
    }
}

/// The step of a variable per metre or radian of a motion of the world.
fn free_step(place: &Place, motion: usize, steps: Steps, centre: &Vector2<f64>) -> [f64; 3] {
    slope(&|by| step_between(place, &with_the_world(place, motion, by, centre), steps))
}

impl Measurement {
    /// Its two variables when there are so many poses, poses first.
    fn variables(&self, poses: usize) -> [usize; 2] {
        match self.what {
            What::Seen { pose, landmark, .. } => [pose, poses + landmark],
            What::Moved { from, to, .. } => [from, to],
        }
    }

    fn size(&self) -> usize {
        match self.what {
            What::Seen { .. } => 2,
            What::Moved { .. } => 3,
        }
    }

    /// What it should be for two variables. The last number of three is for odometry alone.
    fn predicted(&self, [from, to]: &[Place; 2]) -> [f64; 3] {
        let seen = Rotation2::new(-from.heading) * (to.position - from.position);
        [seen.x, seen.y, to.heading - from.heading]
    }

    fn measured(&self) -> [f64; 3] {
        match self.what {
            What::Seen { place, .. } => [place.x, place.y, 0.0],
            What::Moved { shift, turn, .. } => [shift.x, shift.y, turn],
        }
    }
}

impl Window {
    fn variables(&self) -> usize {
        self.poses.len() + self.landmarks.len()
    }

    fn estimates(&self, variable: usize) -> usize {
        match variable.checked_sub(self.poses.len()) {
            None => self.poses[variable].len(),
            Some(landmark) => self.landmarks[landmark].len(),
        }
    }

    fn estimate(&self, variable: usize, number: usize) -> Place {
        match variable.checked_sub(self.poses.len()) {
            None => self.poses[variable][number],
            Some(landmark) => Pose { heading: 0.0, position: self.landmarks[landmark][number] },
        }
    }

    fn latest(&self) -> Vec<usize> {
        (0..self.variables()).map(|variable| self.estimates(variable) - 1).collect()
    }

    /// First column and number of columns of a variable.
    fn columns(&self, variable: usize) -> (usize, usize) {
        let poses = self.poses.len();
        let landmarks = variable.saturating_sub(poses);
        (3 * variable.min(poses) + 2 * landmarks, if variable < poses { 3 } else { 2 })
    }

    fn size(&self) -> usize {
        self.columns(self.variables()).0
    }

    /// Two estimates of the variables of a measurement.
    fn ends(&self, measurement: &Measurement, points: [usize; 2]) -> [Place; 2] {
        let [from, to] = measurement.variables(self.poses.len());
        [self.estimate(from, points[0]), self.estimate(to, points[1])]
    }

    /// The points of each measurement when each variable has one.
    fn points_on(&self, trajectory: &[usize]) -> Vec<[usize; 2]> {
        let poses = self.poses.len();
        let points = |measurement: &Measurement| {
            measurement.variables(poses).map(|variable| trajectory[variable])
        };
        self.measurements.iter().map(points).collect()
    }

    /// What the numbers of a measurement, whitened, gain per step along a motion of the world at a trajectory, when
    /// they are linearized at points of their own: by moving the points by those steps.
    fn claims(
        &self,
        measurement: &Measurement,
        points: [usize; 2],
        (motion, steps): (usize, Steps),
        trajectory: &[usize],
    ) -> [f64; 3] {
        let variables = measurement.variables(self.poses.len());
        let ends = self.ends(measurement, points);
        let along = variables.map(|variable| {
            let place = self.estimate(variable, trajectory[variable]);
            let mut step = free_step(&place, motion, steps, &Vector2::zeros());
            if variable >= self.poses.len() {
                step[0] = 0.0;
            }
            step
        });
        let moved = |by: f64| {
            let side = |k: usize| {
                let of_landmark = variables[k] >= self.poses.len();
                let steps = if of_landmark { Steps::World } else { steps };
                stepped(&ends[k], steps, along[k].map(|part| by * part))
            };
            let numbers = measurement.predicted(&[side(0), side(1)]);
            [0, 1, 2].map(|k| if k < measurement.size() { numbers[k] } else { 0.0 })
        };
        slope(&moved).map(|claim| claim / measurement.sigma)
    }
}

/// A position within so many metres of the origin in each coordinate.
fn position(draw: &mut Draw, within: f64) -> Vector2<f64> {
    Vector2::new(draw.uniform(-within..within), draw.uniform(-within..within))
}

/// An error of a length of the range, in any direction.
fn error(draw: &mut Draw, length: [f64; 2]) -> Vector2<f64> {
    let angle = draw.uniform(-3.1..3.1);
    draw.uniform(length[0]..length[1]) * Vector2::new(f64::cos(angle), f64::sin(angle))
}

/// Of what windows are drawn.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// How many poses there are.
    pub poses: usize,
    /// How many landmarks.
    pub landmarks: usize,
    /// How far places are from the origin at the most, in metres.
    pub within: f64,
    /// How far estimates are off, in metres, from and to.
    pub error: [f64; 2],
    /// How far headings are off, in radians, from and to.
    pub turn: [f64; 2],
}

/// The range of the public instances.
const PUBLIC: Range =
    Range { poses: 3, landmarks: 2, within: 6.0, error: [0.1, 0.5], turn: [0.05, 0.3] };

impl Window {
    /// A window of poses that follow each other by odometry and landmarks each of which two poses see, with a single
    /// estimate of each. Its measurements are in any order.
    pub fn drawn(draw: &mut Draw, range: &Range) -> Self {
        let Range { poses, landmarks, within, .. } = *range;
        let mut window = Self {
            poses: (0..poses)
                .map(|_| {
                    vec![Pose {
                        heading: draw.uniform(-3.1..3.1),
                        position: position(draw, within),
                    }]
                })
                .collect(),
            landmarks: (0..landmarks).map(|_| vec![position(draw, within)]).collect(),
            measurements: Vec::new(),
        };
        let mut all: Vec<What> = (1..poses)
            .map(|to| What::Moved { from: to - 1, to, shift: Vector2::zeros(), turn: 0.0 })
            .collect();
        for landmark in 0..landmarks {
            let first = draw.index(0..poses);
            let second = (first + draw.index(1..poses)) % poses;
            all.extend([first, second].map(|pose| What::Seen {
                pose,
                landmark,
                place: Vector2::zeros(),
            }));
        }
        draw.shuffle(&mut all);
        for what in all {
            let sigma = draw.uniform(0.02..0.2);
            let nothing = Measurement { what, sigma, kept: None };
            let [x, y, turn] = nothing.predicted(&window.ends(&nothing, [0, 0]));
            let place = Vector2::new(x, y) + error(draw, [0.5 * sigma, 2.0 * sigma]);
            // A measured angle lies between −π and π, whatever headings have been added up to.
            let turn = turn + sigma * draw.uniform(0.5..1.0);
            let turn = turn.sin().atan2(turn.cos());
            let what = match what {
                What::Seen { pose, landmark, .. } => What::Seen { pose, landmark, place },
                What::Moved { from, to, .. } => What::Moved { from, to, shift: place, turn },
            };
            window.measurements.push(Measurement { what, ..nothing });
        }
        window
    }

    /// The same with more estimates of each variable, all of them off.
    fn estimated(mut self, draw: &mut Draw, range: &Range, more: [usize; 2]) -> Self {
        for estimates in &mut self.poses {
            let truth = estimates[0];
            for _ in 0..draw.index(more[0]..more[1]) {
                let sign = if draw.index(0..2) == 0 { 1.0 } else { -1.0 };
                let turn = sign * draw.uniform(range.turn[0]..range.turn[1]);
                let position = truth.position + error(draw, range.error);
                estimates.push(Pose { heading: truth.heading + turn, position });
            }
        }
        for estimates in &mut self.landmarks {
            let truth = estimates[0];
            for _ in 0..draw.index(more[0]..more[1]) {
                estimates.push(truth + error(draw, range.error));
            }
        }
        self
    }
}

const BOTH: [Steps; 2] = [Steps::World, Steps::Body];

fn checks() -> Vec<Check> {
    vec![
        Check::new("nobody_notices_a_motion_of_the_world", |answer| {
            let mut draw = Draw::new(61);
            (0..10).try_for_each(|index| {
                let window = Window::drawn(&mut draw, &PUBLIC);
                free(answer, &window, BOTH[index % 2])
            })
        }),
        Check::new("derivatives_are_taken_where_they_should_be", |answer| {
            let mut draw = Draw::new(62);
            (0..10).try_for_each(|index| {
                equations(answer, &Equations::drawn(&mut draw, &PUBLIC, BOTH[index % 2]))
            })
        }),
        Check::new("each_variable_has_one_estimate_for_all_derivatives", |answer| {
            let mut draw = Draw::new(63);
            (0..10).try_for_each(|_| chosen(answer, &Kept::drawn(&mut draw, &KEPT, true)))
        }),
        Check::new("kept_measurements_that_disagree_leave_none", |answer| {
            let mut draw = Draw::new(64);
            (0..20).try_for_each(|_| {
                let agree = draw.index(0..2) == 0;
                chosen(answer, &Kept::drawn(&mut draw, &KEPT, agree))
            })
        }),
        Check::new("a_direction_is_lost_by_the_measurement_that_claims_it", |answer| {
            let mut draw = Draw::new(65);
            Displaced::of_all_kinds(&mut draw, &PUBLIC)
                .iter()
                .try_for_each(|displaced| which_is_lost(answer, displaced))
        }),
        Check::new("the_least_change_sets_the_directions_free", |answer| {
            let mut draw = Draw::new(66);
            (0..10).try_for_each(|_| least_change(answer, &Claiming::drawn(&mut draw, 4, 8)))
        }),
    ]
}

/// The range of the public instances of measurements that are kept.
const KEPT: Range = Range { poses: 4, landmarks: 3, ..PUBLIC };

/// Free directions, by moving the world.
///
/// # Errors
///
/// A failure, which names what was moved instead where that is known.
pub fn free(answer: &dyn Transport, window: &Window, steps: Steps) -> Result<(), Failure> {
    let first = |estimates: &Vec<Pose>| estimates[0];
    let poses: Vec<Pose> = window.poses.iter().map(first).collect();
    let landmarks: Vec<Vector2<f64>> = window.landmarks.iter().map(|all| all[0]).collect();
    let obtained = Answer(answer).free_directions(&poses, &landmarks, &steps)?;
    let origin = Vector2::zeros();
    let by_world = |steps: Steps, centre: &Vector2<f64>| {
        let mut directions = DMatrix::zeros(window.size(), 3);
        for variable in 0..window.variables() {
            let place = window.estimate(variable, 0);
            let (start, count) = window.columns(variable);
            for motion in 0..3 {
                let step = free_step(&place, motion, steps, centre);
                let own = &step[3 - count..];
                (0..count).for_each(|k| directions[(start + k, motion)] = own[k]);
            }
        }
        directions
    };
    let expected = by_world(steps, &origin);
    // The part of the turn in rows that are chosen by the number of a variable and its coordinate.
    let turn_where = |chosen: &dyn Fn(usize, bool) -> f64| {
        let mut directions = expected.clone();
        for variable in 0..window.variables() {
            let (start, count) = window.columns(variable);
            for k in 0..count {
                let is_heading = count == 3 && k == 0;
                directions[(start + k, 2)] *= chosen(variable, is_heading);
            }
        }
        directions
    };
    let inverted = {
        let mut directions = expected.clone();
        for (k, pose) in poses.iter().enumerate() {
            let twice = match steps {
                Steps::World => Rotation2::identity(),
                Steps::Body => Rotation2::new(2.0 * pose.heading),
            };
            let turned = twice * expected.fixed_view::<2, 3>(3 * k + 1, 0);
            directions.fixed_view_mut::<2, 3>(3 * k + 1, 0).copy_from(&turned);
        }
        directions
    };
    let part = |yes: bool| if yes { 1.0 } else { 0.0 };
    compare("the table of free directions", &obtained, &expected)
        .within(1e-8)
        .labelled(&[], &["shift 1", "shift 2", "turn"])
        .or(&ONLY_HEADINGS_TURN, &turn_where(&|_, is_heading| part(is_heading)))
        .or(&LANDMARKS_STAY, &turn_where(&|variable, _| part(variable < poses.len())))
        .or(&ABOUT_THE_FIRST_POSE, &by_world(steps, &poses[0].position))
        .or(&TURNED_BACK, &turn_where(&|_, is_heading| if is_heading { 1.0 } else { -1.0 }))
        .or(&STEPS_IN_THE_WORLD, &by_world(Steps::World, &origin))
        .or(&ROTATION_INVERTED, &inverted)
        .judge()
        .map_err(|failure| {
            failure.given(&[("poses", &poses), ("landmarks", &landmarks), ("steps", &steps)])
        })
}
