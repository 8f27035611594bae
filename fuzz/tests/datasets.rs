//! The readers of recorded data.

use fuzz::Trial;
use nalgebra::Isometry3;
use vislam::datasets::bal::read_bal;
use vislam::datasets::calibration::{read_calibration, read_right_camera};
use vislam::datasets::euroc::{read_ground_truth, read_imu, truth_at};
use vislam::datasets::matches::read_matches;
use vislam::datasets::pose_graph::{read_planar_graph, read_pose_graph};
use vislam::datasets::recording::read_recording;
use vislam::datasets::tracks::read_tracks;
use vislam::inertial::{ImuBias, between};

/// The text in bytes of which not all need be.
fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What a reader says of a text.
fn said<T, E: ToString>(read: &Result<T, E>) -> String {
    read.as_ref().err().map_or_else(|| "read".to_owned(), ToString::to_string)
}

#[test]
fn bal() {
    let seed = "2 2 4\n0 0 1.5 -2.5\n1 0 2 3\n0 1 4e0 5\n1 1 6 7\n\
        0\n0\n0\n0\n0\n0\n500\n0.1\n0.01\n0.1\n0.2\n0.3\n1\n2\n3\n600\n0\n0\n\
        0.5\n-0.5\n-5\n1\n0\n-6\n";
    Trial::of("bal", [seed, "1 1 0\n0\n0\n0\n0\n0\n0\n1\n0\n0\n1\n1\n1\n\n", "0 0 0\n"])
        .words(&["2 2 4\n", "0 0 1 1\n", "999999999999 1 1\n", "1 1 99999999999\n", "0\n"])
        .run(|bytes| {
            let text = text(bytes);
            said(&read_bal::<9>(&text)) + &said(&read_bal::<6>(&text))
        });
}

#[test]
fn euroc() {
    let imu = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
        a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\r\n\
        1403715273262142976,1,2,3,4,5,6e0\r\n\r\n1403715273267142912, -1, 0.5, 0, 0, 0, 9.81\r\n";
    let truth = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], \
        q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], \
        b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], \
        b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n\
        1403636580838555648,1,2,3,0.7071,0,0,0.7071,4,5,6,0.1,0.2,0.3,0.4,0.5,0.6\n\
        1403636580888555648,1,2,3,1,0,0,0,4,5,6,0.1,0.2,0.3,0.4,0.5,0.6\n";
    let short = "#time(ns),px,py,pz,qw,qx,qy,qz,vx,vy,vz,bwx,bwy,bwz,bax,bay,baz\n\
        100,1,2,3,0,0,1,0,4,5,6,0,0,0,0,0,0\n60000100,1,2,3,0,0,-1,0,4,5,6,0,0,0,0,0,0\n";
    Trial::of("euroc", [imu, truth, short])
        .words(&[",", "\n", "0,0,0,0,0,0,0\n", "-9223372036854775808,0,0,0,0,0,0\n", "1e-200"])
        .run(|bytes| {
            let text = text(bytes);
            let (samples, truth) = (read_imu(&text), read_ground_truth(&text));
            if let Ok(samples) = &samples {
                let (first, last) =
                    (samples[0].nanoseconds, samples[samples.len() - 1].nanoseconds);
                let (middle, all) = (first / 2 + last / 2, between(samples, first, last));
                return said(&all) + &said(&between(samples, first, middle));
            }
            if let Ok(truth) = &truth {
                let (first, last) = (truth[0].nanoseconds, truth[truth.len() - 1].nanoseconds);
                let at = [first, last, first / 2 + last / 2, i64::MIN, i64::MAX];
                return format!("{:?}", at.map(|at| truth_at(truth, at).is_some()));
            }
            said(&samples) + &said(&truth)
        });
}

#[test]
fn tracks() {
    let seeds = [
        "#timestamp [ns],track,u [px],v [px]\n5,9,1,2\n5,4,-3,0.5\n7,9,1.5,2\n",
        "timestamp,track,u,v,u_right,v_right\r\n5,1,1,2,0,2\r\n5,2,3,4,,\r\n",
    ];
    Trial::of("tracks", seeds)
        .words(&[",", "\n", "5,1,1,2\n", "7,0,0,0\n", "timestamp", "[", "("])
        .run(|bytes| said(&read_tracks(&text(bytes))));
}

#[test]
fn matches() {
    let seed = "# two\ncamera 500 500 320 240\ncamera 400 410 0 0\n\n0 1 2 1 3 4\n0 1 2 1 5 6\n";
    Trial::of("matches", [seed])
        .words(&["camera", "camera 1 1 0 0\n", "0 1 2 1 3 4\n", "#", " ", "\n"])
        .run(|bytes| said(&read_matches(&text(bytes))));
}

#[test]
fn recording() {
    let meta = |key: &str, value: &str| format!("meta{}{key},{value}\n", ",".repeat(20));
    let mut seed = "row_type,t_abs,t_rel,seq,frame_idx,landmark_id,gx,gy,gz,ax,ay,az,bgx,bgy,bgz,\
        bax,bay,baz,u_norm,v_norm,key,value\n"
        .to_owned();
    seed += &meta("measurement_space", "normalized");
    for key in ["tx", "ty", "tz", "qx", "qy", "qz", "qw"] {
        seed += &meta(&format!("T_ci_{key}"), if key == "qw" { "1" } else { "0" });
    }
    for key in ["fx", "fy", "cx", "cy"] {
        seed += &meta(&format!("camera_{key}"), "400");
    }
    for step in 0..4 {
        let time = format!("1403715273.{:03}", 50 * step);
        seed += &format!("vision_feature,{time},0,1,0,7{}0.1,0.{step},,\n", ",".repeat(13));
        seed += &format!("imu,{time},0,1,,,0.1,0.2,0.3,0,0,9.81,0,0,0,0,0,0,,,,\n");
    }
    Trial::of("recording", [seed])
        .words(&[",", "\n", "meta", "imu", "vision_feature", "9223372036.854775807", "0.", ".5"])
        .run(|bytes| {
            let recording = read_recording(&text(bytes));
            if let Ok(recording) = &recording {
                let moved = |from: &Isometry3<f64>| {
                    recording.motion_beyond_turning(from, &ImuBias::default())
                };
                let moved = [moved(&recording.body_from_camera), moved(&Isometry3::identity())];
                return format!("{:?}", moved.map(|moved| moved.is_some()));
            }
            said(&recording)
        });
}

#[test]
fn calibration() {
    let seed = "\u{feff}# a camera on a board\n[camera]\nfx = 460   # pixels\nfy = 458.5\ncx = 367\n\
        cy = 248\nwidth = 752.0\npixel_sigma = 0.5\ntime_offset = -2e-3\n\
        time_offset_sigma = 5e-3\n\n[imu]\r\ngyro = 1e-3\n\
        accelerometer = 2e-2\ngyro_walk = 3e-5\naccelerometer_walk = 0\ngravity = 9.8\n\n[stereo]\n\
        baseline = 0.11\n[extrinsics]\ntranslation_sigma = 0.02\nrotation_sigma = 1e-2\n\
        body_from_camera = [\n    [0, 0, 1, 0.1], # ahead\n    \
        [-1, 0, 0, 0.0],\n    [0, -1, 0, 0.05], [0, 0, 0, 1],\n]\n";
    Trial::of("calibration", [seed])
        .words(&["[", "]", "=", "[camera]\n", "x = [\n", "#", "\n", "[1, 0, 0, 0],"])
        .run(|bytes| {
            let text = text(bytes);
            said(&read_calibration(&text)) + &said(&read_right_camera(&text))
        });
}

#[test]
fn pose_graphs() {
    let seeds = [
        "VERTEX_SE3:QUAT 3 0.1 -0.2 0.3 0 0 0 1\nVERTEX_SE3:QUAT 5 1.2 0.1 -0.1 0 0 0 1\n\
            FIX 3\nEDGE_SE3:QUAT 3 5 1 0.2 -0.3 0 0 0 1 \
            10 1 2 3 4 5 20 1 2 3 4 30 1 2 3 40 1 2 50 1 60\n",
        "VERTEX_SE2 0 0.1 -0.2 0.3\nVERTEX2 1 1.2 0.4 0.7\nEDGE_SE2 0 1 1 0.2 0.6 10 1 2 20 3 30\n\
            EDGE2 1 0 1 0.2 0.6 10 1 20 30 2 3\n",
        "# a walk\r\nFIX 0\r\n\r\nEDGE2 0 7 1 0 0\r\nEQUIV 0 7\r\nEDGE2 7 8 1 0 0.5\r\n",
        "VERTEX3 0 0.1 -0.2 0.3 0 0 0\nVERTEX3 1 1.2 0.1 -0.1 0.1 0.2 -0.7\n\
            EDGE3 0 1 1 0.2 -0.3 0.3 -0.4 0.5\nEDGE3 1 0 1 0.2 -0.3 0.3 -0.4 0.5\n",
    ];
    Trial::of("pose_graphs", seeds)
        .words(&["EDGE2 0 1 1 0 0\n", "EDGE3 0 1 1 0 0 0 0 0\n", "PARAMS_X ", "VERTEX2", " ", "\n"])
        .run(|bytes| {
            let text = text(bytes);
            said(&read_pose_graph(&text)) + &said(&read_planar_graph(&text))
        });
}
