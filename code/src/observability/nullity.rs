//! How many directions are free, and which.

use std::fmt;

use nalgebra::{DMatrix, DVector};

use super::singular::right_singular;
use super::{Direction, ObservabilityError, Window};
use crate::least_squares::SingularSystem;

/// A singular value below this fraction of the largest one is zero: rounding leaves some 1e-16.
const ZERO_BELOW: f64 = 1e-13;

/// A singular value above this fraction of the largest one is not zero. None may lie in the gap
/// between the two limits.
const SEEN_ABOVE: f64 = 1e-10;

/// A candidate lies in the null space when it leaves it by no more than this part of its length.
const LEAVES: f64 = 1e-4;

// ANCHOR: spectrum_type
/// The singular values of a whitened Jacobian whose columns have been scaled to length one, so
/// that radians, metres and metres per second can be compared: {eq:scaled-jacobian}.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// As fractions of the largest, ascending.
    pub singular_values: Vec<f64>,
    /// How many of them are zero.
    pub zeros: usize,
    /// Right singular vectors in scaled coordinates, one a column, in the same order.
    vectors: DMatrix<f64>,
    /// One over the length of each column.
    scale: DVector<f64>,
    largest: f64,
}
// ANCHOR_END: spectrum_type

impl Spectrum {
    // ANCHOR: spectrum
    /// The spectrum of a Jacobian with any number of rows.
    ///
    /// # Errors
    ///
    /// [`ObservabilityError::NotFinite`], and [`ObservabilityError::NoGap`] when it cannot be said
    /// which values are zero.
    pub fn of(jacobian: &DMatrix<f64>) -> Result<Self, ObservabilityError> {
        if let Some(row) = jacobian.row_iter().position(|row| !row.iter().all(|x| x.is_finite())) {
            return Err(ObservabilityError::NotFinite { row });
        }
        let reciprocal = |length: f64| if length > 0.0 { length.recip() } else { 1.0 };
        let scale = DVector::from_iterator(
            jacobian.ncols(),
            jacobian.column_iter().map(|column| reciprocal(column.norm())),
        );
        let (values, vectors) = right_singular(jacobian * DMatrix::from_diagonal(&scale));
        let largest = values.last().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
        let singular_values: Vec<f64> = values.iter().map(|value| value / largest).collect();
        if let Some(value) = singular_values.iter().find(|v| (ZERO_BELOW..SEEN_ABOVE).contains(*v))
        {
            return Err(ObservabilityError::NoGap { value: *value });
        }
        let zeros = singular_values.partition_point(|value| *value < ZERO_BELOW);
        Ok(Self { singular_values, zeros, vectors, scale, largest })
    }
    // ANCHOR_END: spectrum
}

impl Spectrum {
    /// An orthonormal basis, in scaled coordinates, of what no measurement sees.
    fn null_basis(&self) -> DMatrix<f64> {
        self.vectors.columns(0, self.zeros).into_owned()
    }

    /// The free directions in unscaled coordinates, or `None` when there are none.
    pub fn singular(&self) -> Option<SingularSystem> {
        if self.zeros == 0 {
            return None;
        }
        let null = DMatrix::from_diagonal(&self.scale) * self.null_basis();
        let dimension = self.scale.len();
        Some(SingularSystem { free: self.zeros, dimension, basis: null.qr().q() })
    }

    // ANCHOR: leaves
    /// How much of a direction, as a part of its length in scaled coordinates, lies outside of the
    /// null space: 0 when it is free, 1 when nothing of it is.
    pub fn leaves(&self, direction: &DVector<f64>) -> f64 {
        let scaled = direction.component_div(&self.scale);
        let length = scaled.norm();
        if length > 0.0 { self.outside(&scaled).norm() / length } else { 1.0 }
    }

    /// A direction in scaled coordinates, with its length and at length one.
    fn scaled(&self, direction: &DVector<f64>) -> (f64, DVector<f64>) {
        let scaled = direction.component_div(&self.scale);
        (scaled.norm(), scaled.normalize())
    }

    /// The part outside of the null space of a vector in scaled coordinates.
    fn outside(&self, scaled: &DVector<f64>) -> DVector<f64> {
        let basis = self.null_basis();
        scaled - &basis * basis.tr_mul(scaled)
    }
    // ANCHOR_END: leaves

    // ANCHOR: sigma
    /// The standard deviation of a quantity with this gradient over all unknowns, or `None` when it
    /// changes along a free direction: then no measurement bounds it.
    ///
    /// Implements {eq:quantity-sigma}.
    pub fn sigma(&self, gradient: &DVector<f64>) -> Option<f64> {
        let scaled = gradient.component_mul(&self.scale);
        let along = self.vectors.tr_mul(&scaled);
        let free = along.rows(0, self.zeros).norm();
        let variance: f64 = (self.zeros..along.len())
            .map(|i| (along[i] / (self.largest * self.singular_values[i])).powi(2))
            .sum();
        (free <= LEAVES * scaled.norm()).then(|| variance.sqrt())
    }
    // ANCHOR_END: sigma
}

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
    /// Those of [`Window::residual`], and [`ObservabilityError::NoGap`].
    pub fn free_directions(&self) -> Result<FreeDirections, ObservabilityError> {
        let spectrum = Spectrum::of(&self.linearize()?.jacobian)?;
        let mut span = Span::default();
        let mut named = Vec::new();
        for direction in self.candidates() {
            let (_, candidate) = spectrum.scaled(&self.direction(direction));
            let free = spectrum.outside(&candidate).norm() < LEAVES;
            if named.len() < spectrum.zeros && free && span.extend(&candidate) {
                named.push(direction);
            }
        }
        let mixtures = self.mixtures(&spectrum, &named);
        Ok(FreeDirections { spectrum, named, mixtures })
    }
    // ANCHOR_END: name

    /// Every direction with a name. Depths come before scale, which all of them together make up
    /// when the camera stands still.
    fn candidates(&self) -> impl Iterator<Item = Direction> {
        let translations = (0..3).map(Direction::Translation);
        let turns = [Direction::Tilt(0), Direction::Tilt(1), Direction::Yaw];
        let depths = (0..self.landmarks.len()).map(Direction::Depth);
        translations.chain(turns).chain(depths).chain([Direction::Scale])
    }

    // ANCHOR: mixtures
    /// Sums of scale and tilts that are free while their parts are not: what they have outside of
    /// the null space cancels.
    fn mixtures(&self, spectrum: &Spectrum, named: &[Direction]) -> Vec<Mixture> {
        let left = spectrum.zeros - named.len();
        let parts = [Direction::Scale, Direction::Tilt(0), Direction::Tilt(1)];
        let parts: Vec<_> = parts.into_iter().filter(|part| !named.contains(part)).collect();
        if left == 0 || parts.len() < 2 {
            return Vec::new();
        }
        let (lengths, outside): (Vec<_>, Vec<_>) = parts
            .iter()
            .map(|part| spectrum.scaled(&self.direction(*part)))
            .map(|(length, unit)| (length, spectrum.outside(&unit)))
            .unzip();
        let (values, factors) = right_singular(DMatrix::from_columns(&outside));
        let free = values.iter().take(left).take_while(|value| **value < LEAVES).count();
        let mixture = |column| Mixture::new(&parts, &lengths, &factors.column(column).into_owned());
        (0..free).map(mixture).collect()
    }
    // ANCHOR_END: mixtures
}

impl Mixture {
    /// From factors of directions of length one, and the lengths that they have.
    fn new(parts: &[Direction], lengths: &[f64], factors: &DVector<f64>) -> Self {
        let factor = |at: usize| factors[at] / lengths[at];
        let largest = (0..parts.len())
            .map(factor)
            .fold(0.0_f64, |largest, f| if f.abs() > largest.abs() { f } else { largest });
        let parts = parts.iter().enumerate().map(|(at, part)| (*part, factor(at) / largest));
        Self { parts: parts.filter(|(_, factor)| factor.abs() > LEAVES).collect() }
    }
}

/// Vectors that are told apart by whether they add a dimension.
#[derive(Default)]
struct Span(Vec<DVector<f64>>);

impl Span {
    /// Adds a unit vector unless it lies in the span already.
    fn extend(&mut self, unit: &DVector<f64>) -> bool {
        let mut rest = unit.clone();
        // Twice is enough for orthogonality to rounding.
        for known in self.0.iter().chain(&self.0) {
            rest -= known.dot(&rest) * known;
        }
        let length = rest.norm();
        if length > 10.0 * LEAVES {
            self.0.push(rest / length);
        }
        length > 10.0 * LEAVES
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
