//! What is asked in words.

/// A question that wants words: beside the program of an exercise, or of a chapter that has no program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Question {
    /// The slug of the exercise or of the chapter: the heading of the answers, and the name of the rubric.
    pub slug: &'static str,
    /// What its page is called.
    pub title: &'static str,
}
