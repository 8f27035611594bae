//! A window that slides: what leaves, what is coupled then, and what is known of those that stay.

use std::collections::BTreeSet;

use vislam::marginalization::{
    Couplings, Information, Layout, SquareRoot, WindowSigmas, fill_in, marginalize,
};

use super::free::is_determined;

/// Two blocks, the smaller name first.
pub type Pair = (usize, usize);

/// The noise of the window.
pub const SEED: u64 = 0;

/// What was done with the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// How many keyframes have left, the oldest first.
    pub slides: usize,
    /// Whether they left alone, and not with the landmarks that they saw.
    pub alone: bool,
    /// Whether odometry links each keyframe with the next.
    pub odometry: bool,
}

impl Plan {
    pub fn layout(&self) -> Layout {
        let layout = Layout::eight_keyframes();
        if self.odometry { layout } else { layout.without_odometry() }
    }

    /// What leaves in each slide, in the order of elimination.
    pub fn leaving(&self) -> Vec<Vec<usize>> {
        let layout = self.layout();
        let mut leaving: Vec<Vec<usize>> = Vec::new();
        for keyframe in 0..self.slides {
            let mut leaves = if self.alone { vec![keyframe] } else { layout.slide(keyframe) };
            leaves.retain(|name| !leaving.iter().any(|gone| gone.contains(name)));
            leaving.push(leaves);
        }
        leaving
    }

    /// The steps of the window from where it was linearized, after the slides; none if they are not determined.
    pub fn gaussian(&self) -> Option<Information<f64>> {
        let layout = self.layout();
        let problem = layout.problem(&WindowSigmas::default(), SEED).ok()?;
        let window = SquareRoot::of_problem(&problem, problem.values()).ok()?.information();
        if !is_determined(&layout, problem) {
            return None;
        }
        let gone = self.leaving().concat();
        if gone.is_empty() { Some(window) } else { marginalize(&window, &gone).ok() }
    }
}

/// Who is coupled with whom.
pub struct Pattern {
    /// Those that have not left.
    pub names: Vec<usize>,
    /// Of those that have not left.
    pub couplings: BTreeSet<Pair>,
    /// By measurements of the whole window.
    pub measured: BTreeSet<Pair>,
    /// In the last slide.
    pub new: BTreeSet<Pair>,
    /// How many couplings came up on the way in the last slide.
    pub along_the_way: usize,
}

impl Pattern {
    pub fn of(plan: &Plan) -> Self {
        let layout = plan.layout();
        let mut names: Vec<usize> = (0..layout.keyframes + layout.seen_by.len()).collect();
        let mut left: Couplings = layout.couplings();
        let measured = left.pairs();
        let (mut new, mut along_the_way) = (BTreeSet::new(), 0);
        for gone in plan.leaving() {
            let Ok(filled) = fill_in(&left, &gone) else { break };
            names.retain(|name| !gone.contains(name));
            (left, new, along_the_way) = (filled.couplings, filled.new, filled.along_the_way);
        }
        Self { names, couplings: left.pairs(), measured, new, along_the_way }
    }

    /// The link with a number; after the last one comes the first one again.
    pub fn link(&self, number: usize) -> Option<Pair> {
        let count = self.couplings.len().max(1);
        self.couplings.iter().nth(number % count).copied()
    }

    /// The number of the link whose square in the matrix is nearest to a place.
    pub fn nearest_link(&self, [x, y]: [f64; 2]) -> Option<usize> {
        let (column, row) = (x.min(y), x.max(y));
        let off = |&(a, b): &Pair| (a as f64 - column).powi(2) + (b as f64 - row).powi(2);
        let numbered = self.couplings.iter().map(off).enumerate();
        numbered.min_by(|(_, one), (_, other)| one.total_cmp(other)).map(|(number, _)| number)
    }
}
