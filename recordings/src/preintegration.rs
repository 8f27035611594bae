//! A flight whose readings are summed: from keyframe to keyframe, and as a whole.

use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, NavState};
use vislam::preintegration::Preintegrator;
use vislam::simulation::Trajectory;

use crate::layout::{Beside, Layout};
use crate::stage::{colour, lines, points};
use crate::{Stage, StageError, ring_around};

pub const SHOWS: &str =
    "a figure-eight, its readings summed, with a tube of three standard deviations";

/// Seconds between two readings, and the length of the flight in seconds.
const DT: f64 = 0.005;
const SECONDS: f64 = 7.85;
/// Readings between two places that are drawn, and between two keyframes.
const DRAWN: usize = 10;
const KEYFRAME: usize = 200;
/// For how long the sums from the beginning are drawn; after that their tube hides everything else.
const RUN_ON: f64 = 2.6;
/// The noise of the readings, over that of the poor sensor of the chapter.
const POORER: f64 = 4.0;
/// How many flights are drawn beside, whose readings have other noise.
const FLIGHTS: u64 = 12;
/// How many standard deviations wide the tubes are.
const WIDE: f64 = 3.0;

/// A place on the way that the sums predict, with the covariance of its position.
struct Place {
    state: NavState,
    covariance: Matrix3<f64>,
}

impl Place {
    fn ring(&self) -> Vec<Vector3<f64>> {
        ring_around(&self.state.position, &self.state.velocity, &self.covariance, WIDE)
    }

    /// The root of the trace of the covariance.
    fn sigma(&self) -> f64 {
        self.covariance.trace().sqrt()
    }
}

pub fn play(stage: &Stage) -> Result<(), StageError> {
    stage.arrange(&Layout {
        title: "A figure-eight with its tubes",
        eye: Vector3::new(-1.9, -5.3, 3.6),
        target: Vector3::new(0.35, 0.0, -0.15),
        up: Vector3::z(),
        floor: None,
        beside: vec![Beside::Curves {
            title: "Standard deviation of the position, m",
            of: "sigma",
        }],
        timeline: "time",
        speed: 1.0,
    })?;
    stage.curve("sigma/whole", "summed from the beginning", colour::ESTIMATED)?;
    stage.curve("sigma/part", "summed from the last keyframe", colour::MEASURED)?;
    let motion = Trajectory::figure_eight();
    let steps = (SECONDS / DT) as usize;
    let truth: Vec<NavState> = (0..=steps).map(|step| motion.at(step as f64 * DT).state).collect();
    let way = truth.iter().step_by(DRAWN).map(|state| state.position).collect();
    stage.always("world/truth", &lines([way], (colour::TRUTH, 160), 1.2))?;
    let whole = summed(&motion, 0, steps)?;
    let parts = (0..steps).step_by(KEYFRAME).map(|first| {
        let last = (first + KEYFRAME).min(steps);
        summed(&motion, first, last)
    });
    let parts = parts.collect::<Result<Vec<_>, _>>()?;
    let flights: Vec<_> = (1..=FLIGHTS).map(|seed| flight(&motion, steps, seed)).collect();
    for drawn in 1..=whole.len() {
        stage.at_seconds("time", (drawn * DRAWN) as f64 * DT);
        let run_on = drawn.min((RUN_ON / DT) as usize / DRAWN);
        let tube = whole[..run_on].iter().map(Place::ring);
        stage.now("world/whole/tube", &lines(tube, (colour::ESTIMATED, 120), 0.8))?;
        let ways = flights.iter().map(|flight| flight[..=run_on].to_vec());
        stage.now("world/whole/flights", &lines(ways, (colour::STRIKING, 160), 0.7))?;
        stage.value("sigma/whole", whole[drawn - 1].sigma())?;
        let keyframes = truth.iter().step_by(KEYFRAME).take((drawn * DRAWN - 1) / KEYFRAME + 1);
        let keyframes = keyframes.map(|state| &state.position);
        stage.now("world/keyframes", &points(keyframes, colour::PRIOR, 7.0))?;
        let past: Vec<&Place> = parts.iter().flatten().take(drawn).collect();
        let tubes = past.iter().map(|place| place.ring());
        stage.now("world/parts/tubes", &lines(tubes, (colour::MEASURED, 200), 0.8))?;
        if let Some(last) = past.last() {
            stage.value("sigma/part", last.sigma())?;
        }
    }
    Ok(())
}

fn noise() -> ImuNoise {
    let poor = ImuNoise::mems();
    let (gyro, accelerometer) = (POORER * poor.gyro, POORER * poor.accelerometer);
    ImuNoise { gyro, accelerometer, ..poor }
}

/// What perfect readings from one step to another predict on the way, from the true state at the first.
fn summed(motion: &Trajectory, first: usize, last: usize) -> Result<Vec<Place>, StageError> {
    let bias = ImuBias::default();
    let start = motion.at(first as f64 * DT).state;
    let turn = start.world_from_body.matrix();
    let mut sums = Preintegrator::new(&bias, &noise()).map_err(StageError::scene)?;
    let mut places = Vec::new();
    for step in first..last {
        let [begin, end] =
            [step, step + 1].map(|step| motion.at(step as f64 * DT).sample(&GRAVITY));
        sums.integrate_midpoint(&begin, &end, DT).map_err(StageError::scene)?;
        if (step + 1) % DRAWN == 0 {
            let sums = sums.finish().map_err(StageError::scene)?;
            let own = sums.covariance.fixed_view::<3, 3>(6, 6);
            let covariance = turn * own * turn.transpose();
            places.push(Place { state: sums.predict(&start, &GRAVITY, &bias), covariance });
        }
    }
    Ok(places)
}

/// Where readings with noise lead, from the true state at the beginning.
fn flight(motion: &Trajectory, steps: usize, seed: u64) -> Vec<Vector3<f64>> {
    let (noise, bias) = (noise(), ImuBias::default());
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut state = motion.at(0.0).state;
    let mut way = vec![state.position];
    let readings = motion.samples(&GRAVITY, DT, steps + 1);
    let read = |sample| noise.corrupt(sample, &bias, DT, || StandardNormal.sample(&mut random));
    let readings: Vec<_> = readings.iter().map(read).collect();
    for (step, pair) in readings.windows(2).enumerate() {
        state = state.propagate_midpoint(&pair[0], &pair[1], &GRAVITY, DT);
        if (step + 1) % DRAWN == 0 {
            way.push(state.position);
        }
    }
    way
}
