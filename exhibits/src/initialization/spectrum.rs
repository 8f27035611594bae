//! What noise leaves of the linear equations.

use nalgebra::{DMatrix, DVector, SMatrix};
use vislam::initialization::LinearAlignment;

use super::exact::Told;
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

const SYSTEMS: usize = 60;
const CAMERAS: usize = 12;
/// Pictures on a path, so many that sums are integrals.
const PICTURES: usize = 400;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Sigma =
        |system, row, bias| system.beyond(row, row / bias).map_or(f64::NAN, |(c, _)| row / c);
    let mutants: [(_, Sigma); 4] = [
        ("the whole column", |system, row, _| row / system.matrix.column(0).norm()),
        ("bias known", |system, row, _| system.beyond(row, 1e6).map_or(f64::NAN, |(c, _)| row / c)),
        ("bias free", |system, row, _| system.beyond(row, 0.0).map_or(f64::NAN, |(c, _)| row / c)),
        ("not the root", |system, row, bias| {
            system.beyond(row, row / bias).map_or(f64::NAN, |(c, _)| row / (c * c))
        }),
    ];
    chapter.equation("scale-information", scale_information, formula, &mutants);

    let mutants: [(_, Beyond); 4] = [
        ("the first centre exact", |jerk, t| jerk * t.powi(3) / (6.0 * 1575_f64.sqrt())),
        ("third derivative not divided by six", |jerk, t| 6.0 * beyond(jerk, t)),
        ("square of the time", |jerk, t| beyond(jerk, t) / t),
        ("largest, not root mean square", |jerk, t| jerk * t.powi(3) / 120.0),
    ];
    chapter.equation("beyond-parabola", beyond_parabola, beyond, &mutants);

    let mutants: [(_, Time); 4] = [
        ("the first centre exact", |of| {
            of.sigma() * 6.0 * 1575_f64.sqrt() / (120.0 * 7_f64.sqrt())
        }),
        ("one picture", |of| of.sigma() * of.pictures.sqrt()),
        ("three axes", |of| of.sigma() / 3_f64.sqrt()),
        ("square of the time", |of| of.sigma() * of.seconds),
    ];
    chapter.equation("scale-time", scale_time, Passed::sigma, &mutants);
    numbers(chapter);
}

/// The standard deviation of the scale from those of a row and of the bias on each axis.
type Sigma = fn(&LinearAlignment, f64, f64) -> f64;

fn scale_information(formula: Sigma) -> Comparison {
    let against = "the inverse of all normal equations";
    Comparison::relative(against, 1e-5).over(SYSTEMS, 61, |random| {
        let system = Told::drawn(random, CAMERAS).system();
        let (row, bias) = (random.logarithmic(1e-3..0.1), random.logarithmic(0.02..0.5));
        let mut rows = system.matrix.clone() / row;
        let known = rows.nrows();
        rows = rows.insert_rows(known, 3, 0.0);
        (0..3).for_each(|axis| rows[(known + axis, 4 + axis)] = 1.0 / bias);
        // By an orthogonal triangle, so that nothing is squared before it has to be.
        let triangle: SMatrix<f64, 10, 10> = rows.qr().r().fixed_view::<10, 10>(0, 0).into_owned();
        let inverse = triangle.try_inverse().unwrap_or(SMatrix::repeat(f64::NAN));
        (formula(&system, row, bias), inverse.row(0).norm())
    })
}

type Beyond = fn(f64, f64) -> f64;

/// How far a path with a constant jerk is from the parabola that is nearest to it.
pub fn beyond(jerk: f64, seconds: f64) -> f64 {
    jerk * seconds.powi(3) / (120.0 * 7_f64.sqrt())
}

fn beyond_parabola(formula: Beyond) -> Comparison {
    let against = "what a fit of three coefficients leaves at ten thousand times";
    Comparison::relative(against, 1e-6).over(SYSTEMS, 62, |random| {
        let (jerk, seconds) = (random.logarithmic(0.1..10.0), random.logarithmic(0.5..10.0));
        let count = 10_000;
        let time = |row: usize| (row as f64 + 0.5) / count as f64;
        let powers = DMatrix::from_fn(count, 3, |row, power| time(row).powi(power as i32));
        let path = DVector::from_fn(count, |row, _| jerk * (seconds * time(row)).powi(3) / 6.0);
        let basis = powers.qr().q();
        let left = &path - &basis * basis.tr_mul(&path);
        (formula(jerk, seconds), left.norm() / (count as f64).sqrt())
    })
}

/// A path of constant jerk, in m/s³ and seconds, and what was seen of it: centres as good as so many metres.
#[derive(Clone, Copy)]
struct Passed {
    jerk: f64,
    seconds: f64,
    pictures: f64,
    centre: f64,
}

impl Passed {
    /// The standard deviation of its scale, as a part of it.
    fn sigma(&self) -> f64 {
        let path = 120.0 * 7_f64.sqrt() * self.centre;
        path / (self.jerk * self.seconds.powi(3) * self.pictures.sqrt())
    }
}

type Time = fn(&Passed) -> f64;

fn scale_time(formula: Time) -> Comparison {
    let against = "the inverse of the normal equations of scale, place, velocity and acceleration";
    Comparison::relative(against, 1e-2).over(SYSTEMS, 63, |random| {
        let of = Passed {
            jerk: random.logarithmic(0.1..10.0),
            seconds: random.logarithmic(0.5..5.0),
            pictures: PICTURES as f64,
            centre: random.logarithmic(1e-3..0.1),
        };
        (formula(&of), of.inverted(random))
    })
}

impl Passed {
    fn inverted(&self, random: &mut Random) -> f64 {
        let (rate, push) = (random.normal(1.0), random.normal(1.0));
        let time = |row: usize| row as f64 / (PICTURES - 1) as f64;
        let rows = DMatrix::from_fn(PICTURES, 4, |row, column| {
            let t = time(row) * self.seconds;
            match column {
                0 => rate * t + 0.5 * push * t * t + self.jerk * t.powi(3) / 6.0,
                power => time(row).powi(power as i32 - 1),
            }
        });
        let triangle: SMatrix<f64, 4, 4> = rows.qr().r().fixed_view::<4, 4>(0, 0).into_owned();
        let inverse = triangle.try_inverse().unwrap_or(SMatrix::repeat(f64::NAN));
        self.centre * inverse.row(0).norm()
    }
}

/// A calm motion, and pictures in a second.
const CALM: Passed = Passed { jerk: 1.0, seconds: 1.0, pictures: 10.0, centre: 0.01 };

fn numbers(chapter: &mut Chapter) {
    chapter.number("calm_jerk", CALM.jerk, "m/s³", 0);
    chapter.number("calm_centre_cm", 100.0 * CALM.centre, "cm", 0);
    chapter.number("calm_rate", CALM.pictures, "1/s", 0);
    let after = |seconds: f64| {
        let of = Passed { seconds, pictures: CALM.pictures * seconds, ..CALM };
        100.0 * of.sigma()
    };
    chapter.number("calm_1", after(1.0), "%", 0);
    chapter.number("calm_2", after(2.0), "%", 0);
    chapter.number("calm_3", after(3.0), "%", 0);
    chapter.number("second_more", after(2.0) / after(3.0), "", 1);
}
