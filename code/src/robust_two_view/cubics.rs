//! The ten cubic equations of an essential matrix in the span of four matrices.

use nalgebra::Matrix3;

/// A linear form in x, y, z and 1.
type Linear = [f64; 4];
/// A quadratic form: xx, xy, yy, xz, yz, zz, x, y, z, 1.
type Quadratic = [f64; 10];

// ANCHOR: cubic
/// A cubic form. Its monomials stand in the order of @nister2004: xxx, yyy, xxy, xyy, xxz, xx, yyz,
/// yy, xyz, xy, which are eliminated, and xzz, xz, x, yzz, yz, y, zzz, zz, z, 1.
pub(super) type Cubic = [f64; 20];
// ANCHOR_END: cubic

/// Where the product of two monomials of linear forms stands.
const IN_QUADRATIC: [[usize; 4]; 4] = [[0, 1, 3, 6], [1, 2, 4, 7], [3, 4, 5, 8], [6, 7, 8, 9]];

/// Where the product of a monomial of a quadratic form and one of a linear form stands.
const IN_CUBIC: [[usize; 4]; 10] = [
    [0, 2, 4, 5],
    [2, 3, 8, 9],
    [3, 1, 6, 7],
    [4, 8, 10, 11],
    [8, 6, 13, 14],
    [10, 13, 16, 17],
    [5, 9, 11, 12],
    [9, 7, 14, 15],
    [11, 14, 17, 18],
    [12, 15, 18, 19],
];

/// Adds so many times the product.
#[inline(always)]
fn add_square(into: &mut Quadratic, times: f64, a: &Linear, b: &Linear) {
    for i in 0..4 {
        for j in 0..4 {
            into[IN_QUADRATIC[i][j]] += times * a[i] * b[j];
        }
    }
}

#[inline(always)]
fn add_cube(into: &mut Cubic, a: &Quadratic, b: &Linear) {
    for i in 0..10 {
        for j in 0..4 {
            into[IN_CUBIC[i][j]] += a[i] * b[j];
        }
    }
}

// ANCHOR: cubics
/// What vanishes when E = x E₁ + y E₂ + z E₃ + E₄ is essential: its determinant, and the nine entries
/// of E Eᵀ E − ½ tr(E Eᵀ) E, which says that its two singular values are equal.
pub(super) fn constraints(basis: &[Matrix3<f64>; 4]) -> [Cubic; 10] {
    let entry = |row, column| basis.map(|matrix| matrix[(row, column)]);
    let e: [[Linear; 3]; 3] =
        std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column)));
    let mut cubics = [[0.0; 20]; 10];
    let gram = half_trace_removed(&e);
    for row in 0..3 {
        for column in 0..3 {
            let cubic = &mut cubics[3 * row + column];
            for k in 0..3 {
                add_cube(cubic, &gram[row][k], &e[k][column]);
            }
        }
    }
    for k in 0..3 {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        let mut minor = [0.0; 10];
        add_square(&mut minor, 1.0, &e[1][next], &e[2][last]);
        add_square(&mut minor, -1.0, &e[1][last], &e[2][next]);
        add_cube(&mut cubics[9], &minor, &e[0][k]);
    }
    cubics
}
// ANCHOR_END: cubics

/// The symmetric matrix E Eᵀ − ½ tr(E Eᵀ).
fn half_trace_removed(e: &[[Linear; 3]; 3]) -> [[Quadratic; 3]; 3] {
    let mut gram = [[[0.0; 10]; 3]; 3];
    for row in 0..3 {
        for column in row..3 {
            for (a, b) in e[row].iter().zip(&e[column]) {
                add_square(&mut gram[row][column], 1.0, a, b);
            }
            gram[column][row] = gram[row][column];
        }
    }
    let trace: Quadratic =
        std::array::from_fn(|monomial| (0..3).map(|row| gram[row][row][monomial]).sum());
    for (row, entries) in gram.iter_mut().enumerate() {
        entries[row].iter_mut().zip(&trace).for_each(|(entry, trace)| *entry -= 0.5 * trace);
    }
    gram
}

/// A pivot that is smaller beside the first is rounding.
const LEAST_PIVOT: f64 = 1e-13;

// ANCHOR: eliminate_cubics
/// The coefficients of the last ten monomials in the equations xxz + … = 0, and so on for xx, yyz, yy, xyz and xy, after
/// the first ten have been eliminated by rows; `None` when those depend on each other.
pub(super) fn eliminated(mut rows: [Cubic; 10]) -> Option<[[f64; 10]; 6]> {
    for column in 0..10 {
        let size = |row: &usize| rows[*row][column].abs();
        let pivot = (column..10).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        rows.swap(column, pivot);
        let is_determined = rows[column][column].abs() > LEAST_PIVOT * rows[0][0].abs();
        if !is_determined {
            return None;
        }
        let (above, below) = rows.split_at_mut(column + 1);
        let from = &above[column];
        for row in below {
            let times = row[column] / from[column];
            for k in column + 1..20 {
                row[k] -= times * from[k];
            }
        }
    }
    let mut solved = [[0.0; 10]; 6];
    for row in (4..10).rev() {
        let mut right: [f64; 10] = std::array::from_fn(|k| rows[row][10 + k]);
        for other in row + 1..10 {
            let times = rows[row][other];
            (0..10).for_each(|k| right[k] -= times * solved[other - 4][k]);
        }
        solved[row - 4] = right.map(|value| value / rows[row][row]);
    }
    Some(solved)
}
// ANCHOR_END: eliminate_cubics
