//! The pose of a camera from three points.

use nalgebra::{Isometry3, Matrix3, Rotation3, Vector3};
use thiserror::Error;

use crate::robust_two_view::{Candidates, frame, real_roots};
use crate::two_views::cofactors;

/// Sines that are smaller are rounding.
const FLAT: f64 = 1e-10;
/// Newton needs one or two, from roots of a cubic.
const STEPS: usize = 3;

// ANCHOR: poses_of_three
/// The poses `camera_from_world`, at most four, from which three points of the world are seen in the
/// given directions, of any length: resection from three points, by way of the degenerate conic
/// [@persson2018].
///
/// The distances λ of the points satisfy three quadratic equations, one for each side of the
/// triangle: λᵢ² + λⱼ² − 2 cos θᵢⱼ λᵢ λⱼ is its square. Two combinations of them have zero on the right:
/// they are two conics, in the plane of the ratios of the λ. Among the sums of the two there is one
/// that consists of two lines, found by a cubic equation, and where those meet a conic are the
/// solutions. They are polished by steps of Newton on the three equations.
///
/// # Errors
///
/// [`ThreePointError`] names what leaves more than a few.
// ANCHOR: three_point_poses
pub fn poses_of_three(
    points: &[Vector3<f64>; 3],
    directions: &[Vector3<f64>; 3],
) -> Result<Candidates<Isometry3<f64>, 4>, ThreePointError> {
    let triangle = Triangle::new(points, directions)?;
    let mut poses = Candidates::none(Isometry3::identity());
    for distances in triangle.distances().iter() {
        let distances = triangle.polished(*distances);
        let seen = [0, 1, 2].map(|k| distances[k] * triangle.rays[k]);
        poses.push(laid_upon(points, &seen));
    }
    Ok(poses)
}
// ANCHOR_END: three_point_poses
// ANCHOR_END: poses_of_three

/// Two of three corners, and the third.
const SIDES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// Three points and the directions in which they are seen.
struct Triangle {
    rays: [Vector3<f64>; 3],
    /// The cosines of the angles between rays, and the squares of the sides.
    cosines: [f64; 3],
    squares: [f64; 3],
}

impl Triangle {
    fn new(
        points: &[Vector3<f64>; 3],
        directions: &[Vector3<f64>; 3],
    ) -> Result<Self, ThreePointError> {
        for (point, (place, direction)) in points.iter().zip(directions).enumerate() {
            let length = direction.norm();
            let is_finite = place.iter().all(|entry| entry.is_finite());
            if !(is_finite && length > 0.0 && length.is_finite()) {
                return Err(ThreePointError::NotFinite { point });
            }
        }
        let rays = directions.map(|direction| direction.normalize());
        let sides = SIDES.map(|(a, b)| points[a] - points[b]);
        let longest = sides.iter().map(Vector3::norm).fold(0.0, f64::max);
        if sides[0].cross(&sides[1]).norm() <= FLAT * longest * longest {
            return Err(ThreePointError::Collinear);
        }
        if let Some(side) = SIDES.iter().position(|(a, b)| rays[*a].cross(&rays[*b]).norm() <= FLAT)
        {
            let (first, second) = SIDES[side];
            return Err(ThreePointError::SameDirection { first, second });
        }
        let cosines = SIDES.map(|(a, b)| rays[a].dot(&rays[b]));
        Ok(Self { rays, cosines, squares: sides.map(|side| side.norm_squared()) })
    }

    /// The matrix M of a side, so that λᵀ M λ is its square.
    fn side(&self, side: usize) -> Matrix3<f64> {
        let (a, b) = SIDES[side];
        let mut matrix = Matrix3::zeros();
        (matrix[(a, a)], matrix[(b, b)]) = (1.0, 1.0);
        (matrix[(a, b)], matrix[(b, a)]) = (-self.cosines[side], -self.cosines[side]);
        matrix
    }

    // ANCHOR: distances
    /// The distances of the points in front.
    fn distances(&self) -> Candidates<Vector3<f64>, 4> {
        let conic =
            |side: usize| self.squares[0] * self.side(side) - self.squares[side] * self.side(0);
        let conics = [conic(1), conic(2)];
        let mut found = Candidates::none(Vector3::zeros());
        for line in lines(&conics).unwrap_or_default() {
            for ratios in on_line(&line, &conics).into_iter().flatten() {
                let side = if self.squares[0] > self.squares[1] { 0 } else { 1 };
                let scale = (self.squares[side] / ratios.dot(&(self.side(side) * ratios))).sqrt();
                let distances = ratios * scale.copysign(ratios.sum());
                if distances.iter().all(|distance| *distance > 0.0 && distance.is_finite()) {
                    found.push(distances);
                }
            }
        }
        found
    }
    // ANCHOR_END: distances

    /// The distances after steps of Newton.
    fn polished(&self, start: Vector3<f64>) -> Vector3<f64> {
        let mut distances = start;
        for _ in 0..STEPS {
            let rows = [0, 1, 2].map(|side| (self.side(side) * distances).transpose());
            let off = Vector3::from_fn(|side, _| {
                rows[side].dot(&distances.transpose()) - self.squares[side]
            });
            let Some(inverse) = (2.0 * Matrix3::from_rows(&rows)).try_inverse() else { break };
            let step = inverse * off;
            // A step as long as this does not come from rounding.
            let is_short = step.norm() < 1e-2 * distances.norm();
            if !is_short {
                break;
            }
            distances -= step;
        }
        distances
    }
}

// ANCHOR: degenerate_conic
/// The two lines of a sum of two conics that is degenerate: of D₁ + γ D₂ with det = 0, or D₂ itself.
fn lines(conics: &[Matrix3<f64>; 2]) -> Option<[Vector3<f64>; 2]> {
    let [d1, d2] = conics;
    let mixed = |a: &Matrix3<f64>, b: &Matrix3<f64>| cofactors(a).component_mul(b).sum();
    let cubic = [d1.determinant(), mixed(d1, d2), mixed(d2, d1), d2.determinant()];
    let roots = real_roots(&cubic);
    let degenerate = roots.iter().map(|gamma| d1 + *gamma * d2).chain([*d2]);
    degenerate.into_iter().find_map(|conic| split(&conic))
}

/// The lines l and m of a conic l mᵀ + m lᵀ, when they are real. The point p = l × m in which they meet
/// has p pᵀ for minus the cofactors, and adding p^ leaves one of the two products.
fn split(conic: &Matrix3<f64>) -> Option<[Vector3<f64>; 2]> {
    let squares = -cofactors(conic);
    let at = squares.diagonal().imax();
    let root = squares[(at, at)].sqrt();
    let point = squares.column(at) / root;
    let product = conic + point.cross_matrix();
    let (row, column) = product.iamax_full();
    let lines = [product.column(column).into_owned(), product.row(row).transpose()];
    let is_finite = |line: &Vector3<f64>| line.iter().all(|entry| entry.is_finite());
    (root > 0.0 && lines.iter().all(is_finite)).then_some(lines)
}
// ANCHOR_END: degenerate_conic

/// The two places of a line that lie on the conics, if it meets them.
fn on_line(line: &Vector3<f64>, conics: &[Matrix3<f64>; 2]) -> Option<[Vector3<f64>; 2]> {
    let axis = Vector3::ith(line.map(f64::abs).imin(), 1.0);
    let u = line.cross(&axis).normalize();
    let v = line.cross(&u).normalize();
    let forms = conics.map(|conic| {
        let (to_u, to_v) = (conic * u, conic * v);
        Vector3::new(u.dot(&to_u), u.dot(&to_v), v.dot(&to_v))
    });
    // The one that is degenerate itself vanishes all along the line.
    let relative = |at: usize| forms[at].amax() / conics[at].amax();
    let form = forms[if relative(0) > relative(1) { 0 } else { 1 }];
    let (a, b, c) = (form.x, form.y, form.z);
    let discriminant = b * b - a * c;
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    // The roots of a s² + 2 b s + c as two ratios, neither of which subtracts what is nearly the same.
    let larger = -(b + discriminant.sqrt().copysign(b));
    Some([larger * u + a * v, c * u + larger * v])
}

/// The motion that takes one triangle to another with the same sides.
fn laid_upon(from: &[Vector3<f64>; 3], to: &[Vector3<f64>; 3]) -> Isometry3<f64> {
    let sides =
        |corners: &[Vector3<f64>; 3]| frame(&(corners[1] - corners[0]), &(corners[2] - corners[0]));
    let rotation = Rotation3::from_matrix_unchecked(sides(to) * sides(from).transpose());
    let centre = |corners: &[Vector3<f64>; 3]| corners.iter().sum::<Vector3<f64>>() / 3.0;
    let translation = centre(to) - rotation * centre(from);
    Isometry3::from_parts(translation.into(), rotation.into())
}

/// Why three points give no poses that could be listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ThreePointError {
    /// A point or direction is not finite, or a direction is zero.
    #[error(
        "point {point}: its place or direction is not finite, or its direction is zero; leave it out"
    )]
    NotFinite {
        /// Which of the three.
        point: usize,
    },
    /// The points lie on a line.
    #[error("the three points lie on one line; the camera can turn about it: give others")]
    Collinear,
    /// Two points are seen in one direction.
    #[error("points {first} and {second} are seen in one direction; give others")]
    SameDirection {
        /// One of them.
        first: usize,
        /// The other one.
        second: usize,
    },
}
