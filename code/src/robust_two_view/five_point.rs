//! The motion between two pictures from five points.

use nalgebra::{Matrix3, Rotation3, SVector, Unit, Vector3};
use thiserror::Error;

use super::cubics::{constraints, eliminated};
use super::motion::{RayPair, RelativeMotion, frame, volume_and_row};
use super::{Candidates, real_roots, rotation_of_rays};
use crate::least_squares::Manifold;

/// Five rows of which one is smaller, beside the others, depend on each other.
const DEPENDENT: f64 = 1e-11;
/// Sines of angles that are smaller are rounding.
const SAME: f64 = 1e-9;
/// A root without rounding makes the first step of Newton shorter.
const DISPLACED: f64 = 1e-6;
/// More bases than are ever unlucky.
const MOST_BASES: usize = 5;
/// A longer step leads elsewhere, and the one after a shorter one is rounding.
const LONGEST_STEP: f64 = 1e-2;
const LAST_STEP: f64 = 1e-8;
/// Newton needs one or two.
const MOST_STEPS: usize = 10;

// ANCHOR: five_points
/// All essential matrices, at most ten, for which the rays of five points meet: the five-point
/// method [@nister2004]. Rays may have any length; the matrices have a baseline of one and either
/// sign.
///
/// Every pair of rays gives one linear equation for the nine entries, so E = x E₁ + y E₂ + z E₃ + E₄
/// with four matrices that satisfy all five. A matrix is essential when ten cubic forms in x, y and
/// z vanish. Elimination leaves six equations which are linear in x, y and 1 when z is known; three
/// differences of them form a matrix of polynomials in z, and it is singular where its determinant,
/// of degree ten, is zero. Each of its real roots is a matrix, which is polished by steps of Newton
/// on the five equations, over rotation and direction.
///
/// There may be none when the rays are no pictures of five points.
///
/// # Errors
///
/// [`FivePointError`] names what leaves more than a few matrices.
pub fn five_points(pairs: &[RayPair; 5]) -> Result<Candidates<Matrix3<f64>, 10>, FivePointError> {
    let motions = motions_where(pairs, |motion, _| Some(motion))?;
    let mut found = Candidates::none(Matrix3::zeros());
    motions.iter().for_each(|motion| found.push(motion.essential()));
    Ok(found)
}
// ANCHOR_END: five_points

// ANCHOR: motions_of_five
/// The motions that put all five points in front of both cameras, of [`five_points`].
///
/// # Errors
///
/// Those of [`five_points`].
pub fn motions_of_five(
    pairs: &[RayPair; 5],
) -> Result<Candidates<RelativeMotion, 10>, FivePointError> {
    motions_where(pairs, in_front)
}
// ANCHOR_END: motions_of_five

// ANCHOR: motions_where
/// A motion of each matrix, when `chosen` chooses one of the four, polished.
///
/// Two solutions may happen to have nearly the same z, and rounding then takes them away or
/// displaces them. A displaced one is known by its first step of Newton, and with another basis of
/// the four matrices it has another z.
fn motions_where(
    pairs: &[RayPair; 5],
    chosen: impl Fn(RelativeMotion, &[RayPair; 5]) -> Option<RelativeMotion>,
) -> Result<Candidates<RelativeMotion, 10>, FivePointError> {
    let pairs = unit(pairs)?;
    let mut basis = null_space(&pairs).ok_or_else(|| dependence(&pairs))?;
    if keep_angles(&pairs) {
        return Err(continuum(&pairs));
    }
    let identity = RelativeMotion { rotation: Rotation3::identity(), direction: Vector3::x_axis() };
    let mut best = None;
    let mut least = f64::INFINITY;
    for _ in 0..MOST_BASES {
        if let Some(matrices) = essential_in(&basis) {
            let (mut found, mut longest) = (Candidates::none(identity), 0.0_f64);
            let chosen = |matrix: &Matrix3<f64>| a_motion(matrix).and_then(|m| chosen(m, &pairs));
            for motion in matrices.iter().filter_map(chosen) {
                let (motion, step) = polished(&motion, &pairs);
                longest = longest.max(step);
                found.push(motion);
            }
            if longest < least {
                (best, least) = (Some(found), longest);
            }
        }
        if least < DISPLACED {
            break;
        }
        basis = turned(&basis);
    }
    best.ok_or_else(|| continuum(&pairs))
}

/// Another orthonormal basis of what four matrices span.
fn turned([a, b, c, d]: &[Matrix3<f64>; 4]) -> [Matrix3<f64>; 4] {
    [b + c + d + a, b - c + d - a, b + c - d - a, b - c - d + a].map(|sum| 0.5 * sum)
}
// ANCHOR_END: motions_where

/// The pairs with rays of length one.
fn unit(pairs: &[RayPair; 5]) -> Result<[RayPair; 5], FivePointError> {
    let mut units = *pairs;
    for (pair, rays) in units.iter_mut().enumerate() {
        for ray in [&mut rays.0, &mut rays.1] {
            let length = ray.norm();
            if !(length > 0.0 && length.is_finite()) {
                return Err(FivePointError::Ray { pair });
            }
            *ray /= length;
        }
    }
    Ok(units)
}

// ANCHOR: essential_in
/// The essential matrices among the sums of four, as the roots of the polynomial give them; `None`
/// when the cubic equations depend on each other.
fn essential_in(basis: &[Matrix3<f64>; 4]) -> Option<Candidates<Matrix3<f64>, 10>> {
    let solved = eliminated(constraints(basis))?;
    let rows = [0, 2, 4].map(|first| difference(&solved[first], &solved[first + 1]));
    let mut found = Candidates::none(Matrix3::zeros());
    for &z in real_roots(&determinant(&rows)).iter() {
        let [x, y, w] = null_vector(&[0, 1, 2].map(|row: usize| rows[row].at(z))).into();
        found.push(x * basis[0] + y * basis[1] + w * (z * basis[2] + basis[3]));
    }
    Some(found)
}
// ANCHOR_END: essential_in

// ANCHOR: five_null_space
/// Four orthonormal matrices that satisfy the linear equations of all five pairs, or `None` when
/// there are more: what the reflections that triangulate the equations make of the last four axes.
fn null_space(pairs: &[RayPair; 5]) -> Option<[Matrix3<f64>; 4]> {
    let equation = |(first, second): &RayPair| -> [f64; 9] {
        std::array::from_fn(|k| second[k / 3] * first[k % 3])
    };
    let mut columns: [[f64; 9]; 5] = std::array::from_fn(|pair| equation(&pairs[pair]));
    for step in 0..5 {
        let square = |column: &[f64; 9]| column[step..].iter().map(|x| x * x).sum::<f64>();
        let squares: [f64; 5] = std::array::from_fn(|k| square(&columns[k]));
        let longest = (step..5).max_by(|a, b| squares[*a].total_cmp(&squares[*b]))?;
        columns.swap(step, longest);
        let length = squares[longest].sqrt();
        if length < DEPENDENT {
            return None;
        }
        // The reflection takes the column to the axis `step`; its normal is kept in its place.
        let (done, rest) = columns.split_at_mut(step + 1);
        let normal = &mut done[step];
        normal[step] += length.copysign(normal[step]);
        let scale = (length * normal[step].abs()).sqrt().recip();
        normal[step..].iter_mut().for_each(|entry| *entry *= scale);
        rest.iter_mut().for_each(|column| reflect(column, normal, step));
    }
    Some([5, 6, 7, 8].map(|axis| {
        let mut vector = [0.0; 9];
        vector[axis] = 1.0;
        (0..5).rev().for_each(|step| reflect(&mut vector, &columns[step], step));
        Matrix3::from_row_slice(&vector)
    }))
}

/// Reflects a vector, with a normal of length √2 that begins at `from`.
#[inline(always)]
fn reflect(vector: &mut [f64; 9], normal: &[f64; 9], from: usize) {
    let along: f64 = (from..9).map(|k| vector[k] * normal[k]).sum();
    (from..9).for_each(|k| vector[k] -= along * normal[k]);
}
// ANCHOR_END: five_null_space

/// Polynomials in z, with the lowest power first, that multiply x, y and 1.
struct Row {
    x: [f64; 4],
    y: [f64; 4],
    one: [f64; 5],
}

impl Row {
    fn at(&self, z: f64) -> Vector3<f64> {
        Vector3::new(value(&self.x, z), value(&self.y, z), value(&self.one, z))
    }
}

fn value(polynomial: &[f64], z: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, coefficient| sum * z + coefficient)
}

/// The equation that begins with a product by z, less z times the one without.
fn difference(with: &[f64; 10], without: &[f64; 10]) -> Row {
    let cubic = |at: usize| {
        let (a, b) = (&with[at..at + 3], &without[at..at + 3]);
        [a[2], a[1] - b[2], a[0] - b[1], -b[0]]
    };
    let (a, b) = (&with[6..], &without[6..]);
    let one = [a[3], a[2] - b[3], a[1] - b[2], a[0] - b[1], -b[0]];
    Row { x: cubic(0), y: cubic(3), one }
}

// ANCHOR: five_determinant
// ANCHOR: determinant
/// The determinant of three rows: a polynomial of degree ten.
fn determinant(rows: &[Row; 3]) -> [f64; 11] {
    let mut determinant = [0.0; 11];
    for k in 0..3 {
        let [row, next, last] = [&rows[k], &rows[(k + 1) % 3], &rows[(k + 2) % 3]];
        let mut minor = [0.0; 7];
        add_product(&mut minor, 1.0, &next.x, &last.y);
        add_product(&mut minor, -1.0, &next.y, &last.x);
        add_product(&mut determinant, 1.0, &minor, &row.one);
    }
    determinant
}
// ANCHOR_END: determinant

/// Adds so many times the product of two polynomials.
#[inline(always)]
fn add_product<const A: usize, const B: usize>(
    into: &mut [f64],
    times: f64,
    a: &[f64; A],
    b: &[f64; B],
) {
    for i in 0..A {
        for j in 0..B {
            into[i + j] += times * a[i] * b[j];
        }
    }
}
// ANCHOR_END: five_determinant

/// What is orthogonal to three rows of rank two: the longest of their cross products.
fn null_vector(rows: &[Vector3<f64>; 3]) -> Vector3<f64> {
    let [a, b, c] = rows;
    let (mut longest, mut square) = (Vector3::zeros(), 0.0);
    for product in [a.cross(b), b.cross(c), c.cross(a)] {
        let its_square = product.norm_squared();
        if its_square > square {
            (longest, square) = (product, its_square);
        }
    }
    longest / square.sqrt()
}

// ANCHOR: a_motion
/// One of the four motions of an essential matrix E; `None` when it is not finite.
///
/// The cross products of its columns are multiples of the baseline t, of which the longest is taken,
/// and the rotation is the matrix of all three of them less t^ E {eq:essential-poses}.
fn a_motion(essential: &Matrix3<f64>) -> Option<RelativeMotion> {
    let scaled = essential * (2.0 / essential.norm_squared()).sqrt();
    let [a, b, c] = [0, 1, 2].map(|column| scaled.column(column).into_owned());
    let products = [b.cross(&c), c.cross(&a), a.cross(&b)];
    let squares = products.map(|product| product.norm_squared());
    let longest = if squares[0] > squares[1] { 0 } else { 1 };
    let longest = if squares[longest] > squares[2] { longest } else { 2 };
    let direction = products[longest] / squares[longest].sqrt();
    let matrix = frame(&(products[0] - direction.cross(&a)), &(products[1] - direction.cross(&b)));
    let rotation = Rotation3::from_matrix_unchecked(matrix);
    let motion = RelativeMotion { rotation, direction: Unit::new_unchecked(direction) };
    (matrix.sum() + direction.sum()).is_finite().then_some(motion)
}
// ANCHOR_END: a_motion

// ANCHOR: in_front
/// The one of the four motions with the same essential matrix that puts all points in front.
fn in_front(motion: RelativeMotion, pairs: &[RayPair; 5]) -> Option<RelativeMotion> {
    let t = motion.direction;
    let half_turn = 2.0 * t.as_ref() * t.transpose() - Matrix3::identity();
    let turned = || Rotation3::from_matrix_unchecked(half_turn * motion.rotation.matrix());
    [false, true].into_iter().find_map(|other| {
        let rotation = if other { turned() } else { motion.rotation };
        let motion = RelativeMotion { rotation, direction: t };
        let (first, second) = depth_signs(&motion, &pairs[0]);
        let direction = if first < 0.0 { -t } else { t };
        let motion = RelativeMotion { rotation, direction };
        let is_in_front = |pair: &RayPair| {
            let (first, second) = depth_signs(&motion, pair);
            first > 0.0 && second > 0.0
        };
        (first * second > 0.0 && pairs.iter().all(is_in_front)).then_some(motion)
    })
}

/// Two numbers with the signs of the depths at which two rays come nearest to each other.
pub(super) fn depth_signs(motion: &RelativeMotion, (first, second): &RayPair) -> (f64, f64) {
    let turned = motion.rotation * first;
    let normal = turned.cross(second);
    (normal.dot(&second.cross(&motion.direction)), normal.dot(&turned.cross(&motion.direction)))
}
// ANCHOR_END: in_front

// ANCHOR: polished
/// The motion for which the five volumes vanish, by steps of Newton for as long as they become
/// shorter, and the length of the first.
fn polished(start: &RelativeMotion, pairs: &[RayPair; 5]) -> (RelativeMotion, f64) {
    let mut motion = *start;
    let (mut first, mut last) = (None, LONGEST_STEP);
    for _ in 0..MOST_STEPS {
        let by_step = motion.direction_by_step();
        let equations = pairs.map(|pair| {
            let (volume, row) = volume_and_row(&motion, &by_step, &pair);
            [row[0], row[1], row[2], row[3], row[4], -volume]
        });
        let step = SVector::from(solved(equations));
        let length = step.norm();
        first = first.or(Some(length));
        let is_shorter = length < last;
        if !is_shorter {
            break;
        }
        motion = motion.retract(step.as_slice());
        last = length;
        if length < LAST_STEP {
            break;
        }
    }
    (motion, first.filter(|length| length.is_finite()).unwrap_or(f64::MAX))
}
// ANCHOR_END: polished

/// The solution of five equations, each with its right side at the end; not finite when there is none.
fn solved(mut equations: [[f64; 6]; 5]) -> [f64; 5] {
    for column in 0..5 {
        let size = |row: &usize| equations[*row][column].abs();
        let pivot = (column..5).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(column);
        equations.swap(column, pivot);
        let from = equations[column];
        for row in &mut equations[column + 1..] {
            let times = row[column] / from[column];
            (column + 1..6).for_each(|k| row[k] -= times * from[k]);
        }
    }
    let mut solution = [0.0; 5];
    for row in (0..5).rev() {
        let known: f64 = (row + 1..5).map(|k| equations[row][k] * solution[k]).sum();
        solution[row] = (equations[row][5] - known) / equations[row][row];
    }
    solution
}

/// Why the five equations depend on each other.
fn dependence(pairs: &[RayPair; 5]) -> FivePointError {
    let is_same = |a: &Vector3<f64>, b: &Vector3<f64>| a.cross(b).norm() < SAME;
    for second in 1..5 {
        for first in 0..second {
            let (a, b) = (&pairs[first], &pairs[second]);
            if is_same(&a.0, &b.0) && is_same(&a.1, &b.1) {
                return FivePointError::Repeated { first, second };
            }
        }
    }
    let on_line = |left_out: usize| {
        let kept: Vec<_> = (0..5).filter(|k| *k != left_out).map(|k| pairs[k]).collect();
        let is_flat = |rays: [Vector3<f64>; 3]| rays[0].cross(&rays[1]).dot(&rays[2]).abs() < SAME;
        let triples = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
        triples
            .iter()
            .all(|triple| is_flat(triple.map(|k| kept[k].0)) && is_flat(triple.map(|k| kept[k].1)))
    };
    match (0..5).find(|left_out| on_line(*left_out)) {
        Some(_) => FivePointError::Collinear,
        None => FivePointError::Dependent,
    }
}

/// Whether the rays enclose the same angles in both pictures, as when the camera only turned.
fn keep_angles(pairs: &[RayPair; 5]) -> bool {
    let mut couples = (1..5).flat_map(|b| (0..b).map(move |a| (&pairs[a], &pairs[b])));
    couples.all(|(a, b)| (a.0.dot(&b.0) - a.1.dot(&b.1)).abs() < SAME)
}

/// Why the cubic equations have more than a few solutions.
fn continuum(pairs: &[RayPair; 5]) -> FivePointError {
    let turned = rotation_of_rays(pairs);
    let is_turned = |rotation: Rotation3<f64>| {
        pairs.iter().all(|(first, second)| (rotation * first).cross(second).norm() < SAME)
    };
    if turned.is_some_and(is_turned) {
        FivePointError::PureRotation
    } else {
        FivePointError::Continuum
    }
}

/// Why five pairs of rays have no essential matrices that could be listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum FivePointError {
    /// A ray is zero or not finite.
    #[error("pair {pair}: a ray is zero or not finite; leave the pair out")]
    Ray {
        /// Which pair.
        pair: usize,
    },
    /// Two pairs are the same.
    #[error("pairs {first} and {second} are the same; give five different points")]
    Repeated {
        /// One of them.
        first: usize,
        /// The other one.
        second: usize,
    },
    /// Four of the points lie on a line, and the fourth says nothing that three did not say.
    #[error("four of the points lie on one line; three of a line say all that it can")]
    Collinear,
    /// The equations depend on each other in another way.
    #[error("the five equations depend on each other; give points that are farther apart")]
    Dependent,
    /// Every direction of the baseline satisfies the equations.
    #[error(
        "the second picture is the first one, turned; a pure rotation has no baseline: wait until \
         the camera has moved"
    )]
    PureRotation,
    /// Points and centres lie so that essential matrices satisfy the equations all along a curve.
    #[error("more than ten motions fit the five points, which lie on a critical surface")]
    Continuum,
}
