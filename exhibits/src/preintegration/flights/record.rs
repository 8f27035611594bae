//! The record of two flights.

use nalgebra::Vector3;
use vislam::inertial::GRAVITY;
use vislam::inertial::euroc::{read_ground_truth, read_imu};
use vislam::preintegration::Rule;

use super::budget::{
    Pieces, best_offset, bias_wander, explained_by_the_gyroscope, gravity_found,
    normalized_with_truth, roughness, shares,
};
use super::intervals::{Flight, LENGTHS, normalized, predicted, sizes};
use crate::chapter::Chapter;
use crate::data::{DataFile, NotMade};
use crate::record::RecordValue;

const FILES: [DataFile; 4] = [
    DataFile {
        path: "euroc/V1_01_imu0.csv",
        sha256: "4cef78a5cf7c8ee52016a160de4b50184da2a216d615feb7ebbbb3bc99efa89e",
    },
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

pub fn records(chapter: &mut Chapter) {
    let lengths = LENGTHS.map(|seconds| format!("{seconds}")).join(" ");
    chapter.record_of_data("flights", &FILES, vec![("lengths", lengths)], flights);
}

/// The flight of two files.
fn flight(files: &[DataFile]) -> Result<Flight, NotMade> {
    let [imu, truth] = files else { return Err(NotMade::Failed("a flight has two files".into())) };
    let failed =
        |file: &DataFile, error: String| NotMade::Failed(format!("{}: {error}", file.path));
    let samples = read_imu(&imu.read()?).map_err(|error| failed(imu, error.to_string()))?;
    let truth_text = truth.read()?;
    let truth = read_ground_truth(&truth_text).map_err(|error| failed(truth, error.to_string()))?;
    Ok(Flight { samples, truth })
}

fn flights() -> Result<Vec<RecordValue>, NotMade> {
    let (vicon, leica) = (flight(&FILES[..2])?, flight(&FILES[2..])?);
    for f in [&vicon, &leica] {
        let (g, s) = gravity_found(f);
        eprintln!("gravity {g:?} +- {s:?} size {}", g.norm());
        let pieces = Pieces::new(f, &g);
        let (wa, wv) = (pieces.attitude_wander(), pieces.velocity_wander());
        eprintln!(
            "{wa:?} {wv:?} corr {} step {} pred {}",
            pieces.step_correlation(),
            pieces.attitude_after(0.05),
            pieces.step_predicted()
        );
        for t in [0.05, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0, 60.0] {
            let [v, p] = pieces.without_attitude(t);
            eprintln!(
                "{t}: phi {:.3} model {:.3}  v {:.2} model {:.2} p {:.2}",
                1e3 * pieces.attitude_after(t),
                1e3 * wa.spread(t).sqrt(),
                1e2 * v,
                1e2 * wv.spread(t).sqrt(),
                1e2 * p
            );
        }
        for (i, s) in LENGTHS.iter().enumerate() {
            for rule in [Rule::Left, Rule::Midpoint] {
                let iv = f.intervals(rule, *s, 0.0);
                eprintln!(
                    "{rule:?} {s} n {} {:?} pred {:?} nees {} level {} with truth {}",
                    iv.len(),
                    sizes(iv.iter().map(|i| i.residual(&GRAVITY))),
                    predicted(&iv),
                    normalized(&iv, &GRAVITY),
                    normalized(&iv, &g),
                    normalized_with_truth(&iv, &g, &wa, &wv)
                );
            }
            let sh = &shares(f, &g, &pieces)[i];
            for x in sh {
                eprintln!(
                    "  seen {:.2} grav {:.2} att {:.2} rest {:.2}",
                    100. * x.seen,
                    100. * x.gravity,
                    100. * x.attitude,
                    100. * x.rest
                );
            }
            eprintln!("  offset {:?}", best_offset(f, *s));
        }
        eprintln!(
            "{:?} rough {:?} {:?} bias {}",
            explained_by_the_gyroscope(f),
            roughness(&f.samples, 0, 200),
            roughness(&f.samples, 4000, 20000),
            bias_wander(f)
        );
    }
    let _ = Vector3::<f64>::zeros();
    Ok(vec![])
}
