//! A body that stands first.

use nalgebra::Vector3;
use vislam::simulation::{EulerAngles, Flight, FlightRecording, ScalarTrajectory, Trajectory};

pub const LEVER: Vector3<f64> = Vector3::new(0.1, 0.05, -0.02);

/// A flight that stands for two seconds, glued together from a stand and the flight that begins there.
pub fn taking_off(seed: u64) -> FlightRecording {
    let wave = ScalarTrajectory::wave;
    // At the beginning all velocities are zero, and so are the turns.
    let swing = |size: f64, rate: f64| ScalarTrajectory {
        value: size,
        ..wave(size, rate, -std::f64::consts::FRAC_PI_2)
    };
    let angles =
        EulerAngles { yaw: swing(0.2, 1.1), pitch: swing(0.05, 1.7), roll: swing(0.06, 1.3) };
    let motion = Trajectory {
        position: [swing(0.8, 1.5), swing(0.6, 1.2), swing(0.4, 1.9)],
        angles,
        ..Trajectory::default()
    };
    let still = Trajectory::hover();
    let base = Flight { picture_rate: 20.0, tracks: 40, ..Flight::new(still) }.with_lever(LEVER);
    let flying = Flight { seconds: 4.0, motion, ..base.clone() };
    let landmarks = flying.room(3.0, 400, seed).unwrap();
    let mut standing = Flight { seconds: 2.0, ..base }.record(&landmarks, seed).unwrap();
    let mut flight = flying.record(&landmarks, seed + 100).unwrap();
    let shift = 2_000_000_000;
    standing.readings.retain(|reading| reading.nanoseconds < shift);
    standing.pictures.pop();
    standing.truth.states.pop();
    standing.truth.biases.pop();
    // A landmark has one track on both sides.
    let followed = standing.truth.landmark_of_track.clone();
    let mut track_of: Vec<usize> = Vec::new();
    for (track, landmark) in flight.truth.landmark_of_track.iter().enumerate() {
        let in_first = flight.pictures[0].features.iter().any(|feature| feature.track == track);
        let same = followed.iter().position(|other| other == landmark).filter(|_| in_first);
        track_of.push(same.unwrap_or_else(|| {
            standing.truth.landmark_of_track.push(*landmark);
            standing.truth.landmark_of_track.len() - 1
        }));
    }
    for picture in &mut flight.pictures {
        picture.nanoseconds += shift;
        picture.features.iter_mut().for_each(|feature| feature.track = track_of[feature.track]);
        picture.features.sort_by_key(|feature| feature.track);
    }
    flight.readings.iter_mut().for_each(|reading| reading.nanoseconds += shift);
    standing.readings.append(&mut flight.readings);
    standing.pictures.append(&mut flight.pictures);
    standing.truth.states.append(&mut flight.truth.states);
    standing
}
