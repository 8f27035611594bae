//! The chapter's figures.

mod certificate;
mod nees;
mod yaw;

use vislam::consistency::Policy;

use crate::chapter::Chapter;

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("certificate", certificate::certificate);
    chapter.figure("nees", nees::nees);
    chapter.figure("yaw", yaw::yaw);
}

/// The name of a policy where there is little room.
fn short(policy: Policy) -> &'static str {
    match policy {
        Policy::Standard => "standard",
        Policy::FirstEstimates => "first",
        Policy::Fej2 => "FEJ2",
        Policy::ObservabilityConstrained => "constr.",
        Policy::RightInvariant => "invariant",
        Policy::Robocentric => "roboc.",
        Policy::Ideal => "ideal",
    }
}
