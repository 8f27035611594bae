//! Two cameras and a point, seen from above and in both pictures.

use nalgebra::{Vector2, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::bearing::{back_project, depth_from_disparity, depth_sigma, disparity_sigma, parallax};
use vislam::reprojection::Pinhole;

use crate::{
    Axis, Control, Face, Handle, Kind, Panel, Question, Reading, Scene, Shape, Style, Widget,
};

/// Measurements of the point that a noisy detector might have made.
const DRAWS: usize = 240;
/// How far to the right the point lies for each metre of depth.
const SLOPE: f64 = 0.12;
/// Of depths, in metres.
const FARTHEST: f64 = 13.5;
/// To the right, in metres.
const TO_THE_RIGHT: f64 = 2.2;
/// The largest depth that is believed, over the true one, and some room.
const BEYOND: f64 = 3.2;
/// A believed landmark that is dragged as near as this to the ray is on it, in metres.
const ON_THE_RAY: f64 = 0.06;
/// What is shown of a depth where there is none.
const RAYS_PART: &str = "none: the rays part";
/// How far away other points on the ray of the first camera are, over the landmark's depth.
const OTHERS: [f64; 4] = [0.625, 0.875, 1.25, 2.0];

/// Two cameras that look the same way, a landmark, and what is believed of it.
pub struct Bearing {
    /// The noise of both pixels of each draw, in standard deviations.
    noise: Vec<[f64; 2]>,
    places: Vec<[f64; 2]>,
    depths: Vec<f64>,
}

impl Default for Bearing {
    fn default() -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut normal = || StandardNormal.sample(&mut random);
        let noise = (0..DRAWS).map(|_| [normal(), normal()]).collect();
        Self { noise, places: Vec::with_capacity(DRAWS), depths: Vec::with_capacity(DRAWS) }
    }
}

/// Of a picture, to either side of the measured pixel, in pixels.
const REACH: f64 = 24.0;
const ABOVE: usize = 0;
const PICTURES: [usize; 2] = [1, 2];

const fn picture(title: &'static str) -> Panel {
    let x = Axis { label: "column, px from the measured pixel", range: [-REACH, REACH] };
    let y = Axis { label: "", range: [-REACH / 3.0, REACH / 3.0] };
    Panel { title, x, y, aspect: 0.42, span: 3, equal: true, down: true }
}

const fn reading(label: &'static str, unit: &'static str, digits: usize) -> Reading {
    Reading { label, unit, digits, none: "not in sight", veiled: false }
}

impl Widget for Bearing {
    const FACE: Face = Face {
        lead: "Drag the ring, which is where the landmark is believed to be, along the ray of the first camera and across it, and watch both pictures. The cross is where it is, the dots are other points on the same ray, and the cloud is where two noisy pixels would put it. The other ring moves the second camera.",
        controls: &[
            Control {
                kind: Kind::Sweep,
                ..Control::slider(
                    "along",
                    "Depth believed, over the true one",
                    "",
                    [1.0, 0.4, 3.0, 0.01],
                )
            },
            Control::slider("across", "Moved across the ray", "m", [0.0, -0.5, 0.5, 0.01]),
            Control::slider("depth", "True depth", "m", [4.0, 2.0, 10.0, 0.1]),
            Control::slider("baseline", "Baseline", "m", [0.3, 0.05, 1.5, 0.01]),
            Control::slider("focal", "Focal length", "px", [400.0, 200.0, 800.0, 10.0]),
            Control::slider("noise", "Noise of a pixel", "px", [3.0, 0.0, 4.0, 0.1]),
        ],
        handles: &[
            Handle { panel: ABOVE, label: "believed landmark" },
            Handle { panel: ABOVE, label: "second camera" },
        ],
        panels: &[
            Panel {
                title: "Seen from above, widths drawn larger",
                x: Axis { label: "depth, m", range: [-0.8, FARTHEST] },
                y: Axis { label: "to the right, m", range: [-0.6, TO_THE_RIGHT] },
                aspect: 0.4,
                span: 6,
                equal: false,
                down: true,
            },
            picture("First picture"),
            picture("Second picture"),
        ],
        readings: &Self::READINGS,
        question: Some(Question {
            ask: "Which picture contradicts when the landmark is believed farther away than it is, on the ray of the first camera?",
            choices: &["the first", "the second", "both, by the same number of pixels"],
            right: 1,
            why: "It stays on the ray of the first camera, so the first picture cannot tell; the second looks from the side.",
        }),
        words: &["first camera", "second camera"],
    };

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let &[along, across, depth, baseline, focal, noise] = controls else { return };
        let camera = Pinhole { fx: focal, fy: focal, cx: 0.0, cy: 0.0 };
        let stage = Stage { camera, baseline, truth: Vector3::new(SLOPE * depth, 0.0, depth) };
        let believed = stage.believed(along, across);
        // So far that the ring can be seen wherever it is believed to be.
        let wider = (BEYOND * depth / FARTHEST).max(1.0);
        scene.view(ABOVE, [-0.8, wider * FARTHEST], [-0.6, wider * TO_THE_RIGHT]);
        scene.draw(ABOVE, (Shape::Line, Style::Measured, 1.5), stage.ray(0));
        scene.draw(ABOVE, (Shape::Line, Style::Measured, 1.5), stage.ray(1));
        self.draw_depths(&stage, noise);
        scene.draw(ABOVE, (Shape::Discs, Style::Third, 2.0), self.places.iter().copied());
        let others = OTHERS.map(|along| stage.believed(along, 0.0));
        scene.draw(ABOVE, (Shape::Discs, Style::Estimated, 3.5), others.map(|point| above(&point)));
        for (number, centre) in [0.0, baseline].into_iter().enumerate() {
            let corners = [[-0.4, centre - 0.1], [0.0, centre], [-0.4, centre + 0.1]];
            scene.draw(ABOVE, (Shape::Area, Style::Ink, 1.0), corners);
            if number == 0 {
                scene.word(ABOVE, 0, Style::Ink, [-0.6, -0.25]);
            }
        }
        scene.word(ABOVE, 1, Style::Ink, [-0.6, baseline + 0.45]);
        scene.draw(ABOVE, (Shape::Crosses, Style::Ink, 5.0), [above(&stage.truth)]);
        scene.handle(ABOVE, 1, Style::Ink, [0.0, baseline]);
        scene.handle(ABOVE, 0, Style::Estimated, above(&believed));
        let residuals = [0, 1].map(|number| stage.residuals(number, &believed, &others));
        let seen = residuals.iter().flatten().flatten();
        let largest = seen.fold(0.0, |most: f64, residual| most.max(1.1 * residual.amax()));
        // Twice as much at a time, so that a residual that grows is seen to grow.
        let reach = REACH * 2.0_f64.powi((largest / REACH).log2().ceil().max(0.0) as i32);
        for (panel, residuals) in PICTURES.into_iter().zip(&residuals) {
            draw_picture(scene, panel, residuals, noise, reach);
            scene.read(residuals[0].map(|residual| residual.x));
        }
        let centres = [stage.centre(0), stage.centre(1)];
        scene.read(parallax(&stage.truth, &centres[0], &centres[1]).to_degrees());
        let sigma = disparity_sigma(noise, noise);
        let sigma = depth_sigma(&camera, baseline, depth, sigma);
        scene.read(100.0 * sigma);
        scene.read(100.0 * sigma / depth);
        self.depths.sort_by(f64::total_cmp);
        for part in [DRAWS / 20, DRAWS - DRAWS / 20] {
            scene.read(self.depths.get(part).copied().filter(|depth| depth.is_finite()));
        }
    }

    fn drag(&self, handle: usize, [z, x]: [f64; 2], controls: &mut [f64]) {
        let [along, across, depth, baseline, ..] = controls else { return };
        let (ray, side) = directions(*depth);
        match handle {
            0 => {
                let to = Vector3::new(x, 0.0, z);
                let moved = to.dot(&side);
                *along = to.dot(&ray) / ray.norm_squared();
                *across = if moved.abs() < ON_THE_RAY { 0.0 } else { moved };
            }
            _ => *baseline = x,
        }
    }
}

impl Bearing {
    /// The numbers that are shown.
    pub(crate) const READINGS: [Reading; 7] = [
        Reading { veiled: true, ..reading("Residual of the first camera", "px", 1) },
        Reading { veiled: true, ..reading("Residual of the second camera", "px", 1) },
        reading("Parallax of the landmark", "°", 2),
        reading("σ of the depth", "cm", 1),
        reading("σ over the depth", "%", 1),
        Reading { none: RAYS_PART, ..reading("5 % of the depths found are nearer than", "m", 2) },
        Reading { none: RAYS_PART, ..reading("5 % of them are farther than", "m", 2) },
    ];

    /// Where the landmark would be found with each draw of the noise, and how far away.
    fn draw_depths(&mut self, stage: &Stage, noise: f64) {
        self.places.clear();
        self.depths.clear();
        let pixels = [0, 1].map(|number| stage.pixel(number, &stage.truth));
        let [Some(first), Some(second)] = pixels else { return };
        for [left, right] in &self.noise {
            let first = first + Vector2::new(noise * left, 0.0);
            let disparity = first.x - second.x - noise * right;
            let depth = depth_from_disparity(&stage.camera, stage.baseline, disparity);
            self.depths.push(depth.unwrap_or(f64::INFINITY));
            if let Some(depth) = depth.filter(|depth| *depth < 2.0 * FARTHEST) {
                self.places.push(above(&back_project(&stage.camera, &first, depth)));
            }
        }
    }
}

/// The cameras and the landmark.
struct Stage {
    camera: Pinhole,
    baseline: f64,
    truth: Vector3<f64>,
}

impl Stage {
    fn centre(&self, number: usize) -> Vector3<f64> {
        Vector3::new(number as f64 * self.baseline, 0.0, 0.0)
    }

    fn pixel(&self, number: usize, point: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.camera.project_cam(&(point - self.centre(number)))
    }

    /// Prediction minus measurement, in pixels.
    fn residual(&self, number: usize, point: &Vector3<f64>) -> Option<Vector2<f64>> {
        Some(self.pixel(number, point)? - self.pixel(number, &self.truth)?)
    }

    /// Those of the believed landmark and of the other points on the ray.
    fn residuals(
        &self,
        number: usize,
        believed: &Vector3<f64>,
        others: &[Vector3<f64>; 4],
    ) -> [Option<Vector2<f64>>; 5] {
        let [a, b, c, d] = others;
        [believed, a, b, c, d].map(|point| self.residual(number, point))
    }

    /// From a camera through the landmark and on.
    fn ray(&self, number: usize) -> [[f64; 2]; 2] {
        let centre = self.centre(number);
        let farthest = (2.0 * FARTHEST).max(BEYOND * self.truth.z);
        let end = centre + (self.truth - centre) * (farthest / self.truth.z);
        [above(&centre), above(&end)]
    }

    fn believed(&self, along: f64, across: f64) -> Vector3<f64> {
        let (ray, side) = directions(self.truth.z);
        along * ray + across * side
    }
}

/// From the first camera to a landmark at this depth, and to the right of that.
fn directions(depth: f64) -> (Vector3<f64>, Vector3<f64>) {
    let ray = Vector3::new(SLOPE * depth, 0.0, depth);
    (ray, Vector3::new(ray.z, 0.0, -ray.x).normalize())
}

/// A point seen from above, with its depth to the right.
fn above(point: &Vector3<f64>) -> [f64; 2] {
    [point.z, point.x]
}

/// The measured pixel with a circle of one standard deviation, and the predicted one, which comes first of the
/// residuals.
fn draw_picture(
    scene: &mut Scene,
    panel: usize,
    residuals: &[Option<Vector2<f64>>],
    noise: f64,
    reach: f64,
) {
    scene.view(panel, [-reach, reach], [-reach / 3.0, reach / 3.0]);
    let circle = (0..=48).map(|part| {
        let angle = f64::from(part) * std::f64::consts::TAU / 48.0;
        [noise * angle.cos(), noise * angle.sin()]
    });
    scene.draw(panel, (Shape::Line, Style::Measured, 1.0), circle);
    scene.draw(panel, (Shape::Crosses, Style::Measured, 5.0), [[0.0, 0.0]]);
    let mut places = residuals.iter().flatten().map(|residual| [residual.x, residual.y]);
    if residuals[0].is_some()
        && let Some(believed) = places.next()
    {
        scene.draw(panel, (Shape::Line, Style::Estimated, 2.0), [[0.0, 0.0], believed]);
        scene.draw(panel, (Shape::Rings, Style::Estimated, 5.0), [believed]);
    }
    scene.draw(panel, (Shape::Discs, Style::Estimated, 2.5), places);
}
