//! What the picture of an interval shows is what the library computes, and its controls do what they say.

use approx::assert_relative_eq;
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, StampedSample};
use vislam::preintegration::{
    Preintegrated, Rule, correct_for_bias, imu_residual, preintegrate_stamped,
};
use vislam::simulation::Trajectory;
use widgets::preintegration::Preintegration;
use widgets::{Player, Session, Shape, Style, Widget};

const ROTATION: &str = "σ of the rotation";
const VELOCITY: &str = "σ of the velocity";
const POSITION: &str = "σ of the position";
const LARGEST: &str = "Largest of the nine residuals";
const SQUARED: &str = "Squared whitened residual, nine on average";
const LEFT: &str = "Left of the position by first order";
const BOUND: &str = "Bound on what is left";
const AGAIN: &str = "Sum again beyond a move of";

/// The panel of the second keyframe.
const END: u8 = 0;

fn shown(settings: &[(&str, f64)]) -> impl Fn(&str) -> f64 + use<> {
    let mut session = Session::<Preintegration>::with(settings).expect("controls");
    let readings = session.readings();
    move |label| {
        let found = readings.iter().find(|(known, _)| *known == label);
        found.unwrap_or_else(|| panic!("no reading {label}")).1
    }
}

fn summed(samples: &[ImuSample], bias: &ImuBias) -> Preintegrated {
    let stamped = |(at, sample): (usize, &ImuSample)| StampedSample {
        nanoseconds: 5_000_000 * at as i64,
        sample: *sample,
    };
    let stamped: Vec<_> = samples.iter().enumerate().map(stamped).collect();
    preintegrate_stamped(&stamped, Rule::Midpoint, 0.1, bias, &ImuNoise::mems()).unwrap()
}

fn about(axis: Vector3<f64>, rate: f64) -> ImuBias {
    ImuBias { gyro: rate * axis, ..ImuBias::default() }
}

/// What the correction leaves of the position in millimetres, for a second of perfect readings.
fn left_of_perfect(motion: &Trajectory, bias: &ImuBias) -> f64 {
    let samples = motion.samples(&GRAVITY, 0.005, 201);
    let (sums, again) = (summed(&samples, &ImuBias::default()), summed(&samples, bias));
    1e3 * (correct_for_bias(&sums, bias).position - again.deltas.position).norm()
}

#[test]
fn at_the_start_it_shows_what_the_library_computes() {
    let (motion, bias) = (Trajectory::figure_eight(), about(Vector3::x(), 0.1));
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut samples = motion.samples(&GRAVITY, 0.005, 201);
    for sample in &mut samples {
        let normal = || StandardNormal.sample(&mut random);
        *sample = ImuNoise::mems().corrupt(sample, &bias, 0.005, normal);
    }
    let (sums, again) = (summed(&samples, &ImuBias::default()), summed(&samples, &bias));
    let [first, second] = [0.0, 1.0].map(|time| motion.at(time).state);
    let residual = imu_residual(&sums, &first, &second, &GRAVITY, &bias);
    let information = sums.covariance.try_inverse().unwrap();
    let sigmas = sums.covariance.diagonal().map(f64::sqrt);
    let error = correct_for_bias(&sums, &bias).position - again.deltas.position;
    let bound = sums.linearization_error_bound(&bias).position;

    let shown = shown(&[]);
    let close = |label: &str, wanted: f64| {
        assert_relative_eq!(shown(label), wanted, max_relative = 1e-9);
    };
    close("Steps summed", 200.0);
    close(ROTATION, 1e3 * sums.sigmas()[0]);
    close(VELOCITY, 1e2 * sums.sigmas()[1]);
    close(POSITION, 1e2 * sums.sigmas()[2]);
    close(LARGEST, residual.component_div(&sigmas).amax());
    close(SQUARED, residual.dot(&(information * residual)));
    close(LEFT, 1e3 * error.norm());
    close(BOUND, 1e3 * bound);
    let farthest = shown(AGAIN);
    for (part, again) in [(0.999, false), (1.001, true)] {
        let moved = about(Vector3::x(), 1e-3 * part * farthest);
        assert_eq!(sums.should_reintegrate(&moved, 0.01), again);
    }
}

#[test]
fn with_little_noise_it_leaves_what_is_left_of_perfect_readings() {
    let motions = [
        Trajectory::figure_eight(),
        Trajectory::level_turn(1.0, 0.5),
        Trajectory::turn_on_the_spot(0.5),
    ];
    for (motion, trajectory) in motions.iter().enumerate() {
        for (axis, direction) in [Vector3::x(), Vector3::z()].into_iter().enumerate() {
            let left = shown(&[
                ("motion", motion as f64),
                ("axis", axis as f64),
                ("gyro", 20.0),
                ("noise", 0.05),
            ])(LEFT);
            let wanted = left_of_perfect(trajectory, &about(direction, 0.02));
            assert!((left - wanted).abs() < 0.02 * wanted + 1e-3, "{left} and {wanted} mm");
        }
    }
}

#[test]
fn the_true_states_fit_the_true_bias_and_no_other() {
    let [none, half, whole, more] =
        [0.0, 0.5, 1.0, 1.5].map(|believed| shown(&[("believed", believed)]));
    for reading in [LARGEST, SQUARED] {
        assert!(none(reading) > half(reading) && half(reading) > whole(reading));
        assert!(more(reading) > whole(reading));
    }
    assert!(whole(LARGEST) < 3.0 && none(LARGEST) > 10.0);
    assert!(none(LEFT) < 1e-9);
}

#[test]
fn the_squared_residual_is_nine_on_average() {
    const DRAWS: usize = 400;
    let mut session = Session::<Preintegration>::new();
    session.set("gyro", 0.0);
    let squared = |draw: usize| {
        session.set("other", draw as f64);
        let readings = session.readings();
        readings.iter().find(|(label, _)| *label == SQUARED).unwrap().1
    };
    let mean = (0..DRAWS).map(squared).sum::<f64>() / DRAWS as f64;
    // Four standard deviations of a mean of so many.
    assert!((mean - 9.0).abs() < 4.0 * (18.0 / DRAWS as f64).sqrt(), "{mean}");
}

#[test]
fn what_is_left_grows_with_the_square_of_the_move() {
    for axis in [0.0, 1.0] {
        let [one, two] = [50.0, 100.0].map(|gyro| shown(&[("gyro", gyro), ("axis", axis)]));
        let ratio = two(LEFT) / one(LEFT);
        assert!((3.6..4.4).contains(&ratio), "{ratio}");
    }
}

#[test]
fn twice_the_time_leaves_about_sixteen_times_as_much() {
    // A turn on the spot about its own axis leaves nothing.
    for (motion, axis) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0), (2.0, 0.0)] {
        let left =
            |seconds| shown(&[("seconds", seconds), ("motion", motion), ("axis", axis)])(LEFT);
        for seconds in [0.25, 0.5, 1.0] {
            let ratio = left(2.0 * seconds) / left(seconds);
            assert!((12.0..22.0).contains(&ratio), "{ratio}");
        }
    }
}

#[test]
fn a_bias_of_the_accelerometer_alone_is_corrected_exactly() {
    let moved = shown(&[("gyro", 0.0), ("force", 0.5), ("believed", 1.5)]);
    assert!(moved(LEFT) < 1e-9 && moved(BOUND) == 0.0 && moved(AGAIN).is_nan());
    let both = shown(&[("force", 0.5)]);
    assert!(both(BOUND) > shown(&[])(BOUND));
}

#[test]
fn sigmas_grow_with_time_and_in_proportion_to_the_noise() {
    for sigma in [ROTATION, VELOCITY, POSITION] {
        let [short, long] = [0.5, 1.0].map(|seconds| shown(&[("seconds", seconds)])(sigma));
        assert!(long > 1.3 * short, "{sigma}");
        let [quiet, loud] = [0.1, 0.2].map(|noise| shown(&[("noise", noise)])(sigma));
        assert_relative_eq!(loud, 2.0 * quiet, max_relative = 1e-2);
    }
    let [quiet, loud] = [0.1, 1.0].map(|noise| shown(&[("noise", noise)])(AGAIN));
    assert!(quiet < 0.5 * loud);
}

/// The places of the first mark of this shape and style in a panel.
fn drawn(numbers: &[f64], mark: [f64; 3]) -> Vec<[f64; 2]> {
    let mut rest = &numbers[Preintegration::FACE.readings.len()..];
    while let [shape, panel, style, _, count, after @ ..] = rest {
        let (places, later) = after.split_at(*count as usize);
        if [*shape, *panel, *style] == mark {
            return places.chunks(2).map(|place| [place[0], place[1]]).collect();
        }
        rest = later;
    }
    panic!("nothing is drawn as {mark:?}");
}

/// Whether a place is inside a closed line around the origin that goes counterclockwise.
fn is_inside(line: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let left_of =
        |[a, b]: [[f64; 2]; 2]| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) >= 0.0;
    line.windows(2).all(|pair| left_of([pair[0], pair[1]]))
}

#[test]
fn other_flights_end_where_the_ellipse_says() {
    let mut session = Session::<Preintegration>::new();
    for (seconds, motion) in [(0.5, 0.0), (1.0, 1.0), (2.0, 0.0), (2.0, 2.0)] {
        session.set("seconds", seconds);
        session.set("motion", motion);
        assert!(session.advance(), "all flights at once are too much for a picture of the screen");
        let numbers = session.numbers();
        let ends = drawn(numbers, [Shape::Discs as u8, END, Style::Faint as u8].map(f64::from));
        let ellipse = drawn(numbers, [Shape::Line as u8, END, Style::Ink as u8].map(f64::from));
        let inside = |scale: f64| {
            let inside = ends.iter().filter(|end| is_inside(&ellipse, end.map(|at| at / scale)));
            inside.count() as f64 / ends.len() as f64
        };
        // Of a normal distribution in the plane, 39 % are within one standard deviation and 99 % within three.
        assert!((0.22..0.56).contains(&inside(1.0 / 3.0)), "{}", inside(1.0 / 3.0));
        assert!(inside(1.0) > 0.93, "{}", inside(1.0));
    }
}

#[test]
fn cells_are_symmetric_and_join_velocity_and_position() {
    let mut session = Session::<Preintegration>::new();
    session.set("motion", 2.0);
    let numbers = session.numbers();
    let cells = drawn(numbers, [Shape::PaleCells as u8, 3, Style::First as u8].map(f64::from));
    for [column, row] in &cells {
        assert!(cells.contains(&[*row, *column]));
    }
    for axis in [4.0, 5.0, 6.0] {
        assert!(cells.contains(&[axis, axis + 3.0]));
    }
}

#[test]
fn the_bound_holds_and_no_number_is_missing_at_the_ends_of_all_controls() {
    let mut session = Session::<Preintegration>::new();
    let ends: Vec<Vec<f64>> = Preintegration::FACE
        .controls
        .iter()
        .map(|control| {
            let mut ends = vec![control.least, control.start, control.most];
            ends.dedup();
            ends
        })
        .collect();
    let count: usize = ends.iter().map(Vec::len).product();
    for combination in 0..count {
        let mut rest = combination;
        // The count comes last, since every other change sets it back.
        for (control, ends) in Preintegration::FACE.controls.iter().zip(&ends) {
            session.set(control.name, ends[rest % ends.len()]);
            rest /= ends.len();
        }
        let readings = session.readings();
        let at = |label: &str| readings.iter().find(|(known, _)| *known == label).unwrap().1;
        for (label, value) in &readings {
            let missing = *label == AGAIN && at(BOUND) == 0.0;
            assert!(value.is_finite() || missing, "{label}: {value} {:?}", session.controls());
        }
        assert!(at(LEFT) <= at(BOUND) + 1e-9, "{:?} {readings:?}", session.controls());
    }
}

#[test]
fn the_same_controls_show_the_same_whatever_came_before() {
    let fresh = Session::<Preintegration>::new().numbers().to_vec();
    let mut session = Session::<Preintegration>::new();
    let mut longest = 0;
    for update in 0..1000 {
        let control = &Preintegration::FACE.controls[update % 7];
        let part = (update * 37 % 101) as f64 / 100.0;
        session.set(control.name, control.least + part * (control.most - control.least));
        longest = longest.max(session.numbers().len());
    }
    assert!(longest < 3000, "{longest}");
    for control in Preintegration::FACE.controls {
        session.set(control.name, control.start);
    }
    let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(session.numbers()), bits(&fresh));
}
