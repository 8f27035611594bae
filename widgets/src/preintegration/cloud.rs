//! Where the same motion ends for other flights, whose readings have other noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::inertial::{GRAVITY, ImuBias, ImuSample};

use super::interval::{DT, Interval};

/// How many flights there are, how many are flown in one go, and how many readings each has at most.
const FLIGHTS: usize = 60;
const BIT: usize = 5;
const READINGS: usize = 401;
const NUMBERS: usize = 6 * READINGS;

/// Flights with the same motion.
#[derive(Default)]
pub struct Cloud {
    /// Numbers with mean zero and variance one, six for a reading.
    normal: Vec<f64>,
    /// Motion, steps and noise.
    of: Option<(usize, usize, f64)>,
    /// What a sensor without errors reads.
    perfect: Vec<ImuSample>,
    ends: Vec<[f64; 2]>,
}

impl Cloud {
    /// Flies a few flights with the motion and the noise of an interval; whether some are left.
    pub fn advance(&mut self, interval: &Interval) -> bool {
        self.begin(interval);
        let left = self.normal.chunks(NUMBERS).skip(self.ends.len());
        let ends = left.take(BIT).map(|flight| end(interval, &self.perfect, flight));
        self.ends.extend(ends);
        self.ends.len() < FLIGHTS
    }

    /// Where those that have been flown believe to be at the second keyframe, from where they are, in metres. They know
    /// their bias.
    pub fn ends(&self) -> &[[f64; 2]] {
        &self.ends
    }

    fn begin(&mut self, interval: &Interval) {
        let setting = &interval.setting;
        let of = Some((setting.motion, setting.steps, setting.noise));
        if self.of == of {
            return;
        }
        if self.normal.is_empty() {
            let mut random = ChaCha8Rng::seed_from_u64(1000);
            let normal = |_| -> f64 { StandardNormal.sample(&mut random) };
            self.normal.extend((0..FLIGHTS * NUMBERS).map(normal));
        }
        self.of = of;
        self.perfect = setting.trajectory().samples(&GRAVITY, DT, setting.steps + 1);
        self.ends.clear();
    }
}

fn end(interval: &Interval, perfect: &[ImuSample], normal: &[f64]) -> [f64; 2] {
    let noise = interval.setting.densities();
    let mut normal = normal.iter().copied();
    let mut read = |sample| {
        noise.corrupt(sample, &ImuBias::default(), DT, || normal.next().unwrap_or_default())
    };
    let mut state = interval.first;
    let mut readings = perfect.iter();
    let Some(mut start) = readings.next().map(&mut read) else { return [f64::NAN; 2] };
    for sample in readings {
        let end = read(sample);
        state = state.propagate_midpoint(&start, &end, &GRAVITY, DT);
        start = end;
    }
    let off = state.position - interval.second.position;
    [off.x, off.y]
}
