//! Expected and obtained side by side, as plain data for a drawing.

/// Points of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Dots {
    /// What they are, for the legend.
    pub name: String,
    /// Where they are, in the units of the axes.
    pub at: Vec<[f64; 2]>,
    /// Where lines from the first points lead, as those of velocities do.
    pub ways: Vec<[f64; 2]>,
}

impl Dots {
    /// Points without lines.
    pub fn new(name: &str, at: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self { name: name.to_owned(), at: at.into_iter().collect(), ways: Vec::new() }
    }

    /// The same with a line from each of the first points to one of these places.
    pub fn with_ways(self, ways: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self { ways: ways.into_iter().collect(), ..self }
    }

    /// The points and the ends of their lines.
    pub fn ends(&self) -> impl Iterator<Item = &[f64; 2]> {
        self.at.iter().chain(&self.ways)
    }
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
    /// Whether some point that came back, or its way, is off by a hundredth of the picture or more.
    pub fn shows_a_difference(&self) -> bool {
        let (expected, obtained) = (&self.expected, &self.obtained);
        let near = [0, 1].into_iter().all(|axis| {
            let all = expected.ends().chain(obtained.ends()).map(|point| point[axis]);
            let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                (low.min(at), high.max(at))
            });
            expected
                .ends()
                .zip(obtained.ends())
                .all(|(a, b)| (a[axis] - b[axis]).abs() <= 0.01 * (high - low))
        });
        !near || expected.at.len() != obtained.at.len()
    }
}
