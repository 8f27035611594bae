//! The equations of what no picture fixes, and of the ruler that fixes it.

use nalgebra::{Isometry3, Matrix3, Matrix3x6, Vector3, Vector6};
use vislam::manifold::se3;
use vislam::two_views::{StereoPinhole, StereoProjection, scale_direction};

use super::oracle::{seen, slope};
use super::{NOWHERE, STATES, motion};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Registers the equations.
pub fn equations(chapter: &mut Chapter) {
    let mutants: [(_, Direction); 4] = [
        ("sign", |pose| -scale_direction(pose)),
        ("in world coordinates of the camera's translation", |pose| {
            with_zeros(&pose.translation.vector)
        }),
        ("camera stays", |_| Vector6::zeros()),
        ("camera turns as well", |pose| {
            let direction = scale_direction(pose);
            let turn = direction.fixed_rows::<3>(0).into_owned();
            Vector6::new(turn.x, turn.y, turn.z, turn.x, turn.y, turn.z)
        }),
    ];
    chapter.equation("scale-null-vector", scale_null_vector, scale_direction, &mutants);

    let formula: Observation = |stereo, point| {
        let seen = stereo.project_with_jacobians(&Isometry3::identity(), point)?;
        Some(seen.observation)
    };
    let mutants: [(_, Observation); 4] = [
        ("sign of the baseline", |stereo, point| predicted(&with_baseline(stereo, -1.0), point)),
        ("baseline dropped", |stereo, point| predicted(&with_baseline(stereo, 0.0), point)),
        ("disparity for the right column", |stereo, point| {
            let seen = predicted(stereo, point)?;
            Some(Vector3::new(seen.x, seen.y, seen.x - seen.z))
        }),
        ("right row for the right column", |stereo, point| {
            let seen = predicted(stereo, point)?;
            Some(Vector3::new(seen.x, seen.y, seen.y))
        }),
    ];
    chapter.equation("stereo-projection", stereo_projection, formula, &mutants);

    let formula: Blocks = StereoPinhole::project_with_jacobians;
    let mutants: [(_, Blocks); 4] = [
        ("baseline dropped", |stereo, pose, point| {
            with_baseline(stereo, 0.0).project_with_jacobians(pose, point)
        }),
        ("right camera on the left", |stereo, pose, point| {
            with_baseline(stereo, -1.0).project_with_jacobians(pose, point)
        }),
        ("pose block on the left", |stereo, pose, point| {
            let mut seen = stereo.project_with_jacobians(pose, point)?;
            seen.by_pose *= se3::adjoint(&pose.inverse());
            Some(seen)
        }),
        ("point block in camera coordinates", |stereo, pose, point| {
            let mut seen = stereo.project_with_jacobians(pose, point)?;
            seen.by_point *= pose.rotation.inverse().to_rotation_matrix();
            Some(seen)
        }),
    ];
    chapter.equation("stereo-blocks", stereo_blocks, formula, &mutants);
}

type Direction = fn(&Isometry3<f64>) -> Vector6<f64>;

fn scale_null_vector(formula: Direction) -> Comparison {
    let against = "what the motion of the points does to the pixel, with the sign turned";
    let mut comparison = Comparison::relative(against, 1e-12);
    let mut random = Random::new(21);
    for _ in 0..STATES {
        let camera = random.camera();
        let pose = Isometry3::from_parts(random.direction(3.0).into(), random.rotation(3.0).into());
        let point = pose.inverse() * nalgebra::Point3::from(random.point(1.0..50.0));
        let Some((by_pose, by_point)) = camera.jacobians(&pose, &point.coords) else { continue };
        let by_camera = by_pose * formula(&pose);
        comparison.add(by_camera.as_slice(), (-by_point * point.coords).as_slice());
    }
    comparison
}

/// Takes a stereo camera and a point in coordinates of the left one.
type Observation = fn(&StereoPinhole, &Vector3<f64>) -> Option<Vector3<f64>>;

fn stereo_projection(formula: Observation) -> Comparison {
    let against = "the projections into both cameras";
    let mut comparison = Comparison::absolute(against, 1e-10, "px");
    let mut random = Random::new(22);
    for _ in 0..STATES {
        let stereo = stereo(&mut random);
        let point = random.point(0.5..50.0);
        let seen = formula(&stereo, &point).unwrap_or(NOWHERE.push(f64::NAN));
        let expected = observed(&stereo, &Isometry3::identity(), &point);
        comparison.add(seen.as_slice(), expected.as_slice());
    }
    comparison
}

type Blocks = fn(&StereoPinhole, &Isometry3<f64>, &Vector3<f64>) -> Option<StereoProjection>;

fn stereo_blocks(formula: Blocks) -> Comparison {
    let against = "central differences of the projections into both cameras";
    let mut comparison = Comparison::relative(against, 1e-7);
    let mut random = Random::new(23);
    for _ in 0..STATES {
        let stereo = stereo(&mut random);
        let pose = motion(&mut random);
        let point = random.point(2.0..20.0);
        let mut by_pose = Matrix3x6::zeros();
        for axis in 0..6 {
            let along = |change: f64| {
                let moved = se3::retract(&pose, &(change * Vector6::ith(axis, 1.0)));
                observed(&stereo, &moved, &point)
            };
            by_pose.set_column(axis, &slope(along, 1e-5));
        }
        let mut by_point = Matrix3::zeros();
        for axis in 0..3 {
            let along =
                |change: f64| observed(&stereo, &pose, &(point + change * Vector3::ith(axis, 1.0)));
            by_point.set_column(axis, &slope(along, 1e-5));
        }
        let blocks = formula(&stereo, &pose, &point);
        let blocks =
            blocks.map(|seen| [seen.by_pose.as_slice(), seen.by_point.as_slice()].concat());
        let expected = [by_pose.as_slice(), by_point.as_slice()].concat();
        comparison.add(&blocks.unwrap_or(vec![f64::NAN; 27]), &expected);
    }
    comparison
}

fn stereo(random: &mut Random) -> StereoPinhole {
    StereoPinhole { camera: random.camera(), baseline: random.logarithmic(0.05..1.0) }
}

fn predicted(stereo: &StereoPinhole, point: &Vector3<f64>) -> Option<Vector3<f64>> {
    let seen = stereo.project_with_jacobians(&Isometry3::identity(), point)?;
    Some(seen.observation)
}

fn with_baseline(stereo: &StereoPinhole, factor: f64) -> StereoPinhole {
    StereoPinhole { baseline: factor * stereo.baseline, ..*stereo }
}

/// The three numbers of a stereo observation, by homogeneous matrices.
fn observed(
    stereo: &StereoPinhole,
    left_from_world: &Isometry3<f64>,
    point: &Vector3<f64>,
) -> Vector3<f64> {
    let left = seen(&stereo.camera, left_from_world, point);
    let mut right_from_world = *left_from_world;
    right_from_world.translation.vector.x -= stereo.baseline;
    left.push(seen(&stereo.camera, &right_from_world, point).x)
}

fn with_zeros(translation: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(translation.x, translation.y, translation.z, 0.0, 0.0, 0.0)
}
