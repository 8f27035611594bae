//! Where each policy wins and where it loses: twenty flights of two minutes in each of many cells.

use vislam::consistency::Policy;
use vislam::filtering::NeesBand;

use super::told::told;
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::{RecordValue, accepted};

const FLIGHTS: usize = 20;
const MINUTES: usize = 2;
/// The probability that a consistent filter leaves its band of yaw in one cell.
const OUTSIDE: f64 = 0.01;
pub const SENSORS: [&str; 2] = ["euroc", "mems"];
pub const PIXELS: [&str; 3] = ["0.5", "1", "2"];
/// How long a landmark keeps its name, in pictures.
pub const LONGEST: [(&str, usize); 2] = [("short", 6), ("long", 1_000_000)];
/// Poses in the window.
pub const CLONES: [usize; 2] = [6, 11];
/// Landmarks that are kept in the state.
pub const KEPT: [usize; 2] = [0, 20];
pub const STARTS: [(&str, &str); 2] = [("estimated", ""), ("perfect", "--perfect-start")];

/// One cell of the map.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    pub sensor: &'static str,
    pub pixels: &'static str,
    pub longest: (&'static str, usize),
    pub clones: usize,
    pub kept: usize,
    pub start: (&'static str, &'static str),
}

impl Cell {
    /// All of them; pixels go round fastest.
    pub fn all() -> Vec<Self> {
        let mut cells = Vec::new();
        for sensor in SENSORS {
            for start in STARTS {
                for kept in KEPT {
                    for longest in LONGEST {
                        for clones in CLONES {
                            let of = |pixels| Self { sensor, pixels, longest, clones, kept, start };
                            cells.extend(PIXELS.map(of));
                        }
                    }
                }
            }
        }
        cells
    }

    fn name(&self, policy: Policy, what: &str) -> String {
        let Self { sensor, pixels, longest: (tracks, _), clones, kept, start: (start, _) } = self;
        format!("{sensor}_{start}_{kept}_{tracks}_{clones}_{pixels}_{policy}_{what}")
    }

    /// An accepted value.
    pub fn recorded(&self, policy: Policy, what: &str) -> f64 {
        accepted("consistency_map", &self.name(policy, what))
    }

    fn values(&self) -> Result<Vec<RecordValue>, NotMade> {
        let Self { sensor, pixels, longest: (_, longest), clones, kept, start: (_, start) } = self;
        let times = told(&format!(
            "--flights {FLIGHTS} --minutes {MINUTES} --sensor {sensor} --pixels {pixels} \
             --longest-track {longest} --clones {clones} --kept {kept} {start}"
        ))?;
        let mut values = Vec::new();
        for policy in Policy::ALL {
            let mut push = |what: &str, value| {
                let name = self.name(policy, what);
                values.push(RecordValue::new(name, value, "", 2, 0.02));
            };
            push("yaw", times[0].of(policy.name(), "nees_yaw")?);
            push("position", times[0].of(policy.name(), "nees_position")?);
            push("error", times[0].by_ideal(policy, "rmse_cm")?);
            push("surer", times[0].by_ideal(policy, "sigma_yaw_mrad")?);
        }
        Ok(values)
    }
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("flights", format!("seeds 0 to {}", FLIGHTS - 1)),
        ("minutes", MINUTES.to_string()),
        ("pixels", PIXELS.join(" ")),
        ("longest tracks", LONGEST.map(|(_, pictures)| pictures.to_string()).join(" ")),
        ("windows", CLONES.map(|clones| clones.to_string()).join(" ")),
        ("kept", KEPT.map(|kept| kept.to_string()).join(" ")),
        ("sensors", SENSORS.join(" ")),
        ("starts", STARTS.map(|(name, _)| name).join(" ")),
    ];
    chapter.record_of_data("consistency_map", &[], inputs, map);
}

fn map() -> Result<Vec<RecordValue>, NotMade> {
    let cells = Cell::all();
    let mut values = vec![RecordValue::new("cells", cells.len() as f64, "", 0, 0.0)];
    for cell in cells {
        values.extend(cell.values()?);
    }
    Ok(values)
}

/// The band of yaw in one cell.
pub fn band() -> NeesBand {
    NeesBand::new(FLIGHTS, 1, OUTSIDE).expect("a probability")
}
