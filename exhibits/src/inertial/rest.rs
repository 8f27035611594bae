//! The record of a real sensor that rests on the floor while rotors shake it.

use vislam::datasets::euroc::read_imu;
use vislam::inertial::ImuNoise;

use super::averages::{allan_deviation, sums};
use super::noise::STEP;
use crate::chapter::Chapter;
use crate::data::{DataFile, NotMade};
use crate::record::RecordValue;

/// Readings of the flight V1_01 with the Vicon system.
pub const FILE: DataFile = DataFile {
    path: "euroc/V1_01_imu0.csv",
    sha256: "4cef78a5cf7c8ee52016a160de4b50184da2a216d615feb7ebbbb3bc99efa89e",
};

/// Seconds from the first reading in which the vehicle does not leave its place.
const REST: f64 = 4.9;

/// Readings in a window; the names of its length and of what the stated densities promise for it;
/// and those of what the two sensors show there.
const WINDOWS: [(usize, [&str; 3], [&str; 2]); 4] = [
    (1, ["rest_window_0", "rest_gyro_promised_0", "rest_acc_promised_0"], ["gyro_0", "acc_0"]),
    (4, ["rest_window_1", "rest_gyro_promised_1", "rest_acc_promised_1"], ["gyro_1", "acc_1"]),
    (32, ["rest_window_2", "rest_gyro_promised_2", "rest_acc_promised_2"], ["gyro_2", "acc_2"]),
    (200, ["rest_window_3", "rest_gyro_promised_3", "rest_acc_promised_3"], ["gyro_3", "acc_3"]),
];

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("rest_seconds", REST, "s", 1);
    let noise = ImuNoise::euroc();
    for (window, [length, gyro, accelerometer], _) in WINDOWS {
        let seconds = window as f64 * STEP;
        let promised = |density: f64| 1e3 * density / seconds.sqrt();
        chapter.number(length, 1e3 * seconds, "ms", 0);
        chapter.number(gyro, promised(noise.gyro), "mrad/s", 1);
        chapter.number(accelerometer, promised(noise.accelerometer), "mm/s²", 0);
    }
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![("seconds", format!("{REST}"))];
    chapter.record_of_data("rest", &[FILE], inputs, rest);
}

fn rest() -> Result<Vec<RecordValue>, NotMade> {
    let samples = read_imu(&FILE.read()?)
        .map_err(|error| NotMade::Failed(format!("{}: {error}", FILE.path)))?;
    let resting = samples.iter().take_while(|sample| samples[0].seconds_to(sample) < REST);
    let sums = sums(resting.map(|stamped| stamped.sample));
    let values = WINDOWS.into_iter().flat_map(|(window, _, names)| {
        let [gyro, accelerometer] = allan_deviation(&sums, window);
        let value = |name, value: f64, unit, decimals| {
            RecordValue::new(name, 1e3 * value, unit, decimals, 1e-6)
        };
        [value(names[0], gyro, "mrad/s", 1), value(names[1], accelerometer, "mm/s²", 0)]
    });
    Ok(values.collect())
}
