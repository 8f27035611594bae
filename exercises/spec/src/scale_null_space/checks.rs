//! What is asked about an answer, and on which instances.

use nalgebra::{DMatrix, DVector, Isometry3, Point3, Vector2, Vector3, Vector6};
use vislam::manifold::{se3, so3};
use vislam::two_views;

use super::*;
use crate::Exercise;
use crate::answer::{Spoiled, Transport};
use crate::check::{
    Check, Failure, Misconception, compare, compare_number, readable, show, show_list,
};
use crate::draw::Draw;
use crate::picture::{Dots, Picture};

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "scale_null_space",
    title: "The null vector of scale",
    chapter: "bundle_adjustment",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Scene"],
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
    ABOUT_THE_ORIGIN, "about_the_origin":
        "The scale grows about the origin of the world. No pixel changes, but camera 0 moves, and it \
         is pinned. Which point of the world stays in its place when camera 0 does?";
    PIN_ERASED, "pin_erased":
        "This is the change of scale about the origin of the world with the six numbers of camera 0 \
         struck out. The others still run away from the origin: what does camera 0 see of points \
         that do, while it stays?";
    TWO_CENTRES, "two_centres":
        "The cameras run away from camera 0 and the points from the origin of the world. About how \
         many places can the scale of one scene grow at a time?";
    POINTS_OMITTED, "points_omitted":
        "The cameras are right, and the points do not move. What happens to the angle under which \
         two cameras see a point when the cameras alone move apart?";
    CAMERAS_OMITTED, "cameras_omitted":
        "The points are right, and the cameras do not move. Camera 0 notices nothing, as each point \
         stays on its ray: and camera 1?";
    TRANSLATION_FOR_CENTRE, "translation_for_centre":
        "Here the translations of camera_from_world grow apart. Are they places in the world?";
    CENTRE_AS_TRANSLATION, "centre_as_translation":
        "The new centres stand in the translations. Is the translation of camera_from_world a place?";
    ROTATIONS_SCALED, "rotations_scaled":
        "The rotations were multiplied too. Is an angle a length?";
    OTHER_SIGN, "other_sign":
        "The points are right, and the cameras move in the opposite direction. A right twist moves \
         the world in front of a camera: which way does the camera's centre go for a positive ρ?";
    CAMERA_AXES, "camera_axes":
        "The numbers of each ρ are right in the axes of its camera. In T exp(ξ) with T from world to \
         camera, what does the twist meet first, and in which axes does it therefore stand?";
    POINTS_FIRST, "points_first":
        "The blocks are right and in another order: the cameras come first.";
    ROTATION_FIRST, "rotation_first":
        "The blocks are right and in another order: a twist is (ρ, φ), translation first.";
    UNIT_LENGTH, "unit_length":
        "The direction is right and its length is one. Metres and radians do not add up to a length; \
         at which rate does the distance to a point grow while the factor grows by one?";
    NOT_RELATIVE, "not_relative":
        "The number changes when the Hessian or the direction is multiplied by a constant. How long \
         could the product have been, given how long its factors are?";
    QUADRATIC_FORM, "quadratic_form":
        "This is the part of the product that is parallel to the direction. Is it all of the product?";
    ORTHOGONAL_SHARE, "orthogonal_share":
        "This step is orthogonal to the direction of scale. The pixels agree. Does the distance \
         between cameras 0 and 1 stay?";
    ONE_CAMERA_ONLY, "one_camera_only":
        "The distance stays because camera 1 was moved alone. Do its pixels agree with those of the \
         step given?";
    TURN_FORGOTTEN, "turn_forgotten":
        "φ has no share in this change of the distance. exp(ξ) turns about the origin of the \
         world, and camera 1 does not stand there: what does φ do to its centre?";
    SHARE_ADDED, "share_added":
        "The distance changes by twice as much as it did before. With which sign does the direction \
         of scale have to be mixed in?";
}

impl Spoiled for Scene {
    fn spoiled(number: f64) -> Self {
        Self { cameras: Vec::spoiled(number), points: Vec::spoiled(number) }
    }
}

/// A scene with what sees it, and a step.
#[derive(Debug, Clone)]
pub struct Case {
    /// The lens of every camera.
    pub camera: Camera,
    /// Cameras and points; every camera sees every point.
    pub scene: Scene,
    /// How much it shall grow.
    pub factor: f64,
    /// A step of the unknowns that leaves camera 0.
    pub step: DVector<f64>,
}

impl Case {
    /// A number of cameras all about a cloud of points, which lies some metres from the origin of the
    /// world. The distance from the cameras to the middle of the cloud is of the range.
    pub fn drawn(draw: &mut Draw, counts: [usize; 2], distance: [f64; 2], away: f64) -> Self {
        let middle = draw.vector(0.5 * away..away);
        let depth = distance[0];
        let points: Vec<Vector3<f64>> =
            (0..counts[1]).map(|_| middle + draw.vector(0.1 * depth..0.4 * depth)).collect();
        let pose = |draw: &mut Draw| {
            let rotation = draw.rotation(0.2..2.5);
            let depth = draw.uniform(distance[0]..distance[1]);
            let lean = Vector3::new(draw.uniform(-0.2..0.2), draw.uniform(-0.2..0.2), 1.0);
            Isometry3::from_parts((depth * lean - rotation * middle).into(), rotation.into())
        };
        let cameras: Vec<Isometry3<f64>> = (0..counts[0]).map(|_| pose(draw)).collect();
        let (moving, all) = (6 * counts[0], 6 * counts[0] + 3 * counts[1]);
        let step = DVector::from_fn(all, |row, _| match row {
            0..6 => 0.0,
            row if row < moving && row % 6 >= 3 => draw.uniform(-0.1..0.1),
            _ => draw.uniform(-0.3..0.3),
        });
        let factor = draw.uniform(1.3..3.0).powi(if draw.index(0..2) == 0 { 1 } else { -1 });
        Self { camera: Camera::drawn(draw), scene: Scene { cameras, points }, factor, step }
    }

    /// All pixels of the scene, camera by camera.
    fn pixels(&self, scene: &Scene) -> Vec<Vector2<f64>> {
        let pinhole = self.camera.pinhole();
        let pixel = |camera: &Isometry3<f64>, point: &Vector3<f64>| {
            let pixel = pinhole.project_cam(&(camera * Point3::from(*point)).coords);
            pixel.unwrap_or_else(|| Vector2::repeat(f64::NAN))
        };
        let seen = |camera| scene.points.iter().map(move |point| pixel(camera, point));
        scene.cameras.iter().flat_map(seen).collect()
    }

    /// The derivative of all pixels by all unknowns, by differences of the fourth order.
    fn jacobian(&self) -> DMatrix<f64> {
        const H: f64 = 1e-3;
        let unknowns = self.step.len();
        let columns: Vec<DVector<f64>> = (0..unknowns)
            .map(|column| {
                let pixels = |step: f64| {
                    let mut direction = DVector::zeros(unknowns);
                    direction[column] = step;
                    let pixels = self.pixels(&self.scene.moved(&direction));
                    DVector::from_iterator(
                        2 * pixels.len(),
                        pixels.iter().flat_map(|pixel| [pixel.x, pixel.y]),
                    )
                };
                let near = pixels(H) - pixels(-H);
                let far = pixels(2.0 * H) - pixels(-2.0 * H);
                (8.0 * near - far) / (12.0 * H)
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// The curvature of half the sum of squared residuals where the residuals are zero. As camera 0
    /// is pinned, its rows and columns are zero.
    fn hessian(&self) -> DMatrix<f64> {
        let mut jacobian = self.jacobian();
        jacobian.columns_mut(0, 6).fill(0.0);
        jacobian.tr_mul(&jacobian)
    }

    /// The direction in which no pixel changes and camera 0 stays, as long as it takes for the
    /// distance from camera 0 to point 0 to grow at its own rate.
    fn null_vector(&self) -> DVector<f64> {
        let hessian = self.hessian();
        let free = hessian.view((6, 6), (hessian.nrows() - 6, hessian.ncols() - 6)).into_owned();
        let eigen = free.symmetric_eigen();
        let weakest = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
        let direction = weakest.insert_rows(0, 6, 0.0);
        let distance = |scene: &Scene| (scene.points[0] - scene.centre(0)).norm();
        let rate = self.scene.rate(&direction, &distance);
        let direction = distance(&self.scene) / rate * direction;
        // Differences leave a little where there is nothing.
        let nothing = 1e-7 * direction.amax();
        direction.map(|part| if part.abs() < nothing { 0.0 } else { part })
    }

    /// What the rows of a vector of unknowns are.
    fn labels(&self) -> Vec<String> {
        let twist = ["ρ x", "ρ y", "ρ z", "φ x", "φ y", "φ z"];
        let cameras = (0..self.scene.cameras.len())
            .flat_map(|camera| twist.map(|axis| format!("cam {camera} {axis}")));
        let points = (0..self.scene.points.len())
            .flat_map(|point| ["x", "y", "z"].map(|axis| format!("pt {point} {axis}")));
        cameras.chain(points).collect()
    }

    /// Compares a vector of unknowns with what it should be, and with mistakes.
    fn judge(
        &self,
        what: &str,
        obtained: &DVector<f64>,
        expected: &DVector<f64>,
        candidates: &[(&'static Misconception, DVector<f64>)],
    ) -> Result<(), Failure> {
        let labels = self.labels();
        let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
        let mut comparison = compare(what, obtained, expected).within(1e-6).labelled(&labels, &[]);
        for (misconception, candidate) in candidates {
            comparison = comparison.or(misconception, candidate);
        }
        comparison.judge().map_err(|failure| failure.with_picture(self.above(expected, obtained)))
    }

    /// Where centres and points go in a tenth of a step, from above.
    fn above(&self, expected: &DVector<f64>, obtained: &DVector<f64>) -> Picture {
        let dots = |name: &str, step: &DVector<f64>| {
            let moved = if step.len() == self.step.len() && step.iter().all(|part| part.is_finite())
            {
                self.scene.moved(&(0.1 * step))
            } else {
                self.scene.clone()
            };
            let centres = (0..moved.cameras.len()).map(|index| moved.centre(index));
            let at = centres.chain(moved.points.iter().copied()).map(|place| [place.x, place.y]);
            Dots::new(name, at)
        };
        Picture {
            title: "Cameras and points after a tenth of the step, from above".to_owned(),
            axes: ["x, m".to_owned(), "y, m".to_owned()],
            expected: dots("expected", expected),
            obtained: dots("obtained", obtained),
            downward: false,
        }
    }
}

impl Scene {
    /// The centre of a camera, in the world.
    fn centre(&self, camera: usize) -> Vector3<f64> {
        self.cameras[camera].inverse().translation.vector
    }

    /// The scene after a step.
    fn moved(&self, step: &DVector<f64>) -> Self {
        let twist = |index: usize| Vector6::from_fn(|row, _| step[6 * index + row]);
        let first_point = 6 * self.cameras.len();
        let shift = |index: usize| Vector3::from_fn(|row, _| step[first_point + 3 * index + row]);
        let cameras = self.cameras.iter().enumerate();
        let points = self.points.iter().enumerate();
        Self {
            cameras: cameras.map(|(index, pose)| se3::retract(pose, &twist(index))).collect(),
            points: points.map(|(index, point)| point + shift(index)).collect(),
        }
    }

    /// The entries of all poses, as 4×4 matrices, and of all points.
    fn numbers(&self) -> DVector<f64> {
        let matrices = self.cameras.iter().map(Isometry3::to_homogeneous);
        let entries = matrices.flat_map(|matrix| matrix.iter().copied().collect::<Vec<f64>>());
        let points = self.points.iter().flat_map(|point| [point.x, point.y, point.z]);
        DVector::from_vec(entries.chain(points).collect())
    }

    /// What was done to the scene instead of growing it about camera 0, if that is known.
    fn grown_instead(&self, factor: f64, obtained: &Self) -> Option<&'static Misconception> {
        let same = |a: &Self, b: &Self| {
            let (a, b) = (a.numbers(), b.numbers());
            (&a - &b).amax() <= 1e-9 * b.amax()
        };
        let cameras = |pose: &dyn Fn(&Isometry3<f64>) -> Isometry3<f64>| Self {
            cameras: self.cameras.iter().map(pose).collect(),
            ..obtained.clone()
        };
        let at = |translation: Vector3<f64>, pose: &Isometry3<f64>| {
            Isometry3::from_parts(translation.into(), pose.rotation)
        };
        let about_origin = Self {
            points: self.points.iter().map(|point| factor * point).collect(),
            ..cameras(&|pose| at(factor * pose.translation.vector, pose))
        };
        let first = self.cameras[0].translation.vector;
        let translations =
            cameras(&|pose| at(first + factor * (pose.translation.vector - first), pose));
        let pinned = self.centre(0);
        let centre = |pose: &Isometry3<f64>| pose.inverse().translation.vector;
        let centres = cameras(&|pose| at(pinned + factor * (centre(pose) - pinned), pose));
        let turn = |pose: &Isometry3<f64>| {
            so3::exp_quaternion(&(factor * so3::log_quaternion(&pose.rotation)))
                .to_rotation_matrix()
        };
        let turned = self.cameras.iter().zip(&obtained.cameras).all(|(before, after)| {
            let off = turn(before).into_inner() - after.rotation.to_rotation_matrix().into_inner();
            off.amax() <= 1e-9
        });
        let cameras_stay = same(&cameras(&|pose| *pose), obtained);
        let points_stay = obtained.points == self.points;
        match () {
            () if cameras_stay && points_stay => None,
            () if same(&about_origin, obtained) => Some(&ABOUT_THE_ORIGIN),
            () if cameras_stay => Some(&CAMERAS_OMITTED),
            () if same(&translations, obtained) => Some(&TRANSLATION_FOR_CENTRE),
            () if same(&centres, obtained) => Some(&CENTRE_AS_TRANSLATION),
            () if turned => Some(&ROTATIONS_SCALED),
            () if points_stay => Some(&POINTS_OMITTED),
            () => None,
        }
    }

    /// How fast a length changes along a direction, by differences of the fourth order.
    fn rate(&self, direction: &DVector<f64>, length: &dyn Fn(&Self) -> f64) -> f64 {
        let size = 1e-3 / direction.amax().max(f64::MIN_POSITIVE);
        let at = |step: f64| length(&self.moved(&(step * size * direction)));
        (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * size)
    }

    /// The distance between the centres of cameras 0 and 1.
    fn baseline(&self) -> f64 {
        (self.centre(1) - self.centre(0)).norm()
    }
}

/// The instances that students have.
fn cases() -> Vec<Case> {
    let mut draw = Draw::new(2);
    (0..8).map(|index| Case::drawn(&mut draw, [2 + index % 3, 7], [4.0, 6.0], 4.0)).collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("a_rescaled_scene_shows_the_same_pixels", |answer| {
            cases().iter().try_for_each(|case| rescaling(answer, case))
        }),
        Check::new("the_direction_of_scale_is_the_one_that_no_pixel_resists", |answer| {
            cases().iter().try_for_each(|case| direction(answer, case))
        }),
        Check::new("annihilation_is_a_pure_number", |answer| {
            cases().iter().try_for_each(|case| measured(answer, case))
        }),
        Check::new("the_hessian_annihilates_scale_and_nothing_else_that_was_tried", |answer| {
            cases().iter().try_for_each(|case| annihilated(answer, case))
        }),
        Check::new("the_same_step_with_the_distance_held_moves_every_pixel_alike", |answer| {
            cases().iter().try_for_each(|case| held(answer, case))
        }),
    ]
}

/// A rescaled scene, by what it must leave alone and what it must multiply.
///
/// # Errors
///
/// A failure, which names what was done instead where that is known.
pub fn rescaling(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { scene, factor, .. } = case;
    let obtained = Answer(answer).rescaled(scene, factor)?;
    if obtained.cameras.len() != scene.cameras.len() || obtained.points.len() != scene.points.len()
    {
        return Err(Failure::new(format!(
            "The scene came back with {} cameras and {} points, and it had {} and {}.",
            obtained.cameras.len(),
            obtained.points.len(),
            scene.cameras.len(),
            scene.points.len()
        )));
    }
    if obtained.numbers().iter().any(|number| !number.is_finite()) {
        return Err(Failure::new("The rescaled scene: all its numbers must be finite."));
    }
    let moved = (obtained.cameras[0].to_homogeneous() - scene.cameras[0].to_homogeneous()).amax();
    let (before, after) = (case.pixels(scene), case.pixels(&obtained));
    let off = before.iter().zip(&after).map(|(before, after)| (after - before).norm());
    // A pixel that is lost behind its camera is as far off as can be.
    let off = off.map(|off| if off.is_nan() { f64::INFINITY } else { off }).fold(0.0, f64::max);
    let length = |scene: &Scene| (scene.points[0] - scene.centre(0)).norm();
    let times = length(&obtained) / length(scene);
    let table =
        |pixels: &[Vector2<f64>]| DMatrix::from_fn(pixels.len(), 2, |row, axis| pixels[row][axis]);
    show("the table of pixels after the change", &table(&after), &table(&before));
    show_list("the factor of the distance from camera 0 to point 0", &[times], &[*factor]);
    if moved <= 1e-9 && off <= 1e-6 && (times / factor - 1.0).abs() <= 1e-9 {
        return Ok(());
    }
    let failure = match scene.grown_instead(*factor, &obtained) {
        Some(misconception) => Failure::known(misconception),
        None if moved > 1e-9 => Failure::new("Camera 0 has moved, and it is pinned."),
        None if off > 1e-6 => Failure::new("Camera 0 stays where it is, and pixels change."),
        None => Failure::new("No pixel changes, and distances are not as many times as long."),
    };
    let numbers = format!(
        "factor                                             {}\n\
         camera 0, greatest change of an entry of its pose  {} (expected 0)\n\
         greatest move of a pixel                           {} px (expected 0)\n\
         distance from camera 0 to point 0, times           {} (expected {})",
        readable(*factor),
        readable(moved),
        readable(off),
        readable(times),
        readable(*factor)
    );
    let count = scene.points.len();
    let last = before.len() - count;
    let dots = |name: &str, pixels: &[Vector2<f64>]| {
        Dots::new(name, pixels[last..].iter().map(|pixel| [pixel.x, pixel.y]))
    };
    Err(failure.with_numbers(numbers).with_picture(Picture {
        title: "The last camera's picture before and after".to_owned(),
        axes: ["u, px".to_owned(), "v, px".to_owned()],
        expected: dots("before", &before),
        obtained: dots("after", &after),
        downward: true,
    }))
}

/// The direction of scale, against the weakest direction of a Hessian made by differences.
///
/// # Errors
///
/// A failure, which names the direction that came back where that is known.
pub fn direction(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { scene, .. } = case;
    let obtained = Answer(answer).scale_direction(scene)?;
    let expected = case.null_vector();
    let first_point = 6 * scene.cameras.len();
    let part = |of: &dyn Fn(usize) -> f64| DVector::from_fn(expected.len(), |row, _| of(row));
    let is_camera = |row: usize| row < first_point;
    let origin = part(&|row| {
        if is_camera(row) {
            two_views::scale_direction(&scene.cameras[row / 6])[row % 6]
        } else {
            scene.points[(row - first_point) / 3][(row - first_point) % 3]
        }
    });
    let in_camera = part(&|row| match row {
        row if !is_camera(row) || row % 6 >= 3 => expected[row],
        row => {
            let rho = expected.fixed_rows::<3>(row - row % 6).into_owned();
            (scene.cameras[row / 6].rotation * rho)[row % 6]
        }
    });
    let length = expected.len();
    case.judge(
        "the direction of scale",
        &obtained,
        &expected,
        &[
            (&ABOUT_THE_ORIGIN, origin.clone()),
            (&PIN_ERASED, part(&|row| if row < 6 { 0.0 } else { origin[row] })),
            (&TWO_CENTRES, part(&|row| if is_camera(row) { expected[row] } else { origin[row] })),
            (&POINTS_OMITTED, part(&|row| if is_camera(row) { expected[row] } else { 0.0 })),
            (&CAMERAS_OMITTED, part(&|row| if is_camera(row) { 0.0 } else { expected[row] })),
            (&OTHER_SIGN, part(&|row| if is_camera(row) { -expected[row] } else { expected[row] })),
            (&CAMERA_AXES, in_camera),
            (&POINTS_FIRST, part(&|row| expected[(row + first_point) % length])),
            (
                &ROTATION_FIRST,
                part(&|row| match row {
                    row if !is_camera(row) => expected[row],
                    row => expected[row - row % 6 + (row % 6 + 3) % 6],
                }),
            ),
            (&UNIT_LENGTH, expected.normalize()),
        ],
    )
    .map_err(|failure| {
        if obtained.len() != length || obtained.iter().any(|part| !part.is_finite()) {
            return failure;
        }
        let numbers = format!(
            "{}\nalong what came back pixels move by up to {} px",
            failure.numbers.trim_end(),
            readable((case.jacobian() * &obtained).amax())
        );
        failure.with_numbers(numbers)
    })
}

/// The measure of a null vector on a Hessian and any direction, against its eigenvalues; and that
/// multiples do not change it.
///
/// # Errors
///
/// A failure, which names what was left out where that is known.
pub fn measured(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let hessian = case.hessian();
    for (weight, length) in [(1.0, 1.0), (1e-4, 1.0), (1.0, 50.0), (3e3, 0.02)] {
        let (hessian, direction) = (weight * &hessian, length * &case.step);
        let obtained = Answer(answer).annihilation(&hessian, &direction)?;
        let eigen = hessian.clone().symmetric_eigen();
        let share = eigen.eigenvectors.tr_mul(&direction);
        let product = eigen.eigenvalues.component_mul(&share);
        let (h, v) = (eigen.eigenvalues.norm(), direction.norm());
        compare_number("the annihilation", obtained, product.norm() / (h * v))
            .or_number(&NOT_RELATIVE, product.norm())
            .or_number(&NOT_RELATIVE, product.norm() / h)
            .or_number(&NOT_RELATIVE, product.norm() / v)
            .or_number(&QUADRATIC_FORM, product.dot(&share) / (h * v * v))
            .judge()?;
    }
    Ok(())
}

/// The student's own direction and the student's own measure on the same Hessian. Each must be right
/// by itself: two that are wrong can agree.
///
/// # Errors
///
/// A failure when the direction of scale is not a null vector, or when everything is.
pub fn annihilated(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let hessian = case.hessian();
    let of_scale = Answer(answer).scale_direction(&case.scene)?;
    if of_scale.len() != case.step.len() {
        return Err(Failure::new(format!(
            "The direction of scale has {} numbers, and there are {} unknowns.",
            of_scale.len(),
            case.step.len()
        )));
    }
    let ask = |direction: &DVector<f64>| Answer(answer).annihilation(&hessian, direction);
    let (along, other) = (ask(&of_scale)?, ask(&case.step)?);
    let what = "the pair of measures, of your direction of scale and of a step drawn at random,";
    show_list(what, &[along, other], &[0.0, other]);
    // The Hessian comes from differences, and so is off by about 1e-11.
    let agree = along.abs() <= 1e-8 && (1e-4..=1.0).contains(&other);
    if agree && direction(answer, case).is_ok() && measured(answer, case).is_ok() {
        return Ok(());
    }
    let failure = Failure::new(
        "Your measure was asked about your direction of scale, where it should be zero, and about \
         a step drawn at random, where it should not.",
    )
    .with_numbers(format!(
        "scale:         {} (expected at most 1e-8)\na random step: {} (expected between 1e-4 and 1)",
        readable(along),
        readable(other)
    ));
    let failure = failure.unless("scale_direction", || direction(answer, case));
    Err(failure.unless("annihilation", || measured(answer, case)))
}

/// A step with the distance held, against one found from the null vector and differences.
///
/// # Errors
///
/// A failure, which names the step that came back where that is known.
pub fn held(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { scene, step, .. } = case;
    let obtained = Answer(answer).with_distance_held(scene, step)?;
    let of_scale = case.null_vector();
    let rate = |direction: &DVector<f64>| scene.rate(direction, &Scene::baseline);
    let without = |share: f64| step - share * &of_scale;
    let share = rate(step) / rate(&of_scale);
    let mut unturned = step.clone();
    unturned.rows_mut(9, 3).fill(0.0);
    let mut alone = step.clone();
    for axis in 6..9 {
        // Each coordinate of ρ moves the distance at a rate of its own; they make up a unit vector.
        let unit = DVector::from_fn(step.len(), |row, _| f64::from(u8::from(row == axis)));
        alone[axis] -= rate(step) * rate(&unit);
    }
    case.judge(
        "the step with the distance held",
        &obtained,
        &without(share),
        &[
            (&ORTHOGONAL_SHARE, without(of_scale.dot(step) / of_scale.norm_squared())),
            (&ONE_CAMERA_ONLY, alone),
            (&TURN_FORGOTTEN, without(rate(&unturned) / rate(&of_scale))),
            (&SHARE_ADDED, without(-share)),
        ],
    )
    .map_err(|failure| {
        if obtained.len() != step.len() || obtained.iter().any(|part| !part.is_finite()) {
            return failure.unless("scale_direction", || direction(answer, case));
        }
        let numbers = format!(
            "{}\nthe distance changes by {} m for the step given, by {} m for the one returned; \
             pixels differ by up to {} px",
            failure.numbers.trim_end(),
            readable(rate(step)),
            readable(rate(&obtained)),
            readable((case.jacobian() * (&obtained - step)).amax())
        );
        failure.with_numbers(numbers).unless("scale_direction", || direction(answer, case))
    })
}
