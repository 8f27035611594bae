//! The four panels.

use nalgebra::{Vector2, Vector6};
use vislam::bundle_adjustment::{Camera, PosedPinhole};

use super::{ARROWS, Comparison, ERRORS, RESIDUALS, ROUNDING, STEPS, WATCHED, to_side};
use crate::{Scene, Shape, Style};

/// Where the names of both curves stand, in steps.
const LEGEND: f64 = 10.5;
/// Where a line breaks.
const BREAK: [f64; 2] = [f64::NAN, f64::NAN];
/// How far the trial step goes along an axis and about it, in metres and radians.
const TRIAL: [f64; 2] = [0.4, 6.0 * std::f64::consts::PI / 180.0];

/// What a trial step of the watched camera does to its picture, taken on the right, and what the Jacobian says of it.
/// Returns the root of the mean squared distance between both, in pixels.
pub fn arrows(run: &Comparison, axis: usize, scene: &mut Scene) -> Option<f64> {
    let camera = run.scene.true_cameras[WATCHED];
    let mut twist = Vector6::zeros();
    twist[axis] = TRIAL[axis / 3];
    let moved = camera.retract(&twist);
    let slid = to_side(&camera.camera_from_world, run.setting.side) * twist;
    let seen: Vec<[Vector2<f64>; 3]> = points(run)
        .filter_map(|point| {
            let predicted = camera.differentiate(&run.scene.true_points[point])?;
            let moved = moved.project(&run.scene.true_points[point])?;
            Some([predicted.pixel, moved, predicted.pixel + predicted.by_camera * slid])
        })
        .collect();
    let line = |to: usize| {
        seen.iter().flat_map(move |pixels| [place(&pixels[0]), place(&pixels[to]), BREAK])
    };
    let ends = |to: usize| seen.iter().map(move |pixels| place(&pixels[to]));
    scene.draw(ARROWS, (Shape::Line, Style::Measured, 2.0), line(1));
    scene.draw(ARROWS, (Shape::Discs, Style::Measured, 3.0), ends(1));
    scene.draw(ARROWS, (Shape::Line, Style::Estimated, 1.5), line(2));
    scene.draw(ARROWS, (Shape::Rings, Style::Estimated, 4.5), ends(2));
    let squared = seen.iter().map(|[_, moved, predicted]| (moved - predicted).norm_squared());
    (!seen.is_empty()).then(|| (squared.sum::<f64>() / seen.len() as f64).sqrt())
}

/// The landmarks that the watched camera sees.
fn points(run: &Comparison) -> impl Iterator<Item = usize> {
    let seen = run.scene.problem.factors.iter().filter(|factor| factor.keyframe == WATCHED);
    seen.map(|factor| factor.point)
}

fn place(pixel: &Vector2<f64>) -> [f64; 2] {
    [pixel.x, pixel.y]
}

/// Errors over the steps, a ring where the reader stands, and the slope of the theorem.
pub fn errors(run: &Comparison, at: usize, rate: f64, scene: &mut Scene) {
    let curves = [&run.consistent, &run.mixed].map(|one| -> Vec<[f64; 2]> {
        let errors = one.errors(&run.optimum).enumerate();
        errors.map(|(step, error)| [step as f64, error.max(ROUNDING).log10()]).collect()
    });
    let styles = [(Style::First, Shape::Discs), (Style::Second, Shape::Rings)];
    if let [_, [step, power], ..] = curves[1][..] {
        let end = [STEPS as f64, power + (STEPS as f64 - step) * rate.max(ROUNDING).log10()];
        scene.draw(ERRORS, (Shape::Dashed, Style::Faint, 1.0), [[step, power], end]);
    }
    for (number, (curve, (style, marks))) in curves.iter().zip(styles).enumerate() {
        scene.draw(ERRORS, (Shape::Line, style, 1.5), curve.iter().copied());
        scene.draw(ERRORS, (marks, style, 2.5), curve.iter().copied());
        if let Some(here) = curve.get(at) {
            scene.draw(ERRORS, (Shape::Rings, Style::Ink, 6.0), [*here]);
        }
        let height = -11.3 - 1.4 * number as f64;
        scene.draw(ERRORS, (marks, style, 3.5), [[LEGEND - 0.6, height]]);
        scene.word(ERRORS, number, style, [LEGEND, height - 0.3]);
    }
}

/// Measured pixels of the watched camera, and where its landmarks are predicted after so many steps.
pub fn residuals(run: &Comparison, at: usize, scene: &mut Scene) {
    for (one, panel) in [&run.consistent, &run.mixed].into_iter().zip(RESIDUALS) {
        let factors = run.scene.problem.factors.iter().filter(|f| f.keyframe == WATCHED);
        scene.draw(
            panel,
            (Shape::Crosses, Style::Measured, 3.0),
            factors.clone().map(|factor| place(&factor.pixel)),
        );
        let Some(state) = one.states.get(at) else {
            scene.word(panel, 2, Style::Ink, [340.0, 240.0]);
            continue;
        };
        let Some(camera) = one.cameras(at).map(|cameras| -> PosedPinhole { cameras[WATCHED].0 })
        else {
            continue;
        };
        let points = state.of_kind::<nalgebra::Vector3<f64>>();
        let predicted = factors.filter_map(|factor| {
            let pixel = camera.project(&points[factor.point])?;
            Some([place(&factor.pixel), place(&pixel), BREAK])
        });
        let pairs: Vec<[[f64; 2]; 3]> = predicted.collect();
        scene.draw(panel, (Shape::Line, Style::Estimated, 1.5), pairs.iter().flatten().copied());
        scene.draw(panel, (Shape::Rings, Style::Estimated, 4.0), pairs.iter().map(|pair| pair[1]));
    }
}
