//! What is asked about an answer, and on which instances.

use nalgebra::{DMatrix, DVector, Isometry3, Point3, SMatrix, Vector2, Vector3, Vector6};
use vislam::manifold::se3;
use vislam::two_views::StereoPinhole;

use super::*;
use crate::Exercise;
use crate::answer::Transport;
use crate::check::{Check, Failure, Misconception, compare, compare_list, readable, told_apart};
use crate::draw::Draw;
use crate::picture::{Dots, Picture};

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "stereo_gauge",
    title: "The gauge of stereo bundle adjustment",
    chapter: "bundle_adjustment",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Camera", "Scene"],
    forbidden: &[
        "bal",
        "bundle_adjustment",
        "factors",
        "least_squares",
        "observability",
        "simulation",
        "two_views",
    ],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    BASELINE_SIGN, "baseline_sign":
        "The right camera has come to stand on the left. Take the centre of the right camera: where \
         is it in the left one, and where in its own?";
    BASELINE_IN_WORLD, "baseline_in_world":
        "The right camera stands along the x axis of the world. What happens to the pair when the \
         rig turns?";
    ADJOINT_FORGOTTEN, "adjoint_forgotten":
        "These are the derivatives by a twist of the right camera's own pose. When the rig turns \
         about the left camera, does the right one only turn?";
    ADJOINT_INVERTED, "adjoint_inverted":
        "The twist of the left camera was carried to the right one the wrong way round. \
         T exp(ξ) = exp(η) T: which transform stands for T, the one to the right camera or back?";
    TWIST_ON_THE_RIGHT, "twist_on_the_right":
        "These are the derivatives by a twist on the right of the pose, T exp(ξ), as the library has \
         them. Here it stands on the left, in the axes of the rig: what leads from one to the other?";
    LEFT_PIXEL, "left_pixel":
        "These are the derivatives of the pixel in the left camera. What is in the right camera, \
         and at which coordinates is the point there?";
    FREE_RIGHT_CAMERA, "free_right_camera":
        "S has twelve rows for a rig, so its cameras may move apart. How many numbers say where two \
         cameras are that are bolted together?";
    POINTS_NAILED, "points_nailed":
        "This is the block of the cameras alone. It says how stiff they are while no point may move: \
         what is left when every point gives way as well as it can?";
    POINTS_LEFT_IN, "points_left_in":
        "S has rows for the points. It is the whole Hessian: what did eliminating them mean?";
    COUPLING_ADDED, "coupling_added":
        "What the points take off has been added. Does a rig become stiffer or softer when the points \
         that it sees may give way?";
    HELD_IS_BLIND, "held_is_blind":
        "Rig 0 was held and its pixels were dropped. Something that cannot move still measures: which \
         of its blocks remain?";
    STILL_FREE, "still_free":
        "Rig 0 was to be held, and S has six rows for it. What does a column mean for something \
         that cannot move?";
    UNWHITENED, "unwhitened":
        "S is in the square of pixels. A residual counts standard deviations: by what was each to be \
         divided, and how often does that enter S?";
    SECOND_LENS_UNUSED, "second_lens_unused":
        "This is S of the left cameras alone, and a baseline was given. What else was seen?";
    ROW_LEFT_OUT, "row_left_out":
        "In the right camera the column was used and the row was not. Both were measured: what does \
         the second measurement of one row tell that the first does not?";
    UNITS_MIXED, "units_mixed":
        "These are the eigenvalues of S as it stands, with metres beside radians. Would they be the \
         same in millimetres?";
    UNITS_SQUARED, "units_squared":
        "Each entry was divided by the product of two entries of the diagonal. What does that make \
         of the diagonal itself?";
    DESCENDING, "descending":
        "The numbers are right, and the greatest comes first.";
    OPPOSITE_MOTION, "opposite_motion":
        "The signs are opposite. The points go from P to exp(s e) P, and the camera coordinates stay: \
         what has to stand to the right of T to undo what was done to the point?";
    SAME_FOR_ALL, "same_for_all":
        "All rigs have the same twist. That is so for twists on the right of the poses, in the axes \
         of the world. In whose axes is a twist on the left, and do all rigs share them?";
}

/// A scene with a baseline.
#[derive(Debug, Clone)]
pub struct Case {
    /// The rigs and the points.
    pub scene: Scene,
    /// From each left camera to its right one, in metres.
    pub baseline: f64,
}

/// How a rig's two cameras, left and right, move with a twist; or would, if it were done wrongly.
type Rig<'a> = &'a dyn Fn(&Isometry3<f64>, f64, &Vector6<f64>) -> [Isometry3<f64>; 2];

/// The rig as it is. A twist on the left of the left pose takes the right camera along.
fn bolted(left: &Isometry3<f64>, baseline: f64, xi: &Vector6<f64>) -> [Isometry3<f64>; 2] {
    let moved = se3::exp(xi) * left;
    [moved, second_lens(baseline) * moved]
}

fn mirrored(left: &Isometry3<f64>, baseline: f64, xi: &Vector6<f64>) -> [Isometry3<f64>; 2] {
    bolted(left, -baseline, xi)
}

fn along_world(left: &Isometry3<f64>, baseline: f64, xi: &Vector6<f64>) -> [Isometry3<f64>; 2] {
    let moved = se3::exp(xi) * left;
    [moved, moved * second_lens(baseline)]
}

fn own_twist(left: &Isometry3<f64>, baseline: f64, xi: &Vector6<f64>) -> [Isometry3<f64>; 2] {
    [se3::exp(xi) * left, se3::exp(xi) * second_lens(baseline) * left]
}

fn twist_carried_back(
    left: &Isometry3<f64>,
    baseline: f64,
    xi: &Vector6<f64>,
) -> [Isometry3<f64>; 2] {
    let lens = second_lens(baseline);
    [se3::exp(xi) * left, lens.inverse() * se3::exp(xi) * lens * lens * left]
}

fn right_twist(left: &Isometry3<f64>, baseline: f64, xi: &Vector6<f64>) -> [Isometry3<f64>; 2] {
    [left * se3::exp(xi), second_lens(baseline) * left * se3::exp(xi)]
}

/// The library's, from the left camera to the right one.
fn second_lens(baseline: f64) -> Isometry3<f64> {
    StereoPinhole { camera: Camera::of_the_book().pinhole(), baseline }.right_from_left()
}

impl Case {
    /// A number of rigs all about a cloud of points some metres from the origin of the world. The
    /// number of points is odd, so that no two wrong systems have the same size.
    pub fn drawn(draw: &mut Draw, counts: [usize; 2], baseline: [f64; 2]) -> Self {
        let middle = draw.vector(1.0..4.0);
        let points = (0..counts[1]).map(|_| middle + draw.vector(0.3..1.6)).collect();
        let pose = |draw: &mut Draw| {
            let rotation = draw.rotation(0.2..2.5);
            let lean = Vector3::new(draw.uniform(-0.2..0.2), draw.uniform(-0.2..0.2), 1.0);
            let translation = draw.uniform(4.0..6.0) * lean - rotation * middle;
            Isometry3::from_parts(translation.into(), rotation.into())
        };
        let left_from_world = (0..counts[0]).map(|_| pose(draw)).collect();
        let (camera, sigma) = (Camera::drawn(draw), draw.uniform(0.3..0.8));
        let scene = Scene { camera, left_from_world, points, sigma };
        Self { scene, baseline: draw.uniform(baseline[0]..baseline[1]) }
    }

    /// The pixels of a point in both cameras of a rig that moves with a twist, by the twist and by
    /// the point: left u and v, right u and v. By differences of the fourth order.
    fn slopes(&self, rig: Rig<'_>, index: usize, point: &Vector3<f64>) -> SMatrix<f64, 4, 9> {
        const H: f64 = 1e-3;
        let pinhole = self.scene.camera.pinhole();
        let pixels = |column: usize, step: f64| {
            let mut change = SMatrix::<f64, 9, 1>::zeros();
            change[column] = step;
            let xi = change.fixed_rows::<6>(0).into_owned();
            let moved = Point3::from(point + change.fixed_rows::<3>(6));
            let cameras = rig(&self.scene.left_from_world[index], self.baseline, &xi);
            // Instances keep their points so far in front that a step this small leaves them there.
            let pixel = cameras.map(|camera| {
                let pixel = pinhole.project_cam(&(camera * moved).coords);
                pixel.unwrap_or_else(|| Vector2::repeat(f64::NAN))
            });
            SMatrix::<f64, 4, 1>::new(pixel[0].x, pixel[0].y, pixel[1].x, pixel[1].y)
        };
        SMatrix::from_columns(&[0, 1, 2, 3, 4, 5, 6, 7, 8].map(|column| {
            let near = pixels(column, H) - pixels(column, -H);
            let far = pixels(column, 2.0 * H) - pixels(column, -2.0 * H);
            (8.0 * near - far) / (12.0 * H)
        }))
    }

    /// The Jacobian of all whitened pixels, of which `rows` of the four of each rig and point are
    /// used, by the rigs and by the points.
    fn jacobian(&self, rig: Rig<'_>, rows: &[usize], hold_first: bool) -> [DMatrix<f64>; 2] {
        let (rigs, points) = (self.scene.left_from_world.len(), self.scene.points.len());
        let first = usize::from(hold_first);
        let height = rows.len() * rigs * points;
        let mut by_rigs = DMatrix::zeros(height, 6 * (rigs - first));
        let mut by_points = DMatrix::zeros(height, 3 * points);
        for index in 0..rigs {
            for (which, point) in self.scene.points.iter().enumerate() {
                let slopes = self.slopes(rig, index, point).select_rows(rows) / self.scene.sigma;
                let row = rows.len() * (index * points + which);
                if index >= first {
                    let column = 6 * (index - first);
                    by_rigs
                        .view_mut((row, column), (rows.len(), 6))
                        .copy_from(&slopes.columns(0, 6));
                }
                by_points
                    .view_mut((row, 3 * which), (rows.len(), 3))
                    .copy_from(&slopes.columns(6, 3));
            }
        }
        [by_rigs, by_points]
    }

    /// What is left of the Jacobian by the rigs when the points follow as well as they can: its
    /// part at right angles to everything that the points can do.
    fn remaining(&self, rig: Rig<'_>, rows: &[usize], hold_first: bool) -> DMatrix<f64> {
        let [by_rigs, by_points] = self.jacobian(rig, rows, hold_first);
        unexplained(by_rigs, by_points)
    }
}

/// The part of a Jacobian by the rigs at right angles to everything that the points can do.
fn unexplained(by_rigs: DMatrix<f64>, by_points: DMatrix<f64>) -> DMatrix<f64> {
    let reachable = by_points.qr().q();
    &by_rigs - &reachable * reachable.tr_mul(&by_rigs)
}

/// The rows of both pixels that are used.
const LEFT: &[usize] = &[0, 1];
const BOTH: &[usize] = &[0, 1, 2, 3];

const PIXEL: [&str; 2] = ["u", "v"];
const BLOCKS: [&str; 9] =
    ["rho x", "rho y", "rho z", "phi x", "phi y", "phi z", "P x", "P y", "P z"];
const TWIST: [&str; 6] = ["rho x", "rho y", "rho z", "phi x", "phi y", "phi z"];

/// The instances that students have.
fn cases() -> Vec<Case> {
    let mut draw = Draw::new(8);
    (0..6).map(|index| Case::drawn(&mut draw, [3 + index % 2, 9], [0.1, 0.5])).collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("the_right_camera_stands_to_the_right_of_the_left_one", |answer| {
            cases().iter().try_for_each(|case| second_camera(answer, case))
        }),
        Check::new("the_right_pixel_moves_with_the_rig_and_with_the_point", |answer| {
            cases().iter().try_for_each(|case| blocks(answer, case))
        }),
        Check::new("the_reduced_system_is_the_stiffness_that_points_leave", |answer| {
            cases().iter().try_for_each(|case| reduced(answer, case))
        }),
        Check::new("stiffnesses_do_not_depend_on_units", |answer| {
            cases().iter().try_for_each(|case| eigenvalues(answer, case))
        }),
        Check::new("one_lens_leaves_seven_directions_and_one_two_lenses_six_and_none", |answer| {
            cases().iter().try_for_each(|case| counts(answer, case))
        }),
        Check::new("moving_the_world_moves_every_rig_in_its_own_axes", |answer| {
            cases().iter().try_for_each(|case| motions(answer, case))
        }),
    ]
}

/// The pose of the right camera, against the library's stereo camera.
///
/// # Errors
///
/// A failure, which names where the camera stands instead where that is known.
pub fn second_camera(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    for left in &case.scene.left_from_world {
        let obtained = Answer(answer).right_from_world(left, &case.baseline)?;
        let rows = |pose: &Isometry3<f64>| pose.to_homogeneous().fixed_rows::<3>(0).into_owned();
        let right = |rig: Rig<'_>| rig(left, case.baseline, &Vector6::zeros())[1];
        let expected = right(&bolted);
        compare("the pose of the right camera", &rows(&obtained), &rows(&expected))
            .labelled(&["x", "y", "z"], &["R", "R", "R", "t"])
            .or(&BASELINE_SIGN, &rows(&right(&mirrored)))
            .or(&BASELINE_IN_WORLD, &rows(&right(&along_world)))
            .judge()
            .map_err(|failure| {
                // The left camera, and where the right one was put.
                let seen = |name: &str, right: &Isometry3<f64>| {
                    let centre = (left * right.inverse()).translation.vector;
                    Dots::new(name, [[0.0, 0.0], [centre.x, centre.z]])
                };
                failure.with_picture(Picture {
                    title: "Both cameras of the rig from above, in the left one's axes".to_owned(),
                    axes: ["x, m".to_owned(), "z, m".to_owned()],
                    expected: seen("expected", &expected),
                    obtained: seen("obtained", &obtained),
                    downward: false,
                })
            })?;
    }
    Ok(())
}

/// The blocks of the right pixel, against differences.
///
/// # Errors
///
/// A failure, which names what moves instead where that is known.
pub fn blocks(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { scene, baseline } = case;
    for (index, left) in scene.left_from_world.iter().enumerate() {
        let point = &scene.points[index];
        let (by_twist, by_point) =
            Answer(answer).right_blocks(&scene.camera, left, baseline, point)?;
        let mut obtained = SMatrix::<f64, 2, 9>::zeros();
        obtained.fixed_columns_mut::<6>(0).copy_from(&by_twist);
        obtained.fixed_columns_mut::<3>(6).copy_from(&by_point);
        let right = |rig: Rig<'_>| case.slopes(rig, index, point).fixed_rows::<2>(2).into_owned();
        let left_pixel = case.slopes(&bolted, index, point).fixed_rows::<2>(0).into_owned();
        compare("the pair of blocks of the right pixel", &obtained, &right(&bolted))
            .within(1e-7)
            .labelled(&PIXEL, &BLOCKS)
            .or(&BASELINE_SIGN, &right(&mirrored))
            .or(&BASELINE_IN_WORLD, &right(&along_world))
            .or(&ADJOINT_FORGOTTEN, &right(&own_twist))
            .or(&ADJOINT_INVERTED, &right(&twist_carried_back))
            .or(&TWIST_ON_THE_RIGHT, &right(&right_twist))
            .or(&LEFT_PIXEL, &left_pixel)
            .judge()?;
    }
    Ok(())
}

/// The reduced system, against the part of the rigs' Jacobian that no motion of points explains.
///
/// # Errors
///
/// A failure, which names what the matrix is instead where that is known.
pub fn reduced(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { scene, baseline } = case;
    for (lenses, hold_first) in [(1, false), (1, true), (2, false), (2, true)] {
        let (baseline, rows) = if lenses == 2 { (Some(*baseline), BOTH) } else { (None, LEFT) };
        let obtained = Answer(answer).reduced_system(scene, &baseline, &hold_first)?;
        let square = |jacobian: DMatrix<f64>| jacobian.tr_mul(&jacobian);
        let of = |rig: Rig<'_>, rows: &[usize]| square(case.remaining(rig, rows, hold_first));
        let expected = of(&bolted, rows);
        if let Some(misconception) = size_of(scene, &obtained, expected.nrows()) {
            let numbers = format!(
                "{} rigs, {} points, rig 0 {}: {}×{} expected, {}×{} obtained",
                scene.left_from_world.len(),
                scene.points.len(),
                if hold_first { "held" } else { "free" },
                expected.nrows(),
                expected.ncols(),
                obtained.nrows(),
                obtained.ncols()
            );
            return Err(Failure::known(misconception).with_numbers(numbers));
        }
        let [nailed, _] = case.jacobian(&bolted, rows, hold_first);
        let nailed = square(nailed);
        let rigs = usize::from(hold_first)..scene.left_from_world.len();
        let labels: Vec<String> =
            rigs.flat_map(|rig| TWIST.map(|axis| format!("{rig}, {axis}"))).collect();
        let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
        let mut comparison = compare("the reduced system", &obtained, &expected)
            .within(1e-7)
            .labelled(&labels, &[])
            .or(&POINTS_NAILED, &nailed)
            .or(&COUPLING_ADDED, &(2.0 * &nailed - &expected))
            .or(&TWIST_ON_THE_RIGHT, &of(&right_twist, rows))
            .or(&UNWHITENED, &(scene.sigma * scene.sigma * &expected))
            .or(&UNWHITENED, &(scene.sigma * &expected));
        if hold_first {
            // The rows of rig 0 come first.
            let seen = scene.left_from_world.len() * scene.points.len();
            let [by_rigs, by_points] = case.jacobian(&bolted, rows, hold_first);
            let first = by_rigs.nrows() / seen * scene.points.len();
            let [by_rigs, by_points] = [by_rigs, by_points].map(|all| all.remove_rows(0, first));
            comparison = comparison.or(&HELD_IS_BLIND, &square(unexplained(by_rigs, by_points)));
        }
        if lenses == 2 {
            comparison = comparison
                .or(&BASELINE_SIGN, &of(&mirrored, rows))
                .or(&BASELINE_IN_WORLD, &of(&along_world, rows))
                .or(&ADJOINT_FORGOTTEN, &of(&own_twist, rows))
                .or(&ADJOINT_INVERTED, &of(&twist_carried_back, rows))
                .or(&SECOND_LENS_UNUSED, &of(&bolted, LEFT))
                .or(&ROW_LEFT_OUT, &of(&bolted, &[0, 1, 2]));
        }
        comparison.judge().map_err(|failure| {
            let which = format!(
                "{lenses} camera{} a rig, rig 0 {}",
                if lenses == 2 { "s" } else { "" },
                if hold_first { "held" } else { "free" },
            );
            if obtained.shape() != expected.shape() {
                return failure.with_numbers(which);
            }
            let numbers = format!(
                "{which}\n{}\nsum of the diagonal: {} expected, {} obtained, {} with the points nailed \
                 down",
                shortened(&obtained, &expected, &labels),
                readable(expected.trace()),
                readable(obtained.trace()),
                readable(nailed.trace())
            );
            failure.with_numbers(numbers)
        })?;
    }
    Ok(())
}

/// What is in a matrix that has this size instead of the right one.
fn size_of(
    scene: &Scene,
    obtained: &DMatrix<f64>,
    expected: usize,
) -> Option<&'static Misconception> {
    let (rigs, points) = (scene.left_from_world.len(), scene.points.len());
    let size = obtained.nrows();
    let square = size == obtained.ncols() && size != expected;
    match size {
        _ if !square => None,
        _ if size == 6 * rigs => Some(&STILL_FREE),
        _ if [12 * rigs, 12 * rigs - 6, 12 * rigs - 12].contains(&size) => Some(&FREE_RIGHT_CAMERA),
        _ if size == expected + 3 * points || size == 6 * rigs + 3 * points => {
            Some(&POINTS_LEFT_IN)
        }
        _ => None,
    }
}

/// The first block of each matrix, and where they differ most: whole ones are too wide to read.
fn shortened(obtained: &DMatrix<f64>, expected: &DMatrix<f64>, labels: &[&str]) -> String {
    let block = |matrix: &DMatrix<f64>| {
        let rows = (0..6).map(|row| {
            let entries = (0..6).map(|column| format!("{:>11}", readable(matrix[(row, column)])));
            format!("{:>10} {}\n", labels[row], entries.collect::<String>())
        });
        rows.collect::<String>()
    };
    let nowhere = obtained.iter().position(|entry| !entry.is_finite());
    let (row, column) = match nowhere {
        Some(index) => obtained.vector_to_matrix_index(index),
        None => (expected - obtained).iamax_full(),
    };
    let [from, to] = told_apart(expected[(row, column)], obtained[(row, column)]);
    format!(
        "first block expected:\n{}first block obtained:\n{}greatest difference, at ({}; {}): {from} expected, \
         {to} obtained",
        block(expected),
        block(obtained),
        labels[row],
        labels[column]
    )
}

/// The eigenvalues in units of the diagonal, against squared singular values.
///
/// # Errors
///
/// A failure, which names the units where they are known.
pub fn eigenvalues(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    for (rows, hold_first, millimetres) in
        [(LEFT, false, 1.0), (BOTH, true, 1.0), (BOTH, true, 1e-3)]
    {
        let mut remaining = case.remaining(&bolted, rows, hold_first);
        for (index, mut column) in remaining.column_iter_mut().enumerate() {
            column *= if index % 6 < 3 { millimetres } else { 1.0 };
        }
        let reduced = remaining.tr_mul(&remaining);
        let obtained = Answer(answer).stiffnesses(&reduced)?;
        let expected = pure(&remaining);
        let plain = ascending(remaining.singular_values().map(|value| value * value));
        let diagonal = reduced.diagonal();
        let twice = DMatrix::from_fn(reduced.nrows(), reduced.ncols(), |row, column| {
            reduced[(row, column)] / (diagonal[row] * diagonal[column])
        });
        let descending: Vec<f64> = expected.iter().rev().copied().collect();
        compare_list("the list of stiffnesses", &obtained, &expected)
            .or_list(&UNITS_MIXED, &plain)
            .or_list(&UNITS_SQUARED, &ascending(twice.symmetric_eigenvalues()))
            .or_list(&DESCENDING, &descending)
            .judge()?;
    }
    Ok(())
}

/// The stiffnesses of what remains of a Jacobian, from its singular values.
fn pure(remaining: &DMatrix<f64>) -> Vec<f64> {
    let mut scaled = remaining.clone();
    scaled.column_iter_mut().for_each(|mut column| column /= column.norm());
    ascending(scaled.singular_values().map(|value| value * value))
}

fn ascending(numbers: DVector<f64>) -> Vec<f64> {
    let mut numbers: Vec<f64> = numbers.iter().copied().collect();
    numbers.sort_by(f64::total_cmp);
    // Differences and rounding leave a little where there is nothing.
    let nothing = 1e-14 * numbers.last().copied().unwrap_or_default();
    numbers.into_iter().map(|number| if number.abs() < nothing { 0.0 } else { number }).collect()
}

/// A stiffness below this is none. Rounding leaves about 1e-15.
pub const NONE_BELOW: f64 = 1e-9;

/// The student's own stiffnesses of the student's own systems: how many are zero. Systems and
/// stiffnesses must be right as well: any matrix has some eigenvalues.
///
/// # Errors
///
/// A failure when the counts are not 7 and 1 for one lens, 6 and 0 for two.
pub fn counts(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { scene, baseline } = case;
    let rigs = scene.left_from_world.len();
    let mut lines = String::new();
    let mut right = true;
    for (baseline, hold_first, free) in
        [(None, false, 7), (None, true, 1), (Some(*baseline), false, 6), (Some(*baseline), true, 0)]
    {
        let reduced = Answer(answer).reduced_system(scene, &baseline, &hold_first)?;
        let rows = 6 * (rigs - usize::from(hold_first));
        if reduced.shape() != (rows, rows) || reduced.iter().any(|entry| !entry.is_finite()) {
            return Err(Failure::new(format!(
                "S should be {rows}×{rows} and finite before its directions can be counted; the check \
                 of the reduced system says more."
            )));
        }
        let stiffnesses = Answer(answer).stiffnesses(&reduced)?;
        let found = stiffnesses.iter().filter(|value| value.abs() < NONE_BELOW).count();
        let least = stiffnesses.iter().find(|value| value.abs() >= NONE_BELOW);
        let used = if baseline.is_some() { BOTH } else { LEFT };
        let remaining = case.remaining(&bolted, used, hold_first);
        let system = compare("S", &reduced, &remaining.tr_mul(&remaining)).within(1e-7);
        let list = compare_list("the list", &stiffnesses, &pure(&remaining)).within(1e-7);
        right &= found == free && system.judge().is_ok() && list.judge().is_ok();
        lines += &format!(
            "{} a rig, rig 0 {}: {free} expected, {found} obtained; the least that is not zero: {}\n",
            if baseline.is_some() { "two cameras" } else { "one camera" },
            if hold_first { "held" } else { "free" },
            least.map_or_else(|| "none".to_owned(), |least| readable(*least)),
        );
    }
    if right {
        return Ok(());
    }
    let sentence = "Your stiffnesses of your reduced systems are not those of the directions that \
        pixels see and do not see. The checks of the single functions say more.";
    let failure = Failure::new(sentence).with_numbers(format!("stiffnesses below 1e-9\n{lines}"));
    let failure = failure.unless("reduced_system", || reduced(answer, case));
    Err(failure.unless("stiffnesses", || eigenvalues(answer, case)))
}

/// The motions that leave all pictures alone, against logarithms of moved poses.
///
/// # Errors
///
/// A failure, which names what the rigs do instead where that is known.
pub fn motions(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    const H: f64 = 1e-3;
    let poses = &case.scene.left_from_world;
    let obtained = Answer(answer).rigid_motions(poses)?;
    // The twist on the left that takes the pose to the one which sees the moved world unchanged.
    let twist = |pose: &Isometry3<f64>, axis: usize, step: f64| {
        let mut unit = Vector6::zeros();
        unit[axis] = step;
        se3::log(&(pose * se3::exp(&unit).inverse() * pose.inverse()))
    };
    let table = |of: &dyn Fn(&Isometry3<f64>, usize) -> Vector6<f64>| {
        DMatrix::from_fn(6 * poses.len(), 6, |row, axis| of(&poses[row / 6], axis)[row % 6])
    };
    let motion = |pose: &Isometry3<f64>, axis: usize| {
        (twist(pose, axis, H) - twist(pose, axis, -H)) / (2.0 * H)
    };
    let expected = table(&motion);
    let backwards = table(&|pose, axis| motion(&pose.inverse(), axis));
    let same = table(&|_, axis| motion(&Isometry3::identity(), axis));
    let labels: Vec<String> =
        (0..poses.len()).flat_map(|rig| TWIST.map(|axis| format!("{rig}, {axis}"))).collect();
    let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
    compare("the table of motions", &obtained, &expected)
        .within(1e-6)
        .labelled(&labels, &TWIST)
        .or(&OPPOSITE_MOTION, &-&expected)
        .or(&SAME_FOR_ALL, &same)
        .or(&SAME_FOR_ALL, &-&same)
        .or(&ADJOINT_INVERTED, &backwards)
        .or(&ADJOINT_INVERTED, &-&backwards)
        .judge()
}
