//! Names and values of sensors.

use approx::assert_abs_diff_eq;
use nalgebra::{Matrix3, Vector3};
use vislam::datasets::calibration::{CalibrationFault, read_calibration, read_right_camera};
use vislam::inertial::{Calibrated, ImuNoise};
use vislam::reprojection::PinholeError;

const TEXT: &str = "\u{feff}# a camera on a board
[camera]
fx = 460   # pixels
fy = 458.5
cx = 367
cy = 248
width = 752.0
pixel_sigma = 0.5
time_offset = -2e-3

[imu]\r
gyro = 1e-3
accelerometer = 2e-2
gyro_walk = 3e-5
accelerometer_walk = 0

[extrinsics]
body_from_camera = [
    [0, 0, 1, 0.1], # ahead
    [-1, 0, 0, 0.0],
    [0, -1, 0, 0.05], [0, 0, 0, 1],
]
";

#[test]
fn a_calibration_is_read() {
    let sensors = read_calibration(TEXT).unwrap();
    let camera = sensors.camera;
    assert_eq!([camera.fx, camera.fy, camera.cx, camera.cy], [460.0, 458.5, 367.0, 248.0]);
    assert_eq!((sensors.pixel_sigma, sensors.rig.time_offset), (0.5, -2e-3));
    let noise =
        ImuNoise { gyro: 1e-3, accelerometer: 2e-2, gyro_walk: 3e-5, accelerometer_walk: 0.0 };
    assert_eq!((sensors.noise, sensors.gravity), (noise, 9.81));
    assert_eq!(sensors.calibrated, Calibrated::default());
    let mounting = sensors.rig.body_from_camera;
    assert_eq!(mounting.translation.vector, Vector3::new(0.1, 0.0, 0.05));
    let axes = Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
    assert_abs_diff_eq!(*mounting.rotation.to_rotation_matrix().matrix(), axes, epsilon = 1e-12);
    // One row of sixteen says the same.
    let start = TEXT.find("body_from").unwrap();
    let one_row =
        TEXT[..start].to_owned() + "body_from_camera = [0,0,1,.1,-1,0,0,0,0,-1,0,.05,0,0,0,1]";
    assert_eq!(read_calibration(&one_row).unwrap(), sensors);
    let without = TEXT.replace("pixel_sigma = 0.5\n", "").replace("time_offset = -2e-3\n", "");
    let sensors = read_calibration(&without).unwrap();
    assert_eq!((sensors.pixel_sigma, sensors.rig.time_offset), (1.0, 0.0));
}

#[test]
fn what_is_uncertain_is_to_be_estimated() {
    let clock = TEXT.replace("[imu]", "time_offset_sigma = 5e-3\n[imu]");
    let calibrated = read_calibration(&clock).unwrap().calibrated;
    assert_eq!(calibrated, Calibrated { time_offset: Some(5e-3), extrinsics: None });
    let [shift, turn] = ["translation_sigma = 0.02\n", "rotation_sigma = 0.01\n"];
    let both = read_calibration(&(TEXT.to_owned() + turn + shift)).unwrap().calibrated;
    assert_eq!(both, Calibrated { time_offset: None, extrinsics: Some([0.02, 0.01]) });
    let error = read_calibration(&(TEXT.to_owned() + turn)).unwrap_err();
    let missing = CalibrationFault::Missing { name: "extrinsics.translation_sigma" };
    assert_eq!(error.fault, missing);
    let error = read_calibration(&clock.replace("5e-3", "0")).unwrap_err();
    assert!(matches!(error.fault, CalibrationFault::Positive { value: 0.0, .. }), "{error}");
}

#[test]
fn a_baseline_makes_a_pair() {
    assert_eq!(read_right_camera(TEXT).unwrap(), None);
    let text = TEXT.replace("[imu]", "[stereo]\nbaseline = 0.11\n[imu]");
    let right = read_right_camera(&text).unwrap().unwrap();
    assert_eq!(right.camera, read_calibration(TEXT).unwrap().camera);
    assert_eq!(right.camera_from_first.translation.vector, Vector3::new(-0.11, 0.0, 0.0));
    let error = read_right_camera(&text.replace("0.11", "-0.11")).unwrap_err();
    assert!(matches!(error.fault, CalibrationFault::Positive { value: -0.11, .. }), "{error}");
    assert_eq!(error.line, text.lines().position(|line| line.contains("baseline")).unwrap() + 1);
}

#[test]
fn a_fault_in_a_calibration_is_told_with_its_line() {
    let fault = |from: &str, to: &str| {
        assert!(TEXT.contains(from), "{from}");
        let error = read_calibration(&TEXT.replacen(from, to, 1)).unwrap_err();
        (error.line, error.fault)
    };
    let unknown = |name: &str| CalibrationFault::Unknown { name: name.into() };
    assert_eq!(fault("fx =", "focal ="), (3, unknown("camera.focal")));
    assert_eq!(fault("[imu]", "[gyroscope]"), (12, unknown("gyroscope.gyro")));
    let text = "fx 460".into();
    assert_eq!(fault("fx = 460   #", "fx 460 #"), (3, CalibrationFault::Line { text }));
    assert_eq!(fault("fy =", "fx ="), (4, CalibrationFault::Twice { name: "camera.fx" }));
    for text in ["", "NaN", "1e999", "a pixel", "[1]"] {
        let number = CalibrationFault::Number { text: text.into() };
        assert_eq!(fault("0.5", text), (8, number));
    }
    let positive = CalibrationFault::Positive { name: "camera.pixel_sigma", value: 0.0 };
    assert_eq!(fault("0.5", "0"), (8, positive));
    let camera = PinholeError::FocalLength { name: "fx", value: -460.0 };
    assert_eq!(fault("460", "-460"), (3, CalibrationFault::Camera(camera)));
    assert!(matches!(fault("2e-2", "-1"), (13, CalibrationFault::Noise(_))));
    assert!(matches!(fault("458.5", "0"), (4, CalibrationFault::Camera(_))));
    for (from, to) in [
        ("0, 0, 1, 0.1", "0, 0, 2, 0.1"),
        ("0, 0, 1, 0.1", "0, 0, -1, 0.1"),
        ("0, 0, 1, 0.1", "0, 0, 1, NaN"),
        ("0, 0, 1, 0.1", "0, 0, 1"),
        ("0, 0, 0, 1]", "0, 0, 1, 0]"),
    ] {
        assert_eq!(fault(from, to), (18, CalibrationFault::Transform), "{to}");
    }
    assert_eq!(
        fault("    [0, -1, 0, 0.05], [0, 0, 0, 1],\n]\n", ""),
        (18, CalibrationFault::Transform)
    );
    let missing = CalibrationFault::Missing { name: "imu.gyro_walk" };
    assert_eq!(fault("gyro_walk = 3e-5\n", ""), (21, missing));
    let error = read_calibration("").unwrap_err().to_string();
    assert!(error.starts_with("line 1: the file ends without `camera.fx`"), "{error}");
}
