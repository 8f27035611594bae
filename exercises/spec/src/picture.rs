//! Expected and obtained side by side, as plain data for a drawing.

/// Points of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Dots {
    /// What they are, for the legend.
    pub name: String,
    /// Where they are, in the units of the axes.
    pub at: Vec<[f64; 2]>,
}

/// A drawing of what was expected and what came back.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// What it shows.
    pub title: String,
    /// What the two axes are, with units.
    pub axes: [String; 2],
    /// What was expected.
    pub expected: Dots,
    /// What came back. A line joins each point to the one expected.
    pub obtained: Dots,
    /// Whether the vertical axis points down, as pixels count.
    pub downward: bool,
}
