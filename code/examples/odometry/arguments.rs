//! What is asked for.

use vislam::odometry::Estimator;

pub const USAGE: &str = "usage: odometry (COMBINED.csv | IMU.csv TRACKS.csv) [--calibration FILE] \
    [--from S] [--to S] [--every N] [--estimator batch|smoother|msckf] [--truth FILE] [--start EXPORT.json] \
    [--tum FILE] [--covariance FILE] [--ply FILE]; --help says more";

/// The beginning of it is the calibration that is taken without another one.
pub const HELP: &str = concat!(
    "odometry (COMBINED.csv | IMU.csv TRACKS.csv) [OPTION VALUE ...]

Estimates how a body moved from the readings of its inertial sensor and the tracks of its camera.
COMBINED.csv has a flight in one file, as GTSAM's examples have it. IMU.csv has readings as EuRoC
has them, TRACKS.csv the columns timestamp [ns], track, u [px], v [px], with distortion taken out.

  --calibration FILE   camera, its place on the body, noise; see below
  --from S             pictures from this second after the first reading on
  --to S               pictures until this second
  --every N            every so manieth picture, 1 for each
  --estimator batch    all states, biases and landmarks at once
  --estimator smoother the states of the last two seconds, and what is known from before
  --estimator msckf    a filter that keeps the poses of the last pictures
  --truth FILE         ground truth as EuRoC has it, to be compared with
  --start EXPORT.json  what GTSAM was given: solve that from its start, and compare
  --tum FILE           write the trajectory: timestamp tx ty tz qx qy qz qw
  --covariance FILE    write the covariance of each pose: time and upper triangle
  --ply FILE           write the trajectory, and the landmarks of a batch, for a viewer

A calibration with a [stereo] baseline, in metres, has a second camera beside it, whose pixels are u_right and v_right of
TRACKS.csv. The smoother takes them, the others do not.

Without --calibration camera and noise are EuRoC's; a COMBINED.csv has a camera of its own, so that
only the noise is. A calibration has these names:

",
    include_str!("euroc.toml")
);

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Arguments {
    /// One file with all, or readings and tracks.
    pub files: Vec<String>,
    pub calibration: Option<String>,
    /// Seconds after the first reading.
    pub from: f64,
    pub to: f64,
    pub every: usize,
    pub estimator: Estimator,
    pub truth: Option<String>,
    pub start: Option<String>,
    pub tum: Option<String>,
    pub covariance: Option<String>,
    pub ply: Option<String>,
}

impl Arguments {
    pub fn read(words: impl IntoIterator<Item = String>) -> Result<Self, String> {
        let mut arguments = Self::default();
        let mut is_chosen = false;
        let mut words = words.into_iter();
        while let Some(word) = words.next() {
            if !word.starts_with("--") {
                arguments.files.push(word);
                continue;
            }
            let value = words.next().ok_or_else(|| format!("{word} has no value; {USAGE}"))?;
            is_chosen |= ["--from", "--to", "--every", "--estimator"].contains(&word.as_str());
            arguments.set(&word, value)?;
        }
        if !(1..=2).contains(&arguments.files.len()) {
            return Err(USAGE.into());
        }
        let Self { from, to, .. } = arguments;
        if !(from >= 0.0 && to > from) {
            return Err(format!(
                "there is nothing from {from} s to {to} s; give a span of seconds"
            ));
        }
        if is_chosen && arguments.start.is_some() {
            return Err("--start brings its own states, which are solved for at once; leave out \
                        --from, --to, --every and --estimator"
                .into());
        }
        Ok(arguments)
    }

    fn set(&mut self, option: &str, value: String) -> Result<(), String> {
        let not = |what: &str| format!("{option}: `{value}` is not {what}; {USAGE}");
        let seconds = || value.parse().map_err(|_| not("a number of seconds"));
        match option {
            "--from" => self.from = seconds()?,
            "--to" => self.to = seconds()?,
            "--every" => {
                let every = value.parse().ok().filter(|every| *every > 0);
                self.every = every.ok_or_else(|| not("a whole number above zero"))?;
            }
            "--estimator" => {
                self.estimator = value.parse().map_err(|error| format!("--estimator: {error}"))?;
            }
            "--calibration" => self.calibration = Some(value),
            "--truth" => self.truth = Some(value),
            "--start" => self.start = Some(value),
            "--tum" => self.tum = Some(value),
            "--covariance" => self.covariance = Some(value),
            "--ply" => self.ply = Some(value),
            _ => return Err(format!("{option} is not an option; {USAGE}")),
        }
        Ok(())
    }
}

impl Default for Arguments {
    /// All pictures of no file.
    fn default() -> Self {
        Self {
            files: Vec::new(),
            calibration: None,
            from: 0.0,
            to: f64::INFINITY,
            every: 1,
            estimator: Estimator::Batch,
            truth: None,
            start: None,
            tum: None,
            covariance: None,
            ply: None,
        }
    }
}
