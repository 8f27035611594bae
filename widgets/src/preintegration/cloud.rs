//! Where the same motion ends for other flights, whose readings have other noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::inertial::{GRAVITY, ImuBias, ImuSample};

use super::interval::{DT, Interval};

/// How many flights there are, and how many readings each has at most.
const FLIGHTS: usize = 60;
const READINGS: usize = 401;
const NUMBERS: usize = 6 * READINGS;

/// Flights with the same motion.
#[derive(Default)]
pub struct Cloud {
    /// Numbers with mean zero and variance one, six for a reading.
    normal: Vec<f64>,
    /// Motion, steps and noise.
    of: Option<(usize, usize, f64)>,
    ends: Vec<[f64; 2]>,
}

impl Cloud {
    /// Where the flights believe to be at the second keyframe, from where they are, in metres. They know their bias.
    pub fn ends(&mut self, interval: &Interval) -> &[[f64; 2]] {
        let setting = &interval.setting;
        let of = Some((setting.motion, setting.steps, setting.noise));
        if self.normal.is_empty() {
            let mut random = ChaCha8Rng::seed_from_u64(1000);
            self.normal.extend(
                (0..FLIGHTS * NUMBERS).map(|_| -> f64 { StandardNormal.sample(&mut random) }),
            );
        }
        if self.of != of {
            self.of = of;
            let perfect = setting.trajectory().samples(&GRAVITY, DT, setting.steps + 1);
            self.ends.clear();
            for flight in self.normal.chunks(NUMBERS) {
                self.ends.push(end(interval, &perfect, flight));
            }
        }
        &self.ends
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
