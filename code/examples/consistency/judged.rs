//! What becomes of a filter's errors, by what it believes of them.

use std::fmt;
use std::time::{Duration, Instant};

use nalgebra::SMatrix;
use vislam::consistency::{Claimed, Policy};
use vislam::filtering::{BlockNees, NeesError, StateError, attitude_in_world};
use vislam::inertial::NavState;
use vislam::simulation::FlightRecording;

use crate::flown::{self, PICTURE_RATE, Setting};

/// Sums over flights, at one time after their beginnings.
#[derive(Debug, Clone, Default)]
pub struct Judged {
    flights: f64,
    /// Of position, tilt, yaw and velocity, each divided by its dimension.
    nees: [f64; 4],
    /// Of the standard deviation of yaw and its error, in rad, of those of the velocity along itself,
    /// in m/s, and of the distance from the truth, in metres.
    squares: [f64; 5],
    /// Of the distances from the truth at all pictures until then, in metres.
    distances: f64,
    pictures: f64,
    time: Duration,
    claimed: Claimed,
}

impl Judged {
    /// An estimate of a state, the covariance of its step, and the truth.
    pub fn of(
        estimate: &NavState,
        truth: &NavState,
        covariance: &SMatrix<f64, 9, 9>,
    ) -> Result<Self, NeesError> {
        let BlockNees { position, tilt, yaw, velocity } =
            BlockNees::of(estimate, truth, covariance)?;
        let error = StateError::between(estimate, truth);
        let turn = attitude_in_world(estimate, &covariance.fixed_view::<3, 3>(0, 0));
        let ahead = truth.velocity.normalize();
        let along = (ahead.transpose() * covariance.fixed_view::<3, 3>(3, 3) * ahead).x;
        let squares = [
            turn[(2, 2)],
            error.yaw().powi(2),
            along,
            error.velocity.dot(&ahead).powi(2),
            error.position.norm_squared(),
        ];
        let nees = [position, tilt, yaw, velocity];
        Ok(Self { flights: 1.0, nees, squares, ..Self::default() })
    }

    /// With the distances at all pictures until then, how long all of them took, and what was
    /// claimed.
    pub fn after(
        mut self,
        (distances, pictures): (f64, usize),
        time: Duration,
        claimed: Claimed,
    ) -> Self {
        (self.distances, self.pictures) = (distances, pictures as f64);
        (self.time, self.claimed) = (time, claimed);
        self
    }

    /// Adds those of another flight.
    pub fn add(&mut self, other: &Self) {
        let add = |sums: &mut [f64], more: &[f64]| {
            sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        };
        add(&mut self.nees, &other.nees);
        add(&mut self.squares, &other.squares);
        self.flights += other.flights;
        self.distances += other.distances;
        self.pictures += other.pictures;
        self.time += other.time;
        self.claimed.add(&other.claimed);
    }
}

impl fmt::Display for Judged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [position, tilt, yaw, velocity] = self.nees.map(|sum| sum / self.flights);
        let [sigma, error, speed, speed_error, distance] =
            self.squares.map(|sum| 1e3 * (sum / self.flights).sqrt());
        let distance = 0.1 * distance;
        let rmse = 100.0 * (self.distances / self.pictures).sqrt();
        let time = 1e3 * self.time.as_secs_f64() / self.pictures;
        let shifts = self.claimed.part_of_shifts().unwrap_or(f64::NAN);
        let turn = self.claimed.part_of_turn().unwrap_or(f64::NAN);
        write!(
            f,
            "nees_position {position:.3}  nees_tilt {tilt:.3}  nees_yaw {yaw:.3}  rmse_cm \
             {rmse:.3}  ms_per_picture {time:.3}  error_cm {distance:.3}  nees_velocity \
             {velocity:.3}  sigma_yaw_mrad {sigma:.3}  error_yaw_mrad {error:.3}  sigma_speed_mm_s {speed:.3}  error_speed_mm_s \
             {speed_error:.3}  claimed_shift {shifts:.2e}  claimed_yaw {turn:.2e}"
        )
    }
}

/// Follows a recording with a policy, and judges it at some times.
pub fn follow(
    recording: &FlightRecording,
    (setting, policy): (&Setting, Policy),
    times: &[f64],
    seed: u64,
) -> Result<Vec<Judged>, String> {
    let (mut distances, mut claimed, mut judged) = (0.0, Claimed::default(), Vec::new());
    let begin = Instant::now();
    let told = |error: &dyn std::error::Error| format!("flight {seed}, {policy}: {error}");
    flown::follow(recording, setting, policy, seed, |number, filter, report| {
        let truth = &recording.truth.states[number];
        distances += (truth.position - filter.state().position).norm_squared();
        claimed.add(&report.claimed);
        if times.iter().any(|time| (time * PICTURE_RATE).round() as usize == number) {
            let covariance = filter.covariance().fixed_view::<9, 9>(0, 0).into_owned();
            let one = Judged::of(filter.state(), truth, &covariance);
            let until = (distances, number + 1);
            judged.push(one.map(|one| one.after(until, begin.elapsed(), claimed)));
        }
    })
    .map_err(|error| told(&error))?;
    judged.into_iter().map(|one| one.map_err(|error| told(&error))).collect()
}
