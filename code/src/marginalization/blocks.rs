//! Names of what stands in which columns.

use std::ops::Range;

use super::MarginalizationError;

// ANCHOR: blocks
/// A variable by its name, and how many coordinates a step of it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block {
    /// Its name: its number in the problem that it comes from, or any other.
    pub name: usize,
    /// Its dimension.
    pub dimension: usize,
}

/// Blocks in the order of their columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Blocks {
    blocks: Vec<Block>,
    /// The first column of each.
    starts: Vec<usize>,
    dimension: usize,
}
// ANCHOR_END: blocks

impl Blocks {
    /// Blocks in this order.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::NoneNamed`], [`MarginalizationError::EmptyBlock`] and
    /// [`MarginalizationError::Repeated`].
    pub fn new(blocks: Vec<Block>) -> Result<Self, MarginalizationError> {
        if blocks.is_empty() {
            return Err(MarginalizationError::NoneNamed);
        }
        let (mut starts, mut dimension) = (Vec::with_capacity(blocks.len()), 0);
        for (number, block) in blocks.iter().enumerate() {
            if block.dimension == 0 {
                return Err(MarginalizationError::EmptyBlock { name: block.name });
            }
            if blocks[..number].iter().any(|other| other.name == block.name) {
                return Err(MarginalizationError::Repeated { name: block.name });
            }
            starts.push(dimension);
            dimension += block.dimension;
        }
        Ok(Self { blocks, starts, dimension })
    }

    /// How many blocks there are.
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Whether there are none, which [`Blocks::new`] does not allow.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// The dimension of all blocks together.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The names, in order.
    pub fn names(&self) -> impl Iterator<Item = usize> + '_ {
        self.blocks.iter().map(|block| block.name)
    }

    /// The columns of a block.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::Unknown`].
    pub fn columns_of(&self, name: usize) -> Result<Range<usize>, MarginalizationError> {
        let at = self.blocks.iter().position(|block| block.name == name);
        let unknown = MarginalizationError::Unknown { name, blocks: self.len() };
        let at = at.ok_or(unknown)?;
        Ok(self.starts[at]..self.starts[at] + self.blocks[at].dimension)
    }

    /// The columns of each block, in order.
    pub(super) fn ranges(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        self.blocks.iter().zip(&self.starts).map(|(block, start)| *start..start + block.dimension)
    }

    /// The name of the block that has a column.
    pub(super) fn name_at(&self, column: usize) -> usize {
        let after = self.starts.partition_point(|start| *start <= column);
        self.blocks[after - 1].name
    }

    /// Some of the blocks, in this order, and their columns.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::NoneNamed`], [`MarginalizationError::Unknown`] and
    /// [`MarginalizationError::Repeated`].
    pub(super) fn select(
        &self,
        names: &[usize],
    ) -> Result<(Self, Vec<usize>), MarginalizationError> {
        let mut columns = Vec::with_capacity(self.dimension);
        let mut blocks = Vec::with_capacity(names.len());
        for &name in names {
            let own = self.columns_of(name)?;
            blocks.push(Block { name, dimension: own.len() });
            columns.extend(own);
        }
        Ok((Self::new(blocks)?, columns))
    }

    /// The names of the blocks that are left without some.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::NoneNamed`], [`MarginalizationError::Unknown`],
    /// [`MarginalizationError::Repeated`], and [`MarginalizationError::NothingLeft`] when all are named.
    pub(super) fn without(&self, names: &[usize]) -> Result<Vec<usize>, MarginalizationError> {
        self.select(names)?;
        let left: Vec<usize> = self.names().filter(|name| !names.contains(name)).collect();
        let nothing = MarginalizationError::NothingLeft { blocks: self.len() };
        (!left.is_empty()).then_some(left).ok_or(nothing)
    }
}
