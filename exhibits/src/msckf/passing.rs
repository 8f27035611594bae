//! A camera that passes a landmark: what one correction does, and what an adjustment does that goes
//! on to its end.

use nalgebra::{DMatrix, DVector, Vector3};
use vislam::filtering::{Form, correct};
use vislam::inertial::BodyPose;
use vislam::least_squares::Manifold;

use super::draws::{Linear, Plan, SIGMA, Track, covariance, least, stacked};
use crate::chapter::Chapter;
use crate::random::Random;

/// Sights of the worked track.
pub const SIGHTS: usize = 8;
/// Root mean square of the standard deviations of the poses, in metres.
pub const UNCERTAIN: [f64; 3] = [0.01, 0.04, 0.16];
/// Steps of the adjustment that are shown.
pub const STEPS: usize = 4;

/// A track whose poses are off as their covariance says.
pub struct Pass {
    pub track: Track,
    pub covariance: DMatrix<f64>,
}

impl Pass {
    pub fn new(uncertain: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let plan = Plan { off: 0.0, landmark_off: 0.0, ..Plan::new(SIGHTS) };
        let mut track = Track::drawn(&mut random, plan);
        track.camera = vislam::reprojection::Pinhole { fx: 250.0, fy: 250.0, cx: 320.0, cy: 240.0 };
        // Turns in rad are a tenth of positions in m.
        let part = DMatrix::from_diagonal(&DVector::from_fn(6 * SIGHTS, |at, _| {
            uncertain * if at % 6 < 3 { 0.1 } else { 1.0 }
        }));
        let unit = covariance(&mut random, 6 * SIGHTS, 1.0) / (6.0 * SIGHTS as f64 + 4.0);
        let covariance = &part * unit * &part;
        let root = covariance.clone().cholesky().expect("a covariance").l();
        let drawn = DVector::from_fn(6 * SIGHTS, |_, _| random.normal(1.0));
        let off = root * drawn;
        for (k, sight) in track.sights.iter_mut().enumerate() {
            let truth = track.true_poses[k];
            let world_from_camera = truth.at_rest().pose() * track.rig;
            let seen = track.camera.project(&world_from_camera.inverse(), &track.true_landmark);
            let noise = nalgebra::Vector2::from_fn(|_, _| random.normal(SIGMA));
            sight.pixel = seen.expect("it is ahead") + noise;
            sight.pose = truth.retract(&off.as_slice()[6 * k..6 * k + 6]);
            sight.linearized_at = sight.pose;
        }
        let camera = (&track.camera, SIGMA);
        track.landmark = vislam::msckf::landmark(&track.sights, &track.rig, camera, 1e-3)
            .expect("the rays meet");
        Self { track, covariance }
    }

    /// The correction of the poses by the projected rows, and the covariance after it.
    pub fn corrected(&self) -> (DVector<f64>, DMatrix<f64>) {
        let rows = Linear::projected(&self.track.linearized());
        let mut after = self.covariance.clone();
        let correction = correct(&mut after, &rows.by_poses, &rows.residual, Form::Joseph);
        (correction.expect("a covariance").step, after)
    }

    /// The errors of the poses, from those that were believed, after each step of an adjustment that
    /// keeps the landmark and linearizes anew.
    pub fn adjusted(&self, steps: usize) -> Vec<DVector<f64>> {
        let believed: Vec<BodyPose> = self.track.sights.iter().map(|sight| sight.pose).collect();
        let root = self.covariance.clone().cholesky().expect("a covariance").l();
        let root = root.try_inverse().expect("a triangle");
        let mut now = Track {
            sights: self.track.sights.clone(),
            true_poses: self.track.true_poses.clone(),
            ..self.track
        };
        let poses = 6 * believed.len();
        (0..steps)
            .map(|_| {
                let (moved, derivative) = moved(&believed, &now);
                let linear = Linear::of(&now.linearized(), 0);
                let nothing = (1e-6, Vector3::zeros());
                let (mut a, mut b) = stacked(&self.covariance, &linear, nothing);
                a.view_mut((0, 0), (poses, poses)).copy_from(&(&root * derivative));
                b.rows_mut(0, poses).copy_from(&(&root * moved));
                let (step, _) = least(&a, &b);
                for (k, sight) in now.sights.iter_mut().enumerate() {
                    sight.pose = sight.pose.retract(&step.as_slice()[6 * k..6 * k + 6]);
                    sight.linearized_at = sight.pose;
                }
                now.landmark += step.fixed_rows::<3>(poses);
                self::moved(&believed, &now).0
            })
            .collect()
    }

    /// How far errors are from others, in standard deviations after the correction: the largest of
    /// all coordinates.
    pub fn apart(&self, one: &DVector<f64>, other: &DVector<f64>) -> f64 {
        let (_, after) = self.corrected();
        let sigmas = after.diagonal().map(f64::sqrt);
        (one - other).component_div(&sigmas).amax()
    }

    /// How far from the end of the adjustment its steps are, from the beginning on.
    pub fn ways(&self) -> Vec<f64> {
        let steps = self.adjusted(40);
        let end = steps.last().expect("there are steps");
        let begin = DVector::zeros(end.len());
        let all = std::iter::once(&begin).chain(&steps).take(STEPS + 1);
        all.map(|step| self.apart(step, end)).collect()
    }
}

/// The errors that poses have moved by, and their derivative by a further step.
fn moved(believed: &[BodyPose], now: &Track) -> (DVector<f64>, DMatrix<f64>) {
    let size = 6 * believed.len();
    let (mut moved, mut derivative) = (DVector::zeros(size), DMatrix::zeros(size, size));
    for (k, (from, sight)) in believed.iter().zip(&now.sights).enumerate() {
        from.local(&sight.pose, &mut moved.as_mut_slice()[6 * k..6 * k + 6]);
        let mut own = [0.0; 36];
        from.local_jacobian(&sight.pose, &mut own);
        let own = DMatrix::from_column_slice(6, 6, &own);
        derivative.view_mut((6 * k, 6 * k), (6, 6)).copy_from(&own);
    }
    (moved, derivative)
}

/// The seed of the track that the chapter shows.
pub const SEED: u64 = 7;

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("sights", SIGHTS as f64, "", 0);
    chapter.number("rows_before", 2.0 * SIGHTS as f64, "", 0);
    chapter.number("rows_after", 2.0 * SIGHTS as f64 - 3.0, "", 0);
    let passes = UNCERTAIN.map(|uncertain| Pass::new(uncertain, SEED));
    let agreed = passes.each_ref().map(|pass| {
        let first = &pass.adjusted(1)[0];
        let (step, _) = pass.corrected();
        -((&step - first).norm() / step.norm()).log10()
    });
    chapter.number(
        "agreed_digits",
        agreed.into_iter().fold(f64::INFINITY, f64::min).floor(),
        "",
        0,
    );
    let names = ["uncertain_0", "uncertain_1", "uncertain_2"];
    let left_names = ["left_0", "left_1", "left_2"];
    for ((name, left_name), (uncertain, pass)) in
        names.into_iter().zip(left_names).zip(UNCERTAIN.iter().zip(&passes))
    {
        chapter.number(name, 100.0 * uncertain, "cm", 0);
        let ways = pass.ways();
        let decimals = if ways[1] < 0.01 { 4 } else { 2 };
        chapter.number(left_name, ways[1], "standard deviations", decimals);
    }
    chapter.number("second_1", passes[1].ways()[2], "standard deviations", 3);
    chapter.number("second_2", passes[2].ways()[2], "standard deviations", 2);
}
