//! A link that is dropped, and what is reported of its ends then.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, Matrix2};
use vislam::marginalization::{
    Couplings, Information, divergence, keep_marginals, marginalize, sparsify, zero_link,
};

use super::window::Pair;

/// How a link is dropped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Way {
    Kept,
    Zeroed,
    MarginalsKept,
    /// As the sparse extended information filter does, the first end in the place of its robot.
    Filter,
}

impl Way {
    pub const ALL: [Self; 4] = [Self::Kept, Self::Zeroed, Self::MarginalsKept, Self::Filter];

    /// The window without the link; none if that is no Gaussian.
    pub fn apply(
        self,
        truth: &Information<f64>,
        (first, second): Pair,
    ) -> Option<Information<f64>> {
        match self {
            Self::Kept => Some(truth.clone()),
            Self::Zeroed => zero_link(truth, first, second).ok(),
            Self::MarginalsKept => keep_marginals(truth, first, second).ok(),
            Self::Filter => sparsify(truth, first, &[second]).ok(),
        }
    }
}

/// What a window says of both ends of a link, whatever the others are.
pub struct Ends {
    covariance: DMatrix<f64>,
    /// Where the position of each end begins.
    starts: [usize; 2],
}

impl Ends {
    fn of(window: &Information<f64>, (first, second): Pair) -> Option<Self> {
        // Landmarks come last, and should go first.
        let mut others: Vec<usize> =
            window.blocks().names().filter(|name| ![first, second].contains(name)).collect();
        others.reverse();
        let both = match others.is_empty() {
            true => window.clone(),
            false => marginalize(window, &others).ok()?,
        };
        let start = |name: usize| Some(both.blocks().columns_of(name).ok()?.start);
        let starts = [start(first)?, start(second)?];
        Some(Self { covariance: both.covariance().ok()?, starts })
    }

    /// The standard deviation of the position of an end, in metres.
    pub fn sigma(&self, end: usize) -> f64 {
        let start = self.starts[end];
        self.covariance.view((start, start), (3, 3)).trace().sqrt()
    }

    /// The covariance of the position of an end to the right and in depth.
    pub fn seen_from_above(&self, end: usize) -> Matrix2<f64> {
        let axes = [0, 2].map(|axis| self.starts[end] + axis);
        Matrix2::from_fn(|row, column| self.covariance[(axes[row], axes[column])])
    }
}

/// What dropping a link does.
pub struct Dropped {
    pub truth: Option<Ends>,
    pub reported: Option<Ends>,
    /// The Kullback-Leibler divergence of what is reported from the truth, in nats.
    pub nats: Option<f64>,
    /// The pairs that are coupled without the link, if that is a Gaussian.
    pub couplings: Option<BTreeSet<Pair>>,
}

impl Dropped {
    pub fn of(truth: Option<&Information<f64>>, link: Pair, way: Way) -> Self {
        let left = truth.and_then(|truth| way.apply(truth, link));
        let ends = |window: Option<&Information<f64>>| Ends::of(window?, link);
        let (known, reported) = (ends(truth), ends(left.as_ref()));
        let nats = truth.zip(left.as_ref()).and_then(|(p, q)| divergence(p, q).ok());
        let couplings = left.as_ref().map(|left| Couplings::of(left).pairs());
        Self { truth: known, reported, nats, couplings }
    }
}
