//! Two views of a few points: the shorter the baseline, the longer the ellipsoids.

use nalgebra::{Isometry3, Vector2, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::bundle_adjustment::{Camera, PosedPinhole};
use vislam::reprojection::Pinhole;
use vislam::two_views::{Triangulated, View, triangulate_nonlinear};

use crate::layout::{Beside, Layout};
use crate::stage::{colour, ellipsoids, lines, points};
use crate::{Ellipsoid, Stage, StageError, frustum};

pub const SHOWS: &str = "two cameras that come together, and what they know of eight points";

/// The camera of the chapter.
const CAMERA: Pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };
/// Where the points are, in metres: to the side, down and ahead of the first camera.
const POINTS: [[f64; 3]; 8] = [
    [-1.1, 0.5, 3.0],
    [0.6, -0.6, 3.4],
    [-1.9, -0.9, 4.6],
    [1.6, 0.6, 5.0],
    [-0.4, 0.3, 6.0],
    [2.4, -0.9, 7.0],
    [-2.6, 0.7, 7.4],
    [0.6, -0.3, 8.6],
];
/// Metres between the cameras, at the beginning and at the end, and the steps between.
const BASELINES: (f64, f64) = (2.0, 0.4);
const STEPS: usize = 30;
/// Standard deviation of each coordinate of a pixel.
const SIGMA: f64 = 1.0;
/// Pairs of pictures with other noise, each of which gives a dot for each point.
const DRAWS: usize = 80;
/// How many standard deviations the ellipsoids are drawn large.
const LARGE: f64 = 3.0;

pub fn play(stage: &Stage) -> Result<(), StageError> {
    stage.arrange(&Layout {
        title: "Two cameras, and points with their ellipsoids",
        eye: Vector3::new(-3.5, -3.9, -0.9),
        target: Vector3::new(0.15, 0.35, 4.0),
        up: -Vector3::y(),
        floor: None,
        beside: vec![
            Beside::Curves { title: "Standard deviation of the depth, m", of: "depth" },
            Beside::Curves { title: "Baseline, m", of: "baseline" },
        ],
        timeline: "step",
        speed: 8.0,
    })?;
    let truth = POINTS.map(Vector3::from);
    stage.always("world/truth", &points(&truth, colour::TRUTH, 4.0))?;
    let [near, far] = [0, POINTS.len() - 1];
    let title = |point: usize| format!("{} m away", POINTS[point][2]);
    stage.curve("depth/near", &title(near), colour::MEASURED)?;
    stage.curve("depth/far", &title(far), colour::ESTIMATED)?;
    stage.curve("baseline", "baseline", colour::NEUTRAL)?;
    for step in 0..=STEPS {
        stage.at_step("step", step);
        let (first, last) = BASELINES;
        let baseline = first * (last / first).powf(step as f64 / STEPS as f64);
        stage.value("baseline", baseline)?;
        let cameras = cameras(baseline);
        draw_cameras(stage, &cameras, &truth)?;
        let known = truth.iter().map(|point| likely(&cameras, point, || 0.0));
        let known = known.collect::<Result<Vec<_>, _>>()?;
        let around = known.iter().map(|it| Ellipsoid::of(&it.point, &it.covariance, LARGE));
        stage.now("world/ellipsoids", &ellipsoids(around, colour::ESTIMATED))?;
        stage.now("world/dots", &points(&draws(&cameras, &truth), colour::STRIKING, 1.3))?;
        for (entity, point) in [("depth/near", near), ("depth/far", far)] {
            stage.value(entity, known[point].covariance[(2, 2)].sqrt())?;
        }
    }
    Ok(())
}

/// Two cameras side by side.
fn cameras(baseline: f64) -> [PosedPinhole; 2] {
    [0.0, -baseline].map(|shift| PosedPinhole {
        intrinsics: CAMERA,
        camera_from_world: Isometry3::translation(shift, 0.0, 0.0),
    })
}

fn draw_cameras(
    stage: &Stage,
    cameras: &[PosedPinhole; 2],
    truth: &[Vector3<f64>],
) -> Result<(), StageError> {
    let frusta = cameras.iter().flat_map(|camera| frustum(&CAMERA, &camera.camera_from_world, 0.5));
    stage.now("world/cameras", &lines(frusta, (colour::PRIOR, 255), 2.0))?;
    let rays =
        cameras.iter().flat_map(|camera| truth.iter().map(|point| vec![camera.centre(), *point]));
    stage.now("world/rays", &lines(rays, (colour::MEASURED, 110), 0.8))
}

/// The most likely point for pixels with this noise.
fn likely(
    cameras: &[PosedPinhole; 2],
    point: &Vector3<f64>,
    mut noise: impl FnMut() -> f64,
) -> Result<Triangulated, StageError> {
    let unseen = || StageError::scene("a camera does not see a point");
    let view = |camera: &PosedPinhole| {
        let seen = camera.project(point).ok_or_else(unseen)?;
        let pixel = seen + SIGMA * Vector2::from_fn(|_, _| noise());
        let PosedPinhole { intrinsics: camera, camera_from_world } = *camera;
        Ok(View { camera, camera_from_world, pixel, sigma: SIGMA })
    };
    let views = cameras.iter().map(view).collect::<Result<Vec<_>, StageError>>()?;
    triangulate_nonlinear(&views, point).map_err(StageError::scene)
}

/// Where pairs of pictures put the points. The noise is the same for every baseline; a pair that has no point for its
/// pixels gives none.
fn draws(cameras: &[PosedPinhole; 2], truth: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut found = Vec::with_capacity(DRAWS * truth.len());
    for point in truth {
        for _ in 0..DRAWS {
            let draw = likely(cameras, point, || StandardNormal.sample(&mut random));
            found.extend(draw.ok().map(|draw| draw.point));
        }
    }
    found
}
