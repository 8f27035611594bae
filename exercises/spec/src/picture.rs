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

impl Picture {
    /// Whether some point that came back is off by a hundredth of the picture or more.
    pub fn shows_a_difference(&self) -> bool {
        let (expected, obtained) = (&self.expected.at, &self.obtained.at);
        let near = [0, 1].into_iter().all(|axis| {
            let all = expected.iter().chain(obtained).map(|point| point[axis]);
            let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                (low.min(at), high.max(at))
            });
            let pairs = || expected.iter().zip(obtained);
            pairs().all(|(a, b)| (a[axis] - b[axis]).abs() <= 0.01 * (high - low))
        });
        !near || expected.len() != obtained.len()
    }
}
