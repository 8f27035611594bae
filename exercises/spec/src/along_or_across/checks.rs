//! What is asked about an answer, and on which instances.

use nalgebra::{DMatrix, Isometry3, Matrix3, Point3, Vector2, Vector3};

use super::*;
use crate::Exercise;
use crate::answer::Transport;
use crate::camera::point_in_view;
use crate::check::{Check, Failure, compare, readable, show};
use crate::draw::Draw;
use crate::picture::{Dots, Picture};

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "along_or_across",
    title: "Null spaces of triangulation",
    chapter: "two_views",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["View"],
    forbidden: &["msckf", "two_views"],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    ALONG_THE_AXIS, "along_the_axis":
        "This drag is parallel to the optical axis. The point does not lie on that axis, and its \
         pixel moves: what line joins the point to the place that all rays of a camera share?";
    TOWARDS_THE_CAMERA, "towards_the_camera":
        "The line is right, and the point comes nearer on it. From which of its ends to which does \
         the drag lead?";
    UNIT_FORGOTTEN, "unit_forgotten":
        "The direction is right, and the drag is as many times too long as the point is metres away. \
         What should the length of a vector be before it is multiplied by a distance?";
    DEPTH_FOR_DISTANCE, "depth_for_distance":
        "This drag makes the point's depth grow by the distance given. Depth is counted along the \
         optical axis: how long is the way on a ray that leans away from it?";
    CAMERA_COORDINATES, "camera_coordinates":
        "The drag has the right length and stands in the axes of the camera. The point is in the \
         world: what takes a direction from the camera's axes to those of the world?";
    FROM_THE_ORIGIN, "from_the_origin":
        "This drag leads away from the origin of the world. Is that where the camera has its centre?";
    TRANSLATION_FOR_CENTRE, "translation_for_centre":
        "This drag leads away from the place whose coordinates are the translation of \
         camera_from_world. What does camera_from_world make of that place, and what should it make \
         of the camera's own centre?";
    OTHER_CAMERA, "other_camera":
        "This is the drag of camera 0, and another camera was asked for. What does `seen_from` say?";
    ALONG_X, "along_x":
        "This drag is along the camera's x axis. Take its product with the direction of the ray: \
         for which points would it be zero?";
    PRODUCT_NOT_UNIT, "product_not_unit":
        "The direction is right and the length is not. How long is the product of two vectors that \
         are not square to each other, even when both have length one?";
    TO_THE_LEFT, "to_the_left":
        "The drag has the right line and length, and the camera sees the point go to the left. In \
         which order do y axis and ray stand in your product?";
    DRAG_NOT_TURNED, "drag_not_turned":
        "The moves are right for a drag whose numbers are read in the axes of each camera. In which \
         frame is the drag given, and how does a camera that is turned see it?";
    OLD_MINUS_NEW, "old_minus_new":
        "All moves have the wrong sign. These are old place minus new: which of the two does the \
         specification subtract?";
    EXACT_FOR_FIRST_ORDER, "exact_for_first_order":
        "These are the exact moves. Double the drag, and they do not double: what do they owe to \
         the square of the drag?";
    FIRST_ORDER_FOR_EXACT, "first_order_for_exact":
        "These moves are proportional to the drag. A point that recedes slows down in the picture: \
         where does the pixel end up?";
    FIRST_RAY_ONLY, "first_ray_only":
        "This is the ray of camera 0. That camera notices nothing of the drag, and the others do: \
         could a slightly different direction be cheaper for all of them together?";
    MOST_NOTICED, "most_noticed":
        "Of all drags of length one this one is noticed most. Which end of the list of singular \
         values, or of eigenvalues, was asked for?";
}

/// Several views of a point, and a drag.
#[derive(Debug, Clone)]
pub struct Case {
    /// The views.
    pub views: Vec<View>,
    /// The point, in front of all of them.
    pub point_in_world: Vector3<f64>,
    /// Some drag, in the world.
    pub drag: Vector3<f64>,
}

impl Case {
    /// A number of views that stand beside one another. The point has a depth of the range in
    /// the first of them, in metres; the centres of the others are up to `spread` of its distance
    /// away from the first, and zero puts them all in one place. The drag is of up to a tenth of
    /// the depth.
    pub fn drawn(draw: &mut Draw, count: usize, depth: [f64; 2], spread: f64) -> Self {
        let point_in_world = draw.vector(1.0..6.0);
        let first = draw.rotation(0.3..2.5);
        let seen = point_in_view(draw, depth[0], depth[1]);
        let view = |index: usize, draw: &mut Draw| {
            let (turn, shift) = match index {
                0 => (draw.rotation(0.0..1e-9), Vector3::zeros()),
                _ => (draw.rotation(0.05..0.2), draw.vector(0.3 * spread..spread + 1e-300)),
            };
            let rotation = turn * first;
            let translation = turn * (seen + seen.norm() * shift) - rotation * point_in_world;
            let camera_from_world = Isometry3::from_parts(translation.into(), rotation.into());
            View { camera: Camera::drawn(draw), camera_from_world }
        };
        let views = (0..count).map(|index| view(index, draw)).collect();
        Self { views, point_in_world, drag: draw.vector(0.03 * seen.z..0.1 * seen.z) }
    }

    /// Camera 1 stands half a metre to the right of camera 0, which is at the world's origin, and
    /// both look at the point of the book's worked example.
    pub fn of_the_book() -> Self {
        let view = |x: f64| View {
            camera: Camera::of_the_book(),
            camera_from_world: Isometry3::translation(-x, 0.0, 0.0),
        };
        Self {
            views: vec![view(0.0), view(0.5)],
            point_in_world: Vector3::new(0.2, -0.1, 5.0),
            drag: Vector3::new(0.1, 0.0, 0.0),
        }
    }
}

impl View {
    fn in_camera(&self, point_in_world: &Vector3<f64>) -> Vector3<f64> {
        (self.camera_from_world * Point3::from(*point_in_world)).coords
    }

    /// The pixel of a point in camera coordinates. Instances keep their points in front.
    fn pixel(&self, point_in_camera: &Vector3<f64>) -> Vector2<f64> {
        let pixel = self.camera.pinhole().project_cam(point_in_camera);
        pixel.unwrap_or_else(|| Vector2::repeat(f64::NAN))
    }

    /// The derivative of the pixel by a point's way along a vector in camera coordinates, by
    /// differences of the fourth order.
    fn slope(&self, point_in_camera: &Vector3<f64>, way: &Vector3<f64>) -> Vector2<f64> {
        const H: f64 = 1e-3;
        let pixel = |step: f64| self.pixel(&(point_in_camera + step * way));
        let near = pixel(H) - pixel(-H);
        let far = pixel(2.0 * H) - pixel(-2.0 * H);
        (8.0 * near - far) / (12.0 * H)
    }

    /// The derivative of the pixel by a point's way along a vector in the world.
    fn slope_in_world(&self, point_in_world: &Vector3<f64>, way: &Vector3<f64>) -> Vector2<f64> {
        self.slope(&self.in_camera(point_in_world), &(self.camera_from_world.rotation * way))
    }

    /// The directions in the world in which u and v of a point grow fastest.
    fn gradients(&self, point_in_world: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let slopes = axes.map(|axis| self.slope_in_world(point_in_world, &axis));
        [0, 1].map(|row| Vector3::from_fn(|axis, _| slopes[axis][row]))
    }

    /// The direction in the world in which neither u nor v changes, away from the camera.
    fn unseen(&self, point_in_world: &Vector3<f64>) -> Vector3<f64> {
        let [u, v] = self.gradients(point_in_world);
        u.cross(&v).normalize()
    }

    /// An axis of the camera, in the world.
    fn axis(&self, axis: &Vector3<f64>) -> Vector3<f64> {
        self.camera_from_world.rotation.inverse_transform_vector(axis)
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];
const METRES: [&str; 1] = ["m"];
const PIXEL: [&str; 2] = ["u, px", "v, px"];
const CAMERAS: [&str; 4] = ["camera 0", "camera 1", "camera 2", "camera 3"];

/// The instances that students have.
fn cases() -> Vec<Case> {
    let mut draw = Draw::new(6);
    (0..20).map(|index| Case::drawn(&mut draw, 2 + index % 3, [2.0, 8.0], 0.25)).collect()
}

/// Views in one place, and single ones.
fn degenerate() -> Vec<Case> {
    let mut draw = Draw::new(7);
    (0..10).map(|index| Case::drawn(&mut draw, 1 + index % 3, [2.0, 8.0], 0.0)).collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("a_drag_along_the_ray_leaves_the_pixel_of_its_camera", |answer| {
            cases().iter().try_for_each(|case| along(answer, case))
        }),
        Check::new("a_drag_across_is_square_to_the_ray_and_to_the_y_axis", |answer| {
            cases().iter().try_for_each(|case| across(answer, case))
        }),
        Check::new("predicted_moves_are_slopes_times_the_drag", |answer| {
            cases().iter().try_for_each(|case| predicted(answer, case))
        }),
        Check::new("exact_moves_are_differences_of_pixels", |answer| {
            cases().iter().try_for_each(|case| exact(answer, case))
        }),
        Check::new("the_least_noticed_drag_beats_every_other", |answer| {
            cases().iter().try_for_each(|case| least_noticed(answer, case))
        }),
        Check::new("cameras_in_one_place_share_the_drag_that_none_of_them_sees", |answer| {
            degenerate().iter().try_for_each(|case| least_noticed(answer, case))
        }),
        Check::new("a_drag_along_the_ray_shows_in_the_other_camera_only", |answer| {
            worked(answer, &Case::of_the_book(), 0.1)
        }),
    ]
}

/// Drags along the ray of every camera, against the direction in which no pixel changes.
///
/// # Errors
///
/// A failure, which names the drag that came back where that is known.
pub fn along(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let point = &case.point_in_world;
    let distance = case.drag.norm();
    // The last camera comes first: it has a ray of its own.
    for (index, view) in case.views.iter().enumerate().rev() {
        let obtained = Answer(answer).drag_along(&case.views, &index, point, &distance)?;
        let expected = distance * view.unseen(point);
        let in_camera = view.in_camera(point);
        let translation = view.camera_from_world.translation.vector;
        compare("the drag along the ray", &obtained, &expected)
            .within(1e-7)
            .labelled(&AXES, &METRES)
            .or(&ALONG_THE_AXIS, &(distance * view.axis(&Vector3::z())))
            .or(&TOWARDS_THE_CAMERA, &-expected)
            .or(&UNIT_FORGOTTEN, &(in_camera.norm() * expected))
            .or(&DEPTH_FOR_DISTANCE, &(in_camera.norm() / in_camera.z * expected))
            .or(&CAMERA_COORDINATES, &(view.camera_from_world.rotation * expected))
            .or(&FROM_THE_ORIGIN, &(distance * point.normalize()))
            .or(&TRANSLATION_FOR_CENTRE, &(distance * (point - translation).normalize()))
            .or(&OTHER_CAMERA, &(distance * case.views[0].unseen(point)))
            .judge()
            .map_err(|failure| case.told(failure, index, &expected, &obtained))?;
    }
    Ok(())
}

/// Drags across the ray of every camera, against the direction with the smallest part along the
/// ray and along the y axis.
///
/// # Errors
///
/// A failure, which names the drag that came back where that is known.
pub fn across(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let point = &case.point_in_world;
    let distance = case.drag.norm();
    let square = |view: &View| {
        let parts = [view.unseen(point), view.axis(&Vector3::y())];
        let least = least_eigenvector(&parts.map(|part| part * part.transpose()).iter().sum());
        let [u, _] = view.gradients(point);
        distance * u.dot(&least).signum() * least
    };
    for (index, view) in case.views.iter().enumerate().rev() {
        let obtained = Answer(answer).drag_across(&case.views, &index, point, &distance)?;
        let expected = square(view);
        let sine = view.axis(&Vector3::y()).cross(&view.unseen(point)).norm();
        compare("the drag across the ray", &obtained, &expected)
            .within(1e-7)
            .labelled(&AXES, &METRES)
            .or(&TO_THE_LEFT, &-expected)
            .or(&PRODUCT_NOT_UNIT, &(sine * expected))
            .or(&PRODUCT_NOT_UNIT, &(view.in_camera(point).norm() * sine * expected))
            .or(&ALONG_X, &(distance * view.axis(&Vector3::x())))
            .or(&CAMERA_COORDINATES, &(view.camera_from_world.rotation * expected))
            .or(&OTHER_CAMERA, &square(&case.views[0]))
            .judge()
            .map_err(|failure| case.told(failure, index, &expected, &obtained))?;
    }
    Ok(())
}

impl Case {
    /// A failure with what can be said of any drag that camera `index` was asked for.
    fn told(
        &self,
        failure: Failure,
        index: usize,
        expected: &Vector3<f64>,
        obtained: &Vector3<f64>,
    ) -> Failure {
        let (view, point) = (&self.views[index], &self.point_in_world);
        let length = obtained.norm();
        if !length.is_normal() {
            return failure;
        }
        let degrees =
            (obtained.dot(&view.unseen(point)) / length).clamp(-1.0, 1.0).acos().to_degrees();
        let numbers = format!(
            "{}\nasked for camera {index} and {} m; what came back is {} m long and makes an angle of \
             {degrees:.1}° with the ray of that camera",
            failure.numbers.trim_end(),
            readable(expected.norm()),
            readable(length)
        );
        failure.with_numbers(numbers).with_picture(beside(expected, obtained))
    }
}

/// A drag beside the one expected. Whatever is wrong with it is in one of its two parts.
fn beside(expected: &Vector3<f64>, obtained: &Vector3<f64>) -> Picture {
    let direction = expected.normalize();
    let dots = |name: &str, drag: &Vector3<f64>| {
        let along = drag.dot(&direction);
        let off = (drag - along * direction).norm();
        Dots::new(name, [[0.0, 0.0], [along, off]]).with_ways([[along, off]])
    };
    Picture {
        title: "The drag from (0, 0), by its parts along and square to the one expected".to_owned(),
        axes: ["along it, m".to_owned(), "square to it, m".to_owned()],
        expected: dots("expected", expected),
        obtained: dots("obtained", obtained),
        downward: false,
    }
}

/// Moves of the pixels to first order, against differences with a small part of the drag.
///
/// # Errors
///
/// A failure, which names the moves that came back where that is known.
pub fn predicted(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { views, point_in_world, drag } = case;
    let obtained = Answer(answer).predicted_moves(views, point_in_world, drag)?;
    let [slopes, unturned, exact] = case.moves();
    compare("the list of predicted moves", &rows(&obtained), &slopes)
        .within(1e-7)
        .labelled(&CAMERAS, &PIXEL)
        .or(&DRAG_NOT_TURNED, &unturned)
        .or(&OLD_MINUS_NEW, &-&slopes)
        .or(&EXACT_FOR_FIRST_ORDER, &exact)
        .judge()
        .map_err(|failure| failure.with_picture(in_pixels(&slopes, &obtained)))
}

/// Moves of the pixels, against their differences.
///
/// # Errors
///
/// A failure, which names the moves that came back where that is known.
pub fn exact(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { views, point_in_world, drag } = case;
    let obtained = Answer(answer).exact_moves(views, point_in_world, drag)?;
    let [slopes, _, exact] = case.moves();
    let unturned = |view: &View| {
        let before = view.in_camera(point_in_world);
        view.pixel(&(before + drag)) - view.pixel(&before)
    };
    let unturned: Vec<Vector2<f64>> = views.iter().map(unturned).collect();
    compare("the list of exact moves", &rows(&obtained), &exact)
        .labelled(&CAMERAS, &PIXEL)
        .or(&DRAG_NOT_TURNED, &rows(&unturned))
        .or(&OLD_MINUS_NEW, &-&exact)
        .or(&FIRST_ORDER_FOR_EXACT, &slopes)
        .judge()
        .map_err(|failure| failure.with_picture(in_pixels(&exact, &obtained)))
}

impl Case {
    /// Moves of the pixels, one camera a row: by slopes, by slopes with the drag in the axes of
    /// each camera, and by differences of pixels.
    fn moves(&self) -> [DMatrix<f64>; 3] {
        let Self { point_in_world: point, drag, .. } = self;
        let table = |of: &dyn Fn(&View) -> Vector2<f64>| {
            rows(&self.views.iter().map(of).collect::<Vec<_>>())
        };
        [
            table(&|view| view.slope_in_world(point, drag)),
            table(&|view| view.slope(&view.in_camera(point), drag)),
            table(&|view| {
                view.pixel(&view.in_camera(&(point + drag))) - view.pixel(&view.in_camera(point))
            }),
        ]
    }
}

/// One move a row.
fn rows(moves: &[Vector2<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(moves.len(), 2, |row, column| moves[row][column])
}

/// The ends of moves that all begin at zero.
fn in_pixels(expected: &DMatrix<f64>, obtained: &[Vector2<f64>]) -> Picture {
    // Lines lead back to where all begin.
    let ends = |name: &str, ends: Vec<[f64; 2]>| {
        let begin = vec![[0.0, 0.0]; ends.len()];
        Dots::new(name, ends).with_ways(begin)
    };
    Picture {
        title: "Where the pixels go, from (0, 0)".to_owned(),
        axes: ["u, px".to_owned(), "v, px".to_owned()],
        expected: ends("expected", expected.row_iter().map(|row| [row[0], row[1]]).collect()),
        obtained: ends("obtained", obtained.iter().map(|end| [end.x, end.y]).collect()),
        downward: true,
    }
}

/// The eigenvector of the smallest eigenvalue.
fn least_eigenvector(matrix: &Matrix3<f64>) -> Vector3<f64> {
    eigenvector(matrix, Vector3::imin)
}

fn eigenvector(matrix: &Matrix3<f64>, which: impl Fn(&Vector3<f64>) -> usize) -> Vector3<f64> {
    let eigen = matrix.symmetric_eigen();
    eigen.eigenvectors.column(which(&eigen.eigenvalues)).into_owned()
}

/// The drag that all cameras together notice least, against the weakest direction of the
/// gradients found by differences.
///
/// # Errors
///
/// A failure when a shorter sum of squares exists, or when the drag is not of length one or leads
/// towards camera 0.
pub fn least_noticed(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { views, point_in_world: point, .. } = case;
    let obtained = Answer(answer).least_noticed_drag(views, point)?;
    let gradients = views.iter().flat_map(|view| view.gradients(point));
    let information: Matrix3<f64> = gradients.map(|gradient| gradient * gradient.transpose()).sum();
    let first = views[0].unseen(point);
    let away = |drag: Vector3<f64>| drag.dot(&first).signum() * drag;
    let expected = away(least_eigenvector(&information));
    let most = eigenvector(&information, Vector3::imax);
    // The most noticed drag is square to the ray, or nearly: either sign of it is that mistake.
    let most = most.dot(&obtained).signum() * most;
    compare("the drag that is noticed least", &obtained, &expected)
        .within(1e-6)
        .labelled(&AXES, &["m"])
        .or(&TOWARDS_THE_CAMERA, &-expected)
        .or(&CAMERA_COORDINATES, &(views[0].camera_from_world.rotation * expected))
        .or(&FIRST_RAY_ONLY, &first)
        .or(&MOST_NOTICED, &most)
        .judge()
        .map_err(|failure| {
            if obtained.iter().any(|part| !part.is_finite()) {
                return failure;
            }
            let noticed = |drag: &Vector3<f64>| {
                let squares = views.iter().map(|view| view.slope_in_world(point, drag).norm_squared());
                let root = squares.sum::<f64>().sqrt();
                // Differences leave a little where there is nothing.
                readable(if root < 1e-6 { 0.0 } else { root })
            };
            let numbers = format!(
                "{}\nall cameras together notice {} px per metre of the one expected, {} of the one \
                 obtained",
                failure.numbers,
                noticed(&expected),
                noticed(&obtained)
            );
            failure.with_numbers(numbers).with_picture(beside(&expected, &obtained))
        })
}

/// Drags along and across the ray of camera 0, and what both cameras of a pair read.
///
/// # Errors
///
/// A failure when the readings are not those of the drags.
pub fn worked(transport: &dyn Transport, case: &Case, distance: f64) -> Result<(), Failure> {
    let Case { views, point_in_world: point, .. } = case;
    let answer = Answer(transport);
    let axis = views[0].axis(&Vector3::y());
    let ray = views[0].unseen(point);
    let drags = [
        ("along", answer.drag_along(views, &0, point, &distance)?, ray),
        ("across", answer.drag_across(views, &0, point, &distance)?, axis.cross(&ray).normalize()),
    ];
    let mut lines = String::new();
    let mut right = true;
    for (name, drag, direction) in drags {
        let moves = answer.exact_moves(views, point, &drag)?;
        let dragged = Case { drag: distance * direction, ..case.clone() };
        let [.., expected] = dragged.moves();
        let lengths = |table: &DMatrix<f64>| {
            let lengths = table.row_iter().map(|row| format!("{:.2}", row.norm()));
            lengths.collect::<Vec<_>>().join(" and ")
        };
        let obtained = rows(&moves);
        show("the table of moves of a point that is dragged", &obtained, &expected);
        right &= obtained.shape() == expected.shape()
            && (&obtained - &expected).amax() <= 1e-7 * expected.amax()
            && obtained.iter().all(|number| number.is_finite());
        lines += &format!(
            "{name:>6}: {} px expected, {} px obtained\n",
            lengths(&expected),
            lengths(&obtained)
        );
    }
    if right {
        return Ok(());
    }
    let sentence = "The point was dragged along the ray of camera 0 and then across it, and the \
        moves of the pixels in cameras 0 and 1 were read off. They are not what these drags produce. \
        The checks of the single functions say more.";
    let case = &Case { drag: distance * ray, ..case.clone() };
    Err(Failure::new(sentence)
        .with_numbers(lines)
        .unless("drag_along", || along(transport, case))
        .unless("drag_across", || across(transport, case))
        .unless("exact_moves", || exact(transport, case)))
}
