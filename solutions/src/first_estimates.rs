//! Which direction is lost, and why.

use exercise_spec::first_estimates::{Measurement, Pose, Steps, What, Window};
use nalgebra::{DMatrix, DVector, Matrix2, Matrix2x3, Rotation2, Vector2};

/// The steps of all variables under three motions of the world, in three columns: a shift
/// by a metre along its first axis, one along its second, and a turn by a radian about its
/// origin, from the first axis to the second, to first order.
///
/// Three rows for each pose, (δθ, δp), and then two for each landmark.
pub fn free_directions(
    poses: Vec<Pose>,
    landmarks: Vec<Vector2<f64>>,
    steps: Steps,
) -> DMatrix<f64> {
    let first_landmark = 3 * poses.len();
    let mut directions = DMatrix::zeros(first_landmark + 2 * landmarks.len(), 3);
    for (k, pose) in poses.iter().enumerate() {
        let step = world_from_step(pose, steps).transpose() * moved_with_the_world(&pose.position);
        directions[(3 * k, 2)] = 1.0;
        directions.fixed_view_mut::<2, 3>(3 * k + 1, 0).copy_from(&step);
    }
    for (k, landmark) in landmarks.iter().enumerate() {
        let step = moved_with_the_world(landmark);
        directions.fixed_view_mut::<2, 3>(first_landmark + 2 * k, 0).copy_from(&step);
    }
    directions
}

/// How two shifts and a turn of the world move a point of it.
fn moved_with_the_world(point: &Vector2<f64>) -> Matrix2x3<f64> {
    Matrix2x3::new(1.0, 0.0, -point.y, 0.0, 1.0, point.x)
}

/// The rotation that takes δp to the world.
fn world_from_step(pose: &Pose, steps: Steps) -> Matrix2<f64> {
    match steps {
        Steps::World => Matrix2::identity(),
        Steps::Body => *Rotation2::new(pose.heading).matrix(),
    }
}

/// Derivatives of all measurements by the steps of all variables, and residuals. Both are
/// whitened: each row is divided by its standard deviation.
///
/// Two rows for each measurement of a landmark and three for each of a pose, in the order
/// of the window and of `What`. Columns as the rows of `free_directions`. The derivatives
/// of a measurement are taken at those estimates of its two variables that `points`
/// numbers, which is as long as the list of measurements. The residual is predicted less
/// measured at the latest estimates of all variables; the difference of an angle is taken
/// between −π and π before it is divided.
pub fn linearized(
    window: Window,
    points: Vec<[usize; 2]>,
    steps: Steps,
) -> (DMatrix<f64>, DVector<f64>) {
    let landmark_column = |landmark: usize| 3 * window.poses.len() + 2 * landmark;
    let columns = landmark_column(window.landmarks.len());
    let size = window.measurements.iter().map(rows_of).sum();
    let (mut rows, mut residual) = (DMatrix::zeros(size, columns), DVector::zeros(size));
    let mut row = 0;
    for (measurement, [a, b]) in window.measurements.iter().zip(points) {
        let sigma = measurement.sigma;
        // The two variables of the measurement: a pose, and the place that is seen from it.
        let (pose, column, place, world_from_place, measured) = match measurement.what {
            What::Seen { pose, landmark, place } => {
                let estimates = &window.landmarks[landmark];
                let ends = [estimates[b], latest(estimates)];
                (pose, landmark_column(landmark), ends, Matrix2::identity(), place)
            }
            What::Moved { from, to, shift, turn } => {
                let estimates = &window.poses[to];
                let ends = [estimates[b].position, latest(estimates).position];
                let angle = latest(estimates).heading - latest(&window.poses[from]).heading - turn;
                rows[(row + 2, 3 * from)] = -1.0 / sigma;
                rows[(row + 2, 3 * to)] = 1.0 / sigma;
                residual[row + 2] = angle.sin().atan2(angle.cos()) / sigma;
                (from, 3 * to + 1, ends, world_from_step(&estimates[b], steps), shift)
            }
        };
        let estimates = &window.poses[pose];
        let (point, now) = (&estimates[a], latest(estimates));
        let body_from_world = Rotation2::new(point.heading).inverse().into_inner();
        let seen = body_from_world * (place[0] - point.position);
        let by_heading = Vector2::new(seen.y, -seen.x);
        let by_position = -body_from_world * world_from_step(point, steps);
        let by_place = body_from_world * world_from_place;
        rows.fixed_view_mut::<2, 1>(row, 3 * pose).copy_from(&(by_heading / sigma));
        rows.fixed_view_mut::<2, 2>(row, 3 * pose + 1).copy_from(&(by_position / sigma));
        rows.fixed_view_mut::<2, 2>(row, column).copy_from(&(by_place / sigma));
        let predicted = Rotation2::new(-now.heading) * (place[1] - now.position);
        residual.fixed_rows_mut::<2>(row).copy_from(&((predicted - measured) / sigma));
        row += rows_of(measurement);
    }
    (rows, residual)
}

/// How many numbers have been measured.
fn rows_of(measurement: &Measurement) -> usize {
    match measurement.what {
        What::Seen { .. } => 2,
        What::Moved { .. } => 3,
    }
}

/// The last estimate of a variable.
fn latest<T: Copy>(estimates: &[T]) -> T {
    estimates[estimates.len() - 1]
}

/// One estimate of each variable at which the derivatives of all measurements can be
/// taken: the latest that is possible, where measurements that are kept have had theirs
/// taken already. The numbers of the estimates, poses first. `None` when no estimate of
/// some variable will do.
pub fn one_trajectory(window: Window) -> Option<Vec<usize>> {
    let mut frozen = vec![None; window.poses.len() + window.landmarks.len()];
    for measurement in &window.measurements {
        let Some(points) = measurement.kept else { continue };
        let variables = match measurement.what {
            What::Seen { pose, landmark, .. } => [pose, window.poses.len() + landmark],
            What::Moved { from, to, .. } => [from, to],
        };
        for (variable, point) in variables.into_iter().zip(points) {
            if *frozen[variable].get_or_insert(point) != point {
                return None;
            }
        }
    }
    let counts = window.poses.iter().map(Vec::len).chain(window.landmarks.iter().map(Vec::len));
    Some(frozen.into_iter().zip(counts).map(|(point, count)| point.unwrap_or(count - 1)).collect())
}

/// Which free directions the derivatives at `points` claim to know, and why. The
/// directions are those of `free_directions`, taken at the estimates that `trajectory`
/// numbers, poses first.
///
/// For each direction the number of the measurement that claims most of it. What rows
/// claim of a direction n is the information nᵀ Hᵀ H n. `None` where all rows together
/// claim 1e-16 or less of what it would be if nothing cancelled: of the sum over all rows
/// h of (Σᵢ |hᵢ nᵢ|)². It does not matter whether a measurement is kept.
pub fn lost(
    window: Window,
    points: Vec<[usize; 2]>,
    trajectory: Vec<usize>,
    steps: Steps,
) -> Vec<Option<usize>> {
    let (of_poses, of_landmarks) = trajectory.split_at(window.poses.len());
    let poses = window.poses.iter().zip(of_poses).map(|(all, point)| all[*point]).collect();
    let landmarks =
        window.landmarks.iter().zip(of_landmarks).map(|(all, point)| all[*point]).collect();
    let directions = free_directions(poses, landmarks, steps);
    let sizes: Vec<usize> = window.measurements.iter().map(rows_of).collect();
    let (rows, _) = linearized(window, points, steps);
    let claimed_most = |direction: usize| {
        let along = directions.column(direction);
        let parts = rows.row_iter().map(|row| row.transpose().component_mul(&along).abs().sum());
        let whole: f64 = parts.map(|sum| sum * sum).sum();
        let (mut row, mut claims) = (0, Vec::new());
        for size in &sizes {
            claims.push((rows.rows(row, *size) * along).norm_squared());
            row += size;
        }
        let most = (0..claims.len()).max_by(|a, b| claims[*a].total_cmp(&claims[*b]));
        most.filter(|_| claims.iter().sum::<f64>() > 1e-16 * whole)
    };
    (0..3).map(claimed_most).collect()
}

/// The rows H + D that claim nothing along any combination of the columns of `directions`,
/// with the least change D: what D e is on average, squared and summed, is as little as
/// can be for errors e of mean zero and of this covariance. The covariance is positive
/// definite, and the directions do not depend on one another.
pub fn restored(
    rows: DMatrix<f64>,
    directions: DMatrix<f64>,
    covariance: DMatrix<f64>,
) -> DMatrix<f64> {
    let claimed = &rows * &directions;
    let Some(covariance) = covariance.cholesky() else { return rows };
    let informed = covariance.solve(&directions);
    let Some(gram) = directions.tr_mul(&informed).cholesky() else { return rows };
    rows - claimed * gram.solve(&informed.transpose())
}
