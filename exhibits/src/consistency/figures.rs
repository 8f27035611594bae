//! The chapter's figures.

mod certificate;
mod map;
mod nees;
mod nullity;
mod yaw;

use vislam::consistency::Policy;

use super::flown::{MINUTES, SENSORS, recorded};
use crate::chapter::Chapter;
use crate::figure::{self, Column, Drawing, Drawn, decimals};

/// Those that are drawn; the two others are in the tables.
const SHOWN: [Policy; 5] =
    [Policy::Standard, Policy::FirstEstimates, Policy::Fej2, Policy::RightInvariant, Policy::Ideal];

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("certificate", certificate::certificate);
    chapter.figure("nullity", nullity::nullity);
    chapter.figure("nees", nees::nees);
    chapter.figure("yaw", yaw::yaw);
    chapter.figure("map", map::estimated);
    chapter.figure("map_perfect", map::perfect);
}

/// Every sensor, policy and time of the flights, and what was recorded of each, under a title.
fn columns(recorded_as: &[(&'static str, &str)]) -> Vec<Column> {
    let each = || {
        SENSORS.into_iter().flat_map(|sensor| {
            Policy::ALL
                .into_iter()
                .flat_map(move |policy| MINUTES.map(move |minutes| (sensor, policy, minutes)))
        })
    };
    let of = |what: &str| {
        decimals(2, each().map(|(sensor, policy, minutes)| recorded(sensor, policy, what, minutes)))
    };
    let mut columns: Vec<Column> = vec![
        ("sensor", each().map(|(sensor, ..)| sensor.to_owned()).collect()),
        ("policy", each().map(|(_, policy, _)| policy.to_string()).collect()),
        ("time (min)", each().map(|(.., minutes)| minutes.to_string()).collect()),
    ];
    columns.extend(recorded_as.iter().map(|(title, what)| (*title, of(what))));
    columns
}

/// The marks of the policies and their names, over the whole width.
fn keys(drawing: &Drawing) -> Drawn {
    figure::keys(drawing, 3, SHOWN.iter().map(|policy| policy.name()))
}
