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

    /// The cell that is the same, if there is one: a track has no more pixels than the window has poses, and
    /// no landmark is kept whose track is shorter than the window.
    pub fn twin(&self) -> Option<Self> {
        let Self { longest: (_, longest), clones, kept, .. } = *self;
        if kept == 0 && longest > clones && clones <= LONGEST[0].1 {
            Some(Self { longest: LONGEST[0], ..*self })
        } else if kept > 0 && longest < clones {
            Some(Self { kept: 0, ..*self })
        } else {
            None
        }
    }

    /// How long a landmark keeps its name, in a word.
    pub fn track(&self) -> String {
        let (name, pictures) = self.longest;
        if name == LONGEST[0].0 { pictures.to_string() } else { name.to_owned() }
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
            if policy != Policy::Ideal {
                push("error", times[0].by_ideal(policy, "rmse_cm")?);
            }
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
    let mut values = Vec::new();
    for cell in cells {
        values.extend(cell.values()?);
    }
    Ok(values)
}

/// The band of yaw in one cell.
pub fn band() -> NeesBand {
    NeesBand::new(FLIGHTS, 1, OUTSIDE).expect("a probability")
}

/// All of them, each once, in which the filter that is told the truth is consistent.
fn licensed() -> impl Iterator<Item = Cell> {
    let is_licensed =
        |cell: &Cell| cell.twin().is_none() && band().contains(cell.recorded(Policy::Ideal, "yaw"));
    Cell::all().into_iter().filter(is_licensed)
}

/// The largest difference between a cell and its twin.
fn twins_apart() -> f64 {
    let apart = |cell: Cell| {
        let twin = cell.twin()?;
        let by = |(policy, what): (Policy, &str)| {
            (cell.recorded(policy, what) - twin.recorded(policy, what)).abs()
        };
        let errors = Policy::ALL.into_iter().filter(|policy| *policy != Policy::Ideal);
        let all = Policy::ALL.map(|policy| (policy, "yaw")).into_iter();
        Some(all.chain(errors.map(|policy| (policy, "error"))).map(by).fold(0.0, f64::max))
    };
    Cell::all().into_iter().filter_map(apart).fold(0.0, f64::max)
}

pub fn numbers(chapter: &mut Chapter) {
    let distinct = Cell::all().into_iter().filter(|cell| cell.twin().is_none()).count();
    chapter.number("map_cells", Cell::all().len() as f64, "", 0);
    chapter.number("map_distinct", distinct as f64, "", 0);
    chapter.number("map_licensed", licensed().count() as f64, "", 0);
    chapter.number("map_flights", FLIGHTS as f64, "", 0);
    chapter.number("map_twins_apart", twins_apart(), "", 0);
    chapter.number("map_minutes", MINUTES as f64, "", 0);
    chapter.number("map_band_low", band().low, "", 2);
    chapter.number("map_band_high", band().high, "", 2);
    for policy in Policy::ALL.into_iter().filter(|policy| *policy != Policy::Ideal) {
        let mut number = |what: &str, value, decimals| {
            let name: &str = format!("map_{policy}_{what}").leak();
            chapter.number(name, value, "", decimals);
        };
        for sensor in SENSORS {
            let leaves = |cell: &Cell| {
                cell.sensor == sensor && !band().contains(cell.recorded(policy, "yaw"))
            };
            let outside = licensed().filter(leaves).count();
            number(&format!("outside_{sensor}"), outside as f64, 0);
        }
        let errors = || licensed().map(|cell| cell.recorded(policy, "error"));
        let least = errors().fold(f64::INFINITY, f64::min);
        number("least", least, 2);
        number("most", errors().fold(0.0, f64::max), 2);
    }
}
