//! A flight, and the filter that follows it.

use nalgebra::Matrix2;
use vislam::filtering::{BlockNees, StateError, attitude_in_world};
use vislam::inertial::{BodyPose, NavState};
use vislam::msckf::{Msckf, PictureReport, Start};
use vislam::simulation::{FlightRecording, Recorder};

use super::setting::{SIGMAS, Setting};

/// A filter whose NEES of the position is beyond this is lost: it takes its derivatives where the body is not, and small
/// differences grow.
const LOST: f64 = 10.0;

/// A flight until some picture.
pub struct Run {
    /// What was asked for.
    pub setting: Setting,
    /// The filter after each picture.
    pub frames: Vec<Frame>,
    recorder: Recorder,
    filter: Option<Msckf>,
    /// Whether the filter cannot go on.
    failed: bool,
}

/// The filter after a picture.
pub struct Frame {
    /// What it believes of the body.
    pub estimate: NavState,
    /// Its poses in the window, seen from above, in metres.
    pub poses: Vec<[f64; 2]>,
    /// What would have to be added to get the truth.
    pub error: StateError,
    /// The covariance of the position seen from above, in m².
    pub covariance: Matrix2<f64>,
    /// The root of the trace of the covariance of the position, in metres.
    pub sigma: f64,
    /// The standard deviation of the yaw, in radians.
    pub yaw_sigma: f64,
    /// Whether error and covariance fit each other, if that is a covariance.
    pub nees: Option<BlockNees>,
    /// What became of the tracks.
    pub report: PictureReport,
}

impl Run {
    /// The flight before it begins, if there is one.
    pub fn new(setting: Setting) -> Option<Self> {
        let recorder = setting.recorder().ok()?;
        Some(Self { setting, frames: Vec::new(), recorder, filter: None, failed: false })
    }

    /// What the sensors have brought home until now.
    pub fn recording(&self) -> &FlightRecording {
        self.recorder.recording()
    }

    /// Goes on by a picture if this one is still to come; whether it is still to come then.
    pub fn advance(&mut self, to: usize) -> bool {
        if self.is_left(to) {
            let frame = self.picture();
            self.failed = frame.is_none();
            self.frames.extend(frame);
        }
        self.is_left(to)
    }

    fn is_left(&self, to: usize) -> bool {
        self.frames.len() <= to && !self.failed
    }

    /// The filter after this picture, or as far as it has come; nothing if it could not go on until there.
    pub fn last(&self, to: usize) -> Option<&Frame> {
        self.frames.get(to).or(self.frames.last().filter(|_| !self.failed))
    }

    /// Takes a picture.
    fn picture(&mut self) -> Option<Frame> {
        if !self.recorder.picture().ok()? {
            return None;
        }
        let recording = self.recorder.recording();
        if self.filter.is_none() {
            let start = Start::drawn(recording, &SIGMAS, self.setting.seed)?;
            let options = self.setting.options(&recording.flight);
            self.filter = Some(Msckf::new(options, &start).ok()?);
        }
        let filter = self.filter.as_mut()?;
        let number = self.frames.len();
        let report = filter.follow(recording, number).ok()??;
        Some(Frame::of(filter, recording.truth.states.get(number)?, report))
    }
}

impl Frame {
    fn of(filter: &Msckf, truth: &NavState, report: PictureReport) -> Self {
        let (estimate, covariance) = (*filter.state(), filter.covariance());
        let attitude = attitude_in_world(&estimate, &covariance.fixed_view::<3, 3>(0, 0));
        let poses = filter.belief().values().of_kind::<BodyPose>().iter();
        Self {
            estimate,
            poses: poses.map(|pose| above(&pose.at_rest())).collect(),
            error: StateError::between(&estimate, truth),
            covariance: covariance.fixed_view::<2, 2>(6, 6).into_owned(),
            sigma: covariance.fixed_view::<3, 3>(6, 6).trace().sqrt(),
            yaw_sigma: attitude[(2, 2)].sqrt(),
            nees: BlockNees::of(
                &estimate,
                truth,
                &covariance.fixed_view::<9, 9>(0, 0).into_owned(),
            )
            .ok(),
            report,
        }
    }

    /// Whether the filter is lost.
    pub fn is_lost(&self) -> bool {
        self.nees.is_none_or(|nees| nees.position > LOST)
    }
}

/// A body seen from above, in metres.
pub fn above(state: &NavState) -> [f64; 2] {
    [state.position.x, state.position.y]
}
