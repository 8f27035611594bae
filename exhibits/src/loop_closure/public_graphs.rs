//! Public pose graphs, here and in GTSAM.

use std::collections::BTreeMap;

use crate::chapter::Chapter;
use crate::data::{DataFile, NotMade};
use crate::python::Python;
use crate::record::{RecordValue, accepted, inputs_of};

#[allow(dead_code)]
#[path = "../../../code/examples/pose_graphs.rs"]
mod example;

use example::measured;

const FOLDER: &str = "VISLAM_POSE_GRAPHS";
const SPHERE: DataFile = DataFile {
    path: "sphere2500.txt",
    sha256: "4b9418a300e6ec3ec0a4223e13b0febb068d18f9a008ebb59c1b9f262626e552",
};
const PLANE: DataFile = DataFile {
    path: "w10000.graph",
    sha256: "1e88f220bd580a4c2b9fc065358608a53b26b1c30033405990b4cdc83236fc89",
};

/// What is kept of what both print: its name there and here, unit, digits and what may differ when it is made again.
const KEPT: [(&str, &str, &str, usize, f64); 10] = [
    ("sphere.chained.gauss_newton.cost", "sphere_cost", "", 4, 1e-6),
    ("sphere.chained.gauss_newton.ms", "sphere_gauss_newton", "ms", 0, 3.0),
    ("sphere.chained.levenberg.ms", "sphere_levenberg", "ms", 0, 3.0),
    ("sphere.chained.levenberg.cost", "sphere_levenberg_cost", "", 4, 1e-6),
    ("sphere.chordal.gauss_newton.cost", "sphere_chordal_cost", "", 4, 1e-6),
    ("sphere.chord.ms", "sphere_chord", "ms", 0, 3.0),
    ("sphere_as_read.chordal.levenberg.cost", "sphere_as_read_cost", "", 4, 1e-6),
    ("plane.gauss_newton.cost", "plane_cost", "", 4, 1e-6),
    ("plane.gauss_newton.ms", "plane_gauss_newton", "ms", 0, 3.0),
    ("plane.levenberg.ms", "plane_levenberg", "ms", 0, 3.0),
];

/// What this library alone has.
const OWN: [(&str, &str, &str, usize, f64); 6] = [
    ("certificate.ms", "certificate", "ms", 0, 3.0),
    ("certificate.cost", "certificate_cost", "", 4, 1e-6),
    ("certificate.gap", "certificate_gap", "", 12, 10.0),
    ("isotropic.ms", "isotropic", "ms", 0, 3.0),
    ("sphere.chained.gauss_newton.steps", "sphere_chained_steps", "", 0, 0.0),
    ("sphere.chordal.gauss_newton.steps", "sphere_chordal_steps", "", 0, 0.0),
];

pub fn record(chapter: &mut Chapter) {
    let mut inputs: Vec<_> = inputs_of(&[SPHERE, PLANE]).collect();
    inputs.push(("start", "the vertices of the file, or measurements chained".to_owned()));
    inputs.push(("stop", "a decrease of less than a billionth".to_owned()));
    chapter.record_of_data("pose_graphs", &[], inputs, beside_gtsam);
}

const TURNS: usize = 2;

/// Here and in GTSAM in turn; the least time of each counts.
fn beside_gtsam() -> Result<Vec<RecordValue>, NotMade> {
    let (sphere, plane) = (SPHERE.read_from(FOLDER)?, PLANE.read_from(FOLDER)?);
    let python = Python::with_gtsam()?;
    let absent = |_| NotMade::DataAbsent(format!("{FOLDER} is not set"));
    let folder = std::env::var(FOLDER).map_err(absent)?;
    let (mut ours, mut theirs) = (BTreeMap::new(), BTreeMap::new());
    for _ in 0..TURNS {
        let lines =
            measured(&sphere, &plane).map_err(|error| NotMade::Failed(error.to_string()))?;
        keep_least(&mut ours, lines.0);
        keep_least(&mut theirs, said(&python, &folder)?);
    }
    let value = |from: &BTreeMap<String, f64>, of: &str, name: String, unit, decimals, within| {
        let missing = || NotMade::Failed(format!("nothing is said of {of}"));
        from.get(of)
            .map(|value| RecordValue::new(name, *value, unit, decimals, within))
            .ok_or_else(missing)
    };
    let mut values = Vec::new();
    for (of, name, unit, decimals, within) in KEPT {
        values.push(value(&ours, of, name.to_owned(), unit, decimals, within)?);
        values.push(value(&theirs, of, format!("gtsam_{name}"), unit, decimals, within)?);
    }
    for (of, name, unit, decimals, within) in OWN {
        values.push(value(&ours, of, name.to_owned(), unit, decimals, within)?);
    }
    Ok(values)
}

/// Takes in numbers; of times the least one stays.
fn keep_least(kept: &mut BTreeMap<String, f64>, lines: Vec<(String, f64)>) {
    for (name, value) in lines {
        let before = kept.get(&name).copied().filter(|_| name.ends_with(".ms"));
        kept.insert(name, before.map_or(value, |before| before.min(value)));
    }
}

/// What GTSAM prints of the graphs in a folder: names and numbers.
fn said(python: &Python, folder: &str) -> Result<Vec<(String, f64)>, NotMade> {
    let text = python.run("pose_graphs_gtsam.py", &[folder.as_ref()])?;
    let named = |line: &str| {
        let (name, value) = line.split_once(' ')?;
        Some((name.to_owned(), value.parse().ok()?))
    };
    let unread = |line: &str| NotMade::Failed(format!("pose_graphs_gtsam.py printed `{line}`"));
    text.lines().map(|line| named(line).ok_or_else(|| unread(line))).collect()
}

pub fn numbers(chapter: &mut Chapter) {
    let of = |name: &str| accepted("pose_graphs", name);
    let ratio = |name: &str| of(name) / of(&format!("gtsam_{name}"));
    chapter.number("sphere_time_ratio", ratio("sphere_gauss_newton"), "", 1);
    chapter.number("plane_time_ratio", ratio("plane_gauss_newton"), "", 1);
    chapter.number("chord_time_ratio", ratio("sphere_chord"), "", 1);
    let costs = ["sphere_cost", "sphere_levenberg_cost", "sphere_chordal_cost", "plane_cost"];
    let apart = costs.map(|name| (ratio(name) - 1.0).abs());
    let digits = -apart.iter().fold(1e-15_f64, |most, apart| most.max(*apart)).log10();
    chapter.number("digits_agreed", digits.floor(), "", 0);
}
