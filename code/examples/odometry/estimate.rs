//! The estimators, and what each of them says.

use nalgebra::{Matrix6, Vector3};
use vislam::inertial::NavState;
use vislam::initialization::{Batch, BeginOptions, Whole, WholeOptions, begin};
use vislam::least_squares::{Covariance, Values};

use super::input::Input;

/// How a flight is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// All states, biases and landmarks at once.
    Batch,
}

/// What an estimator says.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Times of the states, in nanoseconds on the sensor's clock.
    pub nanoseconds: Vec<i64>,
    pub states: Vec<NavState>,
    /// Of the poses, by the steps of [`vislam::inertial::BodyPose`].
    pub pose_covariances: Vec<Matrix6<f64>>,
    /// In the world, in metres.
    pub landmarks: Vec<Vector3<f64>>,
    /// Seconds from the first picture until there was an estimate; NaN when it was given.
    pub initialized_after: f64,
    /// The standard deviation of the scale then, as a part of it; NaN when none was estimated.
    pub scale_sigma: f64,
}

impl Estimator {
    const ALL: [(&'static str, Self); 1] = [("batch", Self::Batch)];

    pub fn named(name: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        let names = || Self::ALL.map(|(known, _)| known).join(", ");
        let unknown = || format!("--estimator: there is no `{name}` yet, only {}", names());
        found.map(|(_, estimator)| *estimator).ok_or_else(unknown)
    }

    /// Estimates a flight. Meanwhile it is told what is being done.
    pub fn run(self, input: &Input, progress: &mut dyn FnMut(&str)) -> Result<Estimate, String> {
        match self {
            Self::Batch => batch(input, progress),
        }
    }
}

/// Begins at rest or in motion, and from there grows the batch of all pictures.
fn batch(input: &Input, progress: &mut dyn FnMut(&str)) -> Result<Estimate, String> {
    let Input { sensors, readings, pictures } = input;
    progress("looking for a beginning");
    let begun = begin(sensors, readings, pictures, &BeginOptions::default())
        .map_err(|error| format!("there is no beginning: {error}"))?;
    progress(&format!("begun after {:.2} s; growing the batch", begun.seconds));
    let options = WholeOptions::default();
    let told = |states| progress(&format!("{states} of {} states", pictures.len()));
    let whole = Whole::grown_with(sensors, readings, pictures, begun.known, &options, told)
        .map_err(|error| format!("there is no batch of the whole flight: {error}"))?;
    let rig = sensors.rig;
    let times = pictures.iter().map(|picture| rig.imu_nanoseconds(picture.nanoseconds));
    let estimate =
        Estimate::of_batch(times.collect(), &whole.batch, &whole.values, &whole.covariance);
    Ok(Estimate {
        initialized_after: begun.seconds,
        scale_sigma: begun.scale_sigma.unwrap_or(f64::NAN),
        ..estimate
    })
}

impl Estimate {
    /// What a batch says at its minimum.
    pub fn of_batch(
        nanoseconds: Vec<i64>,
        batch: &Batch,
        values: &Values,
        covariance: &Covariance,
    ) -> Self {
        let pose_covariance = |state| {
            let Some(all) = covariance.of(state) else { return Matrix6::repeat(f64::NAN) };
            // A state's step is (φ, v, p).
            let place =
                |coordinate: usize| if coordinate < 3 { coordinate } else { coordinate + 3 };
            Matrix6::from_fn(|row, column| all[(place(row), place(column))])
        };
        Self {
            nanoseconds,
            states: batch.states.iter().map(|state| values[*state]).collect(),
            pose_covariances: batch.states.iter().map(|state| pose_covariance(*state)).collect(),
            landmarks: batch.landmarks.values().map(|landmark| values[*landmark]).collect(),
            initialized_after: f64::NAN,
            scale_sigma: f64::NAN,
        }
    }
}
