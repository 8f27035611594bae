//! Where a camera stood: Gauss-Newton on its pose, by the answer's derivative of the pixels and by the book's.

use exercise_spec::Exercise;
use exercise_spec::camera::{Camera, point_in_view};
use exercise_spec::draw::Draw;
use exercise_spec::left_perturbation::{Answer, Side};
use nalgebra::{Isometry3, Matrix2x6, Point3, Vector2, Vector3, Vector6};
use vislam::least_squares::{Factor, Kernel, Key, Problem};
use vislam::manifold::se3;
use widgets::{Axis, Control, Face, Panel, Scene, Shape, Style, Widget};

use crate::Asked;
use crate::descent::{self, BOOKS, COSTS, HERS, Trouble, Way, steps};

/// Points that the camera has seen.
const POINTS: usize = 12;

/// A search for a pose.
pub struct LeftPerturbation {
    answer: Asked,
}

impl LeftPerturbation {
    /// The picture of an answer.
    pub fn of(_: &'static Exercise, answer: Asked) -> Self {
        Self { answer }
    }
}

/// Where the derivative comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    Book,
    Left,
    RightFromLeft,
    Differences(Side),
}

/// What can be chosen, in the order of the face.
const SOURCES: [Source; 4] = [
    Source::Left,
    Source::RightFromLeft,
    Source::Differences(Side::Left),
    Source::Differences(Side::Right),
];

/// A point and where it was seen.
#[derive(Clone)]
struct Seen {
    point_in_world: Vector3<f64>,
    pixel: Vector2<f64>,
    camera: Camera,
    pose: Key<Isometry3<f64>>,
    source: Source,
    answer: Asked,
    trouble: Trouble,
}

impl Seen {
    /// The derivative by a twist on the right, as a pose is moved here.
    fn derivative(&self, pose: &Isometry3<f64>) -> Option<Matrix2x6<f64>> {
        let (camera, point) = (&self.camera, &self.point_in_world);
        let asked = (*camera).into();
        let answer = Answer(&*self.answer);
        let asked = match self.source {
            Source::Book => {
                return camera
                    .pinhole()
                    .project_with_jacobians(pose, point)
                    .map(|seen| seen.by_pose);
            }
            Source::Left => answer.left_pose_jacobian(&asked, pose, point),
            Source::RightFromLeft => answer
                .left_pose_jacobian(&asked, pose, point)
                .and_then(|left| answer.right_from_left(pose, &left)),
            Source::Differences(side) => {
                answer.central_differences(&asked, pose, point, &side, &1e-4)
            }
        };
        let asked = self.trouble.or_keep(asked)?;
        let on_the_left = matches!(self.source, Source::Left | Source::Differences(Side::Left));
        // T exp(ξ) = exp(Ad ξ) T: a twist on the right is that one on the left.
        Some(if on_the_left { asked * se3::adjoint(pose) } else { asked })
    }
}

impl Factor<2> for Seen {
    type Variables = (Isometry3<f64>,);
    type Jacobians = (Matrix2x6<f64>,);

    fn variables(&self) -> (Key<Isometry3<f64>>,) {
        (self.pose,)
    }

    fn residual(&self, (pose,): (&Isometry3<f64>,)) -> Option<Vector2<f64>> {
        Some(self.camera.pinhole().project(pose, &self.point_in_world)? - self.pixel)
    }

    fn linearize(&self, values: (&Isometry3<f64>,)) -> Option<(Vector2<f64>, (Matrix2x6<f64>,))> {
        Some((self.residual(values)?, (self.derivative(values.0)?,)))
    }
}

/// A camera, what it saw, and where the search begins.
struct Setting {
    camera: Camera,
    start: Isometry3<f64>,
    seen: Vec<(Vector3<f64>, Vector2<f64>)>,
}

impl Setting {
    fn drawn(number: f64, turned: f64, shifted: f64) -> Self {
        let mut draw = Draw::new(number as u64);
        let camera = Camera::of_the_book();
        let truth = draw.pose(0.5..1.2, 1.0..3.0);
        let point = |draw: &mut Draw| {
            let in_camera = point_in_view(draw, 4.0, 9.0);
            let in_world = (truth.inverse() * Point3::from(in_camera)).coords;
            Some((in_world, camera.pinhole().project_cam(&in_camera)?))
        };
        let seen = (0..POINTS).filter_map(|_| point(&mut draw)).collect();
        let (turn, shift) = (turned.to_radians() * draw.direction(), shifted * draw.direction());
        let xi = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
        Self { camera, start: se3::exp(&xi) * truth, seen }
    }

    /// How far the derivative at the start is from the book's, for one point.
    fn difference(&self, answer: &Asked, source: Source, trouble: &Trouble) -> Option<f64> {
        let pose = Problem::new().add_variable(self.start);
        let of =
            |source| self.factors(pose, answer, source, trouble).next()?.derivative(&self.start);
        descent::difference(of(source), of(Source::Book))
    }

    /// What each point says of the pose.
    fn factors(
        &self,
        pose: Key<Isometry3<f64>>,
        answer: &Asked,
        source: Source,
        trouble: &Trouble,
    ) -> impl Iterator<Item = Seen> {
        self.seen.iter().map(move |&(point_in_world, pixel)| Seen {
            point_in_world,
            pixel,
            camera: self.camera,
            pose,
            source,
            answer: answer.clone(),
            trouble: trouble.clone(),
        })
    }

    fn way(
        &self,
        answer: &Asked,
        source: Source,
        steps: usize,
        trouble: &Trouble,
    ) -> Way<Isometry3<f64>> {
        let mut problem = Problem::new();
        let pose = problem.add_variable(self.start);
        for factor in self.factors(pose, answer, source, trouble) {
            // The variable is the problem's own.
            let _ = problem.add_factor(factor, Kernel::Squared);
        }
        let off = |pose: &Isometry3<f64>, (point, pixel): &(Vector3<f64>, Vector2<f64>)| {
            let seen = self.camera.pinhole().project(pose, point);
            seen.map_or(f64::NAN, |seen| 0.5 * (seen - pixel).norm_squared())
        };
        let cost = |pose: &Isometry3<f64>| self.seen.iter().map(|seen| off(pose, seen)).sum();
        Way::gone(&problem, steps, |values| values[pose], cost)
    }
}

impl Widget for LeftPerturbation {
    const FACE: Face = Face {
        lead: "A camera has seen known points, and its pose is sought: Gauss-Newton steps, once with your derivative \
               and once with the book's, from one start.",
        controls: &[
            Control::choice(
                "derivative",
                "Derivative",
                &[
                    "left_pose_jacobian",
                    "right_from_left of it",
                    "central_differences, left",
                    "central_differences, right",
                ],
            ),
            Control::slider("turned", "Start turned by", "°", [10.0, 0.0, 40.0, 1.0]),
            Control::slider("shifted", "Start shifted by", "m", [0.5, 0.0, 2.0, 0.1]),
            Control::slider("count", "Steps", "", [8.0, 1.0, 20.0, 1.0]),
            Control::slider("problem", "Problem", "", [1.0, 1.0, 20.0, 1.0]),
        ],
        handles: &[],
        panels: &[
            COSTS,
            Panel {
                title: "The image: rings were measured, points go from the disc",
                x: Axis { label: "u (px)", range: [-20.0, 660.0] },
                y: Axis { label: "v (px)", range: [-60.0, 540.0] },
                aspect: 0.75,
                span: 3,
                equal: true,
                down: true,
            },
        ],
        readings: &[steps("Steps until it is there, yours"), steps("The same, the book's")],
        question: None,
        words: &[],
    };

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let &[derivative, turned, shifted, count, number] = controls else { return };
        let setting = Setting::drawn(number, turned, shifted);
        let (count, trouble) = (count as usize, Trouble::default());
        let source = SOURCES[(derivative as usize).min(SOURCES.len() - 1)];
        let books = setting.way(&self.answer, Source::Book, count, &trouble);
        let hers = setting.way(&self.answer, source, count, &trouble);
        scene.read(hers.steps_needed());
        scene.read(books.steps_needed());
        descent::draw_costs(scene, 0, &hers, &books);
        draw_image(scene, 1, &setting, &hers, &books);
        let difference = setting.difference(&self.answer, source, &trouble);
        descent::say(scene, [&hers, &books], difference, trouble.take());
    }
}

fn draw_image(
    scene: &mut Scene,
    panel: usize,
    setting: &Setting,
    hers: &Way<Isometry3<f64>>,
    books: &Way<Isometry3<f64>>,
) {
    let pixel = |pose: &Isometry3<f64>, point: &Vector3<f64>| {
        setting
            .camera
            .pinhole()
            .project(pose, point)
            .map_or([f64::NAN; 2], |pixel| [pixel.x, pixel.y])
    };
    // One line for all points, with a gap behind each.
    let tracks = |way: &Way<Isometry3<f64>>| -> Vec<[f64; 2]> {
        let track = |(point, _): &(Vector3<f64>, Vector2<f64>)| {
            let mut track: Vec<[f64; 2]> =
                way.states.iter().map(|pose| pixel(pose, point)).collect();
            track.push([f64::NAN; 2]);
            track
        };
        setting.seen.iter().flat_map(track).collect()
    };
    let starts = setting.seen.iter().map(|(point, _)| pixel(&setting.start, point));
    scene.draw(panel, (Shape::Line, BOOKS, 1.5), tracks(books));
    scene.draw(panel, (Shape::Dashed, HERS, 2.0), tracks(hers));
    scene.draw(panel, (Shape::Crosses, HERS, 2.5), tracks(hers));
    scene.draw(panel, (Shape::Discs, Style::Ink, 2.5), starts);
    scene.draw(
        panel,
        (Shape::Rings, Style::Ink, 8.0),
        setting.seen.iter().map(|(_, pixel)| [pixel.x, pixel.y]),
    );
}
