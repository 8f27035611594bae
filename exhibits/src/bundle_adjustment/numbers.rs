//! The numbers of the chapter's first half.

use vislam::bundle_adjustment::PosedPinhole;
use vislam::least_squares::Options;
use vislam::simulation::Scene;

use super::progress::{self, REACH};
use super::rails;
use crate::chapter::Chapter;

pub fn numbers(chapter: &mut Chapter) {
    counts(chapter);
    on_rails(chapter);
    streets(chapter);
    signs(chapter);
    solves(chapter);
}

/// Multiplications of the Cholesky factorization of a full matrix of this size, about.
fn factorization(size: f64) -> f64 {
    size.powi(3) / 6.0
}

fn counts(chapter: &mut Chapter) {
    let ring = progress::ring();
    let report = progress::unsolved(&ring);
    let (cameras, points) = (ring.cameras.len(), ring.points.len());
    chapter.number("ring_cameras", cameras as f64, "", 0);
    chapter.number("ring_moving", cameras as f64 - 1.0, "", 0);
    chapter.number("ring_points", points as f64, "", 0);
    chapter.number("ring_observations", ring.factors.len() as f64, "", 0);
    chapter.number("ring_equations", 2.0 * ring.factors.len() as f64, "", 0);
    chapter.number("full_dim", report.full_dim as f64, "", 0);
    chapter.number("reduced_dim", report.reduced_dim as f64, "", 0);
    let mut unpinned = ring.clone();
    unpinned.fixed.fill(false);
    chapter.number("unpinned_dim", progress::unsolved(&unpinned).full_dim as f64, "", 0);

    let products = report.block_products as f64;
    chapter.number("products_each", products / points as f64, "", 0);
    chapter.number("ring_products", products, "", 0);
    // A product of a 6×3 and a 3×6 matrix.
    let eliminating = 6.0 * 3.0 * 6.0 * products;
    let reduced = factorization(report.reduced_dim as f64);
    chapter.number("full_multiplications", factorization(report.full_dim as f64), "", 0);
    chapter.number("eliminating_multiplications", eliminating, "", 0);
    chapter.number("reduced_multiplications", reduced, "", 0);
    let more = 100.0;
    let many = report.full_dim as f64 + 3.0 * points as f64 * (more - 1.0);
    let ratio = factorization(many) / (more * eliminating + reduced);
    chapter.number("more_points", more * points as f64, "", 0);
    // The counts are rough, and so is what they say.
    chapter.number("ratio_more_points", 1e3 * (1e-3 * ratio).round(), "", 0);
}

fn on_rails(chapter: &mut Chapter) {
    let (camera, point) = rails::curvatures();
    let (gradient, by_point) = rails::gradient();
    let (s, rhs) = rails::reduced();
    let step = rails::solver().step(0.0).expect("nothing is free");
    chapter.number("rail_depth", rails::POINT.z, "m", 0);
    chapter.number("rail_arm", rails::PLACES[1].x, "m", 0);
    chapter.number("rail_off_upper", rails::OFF[2], "px", 0);
    chapter.number("rail_off_lower", rails::OFF[3], "px", 0);
    chapter.number("rail_px_per_metre", camera.sqrt(), "px/m", 0);
    chapter.number("rail_camera", camera, "", 0);
    chapter.number("rail_point", point, "", 0);
    chapter.number("rail_gradient_upper", gradient[0], "", 0);
    chapter.number("rail_gradient_lower", gradient[1], "", 0);
    chapter.number("rail_gradient_point", by_point, "", 0);
    chapter.number("rail_through", camera * camera / point, "", 0);
    chapter.number("rail_s_same", s[(0, 0)], "", 0);
    chapter.number("rail_s_other", s[(0, 1)], "", 0);
    chapter.number("rail_point_alone", -by_point / point, "m", 2);
    chapter.number("rail_rhs_upper", rhs[0], "", 0);
    chapter.number("rail_rhs_lower", rhs[1], "", 0);
    chapter.number("rail_step_upper", step.cameras[2][0], "m", 2);
    chapter.number("rail_step_lower", step.cameras[3][0], "m", 2);
    let coupled = camera * (step.cameras[2][0] + step.cameras[3][0]);
    chapter.number("rail_coupled", coupled, "", 0);
    chapter.number("rail_step_upper_cm", 100.0 * step.cameras[2][0], "cm", 0);
    chapter.number("rail_step_lower_cm", 100.0 * step.cameras[3][0], "cm", 0);
    chapter.number("rail_cost", rails::solver().cost(), "", 0);
}

fn streets(chapter: &mut Chapter) {
    let short = progress::short_street();
    chapter.number("street_cameras", short.cameras.len() as f64, "", 0);
    chapter.number("street_points", short.points.len() as f64, "", 0);
    chapter.number("street_reach", REACH, "m", 1);
    let long = progress::long_street();
    let report = progress::unsolved(&long);
    let moving = long.cameras.len() as f64 - 1.0;
    let points = (report.full_dim - report.reduced_dim) as f64 / 3.0;
    let all_pairs = moving * (moving + 1.0) / 2.0;
    chapter.number("long_cameras", long.cameras.len() as f64, "", 0);
    chapter.number("long_products", report.block_products as f64, "", 0);
    chapter.number("long_visits", points * all_pairs, "", 0);
    chapter.number("long_waste", points * all_pairs / report.block_products as f64, "", 0);
    chapter.number("long_all_blocks", all_pairs, "", 0);
    chapter.number("long_blocks", report.stored_blocks as f64, "", 0);
    let shuffled = progress::shuffled(&long);
    chapter.number("shuffled_blocks", progress::blocks_as_numbered(&shuffled) as f64, "", 0);
    let renumbered = progress::unsolved(&shuffled).stored_blocks;
    chapter.number("renumbered_blocks", renumbered as f64, "", 0);
    let closed = progress::unsolved(&progress::closed(long));
    let more = closed.stored_blocks - report.stored_blocks;
    chapter.number("closing_blocks", more as f64, "", 0);
    let more = closed.block_products - report.block_products;
    chapter.number("closing_products", more as f64, "", 0);
}

fn signs(chapter: &mut Chapter) {
    let [before, after, opposite] = progress::step_and_its_opposite();
    chapter.number("sign_before", before, "", 0);
    chapter.number("sign_after", after, "", 0);
    chapter.number("sign_opposite", opposite, "", 0);
}

fn solves(chapter: &mut Chapter) {
    let ring = progress::solved_ring();
    chapter.number("ring_first_cost", ring.iterations[0].cost, "", 0);
    chapter.number("ring_cost", ring.cost, "", 1);
    // Scale is free, so one unknown less is used up.
    let equations = 2.0 * progress::ring().factors.len() as f64;
    chapter.number("ring_cost_expected", 0.5 * (equations - ring.full_dim as f64 + 1.0), "", 1);
    let usual = progress::ring().solve(&Options::large_problem()).expect("a problem");
    chapter.number("ring_iterations", usual.iterations.len() as f64, "", 0);
    let street = progress::solved_street();
    chapter.number("street_cost", street.cost, "", 0);
    chapter.number("street_iterations", street.iterations.len() as f64, "", 0);
    chapter.number("street_all_cameras", progress::street().cameras.len() as f64, "", 0);
    chapter.number("street_third_cost", street.iterations[2].cost, "", 0);
    chapter.number("damping_exponent", progress::DAMPING.log10(), "", 0);
    let (light, exponent) = (1e-9, -9.0);
    let lightly = progress::solved_from(progress::street(), light);
    chapter.number("light_exponent", exponent, "", 0);
    chapter.number("light_iterations", lightly.iterations.len() as f64, "", 0);
    chapter.number("light_cost", lightly.cost, "", 0);
    bend(chapter, light);
}

/// How cameras of the street are off, across it, when two iterations are done and when all are, and what a light
/// damping changes.
fn bend(chapter: &mut Chapter, light: f64) {
    let truth = Scene::street(30, REACH, progress::NOISE, 1).true_cameras;
    let [early, late] = [2, 60].map(|most| progress::street_cameras(most, progress::DAMPING));
    let across = |one: &[PosedPinhole], other: &[PosedPinhole], camera: usize| {
        (one[camera].centre() - other[camera].centre()).y.abs()
    };
    let last = truth.len() - 1;
    chapter.number("bend_half_m", across(&early, &late, truth.len() / 2), "m", 2);
    chapter.number("bend_end_m", across(&early, &late, last), "m", 2);
    chapter.number("bend_plateau_m", across(&early, &truth, last), "m", 2);
    chapter.number("bend_from_truth_m", across(&late, &truth, last), "m", 2);
    let lightly = progress::street_cameras(60, light);
    let apart = late.iter().zip(&lightly).map(|(a, b)| (a.centre() - b.centre()).norm());
    chapter.number("bend_by_damping_mm", 1e3 * apart.fold(0.0, f64::max), "mm", 0);
}
