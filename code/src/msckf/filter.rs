//! The filter: readings carry it on, tracks correct it.

use nalgebra::{DMatrix, DVector, Isometry3, SMatrix, Vector1, Vector3};

use super::update::seen;
use super::window::{Clone, Kept, Window};
use super::{MsckfError, MsckfOptions, PictureReport, Rows, WindowPolicy};
use crate::consistency::{Linearization, Point, certificate, constrained};
use crate::datasets::tracks::{Feature, Picture};
use crate::filtering::{Belief, Transition, chi_square_quantile};
use crate::inertial::{BodyPose, CameraImu, ImuBias, NavState, StampedSample, between};
use crate::least_squares::Key;
use crate::observability::{WorldMotion, four_motions, steps_of_state, vertical};
use crate::preintegration::{Matrix15, preintegrate_combined};
use crate::simulation::Truth;

// ANCHOR: start
/// What a filter begins with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// The time on the sensor's clock, in nanoseconds.
    pub nanoseconds: i64,
    /// The state then.
    pub state: NavState,
    /// The biases then.
    pub bias: ImuBias,
    /// The 15×15 covariance of the errors of state and biases.
    pub covariance: Matrix15,
    /// How the camera sits on the body and how its clock goes. A smoother takes that of its sensors instead.
    pub rig: CameraImu,
}
// ANCHOR_END: start

// ANCHOR: msckf
/// A multi-state constraint Kalman filter. It is given readings and pictures in the order of their
/// times, and has an estimate after each picture.
#[derive(Debug)]
pub struct Msckf {
    pub(super) options: MsckfOptions,
    pub(super) belief: Belief,
    pub(super) state: Key<NavState>,
    pub(super) bias: Key<ImuBias>,
    pub(super) extrinsics: Option<Key<Isometry3<f64>>>,
    pub(super) time_offset: Option<Key<Vector1<f64>>>,
    pub(super) rig: CameraImu,
    pub(super) nanoseconds: i64,
    /// The state as it was predicted, before a picture corrected it.
    pub(super) first: NavState,
    /// Readings that are still needed.
    pub(super) readings: Vec<StampedSample>,
    pub(super) window: Window,
    /// The features of the last picture that was kept, to notice rest.
    pub(super) last: Vec<Feature>,
    /// By degrees of freedom, the largest innovation that passes.
    pub(super) gates: Vec<f64>,
    pub(super) stacked: Rows,
    /// How many pictures were taken.
    taken: usize,
    /// What derivatives at the truth are taken at.
    truth: Option<Truth>,
}
// ANCHOR_END: msckf

/// How fast the body turns by a reading, free of bias.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turning {
    /// The angular velocity, in its own frame.
    pub velocity: Vector3<f64>,
    /// For how many seconds a reading of its interval stands, on average.
    pub seconds: f64,
}

impl Msckf {
    /// A filter that begins with this.
    ///
    /// # Errors
    ///
    /// An [`MsckfError`] names the number that cannot be: a window that is too short, a pixel's standard
    /// deviation that is not positive, a gate that is no probability, a covariance, a state or a bias that is
    /// not finite.
    pub fn new(options: MsckfOptions, start: &Start) -> Result<Self, MsckfError> {
        let MsckfOptions { clones, least_sights, pixel_sigma: sigma, .. } = options;
        if clones < least_sights.max(2) {
            return Err(MsckfError::Window { clones, least_sights });
        }
        if !(sigma > 0.0 && sigma.is_finite()) {
            return Err(MsckfError::PixelSigma { sigma });
        }
        let NavState { world_from_body, velocity, position } = &start.state;
        let bias = start.bias.vector();
        let state = world_from_body.matrix().iter().chain(velocity).chain(position);
        if !state.chain(&bias).chain(&start.covariance).all(|number| number.is_finite()) {
            return Err(MsckfError::Start);
        }
        let mut belief = Belief::new();
        let part = |from: usize, size: usize| {
            DMatrix::from_fn(size, size, |row, column| {
                start.covariance[(from + row, from + column)]
            })
        };
        let state = belief.add(start.state, &part(0, 9))?;
        let bias = belief.add(start.bias, &part(9, 6))?;
        belief.tie(
            (0, 9),
            &DMatrix::from_fn(9, 6, |row, column| start.covariance[(row, 9 + column)]),
        );
        let calibrated = options.calibrated;
        let extrinsics = calibrated.extrinsics.map(|[shift, turn]| {
            let sigmas = [shift, shift, shift, turn, turn, turn];
            let variances = sigmas.map(|sigma| sigma * sigma);
            let variances = DMatrix::from_diagonal(&DVector::from_row_slice(&variances));
            belief.add(start.rig.body_from_camera, &variances)
        });
        let time_offset = calibrated.time_offset.map(|sigma| {
            let variance = DMatrix::from_element(1, 1, sigma * sigma);
            belief.add(Vector1::new(start.rig.time_offset), &variance)
        });
        let gate = chi_square_quantile(options.gate, 0)?;
        belief.follow(free_directions(&options.gravity, &start.state, belief.dimension()))?;
        Ok(Self {
            options,
            state,
            bias,
            extrinsics: extrinsics.transpose()?,
            time_offset: time_offset.transpose()?,
            belief,
            rig: start.rig,
            nanoseconds: start.nanoseconds,
            first: start.state,
            readings: Vec::new(),
            window: Window::default(),
            last: Vec::new(),
            gates: vec![gate],
            stacked: Rows::default(),
            taken: 0,
            truth: None,
        })
    }

    /// Tells the filter the truth, at which derivatives are taken if its options say so. The filter
    /// begins with the first picture then.
    ///
    /// # Errors
    ///
    /// [`MsckfError::NoTruth`] when there is no state.
    pub fn tell(&mut self, truth: &Truth) -> Result<(), MsckfError> {
        let first = truth.states.first().ok_or(MsckfError::NoTruth { picture: 0 })?;
        if self.options.linearization.pixels == Point::Truth && self.taken == 0 {
            let (gravity, dimension) = (&self.options.gravity, self.belief.dimension());
            self.belief.follow(free_directions(gravity, first, dimension))?;
        }
        self.truth = Some(truth.clone());
        Ok(())
    }

    /// Whether the truth of the next picture is needed and not known yet.
    pub(super) fn lacks_truth(&self) -> bool {
        let Linearization { transitions, pixels, .. } = self.options.linearization;
        let is_known = |truth: &Truth| truth.states.len().min(truth.biases.len()) > self.taken;
        [transitions, pixels].contains(&Point::Truth) && !self.truth.as_ref().is_some_and(is_known)
    }

    /// The estimate of the state.
    pub fn state(&self) -> &NavState {
        &self.belief.values()[self.state]
    }

    /// The estimate of the biases.
    pub fn bias(&self) -> &ImuBias {
        &self.belief.values()[self.bias]
    }

    /// How the camera sits on the body and how its clock goes, as it is known or estimated.
    pub fn rig(&self) -> CameraImu {
        let values = self.belief.values();
        CameraImu {
            body_from_camera: self.extrinsics.map_or(self.rig.body_from_camera, |key| values[key]),
            time_offset: self.time_offset.map_or(self.rig.time_offset, |key| values[key].x),
        }
    }

    /// The time of the estimate, on the sensor's clock, in nanoseconds.
    pub fn nanoseconds(&self) -> i64 {
        self.nanoseconds
    }

    /// The 15×15 covariance of the errors of state and biases.
    pub fn covariance(&self) -> Matrix15 {
        self.belief.covariance().fixed_view::<15, 15>(0, 0).into_owned()
    }

    /// All that is believed: state, biases, what is estimated of the calibration, then poses and
    /// kept landmarks as they came.
    pub fn belief(&self) -> &Belief {
        &self.belief
    }

    /// Takes a reading.
    ///
    /// # Errors
    ///
    /// [`MsckfError::Late`] when it is not later than the last one, [`MsckfError::Reading`] when it
    /// is not finite.
    pub fn reading(&mut self, reading: StampedSample) -> Result<(), MsckfError> {
        if !reading.sample.is_finite() {
            return Err(MsckfError::Reading { nanoseconds: reading.nanoseconds });
        }
        match self.readings.last() {
            Some(last) if last.nanoseconds >= reading.nanoseconds => {
                let (nanoseconds, last) = (reading.nanoseconds, last.nanoseconds);
                Err(MsckfError::Late { nanoseconds, last })
            }
            _ => {
                self.readings.push(reading);
                Ok(())
            }
        }
    }

    /// Takes a picture's tracks, when the readings reach its time: carries the estimate on, adds
    /// the pose, and lets the tracks correct it that have ended or grown as long as the window; where
    /// poses are thinned, also what tracks have shown of those that leave.
    ///
    /// # Errors
    ///
    /// An [`MsckfError`]. Where readings are missing or the truth is, the filter stays as it was; when a
    /// correction or a covariance fails, it has to begin again.
    // ANCHOR: picture
    pub fn picture(&mut self, picture: &Picture) -> Result<PictureReport, MsckfError> {
        if self.lacks_truth() {
            return Err(MsckfError::NoTruth { picture: self.taken });
        }
        let turning = self.carry_to(self.rig().imu_nanoseconds(picture.nanoseconds))?;
        self.taken += 1;
        if let Some(rest) = self.options.rest.filter(|rest| self.is_at_rest(picture, rest)) {
            return self.stand_still(&rest, &turning);
        }
        let serial = self.add_clone(&turning.velocity)?;
        self.drop_lost_landmarks(picture)?;
        for feature in &picture.features {
            if !self.window.kept.iter().any(|kept| kept.track == feature.track) {
                let waiting = self.window.waiting.entry(feature.track).or_default();
                waiting.push((serial, feature.pixel));
            }
        }
        let mut due = self.window.due(picture, self.longest());
        let leaving = self.window.leaving(self.options.clones, self.options.policy);
        due.extend(self.window.take(&leaving));
        let report = self.correct(&due, picture)?;
        self.slide(&leaving)?;
        self.last.clone_from(&picture.features);
        Ok(report)
    }
    // ANCHOR_END: picture

    // ANCHOR: carry_to
    /// Carries state and biases to a time, and gives the angular velocity there.
    fn carry_to(&mut self, nanoseconds: i64) -> Result<Turning, MsckfError> {
        let bias = *self.bias();
        let at_end = |readings: &[StampedSample]| {
            let last = readings.iter().rfind(|reading| reading.nanoseconds <= nanoseconds);
            last.map_or(Vector3::zeros(), |last| last.sample.corrected(&bias).gyro)
        };
        if nanoseconds == self.nanoseconds && self.taken == 0 {
            return Ok(Turning { velocity: at_end(&self.readings), seconds: 0.0 });
        }
        let readings = between(&self.readings, self.nanoseconds, nanoseconds)?;
        let transition = self.transition(&readings)?;
        self.belief.carry_on((self.state, self.bias), &transition)?;
        self.first = transition.state;
        self.nanoseconds = nanoseconds;
        let before = self.readings.partition_point(|reading| reading.nanoseconds <= nanoseconds);
        self.readings.drain(..before.saturating_sub(1));
        let all = readings[0].seconds_to(&readings[readings.len() - 1]);
        let seconds = all / (readings.len() - 1) as f64;
        Ok(Turning { velocity: at_end(&readings), seconds })
    }
    // ANCHOR_END: carry_to

    // ANCHOR: transition_at
    /// What readings do to the state and its errors, with derivatives where the options say.
    fn transition(&self, readings: &[StampedSample]) -> Result<Transition, MsckfError> {
        let MsckfOptions { linearization, ref noise, ref gravity, .. } = self.options;
        let (state, bias) = (self.state(), self.bias());
        let sums = preintegrate_combined(readings, bias, noise)?;
        let second = sums.sums.predict(state, gravity, bias);
        let mut transition = match linearization.transitions {
            Point::Latest => Transition::between((state, &second), &sums, bias, gravity)?,
            Point::First => Transition::between((&self.first, &second), &sums, bias, gravity)?,
            Point::Truth => {
                let before = self.taken.checked_sub(1).ok_or(MsckfError::StartBeforeTruth)?;
                let (first, bias) = self.true_state(before)?;
                let (last, _) = self.true_state(self.taken)?;
                let sums = preintegrate_combined(readings, &bias, noise)?;
                Transition::between((&first, &last), &sums, &bias, gravity)?
            }
        };
        transition.state = second;
        if linearization.constrained {
            transition.by_error = self.freed(&transition);
        }
        Ok(transition)
    }
    // ANCHOR_END: transition_at

    // ANCHOR: freed
    /// A transition changed as little as can be to take the free directions from where they are
    /// followed to those of its second state.
    fn freed(&self, transition: &Transition) -> Matrix15 {
        let Transition { state, by_error, .. } = transition;
        let free = self.belief.directions().rows(0, 15).into_owned();
        let wanted = free_directions(&self.options.gravity, state, 15);
        let rows = DMatrix::from_column_slice(15, 15, by_error.as_slice());
        let freed = constrained(&rows, &free, &wanted);
        freed.map_or(*by_error, |freed| Matrix15::from_column_slice(freed.as_slice()))
    }
    // ANCHOR_END: freed

    /// The true state and biases at a picture.
    fn true_state(&self, picture: usize) -> Result<(NavState, ImuBias), MsckfError> {
        let known = self
            .truth
            .as_ref()
            .and_then(|truth| Some((*truth.states.get(picture)?, *truth.biases.get(picture)?)));
        known.ok_or(MsckfError::NoTruth { picture })
    }

    /// Where the landmark of a track truly is.
    pub(super) fn true_landmark(&self, track: usize) -> Option<Vector3<f64>> {
        let truth = self.truth.as_ref()?;
        truth.landmarks.get(*truth.landmark_of_track.get(track)?).copied()
    }

    /// The four motions that no sensor sees.
    pub(super) fn motions(&self) -> [WorldMotion; 4] {
        motions(&self.options.gravity)
    }

    // ANCHOR: filter_certificate
    /// The 4×4 matrix of what is believed to be known along the free directions: shifts along the
    /// axes, in 1/m², and a turn about the vertical, in 1/rad². The newest pose is left out: it is a
    /// part of the state and says nothing of its own. `None` where something is known exactly, and
    /// before the first pose.
    pub fn certificate(&self) -> Option<SMatrix<f64, 4, 4>> {
        let newest = self.window.clones.last()?.variable;
        let newest = self.belief.values().coordinates_of(newest)?;
        let others: Vec<usize> =
            (0..self.belief.dimension()).filter(|at| !newest.contains(at)).collect();
        let covariance = self.belief.covariance().select_rows(&others).select_columns(&others);
        certificate(&covariance, &self.belief.directions().select_rows(&others))
    }
    // ANCHOR_END: filter_certificate

    // ANCHOR: add_clone
    /// Adds the pose of the picture. When the time offset is estimated, its error moves the pose
    /// along with the body's velocities: the picture was taken earlier or later than believed.
    fn add_clone(&mut self, turning: &Vector3<f64>) -> Result<usize, MsckfError> {
        let state = *self.state();
        let mut by_all = DMatrix::zeros(6, self.belief.dimension());
        by_all.view_mut((0, 0), (3, 3)).fill_with_identity();
        by_all.view_mut((3, 6), (3, 3)).fill_with_identity();
        let values = self.belief.values();
        if let Some(offset) = self.time_offset.and_then(|key| values.coordinates_of(key.index())) {
            by_all.view_mut((0, offset.start), (3, 1)).copy_from(turning);
            by_all.view_mut((3, offset.start), (3, 1)).copy_from(&state.velocity);
        }
        let nothing = DMatrix::zeros(6, 6);
        let pose = BodyPose::from(&state);
        let key = self.belief.add_function(pose, &by_all, &nothing)?;
        let serial = self.window.next_serial;
        self.window.next_serial += 1;
        let picture = self.taken - 1;
        self.window.clones.push(Clone { variable: key.index(), serial, picture, first: pose });
        self.widen_gates()?;
        Ok(serial)
    }
    // ANCHOR_END: add_clone

    /// Computes the gate for as many rows as the poses of the window can have.
    fn widen_gates(&mut self) -> Result<(), MsckfError> {
        for rows in self.gates.len()..=2 * self.window.clones.len() {
            self.gates.push(chi_square_quantile(self.options.gate, rows)?);
        }
        Ok(())
    }

    /// The pose in the window with this number, and where it is linearized.
    pub(super) fn pose(&self, serial: usize) -> Option<(BodyPose, BodyPose)> {
        let clone = self.window.clones[self.window.place(serial)?];
        let values = self.belief.values();
        let pose = *values.get(values.key::<BodyPose>(clone.variable)?)?;
        let linearized_at = match self.options.linearization.pixels {
            Point::Latest => pose,
            Point::First => clone.first,
            Point::Truth => BodyPose::from(&self.true_state(clone.picture).ok()?.0),
        };
        Some((pose, linearized_at))
    }

    /// Drops the landmarks that this picture does not show.
    fn drop_lost_landmarks(&mut self, picture: &Picture) -> Result<(), MsckfError> {
        let is_seen = |kept: &Kept| seen(picture, kept.track).is_some();
        let kept = self.window.kept.iter().filter(|kept| !is_seen(kept));
        let lost: Vec<usize> = kept.map(|kept| kept.variable).collect();
        self.window.kept.retain(is_seen);
        self.drop_variables(&lost)
    }

    /// At how many pixels a track is due at the latest. Where poses are thinned, pixels are used as
    /// their poses leave, and only what may be kept as a landmark is due as a whole.
    fn longest(&self) -> usize {
        let MsckfOptions { clones, policy, landmarks, .. } = self.options;
        let has_room = self.window.kept.len() < landmarks;
        if policy == WindowPolicy::Oldest || has_room { clones } else { usize::MAX }
    }

    // ANCHOR: slide
    /// Drops the poses that leave the window.
    fn slide(&mut self, places: &[usize]) -> Result<(), MsckfError> {
        let variable = |place: &usize| self.window.clones[*place].variable;
        let gone: Vec<usize> = places.iter().map(variable).collect();
        self.window.clones.retain(|clone| !gone.contains(&clone.variable));
        self.drop_variables(&gone)
    }
    // ANCHOR_END: slide

    fn drop_variables(&mut self, gone: &[usize]) -> Result<(), MsckfError> {
        if gone.is_empty() {
            return Ok(());
        }
        let count = self.belief.values().len();
        let stays: Vec<usize> = (0..count).filter(|number| !gone.contains(number)).collect();
        self.belief.keep(&stays)?;
        self.window.renumber(|number| stays.partition_point(|other| *other < number));
        Ok(())
    }
}

fn motions(gravity: &Vector3<f64>) -> [WorldMotion; 4] {
    four_motions(&vertical(gravity))
}

/// The steps of a state under the four free motions, in the first of `dimension` rows.
fn free_directions(gravity: &Vector3<f64>, state: &NavState, dimension: usize) -> DMatrix<f64> {
    let mut free = DMatrix::zeros(dimension, 4);
    free.fixed_rows_mut::<9>(0).copy_from(&steps_of_state(&motions(gravity), state));
    free
}
