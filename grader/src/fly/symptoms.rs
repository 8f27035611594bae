//! Names of faults that statistics suggest. Nothing here knows how an answer was made.

use nalgebra::{Quaternion, UnitQuaternion};
use vislam::filtering::NeesBand;
use vislam::inertial::GRAVITY;

use super::answer::{Kind, of_triangle};
use super::measured::{Measured, Table};
use super::reference::Line;
use super::series::TIMES;

/// The probability with which a consistent answer leaves any of its bands.
pub const OUTSIDE: f64 = 1e-3;

/// A fault with what is said of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Symptom {
    /// Its name.
    pub name: &'static str,
    /// What the numbers show, and where to look.
    pub sentence: &'static str,
}

macro_rules! symptoms {
    ($($(#[$doc:meta])* $name:ident: $word:literal, $sentence:literal;)*) => {
        $($(#[$doc])* pub const $name: Symptom = Symptom { name: $word, sentence: $sentence };)*
    };
}

symptoms! {
    /// The filter believes to know its yaw better with time.
    YAW: "yaw_information_gained",
        "the yaw is believed to be known better than anything can have shown it, and the rest of the \
         covariance is right: neither camera nor inertial sensor sees yaw; are derivatives of one \
         variable taken at different estimates of it?";
    /// Pictures correct nothing.
    CLONES: "clones_uncorrelated",
        "errors and covariance grow as by readings alone, smoothly, as if no picture had been taken: \
         when a pose is added to the window, are its covariances with the state added, too?";
    /// White noise too small by the root of the rate.
    DENSITY: "density_taken_for_per_sample_noise",
        "tilt, yaw and position are all believed too well, the tilt most, and the attitude wanders more \
         than readings and pictures leave it: a density is to be divided by the root of the time of a \
         step before it is the noise of a reading";
    /// Free fall counted with the wrong sign.
    GRAVITY_SIGN: "gravitys_sign",
        "the body falls, or rises, by an acceleration that is gravity's or twice that: the accelerometer \
         reads the acceleration less gravity, which points down";
    /// The camera's mounting the wrong way round.
    EXTRINSICS: "extrinsics_inverted",
        "what the pictures say contradicts the readings as if the camera sat otherwise on the body: \
         `body_from_camera` takes camera coordinates to body coordinates; was its inverse taken?";
    /// Pictures taken for simultaneous.
    OFFSET: "time_offset_ignored",
        "flights with a late clock of the camera are off, and the others are not: add `time_offset` to \
         times of pictures";
    /// The triangle of a covariance written by columns.
    TRANSPOSED: "transposed_covariance",
        "the covariances fit when their numbers are read as the lower triangle, row by row: write the \
         upper one, row by row";
    /// A factor on the covariance.
    SCALED: "covariance_scaled_by_guess",
        "the covariances are right but for one factor that is the same for tilt, yaw and position at all \
         times: where does a factor come from that no sensor has?";
    /// No test of what is off.
    OUTLIERS: "outliers_believed",
        "flights with wrong pixels are off, and the others are not: is what cannot be believed refused?";
    /// The camera's pose in the place of the body's.
    CAMERA: "pose_of_the_camera",
        "the attitude is off by the camera's mounting, all along: this is the pose of the camera, and that \
         of the body is asked for";
    /// The quaternion in another order.
    QUATERNION: "quaternion_w_first",
        "the poses fit when the first number of a quaternion is read as w: write x, y, z, w";
    /// A smoothed trajectory declared as causal.
    SMOOTHED: "smoothed_declared_causal",
        "the trajectory has none of the corrections that an estimate has which does not know what comes: \
         declare it as smoothed";
}

/// The bands of an answer's normalized errors: tilt, yaw and position, by times. They hold all at once.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands(Vec<NeesBand>);

impl Bands {
    /// For so many flights.
    ///
    /// # Errors
    ///
    /// A sentence when there is no flight.
    pub fn of(runs: usize) -> Result<Self, String> {
        let dimensions = [2, 1, 3].repeat(TIMES.len());
        let bands = NeesBand::family(runs, &dimensions, OUTSIDE);
        bands.map(Self).map_err(|error| error.to_string())
    }

    /// The band of a block at a time.
    pub fn at(&self, time: usize, block: usize) -> NeesBand {
        self.0[3 * time + block]
    }

    /// Whether a block lies in its bands at all times, each mean divided by a factor.
    pub fn contain(&self, nees: &Table, block: usize, factor: f64) -> bool {
        (0..TIMES.len()).all(|time| self.at(time, block).contains(nees[time][block] / factor))
    }

    /// The same for all blocks.
    pub fn contain_all(&self, nees: &Table, factor: f64) -> bool {
        (0..3).all(|block| self.contain(nees, block, factor))
    }

    /// Whether a block lies above its band at the last time.
    fn is_above(&self, nees: &Table, block: usize) -> bool {
        let last = TIMES.len() - 1;
        nees[last][block] > self.at(last, block).high
    }
}

/// A way to read a line.
pub type Reading = fn(&Line) -> Line;

/// The answer read in another way, and the fault that would have made it so.
pub const REREADINGS: [(Symptom, Reading); 2] =
    [(TRANSPOSED, from_lower_triangle), (QUATERNION, with_w_first)];

/// A line whose covariance had been written as its lower triangle, row by row.
fn from_lower_triangle(line: &Line) -> Line {
    let upper = (0..6).flat_map(|row| (row..6).map(move |column| (row, column)));
    let written: Vec<f64> = upper.map(|place| line.covariance[place]).collect();
    let mut read = of_triangle(&written);
    let lower = (0..6).flat_map(|row| (0..=row).map(move |column| (row, column)));
    for ((row, column), number) in lower.zip(written) {
        read[(row, column)] = number;
        read[(column, row)] = number;
    }
    Line { covariance: read, ..*line }
}

/// A line whose quaternion had been written with its real part first.
fn with_w_first(line: &Line) -> Line {
    let q = line.state.pose().rotation;
    let read = UnitQuaternion::new_normalize(Quaternion::new(q.i, q.j, q.k, q.w));
    let mut line = *line;
    line.state.world_from_body = read.to_rotation_matrix();
    line
}

/// So much farther off than the book's filter is lost.
const LOST: f64 = 20.0;
/// A kind of flight stands out when its errors are so many times those of the other kinds.
const STANDS_OUT: f64 = 2.5;
/// What is turned by less is turned like this, in radians.
const SAME_TURN: f64 = 0.15;
/// An attitude that scatters by more was dragged about by pictures, in radians.
const DRAGGED: f64 = 0.25;
/// Errors that are rougher than the filter's by more have jumps.
const JUMPS: f64 = 4.0;
/// A trajectory that is smoother than the filter's by this was corrected by what came later.
pub const SMOOTH: f64 = 0.2;

/// The fault that the numbers of an answer suggest, if one does. `read` are the numbers of the answer read
/// as in [`REREADINGS`].
pub fn symptom(
    measured: &Measured,
    bands: &Bands,
    read: &[(Symptom, Measured)],
) -> Option<Symptom> {
    let fits = |(_, other): &&(Symptom, Measured)| bands.contain_all(&other.nees, 1.0);
    let consistent = bands.contain_all(&measured.nees, 1.0);
    if let Some((symptom, _)) = read.iter().find(fits).filter(|_| !consistent) {
        return Some(*symptom);
    }
    lost(measured, bands)
        .or_else(|| some_flights(measured))
        .or_else(|| overconfident(measured, bands))
}

/// Faults by which an answer goes nowhere, or is turned.
fn lost(measured: &Measured, bands: &Bands) -> Option<Symptom> {
    let Measured { errors: [plain, ..], falling, tumbling, roughness, turned, sigmas, .. } =
        measured;
    // Only positions that resemble the true ones say how the worlds are turned to each other.
    if *plain < LOST && *tumbling < DRAGGED && turned[0] > SAME_TURN {
        let near = |power: usize| turned[power] < SAME_TURN;
        return near(1).then_some(CAMERA).or_else(|| near(2).then_some(EXTRINSICS));
    }
    let falls = (falling.abs() / GRAVITY.norm() - 1.5).abs() < 0.7;
    if *plain > LOST && falls && *tumbling < 2.0 * DRAGGED || measured.tilted > 2.5 {
        return Some(GRAVITY_SIGN);
    }
    let last = TIMES.len() - 1;
    if sigmas[last][2] > LOST && measured.roughest < 1.0 && !bands.is_above(&measured.nees, 2) {
        return Some(CLONES);
    }
    (*plain > LOST && (*roughness > JUMPS || *tumbling > DRAGGED)).then_some(EXTRINSICS)
}

/// Faults that show in flights of one kind.
fn some_flights(measured: &Measured) -> Option<Symptom> {
    let [plain, outliers, late] = measured.errors;
    // Whoever is off in all flights is more so in the harder ones.
    if measured.wandering > WANDERS {
        return None;
    }
    let stands_out = |one: f64, other: f64| one > STANDS_OUT * plain.max(other);
    if stands_out(late, outliers) {
        return Some(OFFSET);
    }
    stands_out(outliers, late).then_some(OUTLIERS)
}

/// Attitudes wander by so much more than the filter's when readings are believed too well.
const WANDERS: f64 = 1.2;

/// Faults of the covariance.
fn overconfident(measured: &Measured, bands: &Bands) -> Option<Symptom> {
    let nees = &measured.nees;
    let all: f64 = nees.iter().map(|at| (2.0 * at[0] + at[1] + 3.0 * at[2]) / 6.0).sum();
    let factor = all / TIMES.len() as f64;
    let wanders = measured.wandering > WANDERS && measured.tumbling < DRAGGED;
    if bands.is_above(nees, 0) && wanders {
        return Some(DENSITY);
    }
    if bands.contain(nees, 0, 1.0) && bands.is_above(nees, 1) {
        return Some(YAW);
    }
    let scaled = !bands.contain_all(nees, 1.0) && bands.contain_all(nees, factor);
    (scaled && !wanders).then_some(SCALED)
}

/// Whether an answer is smoother than it declares.
pub fn is_smoothed(kind: Kind, measured: &Measured) -> bool {
    kind == Kind::Causal && measured.roughness < SMOOTH && measured.errors[0] < 1.5
}
