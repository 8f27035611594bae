//! With which power of what the algorithms' work grows.

use vislam::bundle_adjustment::TinyBa;
use vislam::marginalization::Layout;
use vislam::simulation::Scene;

use super::counted::correction;
use super::elimination::{of_window, products};
use crate::bundle_adjustment::progress::{REACH, unsolved};
use crate::chapter::Chapter;
use crate::inertial::rules::exponent;
use crate::msckf::rotations;

/// The power with which a count grows over some sizes, each twice the one before.
fn power(sizes: [usize; 3], count: impl Fn(usize) -> f64) -> f64 {
    exponent(&sizes.map(|size| size as f64), &sizes.map(count))
}

/// Blocks of a problem that begins at the truth, so that no pixel is dropped: products of two that eliminating the points
/// takes, and those that are kept of the Schur complement.
fn blocks(scene: Scene) -> [f64; 2] {
    let Scene { problem, true_cameras, true_points, .. } = scene;
    let report = unsolved(&TinyBa { cameras: true_cameras, points: true_points, ..problem });
    [report.block_products as f64, report.stored_blocks as f64]
}

pub fn numbers(chapter: &mut Chapter) {
    let mut grows = |name, sizes, count: &dyn Fn(usize) -> f64| {
        chapter.number(name, power(sizes, count), "", 2);
    };
    let ring = |cameras, points| blocks(Scene::ring(cameras, points, 1.0, 1));
    let street = |cameras| blocks(Scene::street(cameras, REACH, 1.0, 1));
    // One camera is held.
    grows("ring_points", [40, 80, 160], &|points| ring(9, points)[0]);
    grows("ring_cameras", [32, 64, 128], &|cameras| ring(cameras + 1, 20)[0]);
    grows("ring_kept", [32, 64, 128], &|cameras| ring(cameras + 1, 20)[1]);
    grows("street_products", [50, 100, 200], &|cameras| street(cameras)[0]);
    grows("street_kept", [50, 100, 200], &|cameras| street(cameras)[1]);
    grows("blanket", [120, 240, 480], &|reach| products(6.0, reach as f64));
    grows("window", [16, 32, 64], &|keyframes| {
        let window = Layout::chain(keyframes, 2 * keyframes, 4);
        of_window(&window, &window.slide(0))
    });
    grows("track", [22, 44, 88], &|sights| rotations::counted(sights) as f64);
    grows("gate", [22, 44, 88], &|sights| correction(2 * sights - 3, 6 * sights, true) as f64);
    grows("rows", [13, 26, 52], &|rows| correction(rows, 81, false) as f64);
    grows("columns", [75, 150, 300], &|columns| correction(20, columns, false) as f64);
    grows("both", [75, 150, 300], &|columns| correction(columns, columns, false) as f64);
}
