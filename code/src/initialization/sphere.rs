//! The least of a quadratic function on a sphere.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// A place on a sphere where a function is less than all around.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereMinimum {
    /// Where it is.
    pub at: Vector3<f64>,
    /// What the function is there.
    pub value: f64,
}

// ANCHOR: on_sphere
/// Where gᵀ S g − 2 hᵀ g is least among vectors g of a length, and the other place where it is less
/// than all around, if there is one.
///
/// At each, (S + μ I) g = h for some μ. It is the least of all when no eigenvalue of S + μ I is
/// negative, and the other one has a single negative eigenvalue. The length of (S + μ I)⁻¹ h falls
/// as μ grows beyond the eigenvalues, so halving an interval finds the μ of a length.
///
/// Implements {eq:sphere-condition}.
///
/// `None` when a number is not finite, or all places are equally good; two of those of a circle.
pub fn minima_on_sphere(
    square: &Matrix3<f64>,
    target: &Vector3<f64>,
    length: f64,
) -> Option<(SphereMinimum, Option<SphereMinimum>)> {
    let symmetric = 0.5 * (square + square.transpose());
    let eigen = SymmetricEigen::try_new(symmetric, f64::EPSILON, 1000)?;
    let secular = Secular::new(eigen.eigenvalues, eigen.eigenvectors.tr_mul(target), length);
    let place = |parts: Vector3<f64>| {
        let at = eigen.eigenvectors * (parts * (length / parts.norm()));
        SphereMinimum { at, value: at.dot(&(symmetric * at)) - 2.0 * target.dot(&at) }
    };
    let (least, other) = secular.minima()?;
    Some((place(least), other.map(place)))
}
// ANCHOR_END: on_sphere

/// The equation for μ along the eigenvectors, whose eigenvalues ascend.
struct Secular {
    values: Vector3<f64>,
    parts: Vector3<f64>,
    order: [usize; 3],
    length: f64,
}

impl Secular {
    fn new(values: Vector3<f64>, parts: Vector3<f64>, length: f64) -> Self {
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        Self { values, parts, order, length }
    }

    /// g for a μ that is given by its distance from minus the least eigenvalue.
    fn at(&self, shift: f64) -> Vector3<f64> {
        let least = self.values[self.order[0]];
        self.values.zip_map(&self.parts, |value, part| part / (value - least + shift))
    }

    fn is_short(&self, shift: f64) -> bool {
        self.at(shift).norm() <= self.length
    }

    // ANCHOR: secular
    /// The least, and the other minimum.
    fn minima(&self) -> Option<(Vector3<f64>, Option<Vector3<f64>>)> {
        let reach = self.parts.norm() / self.length;
        let scale = self.values.amax().max(reach);
        let nothing = f64::EPSILON * scale;
        let spread = reach.max(self.values.max() - self.values.min());
        let is_finite = (self.values.sum() + reach).is_finite();
        if !(spread > nothing && is_finite) {
            return None;
        }
        if self.is_short(nothing) {
            // Along the least eigenvector nothing pulls: as far as the sphere, both ways.
            let axis = self.order[0];
            let mut ends = [self.at(nothing); 2];
            ends.iter_mut().for_each(|end| end[axis] = 0.0);
            let missing = (self.length.powi(2) - ends[0].norm_squared()).max(0.0).sqrt();
            (ends[0][axis], ends[1][axis]) = (missing, -missing);
            return Some((ends[0], Some(ends[1])));
        }
        let least = halved(nothing, reach + nothing, |shift| self.is_short(shift));
        Some((self.at(least), self.other(nothing)))
    }
    // ANCHOR_END: secular

    /// The other minimum: between the poles of the two least eigenvalues the length has one valley,
    /// and on the slope that rises to the least one it passes through what is wanted, if at all.
    fn other(&self, nothing: f64) -> Option<Vector3<f64>> {
        let pole = self.values[self.order[0]] - self.values[self.order[1]];
        let rises = |shift: f64| {
            let parts = self.at(shift).zip_map(&self.values, |part, value| {
                part * part / (value - self.values[self.order[0]] + shift)
            });
            parts.sum() < 0.0
        };
        let valley = halved(pole + nothing, -nothing, rises);
        let reaches = |shift: f64| !self.is_short(shift);
        (pole < -2.0 * nothing && self.is_short(valley) && reaches(-nothing))
            .then(|| self.at(halved(valley, -nothing, reaches)))
    }
}

/// Where something begins to be so in an interval, at whose end it is.
fn halved(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) { high = middle } else { low = middle }
    }
    high
}

/// Halvings until nothing is left of the digits of an interval.
const HALVINGS: usize = 200;
