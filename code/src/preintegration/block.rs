//! Matrices of three by three whose columns fill a register.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

use nalgebra::{Matrix3, Vector3};

// ANCHOR: block
/// A 3×3 matrix by columns. Each has a fourth entry that means nothing, so that a processor
/// that works on two or four numbers at once loads and stores whole columns.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(32))]
pub struct Block([[f64; 4]; 3]);
// ANCHOR_END: block

impl Block {
    #[inline(always)]
    pub fn of(m: &Matrix3<f64>) -> Self {
        Self(from_fn(|k| [m[(0, k)], m[(1, k)], m[(2, k)], 0.0]))
    }

    pub fn diagonal(value: f64) -> Self {
        Self([[value, 0.0, 0.0, 0.0], [0.0, value, 0.0, 0.0], [0.0, 0.0, value, 0.0]])
    }

    #[inline(always)]
    pub fn matrix(&self) -> Matrix3<f64> {
        Matrix3::from_fn(|row, column| self.0[column][row])
    }

    #[inline(always)]
    pub fn transpose(&self) -> Self {
        let [a, b, c] = &self.0;
        Self([[a[0], b[0], c[0], 0.0], [a[1], b[1], c[1], 0.0], [a[2], b[2], c[2], 0.0]])
    }

    /// The matrix c^ of the cross product.
    #[inline(always)]
    pub fn hat(c: &Vector3<f64>) -> Self {
        Self([[0.0, c.z, -c.y, 0.0], [-c.z, 0.0, c.x, 0.0], [c.y, -c.x, 0.0, 0.0]])
    }

    // ANCHOR: times_hat
    /// The matrix times c^, without the products by zeros.
    #[inline(always)]
    pub fn times_hat(&self, c: &Vector3<f64>) -> Self {
        let [x, y, z] = &self.0;
        Self([
            from_fn(|i| c.z * y[i] - c.y * z[i]),
            from_fn(|i| c.x * z[i] - c.z * x[i]),
            from_fn(|i| c.y * x[i] - c.x * y[i]),
        ])
    }
    // ANCHOR_END: times_hat

    /// The matrix times a diagonal one times the transpose of another one: the second moment of
    /// what two matrices make of the same noise, independent along its axes.
    #[inline(always)]
    pub fn moment(&self, variances: &Vector3<f64>, other: &Self) -> Self {
        let [x, y, z] = &self.0;
        let v = variances;
        let scaled = [x.map(|e| v.x * e), y.map(|e| v.y * e), z.map(|e| v.z * e)];
        Self(scaled) * other.transpose()
    }
}

impl Add for Block {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(from_fn(|k| from_fn(|i| self.0[k][i] + other.0[k][i])))
    }
}

impl Sub for Block {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(from_fn(|k| from_fn(|i| self.0[k][i] - other.0[k][i])))
    }
}

impl Mul<Block> for f64 {
    type Output = Block;

    #[inline(always)]
    fn mul(self, block: Block) -> Block {
        Block(from_fn(|k| from_fn(|i| self * block.0[k][i])))
    }
}

impl Mul<Vector3<f64>> for Block {
    type Output = Vector3<f64>;

    #[inline(always)]
    fn mul(self, v: Vector3<f64>) -> Vector3<f64> {
        let [x, y, z] = &self.0;
        Vector3::from_fn(|i, _| x[i] * v.x + y[i] * v.y + z[i] * v.z)
    }
}

impl Mul for Block {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let [x, y, z] = &self.0;
        Self(from_fn(|k| {
            let [a, b, c, _] = other.0[k];
            from_fn(|i| a * x[i] + b * y[i] + c * z[i])
        }))
    }
}
