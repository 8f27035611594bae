//! One solution, two, or any.

use nalgebra::{DMatrix, DVector, Vector3};
use vislam::inertial::GRAVITY;
use vislam::simulation::Trajectory;

use super::exact::Told;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

const MOTIONS: usize = 60;
const SECONDS: f64 = 2.0;
const CAMERAS: usize = 9;
/// Forward and up, in m/s².
const CLIMB: Vector3<f64> = Vector3::new(1.0, 0.0, 0.5);
/// In m/s and rad/s.
const TURN: (f64, f64) = (1.0, 0.8);

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Other); 5] = [
        ("sign", |s, w, g| s + 2.0 * g.dot(w) / w.norm_squared()),
        ("factor of two dropped", |s, w, g| s - g.dot(w) / w.norm_squared()),
        ("one for s", |_, w, g| 1.0 - 2.0 * g.dot(w) / w.norm_squared()),
        ("by the square of gravity", |s, w, g| s - 2.0 * g.dot(w) / g.norm_squared()),
        ("w in metres", |s, w, g| s - 2.0 * g.dot(w) / (s * w.norm_squared())),
    ];
    chapter.equation("second-scale", second_scale, second, &mutants);

    let eight = Trajectory::figure_eight();
    let climb = Trajectory::constant_acceleration(&CLIMB, eight.angles);
    let turn = Trajectory::level_turn(TURN.0, TURN.1);
    let curved = [Case { motion: eight, knows: BIAS }, Case { motion: climb, knows: BIAS }];
    chapter.counterexample("init-solutions", "curved", any_other, curved);
    let known = Case { motion: turn, knows: BIAS };
    chapter.counterexample(
        "init-solutions",
        "bias",
        any_other,
        [known, Case { knows: NOTHING, ..known }],
    );
    let long = Case { motion: climb, knows: BIAS_AND_LENGTH };
    chapter.counterexample(
        "init-solutions",
        "length",
        one_of_two,
        [long, Case { knows: BIAS, ..long }],
    );
    numbers(chapter);
}

/// Takes the scale, twice the second coefficient of the parabola, in units of the map, and gravity.
type Other = fn(f64, &Vector3<f64>, &Vector3<f64>) -> f64;

fn second(scale: f64, w: &Vector3<f64>, gravity: &Vector3<f64>) -> f64 {
    scale - 2.0 * gravity.dot(w) / w.norm_squared()
}

/// A motion of constant acceleration that may turn, and its acceleration.
fn pushed(random: &mut Random) -> (Told, Vector3<f64>) {
    let level = random.direction(2.0);
    let up = random.uniform(0.3..1.5) * if random.uniform(0.0..1.0) < 0.5 { -1.0 } else { 1.0 };
    let acceleration = Vector3::new(level.x, level.y, up);
    let mut motion =
        Trajectory::constant_acceleration(&acceleration, Trajectory::figure_eight().angles);
    let velocity = random.direction(1.0);
    (0..3).for_each(|axis| motion.position[axis].rate = velocity[axis]);
    let told = Told {
        bias: random.direction(0.2),
        map_from_world: random.rotation(3.0),
        scale: random.logarithmic(0.3..3.0),
        ..Told::plain(motion, SECONDS, CAMERAS)
    };
    (told, acceleration)
}

/// The length of the gravity that fits best for each scale, if the bias is known.
struct Pinned {
    told: Told,
    columns: DMatrix<f64>,
    centres: DVector<f64>,
    right: DVector<f64>,
}

impl Pinned {
    fn new(told: Told) -> Self {
        let system = told.system();
        let bias = system.matrix.columns(4, 3) * told.bias;
        let mut columns = DMatrix::zeros(system.matrix.nrows(), 6);
        columns.columns_mut(0, 3).copy_from(&system.matrix.columns(1, 3));
        columns.columns_mut(3, 3).copy_from(&system.matrix.columns(7, 3));
        let centres = system.matrix.column(0).into_owned();
        Self { told, columns, centres, right: system.right - bias }
    }

    fn gravity(&self, scale: f64) -> Vector3<f64> {
        let right = &self.right - scale * &self.centres;
        let found = self.columns.clone().qr();
        let rotated = found.q().tr_mul(&right);
        let x = found.r().solve_upper_triangular(&rotated);
        x.map_or(Vector3::repeat(f64::NAN), |x| x.fixed_rows::<3>(3).into_owned())
    }

    fn excess(&self, scale: f64) -> f64 {
        self.gravity(scale).norm() - GRAVITY.norm()
    }

    /// The scale at which gravity has its length again, beyond the one where it is shortest.
    fn other(&self) -> f64 {
        let reach = 400.0 * self.told.scale;
        let (mut low, mut high) = (-reach, reach);
        for _ in 0..120 {
            let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if self.excess(left) < self.excess(right) { high = right } else { low = left }
        }
        let least = 0.5 * (low + high);
        let (mut inside, mut outside) = (least, least + 4.0 * (least - self.told.scale));
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if self.excess(middle) < 0.0 { inside = middle } else { outside = middle }
        }
        0.5 * (inside + outside)
    }
}

fn second_scale(formula: Other) -> Comparison {
    let against = "bisection for the scale at which the gravity that fits has its length again";
    Comparison::relative(against, 1e-5).over(MOTIONS, 51, |random| {
        let (told, acceleration) = pushed(random);
        let w = told.map_from_world * acceleration / told.scale;
        let gravity = told.map_from_world * GRAVITY;
        let found = formula(told.scale, &w, &gravity);
        (found, Pinned::new(told).other())
    })
}

/// What is known besides the pictures.
#[derive(Clone, Copy, PartialEq)]
struct Knows {
    bias: bool,
    length: bool,
}

const NOTHING: Knows = Knows { bias: false, length: false };
const BIAS: Knows = Knows { bias: true, length: false };
const BIAS_AND_LENGTH: Knows = Knows { bias: true, length: true };

#[derive(Clone, Copy)]
struct Case {
    motion: Trajectory,
    knows: Knows,
}

impl Case {
    /// Columns of the unknowns, scaled to the length of one, their lengths, and the truth in them.
    fn scaled(&self) -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
        let told = Told::plain(self.motion, SECONDS, CAMERAS);
        let (matrix, truth) = (told.system().matrix, told.truth());
        let unknown = |column: &usize| !(self.knows.bias && (4..7).contains(column));
        let columns: Vec<usize> = (0..10).filter(unknown).collect();
        let chosen = matrix.select_columns(&columns);
        let lengths = DVector::from_fn(columns.len(), |k, _| chosen.column(k).norm());
        let scaled =
            DMatrix::from_fn(chosen.nrows(), columns.len(), |row, k| chosen[(row, k)] / lengths[k]);
        let truth = DVector::from_fn(columns.len(), |k, _| truth[columns[k]]);
        (scaled, lengths, truth)
    }

    /// A solution besides the truth: the truth and, where the equations allow a step, that step.
    fn other(&self) -> DVector<f64> {
        let (scaled, lengths, mut x) = self.scaled();
        let eigen = scaled.tr_mul(&scaled).symmetric_eigen();
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value < FREE {
                x += vector.component_div(&lengths);
            }
        }
        x
    }
}

/// Squares of singular values below it are those of free directions.
const FREE: f64 = 1e-12;

/// The scale of a solution that need not be the truth.
fn any_other(case: Case) -> Comparison {
    Comparison::absolute("the scale of the motion", 1e-3, "").once(case.other()[0], 1.0)
}

/// How far a scale that solves the equations is from the nearest of the two.
fn one_of_two(case: Case) -> Comparison {
    let two = [1.0, second(1.0, &CLIMB, &GRAVITY)];
    let x = case.other();
    let step = x[0] - 1.0;
    let (from, along) = (GRAVITY, (x.fixed_rows::<3>(x.len() - 3) - GRAVITY) / step);
    // As far along the step as gravity may go.
    let allowed =
        if case.knows.length { -2.0 * from.dot(&along) / along.norm_squared() } else { step };
    let scale = 1.0 + allowed;
    let nearest = two.iter().map(|two| (scale - two).abs()).fold(f64::INFINITY, f64::min);
    Comparison::absolute("zero", 1e-3, "").once(nearest, 0.0)
}

/// Level, in m/s².
const PUSH: f64 = 1.0;
/// How well the length of gravity can be read, in m/s².
const READ: f64 = 0.02;

fn numbers(chapter: &mut Chapter) {
    // Gravity is too long by (δs a)² / 2 g for a scale that is too large by δs of it.
    let within = (2.0 * GRAVITY.norm() * READ).sqrt() / PUSH;
    chapter.number("level_push", PUSH, "m/s²", 0);
    chapter.number("level_read", READ, "m/s²", 2);
    chapter.number("level_percent", 100.0 * within, "%", 0);
    chapter.number("turn_speed", TURN.0, "m/s", 0);
    chapter.number("turn_rate", TURN.1, "rad/s", 1);
    chapter.number("turn_bias", 0.1 * TURN.0 * TURN.1, "m/s²", 2);
}
