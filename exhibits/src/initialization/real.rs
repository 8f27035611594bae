//! Starts and the batch on a real flight. The ground truth is asked afterwards.

use nalgebra::{Matrix2, Vector2, Vector3};
use vislam::datasets::euroc::{GroundTruth, read_ground_truth};
use vislam::datasets::recording::read_recording;
use vislam::datasets::tracks::Picture;
use vislam::filtering::{Freedom, absolute_trajectory_error, align, aligned};
use vislam::inertial::{Calibrated, CameraImu, ImuNoise, NavState, StampedSample, between};
use vislam::initialization::{
    BeginOptions, Beginning, MotionOptions, NoStart, Sensors, VisualMotion, Whole, WholeOptions,
    align_motion, begin, in_motion, inertial_map,
};
use vislam::structure_from_motion::{ScaleFreedom, absolute_orientation};

use super::flights::{any, first};
use super::judged::{Judged, Tilt};
use crate::chapter::Chapter;
use crate::data::{DataFile, NotMade};
use crate::record::{RecordValue, accepted};
use crate::statistics::{median, root_mean_square};

/// Readings and tracks of half a minute of V1_01, and its ground truth.
pub const FILES: [DataFile; 2] = [
    DataFile {
        path: "euroc/V1_01_30s_imu_and_tracks.csv",
        sha256: "5c33295d9bfa3affb13acf25b57620bc6b863823847eedcc12a790c08c8a610a",
    },
    DataFile {
        path: "euroc/V1_01_groundtruth_20hz.csv",
        sha256: "16543952bf69f3fb886008a26cc21d3c552deca8fa06087f0bc329c09d7fcbe3",
    },
];

/// Seconds at which the batch takes the flight up.
pub const FROM: [u32; 4] = [0, 5, 10, 15];
/// Every so manieth picture has a state.
pub const EVERY: [usize; 3] = [1, 2, 4];
/// How far off a pixel of a landmark may be.
pub const GATES: [f64; 5] = [5.0, 10.0, 20.0, 50.0, 100.0];
/// What is told of the batch without further words.
const PLAIN: (usize, f64) = (2, 10.0);
/// Half seconds of the figure of rest, and in how many of them the body stands.
pub const HALVES: usize = 16;
const STANDING: usize = 9;
/// From here on the body flies.
const FLYING: usize = 11;
/// Seconds at which starts in motion begin, and after which they are judged.
pub const STARTS: std::ops::RangeInclusive<u32> = 5..=20;
/// Those of them that the figure shows.
pub const SHOWN: [u32; 4] = [8, 10, 13, 16];
pub const AFTER: [u32; 5] = [1, 2, 3, 4, 5];
/// The pictures that a start uses: five a second.
const THINNED: usize = 4;
/// By how much the densities of the readings, and the standard deviation of a pixel, are told too large where the
/// cause of wrong standard deviations is looked for, and after how many seconds.
const SHAKEN: f64 = 10.0;
const COARSE: f64 = 2.0;
const SUSPECTED: [u32; 2] = [2, 5];
/// Starts of windows whose shape is taken for exact, and their length, in seconds.
pub const WINDOWS: [u32; 8] = [5, 7, 9, 11, 13, 15, 17, 19];
const WINDOW: f64 = 2.0;
/// How much better the poses are known then.
const EXACT: f64 = 1e-3;
/// Times of the figure of the batch in a second, and of its ellipses.
pub const PATH_RATE: usize = 2;
pub const PATH: usize = 60;

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let list = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let inputs = vec![
        ("from", list(&FROM.map(f64::from))),
        ("every", list(&EVERY.map(|every| every as f64))),
        ("gates", list(&GATES)),
        ("starts", format!("{} to {} s", STARTS.start(), STARTS.end())),
        ("noise", "ImuNoise::euroc(), 1 px".to_owned()),
    ];
    chapter.record_of_data("initial_real", &FILES, inputs, real);
}

pub fn numbers(chapter: &mut Chapter) {
    chapter.number("batch_enlarged", ENLARGED, "", 0);
}

/// By how much the ellipses of the figure are larger than three standard deviations.
pub const ENLARGED: f64 = 10.0;

/// A value of the accepted record.
pub fn accepted_value(name: &str) -> f64 {
    accepted("initial_real", name)
}

/// A flight, and the true state at each of its pictures.
#[derive(Clone)]
pub struct Real {
    pub sensors: Sensors,
    pub readings: Vec<StampedSample>,
    pub pictures: Vec<Picture>,
    pub truth: Vec<NavState>,
}

impl Real {
    /// The flight of the two files. Its pixels are those of the camera without its lens.
    pub fn read() -> Result<Self, NotMade> {
        let failed =
            |file: &DataFile, error: String| NotMade::Failed(format!("{}: {error}", file.path));
        let [recording, truth] = &FILES;
        let flown = read_recording(&recording.read()?)
            .map_err(|error| failed(recording, error.to_string()))?;
        let rows =
            read_ground_truth(&truth.read()?).map_err(|error| failed(truth, error.to_string()))?;
        let mut pictures = flown.pictures;
        for feature in pictures.iter_mut().flat_map(|picture| &mut picture.features) {
            feature.pixel = flown
                .camera
                .project_cam(&feature.pixel.push(1.0))
                .ok_or_else(|| failed(recording, format!("track {}", feature.track)))?;
        }
        let sensors = Sensors {
            camera: flown.camera,
            pixel_sigma: 1.0,
            noise: ImuNoise::euroc(),
            rig: CameraImu { body_from_camera: flown.body_from_camera, time_offset: 0.0 },
            calibrated: Calibrated::default(),
            gravity: 9.81,
        };
        let truth = pictures.iter().map(|picture| nearest(&rows, picture.nanoseconds)).collect();
        Ok(Self { sensors, readings: flown.samples, pictures, truth })
    }

    /// Every so manieth picture from a second of the flight on.
    pub fn taken_up(&self, from: u32, every: usize) -> Self {
        let begin = self.pictures[0].nanoseconds + 1_000_000_000 * i64::from(from) - 1_000_000;
        let skipped = self.pictures.partition_point(|picture| picture.nanoseconds < begin);
        let mut rest = self.clone();
        rest.pictures = self.pictures[skipped..].iter().step_by(every).cloned().collect();
        rest.truth = self.truth[skipped..].iter().step_by(every).copied().collect();
        rest
    }

    /// A start in motion on the first seconds, whatever it says of its own certainty.
    fn judged_after(&self, seconds: u32) -> Result<Judged, NoStart> {
        let pictures = first(&self.pictures, f64::from(seconds));
        let options = any(MotionOptions::default());
        let found = in_motion(&self.sensors, &self.readings, pictures, &options)?;
        Ok(Judged::of(&found, &self.truth))
    }

    pub fn begun(&self) -> Result<Beginning, NotMade> {
        begin(&self.sensors, &self.readings, &self.pictures, &BeginOptions::default())
            .map_err(|error| NotMade::Failed(format!("no start: {error}")))
    }

    /// The beginning, if the body stands there.
    pub fn stood(&self) -> Result<Beginning, NotMade> {
        let begun = self.begun()?;
        let none = || NotMade::Failed("the flight does not begin with a stand".to_owned());
        begun.scale_sigma.is_none().then_some(begun).ok_or_else(none)
    }

    /// The batch of all pictures from a beginning.
    pub fn whole(&self, beginning: &Beginning, gate: f64) -> Result<Whole, NotMade> {
        let options = WholeOptions { gate, ..WholeOptions::default() };
        let known = beginning.known.clone();
        Whole::grown(&self.sensors, &self.readings, &self.pictures, known, &options)
            .map_err(|error| NotMade::Failed(format!("no batch: {error}")))
    }
}

/// The state of the row that is nearest in time.
fn nearest(rows: &[GroundTruth], nanoseconds: i64) -> NavState {
    let distance = |row: &&GroundTruth| row.nanoseconds.abs_diff(nanoseconds);
    rows.iter().min_by_key(distance).expect("a ground truth has rows").state
}

/// The root mean square of errors of scale over what is reported.
fn normalized(judged: &[Judged]) -> f64 {
    root_mean_square(judged.iter().map(|judged| judged.scale / judged.scale_sigma))
}

/// The estimated states of a batch.
fn states(whole: &Whole) -> Vec<NavState> {
    whole.batch.states.iter().map(|key| whole.values[*key]).collect()
}

/// The error of the positions after an alignment, in centimetres.
pub fn ate(estimate: &[NavState], truth: &[NavState], freedom: Freedom) -> Result<f64, NotMade> {
    absolute_trajectory_error(estimate, truth, freedom)
        .map(|errors| 100.0 * errors.position)
        .map_err(|error| NotMade::Failed(error.to_string()))
}

fn real() -> Result<Vec<RecordValue>, NotMade> {
    let flight = Real::read()?;
    let mut values = Values(Vec::new());
    values.rest(&flight)?;
    values.waiting(&flight)?;
    values.starts(&flight);
    values.suspects(&flight);
    values.begun(&flight)?;
    values.exact(&flight)?;
    values.batches(&flight)?;
    Ok(values.0)
}

struct Values(Vec<RecordValue>);

impl Values {
    fn add(&mut self, name: impl Into<String>, value: f64, unit: &'static str, decimals: usize) {
        self.0.push(RecordValue::new(name.into(), value, unit, decimals, 1e-3));
    }

    /// What readings and pictures show in each half second.
    fn rest(&mut self, flight: &Real) -> Result<(), NotMade> {
        let halves =
            (0..HALVES).map(|half| Half::of(&flight.pictures[10 * half..=10 * half + 10], flight));
        let halves: Vec<Half> = halves.collect::<Option<_>>().ok_or_else(|| {
            NotMade::Failed("a half second has no readings or no features".to_owned())
        })?;
        for (at, half) in halves.iter().enumerate() {
            self.add(format!("rest_scatter_{at}"), half.scatter, "m/s²", 2);
            self.add(format!("rest_motion_{at}"), half.motion, "px", 2);
        }
        let standing = &halves[..STANDING];
        let scatters = || standing.iter().map(|half| half.scatter);
        self.add("rest_scatter_least", scatters().fold(f64::INFINITY, f64::min), "m/s²", 2);
        self.add("rest_scatter_most", scatters().fold(0.0, f64::max), "m/s²", 2);
        let motion = standing.iter().map(|half| half.motion).fold(0.0, f64::max);
        self.add("rest_motion_most", motion, "px", 1);
        let flying = &halves[FLYING..];
        self.add("flying_scatter", median(flying.iter().map(|half| half.scatter)), "m/s²", 2);
        self.add("flying_motion", median(flying.iter().map(|half| half.motion)), "px", 0);
        Ok(())
    }

    /// The stand with which the flight begins.
    fn waiting(&mut self, flight: &Real) -> Result<(), NotMade> {
        let begun = flight.stood()?;
        let (picture, start) = begun.start;
        let turns = start.covariance.fixed_view::<3, 3>(0, 0).into_owned();
        let tilt = Tilt::of(&start.state, &flight.truth[picture], &turns);
        self.add("wait", begun.seconds, "s", 1);
        self.add("wait_tilt", 1e3 * tilt.error.norm(), "mrad", 1);
        self.add("wait_tilt_sigma", 1e3 * tilt.sigma(), "mrad", 1);
        Ok(())
    }

    /// Starts in motion, a second after another, and what they know after some seconds.
    fn starts(&mut self, flight: &Real) {
        let mut after = AFTER.map(|_| Vec::new());
        for from in STARTS {
            let flight = flight.taken_up(from, THINNED);
            for (seconds, judged) in AFTER.into_iter().zip(&mut after) {
                let found = flight.judged_after(seconds);
                let [error, sigma] = match &found {
                    Ok(found) => [found.scale, found.scale_sigma],
                    Err(refused) => {
                        eprintln!("from {from} s, {seconds} s: {refused}");
                        [0.0; 2]
                    }
                };
                if SHOWN.contains(&from) {
                    self.add(format!("start_{from}_{seconds}_error"), 100.0 * error, "%", 1);
                    self.add(format!("start_{from}_{seconds}_sigma"), 100.0 * sigma, "%", 1);
                }
                judged.extend(found);
            }
        }
        self.add("starts", STARTS.count() as f64, "", 0);
        for (seconds, judged) in AFTER.into_iter().zip(&after) {
            let of = |number: fn(&Judged) -> f64| judged.iter().map(number);
            let accurate = root_mean_square(of(|judged| judged.scale));
            let sure = median(of(|judged| judged.scale_sigma));
            let normalized = normalized(judged);
            self.add(format!("found_{seconds}"), judged.len() as f64, "", 0);
            self.add(format!("sigma_median_{seconds}"), 100.0 * sure, "%", 1);
            self.add(format!("error_rms_{seconds}"), 100.0 * accurate, "%", 1);
            self.add(format!("normalized_{seconds}"), normalized, "", 1);
        }
    }

    /// The same with readings, and with pixels, that are told to be worse than they are on paper.
    fn suspects(&mut self, flight: &Real) {
        for (name, [readings, pixels]) in [("shaken", [SHAKEN, 1.0]), ("coarse", [1.0, COARSE])] {
            let mut flight = flight.clone();
            flight.sensors.noise.gyro *= readings;
            flight.sensors.noise.accelerometer *= readings;
            flight.sensors.pixel_sigma *= pixels;
            for seconds in SUSPECTED {
                let starts = STARTS.map(|from| flight.taken_up(from, THINNED));
                let judged: Vec<Judged> =
                    starts.filter_map(|start| start.judged_after(seconds).ok()).collect();
                self.add(format!("{name}_{seconds}"), normalized(&judged), "", 1);
            }
        }
        self.add("shaken_times", SHAKEN, "", 0);
        self.add("coarse_px", COARSE, "px", 0);
    }

    /// How soon the flight begins where it is taken up, and with which scale.
    fn begun(&mut self, flight: &Real) -> Result<(), NotMade> {
        for from in &FROM[1..] {
            let begun = flight.taken_up(*from, 1).begun()?;
            self.add(format!("begun_{from}"), begun.seconds, "s", 1);
            let sigma = begun.scale_sigma.unwrap_or(f64::NAN);
            self.add(format!("begun_{from}_sigma"), 100.0 * sigma, "%", 1);
        }
        Ok(())
    }

    /// What the inertial estimate makes of the scale if the shape is exact, and if it is measured.
    fn exact(&mut self, flight: &Real) -> Result<(), NotMade> {
        let mut both = [Vec::new(), Vec::new()];
        for from in WINDOWS {
            let flight = flight.taken_up(from, THINNED);
            for ((name, trust), found) in
                [("exact", EXACT), ("measured", 1.0)].into_iter().zip(&mut both)
            {
                let scale = Scale::of(&flight, WINDOW, trust);
                // Zero where there is none.
                let [ratio, sigma] = scale.as_ref().map_or([0.0; 2], |s| [s.ratio, s.sigma]);
                self.add(format!("{name}_{from}"), ratio, "", 2);
                self.add(format!("{name}_{from}_sigma"), 100.0 * sigma, "%", 1);
                found.extend(scale);
            }
        }
        self.add("exact_windows", both[0].len() as f64, "", 0);
        for (name, scales) in ["exact", "measured"].into_iter().zip(&both) {
            let ratios = || scales.iter().map(|scale| scale.ratio);
            self.add(format!("{name}_least"), ratios().fold(f64::INFINITY, f64::min), "", 2);
            self.add(format!("{name}_most"), ratios().fold(0.0, f64::max), "", 2);
            let sigma = median(scales.iter().map(|scale| scale.sigma));
            self.add(format!("{name}_sigma"), 100.0 * sigma, "%", 1);
            let normalized = scales.iter().map(|scale| scale.ratio.ln() / scale.sigma);
            self.add(format!("{name}_normalized"), root_mean_square(normalized), "", 1);
        }
        Ok(())
    }

    /// The batch from its own starts, and how far gates and picture rates move its error.
    fn batches(&mut self, flight: &Real) -> Result<(), NotMade> {
        for from in FROM {
            let mut errors = Vec::new();
            for every in EVERY {
                let flight = flight.taken_up(from, every);
                let begun = flight.begun()?;
                for gate in GATES {
                    let whole = flight.whole(&begun, gate)?;
                    let estimate = states(&whole);
                    let error = ate(&estimate, &flight.truth, Freedom::Four)?;
                    eprintln!("from {from} s, every {every}, gate {gate} px: {error:.2} cm");
                    errors.push(error);
                    if (every, gate) == PLAIN {
                        self.add(format!("batch_{from}_ate4"), error, "cm", 2);
                        let six = ate(&estimate, &flight.truth, Freedom::Six)?;
                        self.add(format!("batch_{from}_ate6"), six, "cm", 2);
                        if from == 0 {
                            self.path(&flight, &whole)?;
                        }
                    }
                }
            }
            let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
            self.add(format!("batch_{from}_low"), least, "cm", 2);
            self.add(
                format!("batch_{from}_high"),
                errors.iter().copied().fold(0.0, f64::max),
                "cm",
                2,
            );
        }
        Ok(())
    }

    /// The batch seen from above, in the world of the truth.
    fn path(&mut self, flight: &Real, whole: &Whole) -> Result<(), NotMade> {
        let failed = |error: &dyn std::fmt::Display| NotMade::Failed(error.to_string());
        let estimate = states(whole);
        let laid = aligned(&estimate, &flight.truth, Freedom::Four).map_err(|e| failed(&e))?;
        let turn = align(&estimate, &flight.truth, Freedom::Four).map_err(|e| failed(&e))?.rotation;
        self.add("batch_states", estimate.len() as f64, "", 0);
        self.add("batch_landmarks", whole.batch.landmarks.len() as f64, "", 0);
        self.add("batch_refused", whole.refused.len() as f64, "", 0);
        let second = 20 / PLAIN.0;
        for at in 0..=PATH {
            let state = (at * second / PATH_RATE).min(laid.len() - 1);
            let [is, was] = [&laid[state], &flight.truth[state]].map(|state| state.position.xy());
            self.place(&format!("path_{at}"), is);
            self.place(&format!("truth_{at}"), was);
            let covariance = whole.covariance.of(whole.batch.states[state]);
            let spread = covariance.ok_or_else(|| failed(&"a state has no covariance"))?;
            let spread = spread.fixed_view::<3, 3>(6, 6).into_owned();
            let spread = turn * spread * turn.inverse();
            let spread = 1e4 * spread.fixed_view::<2, 2>(0, 0).into_owned();
            if at == PATH {
                self.add("batch_last_sigma", spread.trace().sqrt(), "cm", 1);
            }
            if at % PATH_RATE == 0 {
                self.spread(at, &spread);
            }
        }
        Ok(())
    }

    fn place(&mut self, name: &str, place: Vector2<f64>) {
        self.add(format!("{name}_x"), place.x, "m", 3);
        self.add(format!("{name}_y"), place.y, "m", 3);
    }

    fn spread(&mut self, at: usize, spread: &Matrix2<f64>) {
        for (name, of) in [("xx", (0, 0)), ("xy", (0, 1)), ("yy", (1, 1))] {
            self.add(format!("spread_{at}_{name}"), spread[of], "cm²", 3);
        }
    }
}

/// Half a second.
struct Half {
    /// The standard deviation of the length of the accelerometer's readings, in m/s².
    scatter: f64,
    /// How far the feature in the middle has moved, in pixels.
    motion: f64,
}

impl Half {
    fn of(pictures: &[Picture], flight: &Real) -> Option<Self> {
        let (first, last) = pictures.first().zip(pictures.last())?;
        let readings = between(&flight.readings, first.nanoseconds, last.nanoseconds).ok()?;
        let lengths: Vec<f64> =
            readings.iter().map(|reading| reading.sample.accelerometer.norm()).collect();
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        let scatter = root_mean_square(lengths.iter().map(|length| length - mean));
        let moved = first.features.iter().filter_map(|feature| {
            let later = last.features.iter().find(|later| later.track == feature.track)?;
            Some((later.pixel - feature.pixel).norm())
        });
        Some(Self { scatter, motion: median(moved) }).filter(|half| half.motion.is_finite())
    }
}

/// A scale from readings, beside the true one.
struct Scale {
    /// Estimate over truth.
    ratio: f64,
    /// The standard deviation that is reported, of its logarithm.
    sigma: f64,
}

impl Scale {
    /// That of the first seconds, when the poses are measured this many times as well as the pixels say;
    /// none without a start.
    fn of(flight: &Real, seconds: f64, trust: f64) -> Option<Self> {
        let Real { sensors, readings, .. } = flight;
        let motion = VisualMotion::of(sensors, first(&flight.pictures, seconds)).ok()?;
        let bias = BeginOptions::default().motion.accelerometer_bias;
        let aligned = align_motion(sensors, readings, &motion, bias).ok()?;
        let told = Sensors { pixel_sigma: trust * sensors.pixel_sigma, ..*sensors };
        let map = inertial_map(&told, readings, &motion, &aligned, bias).ok()?;
        let centre = |at: &usize| -> Vector3<f64> {
            sensors.rig.world_from_camera(&flight.truth[*at]).translation.vector
        };
        let truth = motion.pictures.iter().map(centre);
        let pairs: Vec<_> = motion.centres.iter().copied().zip(truth).collect();
        let true_scale = absolute_orientation(&pairs, ScaleFreedom::Free).ok()?.scale;
        Some(Self { ratio: map.scale / true_scale, sigma: map.scale_sigma })
    }
}
