//! Wrong answers to [`align_gravity`](crate::align_gravity).

use exercise_spec::align_gravity::*;
use nalgebra::{DMatrix, DVector, Matrix3, Matrix6, Rotation3, Vector3};
use vislam::manifold::so3;

use super::Wrong;
use crate::align_gravity as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    level: right::level,
    rest_covariance: right::rest_covariance,
    second_stand: right::second_stand,
    at_scale: right::at_scale,
    scales: right::scales,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let mut wrong = attitudes();
    wrong.extend(covariances());
    wrong.extend(stands());
    wrong.extend(fits());
    wrong.extend(sizes());
    // Some mistakes can be made in several functions.
    let place = |wrong: &Wrong| {
        MISCONCEPTIONS.iter().position(|known| known.name == wrong.misconception.name)
    };
    wrong.sort_by_key(place);
    wrong
}

fn attitudes() -> Vec<Wrong> {
    let level_is =
        |misconception, level| Wrong::new(misconception, Functions { level, ..REFERENCE });
    vec![
        level_is(&FORCE_POINTS_DOWN, |force, heading| right::level(-force, heading)),
        level_is(&TRANSPOSED, |force, heading| right::level(force, heading).inverse()),
        level_is(&HEADING_IN_BODY, |force, heading| right::level(force, 0.0) * about_z(heading)),
        level_is(&LEAST_ROTATION, |force, heading| {
            let least = Rotation3::rotation_between(&force, &Vector3::z());
            about_z(heading) * least.unwrap_or_default()
        }),
        level_is(&UPRIGHT_ALWAYS, |force, heading| {
            let pitch = (-force.x).atan2(force.y.hypot(force.z));
            let roll = (force.y / force.z).atan();
            Rotation3::from_euler_angles(roll, pitch, heading)
        }),
    ]
}

fn about_z(heading: f64) -> Rotation3<f64> {
    Rotation3::new(heading * Vector3::z())
}

fn covariances() -> Vec<Wrong> {
    let covariance_is = |misconception, rest_covariance| {
        Wrong::new(misconception, Functions { rest_covariance, ..REFERENCE })
    };
    vec![
        covariance_is(&TILT_IN_WORLD, |rotation, bias, noise, gravity| {
            let mut world = Matrix6::identity();
            world.fixed_view_mut::<3, 3>(0, 0).copy_from(rotation.matrix());
            world * right::rest_covariance(rotation, bias, noise, gravity) * world.transpose()
        }),
        covariance_is(&INDEPENDENT, |rotation, bias, noise, gravity| {
            apart(&right::rest_covariance(rotation, bias, noise, gravity))
        }),
        covariance_is(&NOT_OVER_GRAVITY, |rotation, bias, noise, _| {
            right::rest_covariance(rotation, bias, noise, 1.0)
        }),
        covariance_is(&LENGTH_IGNORED, |rotation, bias, noise, gravity| {
            let prior = Matrix3::from_diagonal(&bias.component_mul(&bias));
            spread(&up_of(&rotation), &prior, noise, gravity)
        }),
        covariance_is(&ACROSS_UNTOUCHED, |rotation, bias, noise, gravity| {
            let prior = Matrix3::from_diagonal(&bias.component_mul(&bias));
            let up = up_of(&rotation);
            let along = up * up.transpose();
            let across = Matrix3::identity() - along;
            let (height, noise_square) = (up.dot(&(prior * up)), noise * noise);
            let left = height * noise_square / (height + noise_square);
            spread(&up, &(across * prior * across + left * along), noise, gravity)
        }),
        covariance_is(&TURNED_THE_OTHER_WAY, |rotation, bias, noise, gravity| {
            let covariance = right::rest_covariance(rotation, bias, noise, gravity);
            2.0 * apart(&covariance) - covariance
        }),
        covariance_is(&SIGMAS_NOT_SQUARED, |rotation, bias, noise, gravity| {
            right::rest_covariance(rotation, bias.map(f64::sqrt), noise.sqrt(), gravity)
        }),
    ]
}

fn up_of(rotation: &Rotation3<f64>) -> Vector3<f64> {
    rotation.inverse() * Vector3::z()
}

/// The covariance without what tilt and bias have in common.
fn apart(covariance: &Matrix6<f64>) -> Matrix6<f64> {
    let mut apart = *covariance;
    apart.fixed_view_mut::<3, 3>(0, 3).fill(0.0);
    apart.fixed_view_mut::<3, 3>(3, 0).fill(0.0);
    apart
}

/// The joint covariance for a covariance of the bias after the stand.
fn spread(up: &Vector3<f64>, bias: &Matrix3<f64>, noise: f64, gravity: f64) -> Matrix6<f64> {
    let tilt = so3::hat(up) / gravity;
    let mut covariance = Matrix6::zeros();
    let forces = bias + noise * noise * Matrix3::identity();
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&(tilt * forces * tilt.transpose()));
    covariance.fixed_view_mut::<3, 3>(0, 3).copy_from(&(tilt * bias));
    covariance.fixed_view_mut::<3, 3>(3, 0).copy_from(&(bias * tilt.transpose()));
    covariance.fixed_view_mut::<3, 3>(3, 3).copy_from(bias);
    covariance
}

fn stands() -> Vec<Wrong> {
    let second_is = |misconception, second_stand| {
        Wrong::new(misconception, Functions { second_stand, ..REFERENCE })
    };
    vec![
        second_is(&INDEPENDENT, |known, turn, force, noise, gravity| {
            let known = Known { covariance: apart(&known.covariance), ..known };
            right::second_stand(known, turn, force, noise, gravity)
        }),
        second_is(&TURNED_THE_OTHER_WAY, |known, turn, force, noise, gravity| {
            // A tilt of the other sign has this covariance, and the tilt that comes back is the other one.
            let covariance = 2.0 * apart(&known.covariance) - known.covariance;
            let known = Known { covariance, ..known };
            let (tilt, bias) = right::second_stand(known, turn, force, noise, gravity);
            (-tilt, bias)
        }),
        second_is(&SIGMAS_NOT_SQUARED, |known, turn, force, noise, gravity| {
            right::second_stand(known, turn, force, noise.sqrt(), gravity)
        }),
        second_is(&TURN_INVERTED, |known, turn, force, noise, gravity| {
            right::second_stand(known, turn.inverse(), force, noise, gravity)
        }),
        second_is(&BIAS_TURNED_ALONG, |known, turn, force, noise, gravity| {
            // As if the sensor had stayed and the force were seen from the first stand.
            right::second_stand(known, Rotation3::identity(), turn * force, noise, gravity)
        }),
    ]
}

fn fits() -> Vec<Wrong> {
    let fit_is =
        |misconception, at_scale| Wrong::new(misconception, Functions { at_scale, ..REFERENCE });
    vec![
        fit_is(&SIGMAS_NOT_SQUARED, |views, lever, gravity, scale| {
            let roots = with(views, |view, _| view.sigma = view.sigma.sqrt());
            right::at_scale(roots, lever, gravity, scale)
        }),
        fit_is(&HALF_FORGOTTEN, |views, lever, gravity, scale| {
            let fit = right::at_scale(views, lever, 2.0 * gravity, scale);
            Fit { gravity: 0.5 * fit.gravity, ..fit }
        }),
        fit_is(&GRAVITY_UPWARDS, |views, lever, gravity, scale| {
            let fit = right::at_scale(views, lever, gravity, scale);
            Fit { gravity: -fit.gravity, ..fit }
        }),
        fit_is(&LEVER_FORGOTTEN, |views, _, gravity, scale| {
            right::at_scale(views, Vector3::zeros(), gravity, scale)
        }),
        fit_is(&FIRST_VIEW_FORGOTTEN, |mut views, lever, gravity, scale| {
            views[0].centre = Vector3::zeros();
            right::at_scale(views, lever, gravity, scale)
        }),
        fit_is(&FIRST_VIEW_FORGOTTEN, |mut views, lever, gravity, scale| {
            views[0].seconds = 0.0;
            right::at_scale(views, lever, gravity, scale)
        }),
        fit_is(&FIRST_VIEW_FORGOTTEN, |views, lever, gravity, scale| {
            let swung = with(views, |view, first| {
                view.force_twice += first.motion_from_body * lever;
            });
            right::at_scale(swung, lever, gravity, scale)
        }),
        fit_is(&GRAVITY_FREE, |views, lever, _, scale| {
            let (velocity, gravity, squares) = free_at(&views, &lever, scale);
            Fit { velocity, gravity, squares }
        }),
        fit_is(&RESCALED, |views, lever, size, scale| {
            let (velocity, gravity, squares) = free_at(&views, &lever, scale);
            Fit { velocity, gravity: gravity * (size / gravity.norm()), squares }
        }),
    ]
}

fn sizes() -> Vec<Wrong> {
    let scales_are =
        |misconception, scales| Wrong::new(misconception, Functions { scales, ..REFERENCE });
    let fit_is =
        |misconception, at_scale| Wrong::new(misconception, Functions { at_scale, ..REFERENCE });
    vec![
        scales_are(&RESCALED, |views, lever, gravity, most, _| {
            let (size, part) = free_size(&views, &lever);
            let scale = 1.0 / size;
            let fit = right::at_scale(views, lever, gravity, scale);
            let Fit { velocity, gravity, .. } = fit;
            let solution = Solution { scale, sigma: part, velocity, gravity };
            if scale > 0.0 && part <= most { vec![solution] } else { Vec::new() }
        }),
        fit_is(&WEIGHTS_FORGOTTEN, |views, lever, gravity, scale| {
            let equal = with(views, |view, _| view.sigma = 1.0);
            right::at_scale(equal, lever, gravity, scale)
        }),
        fit_is(&NOISE_IN_METRES, |views, lever, gravity, scale| {
            let fit = right::at_scale(views, lever, gravity, scale);
            Fit { squares: scale * scale * fit.squares, ..fit }
        }),
        scales_are(&NOISE_IN_METRES, |views, lever, gravity, _, _| {
            // The true scale is within what a scan for it leaves open.
            let squares = |scale: f64| {
                let fit = right::at_scale(views.clone(), lever, gravity, scale);
                scale * scale * fit.squares
            };
            let scale = least(&squares);
            let Fit { velocity, gravity, .. } =
                right::at_scale(views.clone(), lever, gravity, scale);
            vec![Solution { scale, sigma: 0.0, velocity, gravity }]
        }),
        scales_are(&SECOND_LOST, |views, lever, gravity, most, gate| {
            let mut found = right::scales(views, lever, gravity, most, gate);
            found.truncate(1);
            found
        }),
        scales_are(&SECOND_LOST, |views, lever, gravity, most, gate| {
            let mut found = right::scales(views, lever, gravity, most, gate);
            found.split_off(found.len().saturating_sub(1))
        }),
        scales_are(&GATE_IGNORED, |views, lever, gravity, most, _| {
            right::scales(views, lever, gravity, most, f64::INFINITY)
        }),
        scales_are(&NEGATIVE_KEPT, |views, lever, gravity, most, gate| {
            // A motion that is mirrored has the negative scales.
            let mirrored = with(views.clone(), |view, first| {
                view.centre = 2.0 * first.centre - view.centre;
            });
            let all = |views: &Vec<View>, sign: f64| -> Vec<(f64, Solution)> {
                let (far, any) = (f64::INFINITY, f64::INFINITY);
                let found = right::scales(views.clone(), lever, gravity, far, any);
                let squares = |solution: Solution| {
                    let fit = right::at_scale(views.clone(), lever, gravity, solution.scale);
                    (fit.squares, Solution { scale: sign * solution.scale, ..solution })
                };
                found.into_iter().map(squares).collect()
            };
            let mut found = all(&mirrored, -1.0);
            found.extend(all(&views, 1.0));
            let best = found.iter().map(|(squares, _)| *squares).fold(f64::INFINITY, f64::min);
            found.retain(|(squares, _)| *squares <= best + gate);
            let is_known = found.iter().all(|(_, solution)| solution.sigma <= most);
            let found = found.into_iter().map(|(_, solution)| solution);
            if is_known { found.collect() } else { Vec::new() }
        }),
        scales_are(&NEVER_REFUSED, |views, lever, gravity, _, gate| {
            right::scales(views, lever, gravity, f64::INFINITY, gate)
        }),
        scales_are(&ABSOLUTE_SIGMA, |views, lever, gravity, most, gate| {
            let mut found = right::scales(views, lever, gravity, f64::INFINITY, gate);
            for solution in &mut found {
                solution.sigma *= solution.scale;
            }
            let is_known = found.iter().all(|solution| solution.sigma <= most);
            if is_known { found } else { Vec::new() }
        }),
    ]
}

/// The views with all but the first changed, with a look at that one.
fn with(mut views: Vec<View>, change: impl Fn(&mut View, &View)) -> Vec<View> {
    let first = views[0];
    views[1..].iter_mut().for_each(|view| change(view, &first));
    views
}

/// The linear equations for velocity and gravity over the scale, and for one over the scale, without a
/// length of gravity.
fn free_equations(views: &[View], lever: &Vector3<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let (first, others) = (&views[0], &views[1..]);
    let mut system = DMatrix::zeros(3 * others.len(), 7);
    let mut right = DVector::zeros(3 * others.len());
    for (k, view) in others.iter().enumerate() {
        let t = view.seconds - first.seconds;
        let swung = view.motion_from_body * lever - first.motion_from_body * lever;
        let carried = view.force_twice + swung;
        for axis in 0..3 {
            let row = 3 * k + axis;
            system[(row, axis)] = t / view.sigma;
            system[(row, 3 + axis)] = 0.5 * t * t / view.sigma;
            system[(row, 6)] = carried[axis] / view.sigma;
            right[row] = (view.centre - first.centre)[axis] / view.sigma;
        }
    }
    (system, right)
}

/// Velocity, gravity of any length, and the sum of squares at a scale.
fn free_at(views: &[View], lever: &Vector3<f64>, scale: f64) -> (Vector3<f64>, Vector3<f64>, f64) {
    let (system, right) = free_equations(views, lever);
    let right = right - system.column(6) / scale;
    let system = system.columns(0, 6).into_owned();
    let inverse = (system.tr_mul(&system)).try_inverse().unwrap_or_default();
    let found = inverse * system.tr_mul(&right);
    let squares = (&system * &found - right).norm_squared();
    let part = |from| scale * found.fixed_rows::<3>(from).into_owned();
    (part(0), part(3), squares)
}

/// One over the scale, and its standard deviation as a part of it.
fn free_size(views: &[View], lever: &Vector3<f64>) -> (f64, f64) {
    let (system, right) = free_equations(views, lever);
    let inverse = system.tr_mul(&system).try_inverse().unwrap_or(DMatrix::zeros(7, 7));
    let found = &inverse * system.tr_mul(&right);
    (found[6], inverse[(6, 6)].sqrt() / found[6])
}

/// Where a function of a positive number is least: from factor to factor, then by thirds.
fn least(of: &dyn Fn(f64) -> f64) -> f64 {
    let step = 1.02f64;
    let scanned = (-700..700).map(|k| step.powi(k));
    let around = scanned.min_by(|a, b| of(*a).total_cmp(&of(*b))).unwrap_or(1.0);
    let (mut low, mut high) = (around / step, around * step);
    for _ in 0..120 {
        let third = (high - low) / 3.0;
        if of(low + third) < of(high - third) { high -= third } else { low += third }
    }
    0.5 * (low + high)
}
