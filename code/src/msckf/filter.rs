//! The filter: readings carry it on, tracks correct it.

use nalgebra::{DMatrix, DVector, Isometry3, Vector1, Vector3};

use super::update::seen;
use super::window::{Clone, Kept, Window};
use super::{Linearization, MsckfError, MsckfOptions, PictureReport, Rows};
use crate::datasets::tracks::{Feature, Picture};
use crate::filtering::{Belief, Transition, chi_square_quantile};
use crate::inertial::{BodyPose, CameraImu, ImuBias, NavState, StampedSample, between};
use crate::least_squares::Key;
use crate::preintegration::{Matrix15, preintegrate_combined};

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
    /// How the camera sits on the body and how its clock goes.
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
    /// The features of the last picture, to notice rest.
    pub(super) last: Vec<Feature>,
    /// By degrees of freedom, the largest innovation that passes.
    pub(super) gates: Vec<f64>,
    pub(super) stacked: Rows,
}
// ANCHOR_END: msckf

impl Msckf {
    /// A filter that begins with this.
    ///
    /// # Errors
    ///
    /// An [`MsckfError`] names the number that cannot be.
    pub fn new(options: MsckfOptions, start: &Start) -> Result<Self, MsckfError> {
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
        let gate = |degrees| chi_square_quantile(options.gate, degrees);
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
            gates: (0..=2 * options.clones).map(gate).collect::<Result<_, _>>()?,
            stacked: Rows::default(),
        })
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
    /// [`MsckfError::Late`] when it is not later than the last one.
    pub fn reading(&mut self, reading: StampedSample) -> Result<(), MsckfError> {
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

    // ANCHOR: picture
    /// Takes a picture's tracks, when the readings reach its time: carries the estimate on, adds
    /// the pose, and lets the tracks correct it that have ended or grown as long as the window.
    ///
    /// # Errors
    ///
    /// An [`MsckfError`]; the filter then stays as it was but for what the readings carried on.
    pub fn picture(&mut self, picture: &Picture) -> Result<PictureReport, MsckfError> {
        let turning = self.carry_to(self.rig().imu_nanoseconds(picture.nanoseconds))?;
        if let Some(rest) = self.options.rest.filter(|rest| self.is_at_rest(picture, rest)) {
            return self.stand_still(&rest, &turning);
        }
        let serial = self.add_clone(&turning)?;
        self.drop_lost_landmarks(picture)?;
        for feature in &picture.features {
            if !self.window.kept.iter().any(|kept| kept.track == feature.track) {
                let waiting = self.window.waiting.entry(feature.track).or_default();
                waiting.push((serial, feature.pixel));
            }
        }
        let due = self.window.due(picture, self.options.clones);
        let report = self.correct(&due, picture)?;
        self.slide()?;
        self.last.clone_from(&picture.features);
        Ok(report)
    }
    // ANCHOR_END: picture

    // ANCHOR: carry_to
    /// Carries state and biases to a time, and gives the angular velocity there.
    fn carry_to(&mut self, nanoseconds: i64) -> Result<Vector3<f64>, MsckfError> {
        let bias = *self.bias();
        let at_end = |readings: &[StampedSample]| {
            let last = readings.iter().rfind(|reading| reading.nanoseconds <= nanoseconds);
            last.map_or(Vector3::zeros(), |last| last.sample.corrected(&bias).gyro)
        };
        if nanoseconds == self.nanoseconds {
            return Ok(at_end(&self.readings));
        }
        let readings = between(&self.readings, self.nanoseconds, nanoseconds)?;
        let sums = preintegrate_combined(&readings, &bias, &self.options.noise)?;
        let (state, gravity) = (*self.state(), self.options.gravity);
        let first = match self.options.linearization {
            Linearization::Latest => state,
            Linearization::FirstEstimates => self.first,
        };
        let transition = Transition::linearized_at(&first, &sums, &state, &bias, &gravity)?;
        self.belief.carry_on((self.state, self.bias), &transition)?;
        self.first = transition.state;
        self.nanoseconds = nanoseconds;
        let before = self.readings.partition_point(|reading| reading.nanoseconds <= nanoseconds);
        self.readings.drain(..before.saturating_sub(1));
        Ok(at_end(&readings))
    }
    // ANCHOR_END: carry_to

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
        self.window.clones.push(Clone { variable: key.index(), serial, first: pose });
        Ok(serial)
    }
    // ANCHOR_END: add_clone

    /// The pose in the window with this number, and where it is linearized.
    pub(super) fn pose(&self, serial: usize) -> Option<(BodyPose, BodyPose)> {
        let clone = self.window.clones[self.window.place(serial)?];
        let values = self.belief.values();
        let pose = *values.get(values.key::<BodyPose>(clone.variable)?)?;
        match self.options.linearization {
            Linearization::Latest => Some((pose, pose)),
            Linearization::FirstEstimates => Some((pose, clone.first)),
        }
    }

    /// Drops the landmarks that this picture does not show.
    fn drop_lost_landmarks(&mut self, picture: &Picture) -> Result<(), MsckfError> {
        let is_seen = |kept: &Kept| seen(picture, kept.track).is_some();
        let kept = self.window.kept.iter().filter(|kept| !is_seen(kept));
        let lost: Vec<usize> = kept.map(|kept| kept.variable).collect();
        self.window.kept.retain(is_seen);
        self.drop_variables(&lost)
    }

    // ANCHOR: slide
    /// Drops the poses that leave the window.
    fn slide(&mut self) -> Result<(), MsckfError> {
        let places = self.window.leaving(self.options.clones, self.options.policy);
        let gone: Vec<usize> =
            places.iter().map(|place| self.window.clones[*place].variable).collect();
        self.window.forget(&places);
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
