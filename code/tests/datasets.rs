//! What is read from files of recordings, and what is said of files that are not as they should be.

#[path = "datasets/calibration.rs"]
mod calibration;
mod measured;
#[path = "datasets/written.rs"]
mod written;

use approx::assert_abs_diff_eq;
use nalgebra::{Isometry3, Matrix3, Rotation3, Vector2, Vector3, Vector6};
use vislam::bundle_adjustment::{BalCamera, TinyBa};
use vislam::datasets::TableFault;
use vislam::datasets::bal::{BalError, BalFault, read_bal};
use vislam::datasets::euroc::{read_ground_truth, read_imu};
use vislam::datasets::recording::read_recording;
use vislam::datasets::tracks::{Feature, Picture, read_tracks};
use vislam::inertial::ImuBias;
use vislam::manifold::{se3, so3};
use vislam::reprojection::PinholeError;

use measured::data;

// The inertial files of EuRoC.

const IMU_HEADER: &str = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],\
    w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]";
const LONG_HEADER: &str = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], \
    q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], \
    b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], \
    b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]";
const SHORT_HEADER: &str = "#time(ns),px,py,pz,qw,qx,qy,qz,vx,vy,vz,bwx,bwy,bwz,bax,bay,baz";

#[test]
fn readings_are_read_from_text() {
    let text = format!(
        "{IMU_HEADER}\r\n1403715273262142976,1,2,3,4,5,6e0\r\n\r\n\
        1403715273267142912, -1, 0.5, 0, 0, 0, 9.81\r\n"
    );
    let samples = read_imu(&text).unwrap();
    assert_eq!(samples.len(), 2);
    assert_eq!(samples[0].nanoseconds, 1_403_715_273_262_142_976);
    assert_eq!(samples[0].sample.gyro, Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(samples[0].sample.accelerometer, Vector3::new(4.0, 5.0, 6.0));
    assert_abs_diff_eq!(samples[0].seconds_to(&samples[1]), 0.004999936, epsilon = 1e-15);
}

#[test]
fn ground_truth_is_read_with_either_header() {
    let line = "100,1,2,3,0.7071,0,0,0.7071,4,5,6,0.1,0.2,0.3,0.4,0.5,0.6";
    for header in [LONG_HEADER, SHORT_HEADER] {
        let rows = read_ground_truth(&format!("{header}\n{line}\n")).unwrap();
        let row = &rows[0];
        assert_eq!((rows.len(), row.nanoseconds), (1, 100));
        assert_eq!(row.state.position, Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(row.state.velocity, Vector3::new(4.0, 5.0, 6.0));
        // A quarter turn to the left, w first: the body's x axis points along the world's y.
        let quarter = Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
        assert_abs_diff_eq!(row.state.world_from_body, quarter, epsilon = 1e-12);
        assert_eq!(row.bias.vector(), Vector6::new(0.1, 0.2, 0.3, 0.4, 0.5, 0.6));
    }
}

#[test]
fn a_fault_in_a_file_is_told_with_its_line_and_column() {
    let imu = |lines: &str| read_imu(&format!("{IMU_HEADER}\n{lines}")).unwrap_err();
    let told = |lines: &str| imu(lines).to_string();
    assert_eq!(
        told("\n\n"),
        "line 1: the file ends without any line below the names of its columns; it is not complete"
    );
    assert_eq!(told("1,2,3,4,5,6"), "line 2: 6 fields; there must be 7, separated by commas");
    assert_eq!(imu("1,2,3,4,5,6,7,8").fault, TableFault::Fields { wanted: 7, found: 8 });
    let bad = |line: &str| imu(&format!("1,0,0,0,0,0,0\n\n{line}"));
    assert_eq!(
        bad("1.5,0,0,0,0,0,0").to_string(),
        "line 4, column 1 (timestamp): `1.5` is not a time in whole nanoseconds; mend the field or \
         remove the line"
    );
    for word in ["x", "NaN", "inf", "1e999", ""] {
        let error = bad(&format!("2,0,0,{word},0,0,0"));
        let column = error.column.expect("a column");
        assert_eq!((error.line, column.number, column.name), (4, 4, "w_RS_S_z"));
        let wanted = "a finite number";
        assert_eq!(error.fault, TableFault::Value { text: word.into(), wanted });
    }
    for (time, before) in [("1", 1), ("0", 1), ("-5", 1)] {
        let error = bad(&format!("{time},0,0,0,0,0,0"));
        assert!(matches!(error.fault, TableFault::Order { before: found, .. } if found == before));
        assert_eq!((error.line, error.column), (4, None));
    }
}

#[test]
fn a_line_has_its_number_whatever_ends_the_lines() {
    for (end, between) in [("\n", ""), ("\r\n", ""), ("\n", "\n\n"), ("\r\n", "\r\n")] {
        let line = 3 + between.len() / end.len();
        let text = format!("{IMU_HEADER}{end}1,0,0,0,0,0,0{end}{between}2,0,0,x,0,0,0{end}");
        assert_eq!(read_imu(&text).unwrap_err().line, line, "{text:?}");
    }
}

#[test]
fn a_byte_order_mark_and_empty_lines_do_not_matter() {
    let text = format!("{IMU_HEADER}\r\n1,0,0,0,0,0,0\r\n\r\n   \n\n");
    for before in ["", "\u{feff}", "\n", "\u{feff}\r\n \r\n"] {
        assert_eq!(read_imu(&format!("{before}{text}")).unwrap().len(), 1);
    }
    assert!(read_bal::<6>(&format!("\u{feff}{BAL}")).is_ok());
}

#[test]
fn a_file_with_other_columns_is_refused() {
    for header in ["1,0,0,0,0,0,0", "#t,x,y,z,a,b,c", SHORT_HEADER] {
        let error = read_imu(&format!("{header}\n1,0,0,0,0,0,0\n")).unwrap_err();
        assert_eq!((error.line, error.column), (1, None));
        assert!(matches!(error.fault, TableFault::Header { .. }), "{error}");
    }
    assert!(read_ground_truth(&format!("{IMU_HEADER}\n")).is_err());
    assert!(read_imu("").is_err());
    // Quaternions with the scalar last would be read wrongly.
    let swapped = SHORT_HEADER.replace("qw,qx,qy,qz", "qx,qy,qz,qw");
    assert!(read_ground_truth(&format!("{swapped}\n")).is_err());
    // Whatever a file is, an error remains a sentence, also where a letter has several bytes.
    assert!(read_imu(&"é".repeat(100_000)).unwrap_err().to_string().len() < 500);
}

#[test]
fn a_quaternion_that_is_no_rotation_is_told_with_its_line() {
    let line = "100,1,2,3,0.9,0,0,0.9,4,5,6,0,0,0,0,0,0";
    let error = read_ground_truth(&format!("{SHORT_HEADER}\n{line}\n")).unwrap_err();
    assert_eq!(error.line, 2);
    assert!(matches!(error.fault, TableFault::Quaternion { norm } if norm > 1.2), "{error}");
}

// Feature tracks.

#[test]
fn lines_of_one_time_make_a_picture_in_the_order_of_its_tracks() {
    let pictures =
        read_tracks("#timestamp [ns],track,u [px],v [px]\n5,9,1,2\n5,4,-3,0.5\n7,9,1.5,2\n")
            .unwrap();
    let feature = |track, u, v| Feature { track, pixel: Vector2::new(u, v), right: None };
    let first = vec![feature(4, -3.0, 0.5), feature(9, 1.0, 2.0)];
    assert_eq!(pictures[0], Picture { nanoseconds: 5, features: first });
    assert_eq!(pictures[1], Picture { nanoseconds: 7, features: vec![feature(9, 1.5, 2.0)] });
    assert_eq!(pictures.len(), 2);
}

#[test]
fn a_feature_of_a_pair_of_cameras_may_be_missing_in_the_right_one() {
    let header = "timestamp,track,u,v,u_right,v_right";
    let pictures = read_tracks(&format!("{header}\r\n5,1,1,2,0,2\r\n5,2,3,4,,\r\n")).unwrap();
    let rights: Vec<_> = pictures[0].features.iter().map(|feature| feature.right).collect();
    assert_eq!(rights, [Some(Vector2::new(0.0, 2.0)), None]);
    let error = read_tracks(&format!("{header}\n5,1,1,2,0,\n")).unwrap_err();
    assert_eq!(error.column.expect("a column").name, "v_right");
}

// ANCHOR: track_faults
#[test]
fn a_fault_in_a_file_of_tracks_is_told() {
    let told = |lines: &str| {
        read_tracks(&format!("timestamp,track,u,v\n5,1,1,2\n{lines}")).unwrap_err().to_string()
    };
    assert_eq!(
        told("5,2,0,0\n5,1,3,4"),
        "line 4: track 1 of this picture stands here for the second time; remove one of the two"
    );
    // Also when a picture is taken up again after another one.
    assert_eq!(
        told("7,1,0,0\n5,2,3,4"),
        "line 4: 5 ns is not later than 7 ns before it; sort the lines by time and remove repetitions"
    );
    for track in ["-1", "1.0", "a", ""] {
        assert!(told(&format!("5,{track},0,0")).starts_with("line 3, column 2 (track): `"));
    }
    assert!(told("5,2,0,nan").starts_with("line 3, column 4 (v): `nan` is not a finite number"));
    assert!(read_tracks("").is_err());
    assert!(read_tracks("timestamp,track,u,v\n").is_err());
    assert!(read_tracks("5,1,1,2\n").unwrap_err().to_string().contains("`timestamp,track,u,v` or"));
}
// ANCHOR_END: track_faults

// Readings and tracks in one file.

const COLUMNS: &str = "row_type,t_abs,t_rel,seq,frame_idx,landmark_id,gx,gy,gz,ax,ay,az,\
    bgx,bgy,bgz,bax,bay,baz,u_norm,v_norm,key,value";

fn meta(key: &str, value: &str) -> String {
    format!("meta{}{key},{value}\n", ",".repeat(20))
}

/// The camera looks along the body's x axis and sits a decimetre ahead.
fn forward() -> Isometry3<f64> {
    let axes = Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
    let rotation = Rotation3::from_matrix_unchecked(axes).into();
    Isometry3::from_parts(Vector3::new(0.1, 0.0, 0.05).into(), rotation)
}

/// The camera and its place, in the words of such a file.
fn metas() -> String {
    let (place, q) = (forward().translation.vector, forward().rotation);
    let numbers = [
        ("T_ci_tx", place.x),
        ("T_ci_ty", place.y),
        ("T_ci_tz", place.z),
        ("T_ci_qw", q.w),
        ("T_ci_qx", q.i),
        ("T_ci_qy", q.j),
        ("T_ci_qz", q.k),
        ("camera_fx", 460.0),
        ("camera_fy", 458.0),
        ("camera_cx", 367.0),
        ("camera_cy", 248.0),
    ];
    let metas: String = numbers.iter().map(|(key, value)| meta(key, &value.to_string())).collect();
    meta("measurement_space", "normalized") + &meta("eqf.fast_riccati", "1") + &metas
}

/// Angular velocity of a body that turns on the spot, in rad/s.
const TURNING: Vector3<f64> = Vector3::new(0.3, -0.5, 0.8);

/// Two tenths of a second of turning, in readings of 200 Hz, and five pictures of far points.
fn turning() -> String {
    let [x, y, z] = TURNING.into();
    let mut text = format!("{COLUMNS}\n{}", metas());
    for step in 0..=40 {
        let time = format!("1403715273.{:03}", 5 * step);
        let world_from_body = so3::exp(&(0.005 * f64::from(step) * TURNING));
        let camera_from_world =
            (Isometry3::from_parts([0.0; 3].into(), world_from_body.into()) * forward()).inverse();
        for track in (0..9).filter(|_| step % 10 == 0) {
            let direction =
                Vector3::new(f64::from(track % 3) - 1.0, f64::from(track / 3) - 1.0, 3.0);
            let point = se3::transform(&forward(), &(1e3 * direction));
            let seen = se3::transform(&camera_from_world, &point);
            let (u, v) = (seen.x / seen.z, seen.y / seen.z);
            text += &format!("vision_feature,{time},0,1,0,{track}{}{u},{v},,\n", ",".repeat(13));
        }
        text += &format!("imu,{time},0,1,,,{x},{y},{z},0,0,9.81,0,0,0,0,0,0,,,,\n");
    }
    text
}

#[test]
fn readings_and_tracks_of_one_file_are_read() {
    let recording = read_recording(&turning()).unwrap();
    assert_eq!((recording.samples.len(), recording.pictures.len()), (41, 5));
    assert_eq!(recording.samples[1].nanoseconds, 1_403_715_273_005_000_000);
    assert_eq!(recording.samples[1].sample.gyro, TURNING);
    assert_eq!(recording.samples[1].sample.accelerometer, Vector3::new(0.0, 0.0, 9.81));
    assert_eq!(recording.pictures[1].nanoseconds, 1_403_715_273_050_000_000);
    let tracks: Vec<usize> =
        recording.pictures[4].features.iter().map(|feature| feature.track).collect();
    assert_eq!(tracks, [0, 1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!((recording.camera.fx, recording.camera.cy), (460.0, 248.0));
    let windows = turning().replace('\n', "\r\n") + "\r\n\r\n";
    assert_eq!(read_recording(&format!("\u{feff}{windows}")), Ok(recording));
}

#[test]
fn times_in_seconds_keep_their_digits() {
    let time = |text: &str| {
        let text = turning().replace("imu,1403715273.000,", &format!("imu,{text},"));
        read_recording(&text).map(|recording| recording.samples[0].nanoseconds)
    };
    assert_eq!(time("1403715272.2621431"), Ok(1_403_715_272_262_143_100));
    assert_eq!(time("1403715272.262142976"), Ok(1_403_715_272_262_142_976));
    assert_eq!(time("7"), Ok(7_000_000_000));
    for text in ["-1.5", "1e9", "1.", ".5", "", "1.5.5", "nan", "99999999999999999999", "+1"] {
        let error = time(text).expect_err(text);
        assert_eq!(error.column.expect("a column").name, "t_abs", "{error}");
    }
}

#[test]
fn the_keys_of_the_mounting_are_the_pose_of_the_camera_on_the_body() {
    let recording = read_recording(&turning()).unwrap();
    assert_abs_diff_eq!(recording.body_from_camera, forward(), epsilon = 1e-12);
    // The pixels were made from the forward camera, and the gyroscope agrees with no other.
    let left = |pose: &Isometry3<f64>, bias| recording.motion_beyond_turning(pose, bias).unwrap();
    let none = ImuBias::default();
    assert!(left(&recording.body_from_camera, &none) < 1e-5);
    assert!(left(&recording.body_from_camera.inverse(), &none) > 1e-2);
    assert!(left(&Isometry3::identity(), &none) > 1e-2);
    // A bias is subtracted from the readings: this one leaves them nothing.
    let all = ImuBias { gyro: TURNING, ..none };
    assert!(left(&recording.body_from_camera, &all) > 1e-2);
}

#[test]
fn a_fault_in_a_file_of_readings_and_tracks_is_told() {
    let good = turning();
    let told = |text: String| read_recording(&text).unwrap_err().to_string();
    let lines = good.lines().count();
    let without = |part: &str| {
        let kept: Vec<&str> = good.lines().filter(|line| !line.contains(part)).collect();
        told(kept.join("\n"))
    };
    assert_eq!(
        without("T_ci_qw"),
        format!(
            "line {}: the file ends without any line `meta` with the key `T_ci_qw`; it is not \
             complete",
            lines - 1
        )
    );
    assert!(without("imu,").contains("without any line `imu`"));
    assert!(without("vision_feature").ends_with("any line `vision_feature`; it is not complete"));
    assert_eq!(
        told(good.replace("space,normalized", "space,pixel")),
        "line 2, column 22 (value): `pixel` is not `normalized`, the only coordinates that are \
         read; mend the field or remove the line"
    );
    assert!(
        told(good.clone() + &meta("T_ci_tx", "0")).contains("`T_ci_tx` stands here for the second")
    );
    let kinds = format!("line {}, column 1 (row_type): `gps` is not", lines + 1);
    assert!(told(good.clone() + &format!("gps{}\n", ",".repeat(21))).starts_with(&kinds));
    let stretched = good.replace("T_ci_qw,", "T_ci_q0,") + &meta("T_ci_qw", "3");
    assert!(told(stretched).contains("quaternion has norm"));
    let error = read_recording(&good.replace("camera_fx,460", "camera_fx,0")).unwrap_err();
    let fault = PinholeError::FocalLength { name: "fx", value: 0.0 };
    assert_eq!(error.fault, TableFault::Camera(fault));
    let again = good.lines().last().expect("a reading").to_owned();
    assert!(told(good.clone() + &again).contains("is not later than"));
}

// Files of real flights.

#[test]
#[ignore = "needs the EuRoC flights in the folder that VISLAM_DATA names"]
fn both_flights_are_read_whole() {
    for (imu, truth, readings, states) in [
        ("V1_01_imu0.csv", "V1_01_groundtruth_20hz.csv", 29_120, 2_895),
        ("MH_05_imu0.csv", "MH_05_groundtruth.csv", 22_721, 22_212),
    ] {
        assert_eq!(read_imu(&data(imu)).unwrap().len(), readings);
        assert_eq!(read_ground_truth(&data(truth)).unwrap().len(), states);
    }
}

#[test]
#[ignore = "needs the EuRoC flights in the folder that VISLAM_DATA names"]
fn the_camera_of_a_real_recording_sits_where_the_data_set_says() {
    let recording = read_recording(&data("V1_01_30s_imu_and_tracks.csv")).unwrap();
    assert_eq!((recording.samples.len(), recording.pictures.len()), (6_001, 601));
    // `T_BS` in the sensor.yaml of the left camera.
    let axes = Matrix3::new(
        0.0148655429818,
        -0.999880929698,
        0.00414029679422,
        0.999557249008,
        0.0149672133247,
        0.025715529948,
        -0.0257744366974,
        0.00375618835797,
        0.999660727178,
    );
    let place = Vector3::new(-0.0216401454975, -0.064676986768, 0.00981073058949);
    let found = recording.body_from_camera;
    assert_abs_diff_eq!(*found.rotation.to_rotation_matrix().matrix(), axes, epsilon = 1e-9);
    assert_abs_diff_eq!(found.translation.vector, place, epsilon = 1e-12);
    // The readings are those of the data set, their times to a quarter of a microsecond.
    let samples = read_imu(&data("V1_01_imu0.csv")).unwrap();
    for (ours, theirs) in recording.samples.iter().zip(&samples) {
        assert!((ours.nanoseconds - theirs.nanoseconds).abs() < 250);
        assert_eq!(ours.sample, theirs.sample);
    }
}

#[test]
#[ignore = "needs the EuRoC flights in the folder that VISLAM_DATA names"]
fn the_gyroscope_and_the_tracks_of_a_real_recording_agree_on_the_mounting() {
    let recording = read_recording(&data("V1_01_30s_imu_and_tracks.csv")).unwrap();
    let bias = read_ground_truth(&data("V1_01_groundtruth_20hz.csv")).unwrap()[0].bias;
    let pixels = |pose: &Isometry3<f64>, bias: &ImuBias| {
        recording.camera.fx * recording.motion_beyond_turning(pose, bias).unwrap()
    };
    let stated = recording.body_from_camera;
    for wrong in [stated.inverse(), Isometry3::identity()] {
        assert!(3.0 * pixels(&stated, &bias) < pixels(&wrong, &bias));
    }
}

// Problems of bundle adjustment.

/// Two cameras, two points, four observations.
const BAL: &str = "2 2 4\n0 0 1.5 -2.5\n1 0 2 3\n0 1 4e0 5\n1 1 6 7\n\
    0\n0\n0\n0\n0\n0\n500\n0.1\n0.01\n0.1\n0.2\n0.3\n1\n2\n3\n600\n0\n0\n\
    0.5\n-0.5\n-5\n1\n0\n-6\n";

#[test]
fn a_bal_file_is_read_as_it_stands() {
    let problem: TinyBa<BalCamera, 9> = read_bal(BAL).unwrap();
    assert_eq!((problem.cameras.len(), problem.points.len(), problem.factors.len()), (2, 2, 4));
    assert_eq!(problem.factors[2].pixel, Vector2::new(4.0, 5.0));
    assert_eq!((problem.factors[2].keyframe, problem.factors[2].point), (0, 1));
    assert_eq!(problem.cameras[1].focal_length, 600.0);
    assert_eq!(problem.cameras[0].radial, [0.1, 0.01]);
    assert_eq!(problem.points[1], Vector3::new(1.0, 0.0, -6.0));
    // x = y = 0.1 without the sign of y, r² = 0.02.
    let pixel = problem.cameras[0].project(&problem.points[0]).unwrap();
    let scale = 500.0 * (1.0 + 0.02 * 0.1 + 0.02 * 0.02 * 0.01);
    assert_abs_diff_eq!(pixel, scale * Vector2::new(0.1, -0.1), epsilon = 1e-12);
    assert!(read_bal::<6>(&BAL.replace('\n', "\r\n")).is_ok());
}

#[test]
fn a_bal_camera_has_pixels_behind_it_too() {
    let problem: TinyBa<BalCamera, 9> = read_bal(BAL).unwrap();
    assert!(problem.cameras[0].project(&Vector3::new(0.1, 0.1, 5.0)).is_some());
    assert_eq!(problem.cameras[0].project(&Vector3::new(0.1, 0.1, 0.0)), None);
}

#[test]
fn every_malformed_line_of_a_bal_file_is_named() {
    let fault = |text: &str| read_bal::<9>(text).unwrap_err();
    let lines: Vec<&str> = BAL.lines().collect();
    for number in 1..=lines.len() {
        // The file ends early.
        let error = fault(&lines[..number - 1].join("\n"));
        assert!(matches!(error, BalError { line, fault: BalFault::End { .. } } if line == number));
        for bad in ["x", "nan nan nan nan", "1 2", ""] {
            let mut changed = lines.clone();
            changed[number - 1] = bad;
            let error = fault(&changed.join("\n"));
            assert_eq!(error.line, number, "{error}");
            assert!(error.to_string().starts_with(&format!("line {number}: ")));
        }
    }
    assert_eq!(
        fault(&BAL.replace("1 1 6 7", "1 2 6 7")).to_string(),
        "line 5: there is no point 2, the header announces 2; they count from zero"
    );
    assert_eq!(
        fault(&BAL.replace("500", "inf")).to_string(),
        "line 12: `inf` is not a finite number"
    );
    assert_eq!(fault(&BAL.replace("2 2 4", "2 -2 4")).line, 1);
    assert_eq!(fault(&format!("{BAL}7\n")).line, lines.len() + 1);
    assert_eq!(fault("99999999999999999 1 99999999999999999\n").line, 2);
    assert_eq!(fault("").line, 1);
}

mod matches {
    use nalgebra::Vector2;
    use vislam::datasets::matches::read_matches;

    const CAMERAS: &str = "camera 500 500 320 240\ncamera 400 410 0 0\n";

    #[test]
    fn equal_pixels_of_a_picture_are_one_keypoint() {
        let lines =
            "# two matches of one keypoint\n\n0 1.5 2 1 3 4\n  1 5 6 0 1.5 2\n0 1.5 2.5 1 3 4\n";
        let (pictures, matches) = read_matches(&format!("{CAMERAS}{lines}")).unwrap();
        assert_eq!(pictures[1].camera.fy, 410.0);
        assert_eq!(pictures[0].keypoints, [Vector2::new(1.5, 2.0), Vector2::new(1.5, 2.5)]);
        assert_eq!(pictures[1].keypoints, [Vector2::new(3.0, 4.0), Vector2::new(5.0, 6.0)]);
        let ends: Vec<_> = matches.iter().map(|m| (m.pictures, m.keypoints)).collect();
        assert_eq!(ends, [([0, 1], [0, 0]), ([1, 0], [1, 0]), ([0, 1], [1, 0])]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (line, said) in [
            ("0 1 2 1 3", "line 3: 5 numbers where 6 should stand"),
            ("0 1 2 1 3 x", "line 3: `x` is not a finite number"),
            ("0 1 2 1 3 inf", "line 3: `inf` is not a finite number"),
            ("0 1 2 2 3 4", "line 3: there is no picture 2, only 2 cameras"),
            ("0 1 2 -1 3 4", "line 3: there is no picture -1"),
            ("0.5 1 2 1 3 4", "line 3: there is no picture 0.5"),
            ("1 1 2 1 3 4", "line 3: both pixels are of picture 1"),
            ("camera 0 1 0 0", "line 3: "),
            ("camera 1 1 0", "line 3: 3 numbers where 4 should stand"),
            ("0 1 2 1 3 4\ncamera 1 1 0 0", "line 4: a camera stands below a match"),
        ] {
            let error = read_matches(&format!("{CAMERAS}{line}\n")).unwrap_err().to_string();
            assert!(error.starts_with(said), "{line}: {error}");
        }
    }
}
