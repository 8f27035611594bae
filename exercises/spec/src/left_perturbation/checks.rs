//! What is asked about an answer, and on which instances.

use nalgebra::{
    Isometry3, Matrix2x3, Matrix2x4, Matrix2x6, Point3, Rotation3, SMatrix, Vector2, Vector3,
    Vector6,
};
use vislam::manifold::se3;
use vislam::reprojection::Z_MIN;

use super::*;
use crate::Exercise;
use crate::answer::Transport;
use crate::camera::{self, point_in_view};
use crate::check::{Check, Failure, compare, each, readable};
use crate::draw::Draw;
use crate::picture::{Dots, Picture};

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "left_perturbation",
    title: "Left perturbation of a pose",
    chapter: "reprojection",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Camera", "Side"],
    forbidden: &[
        "bal",
        "bundle_adjustment",
        "factors",
        "jacobians",
        "observability",
        "project_with_jacobians",
        "simulation",
    ],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    RIGHT_PERTURBATION, "right_perturbation":
        "This is the derivative by a twist on the right, T exp(ξ). Write exp(ξ) T P and look at \
         which point ξ meets first: in which frame does it stand?";
    POINT_IN_WORLD, "point_in_world":
        "The translation's columns are right. The rotation's columns have the skew of the point \
         in the world. After T has acted, in which frame is the point that exp(ξ) turns?";
    ROTATION_KEPT, "rotation_kept":
        "The skew is of the right point, but a rotation R_cw is left over in the columns. On the \
         left, ξ acts on coordinates that are already the camera's: what is left for R_cw to turn?";
    TRANSLATION_TURNED, "translation_turned":
        "The rotation's columns are right, and in those of ρ a rotation R_cw is left over. On the \
         left, ρ shifts coordinates that are already the camera's: in which axes does it stand?";
    SKEW_SIGN, "skew_sign":
        "The rotation's columns have the wrong sign. φ × P is linear in φ: which matrix times φ \
         is it, that of P or its negative?";
    ALL_NEGATED, "all_negated":
        "Every column has the wrong sign. Let ρ shift the point to the right in the camera's frame: \
         which way does its pixel go, and what does the first column say?";
    TRANSLATION_FORGOTTEN, "translation_forgotten":
        "The point was turned into the camera's axes and not moved: this is the derivative at R P, and \
         the point in the camera's frame is R P + t.";
    SLOPE_AT_WORLD_POINT, "slope_at_world_point":
        "The slope of the projection was taken at the point in the world. Of which point is the \
         pixel, and in which frame does the camera see it?";
    FOCAL_LENGTH_MISSING, "focal_length_missing":
        "These numbers are right for a focal length of one. The answer is in pixels per metre and per \
         radian: by what does a pixel's row or column grow with X/Z?";
    ROTATION_FIRST, "rotation_first":
        "The columns are right and in another order: the twist is (ρ, φ), translation first.";
    // ANCHOR: adjoint_mistakes
    TRANSPOSED_ADJOINT, "transposed_adjoint":
        "The adjoint is transposed. A derivative by the right twist is one by the left twist, \
         times what takes the right twist to the left one: on which side do the columns multiply?";
    INVERSE_ADJOINT, "inverse_adjoint":
        "This goes the other way, from right to left. T exp(ξ) = exp(η) T: which of the two twists \
         is the adjoint times the other?";
    // ANCHOR_END: adjoint_mistakes
    ONE_SIDED, "one_sided":
        "The error shrinks like the step and not like its square: this is a one-sided difference.";
    TWIST_NOT_APPLIED, "twist_not_applied":
        "Every difference is zero: the twist has moved nothing. Both pixels are those of the pose that \
         came in. Where does exp(ξ) meet it?";
    TWICE_TOO_LARGE, "twice_too_large":
        "These are twice too large. How far apart are the two poses whose pixels were subtracted?";
    SIDES_EXCHANGED, "sides_exchanged":
        "Left and right are exchanged: exp(ξ) T moves the pose on the left.";
    DIFFERENCED, "differenced":
        "This agrees with the derivative and loses its digits where pixels do, far from the principal \
         point or as near as the camera can see: it was differenced. A derivative is asked for. Which \
         numbers of the camera does the pixel contain, and which of them its derivative?";
    POINT_MOVES, "point_moves":
        "This is how the pixel moves when the point moves forward. When the camera does, where does \
         the point go in the camera's frame?";
}

/// A camera, its pose and a world point in front of it.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// The camera.
    pub camera: Camera,
    /// Its pose.
    pub camera_from_world: Isometry3<f64>,
    /// The point.
    pub point_in_world: Vector3<f64>,
}

impl Case {
    /// A case whose point has the depths and whose pose the angles given.
    pub fn drawn(draw: &mut Draw, depth: [f64; 2], angle: f64, distance: f64) -> Self {
        let camera_from_world = draw.pose(0.3 * angle..angle, 0.3 * distance..distance);
        let point_in_camera = point_in_view(draw, depth[0], depth[1]);
        let point_in_world = (camera_from_world.inverse() * Point3::from(point_in_camera)).coords;
        Self { camera: camera::Camera::drawn(draw).into(), camera_from_world, point_in_world }
    }

    /// A failure with the case; the rotation by its logarithm.
    fn shown(&self, failure: Failure) -> Failure {
        let Isometry3 { rotation, translation } = &self.camera_from_world;
        failure.given(&[
            ("camera", &self.camera),
            ("log of camera_from_world.rotation", &rotation.scaled_axis().as_slice()),
            ("camera_from_world.translation", &translation.vector.as_slice()),
            ("point_in_world", &self.point_in_world.as_slice()),
        ])
    }

    fn point_in_camera(&self) -> Vector3<f64> {
        (self.camera_from_world * Point3::from(self.point_in_world)).coords
    }

    /// The point in the camera's frame when a twist moves the pose on a side.
    fn moved(&self, side: Side, xi: &Vector6<f64>) -> Point3<f64> {
        let pose = match side {
            Side::Left => se3::exp(xi) * self.camera_from_world,
            Side::Right => self.camera_from_world * se3::exp(xi),
        };
        pose * Point3::from(self.point_in_world)
    }

    /// The derivative by a twist that moves the pose on a side.
    fn slope(&self, side: Side) -> Matrix2x6<f64> {
        self.slope_of(|xi| self.moved(side, xi))
    }

    /// The same by differences of the second order with a step.
    fn difference(&self, side: Side, step: f64) -> Matrix2x6<f64> {
        let pixels = self.pixels_of(|xi| self.moved(side, xi));
        Matrix2x6::from_columns(
            &[0, 1, 2, 3, 4, 5]
                .map(|axis| (pixels(axis, step) - pixels(axis, -step)) / (2.0 * step)),
        )
    }

    /// The pixel of a point in the camera's frame that is moved along an axis of the twist.
    fn pixels_of(
        &self,
        moved: impl Fn(&Vector6<f64>) -> Point3<f64>,
    ) -> impl Fn(usize, f64) -> Vector2<f64> {
        move |axis, step| {
            let mut xi = Vector6::zeros();
            xi[axis] = step;
            // Instances keep their points so far in front that a step this small leaves them there.
            let pixel = self.camera.pinhole().project_cam(&moved(&xi).coords);
            pixel.unwrap_or_else(|| Vector2::repeat(f64::NAN))
        }
    }

    /// The derivative of the pixel of a point in the camera's frame that a twist moves, by
    /// differences of the fourth order.
    fn slope_of(&self, moved: impl Fn(&Vector6<f64>) -> Point3<f64>) -> Matrix2x6<f64> {
        const H: f64 = 2e-4;
        let pixel = self.pixels_of(moved);
        Matrix2x6::from_columns(&[0, 1, 2, 3, 4, 5].map(|axis| {
            let near = pixel(axis, H) - pixel(axis, -H);
            let far = pixel(axis, 2.0 * H) - pixel(axis, -2.0 * H);
            (8.0 * near - far) / (12.0 * H)
        }))
    }

    /// The derivative when the twist is a displacement ρ + φ × `lever` that `turned` turns.
    fn slope_with_lever(&self, lever: &Vector3<f64>, turned: &Rotation3<f64>) -> Matrix2x6<f64> {
        let point = self.point_in_camera();
        self.slope_of(|xi| {
            let (rho, phi) = (xi.fixed_rows::<3>(0), xi.fixed_rows::<3>(3));
            Point3::from(point + turned * (rho + phi.cross(lever)))
        })
    }
}

/// What somebody gets who takes the slope of the projection at one point and turns another.
impl Case {
    fn blocks(&self, slope_at: &Vector3<f64>, turned: &Vector3<f64>) -> Matrix2x6<f64> {
        let slope = self.slope_at(slope_at);
        Matrix2x6::from_fn(|row, column| match column {
            0..3 => slope[(row, column)],
            // A turn about an axis moves the point by the axis times the point.
            _ => slope.row(row).dot(&Vector3::ith(column - 3, 1.0).cross(turned).transpose()),
        })
    }

    /// The slope of the projection at any point of the camera's frame, behind it too.
    fn slope_at(&self, point: &Vector3<f64>) -> Matrix2x3<f64> {
        let Camera { fx, fy, .. } = self.camera;
        let pixel = |point: Vector3<f64>| Vector2::new(fx * point.x, fy * point.y) / point.z;
        let step = 2e-4 * point.z;
        Matrix2x3::from_columns(&[0, 1, 2].map(|axis| {
            let at = |steps: f64| pixel(point + Vector3::ith(axis, steps * step));
            (8.0 * (at(1.0) - at(-1.0)) - at(2.0) + at(-2.0)) / (12.0 * step)
        }))
    }

    /// The same camera with its principal point so far away that pixels have six digits behind the
    /// point. No derivative notices.
    fn far_off(&self) -> Self {
        let away = 2.0_f64.powi(33);
        Self { camera: Camera { cx: away, cy: -away, ..self.camera }, ..*self }
    }

    /// The point on the same ray, as near as the camera can see. A step farther there is no pixel.
    fn nearest(&self) -> Self {
        let point = self.point_in_camera();
        self.with_point((1.0 + 1e-9) * Z_MIN / point.z * point)
    }

    fn with_point(&self, point_in_camera: Vector3<f64>) -> Self {
        let point = self.camera_from_world.inverse() * Point3::from(point_in_camera);
        Self { point_in_world: point.coords, ..*self }
    }

    /// A camera in the origin of the world and a point of short numbers: nothing is rounded before
    /// the derivative begins.
    fn short(&self) -> Self {
        let point_in_world = self.point_in_camera().map(|number| f64::from(number as f32));
        Self { camera_from_world: Isometry3::identity(), point_in_world, ..*self }
    }

    /// Numbers of pixels in units of the focal lengths.
    fn without_focal_length<const C: usize>(
        &self,
        pixels: &SMatrix<f64, 2, C>,
    ) -> SMatrix<f64, 2, C> {
        let Camera { fx, fy, .. } = self.camera;
        SMatrix::from_fn(|row, column| pixels[(row, column)] / [fx, fy][row])
    }
}

const ROWS: [&str; 2] = ["u", "v"];
const COLUMNS: [&str; 6] = ["rho x", "rho y", "rho z", "phi x", "phi y", "phi z"];

/// The instances that students have.
fn cases() -> Vec<Case> {
    let mut draw = Draw::new(1);
    (0..20).map(|_| Case::drawn(&mut draw, [2.0, 8.0], 1.0, 2.0)).collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("the_left_jacobian_is_the_slope_of_the_projection", |answer| {
            each(&cases(), |case| left_jacobian(answer, case))
        }),
        Check::new("on_the_optical_axis_the_third_column_vanishes", |answer| {
            [1.0, 4.0, 20.0]
                .iter()
                .try_for_each(|depth| third_column(answer, &Case::on_axis(*depth)))
        }),
        Check::new("the_adjoint_takes_left_to_right", |answer| {
            cases().iter().try_for_each(|case| adjoint(answer, case))
        }),
        Check::new("differences_err_with_the_square_of_the_step", |answer| {
            cases().iter().try_for_each(|case| differences(answer, case))
        }),
        Check::new("a_camera_that_moves_forward_sees_points_move_outward", |answer| {
            cases().iter().try_for_each(|case| forward(answer, case))
        }),
    ]
}

/// The left Jacobian against differences.
///
/// # Errors
///
/// A failure, which names what the columns are instead where that is known.
pub fn left_jacobian(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let obtained = Answer(answer).left_pose_jacobian(
        &case.camera,
        &case.camera_from_world,
        &case.point_in_world,
    )?;
    let left = case.slope(Side::Left);
    let (still, turned) =
        (Rotation3::identity(), case.camera_from_world.rotation.to_rotation_matrix());
    let mut negated = left;
    negated.fixed_columns_mut::<3>(3).neg_mut();
    let (seen, only_turned) = (case.point_in_camera(), turned * case.point_in_world);
    let kept = case.slope_with_lever(&case.point_in_camera(), &turned);
    let mixed = |first: &Matrix2x6<f64>, last: &Matrix2x6<f64>| {
        Matrix2x6::from_fn(|row, column| if column < 3 { first } else { last }[(row, column)])
    };
    let swapped = Matrix2x6::from_fn(|row, column| left[(row, (column + 3) % 6)]);
    compare("the left Jacobian", &obtained, &left)
        .within(1e-7)
        .labelled(&ROWS, &COLUMNS)
        .or(&RIGHT_PERTURBATION, &case.slope(Side::Right))
        .or(&POINT_IN_WORLD, &case.slope_with_lever(&case.point_in_world, &still))
        .or(&ROTATION_KEPT, &kept)
        .or(&ROTATION_KEPT, &mixed(&left, &kept))
        .or(&TRANSLATION_TURNED, &mixed(&kept, &left))
        .or(&SKEW_SIGN, &negated)
        .or(&ALL_NEGATED, &-left)
        .or(&TRANSLATION_FORGOTTEN, &case.blocks(&only_turned, &only_turned))
        .or(&TRANSLATION_FORGOTTEN, &case.blocks(&seen, &only_turned))
        .or(&SLOPE_AT_WORLD_POINT, &case.blocks(&case.point_in_world, &seen))
        .or(&SLOPE_AT_WORLD_POINT, &case.blocks(&case.point_in_world, &case.point_in_world))
        .or(&FOCAL_LENGTH_MISSING, &case.without_focal_length(&left))
        .or(&ROTATION_FIRST, &swapped)
        .judge()
        .map_err(|failure| case.shown(failure).with_picture(picture(&left, &obtained)))?;
    derived(answer, case, 6)
}

/// Whether the first columns of a left Jacobian were derived: differences of pixels lose their
/// digits here.
fn derived(answer: &dyn Transport, case: &Case, columns: usize) -> Result<(), Failure> {
    let ask = |case: &Case| {
        let Case { camera, camera_from_world, point_in_world } = case;
        Answer(answer).left_pose_jacobian(camera, camera_from_world, point_in_world)
    };
    let nearest = case.nearest();
    let point = nearest.point_in_camera();
    for (obtained, expected) in [
        (ask(&case.far_off())?, case.slope(Side::Left)),
        (ask(&nearest)?, nearest.blocks(&point, &point)),
    ] {
        compare("the left Jacobian", &obtained.columns(0, columns), &expected.columns(0, columns))
            .within(1e-7)
            .labelled(&ROWS, &COLUMNS)
            .judge()
            .map_err(differenced)?;
    }
    // A point that moves along its ray keeps its pixel, and a turn moves it by the axis times itself.
    let (jacobian, point) = (ask(&case.short())?, case.short().point_in_world);
    let rho = jacobian.fixed_columns::<3>(0).into_owned();
    let related = Matrix2x4::from_fn(|row, column| match column {
        0 => rho.row(row).dot(&point.transpose()),
        _ => {
            let moved = Vector3::ith(column - 1, 1.0).cross(&point);
            jacobian[(row, 2 + column)] - rho.row(row).dot(&moved.transpose())
        }
    });
    exact(related.columns(0, columns - 2).amax(), rho.amax() * point.amax())
}

/// Whether what should be zero is so but for the last digits of a number of this size.
fn exact(off: f64, size: f64) -> Result<(), Failure> {
    if off <= 1e-14 * size { Ok(()) } else { Err(Failure::known(&DIFFERENCED)) }
}

/// What a failure means where differences lose their digits.
fn differenced(failure: Failure) -> Failure {
    Failure { numbers: failure.numbers, ..Failure::known(&DIFFERENCED) }
}

/// How far each axis of the twist moves the pixel for a hundredth of its unit.
fn picture(expected: &Matrix2x6<f64>, obtained: &Matrix2x6<f64>) -> Picture {
    let ends = |name: &str, jacobian: &Matrix2x6<f64>| {
        Dots::new(name, jacobian.column_iter().map(|column| [0.01 * column[0], 0.01 * column[1]]))
    };
    Picture {
        title: "Moves of the pixel for a hundredth of each axis of the twist".to_owned(),
        axes: ["u, px".to_owned(), "v, px".to_owned()],
        expected: ends("expected", expected),
        obtained: ends("obtained", obtained),
        downward: true,
    }
}

/// The column of a motion along the axis, for a point on the axis, beside those of the motions to
/// the sides.
///
/// # Errors
///
/// A failure when it is not zero, or when the others are not what they should be.
pub fn third_column(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let jacobian = Answer(answer).left_pose_jacobian(
        &case.camera,
        &case.camera_from_world,
        &case.point_in_world,
    )?;
    let slope = case.slope(Side::Left);
    let (u, v) = (jacobian[(0, 2)], jacobian[(1, 2)]);
    if let Some(bad) = jacobian.iter().find(|entry| !entry.is_finite()) {
        return Err(Failure::new(format!(
            "The left Jacobian of a point on the optical axis: an entry is {bad}; every entry must \
             be finite."
        )));
    }
    if u.abs().max(v.abs()) > 1e-9 * slope.amax() {
        return Err(Failure::new(format!(
            "The point lies on the optical axis, and the column of rho z is ({}, {}). A step along \
             the axis leaves its pixel where it is, so both should be zero.",
            readable(u),
            readable(v)
        )));
    }
    let columns = |first: usize| slope.fixed_columns::<3>(first).into_owned();
    compare("the part of a translation", &jacobian.fixed_columns::<3>(0).into_owned(), &columns(0))
        .within(1e-7)
        .labelled(&ROWS, &COLUMNS)
        .or(&ALL_NEGATED, &-columns(0))
        .or(&FOCAL_LENGTH_MISSING, &case.without_focal_length(&columns(0)))
        .or(&ROTATION_FIRST, &columns(3))
        .judge()?;
    // On the axis itself the last digits of differences cancel.
    let depth = case.point_in_camera().z;
    derived(answer, &case.with_point(depth * Vector3::new(0.25, -0.125, 1.0)), 3)
}

// ANCHOR: adjoint_check
/// The dictionary between the sides, on a derivative found by differences.
///
/// # Errors
///
/// A failure, which names the dictionary that was used instead where that is known.
pub fn adjoint(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let (left, right) = (case.slope(Side::Left), case.slope(Side::Right));
    let obtained = Answer(answer).right_from_left(&case.camera_from_world, &left)?;
    let adjoint = se3::adjoint(&case.camera_from_world);
    let inverse = se3::adjoint(&case.camera_from_world.inverse());
    compare("the right Jacobian made of the left one", &obtained, &right)
        .within(1e-7)
        .labelled(&ROWS, &COLUMNS)
        .or(&TRANSPOSED_ADJOINT, &(left * adjoint.transpose()))
        .or(&INVERSE_ADJOINT, &(left * inverse))
        .judge()
}
// ANCHOR_END: adjoint_check

/// Central differences, by how their error shrinks and by what they are.
///
/// # Errors
///
/// A failure when they are of another side or order, or no differences.
pub fn differences(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    const STEP: f64 = 0.01;
    let ask = |side, step: f64| {
        let Case { camera, camera_from_world, point_in_world } = case;
        Answer(answer).central_differences(camera, camera_from_world, point_in_world, &side, &step)
    };
    for side in [Side::Left, Side::Right] {
        let (slope, other) = match side {
            Side::Left => (case.slope(Side::Left), case.slope(Side::Right)),
            Side::Right => (case.slope(Side::Right), case.slope(Side::Left)),
        };
        let (half, whole) = (ask(side, 0.5 * STEP)?, ask(side, STEP)?);
        compare("the table of differences with a small step", &ask(side, 1e-5)?, &slope)
            .within(1e-3)
            .labelled(&ROWS, &COLUMNS)
            .or(&TWICE_TOO_LARGE, &(2.0 * slope))
            .or(&SIDES_EXCHANGED, &other)
            .or(&TWIST_NOT_APPLIED, &Matrix2x6::zeros())
            .judge()?;
        let ratio = (whole - slope).norm() / (half - slope).norm();
        if !(3.5..4.5).contains(&ratio) {
            let failure = if (1.7..2.3).contains(&ratio) {
                Failure::known(&ONE_SIDED)
            } else {
                Failure::new("Half the step should leave a quarter of the error.")
            };
            return Err(failure.with_numbers(format!(
                "largest error with a step of {STEP}: {}, with half of it: {}",
                readable((whole - slope).amax()),
                readable((half - slope).amax())
            )));
        }
        for (step, obtained) in [(STEP, whole), (0.5 * STEP, half)] {
            let what = format!("the table of differences with a step of {step}");
            compare(&what, &obtained, &case.difference(side, step))
                .within(1e-7)
                .labelled(&ROWS, &COLUMNS)
                .judge()
                .map_err(|failure| case.shown(failure))?;
        }
    }
    Ok(())
}

/// How the pixel moves when the camera goes forward.
///
/// # Errors
///
/// A failure when it does not move so.
pub fn forward(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let (camera, point) = (&case.camera, case.point_in_camera());
    let obtained = Answer(answer).forward_motion(camera, &point)?;
    let slope = case.slope(Side::Left);
    let point_moves = slope.column(2).into_owned();
    compare("the motion of the pixel", &obtained, &-point_moves)
        .within(1e-7)
        .labelled(&ROWS, &["px per m"])
        .or(&POINT_MOVES, &point_moves)
        .or(&FOCAL_LENGTH_MISSING, &-case.without_focal_length(&point_moves))
        .judge()
        .map_err(|failure| {
            failure.given(&[("camera", camera), ("point_in_camera", &point.as_slice())])
        })?;
    let far = Answer(answer).forward_motion(&case.far_off().camera, &point)?;
    let nearest = case.nearest().point_in_camera();
    let near = Answer(answer).forward_motion(camera, &nearest)?;
    for (obtained, expected) in
        [(far, -point_moves), (near, -case.slope_at(&nearest).column(2).into_owned())]
    {
        compare("the motion of the pixel", &obtained, &expected)
            .within(1e-7)
            .labelled(&ROWS, &["px per m"])
            .judge()
            .map_err(differenced)?;
    }
    // The way to the principal point, over the motion, is the time that a metre a second leaves.
    let Camera { fx, fy, .. } = *camera;
    let away = Vector2::new(fx * point.x, fy * point.y) / point.z;
    exact((obtained * point.z - away).amax(), away.amax())
}

impl Case {
    /// A point on the optical axis of a camera that is turned and away from the origin.
    pub fn on_axis(depth: f64) -> Self {
        let camera_from_world =
            Isometry3::new(Vector3::new(0.4, -0.2, 0.3), Vector3::new(0.2, 0.5, -0.3));
        let point_in_world = camera_from_world.inverse() * Point3::new(0.0, 0.0, depth);
        Self {
            camera: camera::Camera::of_the_book().into(),
            camera_from_world,
            point_in_world: point_in_world.coords,
        }
    }
}
