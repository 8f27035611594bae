//! Windows whose pattern is known: who saw what.

use nalgebra::{Isometry3, Matrix6, Vector3, Vector6};
use thiserror::Error;

use super::Couplings;
use crate::factors::{Prior, RelativePose, StereoByPose};
use crate::least_squares::{Kernel, Key, Problem, ProblemError};
use crate::manifold::se3;
use crate::reprojection::Pinhole;
use crate::simulation::random::{Purpose, normal, random};
use crate::two_views::{StereoError, StereoFactor, StereoPinhole};

// ANCHOR: layout
/// Keyframes, which of them odometry links, and landmarks with the keyframes that saw them.
///
/// Keyframe k is block k. Landmark l is the block after all keyframes and l landmarks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    /// How many keyframes there are.
    pub keyframes: usize,
    /// The pairs of keyframes that odometry links.
    pub odometry: Vec<(usize, usize)>,
    /// For each landmark the keyframes that saw it.
    pub seen_by: Vec<Vec<usize>>,
}
// ANCHOR_END: layout

/// Standard deviations of what a window is measured with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindowSigmas {
    /// Of each coordinate of a pixel.
    pub pixel: f64,
    /// Of the translation that odometry measures, in metres.
    pub odometry_metres: f64,
    /// Of the rotation that odometry measures, in radians.
    pub odometry_radians: f64,
    /// Of what is known of the first keyframe, in metres and in radians: the larger it is, the worse is
    /// the window's condition. When it is infinite nothing is known, and the window is free as a whole.
    pub first_keyframe: f64,
}

impl Default for WindowSigmas {
    /// A pixel, two centimetres, half a degree, and a first keyframe that is known to a centimetre and a
    /// hundredth of a radian.
    fn default() -> Self {
        let odometry_radians = 0.5_f64.to_radians();
        Self { pixel: 1.0, odometry_metres: 0.02, odometry_radians, first_keyframe: 0.01 }
    }
}

impl Layout {
    // ANCHOR: chain
    /// Keyframes in a row, each linked with the next by odometry, and landmarks spread along the row,
    /// each seen by `in_a_row` consecutive keyframes.
    pub fn chain(keyframes: usize, landmarks: usize, in_a_row: usize) -> Self {
        let odometry = (1..keyframes).map(|second| (second - 1, second)).collect();
        let views = in_a_row.min(keyframes);
        let first = |landmark: usize| landmark * (keyframes - views + 1) / landmarks.max(1);
        let seen_by = (0..landmarks).map(|l| (first(l)..first(l) + views).collect()).collect();
        Self { keyframes, odometry, seen_by }
    }
    // ANCHOR_END: chain

    /// The window of the chapter: eight keyframes, twelve landmarks, each seen by four keyframes in a
    /// row.
    pub fn eight_keyframes() -> Self {
        Self::chain(8, 12, 4)
    }

    /// The chain that comes back: odometry links the last keyframe with the first one, and landmarks
    /// near the end are seen from the beginning too.
    pub fn ring(keyframes: usize, landmarks: usize, in_a_row: usize) -> Self {
        let link = |first| (first, (first + 1) % keyframes);
        let links = if keyframes > 2 { keyframes } else { keyframes.saturating_sub(1) };
        let odometry = (0..links).map(link).collect();
        let views = in_a_row.min(keyframes);
        let first = |landmark: usize| landmark * keyframes / landmarks.max(1);
        let seen_by = |l| (0..views).map(|view| (first(l) + view) % keyframes).collect();
        Self { keyframes, odometry, seen_by: (0..landmarks).map(seen_by).collect() }
    }

    /// A chain of keyframes of which every one sees the same landmark.
    pub fn star(keyframes: usize) -> Self {
        Self::chain(keyframes, 1, keyframes)
    }

    /// A chain whose ends alone see the same landmarks: somebody comes back to a place after a gap.
    pub fn gap(keyframes: usize, landmarks: usize) -> Self {
        let seen_by = vec![vec![0, keyframes.saturating_sub(1)]; landmarks];
        Self { seen_by, ..Self::chain(keyframes, 0, 0) }
    }

    /// The same landmarks without odometry.
    pub fn without_odometry(self) -> Self {
        Self { odometry: Vec::new(), ..self }
    }

    /// The name of a landmark.
    pub fn landmark(&self, landmark: usize) -> usize {
        self.keyframes + landmark
    }

    /// The names of the landmarks that a keyframe saw.
    pub fn seen_from(&self, keyframe: usize) -> Vec<usize> {
        let sees = |landmark: &usize| self.seen_by[*landmark].contains(&keyframe);
        (0..self.seen_by.len()).filter(sees).map(|landmark| self.landmark(landmark)).collect()
    }

    // ANCHOR: slide
    /// What leaves together when a keyframe departs: the landmarks that it saw, and then itself.
    pub fn slide(&self, keyframe: usize) -> Vec<usize> {
        let mut gone = self.seen_from(keyframe);
        gone.push(keyframe);
        gone
    }
    // ANCHOR_END: slide

    // ANCHOR: layout_couplings
    /// The graph of the window's information matrix.
    pub fn couplings(&self) -> Couplings {
        let mut couplings = Couplings::new(0..self.keyframes + self.seen_by.len());
        for &(first, second) in &self.odometry {
            couplings.couple(first, second);
        }
        for (landmark, seen_by) in self.seen_by.iter().enumerate() {
            for &keyframe in seen_by {
                couplings.couple(keyframe, self.landmark(landmark));
            }
        }
        couplings
    }
    // ANCHOR_END: layout_couplings

    // ANCHOR: layout_problem
    /// The window as measured: a stereo camera goes sideways along a wall five to eight metres away, a
    /// keyframe every half metre, and sees the landmarks in front of the middle of those keyframes that
    /// saw them. The problem stands at the truth, and its variables have the layout's names.
    ///
    /// # Errors
    ///
    /// A [`LayoutError`] when there is no keyframe, one that is named does not exist or stands twice, a
    /// landmark is seen by none or lies behind one, or a standard deviation is none.
    pub fn problem(&self, sigmas: &WindowSigmas, seed: u64) -> Result<Problem, LayoutError> {
        self.check()?;
        let mut window = Simulated::new(self, sigmas, seed)?;
        window.know_first()?;
        for &(first, second) in &self.odometry {
            window.measure_between(first, second)?;
        }
        for (landmark, seen_by) in self.seen_by.iter().enumerate() {
            for &keyframe in seen_by {
                window.see(keyframe, landmark)?;
            }
        }
        Ok(window.problem)
    }
    // ANCHOR_END: layout_problem

    fn check(&self) -> Result<(), LayoutError> {
        let pairs = self.odometry.iter().map(|(first, second)| vec![*first, *second]);
        for named in pairs.chain(self.seen_by.iter().cloned()) {
            if let Some(keyframe) = named.iter().find(|keyframe| **keyframe >= self.keyframes) {
                let (keyframe, keyframes) = (*keyframe, self.keyframes);
                return Err(LayoutError::NoSuchKeyframe { keyframe, keyframes });
            }
            if (1..named.len()).any(|at| named[..at].contains(&named[at])) {
                return Err(LayoutError::Repeated { named });
            }
        }
        match self.seen_by.iter().position(Vec::is_empty) {
            Some(landmark) => Err(LayoutError::Unseen { landmark }),
            None if self.keyframes == 0 => Err(LayoutError::NoKeyframes),
            None => Ok(()),
        }
    }
}

/// A window that is being measured.
struct Simulated {
    problem: Problem,
    sigmas: WindowSigmas,
    keyframes: Vec<Key<Isometry3<f64>>>,
    landmarks: Vec<Key<Vector3<f64>>>,
    camera: StereoPinhole,
    random: rand_chacha::ChaCha8Rng,
}

impl Simulated {
    fn new(layout: &Layout, sigmas: &WindowSigmas, seed: u64) -> Result<Self, LayoutError> {
        let WindowSigmas { pixel, odometry_metres, odometry_radians, first_keyframe } = *sigmas;
        let measured = [pixel, odometry_metres, odometry_radians].map(|sigma| (sigma, f64::MAX));
        for (sigma, most) in measured.into_iter().chain([(first_keyframe, f64::INFINITY)]) {
            if !(sigma > 0.0 && sigma <= most) {
                return Err(LayoutError::Sigma { sigma });
            }
        }
        let mut random = random(seed, Purpose::Window);
        let mut problem = Problem::new();
        let mut keyframe = |k: usize| {
            let turn = Vector6::from_fn(|_, _| 0.05 * normal(&mut random));
            let camera_from_world = Isometry3::translation(-0.5 * k as f64, 0.0, 0.0);
            problem.add_variable(se3::retract(&camera_from_world, &turn))
        };
        let keyframes = (0..layout.keyframes).map(&mut keyframe).collect();
        let mut landmark = |seen_by: &Vec<usize>| {
            let middle = 0.5 * seen_by.iter().sum::<usize>() as f64 / seen_by.len() as f64;
            let [across, up, away] = [0.5, 0.7, 0.6].map(|size| size * normal(&mut random));
            let away = 6.5 + away.clamp(-1.5, 1.5);
            problem.add_variable(Vector3::new(middle + across, up, away))
        };
        let landmarks = layout.seen_by.iter().map(&mut landmark).collect();
        let pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };
        let camera = StereoPinhole::new(pinhole, 0.1)?;
        Ok(Self { problem, sigmas: *sigmas, keyframes, landmarks, camera, random })
    }

    fn know_first(&mut self) -> Result<(), LayoutError> {
        let variable = self.keyframes[0];
        let sigma = self.sigmas.first_keyframe;
        if sigma == f64::INFINITY {
            return Ok(());
        }
        let noise = Vector6::from_fn(|_, _| sigma * normal(&mut self.random));
        let anchor = se3::retract(&self.problem.values()[variable], &noise);
        self.problem.add_factor(Prior::near(variable, anchor, [sigma; 6]), Kernel::Squared)?;
        Ok(())
    }

    fn measure_between(&mut self, first: usize, second: usize) -> Result<(), LayoutError> {
        let [first, second] = [first, second].map(|keyframe| self.keyframes[keyframe]);
        let WindowSigmas { odometry_metres, odometry_radians, .. } = self.sigmas;
        let sigmas = Vector3::repeat(odometry_metres).push(odometry_radians);
        let sigmas = sigmas.push(odometry_radians).push(odometry_radians);
        let values = self.problem.values();
        let truth = values[second] * values[first].inverse();
        let noise = sigmas.map(|sigma| sigma * normal(&mut self.random));
        let measured = se3::retract(&truth, &noise);
        let sqrt_information = Matrix6::from_diagonal(&sigmas.map(f64::recip));
        let odometry = RelativePose { first, second, measured, sqrt_information };
        self.problem.add_factor(odometry, Kernel::Squared)?;
        Ok(())
    }

    fn see(&mut self, keyframe: usize, landmark: usize) -> Result<(), LayoutError> {
        let (pose, point) = (self.keyframes[keyframe], self.landmarks[landmark]);
        let values = self.problem.values();
        let predicted = self.camera.project_with_jacobians(&values[pose], &values[point]);
        let predicted = predicted.ok_or(LayoutError::Behind { keyframe, landmark })?.observation;
        let noise = Vector3::from_fn(|_, _| self.sigmas.pixel * normal(&mut self.random));
        let observed = StereoFactor::new(keyframe, landmark, predicted + noise, self.sigmas.pixel)?;
        let seen = StereoByPose { pose, landmark: point, camera: self.camera, observed };
        self.problem.add_factor(seen, Kernel::Squared)?;
        Ok(())
    }
}

/// Why a layout is none.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LayoutError {
    /// There is nobody to see anything.
    #[error("the layout has no keyframes; give it at least one")]
    NoKeyframes,
    /// A keyframe is named that does not exist.
    #[error("keyframe {keyframe} is none of the layout's {keyframes}, counted from zero")]
    NoSuchKeyframe {
        /// The number given.
        keyframe: usize,
        /// How many there are.
        keyframes: usize,
    },
    /// A keyframe is linked with itself, or sees a landmark twice.
    #[error("one of the keyframes {named:?} stands there twice; name each once")]
    Repeated {
        /// The keyframes of the odometry or the landmark.
        named: Vec<usize>,
    },
    /// A landmark was not seen.
    #[error("landmark {landmark} is seen by no keyframe; leave it out")]
    Unseen {
        /// Which landmark.
        landmark: usize,
    },
    /// A standard deviation is zero, negative or not finite.
    #[error("the standard deviation {sigma} is none; give positive, finite numbers")]
    Sigma {
        /// The value given.
        sigma: f64,
    },
    /// A landmark does not lie in front of a camera.
    #[error("landmark {landmark} lies behind keyframe {keyframe}; choose another seed")]
    Behind {
        /// Which keyframe.
        keyframe: usize,
        /// Which landmark.
        landmark: usize,
    },
    /// What was seen is no observation.
    #[error(transparent)]
    Stereo(#[from] StereoError),
    /// A factor does not fit.
    #[error(transparent)]
    Problem(#[from] ProblemError),
}
