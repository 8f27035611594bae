//! A start while the body flies: pictures, then readings, then both at once.

use nalgebra::{DMatrix, Rotation3, Vector3};

use super::{
    AlignmentRefused, Batch, BatchError, NoStart, Sensors, VisualLandmark, VisualMotion,
    align_motion, inertial_map,
};
use crate::datasets::tracks::Picture;
use crate::inertial::{ImuBias, NavState, StampedSample};
use crate::least_squares::{Covariance, Kernel, Options, Values};
use crate::msckf::Start;
use crate::preintegration::Matrix15;
use crate::structure_from_motion::ReconstructionError;

// ANCHOR: motion_options
/// When a start in motion counts as one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionOptions {
    /// The standard deviation of the accelerometer's bias on each axis, in m/s².
    pub accelerometer_bias: f64,
    /// That of the gyroscope's, in rad/s.
    pub gyro_bias: f64,
    /// The largest standard deviation of the scale, as a part of it.
    pub scale_sigma: f64,
    /// The largest standard deviation of the tilt, in radians.
    pub tilt_sigma: f64,
    /// How badly pixels and readings may fit together: the largest [`Started::misfit`].
    pub misfit: f64,
    /// The least angle at which two rays of a landmark must meet, in radians.
    pub least_parallax: f64,
    /// The kernel of the pixels.
    pub kernel: Kernel,
}

impl Default for MotionOptions {
    fn default() -> Self {
        Self {
            accelerometer_bias: 0.1,
            gyro_bias: 0.1,
            scale_sigma: 0.1,
            tilt_sigma: 1f64.to_radians(),
            misfit: 1.5,
            least_parallax: 0.01,
            kernel: Kernel::Huber(1.345),
        }
    }
}
// ANCHOR_END: motion_options

// ANCHOR: in_motion
/// A start in motion: the batch of some pictures, at its minimum.
pub struct Started {
    /// The batch.
    pub batch: Batch,
    /// Its most likely values.
    pub values: Values,
    /// Their covariance.
    pub covariance: Covariance,
    /// The standard deviation of the scale, as a part of it: of the distance of the state that is
    /// farthest from the first one.
    pub scale_sigma: f64,
    /// The standard deviation of the first state's tilt, in radians: its greatest about any
    /// horizontal axis.
    pub tilt_sigma: f64,
    /// Twice the cost at the minimum by its degrees of freedom: about one, if this is the right minimum
    /// and the noise is as it is said to be.
    pub misfit: f64,
    /// Which picture each state belongs to.
    pub pictures: Vec<usize>,
}

impl Started {
    /// The first state, whose place and yaw were chosen.
    pub fn first(&self) -> NavState {
        self.values[self.batch.states[0]]
    }

    /// What a filter begins with at the last of its pictures, which was taken at this time on the
    /// camera's clock.
    pub fn start(&self, sensors: &Sensors, nanoseconds: i64) -> Start {
        let last = self.batch.states.len() - 1;
        let (state, bias) = (self.batch.states[last], self.batch.biases[last]);
        let (state, bias) = (state.index(), bias.index());
        let mut covariance = Matrix15::repeat(f64::NAN);
        for (row, first) in [(0, state), (9, bias)] {
            for (column, second) in [(0, state), (9, bias)] {
                if let Some(part) = self.covariance.between_numbers(first, second) {
                    covariance.view_mut((row, column), part.shape()).copy_from(&part);
                }
            }
        }
        Start {
            nanoseconds: sensors.rig.imu_nanoseconds(nanoseconds),
            state: self.values[self.batch.states[last]],
            bias: self.values[self.batch.biases[last]],
            covariance,
            rig: sensors.rig,
        }
    }
}

/// Starts while the body moves: a motion up to scale from the pictures, what readings say of it
/// linearly, the most likely inertial unknowns, and from there the batch of all. The world's third
/// axis points up, its origin is the first camera's centre, and its
/// heading is by choice.
///
/// # Errors
///
/// [`NoStart`] says what is not determined, and by what motion.
pub fn in_motion(
    sensors: &Sensors,
    readings: &[StampedSample],
    pictures: &[Picture],
    options: &MotionOptions,
) -> Result<Started, NoStart> {
    let motion = VisualMotion::of(sensors, pictures).map_err(without_motion)?;
    let started = start(sensors, readings, &motion, options);
    started.map_err(|error| match motion.uniform(sensors).filter(|_| error.is_of_motion()) {
        Some(motion) => NoStart::Uniform { motion, error: Box::new(error) },
        None => error,
    })
}
// ANCHOR_END: in_motion

/// Why pictures show no motion: the camera hovers when most of their pairs show no parallax.
fn without_motion(error: ReconstructionError) -> NoStart {
    match error {
        ReconstructionError::NoFirstPair { pairs, narrow, rotations, planes, .. }
            if rotations + narrow > planes.max(pairs / 2) =>
        {
            NoStart::Hover { narrow: rotations + narrow, pairs }
        }
        error => error.into(),
    }
}

// ANCHOR: start_in_motion
fn start(
    sensors: &Sensors,
    readings: &[StampedSample],
    motion: &VisualMotion,
    options: &MotionOptions,
) -> Result<Started, NoStart> {
    let aligned = align_motion(sensors, readings, motion, options.accelerometer_bias)?;
    let map = inertial_map(sensors, readings, motion, &aligned, options.accelerometer_bias)?;
    let up = Rotation3::rotation_between(&-map.gravity, &Vector3::z());
    let world_from_motion = up.ok_or(AlignmentRefused::Undetermined)?;
    let turned = |state: &NavState| NavState {
        world_from_body: world_from_motion * state.world_from_body,
        velocity: world_from_motion * state.velocity,
        position: world_from_motion * state.position,
    };
    let guess: Vec<(NavState, ImuBias)> =
        map.states.iter().map(|state| (turned(state), map.bias)).collect();
    let placed = motion.landmarks.iter().map(|(track, landmark)| {
        let place = world_from_motion * (map.scale * (landmark.place - motion.centres[0]));
        (*track, VisualLandmark { place, ..landmark.clone() })
    });
    settled(sensors, readings, motion, &guess, placed.collect(), options)
}
// ANCHOR_END: start_in_motion

// ANCHOR: settled
/// The batch at its minimum, from states, biases and landmarks in the world. A landmark whose rays
/// hardly meet at an angle there is left out, and the rest is solved again.
fn settled(
    sensors: &Sensors,
    readings: &[StampedSample],
    motion: &VisualMotion,
    guess: &[(NavState, ImuBias)],
    mut landmarks: Vec<(usize, VisualLandmark)>,
    options: &MotionOptions,
) -> Result<Started, NoStart> {
    loop {
        let mut batch = Batch::new(sensors, readings, &motion.nanoseconds, guess)?;
        for (track, landmark) in &landmarks {
            if batch.is_in_front(&landmark.place, &landmark.sightings) {
                batch.add_landmark(*track, landmark.place, &landmark.sightings, options.kernel)?;
            }
        }
        know_beginning(&mut batch, &guess[0], options)?;
        let values = batch.solve(&Options::default())?.values;
        let before = landmarks.len();
        landmarks.retain(|(track, landmark)| {
            batch.parallax(&values, *track, &landmark.sightings) > options.least_parallax
        });
        if landmarks.len() == before {
            let covariance = batch.covariance(&values)?;
            let scale_sigma = scale_sigma(&batch, &values, &covariance);
            let tilt_sigma = tilt_sigma(&batch, &values, &covariance);
            let misfit = misfit(&batch, &values, &landmarks);
            let pictures = motion.pictures.clone();
            let started =
                Started { batch, values, covariance, scale_sigma, tilt_sigma, misfit, pictures };
            return started.judged(options);
        }
    }
}
// ANCHOR_END: settled

/// Adds what is known before anything is measured: place and heading by choice, and how large the
/// biases may be.
fn know_beginning(
    batch: &mut Batch,
    guess: &(NavState, ImuBias),
    options: &MotionOptions,
) -> Result<(), BatchError> {
    batch.fix_gauge()?;
    let (g, a) = (options.gyro_bias, options.accelerometer_bias);
    let free = [f64::INFINITY; 9];
    batch.know((guess.0, ImuBias::default()), free, [g, g, g, a, a, a])
}

impl Started {
    // ANCHOR: judged
    /// The start, if it fits and is certain enough. A wrong minimum is as certain as the right one.
    fn judged(self, options: &MotionOptions) -> Result<Self, NoStart> {
        let Self { scale_sigma, tilt_sigma, misfit, .. } = self;
        if misfit.is_nan() || misfit > options.misfit {
            return Err(NoStart::Misfit { misfit });
        }
        let (scale, tilt) = (scale_sigma <= options.scale_sigma, tilt_sigma <= options.tilt_sigma);
        if !(scale && tilt) {
            return Err(NoStart::Uncertain { scale_sigma, tilt_sigma });
        }
        Ok(self)
    }
    // ANCHOR_END: judged
}

// ANCHOR: misfit
/// Twice the cost by the degrees of freedom. Two numbers of each pixel go against three of each landmark; an
/// interval of readings tells as many numbers as a state and its biases have, and of the first ones tilt and
/// velocity are told by nothing else.
fn misfit(batch: &Batch, values: &Values, landmarks: &[(usize, VisualLandmark)]) -> f64 {
    let placed = landmarks.iter().filter(|(track, _)| batch.landmarks.contains_key(track));
    let told: usize = placed.map(|(_, landmark)| 2 * landmark.sightings.len()).sum();
    let degrees = told.saturating_sub(3 * batch.landmarks.len() + 5);
    2.0 * batch.cost(values) / degrees as f64
}
// ANCHOR_END: misfit

// ANCHOR: scale_sigma
/// The standard deviation of the distance from the first state to the one that is farthest from it,
/// as a part of that distance. The first position is fixed, so the other's covariance says it.
fn scale_sigma(batch: &Batch, values: &Values, covariance: &Covariance) -> f64 {
    let first = values[batch.states[0]].position;
    let away = |key: &crate::least_squares::Key<NavState>| values[*key].position - first;
    let farthest = batch.states.iter().max_by(|a, b| away(a).norm().total_cmp(&away(b).norm()));
    let spread = farthest.and_then(|key| Some((away(key), covariance.of(*key)?)));
    let Some((away, spread)) = spread else { return f64::NAN };
    let (distance, along) = (away.norm(), away.normalize());
    (along.transpose() * block(&spread, 6) * along).x.sqrt() / distance
}

/// The greatest standard deviation of the first state's turn about a horizontal axis.
fn tilt_sigma(batch: &Batch, values: &Values, covariance: &Covariance) -> f64 {
    let first = batch.states[0];
    let Some(spread) = covariance.of(first) else { return f64::NAN };
    let world_from_body = values[first].world_from_body.matrix();
    let in_world = world_from_body * block(&spread, 0) * world_from_body.transpose();
    in_world.fixed_view::<2, 2>(0, 0).into_owned().symmetric_eigenvalues().max().sqrt()
}
// ANCHOR_END: scale_sigma

fn block(spread: &DMatrix<f64>, from: usize) -> nalgebra::Matrix3<f64> {
    spread.fixed_view::<3, 3>(from, from).into_owned()
}
