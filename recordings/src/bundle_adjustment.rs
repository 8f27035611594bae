//! Bundle adjustment of a ring: cameras and points walk to where the rays meet.

use nalgebra::Vector3;
use vislam::bearing::back_project;
use vislam::bundle_adjustment::PosedPinhole;
use vislam::reprojection::ReprojFactor;
use widgets::bundle_adjustment::{MOST_STEPS, Run, Setting, State, World};

use crate::layout::{Beside, Layout};
use crate::stage::{colour, lines, matrix, points};
use crate::{Stage, StageError, frustum};

pub const SHOWS: &str = "a ring of eight cameras and thirty points on its way to the minimum";

/// How far ahead of its centre a camera's image is drawn, in metres.
const IMAGE: f64 = 0.6;
/// Powers of ten between the faintest entry of a matrix and its largest.
const POWERS: f64 = 4.0;

/// The ring of the chapter, which starts six times as far from the truth.
fn setting() -> Setting {
    let kernel = vislam::least_squares::Kernel::Squared;
    Setting { world: World::Ring, held: true, kernel, outliers: 0.0, start: 6.0, seed: 1 }
}

pub fn play(stage: &Stage) -> Result<(), StageError> {
    stage.arrange(&Layout {
        title: "Cameras, points and rays",
        eye: Vector3::new(5.4, -4.6, 4.2),
        target: Vector3::new(0.1, -0.1, -0.35),
        up: Vector3::z(),
        floor: None,
        beside: vec![
            Beside::Picture { title: "S, points eliminated", of: "schur_complement" },
            Beside::Curves { title: "Powers of ten over the steps", of: "progress" },
        ],
        timeline: "step",
        speed: 2.0,
    })?;
    let mut run = Run::new(setting()).ok_or_else(|| StageError::scene("the ring has no start"))?;
    truth(stage, &run)?;
    stage.curve("progress/cost", "cost", colour::MEASURED)?;
    stage.curve("progress/gradient", "scaled gradient", colour::ESTIMATED)?;
    let mut step = 0;
    loop {
        run.advance(step);
        let Some(state) = run.states.get(step) else { break };
        stage.at_step("step", step);
        estimate(stage, &run, step)?;
        rays(stage, &run.scene.problem.factors, state)?;
        if let Some(schur) = run.schur_complement() {
            stage.now("schur_complement", &matrix(&schur, POWERS))?;
        }
        stage.value("progress/cost", state.cost.log10())?;
        stage.value("progress/gradient", state.gradient_norm.log10())?;
        if run.ended.is_some() && step + 1 == run.states.len() || step == MOST_STEPS {
            break;
        }
        step += 1;
    }
    Ok(())
}

fn frusta<'a>(
    cameras: impl IntoIterator<Item = &'a PosedPinhole>,
) -> impl Iterator<Item = Vec<Vector3<f64>>> {
    cameras
        .into_iter()
        .flat_map(|camera| frustum(&camera.intrinsics, &camera.camera_from_world, IMAGE))
}

fn truth(stage: &Stage, run: &Run) -> Result<(), StageError> {
    let cameras = frusta(&run.scene.true_cameras);
    stage.always("world/truth/cameras", &lines(cameras, (colour::TRUTH, 90), 0.7))?;
    stage.always("world/truth/points", &points(&run.scene.true_points, colour::TRUTH, 2.0))
}

fn estimate(stage: &Stage, run: &Run, step: usize) -> Result<(), StageError> {
    let state = &run.states[step];
    let fixed = |camera: &usize| run.scene.problem.fixed[*camera];
    let (held, moving): (Vec<_>, Vec<_>) = (0..state.cameras.len()).partition(fixed);
    for (entity, cameras, colour) in [
        ("world/estimate/held_camera", held, colour::PRIOR),
        ("world/estimate/cameras", moving, colour::ESTIMATED),
    ] {
        let cameras = frusta(cameras.into_iter().map(|camera| &state.cameras[camera]));
        stage.now(entity, &lines(cameras, (colour, 255), 1.8))?;
    }
    stage.now("world/estimate/points", &points(&state.points, colour::ESTIMATED, 4.5))?;
    let gone = &run.states[..=step];
    let way = |camera: usize| gone.iter().map(|state| state.cameras[camera].centre()).collect();
    let ways = (0..state.cameras.len()).map(way);
    stage.now("world/estimate/ways", &lines(ways, (colour::ESTIMATED, 130), 1.2))
}

/// The measured rays, as far as the points they belong to, and what is missing from there.
fn rays(stage: &Stage, factors: &[ReprojFactor], state: &State) -> Result<(), StageError> {
    let ends = factors.iter().map(|factor| {
        let camera = &state.cameras[factor.keyframe];
        let point = state.points[factor.point];
        let depth = (camera.camera_from_world * nalgebra::Point3::from(point)).z;
        let ray = back_project(&camera.intrinsics, &factor.pixel, depth);
        let end = camera.camera_from_world.inverse() * nalgebra::Point3::from(ray);
        (camera.centre(), end.coords, point)
    });
    let ends: Vec<_> = ends.collect();
    let rays = ends.iter().map(|(centre, end, _)| vec![*centre, *end]);
    stage.now("world/rays", &lines(rays, (colour::MEASURED, 60), 0.6))?;
    let residuals = ends.iter().map(|(_, end, point)| vec![*end, *point]);
    stage.now("world/residuals", &lines(residuals, (colour::STRIKING, 255), 1.2))
}
