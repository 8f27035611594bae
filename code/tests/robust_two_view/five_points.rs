//! Five points: how many motions, and which.

use nalgebra::{Isometry3, Matrix3, SMatrix, SVector, Translation3, UnitQuaternion, Vector3};
use vislam::least_squares::Manifold;
use vislam::robust_two_view::{
    FivePointError, RayPair, RelativeMotion, five_points, motions_of_five, real_roots,
};

use super::scenes::{distance, five, motion, number, random, rays, seen_point, vector};

/// The condition number of the five equations, by differences over the manifold.
fn condition(motion: &RelativeMotion, pairs: &[RayPair; 5]) -> f64 {
    let volume =
        |motion: &RelativeMotion, pair: &RayPair| pair.1.dot(&(motion.essential() * pair.0));
    let mut jacobian = SMatrix::<f64, 5, 5>::zeros();
    for axis in 0..5 {
        let moved = |by: f64| {
            let mut step = [0.0; 5];
            step[axis] = by;
            motion.retract(&step)
        };
        let (ahead, behind) = (moved(1e-5), moved(-1e-5));
        for (row, pair) in pairs.iter().enumerate() {
            jacobian[(row, axis)] = (volume(&ahead, pair) - volume(&behind, pair)) / 2e-5;
        }
    }
    let values = jacobian.svd(false, false).singular_values;
    values.max() / values.min()
}

#[test]
fn the_true_motion_is_among_those_of_five_points() {
    let mut random = random(1);
    let mut well_posed = 0;
    for scene in 0..10_000 {
        let pose = motion(&mut random);
        let pairs = five(&mut random, &pose);
        let truth = RelativeMotion::of(&pose).unwrap();
        if condition(&truth, &pairs) < 1e6 {
            well_posed += 1;
            let found = five_points(&pairs).unwrap();
            let error = found.iter().map(|e| distance(e, &truth.essential())).fold(1.0, f64::min);
            assert!(error < 1e-8, "scene {scene}: {error:e}");
        }
    }
    assert!(well_posed > 9_900);
}

#[test]
fn the_true_motion_puts_its_points_in_front_and_not_all_others_do() {
    let mut random = random(2);
    let (mut all, mut in_front) = (0, 0);
    for _ in 0..1000 {
        let pose = motion(&mut random);
        let pairs = five(&mut random, &pose);
        let truth = RelativeMotion::of(&pose).unwrap();
        let motions = motions_of_five(&pairs).unwrap();
        let nearest = motions.iter().map(|found| {
            (found.rotation.matrix() - truth.rotation.matrix()).amax()
                + (found.direction.into_inner() - truth.direction.into_inner()).amax()
        });
        assert!(nearest.fold(1.0, f64::min) < 1e-6);
        all += five_points(&pairs).unwrap().len();
        in_front += motions.len();
    }
    assert!(1000 < in_front && 3 * in_front < 2 * all, "{in_front} of {all}");
}

/// The exponents of x, y and z in the twenty monomials: cubic ones, then all others.
#[rustfmt::skip]
const MONOMIALS: [[i32; 3]; 20] = [
    [3, 0, 0], [2, 1, 0], [1, 2, 0], [0, 3, 0], [2, 0, 1], [1, 1, 1], [0, 2, 1], [1, 0, 2], [0, 1, 2], [0, 0, 3],
    [2, 0, 0], [1, 1, 0], [0, 2, 0], [1, 0, 1], [0, 1, 1], [0, 0, 2], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0],
];

/// What vanishes for an essential matrix.
fn constraints(e: &Matrix3<f64>) -> SVector<f64, 10> {
    let gram = e * e.transpose();
    let traces = 2.0 * gram * e - gram.trace() * e;
    SVector::from_fn(|k, _| if k < 9 { traces[k] } else { e.determinant() })
}

/// How many matrices there are by the eigenvalues of the multiplication by x, and how far the nearest
/// is from being real or from being complex. The cubic forms are interpolated.
fn counted_by_eigenvalues(pairs: &[RayPair; 5]) -> (usize, f64) {
    let mut random = random(3);
    let equations = SMatrix::<f64, 9, 9>::from_fn(|row, k| match pairs.get(row) {
        Some((first, second)) => second[k / 3] * first[k % 3],
        None => 0.0,
    });
    let null = equations.svd(false, true).v_t.unwrap();
    let basis = [5, 6, 7, 8].map(|row| Matrix3::from_row_iterator(null.row(row).iter().copied()));
    let mut values = SMatrix::<f64, 20, 20>::zeros();
    let mut forms = SMatrix::<f64, 20, 10>::zeros();
    for row in 0..20 {
        let place = vector(&mut random);
        let power = |exponents: [i32; 3]| {
            (0..3).map(|axis| place[axis].powi(exponents[axis])).product::<f64>()
        };
        values.set_row(row, &SVector::<f64, 20>::from(MONOMIALS.map(power)).transpose());
        let matrix = place.x * basis[0] + place.y * basis[1] + place.z * basis[2] + basis[3];
        forms.set_row(row, &constraints(&matrix).transpose());
    }
    let coefficients = values.lu().solve(&forms).unwrap().transpose();
    let cubic = coefficients.fixed_columns::<10>(0).into_owned();
    let rest = cubic.lu().solve(&coefficients.fixed_columns::<10>(10).into_owned()).unwrap();
    let mut action = SMatrix::<f64, 10, 10>::zeros();
    for (row, from) in [(0, 0), (1, 1), (2, 2), (3, 4), (4, 5), (5, 7)] {
        action.set_row(row, &-rest.row(from));
    }
    for (row, to) in [(6, 0), (7, 1), (8, 3), (9, 6)] {
        action[(row, to)] = 1.0;
    }
    let eigenvalues = action.complex_eigenvalues();
    let imaginary = eigenvalues.map(|value| value.im.abs() / (1.0 + value.norm()));
    let real = imaginary.iter().filter(|part| **part < 1e-5).count();
    let doubt = imaginary.iter().map(|part| (part.max(1e-12).log10() + 5.0).abs());
    (real, doubt.fold(f64::INFINITY, f64::min))
}

#[test]
fn there_are_as_many_motions_as_real_eigenvalues() {
    let mut random = random(4);
    let mut compared = 0;
    for scene in 0..1000 {
        let pose = motion(&mut random);
        let pairs = five(&mut random, &pose);
        let (count, doubt) = counted_by_eigenvalues(&pairs);
        // Two solutions that nearly meet are two or none by rounding.
        if doubt > 2.0 {
            compared += 1;
            assert_eq!(five_points(&pairs).unwrap().len(), count, "scene {scene}");
        }
    }
    assert!(compared > 900, "{compared}");
}

#[test]
fn five_points_of_a_plane_still_have_few_motions() {
    let mut random = random(5);
    for _ in 0..200 {
        let pose = motion(&mut random);
        let normal = Vector3::new(0.2 * number(&mut random), 0.2 * number(&mut random), 1.0);
        let pairs = [(); 5].map(|()| {
            let point = seen_point(&mut random, &pose);
            let in_plane = point * (4.0 / normal.dot(&point));
            let ray = rays(&pose, &in_plane);
            if ray.1.z > 0.0 { ray } else { rays(&pose, &point) }
        });
        let truth = RelativeMotion::of(&pose).unwrap().essential();
        let found = five_points(&pairs).unwrap();
        assert!(found.iter().any(|matrix| distance(matrix, &truth) < 1e-6));
    }
}

#[test]
fn degenerate_samples_are_refused_by_name() {
    let mut random = random(6);
    for _ in 0..100 {
        let pose = motion(&mut random);
        let pairs = five(&mut random, &pose);

        let mut repeated = pairs;
        repeated[3] = (2.0 * pairs[1].0, pairs[1].1);
        assert_eq!(five_points(&repeated), Err(FivePointError::Repeated { first: 1, second: 3 }));

        let (from, along) = (Vector3::new(0.1, 0.2, 5.0), 0.4 * vector(&mut random));
        let mut collinear = pairs;
        for (k, pair) in collinear.iter_mut().take(4).enumerate() {
            *pair = rays(&pose, &(from + (k as f64 - 1.5) * along));
        }
        assert_eq!(five_points(&collinear), Err(FivePointError::Collinear));

        let turn = Isometry3::from_parts(Translation3::identity(), pose.rotation);
        let turned = pairs.map(|(first, _)| rays(&turn, &first));
        assert_eq!(five_points(&turned), Err(FivePointError::PureRotation));
        let still = pairs.map(|(first, _)| (first, 3.0 * first));
        assert_eq!(five_points(&still), Err(FivePointError::PureRotation));

        for broken in [f64::NAN, f64::INFINITY] {
            let mut wrong = pairs;
            wrong[2].1.y = broken;
            assert_eq!(five_points(&wrong), Err(FivePointError::Ray { pair: 2 }));
        }
        let mut zero = pairs;
        zero[4].0 = Vector3::zeros();
        assert_eq!(motions_of_five(&zero), Err(FivePointError::Ray { pair: 4 }));
    }
}

#[test]
fn rays_of_any_length_give_the_same_matrices() {
    let mut random = random(7);
    let pose = motion(&mut random);
    let pairs = five(&mut random, &pose);
    let longer = pairs.map(|(first, second)| (7.0 * first, 0.1 * second));
    let (one, other) = (five_points(&pairs).unwrap(), five_points(&longer).unwrap());
    assert_eq!(one.len(), other.len());
    for a in one.iter() {
        assert!(other.iter().any(|b| distance(a, b) < 1e-9));
    }
}

/// The product of two polynomials.
fn times<const N: usize>(polynomial: &[f64; N], factor: &[f64]) -> [f64; N] {
    let mut product = [0.0; N];
    for (k, times) in factor.iter().enumerate() {
        (k..N).for_each(|power| product[power] += times * polynomial[power - k]);
    }
    product
}

/// The polynomial with these roots.
fn with_roots<const N: usize>(roots: &[f64]) -> [f64; N] {
    let one = std::array::from_fn(|k| if k == 0 { 1.0 } else { 0.0 });
    roots.iter().fold(one, |product, root| times(&product, &[-root, 1.0]))
}

#[test]
fn real_roots_are_those_that_were_multiplied() {
    let mut random = random(8);
    for _ in 0..1000 {
        let mut roots: Vec<f64> = (0..6).map(|_| 3.0 * number(&mut random)).collect();
        roots.sort_by(f64::total_cmp);
        if roots.windows(2).any(|pair| pair[1] - pair[0] < 1e-2) {
            continue;
        }
        // Times two quadratic factors without a real root.
        let quadratic = [[1.3, 1.0, 1.0], [2.3, 1.0, 1.0]];
        let polynomial = quadratic.iter().fold(with_roots::<11>(&roots), |of, by| times(&of, by));
        let mut found = real_roots(&polynomial).to_vec();
        found.sort_by(f64::total_cmp);
        assert_eq!(found.len(), roots.len());
        for (found, root) in found.iter().zip(&roots) {
            assert!((found - root).abs() < 1e-7, "{found} {root}");
        }
    }
}

/// All three and four of thirteen places, in order, also those that are the same.
fn each_of_three_and_four(mut each: impl FnMut(&[f64])) {
    let places = |from: usize| (from..13).map(|k| (k, 0.37 * (k as f64 - 6.0)));
    for (i, a) in places(0) {
        for (j, b) in places(i) {
            for (k, c) in places(j) {
                each(&[a, b, c]);
                places(k).for_each(|(_, d)| each(&[a, b, c, d]));
            }
        }
    }
}

#[test]
fn where_the_slope_vanishes_there_is_no_root() {
    let roots = |coefficients: [f64; 4]| real_roots(&coefficients).to_vec();
    // What was in its memory before is no part of a list.
    let mut emptied = real_roots(&[-1.0, 1.0, 0.0, 0.0]);
    emptied.pop();
    assert_eq!(emptied, real_roots(&[1.0, 0.0, 0.0, 0.0]));
    assert_eq!(format!("{emptied:?}"), "[]");
    assert_eq!(roots([-15.0, 2.0, 1.0, 0.0]), [-5.0, 3.0]);
    assert_eq!(roots([-36.0, 0.0, 1.0, 1.0]), [3.0]);
    assert_eq!(roots([161.0, -33.0, -1.0, 1.0]), [-7.0]);
}

#[test]
fn roots_at_which_the_sign_does_not_change_are_found_and_hide_no_others() {
    let check = |found: Vec<f64>, expected: &[f64]| {
        let mut found = found;
        found.sort_by(f64::total_cmp);
        assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
        let are_near = found.iter().zip(expected).all(|(found, root)| (found - root).abs() < 1e-4);
        assert!(are_near, "{found:?} {expected:?}");
    };
    each_of_three_and_four(|roots| {
        let mut expected = roots.to_vec();
        expected.dedup();
        check(real_roots(&with_roots::<5>(roots)).to_vec(), &expected);
    });
    check(real_roots(&[0.0, 0.0, 1.0]).to_vec(), &[0.0]);
    check(real_roots(&[1.0, 2.0, 1.0]).to_vec(), &[-1.0]);
    check(real_roots(&[1.0, -2.0, 1.0]).to_vec(), &[1.0]);
    check(real_roots(&[0.0, 0.0, -5.0, 1.0]).to_vec(), &[0.0, 5.0]);
    check(real_roots(&[-20.0, -16.0, -1.0, 1.0]).to_vec(), &[-2.0, 5.0]);
    check(real_roots(&[-8.0, 12.0, -6.0, 1.0]).to_vec(), &[2.0]);
}

#[test]
fn polynomials_without_real_roots_or_without_meaning_have_none() {
    assert!(real_roots(&[1.0, 0.0, 1.0]).is_empty());
    assert!(real_roots(&[0.0; 4]).is_empty());
    assert!(real_roots(&[2.0]).is_empty());
    assert!(real_roots(&[1.0, f64::NAN, 1.0]).is_empty());
    assert_eq!(real_roots(&[-6.0, 3.0, 0.0]).to_vec(), [2.0]);
}

#[test]
fn a_relative_motion_moves_as_its_local_step_says() {
    let mut random = random(9);
    for _ in 0..200 {
        let [one, other] = [(), ()].map(|()| RelativeMotion::of(&motion(&mut random)).unwrap());
        let mut step = [0.0; 5];
        one.local(&other, &mut step);
        let there = one.retract(&step);
        assert!((there.rotation.matrix() - other.rotation.matrix()).amax() < 1e-12);
        assert!((there.direction.into_inner() - other.direction.into_inner()).amax() < 1e-12);

        let mut jacobian = SMatrix::<f64, 5, 5>::zeros();
        one.local_jacobian(&other, jacobian.as_mut_slice());
        for axis in 0..5 {
            let local = |by: f64| {
                let mut moved = [0.0; 5];
                moved[axis] = by;
                let mut step = SVector::<f64, 5>::zeros();
                one.local(&other.retract(&moved), step.as_mut_slice());
                step
            };
            let slope = (local(1e-5) - local(-1e-5)) / 2e-5;
            assert!((slope - jacobian.column(axis)).amax() < 1e-6 * (1.0 + slope.amax()));
        }
    }
}

#[test]
fn a_motion_without_a_baseline_has_no_direction() {
    let turn = Isometry3::from_parts(Translation3::identity(), UnitQuaternion::identity());
    assert_eq!(RelativeMotion::of(&turn), None);
}
