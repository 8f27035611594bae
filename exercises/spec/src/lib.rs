//! What the exercises of the book ask, said once.
//!
//! A module for each exercise declares its functions and data ([`signatures!`]). Below it are its
//! public checks with the instances they run on, the wrong answers it can name, and its hints. The
//! skeletons, the reference answers, the hidden checks and the grader all build on it. It holds
//! no answer: what checks compare with are oracles that find the same numbers another way, by
//! differences or by brute force. The grader compiles answers without the feature `checks`, so
//! that no answer can ask an oracle.

pub mod align_gravity;
pub mod along_or_across;
pub mod camera;
pub mod declaration;
pub mod fill_in;
pub mod first_estimates;
pub mod left_perturbation;
pub mod navigation;
pub mod nees_diagnosis;
pub mod noise_growth;
pub mod null_space;
pub mod outlier_rescue;
pub mod residual_jacobian;
pub mod robust_motion;
pub mod scale_and_gravity;
pub mod scale_null_space;
pub mod square_root_prior;
pub mod stereo_gauge;

#[cfg(feature = "checks")]
mod checking;
#[cfg(feature = "checks")]
pub use checking::{Exercise, Question, answer, check, draw, picture};

/// Every exercise, in the order of the book.
#[cfg(feature = "checks")]
pub const EXERCISES: &[&Exercise] = &[
    &left_perturbation::EXERCISE,
    &along_or_across::EXERCISE,
    &robust_motion::EXERCISE,
    &scale_null_space::EXERCISE,
    &outlier_rescue::EXERCISE,
    &stereo_gauge::EXERCISE,
    &residual_jacobian::EXERCISE,
    &noise_growth::EXERCISE,
    &scale_and_gravity::EXERCISE,
    &align_gravity::EXERCISE,
    &nees_diagnosis::EXERCISE,
    &null_space::EXERCISE,
    &fill_in::EXERCISE,
    &square_root_prior::EXERCISE,
    &first_estimates::EXERCISE,
];

/// What is asked in words by the chapters that have no exercise with a program, in the order of the book.
#[cfg(feature = "checks")]
pub const CHAPTERS: &[Question] = &[
    Question { slug: "bearing", title: "The pinhole camera and depth" },
    Question { slug: "manifold", title: "Rotations, poses and Lie groups" },
    Question { slug: "least_squares", title: "Nonlinear least squares" },
    Question {
        slug: "structure_from_motion",
        title: "Structure from motion: resection and incremental reconstruction",
    },
    Question { slug: "inertial", title: "Inertial sensors and strapdown integration" },
    Question { slug: "real_flights", title: "Preintegration on real flights" },
    Question {
        slug: "smoother",
        title: "Fixed-lag smoothing: filter, smoother and batch on one posterior",
    },
    Question { slug: "odometry", title: "A visual-inertial odometry, whole, on a real flight" },
    Question { slug: "algorithms", title: "The algorithms at a glance" },
    Question {
        slug: "factrs",
        title: "Factor-graph libraries: the same graph in factrs and GTSAM",
    },
    Question { slug: "loop_closure", title: "Loop closure and pose graphs" },
    Question { slug: "systems", title: "Complete systems: VINS-Mono, ORB-SLAM3 and others" },
];

/// The exercise of a name.
#[cfg(feature = "checks")]
pub fn exercise(slug: &str) -> Option<&'static Exercise> {
    EXERCISES.iter().find(|exercise| exercise.slug == slug).copied()
}

/// What is asked in words under a name, by an exercise or by a chapter.
#[cfg(feature = "checks")]
pub fn question(slug: &str) -> Option<Question> {
    let of_chapter = CHAPTERS.iter().find(|question| question.slug == slug).copied();
    of_chapter.or_else(|| exercise(slug).map(Exercise::question))
}
