//! Simulated flights, as a filter follows them.

use nalgebra::SVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{Msckf, MsckfError, PictureReport, Start};
use crate::least_squares::Manifold;
use crate::preintegration::Matrix15;
use crate::simulation::FlightRecording;
use crate::simulation::random::normal;

impl Start {
    /// What is believed when a recording begins: the truth, off by an error that is drawn. `sigmas`
    /// are the standard deviations of turns, velocity, position and the biases of gyroscope and
    /// accelerometer, in rad, m/s, m, rad/s and m/s². `None` when there is no picture yet.
    pub fn drawn(recording: &FlightRecording, sigmas: &[f64; 15], seed: u64) -> Option<Self> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let off = sigmas.map(|sigma| sigma * normal(&mut random));
        let (truth, rig) = (&recording.truth, recording.flight.rig);
        Some(Self {
            nanoseconds: rig.imu_nanoseconds(recording.pictures.first()?.nanoseconds),
            state: truth.states.first()?.retract(&off[..9]),
            bias: truth.biases.first()?.retract(&off[9..]),
            covariance: Matrix15::from_diagonal(&SVector::from(sigmas.map(|sigma| sigma * sigma))),
            rig,
        })
    }
}

impl Msckf {
    /// Takes a picture of a recording, and the readings since the last one that reach its time.
    /// `None` when there is no such picture.
    ///
    /// # Errors
    ///
    /// An [`MsckfError`].
    pub fn follow(
        &mut self,
        recording: &FlightRecording,
        number: usize,
    ) -> Result<Option<PictureReport>, MsckfError> {
        let Some(picture) = recording.pictures.get(number) else { return Ok(None) };
        let time = self.rig().imu_nanoseconds(picture.nanoseconds);
        let mut last = self.readings.last().map_or(i64::MIN, |reading| reading.nanoseconds);
        let read = recording.readings.partition_point(|reading| reading.nanoseconds <= last);
        for reading in &recording.readings[read..] {
            if last >= time {
                break;
            }
            last = reading.nanoseconds;
            self.reading(*reading)?;
        }
        self.picture(picture).map(Some)
    }
}
