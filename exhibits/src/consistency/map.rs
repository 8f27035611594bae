//! Where each policy wins and where it loses: twenty flights of two minutes in each of many cells.

use vislam::consistency::Policy;

use super::flown::{of, told};
use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::record::{RecordValue, accepted};

const FLIGHTS: usize = 20;
const MINUTES: &str = "2";
pub const SENSORS: [&str; 2] = ["euroc", "mems"];
pub const PIXELS: [&str; 3] = ["0.5", "1", "2"];
/// Pictures after which a landmark has another name.
pub const LONGEST: [&str; 2] = ["6", "1000000"];
/// Poses in the window.
pub const CLONES: [&str; 2] = ["6", "11"];
/// Landmarks that are kept in the state.
pub const KEPT: [&str; 2] = ["0", "20"];
pub const STARTS: [&str; 2] = ["estimated", "perfect"];

/// One cell of the map.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    pub sensor: &'static str,
    pub pixels: &'static str,
    pub longest: &'static str,
    pub clones: &'static str,
    pub kept: &'static str,
    pub start: &'static str,
}

impl Cell {
    /// All of them.
    pub fn all() -> Vec<Self> {
        let mut cells = Vec::new();
        for sensor in SENSORS {
            for start in STARTS {
                for kept in KEPT {
                    for longest in LONGEST {
                        for clones in CLONES {
                            for pixels in PIXELS {
                                cells.push(Self { sensor, pixels, longest, clones, kept, start });
                            }
                        }
                    }
                }
            }
        }
        cells
    }

    fn name(&self, what: &str) -> String {
        let Self { sensor, pixels, longest, clones, kept, start } = self;
        let tracks = if *longest == LONGEST[0] { "short" } else { "long" };
        format!("{sensor}_{start}_{kept}_{tracks}_{clones}_{pixels}_{what}")
    }

    /// An accepted value.
    pub fn recorded(&self, what: &str) -> f64 {
        accepted("consistency_map", &self.name(what))
    }

    fn values(&self) -> Result<Vec<RecordValue>, NotMade> {
        let Self { sensor, pixels, longest, clones, kept, start } = self;
        let flights = FLIGHTS.to_string();
        let mut arguments = vec![
            "--flights",
            &flights,
            "--minutes",
            MINUTES,
            "--sensor",
            sensor,
            "--pixels",
            pixels,
            "--longest-track",
            longest,
            "--clones",
            clones,
            "--kept",
            kept,
        ];
        arguments.extend((*start == STARTS[1]).then_some("--perfect-start"));
        let times = told(&arguments)?;
        let ideal = |what| of(&times[0], Policy::Ideal.name(), what);
        let mut values = Vec::new();
        for policy in Policy::ALL {
            let of = |what| of(&times[0], policy.name(), what);
            let mut push = |what: &str, value| {
                let name = self.name(&format!("{policy}_{what}"));
                values.push(RecordValue::new(name, value, "", 2, 0.02));
            };
            if [Policy::Standard, Policy::FirstEstimates, Policy::Ideal].contains(&policy) {
                push("yaw", of("nees_yaw")?);
            }
            if policy != Policy::Ideal {
                push("error", of("rmse_cm")? / ideal("rmse_cm")?);
            }
            if policy == Policy::Standard {
                push("sigma", of("sigma_yaw_mrad")? / ideal("sigma_yaw_mrad")?);
            }
        }
        Ok(values)
    }
}

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("flights", format!("seeds 0 to {}", FLIGHTS - 1)),
        ("minutes", MINUTES.to_owned()),
        ("pixels", PIXELS.join(" ")),
        ("longest tracks", LONGEST.join(" ")),
        ("windows", CLONES.join(" ")),
        ("kept", KEPT.join(" ")),
        ("sensors", SENSORS.join(" ")),
        ("starts", STARTS.join(" ")),
    ];
    chapter.record_of_data("consistency_map", &[], inputs, map);
}

fn map() -> Result<Vec<RecordValue>, NotMade> {
    let mut values = Vec::new();
    for cell in Cell::all() {
        values.extend(cell.values()?);
    }
    Ok(values)
}
