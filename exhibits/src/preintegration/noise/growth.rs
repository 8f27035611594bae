//! How deviations grow with time.

use nalgebra::{Matrix3, Rotation3, Vector3};
use vislam::inertial::{ImuNoise, ImuSample};
use vislam::manifold::so3;
use vislam::preintegration::{Deltas, Matrix9, Preintegrated, Rule};

use super::oracle::{densities, readings, slopes, summed};
use super::runs::{DT, SECOND, at_rest, of_readings};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::inertial::rules::exponent;
use crate::preintegration::oracle::{STATES, nothing, summed_by};
use crate::random::Random;

/// The error of attitude in the figure of the hinge, in radians, far larger than any worth having.
pub const HINGE_ANGLE: f64 = 0.35;
/// Strength of gravity, in m/s².
pub const G: f64 = 9.81;

pub fn equations(chapter: &mut Chapter) {
    hinge(chapter);
    single_sources(chapter);
    crossover(chapter);
}

/// Takes the deltas at an earlier time and at the end, and the time between. Gives the derivatives
/// of velocity and position at the end by θ at the earlier time.
type Hinge = fn(&Deltas, &Deltas, f64) -> [Matrix3<f64>; 2];

fn hinge(chapter: &mut Chapter) {
    let mutants: [(_, Hinge); 4] = [
        ("sign", |at, end, time| hinged(at, end, time).map(|by_theta| -by_theta)),
        ("hinge at the beginning", |_, end, time| hinged(&nothing(), end, time)),
        ("velocity at the hinge turned too", |at, end, _| hinged(at, end, 0.0)),
        ("in the body", |at, end, time| {
            let back = *at.rotation.inverse().matrix();
            hinged(at, end, time).map(|by_theta| back * by_theta * back.transpose())
        }),
    ];
    chapter.equation("growth-hinge", growth_hinge, hinged, &mutants);
    chapter.counterexample("growth-hinge", "small", turned_by, [1e-4, HINGE_ANGLE]);
}

fn hinged(at: &Deltas, end: &Deltas, time: f64) -> [Matrix3<f64>; 2] {
    let position = end.position - at.position - time * at.velocity;
    [-so3::hat(&(end.velocity - at.velocity)), -so3::hat(&position)]
}

/// The hinge for a turn of this angle.
fn turned_by(angle: f64) -> Comparison {
    let against = "readings summed on from a body that was turned by hand";
    let mut random = Random::new(445);
    let states = (0..STATES).flat_map(|_| {
        let after = readings(&mut random, 15);
        let (at, theta, dt) = (nothing(), random.direction(angle), 0.02);
        let turned = Deltas { rotation: Rotation3::new(theta), ..at };
        let [end, moved] = [at, turned].map(|start| summed(&start, &after, dt));
        let found = [theta.cross(&end.velocity), theta.cross(&end.position)];
        found.into_iter().zip([moved.velocity - end.velocity, moved.position - end.position])
    });
    Comparison::relative(against, 1e-3).each(states, |both| both)
}

fn growth_hinge(formula: Hinge) -> Comparison {
    let against = "readings summed on from a body that was turned by hand, by differences";
    let mut random = Random::new(441);
    let states = (0..STATES).flat_map(|_| {
        let dt = random.logarithmic(0.005..0.1);
        let before = readings(&mut random, 10);
        let after = readings(&mut random, 15);
        let at = summed(&nothing(), &before, dt);
        let end = summed(&at, &after, dt);
        let by_theta = slopes::<3>(|theta| {
            let rotation = Rotation3::new(*theta) * at.rotation;
            summed(&Deltas { rotation, ..at }, &after, dt)
        });
        let found = formula(&at, &end, dt * after.len() as f64);
        found.into_iter().zip([3, 6].map(|row| by_theta.fixed_rows::<3>(row).into_owned()))
    });
    Comparison::relative(against, 1e-7).each(states, |both| both)
}

/// Takes the density, the number of steps and their length. Gives the variance of a component of
/// velocity, its covariance with that of position, and the variance of that.
type Accelerometer = fn(f64, usize, f64) -> [f64; 3];

/// Takes the constant force, the density, the number of steps and their length. Gives the
/// covariances of rotation, velocity and position.
type Gyroscope = fn(&Vector3<f64>, f64, usize, f64) -> [Matrix3<f64>; 3];

fn accelerometer_law(density: f64, steps: usize, dt: f64) -> [f64; 3] {
    let (t, squared) = (steps as f64 * dt, density * density);
    [squared * t, squared * t * t / 2.0, squared * (t.powi(3) / 3.0 - t * dt * dt / 12.0)]
}

/// With what the finite steps take away, as factors of velocity and position.
fn gyroscope_law(force: &Vector3<f64>, density: f64, steps: usize, dt: f64) -> [Matrix3<f64>; 3] {
    let n = steps as f64;
    let velocity = (1.0 - 1.0 / n) * (1.0 - 0.5 / n);
    let position = 1.0 - 2.5 / n + 5.0 / 3.0 / (n * n) - 1.0 / 6.0 / n.powi(4);
    gyroscope_with(&leak(force), density, n * dt, velocity, position)
}

fn gyroscope_with(
    leak: &Matrix3<f64>,
    density: f64,
    t: f64,
    velocity: f64,
    position: f64,
) -> [Matrix3<f64>; 3] {
    let squared = density * density;
    [
        squared * t * Matrix3::identity(),
        squared * t.powi(3) / 3.0 * velocity * leak,
        squared * t.powi(5) / 20.0 * position * leak,
    ]
}

/// As if steps were many and short.
fn many_steps(leak: &Matrix3<f64>, density: f64, steps: usize, dt: f64) -> [Matrix3<f64>; 3] {
    gyroscope_with(leak, density, steps as f64 * dt, 1.0, 1.0)
}

fn leak(force: &Vector3<f64>) -> Matrix3<f64> {
    so3::hat(force) * so3::hat(force).transpose()
}

fn single_sources(chapter: &mut Chapter) {
    let mutants: [(_, Accelerometer); 5] = [
        ("velocity like the time", |s, n, dt| {
            let [v, vp, p] = accelerometer_law(s, n, dt);
            [v * n as f64 * dt, vp, p]
        }),
        ("position like velocity", |s, n, dt| {
            let [v, vp, _] = accelerometer_law(s, n, dt);
            [v, vp, v]
        }),
        ("no covariance", |s, n, dt| {
            let [v, _, p] = accelerometer_law(s, n, dt);
            [v, 0.0, p]
        }),
        ("density not squared", |s, n, dt| accelerometer_law(s.sqrt(), n, dt)),
        ("density for the deviation of a reading", |s, n, dt| {
            accelerometer_law(s * dt.sqrt(), n, dt)
        }),
    ];
    chapter.equation("growth-accelerometer", growth_accelerometer, accelerometer_law, &mutants);
    let [kept, gyro, uneven] = [(0.0, 0.0), (1e-3, 0.0), (0.0, 0.5)];
    chapter.counterexample("growth-accelerometer", "alone", own_noise, [kept, gyro]);
    chapter.counterexample("growth-accelerometer", "equal", own_noise, [kept, uneven]);

    let mutants: [(_, Gyroscope); 5] = [
        ("finite steps forgotten", |f, s, n, dt| many_steps(&leak(f), s, n, dt)),
        ("along the force", |f, s, n, dt| many_steps(&(f * f.transpose()), s, n, dt)),
        ("in all directions", |f, s, n, dt| {
            many_steps(&(f.norm_squared() * Matrix3::identity()), s, n, dt)
        }),
        ("no leak", |_, s, n, dt| many_steps(&Matrix3::zeros(), s, n, dt)),
        ("position like velocity", |f, s, n, dt| {
            let [phi, velocity, _] = gyroscope_law(f, s, n, dt);
            [phi, velocity, velocity]
        }),
    ];
    chapter.equation("growth-gyroscope", growth_gyroscope, gyroscope_law, &mutants);
    let kept = Table { rule: Rule::Euler, uneven: 0.0, accelerometer: 0.0, turn: 0.0, push: 0.0 };
    for (condition, dropped) in [
        ("alone", Table { accelerometer: 1e-3, ..kept }),
        ("still", Table { turn: 1.0, ..kept }),
        ("constant", Table { push: 0.5, ..kept }),
        ("euler", Table { rule: Rule::Midpoint, ..kept }),
        ("equal", Table { uneven: 0.5, ..kept }),
    ] {
        chapter.counterexample("growth-gyroscope", condition, leaked_noise, [kept, dropped]);
    }
}

/// Steps of this mean that are longer and shorter by a share in turns.
fn steps_of(dt: f64, share: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| if k % 2 == 0 { dt * (1.0 + share) } else { dt * (1.0 - share) })
}

/// What the law of the accelerometer says of three blocks of a covariance, and what they are.
fn own_blocks(law: [f64; 3], covariance: &Matrix9) -> [(Matrix3<f64>, Matrix3<f64>); 3] {
    let law = law.map(|value| value * Matrix3::identity());
    [(0, 3, 3), (1, 3, 6), (2, 6, 6)].map(|(k, i, j)| (law[k], block(covariance, i, j)))
}

/// What the law of the gyroscope says of the three diagonal blocks, and what they are.
fn leaked_blocks(
    law: [Matrix3<f64>; 3],
    covariance: &Matrix9,
) -> [(Matrix3<f64>, Matrix3<f64>); 3] {
    [0, 1, 2].map(|k| (law[k], block(covariance, 3 * k, 3 * k)))
}

fn block(covariance: &Matrix9, row: usize, column: usize) -> Matrix3<f64> {
    covariance.fixed_view::<3, 3>(row, column).into_owned()
}

/// The law of the accelerometer, by both rules, with a noise of the gyroscope and with uneven steps.
fn own_noise((gyro, uneven): (f64, f64)) -> Comparison {
    let against = "the recursion over readings that turn and accelerate at random, by both rules";
    let (mut random, count, dt) = (Random::new(446), 20, 0.02);
    let noise = ImuNoise { gyro, ..ImuNoise::mems() };
    let states = [Rule::Euler, Rule::Midpoint].into_iter().flat_map(|rule| {
        let samples = readings(&mut random, count + 1);
        let sums = summed_by(rule, &samples, steps_of(dt, uneven, count), &noise);
        own_blocks(accelerometer_law(noise.accelerometer, count, dt), &sums.covariance)
    });
    Comparison::relative(against, 1e-11).each(states, |both| both)
}

/// A sensor that should lie still: the rule and its steps, the accelerometer's noise, its turn in
/// rad/s, and by what share of itself the force grows in a second.
#[derive(Clone, Copy)]
struct Table {
    rule: Rule,
    uneven: f64,
    accelerometer: f64,
    turn: f64,
    push: f64,
}

/// The law of the gyroscope on such a sensor.
fn leaked_noise(table: Table) -> Comparison {
    let against = "the recursion over the readings of the sensor";
    let (count, dt) = (20, 0.02);
    let noise = ImuNoise { accelerometer: table.accelerometer, ..ImuNoise::mems() };
    let force = Vector3::new(1.0, -2.0, G);
    let samples = (0..=count).map(|k| {
        let accelerometer = (1.0 + table.push * dt * k as f64) * force;
        ImuSample { gyro: table.turn * Vector3::x(), accelerometer }
    });
    let (samples, steps) = (samples.collect::<Vec<_>>(), steps_of(dt, table.uneven, count));
    let sums = summed_by(table.rule, &samples, steps, &noise);
    let states = leaked_blocks(gyroscope_law(&force, noise.gyro, count, dt), &sums.covariance);
    Comparison::relative(against, 1e-11).each(states, |both| both)
}

fn growth_accelerometer(formula: Accelerometer) -> Comparison {
    let against = "the recursion over readings that turn and accelerate at random";
    let mut random = Random::new(442);
    let states = (0..STATES).flat_map(|_| {
        let density = random.logarithmic(1e-4..1e-1);
        let noise = ImuNoise { gyro: 0.0, accelerometer: density, ..ImuNoise::mems() };
        let (steps, dt) = (random.uniform(2.0..60.0) as usize, random.logarithmic(0.001..0.09));
        let sums = of_readings(&readings(&mut random, steps), dt, &noise);
        own_blocks(formula(density, steps, dt), &sums.covariance)
    });
    Comparison::relative(against, 1e-11).each(states, |both| both)
}

fn growth_gyroscope(formula: Gyroscope) -> Comparison {
    let against = "the recursion over equal readings of a body that does not turn";
    let mut random = Random::new(443);
    let states = (0..STATES).flat_map(|_| {
        let density = random.logarithmic(1e-5..1e-2);
        let noise = ImuNoise { gyro: density, accelerometer: 0.0, ..ImuNoise::mems() };
        let (steps, dt) = (random.uniform(3.0..60.0) as usize, random.logarithmic(0.001..0.09));
        let strength = random.uniform(1.0..20.0);
        let accelerometer = random.direction(strength);
        let reading = ImuSample { gyro: Vector3::zeros(), accelerometer };
        let sums = of_readings(&vec![reading; steps], dt, &noise);
        leaked_blocks(formula(&accelerometer, density, steps, dt), &sums.covariance)
    });
    Comparison::relative(against, 1e-11).each(states, |both| both)
}

/// Times at which the gyroscope's part of the deviations of velocity and position, root mean square
/// over the axes, becomes the greater one, at rest under a force of this strength.
type Crossover = fn(&ImuNoise, f64) -> [f64; 2];

pub fn crossovers(noise: &ImuNoise, force: f64) -> [f64; 2] {
    let unit = noise.accelerometer / (force * noise.gyro);
    [3.0 / 2.0_f64.sqrt() * unit, 10.0_f64.sqrt() * unit]
}

fn crossover(chapter: &mut Chapter) {
    let mutants: [(_, Crossover); 4] = [
        ("exchanged", |noise, g| [crossovers(noise, g)[1], crossovers(noise, g)[0]]),
        ("without gravity", |noise, _| crossovers(noise, 1.0)),
        ("squared", |noise, g| crossovers(noise, g).map(|t| t * t)),
        ("sensors exchanged", |noise, g| crossovers(&exchanged(noise), g)),
    ];
    chapter.equation("growth-crossover", growth_crossover, crossovers, &mutants);
}

/// The noise of each sensor with the density of the other.
pub fn exchanged(noise: &ImuNoise) -> ImuNoise {
    ImuNoise { gyro: noise.accelerometer, accelerometer: noise.gyro, ..*noise }
}

fn growth_crossover(formula: Crossover) -> Comparison {
    let against = "the ratio of the two parts at that time, by the recursion in many short steps";
    const STEPS: usize = 4000;
    Comparison::absolute(against, 2e-3, "ratio").over(25, 444, |random| {
        let noise = densities(random, 1e-4..1e-2, 1e-3..1e-1);
        let force = random.uniform(1.0..20.0);
        let reading = ImuSample { gyro: Vector3::zeros(), accelerometer: force * Vector3::z() };
        let ratio = |time: f64, quantity: usize| {
            // A step longer than a gap would be refused.
            let dt = (time / STEPS as f64).min(0.099);
            let sums = |noise| of_readings(&[reading; STEPS], dt, &noise);
            let [own, leaked, _] = sources(&noise).map(|(_, noise)| sums(noise).sigmas()[quantity]);
            leaked / own
        };
        let [velocity, position] = formula(&noise, force);
        ([ratio(velocity, 1), ratio(position, 2)], [1.0, 1.0])
    })
}

/// A source of noise: what it is called, and the sensor that has only this one.
pub fn sources(noise: &ImuNoise) -> [(&'static str, ImuNoise); 3] {
    [
        ("accelerometer", ImuNoise { gyro: 0.0, ..*noise }),
        ("gyroscope", ImuNoise { accelerometer: 0.0, ..*noise }),
        ("both", *noise),
    ]
}

/// The slope of the straight line through the logarithms of the deviations after every step
/// between two times.
fn fitted(noise: &ImuNoise, quantity: usize, from: f64, to: f64) -> f64 {
    let steps = |time: f64| (time / DT).round() as usize;
    let sigma = |n: usize| (n as f64 * DT, at_rest(noise, DT, n).sigmas()[quantity]);
    let (times, sigmas): (Vec<_>, Vec<_>) = (steps(from)..=steps(to)).map(sigma).unzip();
    exponent(&times, &sigmas)
}

/// Between these times, in seconds, exponents are fitted.
const FITTED: [f64; 2] = [0.5, 2.0];

pub fn numbers(chapter: &mut Chapter) {
    table(chapter);
    exponents(chapter);
    times(chapter);
    chapter.number("growth_hinge_angle", HINGE_ANGLE, "rad", 2);
    chapter.number("growth_g", G, "m/s²", 2);
}

/// A deviation, of the first axis or of the third: level or upright.
pub fn sigma(sums: &Preintegrated, at: usize) -> f64 {
    sums.covariance[(at, at)].sqrt()
}

/// Deviations after a second at rest for two sensors, in mrad, cm/s and cm.
fn table(chapter: &mut Chapter) {
    let [mems, euroc] = [ImuNoise::mems(), ImuNoise::euroc()];
    let of = |noise: &ImuNoise| {
        let sums = at_rest(noise, DT, SECOND);
        let [phi, v, p] = sums.sigmas();
        let axis = |at| 1e2 * sigma(&sums, at);
        [1e3 * phi, 1e2 * v, 1e2 * p, axis(3), axis(5), axis(6), axis(8)]
    };
    let [phi, v, p, v_level, v_up, p_level, p_up] = of(&mems);
    chapter.number("growth_mems_phi", phi, "mrad", 2);
    chapter.number("growth_mems_v", v, "cm/s", 2);
    chapter.number("growth_mems_p", p, "cm", 2);
    chapter.number("growth_mems_v_level", v_level, "cm/s", 2);
    chapter.number("growth_mems_v_up", v_up, "cm/s", 2);
    chapter.number("growth_mems_p_level", p_level, "cm", 2);
    chapter.number("growth_mems_p_up", p_up, "cm", 2);
    let [phi, v, p, v_level, v_up, p_level, p_up] = of(&euroc);
    chapter.number("growth_euroc_phi", phi, "mrad", 2);
    chapter.number("growth_euroc_v", v, "cm/s", 3);
    chapter.number("growth_euroc_p", p, "cm", 3);
    chapter.number("growth_euroc_v_level", v_level, "cm/s", 3);
    chapter.number("growth_euroc_v_up", v_up, "cm/s", 3);
    chapter.number("growth_euroc_p_level", p_level, "cm", 3);
    chapter.number("growth_euroc_p_up", p_up, "cm", 3);
    chapter.number("growth_mems_gyro", 1e3 * mems.gyro, "mrad/s/√Hz", 2);
    chapter.number("growth_euroc_gyro", 1e3 * euroc.gyro, "mrad/s/√Hz", 2);
    chapter.number("growth_mems_accelerometer", 1e2 * mems.accelerometer, "cm/s²/√Hz", 1);
    chapter.number("growth_euroc_accelerometer", 1e2 * euroc.accelerometer, "cm/s²/√Hz", 1);
    // By hand, without what finite steps take away.
    chapter.number("growth_leak_v", 1e2 * (G * mems.gyro / 3.0_f64.sqrt()), "cm/s", 2);
    chapter.number("growth_leak_p", 1e2 * G * mems.gyro / 20.0_f64.sqrt(), "cm", 2);
    chapter.number("growth_own_v", 1e2 * mems.accelerometer, "cm/s", 2);
    chapter.number("growth_own_p", 1e2 * mems.accelerometer / 3.0_f64.sqrt(), "cm", 2);
}

fn exponents(chapter: &mut Chapter) {
    let [accelerometer, gyro, both] = sources(&ImuNoise::mems()).map(|(_, noise)| noise);
    let [from, to] = FITTED;
    let fit = |noise: &ImuNoise, quantity| fitted(noise, quantity, from, to);
    chapter.number("growth_fit_from", from, "s", 1);
    chapter.number("growth_fit_to", to, "s", 0);
    chapter.number("growth_fit_accelerometer_v", fit(&accelerometer, 1), "", 2);
    chapter.number("growth_fit_accelerometer_p", fit(&accelerometer, 2), "", 2);
    chapter.number("growth_fit_gyro_phi", fit(&gyro, 0), "", 2);
    chapter.number("growth_fit_gyro_v", fit(&gyro, 1), "", 2);
    chapter.number("growth_fit_gyro_p", fit(&gyro, 2), "", 2);
    chapter.number("growth_fit_both_v", fit(&both, 1), "", 2);
    chapter.number("growth_fit_both_p", fit(&both, 2), "", 2);
    let euroc = ImuNoise::euroc();
    chapter.number("growth_fit_euroc_v", fit(&euroc, 1), "", 2);
    chapter.number("growth_fit_euroc_p", fit(&euroc, 2), "", 2);
    let early = |quantity| fitted(&both, quantity, 0.1, 0.2);
    let late = |quantity| fitted(&both, quantity, 9.0, 10.0);
    chapter.number("growth_early_v", early(1), "", 2);
    chapter.number("growth_late_v", late(1), "", 2);
    chapter.number("growth_early_p", early(2), "", 2);
    chapter.number("growth_late_p", late(2), "", 2);
}

fn times(chapter: &mut Chapter) {
    let [v, p] = crossovers(&ImuNoise::mems(), G);
    chapter.number("growth_cross_mems_v", v, "s", 2);
    chapter.number("growth_cross_mems_p", p, "s", 2);
    let [v, p] = crossovers(&ImuNoise::euroc(), G);
    chapter.number("growth_cross_euroc_v", v, "s", 2);
    chapter.number("growth_cross_euroc_p", p, "s", 2);
    let double = |quantity| {
        let sigma = |seconds| at_rest(&ImuNoise::mems(), DT, seconds * SECOND).sigmas()[quantity];
        sigma(2) / sigma(1)
    };
    chapter.number("growth_twice_p", double(2), "", 2);
    chapter.number("growth_twice_accelerometer", 8.0_f64.sqrt(), "", 2);
    chapter.number("growth_twice_gyro", 32.0_f64.sqrt(), "", 2);
    let [.., minute] = at_rest(&ImuNoise::mems(), DT, 60 * SECOND).sigmas();
    chapter.number("growth_minute_p", minute, "m", 0);
}
