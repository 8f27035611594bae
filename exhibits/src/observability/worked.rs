//! The motions of the chapter, and windows of them.

use std::sync::OnceLock;

use nalgebra::{DVector, Vector3};
use vislam::inertial::ImuNoise;
use vislam::least_squares::Spectrum;
use vislam::observability::{BiasAssumption, FreeDirections, Window};
use vislam::simulation::{EulerAngles, Flight, ScalarTrajectory, Trajectory, landmarks_around};

/// Landmarks on all sides, of which a camera that looks ahead sees a part.
const LANDMARKS: usize = 100;
/// In the world, in m/s.
pub const VELOCITY: Vector3<f64> = Vector3::new(1.0, 0.5, 0.2);
/// In the world or in the body, in m/s².
pub const ACCELERATION: Vector3<f64> = Vector3::new(0.7, -0.3, 0.4);
/// Along the ground, in the world, in m/s².
pub const LEVEL_ACCELERATION: Vector3<f64> = Vector3::new(0.7, -0.3, 0.0);
/// In m/s and rad/s.
pub const TURN: (f64, f64) = (1.0, 0.5);

/// A motion of the table, with the word by which its numbers are called.
pub struct Case {
    pub word: &'static str,
    pub name: &'static str,
    pub motion: Trajectory,
}

/// About all axes, as in the figure-eight.
pub fn turning() -> EulerAngles {
    Trajectory::figure_eight().angles
}

/// Swaying to and fro along all axes at different rates.
pub fn swaying(angles: EulerAngles) -> Trajectory {
    let waves = [(0.3, 2.0), (0.4, 3.0), (0.2, 2.5)];
    let position = waves.map(|(size, rate)| ScalarTrajectory::wave(size, rate, 0.0));
    Trajectory { position, angles, ..Trajectory::default() }
}

pub fn cases() -> [Case; 12] {
    let case = |word, name, motion| Case { word, name, motion };
    let steady = |angles| Trajectory::constant_velocity(&VELOCITY, angles);
    let pushed = |push, angles| Trajectory::constant_acceleration(push, angles);
    let in_body = Trajectory::constant_body_acceleration(&ACCELERATION, TURN.1);
    let pitching =
        EulerAngles { pitch: ScalarTrajectory::wave(0.3, 1.3, 1.0), ..EulerAngles::default() };
    let straight = EulerAngles::default();
    let (climb, level) = (pushed(&ACCELERATION, straight), pushed(&LEVEL_ACCELERATION, straight));
    let leveled = pushed(&LEVEL_ACCELERATION, turning());
    [
        case("eight", "figure-eight", Trajectory::figure_eight()),
        case("coast", "constant velocity; turning", steady(turning())),
        case("straight", "constant velocity; no rotation", steady(straight)),
        case("turn", "level turn", Trajectory::level_turn(TURN.0, TURN.1)),
        case("body", "acceleration constant in the body; turning", in_body),
        case("sway", "changing acceleration; no rotation", swaying(straight)),
        case("pitch", "changing acceleration; only pitching", swaying(pitching)),
        case("climb", "constant acceleration, climbing; no rotation", climb),
        case("level", "constant level acceleration; no rotation", level),
        case("leveled", "constant level acceleration; turning", leveled),
        case("hover", "hover", Trajectory::hover()),
        case("spot", "turn on the spot", Trajectory::turn_on_the_spot(0.4)),
    ]
}

/// The window of a flight.
pub fn of_flight(flight: &Flight, assumption: BiasAssumption) -> Window {
    let landmarks = landmarks_around(&Vector3::zeros(), LANDMARKS);
    flight.window(&landmarks, assumption).expect("the motions of the chapter are finite")
}

/// The window of a motion, the camera at the sensor.
pub fn window(motion: Trajectory, assumption: BiasAssumption) -> Window {
    of_flight(&Flight::brief(motion), assumption)
}

/// What the motions leave free with constant, walking and known biases, in the order of the cases.
pub fn table() -> &'static [[FreeDirections; 3]] {
    static TABLE: OnceLock<Vec<[FreeDirections; 3]>> = OnceLock::new();
    let walking = BiasAssumption::walking(ImuNoise::euroc());
    let assumptions = [BiasAssumption::CONSTANT, walking, BiasAssumption::KNOWN];
    let row = |case: Case| assumptions.map(|assumption| free(&window(case.motion, assumption)));
    TABLE.get_or_init(|| cases().map(row).to_vec())
}

/// What a motion of the table leaves free.
pub fn row_of(word: &str) -> &'static [FreeDirections; 3] {
    let row = cases().iter().position(|case| case.word == word);
    &table()[row.expect("the word of a motion")]
}

/// What a window leaves free.
pub fn free(window: &Window) -> FreeDirections {
    window.free_directions().expect("the motions of the chapter are degenerate or are not")
}

/// What pictures alone leave free on a motion.
pub fn free_of_pictures(motion: Trajectory) -> FreeDirections {
    let mut window = window(motion, BiasAssumption::KNOWN);
    window.intervals.clear();
    free(&window)
}

/// What pictures alone leave free on the figure-eight.
pub fn vision() -> &'static FreeDirections {
    static VISION: OnceLock<FreeDirections> = OnceLock::new();
    VISION.get_or_init(|| free_of_pictures(Trajectory::figure_eight()))
}

/// The spectrum of a window.
pub fn spectrum(window: &Window) -> Spectrum {
    let (jacobian, _) = window.linearize().expect("every landmark is in front of its cameras");
    Spectrum::of(&jacobian).expect("the motions of the chapter are degenerate or are not")
}

/// The gradient of the logarithm of the distance between the first position and the last.
pub fn log_distance(window: &Window) -> DVector<f64> {
    let last = window.states.len() - 1;
    let way = window.states[last].position - window.states[0].position;
    let slope = way / way.norm_squared();
    let mut gradient = DVector::zeros(window.dimension());
    gradient.rows_mut(6, 3).copy_from(&-slope);
    gradient.rows_mut(9 * last + 6, 3).copy_from(&slope);
    gradient
}
