//! A vehicle in the plane and a filter with a fault, flown many times.

use std::fmt::Write as _;

use nalgebra::{Matrix4, RowVector4, Vector4};

use super::super::{Campaign, Fault, Report};
use super::{quantile, readable};
use crate::draw::Draw;

/// What was done to a filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Injected {
    /// Nothing.
    Nothing,
    /// The noise of a step is believed to be too small.
    TooQuiet,
    /// The noise of a step is believed to be too large.
    TooLoud,
    /// The bias does not enter the velocity.
    BiasDropped,
    /// The velocity does not enter the position.
    VelocityDropped,
    /// Clones have no cross-covariance.
    LoneClones,
}

const INJECTED: [Injected; 6] = [
    Injected::Nothing,
    Injected::TooQuiet,
    Injected::TooLoud,
    Injected::BiasDropped,
    Injected::VelocityDropped,
    Injected::LoneClones,
];

impl Injected {
    /// The verdict that is right.
    pub fn fault(self) -> Fault {
        match self {
            Self::Nothing => Fault::None,
            Self::TooQuiet | Self::TooLoud => Fault::Density,
            Self::BiasDropped | Self::VelocityDropped => Fault::Transition,
            Self::LoneClones => Fault::Clones,
        }
    }
}

/// A campaign and what was done to its filter.
#[derive(Debug, Clone)]
pub struct Flown {
    /// What an answer is given.
    pub campaign: Campaign,
    /// With which probability a consistent filter may be called faulty.
    pub outside: f64,
    pub(super) injected: Injected,
    /// What the numbers of the campaign would be with infinitely many runs.
    expected: Vec<f64>,
}

impl Flown {
    /// So many campaigns of each fault and of none, in any order.
    pub fn all(draw: &mut Draw, each: usize) -> Vec<Self> {
        let mut all: Vec<Self> = INJECTED
            .iter()
            .flat_map(|injected| vec![*injected; each])
            .map(|injected| Self::drawn(draw, injected))
            .collect();
        draw.shuffle(&mut all);
        all
    }

    /// A campaign that is what it is by a clear margin.
    fn drawn(draw: &mut Draw, injected: Injected) -> Self {
        loop {
            let flown = Vehicle::drawn(draw, injected).flown(draw);
            if flown.is_telling() {
                return flown;
            }
        }
    }

    /// Whether numbers that should be one pass as such, and numbers that should be far from it do
    /// not. Of a filter without a fault one is a little off, as happens.
    fn is_telling(&self) -> bool {
        let degrees = 2 * self.campaign.runs;
        let numbers = self.numbers();
        let family = self.outside / numbers.len() as f64;
        let between = |outside: f64| {
            let end = |below| quantile(below, degrees) / degrees as f64;
            let (low, high) = (end(0.5 * outside), end(1.0 - 0.5 * outside));
            move |mean: f64| low < mean && mean < high
        };
        let (narrow, wide, single) =
            (between(2.0 * family), between(0.1 * family), between(self.outside));
        let clear = numbers.iter().zip(&self.expected).all(|(mean, expected)| {
            let off = expected.ln().abs();
            (off > 0.03 || narrow(*mean)) && (off < 0.35 || !wide(*mean))
        });
        let clean = self.injected.fault() == Fault::None;
        clear && (!clean || numbers.iter().any(|mean| !single(*mean)))
    }

    fn numbers(&self) -> Vec<f64> {
        let numbers = |report: &Report| {
            let errors = [report.position, report.velocity, report.bias];
            errors.into_iter().chain(report.displacement)
        };
        self.campaign.reports.iter().flat_map(numbers).collect()
    }

    /// The reports, in lines.
    pub(super) fn table(&self) -> String {
        let heads = ["steps", "displacements", "position", "velocity", "bias", "displacement"];
        let mut text = heads.map(|head| format!("{head:>14}")).concat() + "\n";
        for report in &self.campaign.reports {
            let Report { steps, displacements, position, velocity, bias, displacement } = *report;
            let last = displacement.map_or_else(|| "none".to_owned(), readable);
            let [position, velocity, bias] = [position, velocity, bias].map(readable);
            let _ = writeln!(
                text,
                "{steps:>14}{displacements:>14}{position:>14}{velocity:>14}{bias:>14}{last:>14}"
            );
        }
        text
    }
}

/// A vehicle and a filter along one axis. Errors are those of position, velocity, bias and clone.
#[derive(Debug, Clone, Copy)]
struct Vehicle {
    injected: Injected,
    outside: f64,
    runs: usize,
    dt: f64,
    /// Steps from one displacement to the next.
    interval: usize,
    /// What a step adds to the variance of the velocity.
    noise: f64,
    /// Variances at the start.
    position: f64,
    bias: f64,
    /// Variance of a displacement as measured.
    displacement: f64,
}

const MEASURED: RowVector4<f64> = RowVector4::new(1.0, 0.0, 0.0, -1.0);

impl Vehicle {
    /// One whose bias matters after an interval as much as its noise or a little more, and does not
    /// after a step, and which has lost its position then about as much as it ever knew it.
    fn drawn(draw: &mut Draw, injected: Injected) -> Self {
        let (dt, interval) = (draw.uniform(0.02..0.04), draw.index(150..250));
        let duration = dt * interval as f64;
        let noise = dt * draw.uniform(0.01..0.1).powi(2);
        let share = draw.uniform(2.0..4.0);
        let bias = share * noise / (dt * dt * interval as f64);
        let wandered = noise / dt * duration.powi(3) * (1.0 / 3.0 + share / 4.0);
        Self {
            injected,
            outside: draw.uniform(0.02..0.1),
            runs: draw.index(300..500),
            dt,
            interval,
            noise,
            position: wandered * draw.uniform(0.7..1.2),
            bias,
            displacement: wandered * draw.uniform(0.01..0.05),
        }
    }

    fn flown(self, draw: &mut Draw) -> Flown {
        let mut filter = Filter::new(self, draw);
        let mut expected = Vec::new();
        let mut reports = Vec::new();
        let first = [1, self.interval / 4, self.interval / 2, self.interval];
        for steps in first {
            filter.predict(steps - filter.steps, draw);
            reports.push(filter.report(None, &mut expected));
        }
        for displacements in 0..3 {
            if displacements > 0 {
                filter.clone_position();
                filter.predict(self.interval, draw);
            }
            let innovation = filter.correct(draw);
            reports.push(filter.report(Some(innovation), &mut expected));
        }
        let campaign = Campaign { runs: self.runs, reports };
        Flown { campaign, outside: self.outside, injected: self.injected, expected }
    }

    /// What a step makes of the errors.
    fn transition(&self, bias: f64, velocity: f64) -> Matrix4<f64> {
        let mut transition = Matrix4::identity();
        (transition[(0, 1)], transition[(1, 2)]) = (velocity * self.dt, bias * self.dt);
        transition
    }
}

/// The square of a number and what it should be in the mean.
#[derive(Clone, Copy)]
struct Square {
    mean: f64,
    expected: f64,
}

/// The filter of all runs: what it believes, what is so, and the errors.
struct Filter {
    vehicle: Vehicle,
    believed: Matrix4<f64>,
    actual: Matrix4<f64>,
    /// Two for each run.
    errors: Vec<Vector4<f64>>,
    steps: usize,
    displacements: usize,
}

impl Filter {
    fn new(vehicle: Vehicle, draw: &mut Draw) -> Self {
        let known = Vector4::new(vehicle.position, 0.0, vehicle.bias, 0.0);
        let errors =
            (0..2 * vehicle.runs).map(|_| known.map(|variance| variance.sqrt() * draw.normal()));
        let errors = errors.collect();
        let known = Matrix4::from_diagonal(&known);
        let mut filter =
            Self { vehicle, believed: known, actual: known, errors, steps: 0, displacements: 0 };
        filter.clone_position();
        filter
    }

    /// Steps, each of which integrates a reading.
    fn predict(&mut self, steps: usize, draw: &mut Draw) {
        let Vehicle { injected, noise, dt, .. } = self.vehicle;
        let (velocity, bias, power) = match injected {
            Injected::TooQuiet => (1.0, 1.0, 1),
            Injected::TooLoud => (1.0, 1.0, -1),
            Injected::BiasDropped => (1.0, 0.0, 0),
            Injected::VelocityDropped => (0.0, 1.0, 0),
            Injected::Nothing | Injected::LoneClones => (1.0, 1.0, 0),
        };
        let right = self.vehicle.transition(1.0, 1.0);
        let wrong = self.vehicle.transition(bias, velocity);
        let (mut whole, mut added) = (Matrix4::identity(), Matrix4::zeros());
        for _ in 0..steps {
            self.believed = wrong * self.believed * wrong.transpose();
            self.believed[(1, 1)] += noise * dt.powi(power);
            added = right * added * right.transpose();
            added[(1, 1)] += noise;
            whole = right * whole;
        }
        self.actual = whole * self.actual * whole.transpose() + added;
        // Noise of many steps is that of two numbers, in which position and velocity are correlated.
        let velocity = added[(1, 1)].sqrt();
        let along = added[(0, 1)] / velocity;
        let across = (added[(0, 0)] - along * along).max(0.0).sqrt();
        for error in &mut self.errors {
            let (a, b) = (draw.normal(), draw.normal());
            *error = whole * *error + Vector4::new(along * a + across * b, velocity * a, 0.0, 0.0);
        }
        self.steps += steps;
    }

    /// Uses a displacement. Gives its NIS.
    fn correct(&mut self, draw: &mut Draw) -> Square {
        let variance = self.vehicle.displacement;
        let of = |covariance: &Matrix4<f64>| {
            (MEASURED * covariance * MEASURED.transpose())[0] + variance
        };
        let (believed, actual) = (of(&self.believed), of(&self.actual));
        let gain = self.believed * MEASURED.transpose() / believed;
        let rest = Matrix4::identity() - gain * MEASURED;
        let joseph = |covariance: &Matrix4<f64>| {
            rest * covariance * rest.transpose() + variance * gain * gain.transpose()
        };
        (self.believed, self.actual) = (joseph(&self.believed), joseph(&self.actual));
        let mut squares = 0.0;
        for error in &mut self.errors {
            let innovation = (MEASURED * *error)[0] + variance.sqrt() * draw.normal();
            *error -= innovation * gain;
            squares += innovation * innovation;
        }
        self.displacements += 1;
        let mean = squares / (self.errors.len() as f64 * believed);
        Square { mean, expected: actual / believed }
    }

    fn clone_position(&mut self) {
        let mut copy = Matrix4::identity();
        (copy[(3, 0)], copy[(3, 3)]) = (1.0, 0.0);
        self.errors.iter_mut().for_each(|error| *error = copy * *error);
        let carried = |covariance: &Matrix4<f64>| copy * covariance * copy.transpose();
        (self.believed, self.actual) = (carried(&self.believed), carried(&self.actual));
        if self.vehicle.injected == Injected::LoneClones {
            self.believed.fixed_view_mut::<3, 1>(0, 3).fill(0.0);
            self.believed.fixed_view_mut::<1, 3>(3, 0).fill(0.0);
        }
    }

    fn nees(&self, which: usize) -> Square {
        let believed = self.believed[(which, which)];
        let squares: f64 = self.errors.iter().map(|error| error[which] * error[which]).sum();
        Square {
            mean: squares / (self.errors.len() as f64 * believed),
            expected: self.actual[(which, which)] / believed,
        }
    }

    fn report(&self, innovation: Option<Square>, expected: &mut Vec<f64>) -> Report {
        let [position, velocity, bias] = [0, 1, 2].map(|which| self.nees(which));
        let squares = [position, velocity, bias].into_iter().chain(innovation);
        expected.extend(squares.map(|square| square.expected));
        Report {
            steps: self.steps,
            displacements: self.displacements,
            position: position.mean,
            velocity: velocity.mean,
            bias: bias.mean,
            displacement: innovation.map(|square| square.mean),
        }
    }
}
