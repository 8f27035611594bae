//! A flight, and the odometry that is given what its sensors bring home.

use nalgebra::{Matrix2, Matrix3, Vector3};
use vislam::filtering::{StateError, nees};
use vislam::inertial::NavState;
use vislam::observability::Similarity;
use vislam::odometry::{Estimate, Lost, Odometry, OdometryError, Progress};
use vislam::simulation::{FlightRecording, Recorder};

use super::setting::{Fault, PICTURES, Setting};
use super::tracker::Tracker;

/// Pictures that are flown at a time.
const BIT: usize = 2;
/// When the NEES of the position is beyond this, derivatives are taken where the body is not, and small differences grow.
const ASTRAY: f64 = 10.0;

/// A flight until some picture.
pub struct Run {
    /// What was asked for.
    pub setting: Setting,
    /// What each picture led to.
    pub frames: Vec<Frame>,
    recorder: Recorder,
    tracker: Tracker,
    odometry: Odometry,
    /// Readings that the odometry has taken.
    taken: usize,
    /// Why it was lost between the last two pictures.
    lost: Option<Why>,
    /// What takes the world of the last beginning to the true one.
    true_from_world: Similarity,
    worlds: usize,
    /// Whether there is nothing more to come.
    is_over: bool,
}

/// What a picture led to.
pub struct Frame {
    /// What is said of it.
    pub phase: Phase,
    /// Why the odometry was lost at this picture or since the one before, if it was.
    pub lost: Option<Why>,
    /// What was used of what the picture shows, and what was refused.
    pub seen: [usize; 2],
    /// How many beginnings there were.
    pub worlds: usize,
    /// What is known of the body, if something is.
    pub known: Option<Known>,
    /// The states or poses of the window, seen from above, in metres.
    pub window: Vec<[f64; 2]>,
    /// The landmarks of the window, likewise.
    pub points: Vec<[f64; 2]>,
    /// By how much the clock of the camera is believed to be late, in seconds.
    pub delay: Option<f64>,
}

/// What an odometry is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The picture was not there.
    Missing,
    /// There is no beginning yet.
    Waiting,
    /// The body stands.
    Standing,
    /// The estimator follows.
    Following,
    /// The estimate was given up.
    Lost,
    /// The readings do not come as far as the picture.
    Early,
}

/// Why an odometry is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Why {
    /// Pictures contradict the estimate.
    Contradicted,
    /// Readings are missing.
    Gap,
    /// The estimate is no number.
    Undetermined,
    /// The estimator cannot go on.
    Estimator,
}

/// What is known of the body, in the world of the truth.
pub struct Known {
    /// The state.
    pub estimate: NavState,
    /// What would have to be added to its position to get the true one, in metres.
    pub error: Vector3<f64>,
    /// The covariance of the position seen from above, in m².
    pub covariance: Matrix2<f64>,
    /// The root of the trace of the covariance of the position, in metres.
    pub sigma: f64,
    /// Whether error and covariance fit each other, if that is a covariance.
    pub nees: Option<f64>,
}

impl Run {
    /// The flight before it begins, if there is one.
    pub fn new(setting: Setting) -> Option<Self> {
        let recorder = setting.recorder().ok()?;
        let odometry = Odometry::new(setting.options(&recorder.recording().flight));
        Some(Self {
            setting,
            frames: Vec::new(),
            recorder,
            tracker: Tracker::default(),
            odometry,
            taken: 0,
            lost: None,
            true_from_world: Similarity::identity(),
            worlds: 0,
            is_over: false,
        })
    }

    /// Asks for something else from now on; whether nothing that has been flown would be different.
    pub fn becomes(&mut self, setting: Setting) -> bool {
        let read = self.recording().readings.last().map_or(0, |reading| reading.nanoseconds);
        let agrees = self.setting.agrees(&setting, 1e-9 * read as f64);
        if agrees {
            self.setting = setting;
        }
        agrees
    }

    /// What the sensors have brought home until now.
    pub fn recording(&self) -> &FlightRecording {
        self.recorder.recording()
    }

    /// Goes on by a few pictures if this one is still to come; whether it is still to come then.
    pub fn advance(&mut self, to: usize) -> bool {
        for _ in 0..BIT {
            if self.is_left(to) {
                self.is_over = !self.recorder.picture().unwrap_or(false);
                self.hand_over(to);
            }
        }
        self.is_left(to)
    }

    fn is_left(&self, to: usize) -> bool {
        self.frames.len() <= to && !self.is_over
    }

    /// Gives the odometry the readings that there are, and then the pictures for which these are enough, whatever the clock
    /// of the camera is believed to show: those before the last one.
    fn hand_over(&mut self, to: usize) {
        let recording = self.recorder.recording();
        for reading in &recording.readings[self.taken..] {
            if self.setting.suffers(Fault::Readings, 1e-9 * reading.nanoseconds as f64) {
                continue;
            }
            if let Ok(Some(lost)) = self.odometry.reading(*reading) {
                self.lost = Some(Why::from(&lost));
            }
        }
        self.taken = recording.readings.len();
        let read = recording.readings.last().map_or(0, |reading| reading.nanoseconds);
        let due = |number: usize| {
            let pictures = &self.recorder.recording().pictures;
            pictures.get(number + 1).is_some_and(|next| next.nanoseconds <= read)
        };
        let mut number = self.frames.len();
        let mut waiting = Vec::new();
        while number <= to && due(number) {
            waiting.push(number);
            number += 1;
        }
        for number in waiting {
            let frame = self.picture(number);
            self.frames.push(frame);
        }
    }

    /// Gives the odometry a picture.
    fn picture(&mut self, number: usize) -> Frame {
        let seconds = number as f64 / PICTURES;
        let picture = &self.recorder.recording().pictures[number];
        let picture = self.tracker.shown(picture, (number, seconds), &self.setting);
        let progress = (!self.setting.suffers(Fault::Pictures, seconds))
            .then(|| self.odometry.picture(&picture));
        let (phase, seen) = match progress {
            Some(Ok(Progress::Following { used, refused })) => (Phase::Following, [used, refused]),
            Some(Ok(Progress::Standing)) => (Phase::Standing, [0, 0]),
            Some(Ok(Progress::Lost(lost))) => {
                self.lost = Some(Why::from(&lost));
                (Phase::Lost, [0, 0])
            }
            Some(Ok(Progress::Waiting)) => (Phase::Waiting, [0, 0]),
            Some(Err(OdometryError::EarlyPicture { .. })) => (Phase::Early, [0, 0]),
            Some(Err(_)) | None => (Phase::Missing, [0, 0]),
        };
        if self.odometry.worlds() > self.worlds {
            self.worlds = self.odometry.worlds();
            self.true_from_world = self.world().unwrap_or_else(Similarity::identity);
        }
        let is_given = !matches!(phase, Phase::Missing | Phase::Early);
        let newest = self.odometry.newest().filter(|_| is_given);
        if let Some(standing) = newest.filter(|_| phase == Phase::Standing) {
            let truth = self.truth(standing.nanoseconds);
            self.true_from_world = Similarity::between(&standing.state, &truth);
        }
        let above = |place: &Vector3<f64>| {
            let place = self.true_from_world.point(place);
            [place.x, place.y]
        };
        Frame {
            phase,
            lost: self.lost.take(),
            seen,
            worlds: self.worlds,
            known: newest.map(|newest| self.known(&newest)),
            window: self.odometry.window().iter().map(|state| above(&state.position)).collect(),
            points: self.odometry.points().iter().map(|(_, place)| above(place)).collect(),
            delay: self.odometry.rig().map(|rig| rig.time_offset),
        }
    }

    /// What takes the world of the last beginning to the true one: where and when that one was chosen tells it.
    fn world(&self) -> Option<Similarity> {
        let beginning = self.odometry.beginning()?;
        Some(beginning.to_world_of(&self.truth(beginning.origin.0)))
    }

    /// The body at a time of the sensor's clock.
    pub fn truth(&self, nanoseconds: i64) -> NavState {
        self.recording().flight.motion.at(1e-9 * nanoseconds as f64).state
    }

    fn known(&self, newest: &Estimate) -> Known {
        let Estimate { state: estimate, covariance, .. } = newest.in_world(&self.true_from_world);
        let covariance: Matrix3<f64> = covariance.fixed_view::<3, 3>(6, 6).into_owned();
        let error = StateError::between(&estimate, &self.truth(newest.nanoseconds)).position;
        Known {
            estimate,
            error,
            covariance: covariance.fixed_view::<2, 2>(0, 0).into_owned(),
            sigma: covariance.trace().sqrt(),
            nees: nees(&error, &covariance).ok(),
        }
    }
}

impl Frame {
    /// Whether small differences grow from here on.
    pub fn is_astray(&self) -> bool {
        let fits = |known: &Known| known.nees.is_some_and(|nees| nees <= ASTRAY);
        self.known.as_ref().is_some_and(|known| !fits(known))
    }
}

impl From<&Lost> for Why {
    fn from(lost: &Lost) -> Self {
        match lost {
            Lost::Contradicted { .. } => Self::Contradicted,
            Lost::Gap { .. } => Self::Gap,
            Lost::Undetermined => Self::Undetermined,
            Lost::Estimator(_) => Self::Estimator,
        }
    }
}
