//! Wrong answers to [`first_estimates`](crate::first_estimates).

use exercise_spec::first_estimates::*;
use nalgebra::{DMatrix, Rotation2, Vector2};

use super::Wrong;
use crate::first_estimates as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    free_directions: right::free_directions,
    linearized: right::linearized,
    one_trajectory: right::one_trajectory,
    lost: right::lost,
    restored: right::restored,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let mut wrong = directions();
    wrong.extend(equations());
    wrong.extend(choices());
    wrong.extend(verdicts());
    wrong.extend(rows());
    wrong
}

fn directions() -> Vec<Wrong> {
    let directions_are = |misconception, free_directions| {
        Wrong::new(misconception, Functions { free_directions, ..REFERENCE })
    };
    vec![
        directions_are(&ONLY_HEADINGS_TURN, |poses, landmarks, steps| {
            let count = poses.len();
            let mut directions = right::free_directions(poses, landmarks, steps);
            let is_heading = |row: usize| row < 3 * count && row.is_multiple_of(3);
            let turn = directions.column_mut(2);
            turn.into_iter()
                .enumerate()
                .filter(|(row, _)| !is_heading(*row))
                .for_each(|(_, it)| *it = 0.0);
            directions
        }),
        directions_are(&LANDMARKS_STAY, |poses, landmarks, steps| {
            let (first, count) = (3 * poses.len(), 2 * landmarks.len());
            let mut directions = right::free_directions(poses, landmarks, steps);
            directions.view_mut((first, 2), (count, 1)).fill(0.0);
            directions
        }),
        directions_are(&ABOUT_THE_FIRST_POSE, |mut poses, mut landmarks, steps| {
            let centre = poses[0].position;
            poses.iter_mut().for_each(|pose| pose.position -= centre);
            landmarks.iter_mut().for_each(|landmark| *landmark -= centre);
            right::free_directions(poses, landmarks, steps)
        }),
        directions_are(&TURNED_BACK, |mut poses, landmarks, steps| {
            poses.iter_mut().for_each(|pose| pose.position.neg_mut());
            let landmarks = landmarks.into_iter().map(|landmark| -landmark).collect();
            right::free_directions(poses, landmarks, steps)
        }),
        directions_are(&STEPS_IN_THE_WORLD, |poses, landmarks, _| {
            right::free_directions(poses, landmarks, Steps::World)
        }),
        // The same mistake in another function.
        Wrong::new(
            &STEPS_IN_THE_WORLD,
            Functions {
                linearized: |window, points, _| right::linearized(window, points, Steps::World),
                ..REFERENCE
            },
        ),
        directions_are(&ROTATION_INVERTED, |poses, landmarks, steps| {
            let mut directions = right::free_directions(poses.clone(), landmarks, Steps::World);
            for (k, pose) in poses.iter().enumerate().filter(|_| steps == Steps::Body) {
                let mut step = directions.fixed_view_mut::<2, 3>(3 * k + 1, 0);
                let turned = Rotation2::new(pose.heading) * step.clone_owned();
                step.copy_from(&turned);
            }
            directions
        }),
    ]
}

fn equations() -> Vec<Wrong> {
    let linearized_is = |misconception, linearized| {
        Wrong::new(misconception, Functions { linearized, ..REFERENCE })
    };
    vec![
        linearized_is(&HEADING_SLOPE, |window, points, steps| {
            let (mut rows, residual) = right::linearized(window.clone(), points, steps);
            let mut row = 0;
            for measurement in &window.measurements {
                let (pose, size) = match measurement.what {
                    What::Seen { pose, .. } => (pose, 2),
                    What::Moved { from, .. } => (from, 3),
                };
                rows.view_mut((row, 3 * pose), (2, 1)).neg_mut();
                row += size;
            }
            (rows, residual)
        }),
        linearized_is(&POINTS_IGNORED, |window, _, steps| {
            let points = latest_points(&window);
            right::linearized(window, points, steps)
        }),
        linearized_is(&RESIDUAL_AT_POINTS, |window, points, steps| {
            let (rows, mut residual) = right::linearized(window.clone(), points.clone(), steps);
            let mut row = 0;
            for (measurement, points) in window.measurements.iter().zip(points) {
                // A window of one measurement whose latest estimates are these.
                let mut alone = window.clone();
                alone.measurements = vec![*measurement];
                match measurement.what {
                    What::Seen { pose, landmark, .. } => {
                        alone.poses[pose].truncate(points[0] + 1);
                        alone.landmarks[landmark].truncate(points[1] + 1);
                    }
                    What::Moved { from, to, .. } => {
                        alone.poses[from].truncate(points[0] + 1);
                        alone.poses[to].truncate(points[1] + 1);
                    }
                }
                let (_, own) = right::linearized(alone, vec![points], steps);
                residual.rows_mut(row, own.len()).copy_from(&own);
                row += own.len();
            }
            (rows, residual)
        }),
        linearized_is(&RESIDUAL_SIGN, |window, points, steps| {
            let (rows, residual) = right::linearized(window, points, steps);
            (rows, -residual)
        }),
        linearized_is(&ANGLE_NOT_WRAPPED, |window, points, steps| {
            let (rows, mut residual) = right::linearized(window.clone(), points, steps);
            let mut row = 0;
            let heading = |pose: usize| window.poses[pose].last().map_or(0.0, |pose| pose.heading);
            for measurement in &window.measurements {
                row += 2;
                if let What::Moved { from, to, turn, .. } = measurement.what {
                    residual[row] = (heading(to) - heading(from) - turn) / measurement.sigma;
                    row += 1;
                }
            }
            (rows, residual)
        }),
        linearized_is(&NOT_WHITENED, |mut window, points, steps| {
            window.measurements.iter_mut().for_each(|measurement| measurement.sigma = 1.0);
            right::linearized(window, points, steps)
        }),
    ]
}

fn latest(window: &Window) -> Vec<usize> {
    let poses = window.poses.iter().map(Vec::len);
    poses.chain(window.landmarks.iter().map(Vec::len)).map(|count| count - 1).collect()
}

/// The numbers of the two variables of a measurement, poses first.
fn variables(window: &Window, measurement: &Measurement) -> [usize; 2] {
    match measurement.what {
        What::Seen { pose, landmark, .. } => [pose, window.poses.len() + landmark],
        What::Moved { from, to, .. } => [from, to],
    }
}

fn latest_points(window: &Window) -> Vec<[usize; 2]> {
    let latest = latest(window);
    let points = |measurement| variables(window, measurement).map(|variable| latest[variable]);
    window.measurements.iter().map(points).collect()
}

fn choices() -> Vec<Wrong> {
    let trajectory_is = |misconception, one_trajectory| {
        Wrong::new(misconception, Functions { one_trajectory, ..REFERENCE })
    };
    vec![
        trajectory_is(&LATEST_OF_ALL, |window| Some(latest(&window))),
        trajectory_is(&FIRST_OF_ALL, |window| Some(vec![0; latest(&window).len()])),
        trajectory_is(&LANDMARKS_LATEST, |window| {
            let (poses, latest) = (window.poses.len(), latest(&window));
            let mut chosen = right::one_trajectory(window)?;
            chosen[poses..].copy_from_slice(&latest[poses..]);
            Some(chosen)
        }),
        trajectory_is(&POSES_LATEST, |window| {
            let (poses, latest) = (window.poses.len(), latest(&window));
            let mut chosen = right::one_trajectory(window)?;
            chosen[..poses].copy_from_slice(&latest[..poses]);
            Some(chosen)
        }),
        trajectory_is(&DEPARTURES_LATEST, |window| {
            let mut chosen = vec![None; latest(&window).len()];
            for measurement in &window.measurements {
                let Some(points) = measurement.kept else { continue };
                let is_odometry = matches!(measurement.what, What::Moved { .. });
                let pairs = variables(&window, measurement).into_iter().zip(points);
                for (variable, point) in pairs.skip(usize::from(is_odometry)) {
                    if *chosen[variable].get_or_insert(point) != point {
                        return None;
                    }
                }
            }
            let pairs = chosen.into_iter().zip(latest(&window));
            Some(pairs.map(|(chosen, latest)| chosen.unwrap_or(latest)).collect())
        }),
        trajectory_is(&NEVER_REFUSED, |window| {
            let mut chosen = latest(&window);
            for measurement in window.measurements.iter().rev() {
                let pairs = variables(&window, measurement)
                    .into_iter()
                    .zip(measurement.kept.iter().flatten());
                pairs.for_each(|(variable, point)| chosen[variable] = *point);
            }
            Some(chosen)
        }),
        trajectory_is(&NEVER_REFUSED, |window| {
            let mut chosen = latest(&window);
            for measurement in &window.measurements {
                let pairs = variables(&window, measurement)
                    .into_iter()
                    .zip(measurement.kept.iter().flatten());
                pairs.for_each(|(variable, point)| chosen[variable] = *point);
            }
            Some(chosen)
        }),
    ]
}

/// The free directions at one estimate of each variable.
fn directions_at(window: &Window, trajectory: &[usize], steps: Steps) -> DMatrix<f64> {
    let (poses, landmarks) = trajectory.split_at(window.poses.len());
    let poses = window.poses.iter().zip(poses).map(|(all, point)| all[*point]).collect();
    let landmarks: Vec<Vector2<f64>> =
        window.landmarks.iter().zip(landmarks).map(|(all, point)| all[*point]).collect();
    right::free_directions(poses, landmarks, steps)
}

/// For each direction the measurement whose measure is greatest, if a sum of all says that it is lost.
fn blamed(
    (window, points, steps): (Window, Vec<[usize; 2]>, Steps),
    directions: &DMatrix<f64>,
    measure: fn(f64) -> f64,
    is_lost: fn(f64, f64) -> bool,
) -> Vec<Option<usize>> {
    let sizes: Vec<usize> = window
        .measurements
        .iter()
        .map(|measurement| if matches!(measurement.what, What::Seen { .. }) { 2 } else { 3 })
        .collect();
    let (rows, _) = right::linearized(window, points, steps);
    let whole = rows.abs() * directions.abs();
    let claimed = rows * directions;
    let of_direction = |direction: usize| {
        let (mut row, mut claims) = (0, Vec::new());
        for size in &sizes {
            let own = claimed.view((row, direction), (*size, 1));
            claims.push(own.iter().map(|claim| measure(*claim)).sum::<f64>());
            row += size;
        }
        let most = (0..claims.len()).max_by(|a, b| claims[*a].total_cmp(&claims[*b]));
        let whole = whole.column(direction).norm_squared();
        most.filter(|_| is_lost(claims.iter().sum(), whole))
    };
    (0..3).map(of_direction).collect()
}

fn verdicts() -> Vec<Wrong> {
    let lost_is = |misconception, lost| Wrong::new(misconception, Functions { lost, ..REFERENCE });
    vec![
        lost_is(&DIRECTIONS_FOLLOW, |window, points, trajectory, steps| {
            let mut lost = vec![None; 3];
            for (index, points) in points.into_iter().enumerate() {
                let mut alone = window.clone();
                alone.measurements = vec![window.measurements[index]];
                let mut own = trajectory.clone();
                let pairs = variables(&window, &window.measurements[index]).into_iter().zip(points);
                pairs.for_each(|(variable, point)| own[variable] = point);
                for (lost, found) in
                    lost.iter_mut().zip(right::lost(alone, vec![points], own, steps))
                {
                    *lost = lost.or(found.map(|_| index));
                }
            }
            lost
        }),
        lost_is(&DIRECTIONS_AT_LATEST, |window, points, _, steps| {
            let latest = latest(&window);
            right::lost(window, points, latest, steps)
        }),
        lost_is(&SIGNS_CANCEL, |window, points, trajectory, steps| {
            let directions = directions_at(&window, &trajectory, steps);
            let is_lost = |sum: f64, whole: f64| sum * sum > 1e-16 * whole;
            blamed((window, points, steps), &directions, |claim| claim, is_lost)
        }),
        lost_is(&ABSOLUTE_THRESHOLD, |window, points, trajectory, steps| {
            let directions = directions_at(&window, &trajectory, steps);
            let is_lost = |sum: f64, _| sum > 1e-9;
            blamed((window, points, steps), &directions, |claim| claim * claim, is_lost)
        }),
    ]
}

/// The inverse of a matrix that has one.
fn inverse(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let (rows, columns) = matrix.shape();
    matrix.try_inverse().unwrap_or(DMatrix::zeros(rows, columns))
}

fn rows() -> Vec<Wrong> {
    let restored_is =
        |misconception, restored| Wrong::new(misconception, Functions { restored, ..REFERENCE });
    vec![
        restored_is(&UNWEIGHTED, |rows, directions, covariance| {
            let size = covariance.nrows();
            right::restored(rows, directions, DMatrix::identity(size, size))
        }),
        restored_is(&COVARIANCE_FOR_INFORMATION, |rows, directions, covariance| {
            right::restored(rows, directions, inverse(covariance))
        }),
        restored_is(&GRAM_NOT_INVERTED, |rows, directions, covariance| {
            let informed = inverse(covariance) * &directions;
            &rows - &rows * directions * informed.transpose()
        }),
        restored_is(&GRAM_NOT_INVERTED, |rows, directions, covariance| {
            let informed = inverse(covariance) * &directions;
            &rows - &rows * &directions * directions.tr_mul(&informed) * informed.transpose()
        }),
        restored_is(&ONE_BY_ONE, |rows, directions, covariance| {
            let mut restored = rows.clone();
            for direction in directions.column_iter() {
                let one = DMatrix::from_column_slice(
                    direction.len(),
                    1,
                    direction.clone_owned().as_slice(),
                );
                restored += right::restored(rows.clone(), one, covariance.clone()) - &rows;
            }
            restored
        }),
    ]
}
