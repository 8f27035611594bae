//! How many directions are free, and which.

use std::fmt;

use nalgebra::{DMatrix, DVector};

use super::{Direction, ObservabilityError, Window};
use crate::least_squares::{Columns, NullSpace, Spectrum};

/// A sum of directions that is free although none of them is by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixture {
    /// The directions with their factors, the greatest of which is one.
    pub parts: Vec<(Direction, f64)>,
}

// ANCHOR: free_directions
/// What a window leaves free.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeDirections {
    /// The singular values, and how many are zero.
    pub spectrum: Spectrum,
    /// Free directions that have a name, each independent of those before it.
    pub named: Vec<Direction>,
    /// Free sums of directions with a name.
    pub mixtures: Vec<Mixture>,
}

impl FreeDirections {
    /// How many there are: the nullity of the Jacobian.
    pub fn count(&self) -> usize {
        self.spectrum.zeros
    }

    /// How many have no name.
    pub fn unnamed(&self) -> usize {
        self.count().saturating_sub(self.named.len() + self.mixtures.len())
    }
}
// ANCHOR_END: free_directions

impl Window {
    // ANCHOR: name
    /// Finds the free directions of the window where it stands, and names them.
    ///
    /// # Errors
    ///
    /// Those of [`Window::residual`], and [`ObservabilityError::NullSpace`].
    pub fn free_directions(&self) -> Result<FreeDirections, ObservabilityError> {
        let spectrum = Spectrum::of(&self.linearize()?.0)?;
        let (null_space, columns) = (spectrum.null_space(), self.columns());
        let (mut named, mut units) = (Vec::new(), Vec::new());
        for direction in self.candidates() {
            let candidate = self.direction_in(direction, &columns);
            let is_free = null_space.leaves(&candidate) < NullSpace::TOLERANCE;
            units.push(null_space.scaled(&candidate).1);
            let span = DMatrix::from_columns(&units);
            if is_free && NullSpace::sums_that_vanish(&span, &span).is_empty() {
                named.push(direction);
            } else {
                units.pop();
            }
        }
        let mixtures = self.mixtures(&null_space, &named, &columns);
        Ok(FreeDirections { spectrum, named, mixtures })
    }
    // ANCHOR_END: name

    /// Every direction with a name. Depths come before scale, which all of them together make up
    /// when the camera stands still.
    fn candidates(&self) -> impl Iterator<Item = Direction> {
        let translations = (0..3).map(Direction::Translation);
        let turns = [Direction::Tilt(0), Direction::Tilt(1), Direction::Yaw];
        let depths = (0..self.landmarks.len()).map(Direction::Depth);
        let levers = (0..3).filter(|_| self.calibration.extrinsics).map(Direction::LeverArm);
        translations.chain(turns).chain(depths).chain([Direction::Scale]).chain(levers)
    }

    // ANCHOR: mixtures
    /// Sums of scale and tilts that are free while their parts are not.
    fn mixtures(
        &self,
        null_space: &NullSpace,
        named: &[Direction],
        columns: &Columns,
    ) -> Vec<Mixture> {
        let left = null_space.nullity() - named.len();
        let parts = [Direction::Scale, Direction::Tilt(0), Direction::Tilt(1)];
        let parts: Vec<_> = parts.into_iter().filter(|part| !named.contains(part)).collect();
        if left == 0 || parts.len() < 2 {
            return Vec::new();
        }
        let directions: Vec<_> =
            parts.iter().map(|part| self.direction_in(*part, columns)).collect();
        let sums = null_space.combinations(&directions);
        let mixture = |column| Mixture::new(&parts, &sums.column(column).into_owned());
        (0..sums.ncols().min(left)).map(mixture).collect()
    }
    // ANCHOR_END: mixtures
}

impl Mixture {
    fn new(parts: &[Direction], factors: &DVector<f64>) -> Self {
        let largest = factors[factors.icamax()];
        let parts = parts.iter().zip(factors).map(|(part, factor)| (*part, factor / largest));
        Self { parts: parts.filter(|(_, factor)| factor.abs() > NullSpace::TOLERANCE).collect() }
    }
}

// ANCHOR: display
impl fmt::Display for FreeDirections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_depth = |direction: &&Direction| matches!(direction, Direction::Depth(_));
        let mut names: Vec<String> =
            self.named.iter().filter(|d| !is_depth(d)).map(Direction::to_string).collect();
        match self.named.iter().filter(is_depth).count() {
            0 => {}
            depths => names.push(format!("depth of {depths} landmarks")),
        }
        names.extend(self.mixtures.iter().map(|mixture| {
            let parts: Vec<_> = mixture.parts.iter().map(|(part, _)| part.to_string()).collect();
            parts.join(" with ")
        }));
        if self.unnamed() > 0 {
            names.push(format!("{} without a name", self.unnamed()));
        }
        write!(f, "{}: {}", self.count(), names.join(", "))
    }
}
// ANCHOR_END: display
