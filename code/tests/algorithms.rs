//! The five algorithms of the chapter at a glance: one call of each, and one thing that each refuses.

use std::error::Error;

use nalgebra::{DMatrix, DVector, Isometry3, Vector3};
use vislam::bundle_adjustment::BaError;
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise};
use vislam::least_squares::Options;
use vislam::marginalization::{
    Block, Blocks, Information, Layout, MarginalizationError, SquareRoot, WindowSigmas, marginalize,
};
use vislam::msckf::{Msckf, MsckfOptions, PictureReport, Start};
use vislam::preintegration::{PreintegrationError, preintegrate};
use vislam::reprojection::Pinhole;
use vislam::simulation::{Flight, Scene, Trajectory};

const CAMERA: Pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };

type Outcome = Result<(), Box<dyn Error>>;

/// What the filter says of each picture of two seconds.
fn followed(motion: Trajectory) -> Result<Vec<PictureReport>, Box<dyn Error>> {
    let flight = Flight { seconds: 2.0, ..Flight::new(motion) };
    let recording = flight.record(&flight.room(3.0, 800, 1)?, 1)?;
    let start = Start::drawn(&recording, &[1e-3; 15], 1).ok_or("no picture")?;
    let mut filter = Msckf::new(MsckfOptions::of_flight(&flight), &start)?;
    let mut reports = Vec::new();
    while let Some(report) = filter.follow(&recording, reports.len())? {
        reports.push(report);
    }
    Ok(reports)
}

// ANCHOR: calls
#[test]
fn each_of_the_five_is_a_call() -> Outcome {
    let point = Vector3::new(0.5, 0.2, 4.0);
    let seen = CAMERA.project_with_jacobians(&Isometry3::identity(), &point);
    assert!(seen.is_some_and(|seen| seen.pixel.x == 370.0));

    let mut ring = Scene::ring(8, 40, 1.0, 1).problem;
    assert!(ring.solve(&Options::default())?.stop.is_convergence());

    let readings = Trajectory::figure_eight().samples(&GRAVITY, 0.005, 200);
    let sums = preintegrate(&readings, 0.005, &ImuBias::default(), &ImuNoise::mems())?;
    assert_eq!(sums.steps, 200);

    let (layout, sigmas) = (Layout::eight_keyframes(), WindowSigmas::default());
    let problem = layout.problem(&sigmas, 1)?;
    let window = SquareRoot::of_problem(&problem, problem.values())?.information();
    let left = marginalize(&window, &layout.slide(0))?;
    assert!(left.blocks().len() < window.blocks().len());

    let reports = followed(Trajectory::figure_eight())?;
    assert!(reports.iter().any(|report| report.used > 0));
    Ok(())
}
// ANCHOR_END: calls

// ANCHOR: refusals
#[test]
fn each_of_the_five_refuses_what_it_cannot_use() -> Outcome {
    let behind = Vector3::new(0.0, 0.0, -4.0);
    assert_eq!(CAMERA.project_with_jacobians(&Isometry3::identity(), &behind), None);

    let mut ring = Scene::ring(8, 40, 1.0, 1).problem;
    ring.factors[17].pixel.x = f64::NAN;
    assert!(matches!(ring.solve(&Options::default()), Err(BaError::Pixel { observation: 17, .. })));

    let readings = Trajectory::figure_eight().samples(&GRAVITY, 0.005, 3);
    let sums = preintegrate(&readings, 0.2, &ImuBias::default(), &ImuNoise::mems());
    assert_eq!(sums, Err(PreintegrationError::Gap { step: 0, dt: 0.2, longest: 0.1 }));

    let blocks = [(0, 2), (1, 1)].map(|(name, dimension)| Block { name, dimension });
    let one_ray = DMatrix::from_row_slice(3, 3, &[1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let window = Information::new(Blocks::new(blocks.to_vec())?, one_ray, DVector::zeros(3))?;
    let left = marginalize(&window, &[0]);
    assert!(matches!(left, Err(MarginalizationError::Singular { name: 0, .. })));

    let reports = followed(Trajectory::hover())?;
    let refused: usize = reports.iter().map(|r| r.refused.landmark + r.refused.rank).sum();
    let used: usize = reports.iter().map(|report| report.used).sum();
    assert!(refused > used);
    Ok(())
}
// ANCHOR_END: refusals
