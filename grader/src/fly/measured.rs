//! What the flights of an answer add up to: numbers in which faults show.

use super::flights::{Announced, Graded};
use super::series::{Series, TIMES};

/// One flight of an answer, and what the book's filter makes of the same flight.
#[derive(Debug, Clone)]
pub struct Flown<'a> {
    /// The flight.
    pub flight: &'a Graded,
    /// The answer.
    pub answer: Series,
    /// The filter's.
    pub reference: &'a Series,
}

/// Tilt, yaw and position.
pub const BLOCKS: [&str; 3] = ["tilt", "yaw", "position"];

/// Numbers by [`TIMES`] and [`BLOCKS`].
pub type Table = [[f64; 3]; TIMES.len()];

/// What the flights of an answer add up to. Numbers that a flight lacks are NaN, as are means with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Mean normalized errors squared over the flights with one world.
    pub nees: Table,
    /// How many flights these are.
    pub runs: usize,
    /// Standard deviations as multiples of the filter's: geometric means over the same flights.
    pub sigmas: Table,
    /// Aligned errors as multiples of the filter's: of flights with nothing wrong, with outliers and with a
    /// late clock.
    pub errors: [f64; 3],
    /// Acceleration along the vertical that is not there: its median over flights, in m/s².
    pub falling: f64,
    /// How much the error of the attitude, seen from the body, scatters over a flight: its median, in
    /// radians.
    pub tumbling: f64,
    /// The same as a multiple of the filter's: the geometric mean.
    pub wandering: f64,
    /// The angle between the vertical and what is taken for it: its median at the end, in radians.
    pub tilted: f64,
    /// How much rougher the error of the position is than the filter's, from line to line: the median.
    pub roughness: f64,
    /// The roughest flight in the same measure.
    pub roughest: f64,
    /// The scales less one: their root mean square.
    pub scale: f64,
    /// Distance of the constant turn in the body from none, from that of the camera, and from that twice, in
    /// radians: medians.
    pub turned: [f64; 3],
}

impl Measured {
    /// Of the flights of one answer.
    pub fn of(flown: &[Flown<'_>]) -> Self {
        let whole: Vec<&Flown<'_>> = flown.iter().filter(|one| has_one_world(one.flight)).collect();
        let plain: Vec<&Flown<'_>> = of_kind(&whole, |kind| kind == Announced::Nothing);
        let over = |of: &dyn Fn(&Flown<'_>) -> f64| plain.iter().map(|one| of(one)).collect();
        let errors = |kind: fn(Announced) -> bool| {
            let those = of_kind(&whole, kind);
            geometric(those.iter().map(|one| one.answer.aligned / one.reference.aligned))
        };
        let rough = |one: &Flown<'_>| roughness(&one.answer) / roughness(one.reference);
        let squares: f64 = whole.iter().map(|one| one.answer.scale.powi(2)).sum();
        Self {
            nees: table(
                &whole,
                |one, time, block| one.answer.at(time)?.nees().map(|n| n[block]),
                mean,
            ),
            runs: whole.len(),
            sigmas: table(&whole, ratio, |numbers| geometric(numbers.into_iter())),
            errors: [
                errors(|kind| kind == Announced::Nothing),
                errors(|kind| kind == Announced::Outliers),
                errors(|kind| kind == Announced::LateClock),
            ],
            falling: median(over(&|one| falling(&one.answer))),
            tumbling: median(over(&|one| scatter(&one.answer))),
            wandering: geometric(
                plain.iter().map(|one| scatter(&one.answer) / scatter(one.reference)),
            ),
            tilted: median(over(&|one| tilted(&one.answer))),
            roughness: median(over(&rough)),
            roughest: plain.iter().map(|one| rough(one)).fold(0.0, f64::max),
            scale: (squares / whole.len() as f64).sqrt(),
            turned: [0, 1, 2].map(|power| median(over(&|one| turned(one, power)))),
        }
    }
}

/// Whether position and yaw of a flight can be held against the world of its beginning.
pub fn has_one_world(flight: &Graded) -> bool {
    !matches!(flight.announced, Announced::Gap(_))
}

fn of_kind<'a, 'b>(
    flown: &[&'a Flown<'b>],
    kind: impl Fn(Announced) -> bool,
) -> Vec<&'a Flown<'b>> {
    flown.iter().copied().filter(|one| kind(one.flight.announced)).collect()
}

fn table(
    flown: &[&Flown<'_>],
    of: impl Fn(&Flown<'_>, f64, usize) -> Option<f64>,
    fold: impl Fn(Vec<f64>) -> f64,
) -> Table {
    TIMES.map(|time| {
        [0, 1, 2].map(|block| {
            fold(flown.iter().map(|one| of(one, time, block).unwrap_or(f64::NAN)).collect())
        })
    })
}

fn ratio(one: &Flown<'_>, time: f64, block: usize) -> Option<f64> {
    Some(one.answer.at(time)?.sigmas()[block] / one.reference.at(time)?.sigmas()[block])
}

fn mean(numbers: Vec<f64>) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len() as f64
}

fn geometric(numbers: impl Iterator<Item = f64>) -> f64 {
    mean(numbers.map(f64::ln).collect()).exp()
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let half = numbers.len() / 2;
    match numbers.len() % 2 {
        0 if half > 0 => 0.5 * (numbers[half - 1] + numbers[half]),
        _ => numbers.get(half).copied().unwrap_or(f64::NAN),
    }
}

/// The acceleration of the vertical error by the parabola that fits it best since the body moves.
fn falling(series: &Series) -> f64 {
    let mut normal = nalgebra::Matrix3::zeros();
    let mut right = nalgebra::Vector3::zeros();
    for line in series.lines.iter().filter(|line| line.seconds > super::flights::STAND) {
        let t = line.seconds;
        let row = nalgebra::Vector3::new(1.0, t, 0.5 * t * t);
        normal += row * row.transpose();
        right -= row * line.error().position.z;
    }
    normal.cholesky().map_or(f64::NAN, |factor| factor.solve(&right).z)
}

/// The root mean square of the second difference of the position's error.
pub fn roughness(series: &Series) -> f64 {
    let bends = series.lines.windows(3).map(|lines| {
        let [a, b, c] = [0, 1, 2].map(|at| lines[at].error().position);
        (a - 2.0 * b + c).norm_squared()
    });
    mean(bends.collect()).sqrt()
}

fn scatter(series: &Series) -> f64 {
    series.turn_in_body().1
}

/// The angle between the true vertical and the estimated one at the end.
fn tilted(series: &Series) -> f64 {
    let up = |state: &vislam::inertial::NavState| {
        state.world_from_body.inverse() * nalgebra::Vector3::z()
    };
    series.lines.last().map_or(f64::NAN, |line| up(&line.estimate).angle(&up(&line.truth)))
}

/// How far the constant turn in the body is from a power of the camera's mounting, in radians.
fn turned(one: &Flown<'_>, power: i32) -> f64 {
    let (turn, _) = one.answer.turn_in_body();
    let mounting = one.flight.rig().body_from_camera.rotation.to_rotation_matrix();
    let expected = (0..power).fold(nalgebra::Rotation3::identity(), |turn, _| turn * mounting);
    turn.angle_to(&expected)
}
