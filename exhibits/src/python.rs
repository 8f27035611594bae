//! GTSAM and COLMAP beside the book's library: graphs as the scripts of the library's examples read them, and what these
//! print.

use std::fmt::{Display, Write};
use std::path::Path;
use std::process::Command;

use nalgebra::Isometry3;
use vislam::inertial::NavState;

use crate::data::NotMade;

/// A Python that has a package.
pub struct Python(String);

impl Python {
    /// The one with GTSAM, which `VISLAM_GTSAM` names.
    pub fn with_gtsam() -> Result<Self, NotMade> {
        Self::with("gtsam", "VISLAM_GTSAM")
    }

    /// The one that a variable of the environment names.
    pub fn with(package: &str, variable: &str) -> Result<Self, NotMade> {
        let absent = |_| {
            NotMade::DataAbsent(format!(
                "{variable} is not set; let it name a Python that has {package}"
            ))
        };
        std::env::var(variable).map(Self).map_err(absent)
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.0
    }

    /// The numbers that a script prints of a graph, by lines.
    pub fn says(&self, script: &str, graph: &Exported) -> Result<Vec<Vec<f64>>, NotMade> {
        let failed = |error: &dyn Display| NotMade::Failed(format!("{script}: {error}"));
        let file = std::env::temp_dir().join(format!("graph-{}.csv", std::process::id()));
        std::fs::write(&file, &graph.0).map_err(|error| failed(&error))?;
        let text = self.run(script, &[&file]);
        std::fs::remove_file(&file).map_err(|error| failed(&error))?;
        let number = |word: &str| word.parse().map_err(|error| failed(&format!("{word}: {error}")));
        let numbers = |line: &str| line.split_whitespace().map(number).collect();
        text?.lines().map(numbers).collect()
    }

    /// What a script of the library's examples prints of files or a folder.
    pub fn run(&self, script: &str, of: &[&Path]) -> Result<String, NotMade> {
        let Self(python) = self;
        let failed = |error: &dyn Display| NotMade::Failed(format!("{python} {script}: {error}"));
        let path = format!("{}/../code/examples/{script}", env!("CARGO_MANIFEST_DIR"));
        let output = Command::new(python).arg(path).args(of).output();
        let output = output.map_err(|error| failed(&error))?;
        if !output.status.success() {
            return Err(failed(&String::from_utf8_lossy(&output.stderr)));
        }
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    }
}

/// A graph as the scripts read it: lines of a kind and its numbers.
#[derive(Default)]
pub struct Exported(String);

impl Exported {
    pub fn line(&mut self, kind: &str, numbers: &[f64]) {
        let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
        writeln!(self.0, "{kind},{}", numbers.join(",")).expect("a string takes it");
    }
}

/// A quaternion w x y z and a place.
pub fn pose_numbers(pose: &Isometry3<f64>) -> [f64; 7] {
    let (q, t) = (pose.rotation, pose.translation);
    [q.w, q.i, q.j, q.k, t.x, t.y, t.z]
}

/// A pose and a velocity.
pub fn state_numbers(state: &NavState) -> Vec<f64> {
    [&pose_numbers(&state.pose())[..], state.velocity.as_slice()].concat()
}
