//! The record of two flights.

use std::borrow::Cow;

use nalgebra::Vector3;
use vislam::datasets::euroc::{read_ground_truth, read_imu};
use vislam::inertial::{GRAVITY, ImuNoise};
use vislam::preintegration::Rule;

use super::budget::{
    Pieces, best_offset, explained_by_the_gyroscope, gravity_beside_a_bias, gravity_found, lean,
    normalized_with_truth, roughness, shares, with_steady_bias,
};
use super::intervals::{Flight, LENGTHS, predicted, sizes};
use super::wander::Wander;
use crate::chapter::Chapter;
use crate::data::{DataFile, NotMade};
use crate::inertial::rest;
use crate::record::{RecordValue, accepted};

const FILES: [DataFile; 4] = [
    rest::FILE,
    DataFile {
        path: "euroc/V1_01_groundtruth_20hz.csv",
        sha256: "16543952bf69f3fb886008a26cc21d3c552deca8fa06087f0bc329c09d7fcbe3",
    },
    DataFile {
        path: "euroc/MH_05_imu0.csv",
        sha256: "e8cd122a85f89e82d7980160eceee53825a3d5711098841cf76fd48d688bce16",
    },
    DataFile {
        path: "euroc/MH_05_groundtruth.csv",
        sha256: "da13e5dcb3d5fc2f12c4e8bfae10dd380d765150be3312f989b0bc5550965451",
    },
];

/// Seconds, and the error of attitude over them.
pub const LATER: [(f64, &str); 6] = [
    (0.05, "v1_attitude_after_005"),
    (5.0, "v1_attitude_after_5"),
    (10.0, "v1_attitude_after_10"),
    (20.0, "v1_attitude_after_20"),
    (40.0, "v1_attitude_after_40"),
    (60.0, "v1_attitude_after_60"),
];

pub fn records(chapter: &mut Chapter) {
    let lengths = LENGTHS.map(|seconds| format!("{seconds}")).join(" ");
    let inputs = vec![("lengths", lengths), ("noise", "ImuNoise::euroc()".to_owned())];
    chapter.record_of_data("flights", &FILES, inputs, flights);
}

/// A value of the accepted record, in the units of the book.
pub fn accepted_value(name: &str) -> f64 {
    accepted("flights", name)
}

/// The flight of two files.
fn flight(imu: &DataFile, truth: &DataFile) -> Result<Flight, NotMade> {
    let failed =
        |file: &DataFile, error: String| NotMade::Failed(format!("{}: {error}", file.path));
    let samples = read_imu(&imu.read()?).map_err(|error| failed(imu, error.to_string()))?;
    let states = read_ground_truth(&truth.read()?);
    let truth = states.map_err(|error| failed(truth, error.to_string()))?;
    Ok(Flight { samples, truth })
}

fn flights() -> Result<Vec<RecordValue>, NotMade> {
    let [vicon_imu, vicon_truth, leica_imu, leica_truth] = &FILES;
    let (vicon, leica) = (flight(vicon_imu, vicon_truth)?, flight(leica_imu, leica_truth)?);
    let mut values = Values(Vec::new());
    let (gravity, _) = gravity_found(&vicon);
    let pieces = Pieces::new(&vicon, &gravity);
    let wanders = pieces.wanders();
    values.flight(&vicon);
    values.errors(&vicon);
    values.gravity(&vicon);
    values.wander(&pieces, &wanders);
    values.shares(&vicon, &gravity, &pieces);
    values.normalized(&vicon, &gravity, &wanders);
    values.excluded(&vicon, &pieces, &wanders[0]);
    values.leica(&leica);
    Ok(values.0)
}

/// From radians, m/s and metres to the units of the book.
const MRAD: f64 = 1e3;
const CM: f64 = 1e2;

struct Values(Vec<RecordValue>);

impl Values {
    fn add(
        &mut self,
        name: impl Into<Cow<'static, str>>,
        value: f64,
        unit: &'static str,
        decimals: usize,
    ) {
        self.0.push(RecordValue::new(name, value, unit, decimals, 1e-6));
    }

    fn flight(&mut self, vicon: &Flight) {
        self.add("v1_seconds", vicon.seconds(), "s", 0);
        self.add("v1_readings", vicon.samples.len() as f64, "", 0);
        self.add("v1_states", vicon.truth.len() as f64, "", 0);
    }

    fn errors(&mut self, vicon: &Flight) {
        for (index, seconds) in LENGTHS.into_iter().enumerate() {
            let [euler, midpoint] =
                [Rule::Euler, Rule::Midpoint].map(|rule| vicon.intervals(rule, seconds, 0.0));
            for (kind, [attitude, velocity, position]) in [
                ("_euler", sizes(&euler, &GRAVITY)),
                ("", sizes(&midpoint, &GRAVITY)),
                ("_predicted", predicted(&midpoint)),
            ] {
                self.add(format!("v1_attitude{kind}_{index}"), MRAD * attitude, "mrad", 2);
                self.add(format!("v1_velocity{kind}_{index}"), CM * velocity, "cm/s", 2);
                let decimals = if index == 0 { 3 } else { 2 };
                self.add(format!("v1_position{kind}_{index}"), CM * position, "cm", decimals);
            }
        }
    }

    fn gravity(&mut self, vicon: &Flight) {
        let (gravity, sigma) = gravity_found(vicon);
        self.add("v1_gravity_x", CM * gravity.x, "cm/s²", 1);
        self.add("v1_gravity_y", CM * gravity.y, "cm/s²", 1);
        self.add("v1_gravity_z", CM * gravity.z, "cm/s²", 1);
        self.add("v1_gravity_size", gravity.norm(), "m/s²", 3);
        self.add("v1_gravity_sigma", sigma.z, "m/s²", 4);
        self.add("v1_tilt_mrad", MRAD * tilt(&gravity), "mrad", 1);
        self.add("v1_tilt_deg", tilt(&gravity).to_degrees(), "°", 2);
        // The first axis of the body is the one that points up most.
        let free = gravity_beside_a_bias(vicon);
        self.add("v1_free_x", CM * free.gravity.x, "cm/s²", 2);
        self.add("v1_free_x_sigma", CM * free.sigma(0), "cm/s²", 2);
        self.add("v1_free_size", free.gravity.norm(), "m/s²", 3);
        self.add("v1_free_size_sigma", free.sigma(2), "m/s²", 3);
        self.add("v1_free_bias", free.bias.x, "m/s²", 2);
        self.add("v1_free_bias_sigma", free.sigma(3), "m/s²", 2);
        self.add("v1_free_correlation", free.correlation(2, 3).abs(), "", 4);
        self.add("v1_lean", lean(vicon).to_degrees(), "°", 1);
    }

    fn wander(&mut self, pieces: &Pieces, [attitude, velocity]: &[Wander; 2]) {
        self.add("v1_attitude_sigma", MRAD * attitude.sigma, "mrad", 1);
        self.add("v1_attitude_tau", attitude.tau, "s", 1);
        self.add("v1_velocity_sigma", CM * velocity.sigma, "cm/s", 2);
        self.add("v1_velocity_tau", velocity.tau, "s", 2);
        for (index, seconds) in LENGTHS.into_iter().enumerate() {
            let [attitude, velocity] = [attitude, velocity].map(|of| of.spread(seconds).sqrt());
            self.add(format!("v1_attitude_wander_{index}"), MRAD * attitude, "mrad", 2);
            self.add(format!("v1_velocity_wander_{index}"), CM * velocity, "cm/s", 2);
        }
        for (seconds, name) in LATER {
            let decimals = if seconds < 0.1 { 2 } else { 1 };
            self.add(name, MRAD * pieces.attitude_after(seconds), "mrad", decimals);
        }
        // Both horizontal axes of a tilt that gravity leaks by for a second.
        let leak = GRAVITY.norm() * 2_f64.sqrt() * attitude.sigma;
        self.add("v1_leak", CM * leak, "cm/s", 1);
        self.add("v1_attitude_most", MRAD * 6_f64.sqrt() * attitude.sigma, "mrad", 1);
    }

    fn shares(&mut self, vicon: &Flight, gravity: &Vector3<f64>, pieces: &Pieces) {
        for (index, parts) in shares(vicon, gravity, pieces).into_iter().enumerate() {
            for (shares, (part, unit)) in
                parts.into_iter().zip([("velocity", "cm/s"), ("position", "cm")])
            {
                let decimals = if part == "position" && index == 0 { 3 } else { 2 };
                for (kind, share) in ["gravity", "attitude", "rest"].into_iter().zip(shares) {
                    self.add(format!("v1_{part}_{kind}_{index}"), CM * share, unit, decimals);
                }
            }
        }
        let steady = with_steady_bias(vicon);
        let (gravity, _) = gravity_found(&steady);
        let [velocity, _] = Pieces::new(&steady, &gravity).without_attitude(1.0);
        self.add("v1_velocity_steady", CM * velocity, "cm/s", 2);
        let walk = ImuNoise::euroc().accelerometer_walk * vicon.seconds().sqrt();
        self.add("v1_bias_walk", CM * walk, "cm/s²", 1);
    }

    fn normalized(
        &mut self,
        vicon: &Flight,
        gravity: &Vector3<f64>,
        [attitude, velocity]: &[Wander; 2],
    ) {
        for (index, seconds) in LENGTHS.into_iter().enumerate() {
            let intervals = vicon.intervals(Rule::Midpoint, seconds, 0.0);
            let of = normalized_with_truth(&intervals, gravity, attitude, velocity);
            self.add(format!("v1_normalized_truth_{index}"), of, "", 1);
        }
    }

    /// What was suspected, and how much of the errors it can be.
    fn excluded(&mut self, vicon: &Flight, pieces: &Pieces, attitude: &Wander) {
        for (index, seconds) in LENGTHS.into_iter().enumerate() {
            let (offset, _) = best_offset(vicon, seconds);
            self.add(format!("v1_offset_{index}"), 1e3 * offset, "ms", 2);
        }
        self.add("v1_offset_gain", MRAD * best_offset(vicon, 1.0).1, "mrad", 2);
        let (share, chance) = explained_by_the_gyroscope(vicon);
        self.add("v1_gyro_share", 1e2 * share, "%", 0);
        self.add("v1_gyro_chance", 1e2 * chance, "%", 0);
        // Whatever a minute shows beyond the wander, as if white noise had done it.
        let beyond = |error: f64| error.powi(2) - attitude.spread(60.0);
        let density = |error: f64| (beyond(error).max(0.0) / 180.0).sqrt();
        let limit = density(pieces.attitude_after(60.0));
        self.add("v1_density_limit", limit / ImuNoise::euroc().gyro, "", 1);
        self.add("v1_density_second", MRAD * 3_f64.sqrt() * limit, "mrad", 2);
        // The same when the ground truth's bias may not follow a drift of the gyroscope.
        let steady = Pieces::new(&with_steady_bias(vicon), &GRAVITY).attitude_after(60.0);
        self.add("v1_steady_after_60", MRAD * steady, "mrad", 1);
        self.add("v1_steady_limit", density(steady) / ImuNoise::euroc().gyro, "", 1);
        self.add("v1_steady_second", MRAD * 3_f64.sqrt() * density(steady), "mrad", 2);
        // Three axes whose biases walk, integrated once.
        let walked = ImuNoise::euroc().gyro_walk * 60_f64.powf(1.5);
        self.add("v1_walk_60", MRAD * walked, "mrad", 1);
        let [gyro, accelerometer] = roughness(&vicon.samples, 4000, 24_000);
        self.add("v1_rough_gyro", gyro / ImuNoise::euroc().gyro, "", 0);
        let ratio = accelerometer / ImuNoise::euroc().accelerometer;
        self.add("v1_rough_accelerometer", ratio, "", 0);
        let correlation = pieces.step_correlation();
        let fresh = (1.0 - correlation).sqrt() * pieces.attitude_after(0.05);
        self.add("v1_step_correlation", correlation, "", 2);
        self.add("v1_step_fresh", MRAD * fresh, "mrad", 3);
        self.add("v1_step_predicted", MRAD * predicted(&pieces.pieces)[0], "mrad", 3);
    }

    fn leica(&mut self, leica: &Flight) {
        for (index, seconds) in LENGTHS.into_iter().enumerate() {
            let intervals = leica.intervals(Rule::Midpoint, seconds, 0.0);
            let [_, velocity, position] = sizes(&intervals, &GRAVITY);
            self.add(format!("mh_velocity_{index}"), CM * velocity, "cm/s", 2);
            self.add(format!("mh_position_{index}"), CM * position, "cm", 2);
        }
        let [attitude, ..] = sizes(&leica.intervals(Rule::Midpoint, 0.1, 0.0), &GRAVITY);
        self.add("mh_attitude_0", MRAD * attitude, "mrad", 2);
        self.add("mh_tilt_mrad", MRAD * tilt(&gravity_found(leica).0), "mrad", 2);
    }
}

/// The angle between gravity and the world's z axis, in radians.
fn tilt(gravity: &Vector3<f64>) -> f64 {
    gravity.xy().norm().atan2(-gravity.z)
}
