//! Intervals that are joined against intervals that are summed at once.

use approx::assert_abs_diff_eq;
use nalgebra::{Matrix3, SMatrix, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample};
use vislam::manifold::so3;
use vislam::preintegration::{
    Deltas, Matrix9, Matrix9x6, Preintegrated, PreintegrationError, Rule, Vector9,
};

use super::{Random, difference, summed};

const DT: f64 = 0.01;

/// Sums of the same random readings at once, and of their parts between places to split.
fn parts(random: &mut Random, rule: Rule, splits: &[usize]) -> (Preintegrated, Vec<Preintegrated>) {
    let samples = random.motion().samples(&GRAVITY, DT, 101);
    let bias = random.bias(0.1, 0.5);
    let sums = |samples: &[ImuSample]| summed(samples, rule, DT, &bias, &ImuNoise::mems());
    let ends = splits.windows(2).map(|pair| sums(&samples[pair[0]..=pair[1]]));
    (sums(&samples), ends.collect())
}

/// The largest difference: of deltas, of the covariance whitened by the expected one, and of the
/// derivatives by the bias.
fn apart(found: &Preintegrated, expected: &Preintegrated) -> f64 {
    let whiten = expected.sqrt_information().unwrap();
    let whitened = whiten * found.covariance * whiten.transpose() - Matrix9::identity();
    let deltas = difference(&expected.deltas, &found.deltas).amax();
    deltas.max(whitened.amax()).max((found.bias_jacobian - expected.bias_jacobian).amax())
}

const ROUNDING: f64 = 1e-9;

#[test]
fn two_intervals_joined_are_the_interval_summed_at_once() {
    let mut random = Random::new(31);
    for rule in [Rule::Euler, Rule::Midpoint] {
        for split in [1, 2, 13, 50, 98, 99] {
            for _ in 0..10 {
                let (whole, parts) = parts(&mut random, rule, &[0, split, 100]);
                let joined = parts[0].then(&parts[1]).unwrap();
                let error = apart(&joined, &whole);
                assert!(error < ROUNDING, "{rule:?} split at {split}: {error}");
                assert_abs_diff_eq!(joined.duration, whole.duration, epsilon = 1e-14);
                assert_eq!((joined.steps, joined.bias), (whole.steps, whole.bias));
                assert_eq!(joined.greatest_force, whole.greatest_force);
                assert_eq!(joined.covariance, joined.covariance.transpose());
            }
        }
    }
}

#[test]
fn three_intervals_are_joined_in_either_order() {
    let mut random = Random::new(32);
    for _ in 0..100 {
        let (_, parts) = parts(&mut random, Rule::Midpoint, &[0, 20, 55, 100]);
        let [a, b, c] = [parts[0], parts[1], parts[2]];
        let left = a.then(&b).unwrap().then(&c).unwrap();
        let right = a.then(&b.then(&c).unwrap()).unwrap();
        assert!(apart(&left, &right) < ROUNDING);
    }
}

/// (φ, v, p) added to deltas, in their convention.
fn moved(deltas: &Deltas, step: &Vector9) -> Deltas {
    Deltas {
        rotation: so3::retract(&deltas.rotation, &step.fixed_rows::<3>(0).into()),
        velocity: deltas.velocity + step.fixed_rows::<3>(3),
        position: deltas.position + step.fixed_rows::<3>(6),
    }
}

/// How joined deltas move with the first ones and with the later ones, by central differences.
fn transports(first: &Preintegrated, later: &Preintegrated) -> [Matrix9; 2] {
    let t = later.duration;
    let here = first.deltas.then(&later.deltas, t);
    let slopes = |join: &dyn Fn(&Vector9) -> Deltas| {
        Matrix9::from_columns(&std::array::from_fn::<_, 9, _>(|axis| {
            let step = Vector9::ith(axis, 1e-5);
            (difference(&here, &join(&step)) - difference(&here, &join(&-step))) / 2e-5
        }))
    };
    [
        slopes(&|step| moved(&first.deltas, step).then(&later.deltas, t)),
        slopes(&|step| first.deltas.then(&moved(&later.deltas, step), t)),
    ]
}

#[test]
fn errors_are_carried_by_the_slopes_of_the_composition() {
    let mut random = Random::new(33);
    for _ in 0..100 {
        let (_, parts) = parts(&mut random, Rule::Euler, &[0, 40, 100]);
        let [f, g] = transports(&parts[0], &parts[1]);
        // What becomes of six columns at a time when the other interval has none.
        for at in [0, 3] {
            let columns = Matrix9x6::from_fn(|row, column| f64::from(row == column + at));
            let with =
                |sums: &Preintegrated, bias_jacobian| Preintegrated { bias_jacobian, ..*sums };
            let none = Matrix9x6::zeros();
            let by_first = with(&parts[0], columns).then(&with(&parts[1], none)).unwrap();
            let by_later = with(&parts[0], none).then(&with(&parts[1], columns)).unwrap();
            assert_abs_diff_eq!(by_first.bias_jacobian, f * columns, epsilon = 1e-7);
            assert_abs_diff_eq!(by_later.bias_jacobian, g * columns, epsilon = 1e-7);
        }
    }
}

#[test]
fn wrong_transports_miss_by_far_more_than_rounding() {
    let mut random = Random::new(34);
    let (whole, parts) = parts(&mut random, Rule::Midpoint, &[0, 50, 100]);
    let [f, g] = transports(&parts[0], &parts[1]);
    let by = |f: &Matrix9, g: &Matrix9| Preintegrated {
        covariance: f * parts[0].covariance * f.transpose()
            + g * parts[1].covariance * g.transpose(),
        bias_jacobian: f * parts[0].bias_jacobian + g * parts[1].bias_jacobian,
        ..whole
    };
    let without = |m: &Matrix9, row: usize, column: usize| {
        let mut mutant = *m;
        mutant.fixed_view_mut::<3, 3>(row, column).fill(0.0);
        mutant
    };
    let flipped = |m: &Matrix9, row: usize| {
        let mut mutant = *m;
        let block: Matrix3<f64> = m.fixed_view::<3, 3>(row, row).transpose();
        mutant.fixed_view_mut::<3, 3>(row, row).copy_from(&block);
        mutant
    };
    assert!(apart(&by(&f, &g), &whole) < 1e-6, "differences alone are this good");
    for (name, mutant) in [
        ("all transposed", by(&f.transpose(), &g.transpose())),
        ("attitude not turned back", by(&flipped(&f, 0), &g)),
        ("later velocity turned back", by(&f, &flipped(&g, 3))),
        ("later position turned back", by(&f, &flipped(&g, 6))),
        ("no lever of the later velocity", by(&without(&f, 3, 0), &g)),
        ("no lever of the later position", by(&without(&f, 6, 0), &g)),
        ("no velocity times duration", by(&without(&f, 6, 3), &g)),
        ("later errors not turned", by(&f, &Matrix9::identity())),
    ] {
        let error = apart(&mutant, &whole);
        assert!(error > 1e6 * ROUNDING, "{name}: {error}");
    }
}

#[test]
fn intervals_of_other_biases_or_without_steps_are_not_joined() {
    let mut random = Random::new(35);
    let (whole, parts) = parts(&mut random, Rule::Euler, &[0, 50, 100]);
    let bias = ImuBias { gyro: Vector3::x(), ..whole.bias };
    let other = Preintegrated { bias, ..parts[1] };
    let error = parts[0].then(&other).unwrap_err();
    let (first, later) = (whole.bias.vector().into(), bias.vector().into());
    assert_eq!(error, PreintegrationError::BiasesDiffer { first, later });
    assert!(error.to_string().contains(&format!("{first:?}")), "{error}");
    assert!(error.to_string().contains(&format!("{later:?}")), "{error}");
    let empty = Preintegrated { steps: 0, ..parts[1] };
    assert_eq!(parts[0].then(&empty), Err(PreintegrationError::Empty));
    assert_eq!(empty.then(&parts[0]), Err(PreintegrationError::Empty));
    let covariance = SMatrix::repeat(1e308);
    let huge = Preintegrated { covariance, ..parts[0] };
    assert_eq!(huge.then(&huge), Err(PreintegrationError::Overflow { steps: 100 }));
}
