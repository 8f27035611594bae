//! Where to begin: two linear problems.

use nalgebra::{Isometry3, Matrix1, Matrix3, UnitQuaternion, Vector3};

use super::{LoopClosureError, RelativeMeasurement, SpatialGraph};
use crate::filtering::metrics::rotation_towards;
use crate::least_squares::SparseCholesky;

type Measurement = RelativeMeasurement<Isometry3<f64>, 6>;

// ANCHOR: chordal_initialization
/// Poses to begin with, whatever the poses of the graph are but the first, which stays
/// ([@carlone2015]).
///
/// The rotations are first taken for any matrices: the sum of κ ‖Rⱼ − Rᵢ R̃‖² is then a linear problem
/// with three right-hand sides, one for each row, and each matrix is replaced by the rotation that
/// comes nearest to it. With these the translations are linear too. A weight is the mean of what the
/// information has on its diagonal. Implements {eq:chordal-start}.
///
/// # Errors
///
/// As those of [`PoseGraph::problem`](super::PoseGraph::problem), [`LoopClosureError::Undecided`], and
/// [`LoopClosureError::Solve`] when weights are too different for rounding.
pub fn chordal_initialization(
    graph: &SpatialGraph,
) -> Result<Vec<Isometry3<f64>>, LoopClosureError> {
    graph.check_connected()?;
    let rotations = relaxed_rotations(graph)?;
    let nearest = |(pose, matrix): (usize, &Matrix3<f64>)| {
        let rotation = rotation_towards(matrix, UNDECIDED);
        let rotation = rotation.ok_or(LoopClosureError::Undecided { pose })?;
        Ok(UnitQuaternion::from_rotation_matrix(&rotation))
    };
    let rotations: Vec<UnitQuaternion<f64>> =
        rotations.iter().enumerate().map(nearest).collect::<Result<_, LoopClosureError>>()?;
    let positions = positions(graph, &rotations)?;
    let pose =
        |(rotation, position): (_, Vector3<f64>)| Isometry3::from_parts(position.into(), rotation);
    Ok(rotations.into_iter().zip(positions).map(pose).collect())
}
// ANCHOR_END: chordal_initialization

/// Below this gap more than one rotation is nearest.
const UNDECIDED: f64 = 1e-9;

// ANCHOR: relaxed_rotations
/// The matrices for which the sum of κ ‖Rⱼ − Rᵢ R̃‖² is least, the first one held.
fn relaxed_rotations(graph: &SpatialGraph) -> Result<Vec<Matrix3<f64>>, LoopClosureError> {
    let (mut system, mut rows) = system::<3>(graph);
    let first = graph.poses[0].rotation.to_rotation_matrix().into_inner();
    for measurement in &graph.measurements {
        let turn = measurement.measured.rotation.to_rotation_matrix().into_inner();
        let weight = mean_information(measurement, 3);
        let [from, to] = [measurement.first, measurement.second].map(|pose| pose.checked_sub(1));
        let own = Matrix3::from_diagonal_element(weight);
        [from, to].iter().flatten().for_each(|block| system.add(*block, *block, &own));
        // Each row r of a matrix, as a column, asks for rⱼ = R̃ᵀ rᵢ.
        match (from, to) {
            (Some(from), Some(to)) => system.add(from, to, &(-weight * turn)),
            (None, Some(to)) => add_known(&mut rows, to, &(weight * first * turn)),
            (Some(from), None) => add_known(&mut rows, from, &(weight * first * turn.transpose())),
            (None, None) => {}
        }
    }
    solve(&mut system, &mut rows)?;
    let matrix = |block: usize| Matrix3::from_fn(|row, column| rows[row][3 * block + column]);
    Ok(std::iter::once(first).chain((0..graph.poses.len() - 1).map(matrix)).collect())
}
// ANCHOR_END: relaxed_rotations

/// Adds what the first pose says of a matrix, row by row.
fn add_known(rows: &mut [Vec<f64>; 3], block: usize, known: &Matrix3<f64>) {
    for (row, numbers) in rows.iter_mut().enumerate() {
        let numbers = &mut numbers[3 * block..3 * block + 3];
        numbers.iter_mut().zip(&known.row(row)).for_each(|(sum, number)| *sum += number);
    }
}

// ANCHOR: positions
/// The positions for which the sum of τ ‖tⱼ − tᵢ − Rᵢ t̃‖² is least, the first one held.
fn positions(
    graph: &SpatialGraph,
    rotations: &[UnitQuaternion<f64>],
) -> Result<Vec<Vector3<f64>>, LoopClosureError> {
    let (mut system, mut axes) = system::<1>(graph);
    let first = graph.poses[0].translation.vector;
    for measurement in &graph.measurements {
        let weight = mean_information(measurement, 0);
        let shift = rotations[measurement.first] * measurement.measured.translation.vector;
        let [from, to] = [measurement.first, measurement.second].map(|pose| pose.checked_sub(1));
        for (own, other, known) in [(from, to, -shift), (to, from, shift)] {
            let Some(own) = own else { continue };
            system.add(own, own, &Matrix1::new(weight));
            let known = if other.is_none() { known + first } else { known };
            axes.iter_mut().zip(&known).for_each(|(axis, number)| axis[own] += weight * number);
        }
        if let (Some(from), Some(to)) = (from, to) {
            system.add(from, to, &Matrix1::new(-weight));
        }
    }
    solve(&mut system, &mut axes)?;
    let position = |pose: usize| Vector3::from_fn(|axis, _| axes[axis][pose]);
    Ok(std::iter::once(first).chain((0..graph.poses.len() - 1).map(position)).collect())
}
// ANCHOR_END: positions

/// The mean information of three coordinates, from this one on.
fn mean_information(measurement: &Measurement, first: usize) -> f64 {
    measurement.information.fixed_view::<3, 3>(first, first).trace() / 3.0
}

/// Room for a linear system with a block of `N` for each pose but the first, and its three right-hand
/// sides.
fn system<const N: usize>(graph: &SpatialGraph) -> (SparseCholesky, [Vec<f64>; 3]) {
    let pair = |measurement: &Measurement| {
        Some([measurement.first.checked_sub(1)?, measurement.second.checked_sub(1)?])
    };
    let pairs: Vec<[usize; 2]> = graph.measurements.iter().filter_map(pair).collect();
    let system = SparseCholesky::new(&vec![N; graph.poses.len() - 1], &pairs);
    let zeros = vec![0.0; system.dimension()];
    (system, [zeros.clone(), zeros.clone(), zeros])
}

/// Replaces right-hand sides by solutions.
fn solve(system: &mut SparseCholesky, sides: &mut [Vec<f64>; 3]) -> Result<(), LoopClosureError> {
    if !system.factorize(|_, _| 0.0) {
        return Err(crate::least_squares::SolveError::OutOfRange.into());
    }
    sides.iter_mut().for_each(|side| system.solve(side));
    Ok(())
}
