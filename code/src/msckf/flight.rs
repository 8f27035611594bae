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
        Self::off_by(recording, &drawn(sigmas, seed), sigmas)
    }

    /// The truth at the first picture, off by a step, with independent errors.
    fn off_by(
        recording: &FlightRecording,
        off: &SVector<f64, 15>,
        sigmas: &[f64; 15],
    ) -> Option<Self> {
        let (truth, rig) = (&recording.truth, recording.flight.rig);
        Some(Self {
            nanoseconds: rig.imu_nanoseconds(recording.pictures.first()?.nanoseconds),
            state: truth.states.first()?.retract(&off.as_slice()[..9]),
            bias: truth.biases.first()?.retract(&off.as_slice()[9..]),
            covariance: Matrix15::from_diagonal(&SVector::from(sigmas.map(|sigma| sigma * sigma))),
            rig,
        })
    }

    // ANCHOR: at_the_origin
    /// What is believed when a recording begins by somebody who calls where he stands the origin and
    /// where he looks ahead: yaw and position are exact, as everything else is measured from them.
    /// `sigmas` are the standard deviations of tilt, velocity and the biases of gyroscope and
    /// accelerometer on each axis, in rad, m/s, rad/s and m/s². `None` when there is no picture yet.
    pub fn at_the_origin(
        recording: &FlightRecording,
        [tilt, velocity, gyro, accelerometer]: [f64; 4],
        seed: u64,
    ) -> Option<Self> {
        let mut in_world = [0.0; 15];
        in_world[..2].fill(tilt);
        in_world[3..6].fill(velocity);
        in_world[9..12].fill(gyro);
        in_world[12..].fill(accelerometer);
        let mut off = drawn(&in_world, seed);
        let truth = recording.truth.states.first()?;
        let turn = truth.world_from_body.inverse() * off.fixed_rows::<3>(0);
        off.fixed_rows_mut::<3>(0).copy_from(&turn);
        let mut start = Self::off_by(recording, &off, &in_world)?;
        let body_from_world = start.state.world_from_body.inverse();
        let body_from_world = body_from_world.matrix();
        let turns = start.covariance.fixed_view::<3, 3>(0, 0);
        let turns = body_from_world * turns * body_from_world.transpose();
        start.covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&turns);
        Some(start)
    }
    // ANCHOR_END: at_the_origin
}

/// Errors with these standard deviations.
fn drawn(sigmas: &[f64; 15], seed: u64) -> SVector<f64, 15> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    SVector::from(sigmas.map(|sigma| sigma * normal(&mut random)))
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
        if self.lacks_truth() {
            self.tell(&recording.truth)?;
        }
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
