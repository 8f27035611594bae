//! Rows of the Jacobian that depend on landmarks, and what is left of them when a landmark has
//! explained what it can.

use std::array;

use nalgebra::{Matrix3, Vector3};

use super::blocks::{add_multiple, add_product, first_mut, multiply_add};
use super::linearized::Linearized;
use super::structure::{OnBorder, Run, Structure};

/// Rows of the Jacobian that depend on landmarks, in the order of the structure.
#[derive(Debug, Clone)]
pub struct Rows<const D: usize, const C: usize> {
    pub residual: Vec<f64>,
    /// Derivatives by the landmark.
    pub landmark: Vec<[f64; 3]>,
    /// Derivatives by the other variable. They have no meaning where that is held.
    pub variable: Vec<[f64; C]>,
    /// Derivatives by the variables of the border, if there are any.
    pub border: Vec<[f64; D]>,
}

impl<const D: usize, const C: usize> Rows<D, C> {
    /// Takes linearized factors as the rows of a run.
    #[inline(always)]
    pub fn take(&mut self, run: &Run, linear: &Linearized, structure: &Structure) {
        let (range, places) = (run.rows.clone(), structure.places[run.group]);
        self.residual[range.clone()].copy_from_slice(linear.residuals());
        self.landmark[range.clone()].copy_from_slice(linear.rows_of(places.landmark));
        let other = places.other.map_or(&[][..], |slot| linear.rows_of(slot));
        // What is held may have another dimension.
        if other.len() == range.len() {
            self.variable[range.clone()].copy_from_slice(other);
        }
        if !run.on_border.is_empty() {
            let rows = &mut self.border[range];
            rows.fill([0.0; D]);
            take_border(rows, linear, &structure.on_border[run.on_border.clone()]);
        }
    }
}

/// Adds the derivatives by variables of the border to its rows.
fn take_border<const D: usize>(rows: &mut [[f64; D]], linear: &Linearized, on_border: &[OnBorder]) {
    for &OnBorder { factor, slot, first } in on_border {
        let (each, columns) = (linear.rows(), linear.columns(slot));
        let slopes = linear.jacobian(slot)[factor * each * columns..].chunks_exact(columns);
        for (row, slopes) in rows[factor * each..][..each].iter_mut().zip(slopes) {
            row[first..].iter_mut().zip(slopes).for_each(|(entry, slope)| *entry += slope);
        }
    }
}

/// The rows J and Q of a variable.
pub type Own<'a, const N: usize> = (&'a [[f64; N]], &'a [[f64; 3]]);

/// The product Qᵀ J of the rows of a variable: what motions of the landmark explain.
#[inline(always)]
pub fn explained<const N: usize>((slopes, whitened): Own<N>) -> [[f64; N]; 3] {
    let mut explained = [[0.0; N]; 3];
    for (slope, whitened) in slopes.iter().zip(whitened) {
        for (row, whitened) in explained.iter_mut().zip(whitened) {
            add_multiple(row, *whitened, slope);
        }
    }
    explained
}

/// Adds to a right-hand side what motions of the landmark explain of it.
#[inline(always)]
pub fn add_forward<const D: usize, const N: usize>(
    rhs: &mut [f64; D],
    forward: Vector3<f64>,
    explained: &[[f64; N]; 3],
) {
    forward.iter().zip(explained).for_each(|(f, row)| add_multiple(first_mut(rhs), *f, row));
}

/// Adds Jᵀ (δ I − Q Q'ᵀ) J' to the block of two variables, of which the first is given by its
/// Qᵀ J and by what δ leaves of J: its rows that are those of the second too.
#[inline(always)]
pub fn add_pair<const D: usize, const N: usize, const M: usize>(
    block: &mut [[f64; D]; D],
    explained: &[[f64; N]; 3],
    shared: Option<&[[f64; N]]>,
    (slopes, whitened): Own<M>,
) {
    // Pixels have two rows; a number that is known when compiling keeps the sums in registers.
    if let (Some(slopes), Some(whitened)) = (slopes.as_array::<2>(), whitened.as_array()) {
        let shared = shared.map(|shared| shared.as_array().expect("as many as slopes"));
        return add_rows(block, explained, shared, slopes, whitened);
    }
    for (row, (slope, whitened)) in slopes.iter().zip(whitened).enumerate() {
        let shared = shared.map(|shared| array::from_ref(&shared[row]));
        add_rows(block, explained, shared, array::from_ref(slope), array::from_ref(whitened));
    }
}

#[inline(always)]
// ANCHOR: add_pair
fn add_rows<const D: usize, const N: usize, const M: usize, const ROWS: usize>(
    block: &mut [[f64; D]; D],
    explained: &[[f64; N]; 3],
    shared: Option<&[[f64; N]; ROWS]>,
    slopes: &[[f64; M]; ROWS],
    whitened: &[[f64; 3]; ROWS],
) {
    let mut unexplained = shared.copied().unwrap_or([[0.0; N]; ROWS]);
    for (row, whitened) in unexplained.iter_mut().zip(whitened) {
        for (whitened, explained) in whitened.iter().zip(explained) {
            add_multiple(row, -whitened, explained);
        }
    }
    add_product(block, 1.0, &unexplained, slopes);
}
// ANCHOR_END: add_pair

/// Adds rows to the gradient and to the diagonal of the Hessian.
#[inline(always)]
pub fn add_gradient<const D: usize, const N: usize>(
    gradient: &mut [f64; D],
    curvature: &mut [f64; D],
    rows: &[[f64; N]],
    residuals: &[f64],
) {
    let (gradient, curvature) = (first_mut::<D, N>(gradient), first_mut::<D, N>(curvature));
    let mut sums = (*gradient, *curvature);
    for (row, residual) in rows.iter().zip(residuals) {
        add_multiple(&mut sums.0, *residual, row);
        (0..N).for_each(|axis| sums.1[axis] = multiply_add(row[axis], row[axis], sums.1[axis]));
    }
    (*gradient, *curvature) = sums;
}

// ANCHOR: landmark_block
/// The lower triangle of a landmark's 3×3 block, and its gradient, from the rows that depend on it.
///
/// Implements the middle line of {eq:ba-blocks}.
#[inline(always)]
pub fn landmark_block(slopes: &[[f64; 3]], residuals: &[f64]) -> (Matrix3<f64>, Vector3<f64>) {
    let (mut block, mut gradient) = (Matrix3::zeros(), Vector3::zeros());
    for (slope, residual) in slopes.iter().zip(residuals) {
        for column in 0..3 {
            gradient[column] = multiply_add(slope[column], *residual, gradient[column]);
            for below in column..3 {
                let sum = multiply_add(slope[column], slope[below], block[(below, column)]);
                block[(below, column)] = sum;
            }
        }
    }
    (block, gradient)
}
// ANCHOR_END: landmark_block

// ANCHOR: inverse_factor
/// The lower triangular M with M H Mᵀ = I, the inverse of the Cholesky factor of a 3×3
/// matrix H of which the lower triangle is read. `None` when a pivot is not above
/// `smallest` times its place on the diagonal.
#[inline(always)]
pub fn inverse_factor(h: &Matrix3<f64>, smallest: f64) -> Option<Matrix3<f64>> {
    let m11 = 1.0 / h.m11.sqrt();
    let (l21, l31) = (m11 * h.m21, m11 * h.m31);
    let second = h.m22 - l21 * l21;
    let m22 = 1.0 / second.sqrt();
    let l32 = m22 * (h.m32 - l31 * l21);
    let third = h.m33 - l31 * l31 - l32 * l32;
    let m33 = 1.0 / third.sqrt();
    let regular = h.m11 > 0.0 && second > smallest * h.m22 && third > smallest * h.m33;
    let m21 = -m22 * l21 * m11;
    let m31 = -m33 * (l31 * m11 + l32 * m21);
    let m32 = -m33 * l32 * m22;
    regular.then(|| Matrix3::new(m11, 0.0, 0.0, m21, m22, 0.0, m31, m32, m33))
}
// ANCHOR_END: inverse_factor
