//! Readings and pictures go in, and where the body is comes out.

use nalgebra::Vector3;
use thiserror::Error;

use super::engine::{Engine, Seen};
use super::waiting::Waiting;
use super::{OdometryError, OdometryOptions};
use crate::datasets::tracks::{Feature, Picture};
use crate::inertial::{CameraImu, ImuBias, LONGEST_STEP, NavState, StampedSample};
use crate::initialization::Beginning;
use crate::msckf::Start;
use crate::observability::Similarity;
use crate::preintegration::Matrix15;

// ANCHOR: odometry
/// The assembled system: it is given readings and the tracks of pictures in the order of their times, and
/// has an estimate after each picture from its beginning on.
#[derive(Debug)]
pub struct Odometry {
    options: OdometryOptions,
    phase: Phase,
    last_reading: Option<StampedSample>,
    /// The reading before a gap, while one alone has come after it.
    before_gap: Option<StampedSample>,
    last_picture: Option<i64>,
    /// Since when most of what pictures show has contradicted what is believed, on the camera's clock.
    contradicted: Option<i64>,
    /// Of the flight that is followed, and how many there were.
    beginning: Option<Beginning>,
    worlds: usize,
}

#[derive(Debug)]
enum Phase {
    Waiting(Box<Waiting>),
    Following(Engine),
}
// ANCHOR_END: odometry

/// Where the body is at a time, and how sure that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The time, on the sensor's clock, in nanoseconds.
    pub nanoseconds: i64,
    /// The state then, in the world of this beginning.
    pub state: NavState,
    /// The biases then.
    pub bias: ImuBias,
    /// The 15×15 covariance of the errors of rotation (rad, in the body frame), velocity (m/s) and position
    /// (m), both in the world, and of the biases of gyroscope (rad/s) and accelerometer (m/s²), in this
    /// order. No numbers where rounding has lost what is known of a place, and the rest goes on: a window
    /// of a smoother with twenty pictures a second has to know its place to some tens of metres.
    pub covariance: Matrix15,
}

impl Estimate {
    /// The same in another world, of the same size.
    pub fn in_world(&self, by: &Similarity) -> Self {
        let none = Vector3::zeros();
        let mut turn = Matrix15::identity();
        for from in [3, 6] {
            turn.fixed_view_mut::<3, 3>(from, from).copy_from(by.rotation.matrix());
        }
        let covariance = turn * self.covariance * turn.transpose();
        Self { state: by.state(&self.state, &none, &none), covariance, ..*self }
    }

    /// Whether all of it are numbers and the variances positive, or all of the covariance is said to be unknown.
    fn is_usable(&self) -> bool {
        let NavState { velocity, position, .. } = &self.state;
        let vectors = velocity + position + self.bias.gyro + self.bias.accelerometer;
        let turn = self.state.world_from_body.matrix().sum();
        // A sum is no number if any of its terms is none.
        let is_sure = self.covariance.sum().is_finite()
            && self.covariance.diagonal().iter().all(|variance| *variance > 0.0);
        (turn + vectors.sum()).is_finite()
            && (is_sure || self.covariance.iter().all(|c| c.is_nan()))
    }
}

// ANCHOR: progress
/// What a picture led to.
#[derive(Debug, Clone, PartialEq)]
pub enum Progress {
    /// There is no beginning yet.
    Waiting,
    /// The body stands, and is known to.
    Standing,
    /// The estimator follows: how much it used of what the picture shows, or of what it had waited for,
    /// and how much contradicted it.
    Following {
        /// Pixels or tracks that were used.
        used: usize,
        /// Those that were refused.
        refused: usize,
    },
    /// The estimate is given up, and nothing is known of the body until it begins again, in a world of
    /// its own.
    Lost(Lost),
}
// ANCHOR_END: progress

/// Why an estimate was given up.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Lost {
    /// Most of what pictures showed did not fit for as long as one can have patience.
    #[error("for {seconds:.1} s most of what pictures showed has contradicted the estimate")]
    Contradicted {
        /// For how long.
        seconds: f64,
    },
    /// Readings are missing.
    #[error("there is no reading for {seconds:.2} s, from {nanoseconds} ns on")]
    Gap {
        /// The time of the last one, in nanoseconds.
        nanoseconds: i64,
        /// Until the next one.
        seconds: f64,
    },
    /// The estimate has a number that is not finite, or a variance that is not positive, where the covariance is
    /// not unknown as a whole.
    #[error("the estimate is not a number any more, or its covariance none")]
    Undetermined,
    /// The estimator could not go on.
    #[error("the estimator cannot go on: {0}")]
    Estimator(OdometryError),
}

impl Odometry {
    /// An odometry that knows nothing yet.
    pub fn new(options: OdometryOptions) -> Self {
        let phase = Phase::Waiting(Box::new(Waiting::new(&options)));
        Self {
            options,
            phase,
            last_reading: None,
            before_gap: None,
            last_picture: None,
            contradicted: None,
            beginning: None,
            worlds: 0,
        }
    }

    /// An odometry that is told where a flight begins, as a simulation can. Pictures after that time are
    /// followed.
    ///
    /// # Errors
    ///
    /// [`OdometryError::Smoother`] when the covariance of the start is not positive definite;
    /// [`OdometryError::Msckf`] when the start is not finite, the window is too short, a pixel's standard
    /// deviation is not positive, or the gate is no probability.
    pub fn begun(options: OdometryOptions, start: &Start) -> Result<Self, OdometryError> {
        let phase = Phase::Following(Engine::new(&options, start)?);
        Ok(Self { phase, worlds: 1, ..Self::new(options) })
    }

    // ANCHOR: reading
    /// Takes a reading. What is lost by a gap before it is said. When the first one behind a gap is not followed by a
    /// later one, its time was wrong, and it is forgotten.
    ///
    /// # Errors
    ///
    /// [`OdometryError::LateReading`], [`OdometryError::Reading`] and [`OdometryError::FirstReading`].
    pub fn reading(&mut self, reading: StampedSample) -> Result<Option<Lost>, OdometryError> {
        let nanoseconds = reading.nanoseconds;
        if !reading.sample.is_finite() {
            return Err(OdometryError::Reading { nanoseconds });
        }
        self.forget_wrong_time(nanoseconds);
        let gap = match &self.last_reading {
            Some(last) if last.nanoseconds >= nanoseconds => {
                let last = last.nanoseconds;
                return Err(OdometryError::LateReading { nanoseconds, last });
            }
            Some(last) => {
                let seconds = last.seconds_to(&reading);
                let is_gap = seconds > LONGEST_STEP;
                is_gap.then_some(Lost::Gap { nanoseconds: last.nanoseconds, seconds })
            }
            None => {
                self.reach(nanoseconds)?;
                None
            }
        };
        if gap.is_some() {
            self.begin_again(None);
        }
        match &mut self.phase {
            Phase::Waiting(waiting) => waiting.reading(reading, &self.options),
            Phase::Following(engine) => engine.reading(reading)?,
        }
        self.before_gap = self.last_reading.filter(|_| gap.is_some());
        self.last_reading = Some(reading);
        Ok(gap)
    }
    // ANCHOR_END: reading

    /// Goes back to before a gap when what comes now lies in it.
    fn forget_wrong_time(&mut self, nanoseconds: i64) {
        let is_late = self.last_reading.is_some_and(|last| last.nanoseconds > nanoseconds);
        let before = self.before_gap.filter(|before| is_late && before.nanoseconds < nanoseconds);
        if before.is_some() {
            self.last_reading = before;
            self.begin_again(before);
        }
    }

    /// Whether a first reading reaches back to a start that was told.
    fn reach(&self, nanoseconds: i64) -> Result<(), OdometryError> {
        match self.engine().map(|engine| engine.newest().nanoseconds) {
            Some(start) if start < nanoseconds => {
                Err(OdometryError::FirstReading { nanoseconds, start })
            }
            _ => Ok(()),
        }
    }

    // ANCHOR: picture
    /// Takes the tracks of a picture, when a reading has come that is as late.
    ///
    /// # Errors
    ///
    /// An [`OdometryError`] names what is wrong with the picture, which is left out then.
    pub fn picture(&mut self, picture: &Picture) -> Result<Progress, OdometryError> {
        self.check(picture)?;
        self.last_picture = Some(picture.nanoseconds);
        match &mut self.phase {
            Phase::Waiting(_) => Ok(self.wait(picture)),
            Phase::Following(engine) => match engine.picture(picture) {
                Ok(seen) => Ok(self.followed(picture, seen)),
                Err(error) => Ok(self.lose(Lost::Estimator(error))),
            },
        }
    }
    // ANCHOR_END: picture

    /// Takes a whole recording: the readings as far as each picture needs them, and the pictures. Tells
    /// of each picture what it led to, and of each gap.
    ///
    /// # Errors
    ///
    /// An [`OdometryError`] of the first reading or picture that is not taken.
    pub fn fly(
        &mut self,
        readings: &[StampedSample],
        pictures: &[Picture],
        mut told: impl FnMut(&Self, Progress),
    ) -> Result<(), OdometryError> {
        let mut readings = readings.iter();
        for picture in pictures {
            // The first reading behind a gap is not yet believed. Where one ends what was followed, the clock is
            // the nominal one again.
            let is_short = |flight: &Self| {
                let time = flight.imu_nanoseconds(picture);
                flight.last_reading.is_none_or(|last| last.nanoseconds < time)
            };
            while self.before_gap.is_some() || is_short(self) {
                let Some(reading) = readings.next() else { break };
                if let Some(lost) = self.reading(*reading)? {
                    told(self, Progress::Lost(lost));
                }
            }
            let progress = self.picture(picture)?;
            told(self, progress);
        }
        Ok(())
    }

    /// The time of a picture on the sensor's clock, in nanoseconds, as it is believed to be: so far readings
    /// have to come before it is taken. A filter that estimates the time offset moves it a little.
    pub fn imu_nanoseconds(&self, picture: &Picture) -> i64 {
        let nominal = &self.options.sensors.rig;
        let clock = self.engine().map_or(*nominal, |engine| engine.clock(nominal));
        clock.imu_nanoseconds(picture.nanoseconds)
    }

    /// Whether a picture can be taken.
    fn check(&self, picture: &Picture) -> Result<(), OdometryError> {
        let nanoseconds = picture.nanoseconds;
        if let Some(last) = self.last_picture.filter(|last| *last >= nanoseconds) {
            return Err(OdometryError::LatePicture { nanoseconds, last });
        }
        let time = self.imu_nanoseconds(picture);
        let newest = self.engine().map(|engine| engine.newest().nanoseconds);
        if let Some(newest) = newest.filter(|newest| *newest >= time) {
            let last = nanoseconds.saturating_add(newest.saturating_sub(time));
            return Err(OdometryError::LatePicture { nanoseconds, last });
        }
        let mut before = None;
        for &Feature { track, pixel, right } in &picture.features {
            let is_finite = (pixel + right.unwrap_or(pixel)).sum().is_finite();
            if !is_finite || before.replace(track) >= Some(track) {
                return Err(OdometryError::Feature { track, nanoseconds });
            }
        }
        let last = self.last_reading.as_ref().map(|last| last.nanoseconds);
        if last.is_none_or(|last| last < time) {
            return Err(OdometryError::EarlyPicture { nanoseconds: time });
        }
        Ok(())
    }

    /// Looks for a beginning. What has come since then is followed at once.
    fn wait(&mut self, picture: &Picture) -> Progress {
        let Phase::Waiting(waiting) = &mut self.phase else { return Progress::Waiting };
        let Some(beginning) = waiting.look(picture, &self.options) else {
            waiting.forget(&self.options);
            return if waiting.stand().is_some() { Progress::Standing } else { Progress::Waiting };
        };
        match self.follow(beginning) {
            Ok(seen) => self.followed(picture, seen),
            Err(error) => self.lose(Lost::Estimator(error)),
        }
    }

    // ANCHOR: wait
    /// Hands over what has come since a start.
    fn follow(&mut self, beginning: Beginning) -> Result<Seen, OdometryError> {
        let Phase::Waiting(waiting) = &self.phase else { return Ok(Seen::default()) };
        let (from, ref start) = beginning.start;
        let mut engine = Engine::new(&self.options, start)?;
        let before =
            waiting.readings.partition_point(|reading| reading.nanoseconds <= start.nanoseconds);
        for reading in &waiting.readings[before.saturating_sub(1)..] {
            engine.reading(*reading)?;
        }
        let mut seen = Seen::default();
        let last = waiting.readings.last().map(|reading| reading.nanoseconds);
        for picture in waiting.pictures.iter().skip(from + 1) {
            // A filter may move its clock meanwhile, to where readings do not reach yet.
            let clock = engine.clock(&self.options.sensors.rig);
            if Some(clock.imu_nanoseconds(picture.nanoseconds)) <= last {
                seen = engine.picture(picture)?;
            }
        }
        self.worlds += 1;
        (self.phase, self.beginning) = (Phase::Following(engine), Some(beginning));
        Ok(seen)
    }
    // ANCHOR_END: wait

    // ANCHOR: followed
    /// What is said of a picture that the estimator took: it is lost when for longer than patience lasts most
    /// of what pictures showed did not fit.
    fn followed(&mut self, picture: &Picture, Seen { used, refused }: Seen) -> Progress {
        if !self.newest().as_ref().is_some_and(Estimate::is_usable) {
            return self.lose(Lost::Undetermined);
        }
        if refused <= used {
            // A picture of which nothing was used or refused says neither.
            self.contradicted = self.contradicted.filter(|_| used == 0);
            return Progress::Following { used, refused };
        }
        let since = *self.contradicted.get_or_insert(picture.nanoseconds);
        let seconds = 1e-9 * picture.nanoseconds.saturating_sub(since) as f64;
        if seconds < self.options.patience {
            return Progress::Following { used, refused };
        }
        self.lose(Lost::Contradicted { seconds })
    }
    // ANCHOR_END: followed

    fn lose(&mut self, why: Lost) -> Progress {
        self.begin_again(self.last_reading);
        Progress::Lost(why)
    }

    /// Forgets everything but a reading.
    fn begin_again(&mut self, reading: Option<StampedSample>) {
        let mut waiting = Waiting::new(&self.options);
        waiting.readings.extend(reading);
        self.phase = Phase::Waiting(Box::new(waiting));
        (self.contradicted, self.beginning) = (None, None);
    }

    /// The newest estimate. While the body stands it is that of the last picture by which it was known
    /// to; `None` before there is a beginning.
    pub fn newest(&self) -> Option<Estimate> {
        match &self.phase {
            Phase::Waiting(waiting) => waiting.stand().map(|start| {
                let Start { nanoseconds, state, bias, covariance, .. } = *start;
                Estimate { nanoseconds, state, bias, covariance }
            }),
            Phase::Following(engine) => Some(engine.newest()),
        }
    }

    /// What follows the flight, if it has begun.
    fn engine(&self) -> Option<&Engine> {
        match &self.phase {
            Phase::Waiting(_) => None,
            Phase::Following(engine) => Some(engine),
        }
    }

    /// The state of some seconds ago, or the oldest one that is still estimated, as it is believed now,
    /// with its time; `None` before there is a beginning, and always from a filter, which has no such
    /// state.
    pub fn ago(&self, seconds: f64) -> Option<(i64, NavState)> {
        self.engine()?.ago(seconds)
    }

    /// The states of the window from the oldest to the newest; a filter has poses there, which are given
    /// at rest. None before there is a beginning.
    pub fn window(&self) -> Vec<NavState> {
        self.engine().map(Engine::window).unwrap_or_default()
    }

    /// The tracks that are landmarks of the window, and where in the world those are, in metres. None
    /// before there is a beginning, and none of a filter, which has forgotten them when it was corrected.
    pub fn points(&self) -> Vec<(usize, Vector3<f64>)> {
        self.engine().map(Engine::points).unwrap_or_default()
    }

    /// Where the camera is on the body and what to add to a time of its clock, as it is known or estimated;
    /// `None` before there is a beginning.
    pub fn rig(&self) -> Option<CameraImu> {
        self.engine().map(Engine::rig)
    }

    /// How many pictures are kept because there is no beginning yet.
    pub fn waiting(&self) -> usize {
        match &self.phase {
            Phase::Waiting(waiting) => waiting.pictures.len(),
            Phase::Following(_) => 0,
        }
    }

    /// How the flight that is followed began; `None` before it did, and when it was told by
    /// [`Odometry::begun`]. Its seconds count from the first picture at which a beginning was looked for, and its numbers
    /// of pictures from the oldest one that was still kept.
    pub fn beginning(&self) -> Option<&Beginning> {
        self.beginning.as_ref()
    }

    /// How many beginnings there were. Each has a world of its own, whose origin and heading belong to
    /// one of its states: nothing ties it to the one before.
    pub fn worlds(&self) -> usize {
        self.worlds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_is_usable_when_all_of_it_are_numbers_and_variances_positive() {
        let covariance = Matrix15::identity();
        let (state, bias) = (NavState::origin(), ImuBias::default());
        let known = Estimate { nanoseconds: 0, state, bias, covariance };
        assert!(known.is_usable());
        assert!(Estimate { covariance: Matrix15::repeat(f64::NAN), ..known }.is_usable());
        let nowhere = NavState { position: Vector3::new(0.0, f64::NAN, 0.0), ..state };
        assert!(!Estimate { state: nowhere, ..known }.is_usable());
        for (place, number) in [((3, 3), 0.0), ((3, 3), -1.0), ((2, 7), f64::INFINITY)] {
            let mut covariance = covariance;
            covariance[place] = number;
            assert!(!Estimate { covariance, ..known }.is_usable(), "{place:?} {number}");
        }
    }
}
