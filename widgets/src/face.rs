//! What a widget tells of itself before it draws.

use serde::Serialize;

/// What a reader can change and what is shown.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Face {
    /// What to do first, in a sentence.
    pub lead: &'static str,
    /// What can be changed.
    pub controls: &'static [Control],
    /// What can be dragged.
    pub handles: &'static [Handle],
    /// Where lines are drawn.
    pub panels: &'static [Panel],
    /// The numbers that are shown.
    pub readings: &'static [Reading],
    /// What to predict before some of the numbers are shown.
    pub question: Option<Question>,
    /// Words that a scene may write.
    pub words: &'static [&'static str],
}

/// A number that a reader can change. In the address of the page it has its name.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Control {
    /// A word without spaces.
    pub name: &'static str,
    /// What it is called on the page.
    pub label: &'static str,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// The value that a reset gives it.
    pub start: f64,
    /// The least value.
    pub least: f64,
    /// The largest value.
    pub most: f64,
    /// Values are whole multiples of this, counted from the least; of a logarithmic slider, parts of its length.
    pub step: f64,
    /// How it is changed.
    pub kind: Kind,
}

impl Control {
    /// A slider from its start, its ends and its step.
    pub const fn slider(
        name: &'static str,
        label: &'static str,
        unit: &'static str,
        [start, least, most, step]: [f64; 4],
    ) -> Self {
        Self { name, label, unit, start, least, most, step, kind: Kind::Slider }
    }

    /// A list whose first choice stands at the start.
    pub const fn choice(
        name: &'static str,
        label: &'static str,
        choices: &'static [&'static str],
    ) -> Self {
        let most = choices.len() as f64 - 1.0;
        let kind = Kind::Choice(choices);
        Self { kind, ..Self::slider(name, label, "", [0.0, 0.0, most, 1.0]) }
    }

    /// A switch that is on at the start.
    pub const fn switch(name: &'static str, label: &'static str) -> Self {
        Self { kind: Kind::Switch, ..Self::slider(name, label, "", [1.0, 0.0, 1.0, 1.0]) }
    }

    /// A button that counts up to a number.
    pub const fn count(name: &'static str, label: &'static str, most: f64) -> Self {
        Self { kind: Kind::Count, ..Self::slider(name, label, "", [0.0, 0.0, most, 1.0]) }
    }

    /// A button that says when, before some time in seconds; −1 until it is pressed.
    pub const fn moment(name: &'static str, label: &'static str, most: f64) -> Self {
        Self { kind: Kind::Moment, ..Self::slider(name, label, "s", [-1.0, -1.0, most, 0.2]) }
    }
}

/// How a number is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// By a slider.
    Slider,
    /// By a slider on which equal ways are equal factors.
    Logarithmic,
    /// By a slider that can also be played.
    Sweep,
    /// By a switch between zero and one.
    Switch,
    /// By a list of choices, the first of which is zero.
    Choice(&'static [&'static str]),
    /// By a button that adds one, and another that takes it back.
    Count,
    /// By a button that takes over where the sweep stands, and lets it go on; another takes it back.
    Moment,
}

/// Something to be dragged, at the place where the scene puts it.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Handle {
    /// Which panel it is in, counted from zero.
    pub panel: usize,
    /// What it moves.
    pub label: &'static str,
}

/// A rectangle with coordinates.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Panel {
    /// What it shows.
    pub title: &'static str,
    /// To the right.
    pub x: Axis,
    /// Upwards, or downwards if it is turned over.
    pub y: Axis,
    /// Its height over its width.
    pub aspect: f64,
    /// How much of a wide page it takes, in sixths.
    pub span: usize,
    /// Whether a metre is as long in both directions.
    pub equal: bool,
    /// Whether the second coordinate grows downwards, as in images and matrices.
    pub down: bool,
}

/// A coordinate of a panel.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Axis {
    /// With its unit; an axis without a label has no numbers either.
    pub label: &'static str,
    /// What is shown of it.
    pub range: [f64; 2],
}

/// A number that is shown.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Reading {
    /// What it is.
    pub label: &'static str,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// Digits after the decimal point.
    pub digits: usize,
    /// What is shown when there is no such number.
    pub none: &'static str,
    /// Whether it is covered until the question is answered.
    pub veiled: bool,
}

/// A prediction.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Question {
    /// What is asked.
    pub ask: &'static str,
    /// The answers.
    pub choices: &'static [&'static str],
    /// Which of them is right, counted from zero.
    pub right: usize,
    /// The reason, in a sentence.
    pub why: &'static str,
}

/// What is told of each step of what goes on in steps. Two machines compute the same numbers but for their rounding,
/// until rounding changes a decision.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Steps {
    /// What was decided.
    pub decisions: &'static [&'static str],
    /// What came out.
    pub numbers: &'static [&'static str],
    /// The decision that says, by one, that from here on rounding grows from step to step.
    pub lost: Option<&'static str>,
}
