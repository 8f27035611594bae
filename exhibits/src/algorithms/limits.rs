//! Limits that the algorithms set to what comes in.

use vislam::inertial::ImuNoise;
use vislam::msckf::MsckfOptions;
use vislam::preintegration::LONGEST_STEP;
use vislam::reprojection::{Pinhole, Z_MIN};

use crate::chapter::Chapter;

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("z_min_cm", 100.0 * Z_MIN, "cm", 0);
    chapter.number("longest_step", LONGEST_STEP, "s", 1);
    let camera = Pinhole::new(400.0, 400.0, 320.0, 240.0).expect("a camera");
    let MsckfOptions { least_sights, least_parallax, largest_sigma, gate, .. } =
        MsckfOptions::new(camera, 1.0, ImuNoise::euroc());
    chapter.number("least_sights", least_sights as f64, "", 0);
    chapter.number("least_parallax_mrad", 1e3 * least_parallax, "mrad", 0);
    chapter.number("largest_sigma", largest_sigma, "m", 0);
    chapter.number("gate_percent", 100.0 * gate, "%", 0);
}
