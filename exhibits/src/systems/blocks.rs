//! Two systems block by block. What a block leads to stands here and nowhere else.

use crate::chapter::Chapter;
use crate::diagram::{Block, Row, diagram};

/// Where the chapter says what it leaves out.
const LEFT_OUT: &str = "sec:left-out";

const fn built(lines: &'static [&'static str], to: &'static str) -> Block {
    Block { lines, to, built: true }
}

const fn left_out(lines: &'static [&'static str]) -> Block {
    Block { lines, to: LEFT_OUT, built: false }
}

pub fn figures(chapter: &mut Chapter) {
    chapter.figure("vins_mono", || diagram(VINS_MONO));
    chapter.figure("orb_slam3", || diagram(ORB_SLAM3));
}

const VINS_MONO: &[Row] = &[
    Row {
        name: "front end",
        blocks: &[
            left_out(&["Corners, followed", "from picture to", "picture (KLT)"]),
            built(
                &["Readings summed", "between pictures", "(midpoint rule)"],
                "sec:preintegration",
            ),
        ],
    },
    Row {
        name: "initialization",
        blocks: &[
            built(&["Poses and points", "from pictures", "alone, no scale"], "sec:init-shape"),
            built(
                &["Gyroscope bias,", "velocities, gravity,", "scale, in turn"],
                "sec:init-linear",
            ),
        ],
    },
    Row {
        name: "window",
        blocks: &[built(
            &[
                "States at 11 pictures, one inverse depth for each",
                "landmark, all in one least-squares problem",
            ],
            "sec:window",
        )],
    },
    Row {
        name: "back end",
        blocks: &[
            built(
                &["Cauchy kernel on", "pixels, landmarks", "eliminated first"],
                "sec:bundle_adjustment",
            ),
            built(&["One picture leaves:", "oldest or newest", "but one"], "sec:marginalization"),
        ],
    },
    Row {
        name: "failure detection",
        blocks: &[left_out(&["Back to initialization when a bias or a jump is too large"])],
    },
    Row {
        name: "loop closure",
        blocks: &[
            left_out(&["Place recognition", "by a bag of words,", "on keyframes that left"]),
            left_out(&["Pixels of the old", "picture, back into", "the window"]),
        ],
    },
    Row {
        name: "pose graph",
        blocks: &[built(
            &["Keyframes moved in position and yaw, the four", "directions that no sensor sees"],
            "sec:four-degrees",
        )],
    },
];

const ORB_SLAM3: &[Row] = &[
    Row {
        name: "front end",
        blocks: &[
            left_out(&["ORB corners with", "descriptors,", "matched to the map"]),
            built(&["Readings summed", "between frames", "and keyframes"], "sec:preintegration"),
        ],
    },
    Row {
        name: "tracking",
        blocks: &[built(
            &[
                "State of one frame from pixels of known points",
                "and from the readings since the last one",
            ],
            "sec:reprojection",
        )],
    },
    Row {
        name: "initialization",
        blocks: &[
            built(&["Two pictures:", "homography or", "fundamental matrix"], "sec:model-selection"),
            built(&["Scale, gravity,", "biases, velocities:", "one estimate"], "sec:init-map"),
        ],
    },
    Row {
        name: "map",
        blocks: &[built(
            &["Keyframes and points, joined where keyframes", "see the same points"],
            "sec:bundle_adjustment",
        )],
    },
    Row {
        name: "back end",
        blocks: &[
            built(&["Bundle adjustment of", "10 or 25 keyframes", "with readings"], "sec:window"),
            built(
                &["The others held", "fixed: conditioned,", "not marginalized"],
                "sec:marginalization",
            ),
        ],
    },
    Row {
        name: "loop closure",
        blocks: &[
            left_out(&["Place recognition", "by a bag of words,", "verified"]),
            left_out(&["Alignment of two", "maps: similarity or", "rigid motion"]),
        ],
    },
    Row {
        name: "pose graph",
        blocks: &[
            built(
                &["Keyframes moved in", "position and yaw,", "and the map with them"],
                "sec:four-degrees",
            ),
            built(
                &["Bundle adjustment of", "all, if the map is", "not too large"],
                "sec:bundle_adjustment",
            ),
        ],
    },
];
