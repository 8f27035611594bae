//! How many lines one writes with each library, comments and empty lines not counted.

use crate::chapter::Chapter;

const OURS: &str = include_str!("../../../code/examples/two_keyframes.rs");
const OUR_PIXEL: &str = include_str!("../../../code/src/factors/pixel_by_body.rs");
const OUR_READINGS: &str = include_str!("../../../code/src/preintegration/residual.rs");
const THEIRS: &str = include_str!("../../../factrs/src/graph.rs");
const THEIR_PIXEL: &str = include_str!("../../../factrs/src/reprojection.rs");
const THEIR_READINGS: &str = include_str!("../../../factrs/src/identical.rs");
const GTSAM: &str = include_str!("../../../code/examples/two_keyframes_gtsam.py");

pub fn numbers(chapter: &mut Chapter) {
    let residual =
        ["residual", "stated", "linearized", "linearize", "by_first", "by_second", "by_bias"];
    for (name, text, anchors) in [
        ("lines_graph", OURS, &["graph", "pixels", "priors"][..]),
        (
            "lines_graph_factrs",
            THEIRS,
            &["symbols", "values", "covariance", "preintegrator", "graph", "priors"],
        ),
        ("lines_graph_gtsam", GTSAM, &["start", "pixels", "own"]),
        ("lines_pixel", OUR_PIXEL, &["pixel_by_state", "body_pixel_linearize"]),
        ("lines_pixel_factrs", THEIR_PIXEL, &["reprojection"]),
        ("lines_readings", OUR_READINGS, &residual),
        ("lines_readings_factrs", THEIR_READINGS, &["inertial"]),
    ] {
        let count: usize = anchors.iter().map(|anchor| lines(text, anchor)).sum();
        chapter.number(name, count as f64, "", 0);
    }
}

/// The lines of code of what an anchor encloses.
fn lines(text: &str, anchor: &str) -> usize {
    let is = |line: &str, mark: &str| {
        line.trim_start_matches(['/', '#', ' '])
            .strip_prefix(mark)
            .is_some_and(|rest| rest == anchor)
    };
    let inside = text.lines().skip_while(|line| !is(line, "ANCHOR: ")).skip(1);
    let inside = inside.take_while(|line| !is(line, "ANCHOR_END: "));
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
    inside.filter(is_code).count()
}
