//! The batch of a real flight beside GTSAM's, in one run.
//!
//! GTSAM's start and its choice of landmarks come from the ground truth, ours do not. Seconds are those of
//! programs as they are meant to run, the least of three searches of each, in turn.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::real::{EVERY, FILES, FROM, GATES, accepted_value};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::python::Python;
use crate::record::{RecordValue, accepted};
use crate::release;

const SCRIPT: &str = "odometry_gtsam.py";
const ODOMETRY: [&str; 4] = ["-p", "vislam", "--example", "odometry"];
/// Pictures from a state to the next, and how many pixels a landmark may be off, where nothing else is said.
const PLAIN: (usize, f64) = (2, 20.0);
const RUNS: usize = 3;

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let list = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let inputs = vec![
        ("from", list(&FROM.map(f64::from))),
        ("every", list(&EVERY.map(|every| every as f64))),
        ("gates", list(&GATES)),
        ("plain", format!("every {}, gate {} px", PLAIN.0, PLAIN.1)),
        ("seconds", format!("least of {RUNS}, release build, on a quiet machine")),
    ];
    chapter.record_of_data("initial_gtsam", &FILES, inputs, beside);
}

pub fn numbers(chapter: &mut Chapter) {
    // Two records together: how often the spreads of the two batches over gates and rates overlap.
    let of = |name: String| accepted("initial_gtsam", &name);
    let overlap = FROM.iter().filter(|from| {
        let ours = ["low", "high"].map(|end| accepted_value(&format!("batch_{from}_{end}")));
        let theirs = ["low", "high"].map(|end| of(format!("gtsam_{from}_{end}")));
        ours[0] <= theirs[1] && theirs[0] <= ours[1]
    });
    chapter.number("spreads_overlap", overlap.count() as f64, "", 0);
}

/// Where the two files are.
pub fn files() -> Result<[PathBuf; 2], NotMade> {
    for file in &FILES {
        file.read()?;
    }
    let folder = PathBuf::from(std::env::var_os("VISLAM_DATA").unwrap_or_default());
    Ok(FILES.map(|file| folder.join(file.path)))
}

/// What GTSAM's batch came to.
struct Theirs {
    ate4: f64,
    ate6: f64,
    seconds: f64,
    cost: f64,
}

impl Theirs {
    fn of(
        python: &Python,
        files: &[PathBuf; 2],
        (from, every, gate): (u32, usize, f64),
        export: Option<&Path>,
    ) -> Result<Self, NotMade> {
        let numbers = [from.to_string(), every.to_string(), gate.to_string()];
        let mut arguments: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
        arguments.extend(numbers.iter().map(Path::new));
        arguments.extend(export);
        let said = python.run(SCRIPT, &arguments)?;
        let numbers: Option<Vec<f64>> =
            said.split_whitespace().map(|word| word.parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[ate4, ate6, seconds, cost, ..]) => Ok(Self { ate4, ate6, seconds, cost }),
            _ => Err(NotMade::Failed(format!("{SCRIPT} prints {said:?}; numbers are due"))),
        }
    }
}

/// What our program says, by name.
struct Ours(BTreeMap<String, f64>);

impl Ours {
    fn of(files: &[PathBuf; 2], options: &[&str]) -> Result<Self, NotMade> {
        let [tracks, truth] = files.each_ref().map(|file| file.display().to_string());
        let arguments = [&[tracks.as_str(), "--truth", truth.as_str()], options].concat();
        let said = release::said(&ODOMETRY, &arguments)?;
        let words: Vec<&str> = said.split_whitespace().collect();
        let pairs =
            words.windows(2).filter_map(|pair| Some((pair[0].to_owned(), pair[1].parse().ok()?)));
        Ok(Self(pairs.collect()))
    }

    fn value(&self, name: &str) -> Result<f64, NotMade> {
        let absent = || NotMade::Failed(format!("odometry prints no {name}"));
        self.0.get(name).copied().ok_or_else(absent)
    }
}

fn beside() -> Result<Vec<RecordValue>, NotMade> {
    let (python, files) = (Python::with_gtsam()?, files()?);
    let folder = tempfile::tempdir().map_err(|error| NotMade::Failed(error.to_string()))?;
    let mut values = Vec::new();
    let mut most = [0.0_f64; 3];
    for from in FROM {
        let compared = Compared::of(&python, &files, from, folder.path())?;
        let [ratio, difference, seconds] = compared.judged();
        most = [most[0].max(ratio), most[1].max(difference), most[2].max(seconds)];
        values.extend(compared.values(from));
        let spread = spread(&python, &files, from)?;
        for (name, error) in ["low", "high"].into_iter().zip(spread) {
            values.push(RecordValue::new(format!("gtsam_{from}_{name}"), error, "cm", 2, 1e-2));
        }
    }
    values.push(RecordValue::new("ratio_most", most[0], "", 2, 1e-2));
    values.push(RecordValue::new("same_most", most[1], "", 3, 0.5));
    values.push(RecordValue::new("seconds_ratio_most", most[2], "", 2, 1.0));
    Ok(values)
}

/// The two batches from one second of the flight on.
struct Compared {
    theirs: Theirs,
    /// Of the search alone, with GTSAM's start, landmarks and noise.
    same_seconds: f64,
    /// The error from our own start, in centimetres.
    own: f64,
    /// Of everything, from the files to the estimate.
    own_seconds: f64,
    /// The largest difference of a position and the root mean square, in standard deviations.
    differences: [f64; 2],
    /// Our cost over theirs, less one.
    dearer: f64,
}

impl Compared {
    fn of(
        python: &Python,
        files: &[PathBuf; 2],
        from: u32,
        folder: &Path,
    ) -> Result<Self, NotMade> {
        let export = folder.join(format!("from-{from}.json"));
        let (every, begin) = (PLAIN.0.to_string(), from.to_string());
        let start = export.display().to_string();
        let mut theirs = Theirs::of(python, files, (from, PLAIN.0, PLAIN.1), Some(&export))?;
        let mut same_seconds = f64::INFINITY;
        let mut own_seconds = f64::INFINITY;
        // The program itself searches once, GTSAM's script several times.
        let options = ["--start", start.as_str()];
        let mut same = Ours::of(files, &options)?;
        let own_options = ["--from", begin.as_str(), "--every", every.as_str()];
        let mut own = Ours::of(files, &own_options)?;
        for _ in 0..RUNS {
            same = Ours::of(files, &options)?;
            same_seconds = same_seconds.min(same.value("solve_seconds")?);
            own = Ours::of(files, &own_options)?;
            own_seconds = own_seconds.min(own.value("seconds")?);
            let again = Theirs::of(python, files, (from, PLAIN.0, PLAIN.1), None)?;
            theirs.seconds = theirs.seconds.min(again.seconds);
        }
        let own = own.value("ate4_cm")?;
        let differences =
            [same.value("largest_difference_sigma")?, same.value("rms_difference_sigma")?];
        let dearer = same.value("cost")? / theirs.cost - 1.0;
        Ok(Self { theirs, same_seconds, own, own_seconds, differences, dearer })
    }

    /// Our error over theirs, the largest difference in standard deviations, our seconds over theirs.
    fn judged(&self) -> [f64; 3] {
        let seconds = self.same_seconds / self.theirs.seconds;
        [self.own / self.theirs.ate4, self.differences[0], seconds]
    }

    fn values(&self, from: u32) -> Vec<RecordValue> {
        let value = |name: &str, value, unit, decimals, within| {
            RecordValue::new(name.replace("_F", &format!("_{from}")), value, unit, decimals, within)
        };
        let [ratio, largest, seconds] = self.judged();
        vec![
            value("gtsam_F_ate4", self.theirs.ate4, "cm", 2, 1e-2),
            value("gtsam_F_ate6", self.theirs.ate6, "cm", 2, 1e-2),
            value("gtsam_F_seconds", self.theirs.seconds, "s", 2, 3.0),
            value("same_F_seconds", self.same_seconds, "s", 2, 3.0),
            value("same_F_most", largest, "", 3, 0.5),
            value("same_F_rms", self.differences[1], "", 3, 0.5),
            value("same_F_dearer", 1e6 * self.dearer, "millionths", 1, 10.0),
            value("own_F_seconds", self.own_seconds, "s", 2, 3.0),
            value("own_F_ratio", ratio, "", 2, 2e-2),
            value("seconds_F_ratio", seconds, "", 2, 1.0),
        ]
    }
}

/// The least and the greatest error of GTSAM's batch over gates and picture rates.
fn spread(python: &Python, files: &[PathBuf; 2], from: u32) -> Result<[f64; 2], NotMade> {
    let mut ends = [f64::INFINITY, 0.0];
    for every in EVERY {
        for gate in GATES {
            let error = Theirs::of(python, files, (from, every, gate), None)?.ate4;
            eprintln!("GTSAM from {from} s, every {every}, gate {gate} px: {error:.2} cm");
            ends = [error.min(ends[0]), error.max(ends[1])];
        }
    }
    Ok(ends)
}
