//! The smoother: readings and pictures come in, the window is solved, the oldest leaves.

use std::fmt;

use nalgebra::{DMatrix, DVector, Vector3};

use super::window::{Frame, Waiting, Window};
use super::{SmootherError, SmootherOptions};
use crate::datasets::tracks::Picture;
use crate::factors::{BodyPixel, CombinedInertialFactor, PixelByBody};
use crate::inertial::{BodyPose, ImuBias, NavState, StampedSample, between};
use crate::initialization::{Sensors, calibrate};
use crate::least_squares::{
    Fronts, Kernel, Key, LinearPrior, Problem, ProblemError, Search, sqrt_information,
};
use crate::msckf::Start;
use crate::preintegration::{Matrix15, preintegrate_combined};
use crate::two_views::{View, triangulate, triangulate_nonlinear};

/// A fixed-lag smoother.
pub struct Smoother {
    pub(super) options: SmootherOptions,
    pub(super) problem: Problem,
    pub(super) window: Window,
    readings: Vec<StampedSample>,
    covariance: Matrix15,
    /// The search of the last picture, whose memory the next one takes.
    search: Option<Search<Fronts>>,
}

impl fmt::Debug for Smoother {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Smoother")
            .field("options", &self.options)
            .field("window", &self.window)
            .field("readings", &self.readings.len())
            .finish_non_exhaustive()
    }
}

/// What a picture led to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Smoothed {
    /// Steps that were tried.
    pub iterations: usize,
    /// Landmarks in the window.
    pub landmarks: usize,
    /// Pixels of landmarks in this picture.
    pub pixels: usize,
    /// Pixels that are too far off.
    pub gated: usize,
    /// How many columns the widest front has.
    pub widest: usize,
}

impl Smoother {
    /// A smoother that begins with this.
    ///
    /// # Errors
    ///
    /// A [`SmootherError`] when the covariance is none.
    pub fn new(options: SmootherOptions, start: &Start) -> Result<Self, SmootherError> {
        let mut problem = Problem::new();
        let Sensors { rig, .. } = options.sensors;
        let mut window = Window::new(&mut problem, rig.body_from_camera, options.sensors.gravity());
        problem.hold(window.gravity)?;
        calibrate(&mut problem, (window.extrinsics, window.delay), &options.sensors)?;
        let begin = (start.nanoseconds, Vector3::zeros());
        let Frame { state, bias, .. } =
            window.add_frame(&mut problem, begin, (start.state, start.bias))?;
        let root = sqrt_information(&start.covariance)?;
        let root = DMatrix::from_fn(15, 15, |row, column| root[(row, column)]);
        let variables = [state.index(), bias.index()];
        let known = LinearPrior::of_root(problem.values(), &variables, root, DVector::zeros(15))?;
        problem.add_prior(known)?;
        let covariance = start.covariance;
        Ok(Self { options, problem, window, readings: Vec::new(), covariance, search: None })
    }

    /// Takes a reading.
    ///
    /// # Errors
    ///
    /// [`SmootherError::LateReading`] when it is not later than the last one.
    pub fn reading(&mut self, reading: StampedSample) -> Result<(), SmootherError> {
        let nanoseconds = reading.nanoseconds;
        match self.readings.last().map(|last| last.nanoseconds) {
            Some(last) if last >= nanoseconds => {
                Err(SmootherError::LateReading { nanoseconds, last })
            }
            _ => {
                self.readings.push(reading);
                Ok(())
            }
        }
    }

    // ANCHOR: picture
    /// Takes the tracks of a picture, when the readings reach its time.
    ///
    /// # Errors
    ///
    /// A [`SmootherError`].
    pub fn picture(&mut self, picture: &Picture) -> Result<Smoothed, SmootherError> {
        let mut smoothed = Smoothed::default();
        let frame = self.carry_to(self.options.sensors.rig.imu_nanoseconds(picture.nanoseconds))?;
        self.see(&frame, picture, &mut smoothed)?;
        self.place_landmarks(&frame)?;
        self.solve(&mut smoothed)?;
        smoothed.landmarks = self.window.landmarks.len();
        let lag = (1e9 * self.options.lag).round() as i64;
        while self.window.frames.len() > 2
            && frame.nanoseconds - self.window.frames[1].nanoseconds >= lag
        {
            self.forget_first()?;
        }
        Ok(smoothed)
    }
    // ANCHOR_END: picture

    // ANCHOR: carry_to
    /// Adds the state at a time, where the readings lead.
    fn carry_to(&mut self, nanoseconds: i64) -> Result<Frame, SmootherError> {
        let last = self.newest();
        if nanoseconds <= last.nanoseconds {
            return Err(SmootherError::LatePicture { nanoseconds, last: last.nanoseconds });
        }
        let values = self.problem.values();
        let (state, bias) = (values[last.state], values[last.bias]);
        let readings = between(&self.readings, last.nanoseconds, nanoseconds)?;
        let sensors = &self.options.sensors;
        let sums = preintegrate_combined(&readings, &bias, &sensors.noise)?;
        let next = sums.sums.predict(&state, &sensors.gravity(), &bias);
        let turning = readings.last().map_or(Vector3::zeros(), |r| r.sample.corrected(&bias).gyro);
        let problem = &mut self.problem;
        let frame = self.window.add_frame(problem, (nanoseconds, turning), (next, bias))?;
        let factor = CombinedInertialFactor::new(
            [last.state, frame.state],
            [last.bias, frame.bias],
            self.window.gravity,
            &sums,
        )?;
        problem.add_factor(factor, Kernel::Squared)?;
        let before = self.readings.partition_point(|reading| reading.nanoseconds <= nanoseconds);
        self.readings.drain(..before.saturating_sub(1));
        Ok(frame)
    }
    // ANCHOR_END: carry_to

    fn newest(&self) -> Frame {
        self.window.frames[self.window.frames.len() - 1]
    }

    // ANCHOR: see
    /// Adds the pixels of known landmarks; others wait.
    fn see(
        &mut self,
        frame: &Frame,
        picture: &Picture,
        smoothed: &mut Smoothed,
    ) -> Result<(), SmootherError> {
        for feature in &picture.features {
            let Some(seen) = self.window.landmarks.get(&feature.track).copied() else {
                let waiting = self.window.waiting.entry(feature.track).or_default();
                waiting.push((frame.serial, feature.pixel));
                continue;
            };
            let values = self.problem.values();
            let off = self.off(&values[frame.state], &values[seen.landmark], feature.pixel);
            if off > self.options.gate {
                smoothed.gated += 1;
                continue;
            }
            smoothed.pixels += 1;
            self.add_pixel(frame, seen.landmark, feature.pixel)?;
            if let Some(seen) = self.window.landmarks.get_mut(&feature.track) {
                seen.last = frame.serial;
            }
        }
        Ok(())
    }
    // ANCHOR_END: see

    /// By how many standard deviations a pixel is off; infinite behind the camera.
    fn off(&self, state: &NavState, landmark: &Vector3<f64>, pixel: nalgebra::Vector2<f64>) -> f64 {
        let Sensors { ref camera, pixel_sigma, .. } = self.options.sensors;
        let seen = BodyPixel { camera, pixel, inverse_sigma: 1.0 / pixel_sigma };
        let extrinsics = &self.problem.values()[self.window.extrinsics];
        let residual = seen.residual((&BodyPose::from(state), landmark, extrinsics));
        residual.map_or(f64::INFINITY, |residual| residual.norm())
    }

    fn add_pixel(
        &mut self,
        frame: &Frame,
        landmark: Key<Vector3<f64>>,
        pixel: nalgebra::Vector2<f64>,
    ) -> Result<(), ProblemError> {
        let Sensors { camera, pixel_sigma, .. } = self.options.sensors;
        let factor = PixelByBody {
            state: frame.state,
            landmark,
            extrinsics: self.window.extrinsics,
            time_offset: self.window.delay,
            camera,
            angular_velocity: frame.turning,
            pixel,
            inverse_sigma: 1.0 / pixel_sigma,
        };
        self.problem.add_factor(factor, self.options.kernel)?;
        Ok(())
    }

    // ANCHOR: place_landmarks
    /// Makes landmarks of the tracks of this picture that have waited long enough.
    fn place_landmarks(&mut self, frame: &Frame) -> Result<(), SmootherError> {
        let ready = |(track, waiting): (&usize, &Waiting)| {
            let is_seen = waiting.last().is_some_and(|(serial, _)| *serial == frame.serial);
            (is_seen && waiting.len() >= self.options.least_sightings).then_some(*track)
        };
        let ready: Vec<usize> = self.window.waiting.iter().filter_map(ready).collect();
        for track in ready {
            let Some(place) = self.place(&self.window.waiting[&track]) else { continue };
            let Some(waiting) = self.window.waiting.remove(&track) else { continue };
            let problem = &mut self.problem;
            let landmark = self.window.add_landmark(problem, (track, frame.serial), place)?;
            for (serial, pixel) in waiting {
                if let Some(frame) = self.window.frame(serial).copied() {
                    self.add_pixel(&frame, landmark, pixel)?;
                }
            }
        }
        Ok(())
    }
    // ANCHOR_END: place_landmarks

    /// Where a landmark is most likely, if its rays meet and no pixel is far off.
    fn place(&self, waiting: &Waiting) -> Option<Vector3<f64>> {
        let Sensors { camera, pixel_sigma, rig, .. } = self.options.sensors;
        let values = self.problem.values();
        let view = |(serial, pixel): &(usize, nalgebra::Vector2<f64>)| {
            let state = &values[self.window.frame(*serial)?.state];
            let camera_from_world = rig.camera_from_world(state);
            Some(View { camera, camera_from_world, pixel: *pixel, sigma: pixel_sigma })
        };
        let views: Vec<View> = waiting.iter().filter_map(view).collect();
        let start = triangulate(&views, self.options.least_parallax).ok()?;
        let place = triangulate_nonlinear(&views, &start).map_or(start, |found| found.point);
        let fits = |(serial, pixel): &(usize, nalgebra::Vector2<f64>)| {
            let frame = self.window.frame(*serial);
            frame.is_some_and(|f| self.off(&values[f.state], &place, *pixel) <= self.options.gate)
        };
        waiting.iter().all(fits).then_some(place)
    }

    // ANCHOR: solve
    /// Goes towards the minimum of the window, and notes how sure the newest state is.
    fn solve(&mut self, smoothed: &mut Smoothed) -> Result<(), SmootherError> {
        let order = self.order()?;
        let problem = &self.problem;
        let search = match self.search.take() {
            Some(mut search) => {
                search.begin_again(problem, |fronts| fronts.arrange(problem, &order))?;
                search
            }
            None => {
                let fronts = Fronts::in_order(problem, &order)?;
                Search::new(problem, fronts, &self.options.search())?.without_end()
            }
        };
        let search = self.search.insert(search);
        while search.iterate(problem)?.is_none() {}
        smoothed.widest = search.system().widest();
        smoothed.iterations = search.iterations().len();
        let newest = self.window.frames[self.window.frames.len() - 1];
        let newest = [newest.state.index(), newest.bias.index()];
        let covariance = search.system().covariance_of(problem, &newest);
        let covariance = covariance.filter(|matrix| matrix.shape() == (15, 15));
        self.covariance = covariance
            .map_or(Matrix15::repeat(f64::NAN), |m| Matrix15::from_column_slice(m.as_slice()));
        let values = search.values().clone();
        self.problem.set_values(values)?;
        Ok(())
    }
    // ANCHOR_END: solve

    /// The 15×15 covariance of the errors of the newest state and its biases, as of the last
    /// linearization.
    pub fn covariance(&self) -> &Matrix15 {
        &self.covariance
    }

    /// The newest state that is at least so many seconds older than the newest one, or the oldest
    /// in the window.
    pub fn ago(&self, seconds: f64) -> (i64, NavState, ImuBias) {
        let until = self.newest().nanoseconds - (1e9 * seconds) as i64;
        let older = self.window.frames.iter().rev().find(|frame| frame.nanoseconds <= until);
        self.at(older.unwrap_or(&self.window.frames[0]))
    }

    /// The newest state and its biases, with their time on the sensor's clock.
    pub fn state(&self) -> (i64, NavState, ImuBias) {
        self.at(&self.newest())
    }

    /// The time of the last reading, in nanoseconds.
    pub fn last_reading(&self) -> Option<i64> {
        self.readings.last().map(|reading| reading.nanoseconds)
    }

    /// The tracks that are landmarks of the window.
    pub fn landmarks(&self) -> impl Iterator<Item = usize> {
        self.window.landmarks.keys().copied()
    }

    /// How many variables the window has had room for so far.
    pub fn variables(&self) -> usize {
        self.problem.values().len()
    }

    /// The oldest state in the window.
    pub fn oldest(&self) -> (i64, NavState, ImuBias) {
        self.at(&self.window.frames[0])
    }

    fn at(&self, frame: &Frame) -> (i64, NavState, ImuBias) {
        let values = self.problem.values();
        (frame.nanoseconds, values[frame.state], values[frame.bias])
    }
}
