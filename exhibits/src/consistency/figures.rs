//! The chapter's figures.

mod certificate;
mod nees;
mod nullity;
mod yaw;

use vislam::consistency::Policy;

use crate::chapter::Chapter;
use crate::figure::{Draw, Drawing, Drawn};

/// Those that are drawn; the two others are in the tables.
const SHOWN: [Policy; 5] =
    [Policy::Standard, Policy::FirstEstimates, Policy::Fej2, Policy::RightInvariant, Policy::Ideal];

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("certificate", certificate::certificate);
    chapter.figure("nullity", nullity::nullity);
    chapter.figure("nees", nees::nees);
    chapter.figure("yaw", yaw::yaw);
}

/// The marks of the policies and their names, over the whole width.
fn keys(drawing: &Drawing) -> Drawn {
    let mut chart = plotters::chart::ChartBuilder::on(drawing)
        .margin(10)
        .build_cartesian_2d(0.0..3.0, 0.0..2.0)?;
    for (series, policy) in SHOWN.iter().enumerate() {
        let (x, y) = ((series % 3) as f64 + 0.08, 1.5 - (series / 3) as f64);
        chart.key(series, policy.name(), (x, y), x + 0.05)?;
    }
    Ok(())
}
