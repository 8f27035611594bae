//! Which blocks are coupled, and what elimination couples: the pattern without the numbers.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Bound::{Excluded, Unbounded};

use nalgebra::RealField;

use super::{Information, MarginalizationError};

// ANCHOR: couplings
/// Which blocks are coupled with which: the graph of an information matrix, in which two blocks are
/// neighbours when their off-diagonal block is not zero.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Couplings {
    neighbours: BTreeMap<usize, BTreeSet<usize>>,
}
// ANCHOR_END: couplings

/// What eliminating some blocks does to the others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FillIn {
    /// The couplings of the survivors.
    pub couplings: Couplings,
    /// The pairs of survivors that are coupled now and were not before, the smaller name first.
    pub new: BTreeSet<(usize, usize)>,
    /// The survivors that were coupled with what is gone: its Markov blanket. Those that were coupled with
    /// one connected part of it
    /// are a clique now.
    pub blanket: BTreeSet<usize>,
    /// How many couplings came up along the way in this order, those with blocks included that were
    /// eliminated later. It depends on the order; the rest does not.
    pub along_the_way: usize,
}

impl Couplings {
    /// Blocks of these names, none coupled.
    pub fn new(names: impl IntoIterator<Item = usize>) -> Self {
        let mut couplings = Self::default();
        for name in names {
            couplings.neighbours.entry(name).or_default();
        }
        couplings
    }

    /// The couplings of an information matrix.
    pub fn of<T: RealField + Copy>(information: &Information<T>) -> Self {
        let blocks = information.blocks();
        let mut couplings = Self::new(blocks.names());
        let named: Vec<_> = blocks.names().zip(blocks.ranges()).collect();
        for (number, (name, rows)) in named.iter().enumerate() {
            for (other, columns) in &named[..number] {
                let block = information.matrix().view_range(rows.clone(), columns.clone());
                if block.iter().any(|entry| *entry != T::zero()) {
                    couplings.couple(*name, *other);
                }
            }
        }
        couplings
    }

    /// Couples two blocks, and adds those that are not there. Whether they were not coupled before; a
    /// block is not coupled with itself.
    pub fn couple(&mut self, first: usize, second: usize) -> bool {
        self.neighbours.entry(second).or_default();
        self.neighbours.entry(first).or_default();
        let mut add = |one: usize, other: usize| {
            one != other && self.neighbours.entry(one).or_default().insert(other)
        };
        add(first, second) | add(second, first)
    }

    /// Couples every pair of some blocks, as a factor that names all of them does. How many pairs were
    /// not coupled before.
    pub fn couple_all(&mut self, names: &BTreeSet<usize>) -> usize {
        let pairs = names
            .iter()
            .flat_map(|one| names.range((Excluded(one), Unbounded)).map(move |two| (one, two)));
        pairs.filter(|(one, two)| self.couple(**one, **two)).count()
    }

    /// The neighbours of a block; `None` when there is no such block.
    pub fn neighbours(&self, name: usize) -> Option<&BTreeSet<usize>> {
        self.neighbours.get(&name)
    }

    /// All coupled pairs, the smaller name first.
    pub fn pairs(&self) -> BTreeSet<(usize, usize)> {
        let mut pairs = BTreeSet::new();
        for (name, others) in &self.neighbours {
            pairs.extend(others.range((Excluded(name), Unbounded)).map(|other| (*name, *other)));
        }
        pairs
    }

    /// Whether every pair is coupled.
    pub fn is_complete(&self) -> bool {
        self.neighbours.values().all(|others| others.len() + 1 == self.neighbours.len())
    }

    // ANCHOR: eliminate_name
    /// Takes one block out and makes a clique of its neighbours. How many pairs that couples.
    fn eliminate(&mut self, name: usize) -> usize {
        let neighbours = self.neighbours.remove(&name).unwrap_or_default();
        for other in &neighbours {
            self.neighbours.entry(*other).or_default().remove(&name);
        }
        self.couple_all(&neighbours)
    }
    // ANCHOR_END: eliminate_name

    /// An order of some blocks in which the one with the fewest neighbours is always next.
    ///
    /// # Errors
    ///
    /// As those of [`fill_in`].
    pub fn fewest_neighbours_first(
        &self,
        names: &[usize],
    ) -> Result<Vec<usize>, MarginalizationError> {
        self.check(names)?;
        let (mut left, mut waiting) = (self.clone(), names.to_vec());
        let mut order = Vec::with_capacity(names.len());
        while let Some(at) = (0..waiting.len())
            .min_by_key(|at| left.neighbours.get(&waiting[*at]).map_or(0, BTreeSet::len))
        {
            let name = waiting.remove(at);
            left.eliminate(name);
            order.push(name);
        }
        Ok(order)
    }

    fn check(&self, names: &[usize]) -> Result<(), MarginalizationError> {
        let blocks = self.neighbours.len();
        for (at, &name) in names.iter().enumerate() {
            if !self.neighbours.contains_key(&name) {
                return Err(MarginalizationError::Unknown { name, blocks });
            }
            if names[..at].contains(&name) {
                return Err(MarginalizationError::Repeated { name });
            }
        }
        match names.len() {
            0 => Err(MarginalizationError::NoneNamed),
            count if count == blocks => Err(MarginalizationError::NothingLeft { blocks }),
            _ => Ok(()),
        }
    }
}

// ANCHOR: fill_in
/// What eliminating some blocks, in this order, couples among the others, {thm:blanket}.
///
/// # Errors
///
/// [`MarginalizationError::NoneNamed`], [`MarginalizationError::Unknown`],
/// [`MarginalizationError::Repeated`] and [`MarginalizationError::NothingLeft`].
pub fn fill_in(couplings: &Couplings, names: &[usize]) -> Result<FillIn, MarginalizationError> {
    couplings.check(names)?;
    let (mut left, mut along_the_way, mut blanket) = (couplings.clone(), 0, BTreeSet::new());
    for &name in names {
        blanket.extend(left.neighbours(name).into_iter().flatten().copied());
        along_the_way += left.eliminate(name);
    }
    blanket.retain(|name| !names.contains(name));
    let (mut new, before) = (left.pairs(), couplings.pairs());
    new.retain(|pair| !before.contains(pair));
    Ok(FillIn { couplings: left, new, blanket, along_the_way })
}
// ANCHOR_END: fill_in

impl FillIn {
    /// Whether every survivor depends directly on every other one now, and some did not before: what
    /// a landmark leaves that all keyframes saw.
    pub fn couples_everything(&self) -> bool {
        !self.new.is_empty() && self.couplings.is_complete()
    }

    /// The same, if it couples no more than so many new pairs.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::TooDense`].
    pub fn within(self, limit: usize) -> Result<Self, MarginalizationError> {
        let pairs = self.new.len();
        match pairs > limit {
            true => Err(MarginalizationError::TooDense { pairs, limit }),
            false => Ok(self),
        }
    }
}
