//! What the exercises of the book ask, said once.
//!
//! A module for each exercise declares its functions and data ([`signatures!`]), its public
//! checks with the instances they run on, the wrong answers it can name, and its hints. The
//! skeletons, the reference answers, the hidden checks and the grader all build on it. It holds
//! no answer: what checks compare with are oracles that find the same numbers another way, by
//! differences or by brute force.

pub mod along_or_across;
pub mod answer;
pub mod camera;
pub mod check;
pub mod draw;
pub mod fill_in;
pub mod left_perturbation;
pub mod navigation;
pub mod noise_growth;
pub mod null_space;
pub mod outlier_rescue;
pub mod picture;
pub mod residual_jacobian;
pub mod scale_and_gravity;
pub mod scale_null_space;
pub mod stereo_gauge;

use check::{Check, Misconception};

/// An exercise.
pub struct Exercise {
    /// The word that leads to everything of it.
    pub slug: &'static str,
    /// What its page is called.
    pub title: &'static str,
    /// The chapter it belongs to.
    pub chapter: &'static str,
    /// Names of the functions to write.
    pub functions: &'static [&'static str],
    /// The wrong answers it names.
    pub misconceptions: &'static [&'static Misconception],
    /// Its types of arguments and outputs that an answer may import. Everything else of this crate
    /// belongs to the checks, which know what they expect.
    pub types: &'static [&'static str],
    /// Items of the library that would be the answer, and may not be called.
    pub forbidden: &'static [&'static str],
    /// Hints as Markdown, from a question to a nudge to the idea.
    pub hints: &'static str,
    /// The checks that students have.
    pub checks: fn() -> Vec<Check>,
}

/// Every exercise, in the order of the book.
pub const EXERCISES: &[&Exercise] = &[
    &left_perturbation::EXERCISE,
    &along_or_across::EXERCISE,
    &scale_null_space::EXERCISE,
    &outlier_rescue::EXERCISE,
    &stereo_gauge::EXERCISE,
    &noise_growth::EXERCISE,
    &residual_jacobian::EXERCISE,
    &scale_and_gravity::EXERCISE,
    &null_space::EXERCISE,
    &fill_in::EXERCISE,
];

/// The exercise of a name.
pub fn exercise(slug: &str) -> Option<&'static Exercise> {
    EXERCISES.iter().find(|exercise| exercise.slug == slug).copied()
}

impl Exercise {
    /// The hints one by one. In the file each stands between `<!-- ANCHOR: N -->` and
    /// `<!-- ANCHOR_END: N -->`, so that its page can show them too.
    pub fn hint_ladder(&self) -> Vec<String> {
        let mut hints = Vec::new();
        let mut lines: Option<Vec<&str>> = None;
        for line in self.hints.lines() {
            if line.starts_with("<!-- ANCHOR_END") {
                hints.extend(lines.take().map(|lines| lines.join("\n")));
            } else if line.starts_with("<!-- ANCHOR") {
                lines = Some(Vec::new());
            } else if let Some(lines) = &mut lines {
                lines.push(line);
            }
        }
        hints
    }
}
