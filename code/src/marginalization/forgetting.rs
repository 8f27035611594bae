//! Two ways of taking a block out that are not marginalization.

use nalgebra::RealField;

use super::{Information, MarginalizationError, SquareRoot};

impl<T: RealField + Copy> SquareRoot<T> {
    // ANCHOR: drop_blocks
    /// The window without some blocks and without all rows that name one of them: their measurements
    /// are forgotten. Less is known of the survivors than was measured, or nothing.
    ///
    /// # Errors
    ///
    /// [`MarginalizationError::NoneNamed`], [`MarginalizationError::Unknown`],
    /// [`MarginalizationError::Repeated`] and [`MarginalizationError::NothingLeft`].
    pub fn drop_blocks(&self, names: &[usize]) -> Result<Self, MarginalizationError> {
        let survivors = self.blocks().without(names)?;
        let (_, gone) = self.blocks().select(names)?;
        let names_one = |row: usize| gone.iter().any(|c| self.root()[(row, *c)] != T::zero());
        self.with_rows(|row| !names_one(row)).select(&survivors)
    }
    // ANCHOR_END: drop_blocks
}

impl<T: RealField + Copy> Information<T> {
    // ANCHOR: condition_blocks
    /// The window in which some blocks are held at their means, as if they were known without error:
    /// their rows and columns go. Survivors keep their means, and are claimed to be known better than
    /// they are.
    ///
    /// # Errors
    ///
    /// As those of [`SquareRoot::drop_blocks`], and [`MarginalizationError::Singular`] or
    /// [`MarginalizationError::Indefinite`] when there is no mean.
    pub fn hold_blocks(&self, names: &[usize]) -> Result<Self, MarginalizationError> {
        let survivors = self.blocks().without(names)?;
        let mean = self.select_mean(&survivors)?;
        self.select(&survivors)?.with_mean(&mean)
    }
    // ANCHOR_END: condition_blocks

    /// The part of the mean that belongs to some blocks.
    fn select_mean(&self, names: &[usize]) -> Result<nalgebra::DVector<T>, MarginalizationError> {
        let (_, columns) = self.blocks().select(names)?;
        Ok(self.mean()?.select_rows(&columns))
    }

    /// The Gaussian with the same information matrix and another mean.
    pub(super) fn with_mean(
        self,
        mean: &nalgebra::DVector<T>,
    ) -> Result<Self, MarginalizationError> {
        let vector = self.matrix() * mean;
        Self::new(self.blocks().clone(), self.matrix().clone(), vector)
    }
}
