//! The filter: readings carry it on, tracks correct it.

use nalgebra::{DMatrix, DVector, Isometry3, Vector1, Vector3};
use thiserror::Error;

use super::window::{Clone, Kept, Waiting, Window};
use super::{
    Linearization, LinearizedTrack, MsckfOptions, PictureReport, Rest, Rows, Sight, TrackError,
    landmark,
};
use crate::datasets::tracks::Picture;
use crate::factors::BodyPixel;
use crate::filtering::{Belief, BeliefError, CorrectionError, Transition, TransitionError};
use crate::filtering::{ChiSquareError, chi_square_quantile};
use crate::inertial::{
    BodyPose, CameraImu, ImuBias, NavState, StampedSample, WindowError, between,
};
use crate::least_squares::Key;
use crate::preintegration::{CombinedPreintegrator, Matrix15, PreintegrationError};

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
    options: MsckfOptions,
    belief: Belief,
    state: Key<NavState>,
    bias: Key<ImuBias>,
    extrinsics: Option<Key<Isometry3<f64>>>,
    time_offset: Option<Key<Vector1<f64>>>,
    rig: CameraImu,
    nanoseconds: i64,
    /// The state as it was predicted, before a picture corrected it.
    first: NavState,
    /// Readings that are still needed.
    readings: Vec<StampedSample>,
    window: Window,
    /// The features of the last picture, to notice rest.
    last: Vec<crate::datasets::tracks::Feature>,
    /// By degrees of freedom, the largest innovation that passes.
    gates: Vec<f64>,
    stacked: Rows,
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
        let mut sums = CombinedPreintegrator::new(&bias, &self.options.noise)?;
        for pair in readings.windows(2) {
            let dt = pair[0].seconds_to(&pair[1]);
            sums.integrate_midpoint(&pair[0].sample, &pair[1].sample, dt)?;
        }
        let (state, gravity) = (*self.state(), self.options.gravity);
        let first = match self.options.linearization {
            Linearization::Latest => state,
            Linearization::FirstEstimates => self.first,
        };
        let transition =
            Transition::linearized_at(&first, &sums.finish()?, &state, &bias, &gravity)?;
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
    fn pose(&self, serial: usize) -> Option<(BodyPose, BodyPose)> {
        let clone = self.window.clones[self.window.place(serial)?];
        let values = self.belief.values();
        let pose = *values.get(values.key::<BodyPose>(clone.variable)?)?;
        match self.options.linearization {
            Linearization::Latest => Some((pose, pose)),
            Linearization::FirstEstimates => Some((pose, clone.first)),
        }
    }

    fn sights(&self, waiting: &Waiting) -> Vec<Sight> {
        let sight = |&(serial, pixel): &(usize, _)| {
            let (pose, linearized_at) = self.pose(serial)?;
            Some(Sight { pose, linearized_at, pixel })
        };
        waiting.iter().filter_map(sight).collect()
    }

    // ANCHOR: correct
    /// Lets tracks correct the filter, all at once.
    fn correct(
        &mut self,
        due: &[(usize, Waiting)],
        picture: &Picture,
    ) -> Result<PictureReport, MsckfError> {
        let mut report = PictureReport::default();
        let mut passed = Vec::new();
        for (track, waiting) in due {
            match self.judge(waiting) {
                Ok((linear, landmark)) => passed.push((*track, waiting, linear, landmark)),
                Err(refusal) => refusal.count(&mut report),
            }
        }
        for (track, waiting, linear, landmark) in &passed {
            let is_full = waiting.len() >= self.options.clones;
            if is_full && self.window.kept.len() < self.options.landmarks {
                self.keep_landmark(*track, waiting, linear, landmark)?;
            }
        }
        self.stacked.clear(self.belief.dimension() + 1);
        for (_, waiting, linear, _) in &passed {
            self.stack(waiting, linear);
        }
        report.used = passed.len() + self.stack_kept(picture, &mut report);
        self.stacked.compress();
        report.rows = self.stacked.len();
        if !self.stacked.is_empty() {
            let (jacobian, residual) = self.stacked.system();
            self.belief.correct(&jacobian, &residual, self.options.form)?;
        }
        Ok(report)
    }
    // ANCHOR_END: correct

    // ANCHOR: judge
    /// The rows of a track and its landmark, if it may correct the filter.
    fn judge(&self, waiting: &Waiting) -> Result<(LinearizedTrack, Vector3<f64>), Refusal> {
        if waiting.len() < self.options.least_sights {
            return Err(Refusal::Short);
        }
        let MsckfOptions { ref camera, pixel_sigma, least_parallax, largest_sigma, .. } =
            self.options;
        let (sights, rig) = (self.sights(waiting), self.rig());
        let camera = (camera, pixel_sigma);
        let landmark = landmark(&sights, &rig.body_from_camera, camera, least_parallax);
        let landmark = landmark.map_err(|_| Refusal::Landmark)?;
        let mut linear = LinearizedTrack::default();
        linear.linearize(&sights, &landmark, &rig.body_from_camera, camera)?;
        linear.project(largest_sigma)?;
        let innovation = self.innovation(waiting, &linear);
        let gate = self.gates.get(linear.constraints()).copied().unwrap_or(f64::INFINITY);
        if innovation.is_none_or(|innovation| innovation > gate) {
            return Err(Refusal::Gated);
        }
        Ok((linear, landmark))
    }
    // ANCHOR_END: judge

    /// Where the columns of a track's rows stand in the belief: those of the poses and of the
    /// camera. `None` for what is not estimated.
    fn columns(&self, waiting: &Waiting) -> Vec<Option<usize>> {
        let values = self.belief.values();
        let start = |variable: usize| values.coordinates_of(variable).map(|own| own.start);
        let pose = |serial: usize| {
            let place = self.window.place(serial)?;
            start(self.window.clones[place].variable)
        };
        let starts = waiting.iter().map(|(serial, _)| pose(*serial));
        let starts = starts.chain([self.extrinsics.and_then(|key| start(key.index()))]);
        starts.flat_map(|start| (0..6).map(move |axis| start.map(|start| start + axis))).collect()
    }

    // ANCHOR: innovation
    /// The normalized innovation squared of a track's constraints; `None` when the covariance is
    /// none.
    fn innovation(&self, waiting: &Waiting, linear: &LinearizedTrack) -> Option<f64> {
        let (places, columns): (Vec<usize>, Vec<usize>) = (self.columns(waiting).into_iter())
            .enumerate()
            .filter_map(|(place, column)| Some((3 + place, column?)))
            .unzip();
        let rows = linear.rows();
        let count = linear.constraints();
        let jacobian =
            DMatrix::from_fn(count, places.len(), |row, at| rows.row(row + 3)[places[at]]);
        let mut residual = DVector::from_fn(count, |row, _| rows.row(row + 3)[rows.width() - 1]);
        let covariance = self.belief.covariance();
        let covariance = DMatrix::from_fn(columns.len(), columns.len(), |row, column| {
            covariance[(columns[row], columns[column])]
        });
        let mut innovation = &jacobian * covariance * jacobian.transpose();
        (0..count).for_each(|row| innovation[(row, row)] += 1.0);
        let root = innovation.cholesky()?;
        root.l_dirty().solve_lower_triangular_mut(&mut residual);
        Some(residual.norm_squared())
    }
    // ANCHOR_END: innovation

    /// Adds the constraints of a track to those that correct the filter.
    fn stack(&mut self, waiting: &Waiting, linear: &LinearizedTrack) {
        let columns = self.columns(waiting);
        let width = self.stacked.width();
        for from in linear.rows().from(3) {
            let into = self.stacked.add();
            for (number, column) in from[3..].iter().zip(&columns) {
                if let Some(column) = column {
                    into[*column] = *number;
                }
            }
            into[width - 1] = from[from.len() - 1];
        }
    }

    // ANCHOR: keep_landmark
    /// Adds the landmark of a track to the state. The first three rows of the track, R e_f + H e + r
    /// with white noise, say how its error follows from that of the poses.
    fn keep_landmark(
        &mut self,
        track: usize,
        waiting: &Waiting,
        linear: &LinearizedTrack,
        landmark: &Vector3<f64>,
    ) -> Result<(), MsckfError> {
        let root = linear.landmark_root();
        let Some(inverse) = root.try_inverse() else { return Ok(()) };
        let (rows, columns) = (linear.rows(), self.columns(waiting));
        let mut by_all = DMatrix::zeros(3, self.belief.dimension());
        for (place, column) in columns.iter().enumerate() {
            let by_one = Vector3::from_fn(|row, _| rows.row(row)[3 + place]);
            if let Some(column) = column {
                by_all.set_column(*column, &(-inverse * by_one));
            }
        }
        let residual = Vector3::from_fn(|row, _| rows.row(row)[rows.width() - 1]);
        let landmark = landmark - inverse * residual;
        let noise = inverse * inverse.transpose();
        let noise = DMatrix::from_column_slice(3, 3, noise.as_slice());
        let key = self.belief.add_function(landmark, &by_all, &noise)?;
        self.window.kept.push(Kept { track, variable: key.index(), first: landmark });
        Ok(())
    }
    // ANCHOR_END: keep_landmark

    /// Adds the pixels of the kept landmarks. Returns how many there are.
    fn stack_kept(&mut self, picture: &Picture, report: &mut PictureReport) -> usize {
        let mut count = 0;
        for place in 0..self.window.kept.len() {
            match self.kept_rows(place, picture) {
                Some(rows) => {
                    rows.iter().for_each(|row| self.stacked.add().copy_from_slice(row));
                    count += 1;
                }
                None => report.refused.gated += 1,
            }
        }
        count
    }

    /// The two rows of a kept landmark, if its pixel passes the gate.
    fn kept_rows(&self, place: usize, picture: &Picture) -> Option<[Vec<f64>; 2]> {
        let Kept { track, variable, first } = self.window.kept[place];
        let values = self.belief.values();
        let feature = picture.features.binary_search_by_key(&track, |f| f.track).ok()?;
        let newest = self.window.clones.last()?;
        let (pose, linearized_at) = self.pose(newest.serial)?;
        let landmark = *values.get(values.key::<Vector3<f64>>(variable)?)?;
        let linearized = match self.options.linearization {
            Linearization::Latest => landmark,
            Linearization::FirstEstimates => first,
        };
        let extrinsics = self.rig().body_from_camera;
        let pixel = BodyPixel {
            camera: &self.options.camera,
            angular_velocity: Vector3::zeros(),
            pixel: picture.features[feature].pixel,
            inverse_sigma: 1.0 / self.options.pixel_sigma,
        };
        let clock = Vector1::zeros();
        let residual = pixel.residual((&pose.at_rest(), &landmark, &extrinsics, &clock))?;
        let (_, (by_state, by_landmark, by_camera, _)) =
            pixel.linearize((&linearized_at.at_rest(), &linearized, &extrinsics, &clock))?;
        let start = |variable: usize| values.coordinates_of(variable).map(|own| own.start);
        let width = self.stacked.width();
        let mut jacobian = DMatrix::zeros(2, width - 1);
        let pose = start(newest.variable)?;
        jacobian.view_mut((0, pose), (2, 3)).copy_from(&by_state.fixed_columns::<3>(0));
        jacobian.view_mut((0, pose + 3), (2, 3)).copy_from(&by_state.fixed_columns::<3>(6));
        jacobian.view_mut((0, start(variable)?), (2, 3)).copy_from(&by_landmark);
        if let Some(key) = self.extrinsics {
            jacobian.view_mut((0, start(key.index())?), (2, 6)).copy_from(&by_camera);
        }
        let mut innovation = &jacobian * self.belief.covariance() * jacobian.transpose();
        (0..2).for_each(|axis| innovation[(axis, axis)] += 1.0);
        let whitened = innovation.cholesky()?.solve(&residual);
        let passes = residual.dot(&whitened) <= self.gates.get(2).copied()?;
        passes.then(|| {
            [0, 1].map(|axis| jacobian.row(axis).iter().copied().chain([residual[axis]]).collect())
        })
    }

    /// Drops the landmarks that this picture does not show.
    fn drop_lost_landmarks(&mut self, picture: &Picture) -> Result<(), MsckfError> {
        let is_seen =
            |kept: &Kept| picture.features.binary_search_by_key(&kept.track, |f| f.track).is_ok();
        let lost = |kept: &Kept| (!is_seen(kept)).then_some(kept.variable);
        let lost: Vec<usize> = self.window.kept.iter().filter_map(lost).collect();
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

    // ANCHOR: is_at_rest
    /// Whether half of the tracks that go on have moved by less than a body's that moves.
    fn is_at_rest(&self, picture: &Picture, rest: &Rest) -> bool {
        let mut moved: Vec<f64> = Vec::new();
        for feature in &picture.features {
            if let Ok(at) = self.last.binary_search_by_key(&feature.track, |f| f.track) {
                moved.push((feature.pixel - self.last[at].pixel).norm());
            }
        }
        let half = moved.len() / 2;
        half > 0 && *moved.select_nth_unstable_by(half, f64::total_cmp).1 < rest.motion
    }
    // ANCHOR_END: is_at_rest

    // ANCHOR: stand_still
    /// Tells the filter that the body neither moves nor turns. The window keeps the poses from
    /// which it last moved, and so the parallax of its tracks.
    fn stand_still(
        &mut self,
        rest: &Rest,
        turning: &Vector3<f64>,
    ) -> Result<PictureReport, MsckfError> {
        let mut jacobian = DMatrix::zeros(6, self.belief.dimension());
        jacobian.view_mut((0, 3), (3, 3)).fill_diagonal(1.0 / rest.velocity_sigma);
        jacobian.view_mut((3, 9), (3, 3)).fill_diagonal(-1.0 / rest.turning_sigma);
        let velocity = self.state().velocity / rest.velocity_sigma;
        let turning = turning / rest.turning_sigma;
        let residual = DVector::from_iterator(6, velocity.iter().chain(&turning).copied());
        self.belief.correct(&jacobian, &residual, self.options.form)?;
        Ok(PictureReport { at_rest: true, rows: 6, ..PictureReport::default() })
    }
    // ANCHOR_END: stand_still
}

/// Why a track does not correct the filter.
enum Refusal {
    Short,
    Landmark,
    Rank,
    Gated,
}

impl Refusal {
    fn count(&self, report: &mut PictureReport) {
        let refused = &mut report.refused;
        *match self {
            Self::Short => &mut refused.short,
            Self::Landmark => &mut refused.landmark,
            Self::Rank => &mut refused.rank,
            Self::Gated => &mut refused.gated,
        } += 1;
    }
}

impl From<TrackError> for Refusal {
    fn from(error: TrackError) -> Self {
        match error {
            TrackError::Behind { .. } => Self::Landmark,
            TrackError::Rank { .. } => Self::Rank,
        }
    }
}

/// Why a filter cannot go on.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MsckfError {
    /// A reading is not later than the one before.
    #[error("the reading at {nanoseconds} ns is not later than that at {last} ns; sort them")]
    Late {
        /// Its time.
        nanoseconds: i64,
        /// That of the last reading.
        last: i64,
    },
    /// The readings do not reach from the estimate to the picture.
    #[error(transparent)]
    Readings(#[from] WindowError),
    /// The readings cannot be summed up.
    #[error(transparent)]
    Preintegration(#[from] PreintegrationError),
    /// The estimate cannot be carried on.
    #[error(transparent)]
    Transition(#[from] TransitionError),
    /// A covariance is none.
    #[error(transparent)]
    Belief(#[from] BeliefError),
    /// The covariance cannot be corrected.
    #[error(transparent)]
    Correction(#[from] CorrectionError),
    /// The gate is no probability.
    #[error(transparent)]
    Gate(#[from] ChiSquareError),
}
