//! A short list without an allocation.

use std::fmt;
use std::ops::Deref;

// ANCHOR: candidates
/// At most `N` answers of a solver that has several.
#[derive(Clone, Copy)]
pub struct Candidates<T, const N: usize> {
    values: [T; N],
    count: usize,
}

impl<T: Copy, const N: usize> Candidates<T, N> {
    /// An empty list. Its memory is filled with a value that is never shown.
    pub fn none(filler: T) -> Self {
        Self { values: [filler; N], count: 0 }
    }

    /// Adds a value, unless there are `N` already.
    pub fn push(&mut self, value: T) {
        if let Some(place) = self.values.get_mut(self.count) {
            *place = value;
            self.count += 1;
        }
    }

    /// The list with one more value.
    pub fn with(mut self, value: T) -> Self {
        self.push(value);
        self
    }

    /// Takes the last value out.
    pub fn pop(&mut self) -> Option<T> {
        self.count = self.count.checked_sub(1)?;
        Some(self.values[self.count])
    }
}

impl<T, const N: usize> Deref for Candidates<T, N> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.values[..self.count]
    }
}
// ANCHOR_END: candidates

impl<T: Copy + PartialEq, const N: usize> PartialEq for Candidates<T, N> {
    fn eq(&self, other: &Self) -> bool {
        self[..] == other[..]
    }
}

impl<T: Copy + fmt::Debug, const N: usize> fmt::Debug for Candidates<T, N> {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        self[..].fmt(formatter)
    }
}
