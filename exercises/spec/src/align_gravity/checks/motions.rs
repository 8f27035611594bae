//! Motions of every kind that matters, by formulas.

use nalgebra::{Rotation3, Vector3};

use super::super::View;
use super::descent::{Equations, Free, Minimum};
use crate::draw::Draw;

/// What a camera did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// It accelerated this way and that.
    Lively,
    /// The same, and is known worse than is asked for.
    Blurred,
    /// The same, and is known hardly well enough.
    Barely,
    /// Its acceleration was constant and pointed upwards in part.
    Parabola,
    /// Its acceleration was constant and pointed downwards in part.
    Sinking,
    /// Its acceleration was nearly constant: too nearly to tell one of two scales from the other.
    NearParabola,
    /// Nearly constant, and the wrong scale fits visibly worse.
    OffParabola,
    /// Its acceleration was constant and level.
    Level,
    /// Its velocity was constant.
    Straight,
    /// Its velocity was constant, and the body turned around a camera beside its origin.
    Swung,
    /// It stood.
    Still,
}

impl Kind {
    /// All kinds, with a name for a sentence.
    pub const ALL: [(Self, &'static str); 11] = [
        (Self::Lively, "this way and that"),
        (Self::Blurred, "the same in blurred pictures"),
        (Self::Barely, "the same, known barely well enough"),
        (Self::Parabola, "constant acceleration, upwards"),
        (Self::Sinking, "constant acceleration, downwards"),
        (Self::NearParabola, "nearly constant acceleration"),
        (Self::OffParabola, "not quite constant acceleration"),
        (Self::Level, "constant acceleration, level"),
        (Self::Straight, "straight ahead"),
        (Self::Swung, "straight ahead, turning around a lever"),
        (Self::Still, "at rest"),
    ];

    /// Whether nothing in it fixes the scale.
    pub fn hides_all(self) -> bool {
        matches!(self, Self::Level | Self::Straight | Self::Still)
    }

    /// The name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or("", |(_, name)| name)
    }
}

/// Of what motions are drawn.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// How many views.
    pub views: usize,
    /// How long it lasts, in seconds.
    pub seconds: [f64; 2],
    /// How well centres are known, in metres.
    pub sigma: [f64; 2],
    /// Powers of ten of metres in a unit of the motion.
    pub powers: [f64; 2],
}

/// The range of the public instances.
pub(super) const PUBLIC: Range =
    Range { views: 9, seconds: [1.5, 3.0], sigma: [0.002, 0.006], powers: [-1.0, 1.0] };

/// A motion up to scale and what is asked about it.
#[derive(Debug, Clone)]
pub struct Motion {
    /// What it was.
    pub kind: Kind,
    /// The views.
    pub views: Vec<View>,
    /// The camera in the body, in metres.
    pub lever: Vector3<f64>,
    /// The size of gravity, in m/s².
    pub gravity: f64,
    /// The scale that it was made with.
    pub scale: f64,
    /// The largest standard deviation of a scale.
    pub most: f64,
    /// How much worse than the best a scale may be.
    pub gate: f64,
    /// All minima, negative scales too.
    pub(super) minima: Vec<Minimum>,
}

/// Where a body is over time, in metres.
struct Path {
    velocity: Vector3<f64>,
    acceleration: Vector3<f64>,
    /// Amplitudes, in metres, with frequencies and phases.
    waves: Vec<(Vector3<f64>, f64, f64)>,
}

impl Path {
    /// Where it is, from where it began.
    fn moved(&self, t: f64) -> Vector3<f64> {
        let wave = |(size, rate, phase): &(Vector3<f64>, f64, f64)| {
            size * ((rate * t + phase).sin() - phase.sin())
        };
        let waves: Vector3<f64> = self.waves.iter().map(wave).sum();
        t * self.velocity + 0.5 * t * t * self.acceleration + waves
    }

    /// How fast it is at the beginning.
    fn start(&self) -> Vector3<f64> {
        let wave = |(size, rate, phase): &(Vector3<f64>, f64, f64)| size * (rate * phase.cos());
        self.velocity + self.waves.iter().map(wave).sum::<Vector3<f64>>()
    }
}

impl Motion {
    /// A motion of a kind. What is asked for is answered with a margin.
    pub fn drawn(draw: &mut Draw, kind: Kind, range: Range) -> Self {
        loop {
            let motion = Self::tried(draw, kind, range);
            if motion.is_of_its_kind() {
                return motion;
            }
        }
    }

    fn tried(draw: &mut Draw, kind: Kind, range: Range) -> Self {
        let gravity = draw.uniform(8.0..11.0);
        let down = draw.direction();
        let level = down.cross(&draw.direction()).normalize();
        let path = path(draw, kind, &down, &level, gravity);
        let turns = matches!(kind, Kind::Lively | Kind::Blurred | Kind::Barely | Kind::Swung);
        let turning = if turns { draw.vector(0.5..1.0) } else { Vector3::zeros() };
        let begun = draw.rotation(0.5..2.0);
        let lever = if kind == Kind::Swung { draw.vector(0.3..0.5) } else { draw.vector(0.1..0.2) };
        let scale = 10f64.powf(draw.uniform(range.powers[0]..range.powers[1]));
        let (offset, begin) = (draw.vector(2.0..5.0) / scale, draw.uniform(1.0..3.0));
        let seconds = draw.uniform(range.seconds[0]..range.seconds[1]);
        let noise = draw.uniform(range.sigma[0]..range.sigma[1]);
        let view = |k: usize| {
            let apart = seconds / (range.views - 1) as f64;
            let jitter = if k == 0 { 0.0 } else { draw.uniform(-0.3..0.3) };
            let t = apart * (k as f64 + jitter);
            let motion_from_body = begun * Rotation3::new(t * turning);
            let sigma = noise * draw.uniform(0.4..1.6) / scale;
            let off = if k == 0 { Vector3::zeros() } else { sigma * draw.normals::<3, 1>() };
            let moved = path.moved(t);
            View {
                seconds: begin + t,
                centre: offset + (moved + motion_from_body * lever) / scale + off,
                sigma,
                motion_from_body,
                force_twice: moved - t * path.start() - 0.5 * t * t * gravity * down,
            }
        };
        let views = (0..range.views).map(view).collect();
        let (most, gate) = (draw.uniform(0.06..0.12), draw.uniform(9.0..16.0));
        let minima = Vec::new();
        let mut motion = Self { kind, views, lever, gravity, scale, most, gate, minima };
        motion.minima = motion.equations(Free::All).minima();
        let sigma = match kind {
            Kind::Blurred => Some(draw.uniform(1.4..2.5)),
            Kind::Barely => Some(draw.uniform(0.5..0.75)),
            _ => None,
        };
        if let Some(part) = sigma {
            let sigmas = motion.minima.iter().map(|minimum| minimum.sigma);
            let blurred = part * most / sigmas.fold(f64::INFINITY, f64::min);
            motion.views.iter_mut().for_each(|view| view.sigma *= blurred);
            motion.minima = motion.equations(Free::All).minima();
        }
        motion
    }

    /// The equations of the views.
    pub(super) fn equations(&self, free: Free) -> Equations {
        Equations::of(&self.views, &self.lever, self.gravity, free)
    }

    /// Minima with a scale that is one.
    pub(super) fn candidates(&self) -> Vec<Minimum> {
        self.minima.iter().filter(|minimum| minimum.scale > 0.0).copied().collect()
    }

    /// Those of some minima that fit as well as the best one.
    pub(super) fn fitting(&self, minima: &[Minimum]) -> Vec<Minimum> {
        let best = minima.iter().map(|minimum| minimum.squares).fold(f64::INFINITY, f64::min);
        minima.iter().filter(|minimum| minimum.squares <= best + self.gate).copied().collect()
    }

    /// What is to be found.
    pub(super) fn expected(&self) -> Vec<Minimum> {
        self.unless_unknown(self.fitting(&self.candidates()))
    }

    /// The minima, or none when one of them is known too badly.
    pub(super) fn unless_unknown(&self, minima: Vec<Minimum>) -> Vec<Minimum> {
        let is_known = minima.iter().all(|minimum| minimum.sigma <= self.most);
        if is_known { minima } else { Vec::new() }
    }

    /// Whether it is clear what is to be found, and that is what its kind says.
    fn is_of_its_kind(&self) -> bool {
        let candidates = self.candidates();
        let best = candidates.iter().map(|minimum| minimum.squares).fold(f64::INFINITY, f64::min);
        let worse = |minimum: &Minimum| (minimum.squares - best) / self.gate;
        let fitting = self.fitting(&candidates);
        let is_clear = fitting.iter().all(|m| !(0.8..1.3).contains(&(m.sigma / self.most)))
            && candidates.iter().all(|m| !(0.75..1.4).contains(&worse(m)));
        let (fit, found) = (fitting.len(), self.expected().len());
        let near = |m: &Minimum| (m.scale / self.scale - 1.0).abs() < 6.0 * m.sigma;
        let is_true = found == 0 || fitting.iter().any(near);
        let gap = candidates.iter().map(worse).fold(0.0, f64::max);
        is_clear
            && is_true
            && match self.kind {
                Kind::Lively | Kind::Barely | Kind::Swung => found == 1,
                Kind::Sinking => found == 1 && self.minima.len() == 2,
                Kind::Parabola => found == 2,
                Kind::NearParabola => found == 2 && gap > 0.2,
                Kind::OffParabola => {
                    let all = self.unless_unknown(candidates.clone());
                    found == 1 && all.len() == 2 && gap < 20.0
                }
                Kind::Blurred => fit >= 1 && found == 0,
                Kind::Level | Kind::Straight | Kind::Still => found == 0,
            }
    }
}

/// A path of a kind.
fn path(
    draw: &mut Draw,
    kind: Kind,
    down: &Vector3<f64>,
    level: &Vector3<f64>,
    gravity: f64,
) -> Path {
    let velocity = draw.vector(0.3..1.5);
    let upwards = |draw: &mut Draw| draw.uniform(1.0..3.0) * level - draw.uniform(1.5..4.0) * down;
    let acceleration = match kind {
        Kind::Lively | Kind::Blurred | Kind::Barely => draw.vector(0.5..2.0),
        Kind::Parabola | Kind::NearParabola | Kind::OffParabola => upwards(draw),
        Kind::Sinking => draw.uniform(0.5..2.0) * level + draw.uniform(0.25..0.45) * gravity * down,
        Kind::Level => draw.uniform(1.0..3.0) * level,
        Kind::Straight | Kind::Swung | Kind::Still => Vector3::zeros(),
    };
    let size = match kind {
        Kind::Lively | Kind::Blurred | Kind::Barely => 0.3,
        Kind::NearParabola => 0.01,
        Kind::OffParabola => 0.03,
        _ => 0.0,
    };
    let wave = |_| {
        let size = size * draw.uniform(0.5..1.5) * draw.direction();
        (size, draw.uniform(2.0..4.0), draw.uniform(0.0..6.0))
    };
    let waves = (0..3).map(wave).collect();
    let velocity = if kind == Kind::Still { Vector3::zeros() } else { velocity };
    Path { velocity, acceleration, waves }
}
