//! Flies simulated flights with the multi-state constraint Kalman filter.

use std::error::Error;
use std::time::Instant;

use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use vislam::inertial::{ImuBias, NavState};
use vislam::least_squares::Manifold;
use vislam::manifold::so3;
use vislam::msckf::{Linearization, Msckf, MsckfOptions, Start};
use vislam::simulation::{Flight, FlightRecording, Trajectory};

fn nees(error: &[f64], covariance: &DMatrix<f64>) -> f64 {
    let e = DVector::from_row_slice(error);
    e.dot(&covariance.clone().cholesky().unwrap().solve(&e)) / e.len() as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let get = |name: &str, default: f64| {
        arguments
            .iter()
            .position(|a| a == name)
            .map_or(default, |at| arguments[at + 1].parse().unwrap())
    };
    let flights = get("--flights", 3.0) as u64;
    let seconds = get("--seconds", 60.0);
    let clones = get("--clones", 11.0) as usize;
    let first = arguments.iter().any(|a| a == "--first-estimates");
    let verbose = arguments.iter().any(|a| a == "-v");
    let mut sums = [0.0; 4];
    let (mut square, mut time, mut pictures, mut rows) = (0.0, 0.0, 0, 0);
    for seed in 0..flights {
        let flight = Flight {
            seconds,
            picture_rate: 10.0,
            tracks: 40,
            ..Flight::new(Trajectory::figure_eight()).with_lever(Vector3::new(0.1, 0.05, -0.02))
        };
        let recording =
            flight.record(&flight.room(3.0, get("--landmarks", 800.0) as usize, seed)?, seed)?;
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed + 1000);
        let sigmas: [f64; 15] = [
            0.01, 0.01, 1e-4, 0.05, 0.05, 0.05, 1e-3, 1e-3, 1e-3, 0.002, 0.002, 0.002, 0.02, 0.02,
            0.02,
        ];
        let step: Vec<f64> =
            sigmas.iter().map(|s| s * random.sample::<f64, _>(StandardNormal)).collect();
        let mut covariance = SMatrix::<f64, 15, 15>::zeros();
        sigmas.iter().enumerate().for_each(|(k, s)| covariance[(k, k)] = s * s);
        // Truth is the estimate moved by the error.
        let truth0 = recording.truth.states[0];
        let back: Vec<f64> = step.iter().map(|s| -s).collect();
        let state = NavState {
            world_from_body: so3::retract(
                &truth0.world_from_body,
                &Vector3::from_row_slice(&back[..3]),
            ),
            ..truth0.retract(&[&[0.0; 3], &back[3..9]].concat())
        };
        let bias = ImuBias::from_vector(
            &(recording.truth.biases[0].vector() + SVector::<f64, 6>::from_row_slice(&back[9..])),
        );
        let mut options = MsckfOptions { clones, ..MsckfOptions::of_flight(&flight) };
        options.landmarks = get("--kept", 0.0) as usize;
        if first {
            options.linearization = Linearization::FirstEstimates
        }
        let start = Start { nanoseconds: 0, state, bias, covariance, rig: flight.rig };
        let mut filter = Msckf::new(options, &start)?;
        let FlightRecording { readings, pictures: shots, truth, .. } = &recording;
        let mut next = 0;
        let clock = Instant::now();
        for (k, picture) in shots.iter().enumerate() {
            let time = flight.rig.imu_nanoseconds(picture.nanoseconds);
            while next < readings.len() && (next == 0 || readings[next - 1].nanoseconds < time) {
                filter.reading(readings[next])?;
                next += 1;
            }
            let report = filter.picture(picture)?;
            rows += report.rows;
            if verbose && k % 20 == 0 {
                let e = truth.states[k].position - filter.state().position;
                println!("{k} {report:?} error {:.4}", e.norm());
            }
            square += (truth.states[k].position - filter.state().position).norm_squared();
        }
        time += clock.elapsed().as_secs_f64();
        pictures += shots.len();
        let k = shots.len() - 1;
        let estimate = *filter.state();
        let mut error = [0.0; 9];
        estimate.local(&truth.states[k], &mut error);
        let p = filter.covariance();
        let rotation = estimate.world_from_body;
        let phi = rotation * Vector3::from_row_slice(&error[..3]);
        let world = rotation.matrix() * p.fixed_view::<3, 3>(0, 0) * rotation.matrix().transpose();
        let block = |at: usize, n: usize| DMatrix::from_fn(n, n, |r, c| p[(at + r, at + c)]);
        sums[0] += nees(&error[6..9], &block(6, 3));
        sums[1] += nees(&phi.as_slice()[..2], &DMatrix::from_fn(2, 2, |r, c| world[(r, c)]));
        sums[2] += phi.z * phi.z / world[(2, 2)];
        sums[3] += nees(&error[3..6], &block(3, 3));
        if verbose {
            println!("sigmas p {:.4} yaw {:.5}", p[(6, 6)].sqrt(), world[(2, 2)].sqrt());
        }
    }
    let n = flights as f64;
    println!(
        "rows {:.1} nees_position {:.2}  nees_tilt {:.2}  nees_yaw {:.2}  nees_velocity {:.2} rmse_cm {:.2}  ms_per_picture {:.3}",
        rows as f64 / pictures as f64,
        sums[0] / n,
        sums[1] / n,
        sums[2] / n,
        sums[3] / n,
        100.0 * (square / pictures as f64).sqrt(),
        1e3 * time / pictures as f64
    );
    Ok(())
}
