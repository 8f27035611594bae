//! Five points and motions among wrong matches, here and in PoseLib.

use std::collections::BTreeMap;

use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::python::Python;
use crate::record::{RecordValue, accepted};
use crate::release;

const RECORD: &str = "robust_poses";
const SCENES: usize = 1000;
const VARIABLE: &str = "VISLAM_POSELIB";

/// What is kept: name, unit, digits and what may differ when it is made again.
const KEPT: [(&str, &str, usize, f64); 16] = [
    ("scenes", "", 0, 0.0),
    ("oracle.median", "°", 3, 0.01),
    ("oracle.most", "°", 3, 0.01),
    ("ours.median", "°", 3, 0.02),
    ("ours.most", "°", 3, 0.02),
    ("ours.ms", "ms", 1, 3.0),
    ("ours.draws", "", 0, 0.05),
    ("ours.all_us", "µs", 1, 3.0),
    ("ours.front_us", "µs", 1, 3.0),
    ("poselib.median", "°", 3, 0.02),
    ("poselib.most", "°", 3, 0.02),
    ("poselib.ms", "ms", 1, 3.0),
    ("poselib.draws", "", 0, 0.05),
    ("poselib.all_us", "µs", 1, 3.0),
    ("poselib.front_us", "µs", 1, 3.0),
    ("poselib.call_us", "µs", 1, 3.0),
];

pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("scenes", SCENES.to_string()),
        ("matches", "200 right with a pixel of noise, 300 wrong".to_owned()),
        ("PoseLib", "2.0.5, the same gate, confidence 0.9999".to_owned()),
    ];
    chapter.record_of_data(RECORD, &[], inputs, beside_poselib);
}

fn beside_poselib() -> Result<Vec<RecordValue>, NotMade> {
    let python = Python::with("poselib", VARIABLE)?;
    let scenes = SCENES.to_string();
    let of_example = ["--package", "vislam", "--example", "robust_two_view"];
    let said = release::said(&of_example, &[&scenes, python.name()])?;
    let line = |line: &str| {
        let (name, value) = line.split_once(' ')?;
        Some((name.to_owned(), value.parse().ok()?))
    };
    let lines: BTreeMap<String, f64> = said.lines().filter_map(line).collect();
    let kept = |(name, unit, decimals, within): (&'static str, _, _, _)| {
        let value =
            lines.get(name).ok_or_else(|| NotMade::Failed(format!("nothing is said of {name}")))?;
        Ok(RecordValue::new(name.replace('.', "_"), *value, unit, decimals, within))
    };
    KEPT.into_iter().map(kept).collect()
}

pub fn numbers(chapter: &mut Chapter) {
    let of = |name: &str| accepted(RECORD, name);
    let ratio = |a: &str, b: &str| of(a) / of(b);
    chapter.number("ours_median_ratio", ratio("ours_median", "oracle_median"), "", 2);
    chapter.number("ours_most_ratio", ratio("ours_most", "oracle_most"), "", 2);
    chapter.number("poselib_median_ratio", ratio("poselib_median", "oracle_median"), "", 2);
    chapter.number("poselib_most_ratio", ratio("poselib_most", "oracle_most"), "", 2);
}
