//! The readings between two keyframes, summed, and what a bias makes of the sums.

use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::preintegration::{
    Deltas, Matrix9, Preintegrated, Preintegrator, Vector9, correct_for_bias, imu_residual,
};
use vislam::simulation::Trajectory;

/// Seconds between two readings.
pub const DT: f64 = 0.005;
/// Into how many parts an interval is cut to draw it.
const PARTS: usize = 20;
/// The largest belief in a bias, over the true one, and for how many beliefs up to it readings are summed again.
const MOST_BELIEVED: f64 = 1.5;
const BELIEFS: usize = 15;
/// How much a correction may add to the squared whitened residual: a hundredth of its mean.
const ADDED: f64 = 0.09;

/// What an interval depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Figure-eight, level turn or turn on the spot.
    pub motion: usize,
    /// Steps between two readings.
    pub steps: usize,
    /// Densities of the noise over those of the poor sensor.
    pub noise: f64,
    /// The bias of the gyroscope in mrad/s, about the axis ahead (0) or up (1).
    pub gyro: f64,
    /// Which axis that is.
    pub axis: usize,
    /// The bias of the accelerometer to the left, in m/s².
    pub force: f64,
    /// Which noise is drawn.
    pub draw: u64,
}

impl Setting {
    /// From the controls, and the bias that is believed over the true one.
    pub fn of(controls: &[f64]) -> Option<(Self, f64)> {
        let &[believed, seconds, gyro, axis, force, noise, motion, draw] = controls else {
            return None;
        };
        let [axis, motion] = [axis, motion].map(|choice| choice.round() as usize);
        let steps = (seconds / DT).round() as usize;
        let draw = draw.round() as u64;
        Some((Self { motion, steps, noise, gyro, axis, force, draw }, believed))
    }

    /// The motion.
    pub fn trajectory(&self) -> Trajectory {
        match self.motion {
            0 => Trajectory::figure_eight(),
            1 => Trajectory::level_turn(1.0, 0.5),
            _ => Trajectory::turn_on_the_spot(0.5),
        }
    }

    /// The densities of the sensor's noise.
    pub fn densities(&self) -> ImuNoise {
        let poor = ImuNoise::mems();
        let (gyro, accelerometer) = (self.noise * poor.gyro, self.noise * poor.accelerometer);
        ImuNoise { gyro, accelerometer, ..poor }
    }

    /// A part of the true bias.
    pub fn bias(&self, part: f64) -> ImuBias {
        let axis = if self.axis == 0 { Vector3::x() } else { Vector3::z() };
        ImuBias {
            gyro: part * 1e-3 * self.gyro * axis,
            accelerometer: part * self.force * Vector3::y(),
        }
    }

    /// What the sensor reads, from one keyframe to the other.
    pub fn readings(&self) -> Vec<ImuSample> {
        let (noise, bias) = (self.densities(), self.bias(1.0));
        let mut random = ChaCha8Rng::seed_from_u64(self.draw);
        let mut samples = self.trajectory().samples(&GRAVITY, DT, self.steps + 1);
        for sample in &mut samples {
            *sample = noise.corrupt(sample, &bias, DT, || StandardNormal.sample(&mut random));
        }
        samples
    }
}

/// What a correction leaves of the position, at most and in fact, in metres.
#[derive(Debug, Clone, Copy)]
pub struct Left {
    pub error: f64,
    pub bound: f64,
    /// The state that the readings predict when they are summed again.
    pub again: NavState,
}

/// What the sums say with a bias that is believed.
pub struct Belief {
    /// Over the true one.
    pub part: f64,
    pub bias: ImuBias,
    /// The state that the corrected sums predict.
    pub predicted: NavState,
    /// Residuals of the true states, each over its own standard deviation.
    pub in_sigmas: Vector9,
    /// The squared length of the whitened residual.
    pub squared: f64,
    pub left: Left,
}

/// Readings summed without their bias.
pub struct Interval {
    pub setting: Setting,
    pub first: NavState,
    pub second: NavState,
    samples: Vec<ImuSample>,
    /// From the first keyframe on; the last one is of all readings.
    parts: Vec<Preintegrated>,
    sqrt_information: Matrix9,
    /// For beliefs from nothing to the most.
    pub curve: Vec<Left>,
    /// The belief, over the true bias, beyond which readings are to be summed again.
    pub again_beyond: Option<f64>,
}

impl Interval {
    /// Sums the readings of a setting.
    pub fn new(setting: Setting) -> Option<Self> {
        let motion = setting.trajectory();
        let [first, second] = [0, setting.steps].map(|step| motion.at(step as f64 * DT).state);
        let samples = setting.readings();
        let parts = summed(&samples, &setting.densities())?;
        let sqrt_information = parts.last()?.sqrt_information().ok()?;
        #[rustfmt::skip]
        let mut interval = Self {
            setting, first, second, samples, parts, sqrt_information,
            curve: Vec::with_capacity(BELIEFS + 1), again_beyond: None,
        };
        for belief in 0..=BELIEFS {
            let left = interval.left(&setting.bias(Self::believed(belief)));
            interval.curve.push(left);
        }
        interval.again_beyond = interval.again_beyond();
        Some(interval)
    }

    /// The belief of a place of the curve.
    pub fn believed(place: usize) -> f64 {
        MOST_BELIEVED * place as f64 / BELIEFS as f64
    }

    /// All readings, summed without a bias.
    pub fn sums(&self) -> &Preintegrated {
        &self.parts[self.parts.len() - 1]
    }

    /// The states that the sums predict on the way from the first keyframe.
    pub fn way<'a>(&'a self, bias: &'a ImuBias) -> impl Iterator<Item = NavState> + 'a {
        let way = self.parts.iter().map(|sums| sums.predict(&self.first, &GRAVITY, bias));
        std::iter::once(self.first).chain(way)
    }

    /// What the sums say with a part of the true bias.
    pub fn believe(&self, part: f64) -> Belief {
        let (sums, bias) = (self.sums(), self.setting.bias(part));
        let residual = imu_residual(sums, &self.first, &self.second, &GRAVITY, &bias);
        Belief {
            part,
            bias,
            predicted: sums.predict(&self.first, &GRAVITY, &bias),
            in_sigmas: residual.component_div(&sums.covariance.diagonal().map(f64::sqrt)),
            squared: (self.sqrt_information * residual).norm_squared(),
            left: self.left(&bias),
        }
    }

    fn left(&self, bias: &ImuBias) -> Left {
        let again = walked(&self.samples, bias);
        let corrected = correct_for_bias(self.sums(), bias);
        let summed = Preintegrated { deltas: again, bias: *bias, ..*self.sums() };
        Left {
            error: (corrected.position - again.position).norm(),
            bound: self.sums().linearization_error_bound(bias).position,
            again: summed.predict(&self.first, &GRAVITY, bias),
        }
    }

    /// Where the bound of what a correction adds to the squared error reaches its limit.
    fn again_beyond(&self) -> Option<f64> {
        let added = |part: f64| {
            self.sums().squared_error_bound(&self.setting.bias(part), &self.sqrt_information)
        };
        let (mut low, mut high) = (0.0, 1024.0);
        if added(high) <= ADDED {
            return None;
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            *(if added(middle) > ADDED { &mut high } else { &mut low }) = middle;
        }
        Some(low)
    }
}

/// The sums of the readings without a bias, from the first one on to the end of each part.
fn summed(samples: &[ImuSample], noise: &ImuNoise) -> Option<Vec<Preintegrated>> {
    let mut integrator = Preintegrator::new(&ImuBias::default(), noise).ok()?;
    let steps = samples.len() - 1;
    let mut parts = Vec::with_capacity(PARTS);
    for (step, pair) in samples.windows(2).enumerate() {
        integrator.integrate_midpoint(&pair[0], &pair[1], DT).ok()?;
        // A part ends where its number of steps is reached.
        if (step + 1) * PARTS / steps > step * PARTS / steps {
            parts.push(integrator.finish().ok()?);
        }
    }
    Some(parts)
}

/// The deltas of readings with a bias: a walk from the origin, at rest, without gravity. It is what summing gives, without
/// the covariance.
fn walked(samples: &[ImuSample], bias: &ImuBias) -> Deltas {
    let mut state = NavState::origin();
    for pair in samples.windows(2) {
        let [start, end] = [&pair[0], &pair[1]].map(|sample| sample.corrected(bias));
        state = state.propagate_midpoint(&start, &end, &Vector3::zeros(), DT);
    }
    let NavState { world_from_body: rotation, velocity, position } = state;
    Deltas { rotation, velocity, position }
}
