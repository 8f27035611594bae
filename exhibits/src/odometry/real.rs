//! The three estimators on a real flight, from their own beginning, and ISAM2 beside them in the same run.

use std::path::{Path, PathBuf};

use vislam::filtering::{Freedom, aligned};
use vislam::inertial::NavState;
use vislam::odometry::{Estimator, Odometry, OdometryOptions};

use crate::chapter::Chapter;
use crate::data::NotMade;
use crate::initialization::gtsam::files;
use crate::initialization::real::{FILES, FROM, Real, ate};
use crate::python::Python;
use crate::record::{RecordValue, accepted};
use crate::smoother::followed::Followed;
use crate::statistics;

const SCRIPT: &str = "odometry_isam2.py";
/// Of so many runs the one in the middle is timed.
const TIMED_RUNS: usize = 5;
/// Pictures from a state to the next; the first is meant where nothing is said.
const EVERY: [usize; 3] = [2, 1, 4];
/// How far off a pixel may be: of the smoother in standard deviations, of ISAM2 in pixels. The first is meant where
/// nothing is said.
const GATES: [f64; 3] = [30.0, 10.0, 100.0];
const ISAM_GATES: [f64; 3] = [20.0, 10.0, 100.0];
/// The chance with which the filter lets a good track pass.
const FILTER_GATES: [f64; 3] = [0.99, 0.95, 0.999];
/// Points of the path in a second.
const PATH_RATE: usize = 2;
/// Points of the path.
pub const PATH: usize = 46;
/// Seconds from one error that is shown to the next, as in the script.
const SHOWN: f64 = 1.5;
/// Kinds of trajectories and whose they are, which may only be compared with others of their kind.
pub const KINDS: [(&str, &[&str]); 3] = [
    ("causal", &["smoother", "isam", "filter"]),
    ("delayed", &["smoother", "isam"]),
    ("smoothed", &["batch", "isam"]),
];
/// The estimators that are run, the names of their trajectories in the record, and what is aimed at beside ISAM2.
pub const LINES: [(&str, f64); 3] =
    [("smoother_causal", 1.25), ("smoother_delayed", 1.25), ("filter_causal", 1.6)];

/// Registers the record.
pub fn record(chapter: &mut Chapter) {
    let list = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let inputs = vec![
        ("from", list(&FROM.map(f64::from))),
        ("every", list(&EVERY.map(|every| every as f64))),
        ("gates", list(&[GATES, ISAM_GATES, FILTER_GATES].concat())),
        ("noise", "ImuNoise::euroc(), 1 px".to_owned()),
    ];
    chapter.record_of_data("odometry_real", &FILES, inputs, real);
    let inputs = vec![
        ("from", list(&FROM.map(f64::from))),
        ("every", EVERY[0].to_string()),
        ("gates", list(&[GATES[0], ISAM_GATES[0]])),
        ("runs", TIMED_RUNS.to_string()),
    ];
    chapter.record_of_data("odometry_speed", &FILES, inputs, speed);
}

pub fn numbers(chapter: &mut Chapter) {
    let of = |name: String| accepted("odometry_real", &name);
    let beside = |line: &str, from: u32| {
        let theirs = if line.ends_with("delayed") { "isam_delayed" } else { "isam_causal" };
        of(format!("{line}_{from}")) / of(format!("{theirs}_{from}"))
    };
    let each = || LINES.into_iter().flat_map(|(line, aim)| FROM.map(|from| (line, aim, from)));
    let within = each().filter(|(line, aim, from)| beside(line, *from) <= *aim).count();
    chapter.number("aims", each().count() as f64, "", 0);
    chapter.number("aims_reached", within as f64, "", 0);
    let tie = |(line, from): &(&str, u32)| {
        let theirs = line.replace("smoother", "isam");
        let range =
            |line: &str| of(format!("{line}_{from}_high")) - of(format!("{line}_{from}_low"));
        let apart = of(format!("{line}_{from}")) - of(format!("{theirs}_{from}"));
        apart.abs() < range(line).max(range(&theirs))
    };
    let smoothers = LINES[..2].iter().flat_map(|(line, _)| FROM.map(|from| (*line, from)));
    let [ties, compared] = [smoothers.clone().filter(tie).count(), smoothers.count()];
    chapter.number("ties", ties as f64, "", 0);
    chapter.number("compared", compared as f64, "", 0);
    chapter.number("timed_runs", TIMED_RUNS as f64, "", 0);
    for (name, line, aim) in [
        ("worst_causal", LINES[0].0, "aim_smoother"),
        ("worst_delayed", LINES[1].0, ""),
        ("worst_filter", LINES[2].0, "aim_filter"),
    ] {
        let worst = FROM.map(|from| beside(line, from)).into_iter().fold(0.0, f64::max);
        chapter.number(name, worst, "", 2);
        if let Some((_, value)) =
            LINES.iter().find(|(own, _)| *own == line).filter(|_| !aim.is_empty())
        {
            chapter.number(aim, *value, "", 2);
        }
    }
    for (name, from) in ["from_second", "from_third", "from_fourth"].into_iter().zip(&FROM[1..]) {
        chapter.number(name, f64::from(*from), "s", 0);
    }
}

/// States by the number of their picture.
type Trajectory = Vec<(usize, NavState)>;

/// A flight that is taken up, with what an estimator made of it.
struct Flown {
    causal: Trajectory,
    delayed: Trajectory,
    /// How many times as fast as the flight it was.
    speed: f64,
    losses: usize,
}

fn flown(flight: &Real, estimator: Estimator, gate: usize) -> Result<Flown, NotMade> {
    let mut options = OdometryOptions::new(flight.sensors, estimator);
    (options.smoother.gate, options.msckf.gate) = (GATES[gate], FILTER_GATES[gate]);
    let mut odometry = Odometry::new(options);
    let followed =
        Followed::of(&mut odometry, &flight.readings, &flight.pictures, &flight.sensors.rig)
            .map_err(|error| NotMade::Failed(format!("{estimator}: {error}")))?;
    let Some((first, _)) = followed.causal.first().copied() else {
        return Err(NotMade::Failed(format!("{estimator}: there is no beginning")));
    };
    let times = [first, flight.pictures.len() - 1].map(|at| flight.pictures[at].nanoseconds);
    let delayed = followed.delayed.iter().copied().filter(|(at, _)| *at >= first).collect();
    Ok(Flown {
        causal: followed.causal.iter().map(|(at, estimate)| (*at, estimate.state)).collect(),
        delayed,
        speed: 1e-9 * (times[1] - times[0]) as f64 / followed.seconds,
        losses: followed.losses,
    })
}

/// The error of a trajectory after alignment, in centimetres.
fn error(flight: &Real, trajectory: &Trajectory) -> Result<f64, NotMade> {
    let (states, truth) = beside_truth(flight, trajectory);
    ate(&states, &truth, Freedom::Four)
}

/// The states of a trajectory, and the true ones.
fn beside_truth(flight: &Real, trajectory: &Trajectory) -> (Vec<NavState>, Vec<NavState>) {
    trajectory.iter().map(|(at, state)| (*state, flight.truth[*at])).unzip()
}

/// The states of a trajectory after alignment, and the true ones.
fn laid_on_truth(
    flight: &Real,
    trajectory: &Trajectory,
) -> Result<(Vec<NavState>, Vec<NavState>), NotMade> {
    let (states, truth) = beside_truth(flight, trajectory);
    let aligned = aligned(&states, &truth, Freedom::Four);
    Ok((aligned.map_err(|error| NotMade::Failed(error.to_string()))?, truth))
}

/// What ISAM2 made of the same pictures.
struct Isam {
    /// Causal, delayed and smoothed errors, in centimetres.
    errors: [f64; 3],
    /// Of the same, how far off a state is from time to time.
    off: [Vec<f64>; 3],
    /// How many times as fast as the flight it was.
    speed: f64,
}

/// ISAM2 of the same pictures, judged from a time of the recording on.
fn isam(
    python: &Python,
    (from, every, gate): (u32, usize, usize),
    flight: &Real,
    since: i64,
) -> Result<Isam, NotMade> {
    let begin = flight.readings[0].nanoseconds;
    let since = 1e-9 * (since - begin) as f64;
    let numbers =
        [from.to_string(), every.to_string(), ISAM_GATES[gate].to_string(), format!("{since:.4}")];
    let files = files()?;
    let mut arguments: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    arguments.extend(numbers.iter().map(Path::new));
    let said = python.run(SCRIPT, &arguments)?;
    let line = |line: &str| line.split_whitespace().map(|word| word.parse().ok()).collect();
    let lines: Option<Vec<Vec<f64>>> = said.lines().map(line).collect();
    let [first, off @ ..] = lines.as_deref().unwrap_or_default() else {
        return Err(misread(&said));
    };
    let (&[causal, delayed, smoothed, seconds], Ok(off)) = (&first[..], off.to_vec().try_into())
    else {
        return Err(misread(&said));
    };
    let times = [0, flight.pictures.len() - 1].map(|at| flight.pictures[at].nanoseconds);
    let speed = 1e-9 * (times[1] - times[0]) as f64 / seconds;
    Ok(Isam { errors: [causal, delayed, smoothed], off, speed })
}

fn misread(said: &str) -> NotMade {
    NotMade::Failed(format!("{SCRIPT} prints {said:?}; four numbers and three lines are due"))
}

/// How far off a trajectory is from time to time after alignment, in centimetres.
fn off(flight: &Real, trajectory: &Trajectory) -> Result<Vec<f64>, NotMade> {
    let (aligned, truth) = laid_on_truth(flight, trajectory)?;
    let stride = (SHOWN * (20 / EVERY[0]) as f64).round() as usize;
    let away = aligned
        .iter()
        .zip(&truth)
        .map(|(own, true_)| 100.0 * (own.position - true_.position).norm());
    Ok(away.step_by(stride).collect())
}

/// Puts down how far off a trajectory is.
fn push_off((kind, who, from): (&str, &str, u32), off: &[f64], values: &mut Vec<RecordValue>) {
    let within = within(who, from, 0.1);
    values.extend(off.iter().enumerate().map(|(at, off)| {
        RecordValue::new(format!("off_{kind}_{who}_{from}_{at}"), *off, "cm", 2, within)
    }));
    values.push(RecordValue::new(
        format!("shown_{kind}_{who}_{from}"),
        off.len() as f64,
        "",
        0,
        0.0,
    ));
}

/// One of ISAM2's runs from the last place strays, and how far depends on the last digits of its start.
const ASTRAY: f64 = 1.0;

/// By what share of itself an error may differ when it is computed again.
fn within(who: &str, from: u32, usual: f64) -> f64 {
    let strays = who.starts_with("isam") && from == FROM[FROM.len() - 1];
    if strays { ASTRAY } else { usual }
}

/// One trajectory over gates and rates: at the plain ones, the least and the greatest.
#[derive(Default)]
struct Spread(Vec<f64>);

impl Spread {
    fn push(self, name: &str, from: u32, values: &mut Vec<RecordValue>) {
        let low = self.0.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.0.iter().copied().fold(0.0, f64::max);
        let farthest = within(name, from, 0.02);
        for (end, value, within) in
            [("", self.0[0], 0.02), ("_low", low, 0.02), ("_high", high, farthest)]
        {
            let name = format!("{name}_{from}{end}");
            values.push(RecordValue::new(name, value, "cm", 2, within));
        }
    }
}

fn real() -> Result<Vec<RecordValue>, NotMade> {
    let python = Python::with_gtsam()?;
    let flight = Real::read()?;
    let mut values = Vec::new();
    let (mut runs, mut losses) = (0, 0);
    let plain_first = || {
        let rates = EVERY.into_iter().map(|every| (every, 0));
        rates.chain((1..GATES.len()).map(|gate| (EVERY[0], gate)))
    };
    for from in FROM {
        let names = ["smoother_causal", "smoother_delayed", "filter_causal"];
        let theirs = ["isam_causal", "isam_delayed", "isam_smoothed"];
        let mut spreads: [Spread; 6] = Default::default();
        for (every, gate) in plain_first() {
            let part = flight.taken_up(from, every);
            let smoother = flown(&part, Estimator::Smoother, gate)?;
            let filter = flown(&part, Estimator::Msckf, gate)?;
            (runs, losses) = (runs + 2, losses + smoother.losses + filter.losses);
            let since = part.pictures[smoother.causal[0].0].nanoseconds;
            let isam = isam(&python, (from, every, gate), &part, since)?;
            let own = [&smoother.causal, &smoother.delayed, &filter.causal];
            for (spread, trajectory) in spreads.iter_mut().zip(own) {
                spread.0.push(error(&part, trajectory)?);
            }
            for (spread, error) in spreads[3..].iter_mut().zip(isam.errors) {
                spread.0.push(error);
            }
            if (every, gate) == (EVERY[0], 0) {
                let batch = flown(&part, Estimator::Batch, 0)?;
                for (name, trajectory) in
                    [("batch_causal", &batch.causal), ("batch_delayed", &batch.delayed)]
                {
                    let name = format!("{name}_{from}");
                    values.push(RecordValue::new(name, error(&part, trajectory)?, "cm", 2, 0.02));
                }
                let whole = part.whole(&part.begun()?, 10.0)?;
                let states = whole.batch.states.iter().map(|state| whole.values[*state]);
                let first = smoother.causal[0].0;
                let states: Trajectory = states.enumerate().skip(first).collect();
                let name = format!("batch_smoothed_{from}");
                values.push(RecordValue::new(name, error(&part, &states)?, "cm", 2, 0.02));
                for (kind, who, trajectory) in [
                    ("causal", "smoother", &smoother.causal),
                    ("causal", "filter", &filter.causal),
                    ("delayed", "smoother", &smoother.delayed),
                    ("smoothed", "batch", &states),
                ] {
                    push_off((kind, who, from), &off(&part, trajectory)?, &mut values);
                }
                for ((kind, _), off) in KINDS.iter().zip(&isam.off) {
                    push_off((kind, "isam", from), off, &mut values);
                }
                let begin = part.readings[0].nanoseconds;
                let begun = 1e-9 * (since - begin) as f64;
                values.push(RecordValue::new(format!("begun_{from}"), begun, "s", 2, 0.0));
                if from == FROM[0] {
                    path(&part, &smoother, &filter, &states, &mut values)?;
                }
            }
        }
        for (spread, name) in spreads.into_iter().zip(names.into_iter().chain(theirs)) {
            spread.push(name, from, &mut values);
        }
    }
    values.push(RecordValue::new("runs", f64::from(runs), "", 0, 0.0));
    values.push(RecordValue::new("losses", losses as f64, "", 0, 0.0));
    Ok(values)
}

/// How many times as fast as the flight the smoother is, and how many times as fast as ISAM2: the least from the four
/// places, and from each the median of some runs.
fn speed() -> Result<Vec<RecordValue>, NotMade> {
    let python = Python::with_gtsam()?;
    let flight = Real::read()?;
    let (mut slowest, mut faster) = (f64::INFINITY, f64::INFINITY);
    for from in FROM {
        let part = flight.taken_up(from, EVERY[0]);
        let first = flown(&part, Estimator::Smoother, 0)?.causal[0].0;
        let since = part.pictures[first].nanoseconds;
        let own = median(|| Ok(flown(&part, Estimator::Smoother, 0)?.speed))?;
        let theirs = median(|| Ok(isam(&python, (from, EVERY[0], 0), &part, since)?.speed))?;
        (slowest, faster) = (slowest.min(own), faster.min(own / theirs));
    }
    Ok(vec![
        RecordValue::new("speed", slowest, "", 0, 0.5),
        RecordValue::new("faster_than_isam", faster, "", 1, 0.5),
    ])
}

/// The median of what some runs give.
fn median(run: impl Fn() -> Result<f64, NotMade>) -> Result<f64, NotMade> {
    let found: Vec<f64> = (0..TIMED_RUNS).map(|_| run()).collect::<Result<_, _>>()?;
    Ok(statistics::median(found))
}

/// The trajectories from above, each aligned for itself.
fn path(
    flight: &Real,
    smoother: &Flown,
    filter: &Flown,
    smoothed: &Trajectory,
    values: &mut Vec<RecordValue>,
) -> Result<(), NotMade> {
    let first = smoother.causal[0].0;
    let rate = 20 / EVERY[0];
    let shown = |at: usize| first + at * rate / PATH_RATE;
    let mut push = |name: &str, at: usize, state: &NavState| {
        for (axis, value) in [("x", state.position.x), ("y", state.position.y)] {
            let name = format!("path_{name}_{at}_{axis}");
            // Rounding moves a path by a part of its length, and so a coordinate near zero by a part of more than that.
            let within = if value.abs() < 0.05 { 1.0 } else { 0.02 };
            values.push(RecordValue::new(name, value, "m", 3, within));
        }
    };
    for at in 0..PATH {
        push("truth", at, &flight.truth[shown(at)]);
    }
    let all = [
        ("causal", &smoother.causal),
        ("delayed", &smoother.delayed),
        ("filter", &filter.causal),
        ("smoothed", smoothed),
    ];
    for (name, trajectory) in all {
        let (states, _) = laid_on_truth(flight, trajectory)?;
        for at in 0..PATH {
            let number = trajectory.iter().position(|(number, _)| *number == shown(at));
            let Some(state) = number.map(|number| states[number]) else {
                return Err(NotMade::Failed(format!("{name} has no state {}", shown(at))));
            };
            push(name, at, &state);
        }
    }
    Ok(())
}

/// Times of the recording in seconds, and how far off a trajectory is then, in centimetres.
pub fn off_by(kind: &str, who: &str, from: u32) -> Vec<(f64, f64)> {
    let begun = recorded(&format!("begun_{from}"));
    let count = recorded(&format!("shown_{kind}_{who}_{from}")) as usize;
    let off = |at: usize| recorded(&format!("off_{kind}_{who}_{from}_{at}"));
    (0..count).map(|at| (begun + SHOWN * at as f64, off(at))).collect()
}

/// A value of the accepted record.
pub fn recorded(name: &str) -> f64 {
    accepted("odometry_real", name)
}
