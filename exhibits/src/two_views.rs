//! What chapter `two_views` shows: what binds two pictures together, the points they fix and how
//! sure those are.
//!
//! Each part registers its equations, then checks them. In formulas `k` is a camera, `m` the motion
//! `second_from_first`, `a` a parallax.

mod conditions;
mod draws;
mod figures;
mod five_points;
mod numbers;
mod oracle;
mod worked;

use nalgebra::{
    Isometry3, Matrix2x3, Matrix3, Matrix3x6, Matrix4, Point3, Rotation3, SMatrix, Vector2,
    Vector3, Vector6,
};
use vislam::bearing::{bearing, depth_from_disparity};
use vislam::manifold::{se3, so3};
use vislam::reprojection::Pinhole;
use vislam::two_views::{
    self as theory, StereoPinhole, StereoProjection, View, essential_matrix, scale_direction,
    triangulate, triangulate_nonlinear,
};

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;
use oracle::{curvature, information, meeting_in_plane, nudged, seen, slope};
use worked::facing;

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Stands for the pixel of a formula that gives none; no comparison accepts it.
const NOWHERE: Vector2<f64> = Vector2::new(f64::NAN, f64::NAN);

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    directions(chapter);
    lines(chapter);
    motions(chapter);
    rulers(chapter);
    linear(chapter);
    likely(chapter);
    two_rays(chapter);
    conditions::counterexamples(chapter);
    numbers::numbers(chapter);
    figures::figures(chapter);
}

fn directions(chapter: &mut Chapter) {
    let formula: Coplanarity =
        |m, first, second| theory::epipolar_residual(&essential_matrix(m), first, second);
    let mutants: [(_, Coplanarity); 5] = [
        ("matrix transposed", |m, first, second| first.dot(&(essential_matrix(m) * second))),
        ("rotation transposed", |m, first, second| {
            second.dot(&m.translation.vector.cross(&m.rotation.inverse_transform_vector(first)))
        }),
        ("rotation on the left", |m, first, second| {
            second.dot(&(m.rotation * m.translation.vector.cross(first)))
        }),
        ("sign", |m, first, second| -second.dot(&(essential_matrix(m) * first))),
        ("centre for translation", |m, first, second| {
            let centre = m.inverse().translation.vector;
            second.dot(&centre.cross(&(m.rotation * first)))
        }),
    ];
    chapter.equation("coplanarity", coplanarity, formula, &mutants);

    let formula: AnyBaseline = |r, a, first, second| second.dot(&a.cross(&(r * first)));
    let mutants: [(_, AnyBaseline); 3] = [
        ("rotation transposed", |r, a, first, second| second.dot(&a.cross(&(r.inverse() * first)))),
        ("rotation dropped", |_, a, first, second| second.dot(&a.cross(first))),
        ("directions exchanged", |r, a, first, second| first.dot(&a.cross(&(r * second)))),
    ];
    chapter.equation("any-baseline", any_baseline, formula, &mutants);
}

/// Takes a motion and a direction in each camera.
type Coplanarity = fn(&Isometry3<f64>, &Vector3<f64>, &Vector3<f64>) -> f64;

fn coplanarity(formula: Coplanarity) -> Comparison {
    let against =
        "zero for directions to one point, and the determinant of three columns for others";
    let mut comparison = Comparison::absolute(against, 1e-13, "m³");
    let mut random = Random::new(1);
    for state in 0..STATES {
        let motion = motion(&mut random);
        let point = random.point(2.0..50.0);
        let second = motion.rotation * point + motion.translation.vector;
        let other = random.direction(1.0);
        let (first, second) = if state % 2 == 0 {
            (point.normalize(), second.normalize())
        } else {
            (point.normalize(), other)
        };
        let columns =
            [second, motion.translation.vector, motion.rotation.to_rotation_matrix() * first];
        let volume =
            if state % 2 == 0 { 0.0 } else { Matrix3::from_columns(&columns).determinant() };
        comparison.add(&[formula(&motion, &first, &second)], &[volume]);
    }
    comparison
}

/// Takes a rotation, any vector, and a direction before and after the rotation.
type AnyBaseline = fn(&Rotation3<f64>, &Vector3<f64>, &Vector3<f64>, &Vector3<f64>) -> f64;

fn any_baseline(formula: AnyBaseline) -> Comparison {
    let against = "zero, for the pixels of a turning camera and any vector";
    let mut comparison = Comparison::absolute(against, 1e-12, "m³");
    let mut random = Random::new(2);
    for _ in 0..STATES {
        let camera = random.camera();
        let turn = random.rotation(0.35);
        let point = random.point(1.0..50.0);
        let pose = Isometry3::from_parts(Default::default(), turn.into());
        let [first, second] = [Isometry3::identity(), pose].map(|pose| {
            let pixel = seen(&camera, &pose, &point);
            bearing(&camera, &pixel).into_inner()
        });
        let any = random.direction(1.0);
        comparison.add(&[formula(&turn, &any, &first, &second)], &[0.0]);
    }
    comparison
}

fn lines(chapter: &mut Chapter) {
    let formula: Line = |first, second, m, pixel| line(first, second, &essential_matrix(m), pixel);
    let mutants: [(_, Line); 4] = [
        ("matrix transposed", |first, second, m, pixel| {
            line(first, second, &essential_matrix(m).transpose(), pixel)
        }),
        ("cameras exchanged", |first, second, m, pixel| {
            line(second, first, &essential_matrix(m), pixel)
        }),
        ("motion inverted", |first, second, m, pixel| {
            line(first, second, &essential_matrix(&m.inverse()), pixel)
        }),
        ("not scaled", |first, second, m, pixel| {
            let essential = essential_matrix(m);
            Some(theory::fundamental_matrix(first, second, &essential) * pixel.push(1.0))
        }),
    ];
    chapter.equation("epipolar-line", epipolar_line, formula, &mutants);

    let formula = theory::sampson_distance;
    let mutants: [(_, Sampson); 4] = [
        ("distance in the second image only", |f, first, second| {
            Some(theory::epipolar_line(f, first)?.dot(&second.push(1.0)))
        }),
        ("algebraic", |f, first, second| Some(second.push(1.0).dot(&(f * first.push(1.0))))),
        ("third component counted", |f, first, second| {
            let lines = [f * first.push(1.0), f.transpose() * second.push(1.0)];
            let slope = lines[0].norm().hypot(lines[1].norm());
            Some(second.push(1.0).dot(&lines[0]) / slope)
        }),
        ("matrix transposed", |f, first, second| {
            theory::sampson_distance(&f.transpose(), first, second)
        }),
    ];
    chapter.equation("sampson", sampson, formula, &mutants);
}

fn line(
    first: &Pinhole,
    second: &Pinhole,
    essential: &Matrix3<f64>,
    pixel: &Vector2<f64>,
) -> Option<Vector3<f64>> {
    theory::epipolar_line(&theory::fundamental_matrix(first, second, essential), pixel)
}

/// Takes both cameras, a motion and a pixel of the first image.
type Line = fn(&Pinhole, &Pinhole, &Isometry3<f64>, &Vector2<f64>) -> Option<Vector3<f64>>;

fn epipolar_line(formula: Line) -> Comparison {
    let against = "the pixels of two points of the ray in the second image, and a length of one";
    let mut comparison = Comparison::absolute(against, 1e-9, "px");
    let mut random = Random::new(3);
    for _ in 0..STATES {
        let (first, second) = (random.camera(), random.camera());
        let motion = motion(&mut random);
        let point = random.point(3.0..6.0);
        let pixel = seen(&first, &Isometry3::identity(), &point);
        let line = formula(&first, &second, &motion, &pixel).unwrap_or(NOWHERE.push(f64::NAN));
        let distance = |point| line.dot(&seen(&second, &motion, &point).push(1.0));
        let values = [distance(point), distance(1.7 * point), line.xy().norm()];
        comparison.add(&values, &[0.0, 0.0, 1.0]);
    }
    comparison
}

/// Takes a fundamental matrix and a pixel of each image.
type Sampson = fn(&Matrix3<f64>, &Vector2<f64>, &Vector2<f64>) -> Option<f64>;

fn sampson(formula: Sampson) -> Comparison {
    let against = "how far both pixels move to those of the most likely point, for small noise";
    let mut comparison = Comparison::absolute(against, 1e-6, "px");
    let mut random = Random::new(4);
    for _ in 0..STATES {
        let camera = random.camera();
        let motion = motion(&mut random);
        let point = random.point(2.0..10.0);
        let views = [Isometry3::identity(), motion].map(|pose| {
            let noise = Vector2::new(random.normal(1e-3), random.normal(1e-3));
            let pixel = seen(&camera, &pose, &point) + noise;
            View { camera, camera_from_world: pose, pixel, sigma: 1.0 }
        });
        let fundamental = theory::fundamental_matrix(&camera, &camera, &essential_matrix(&motion));
        let missed = formula(&fundamental, &views[0].pixel, &views[1].pixel);
        let moved = theory::triangulate_nonlinear(&views, &point)
            .map_or(f64::NAN, |found| 2.0 * found.cost);
        comparison.add(&[missed.map_or(f64::NAN, f64::abs)], &[moved.sqrt()]);
    }
    comparison
}

fn motions(chapter: &mut Chapter) {
    let formula: Singular = |m| m.translation.vector.norm() * Vector3::new(1.0, 1.0, 0.0);
    let mutants: [(_, Singular); 4] = [
        ("one of three", |m| m.translation.vector.norm() * Vector3::new(1.0, 0.0, 0.0)),
        ("all three", |m| m.translation.vector.norm() * Vector3::new(1.0, 1.0, 1.0)),
        ("length squared", |m| m.translation.vector.norm_squared() * Vector3::new(1.0, 1.0, 0.0)),
        ("length dropped", |_| Vector3::new(1.0, 1.0, 0.0)),
    ];
    chapter.equation("essential-singular", essential_singular, formula, &mutants);

    let formula: Poses = |essential| theory::relative_poses(essential).ok();
    let mutants: [(_, Poses); 4] = [
        ("cofactors dropped", |essential| with_rotations(essential, |e, t| -so3::hat(t) * e)),
        ("cross product on the right", |essential| {
            with_rotations(essential, |e, t| cofactors(e) - e * so3::hat(t))
        }),
        ("cofactors transposed", |essential| {
            with_rotations(essential, |e, t| cofactors(e).transpose() - so3::hat(t) * e)
        }),
        ("matrix transposed", |essential| theory::relative_poses(&essential.transpose()).ok()),
    ];
    chapter.equation("essential-poses", essential_poses, formula, &mutants);
}

type Singular = fn(&Isometry3<f64>) -> Vector3<f64>;

fn essential_singular(formula: Singular) -> Comparison {
    let against = "the singular values of the matrix whose columns are t × R e";
    let mut comparison = Comparison::relative(against, 1e-13);
    let mut random = Random::new(5);
    for _ in 0..STATES {
        let length = random.logarithmic(0.1..10.0);
        let (translation, rotation) = (random.direction(length), random.rotation(3.0));
        let columns =
            [0, 1, 2].map(|axis| translation.cross(&(rotation * Vector3::ith(axis, 1.0))));
        let values = Matrix3::from_columns(&columns).singular_values();
        let motion = Isometry3::from_parts(translation.into(), rotation.into());
        comparison.add(formula(&motion).as_slice(), values.as_slice());
    }
    comparison
}

type Poses = fn(&Matrix3<f64>) -> Option<[Isometry3<f64>; 4]>;

fn essential_poses(formula: Poses) -> Comparison {
    let against = "the motion that the matrix was made from, with a baseline of one";
    let mut comparison = Comparison::absolute(against, 1e-12, "entries");
    let mut random = Random::new(6);
    for _ in 0..STATES {
        let truth =
            Isometry3::from_parts(random.direction(1.0).into(), random.rotation(3.0).into());
        let scale = random.logarithmic(0.1..10.0);
        let found = formula(&(scale * essential_matrix(&truth)));
        let truth = truth.to_homogeneous();
        let nearest = found.into_iter().flatten().map(|pose| pose.to_homogeneous());
        let nearest =
            nearest.min_by(|one, other| (one - truth).norm().total_cmp(&(other - truth).norm()));
        let nearest = nearest.unwrap_or(Matrix4::repeat(f64::NAN));
        comparison.add(nearest.as_slice(), truth.as_slice());
    }
    comparison
}

/// The four motions with rotations by another formula of the scaled matrix and the translation.
fn with_rotations(
    essential: &Matrix3<f64>,
    rotation: fn(&Matrix3<f64>, &Vector3<f64>) -> Matrix3<f64>,
) -> Option<[Isometry3<f64>; 4]> {
    let scaled = essential * (2.0_f64.sqrt() / essential.norm());
    let poses = theory::relative_poses(essential).ok()?;
    Some(poses.map(|pose| {
        let wrong = rotation(&scaled, &pose.translation.vector);
        let wrong = Rotation3::from_matrix_unchecked(wrong);
        Isometry3::from_parts(pose.translation, wrong.into())
    }))
}

fn cofactors(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let [a, b, c] = [0, 1, 2].map(|column| matrix.column(column).into_owned());
    Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)])
}

fn rulers(chapter: &mut Chapter) {
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
        let point = pose.inverse() * Point3::from(random.point(1.0..50.0));
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

fn linear(chapter: &mut Chapter) {
    let formula: Linear = |views| triangulate(views, 0.0).ok();
    let mutants: [(_, Linear); 5] = [
        ("poses inverted", |views| {
            triangulated(views, |view| View {
                camera_from_world: view.camera_from_world.inverse(),
                ..*view
            })
        }),
        ("translations negated", |views| {
            triangulated(views, |view| {
                let mut pose = view.camera_from_world;
                pose.translation.vector.neg_mut();
                View { camera_from_world: pose, ..*view }
            })
        }),
        ("rotations dropped", |views| {
            triangulated(views, |view| View {
                camera_from_world: Isometry3::from(view.camera_from_world.translation),
                ..*view
            })
        }),
        ("focal lengths exchanged", |views| {
            triangulated(views, |view| View {
                camera: Pinhole { fx: view.camera.fy, fy: view.camera.fx, ..view.camera },
                ..*view
            })
        }),
        ("principal point dropped", |views| {
            triangulated(views, |view| View {
                camera: Pinhole { cx: 0.0, cy: 0.0, ..view.camera },
                ..*view
            })
        }),
    ];
    chapter.equation("dlt-rows", dlt_rows, formula, &mutants);
}

type Linear = fn(&[View; 3]) -> Option<Vector3<f64>>;

fn dlt_rows(formula: Linear) -> Comparison {
    let against = "the point whose pixels the views hold, without noise";
    let mut comparison = Comparison::relative(against, 1e-10);
    let mut random = Random::new(31);
    for _ in 0..STATES {
        let (point, views) = three_views(&mut random);
        // A mutant's point may lie behind its cameras; then it is no point at all.
        let found = formula(&views).unwrap_or(Vector3::repeat(1e9));
        comparison.add(found.as_slice(), point.as_slice());
    }
    comparison
}

/// The linear point of views that were changed.
fn triangulated(views: &[View; 3], change: fn(&View) -> View) -> Option<Vector3<f64>> {
    triangulate(&views.each_ref().map(change), 0.0).ok()
}

/// Three views of a point by one camera, with noise of different sizes claimed and none there.
fn three_views(random: &mut Random) -> (Vector3<f64>, [View; 3]) {
    let camera = random.camera();
    let point = random.point(3.0..8.0);
    let poses = [Isometry3::identity(), motion(random), motion(random)];
    let views = poses.map(|pose| View {
        camera,
        camera_from_world: pose,
        pixel: seen(&camera, &pose, &point),
        sigma: random.uniform(0.5..2.0),
    });
    (point, views)
}

fn likely(chapter: &mut Chapter) {
    let formula: Covariance = |views, point| {
        triangulate_nonlinear(views, point).map_or(Matrix3::repeat(f64::NAN), |p| p.covariance)
    };
    let mutants: [(_, Covariance); 5] = [
        ("not inverted", |views, point| information(views, point)),
        ("sigma not squared", |views, point| {
            inverse(information(&views.map(|v| View { sigma: v.sigma.sqrt(), ..v }), point))
        }),
        ("noise dropped", |views, point| {
            inverse(information(&views.map(|v| View { sigma: 1.0, ..v }), point))
        }),
        ("one view only counted once more", |views, point| {
            inverse(information(&[views[0], views[1], views[1]], point))
        }),
        ("rotations dropped", |views, point| {
            let rows = views.map(|view| {
                let in_camera = view.camera_from_world * Point3::from(*point);
                let jacobian = view.camera.projection_jacobian(&in_camera.coords);
                jacobian.map_or(Matrix2x3::repeat(f64::NAN), |j| j / view.sigma)
            });
            inverse(rows.iter().map(|row| row.tr_mul(row)).sum())
        }),
    ];
    chapter.equation("point-covariance", point_covariance, formula, &mutants);

    let formula: Bias = |views, point| {
        triangulate_nonlinear(views, point).map_or(Vector3::repeat(f64::NAN), |p| p.bias)
    };
    let mutants: [(_, Bias); 4] = [
        ("sign", |views, point| -found_bias(views, point)),
        ("half dropped", |views, point| 2.0 * found_bias(views, point)),
        ("curvature of the first view only", |views, point| {
            let [first, second, third] = *views;
            let dull = |view: View| View { sigma: 1e3 * view.sigma, ..view };
            found_bias(&[first, dull(second), dull(third)], point)
        }),
        ("curvature dropped", |_, _| Vector3::zeros()),
    ];
    chapter.equation("point-bias", point_bias, formula, &mutants);
}

type Covariance = fn(&[View; 3], &Vector3<f64>) -> Matrix3<f64>;

fn point_covariance(formula: Covariance) -> Comparison {
    let against = "how the most likely point answers to each pixel, by central differences";
    let mut comparison = Comparison::relative(against, 1e-5);
    let mut random = Random::new(32);
    for _ in 0..200 {
        let (point, views) = three_views(&mut random);
        let answers: [_; 6] = std::array::from_fn(|coordinate| {
            slope(|change| most_likely(&nudged(&views, coordinate, change), &point), 1e-2)
        });
        let answers = SMatrix::<f64, 3, 6>::from_columns(&answers);
        let expected = answers * answers.transpose();
        comparison.add(formula(&views, &point).as_slice(), expected.as_slice());
    }
    comparison
}

type Bias = fn(&[View; 3], &Vector3<f64>) -> Vector3<f64>;

fn point_bias(formula: Bias) -> Comparison {
    let against = "half the second differences of the most likely point by each pixel";
    let mut comparison = Comparison::relative(against, 5e-3);
    let mut random = Random::new(33);
    for _ in 0..200 {
        let (point, views) = three_views(&mut random);
        let expected: Vector3<f64> = (0..6)
            .map(|coordinate| {
                let along = |change| most_likely(&nudged(&views, coordinate, change), &point);
                0.5 * curvature(along, 0.05)
            })
            .sum();
        comparison.add(formula(&views, &point).as_slice(), expected.as_slice());
    }
    comparison
}

fn most_likely(views: &[View; 3], start: &Vector3<f64>) -> Vector3<f64> {
    triangulate_nonlinear(views, start).map_or(Vector3::repeat(f64::NAN), |found| found.point)
}

fn found_bias(views: &[View; 3], point: &Vector3<f64>) -> Vector3<f64> {
    triangulate_nonlinear(views, point).map_or(Vector3::repeat(f64::NAN), |found| found.bias)
}

fn inverse(matrix: Matrix3<f64>) -> Matrix3<f64> {
    matrix.try_inverse().unwrap_or(Matrix3::repeat(f64::NAN))
}

fn two_rays(chapter: &mut Chapter) {
    let mutants: [(_, RaySigma); 5] = [
        ("distances exchanged", |r1, r2, a, sigma| theory::ray_sigma(r2, r1, a, sigma)),
        ("cosine dropped", |r1, r2, a, sigma| sigma * r1.hypot(r2) / a.sin()),
        ("own noise dropped", |_, r2, a, sigma| sigma * r2 / a.sin()),
        ("tangent for sine", |r1, r2, a, sigma| sigma * r2.hypot(r1 * a.cos()) / a.tan()),
        ("deviations added", |r1, r2, a, sigma| sigma * (r2 + r1 * a.cos()) / a.sin()),
    ];
    chapter.equation("ray-sigma", ray_sigma, theory::ray_sigma, &mutants);

    let mutants: [(_, Condition); 3] = [
        ("whole angle", |a| a.sin().powi(-2)),
        ("not squared", |a| 1.0 / (0.5 * a).sin()),
        ("cosine for sine", |a| (0.5 * a).cos().powi(-2)),
    ];
    chapter.equation("point-condition", point_condition, theory::point_condition, &mutants);

    let mutants: [(_, DepthBias); 4] = [
        ("sign", |z, sigma| -theory::depth_bias(z, sigma)),
        ("sigma not squared", |z, sigma| sigma / z),
        ("half", |z, sigma| 0.5 * theory::depth_bias(z, sigma)),
        ("none", |_, _| 0.0),
    ];
    chapter.equation("depth-bias", depth_bias, theory::depth_bias, &mutants);
}

/// Takes the distances from both cameras, the parallax and the noise of a direction.
type RaySigma = fn(f64, f64, f64, f64) -> f64;

fn ray_sigma(formula: RaySigma) -> Comparison {
    let against = "central differences of where two rays of a plane meet, by both of their angles";
    let mut comparison = Comparison::relative(against, 1e-6);
    let mut random = Random::new(34);
    for _ in 0..STATES {
        let (first, second) = (random.logarithmic(1.0..20.0), random.logarithmic(1.0..20.0));
        let parallax = random.uniform(0.02..2.0);
        let sigma = random.logarithmic(1e-4..1e-2);
        // The first ray runs along z, the second one meets it at the point.
        let backwards = Vector2::new(parallax.sin(), parallax.cos());
        let start = Vector2::new(0.0, first) - second * backwards;
        let step = 1e-4 * parallax;
        let along = |first_turn: f64, second_turn: f64| {
            meeting_in_plane(first_turn, parallax + second_turn, start).y
        };
        let by_first = (along(step, 0.0) - along(-step, 0.0)) / (2.0 * step);
        let by_second = (along(0.0, step) - along(0.0, -step)) / (2.0 * step);
        let expected = sigma * by_first.hypot(by_second);
        comparison.add(&[formula(first, second, parallax, sigma)], &[expected]);
    }
    comparison
}

type Condition = fn(f64) -> f64;

fn point_condition(formula: Condition) -> Comparison {
    let against = "eigenvalues of the information, from central differences of both projections";
    let mut comparison = Comparison::relative(against, 1e-5);
    let mut random = Random::new(35);
    for _ in 0..STATES {
        let parallax = random.logarithmic(0.02..1.5);
        let (point, views) = facing(random.logarithmic(1.0..20.0), parallax);
        let eigenvalues = information(&views, &point).symmetric_eigenvalues();
        comparison.add(&[formula(parallax)], &[eigenvalues.max() / eigenvalues.min()]);
    }
    comparison
}

/// Takes a depth and its standard deviation.
type DepthBias = fn(f64, f64) -> f64;

fn depth_bias(formula: DepthBias) -> Comparison {
    let against = "the average depth over a normally distributed disparity, by Gauss-Hermite nodes";
    let mut comparison = Comparison::relative(against, 1e-4);
    let mut random = Random::new(36);
    for _ in 0..STATES {
        let camera = random.camera();
        let baseline = random.logarithmic(0.05..2.0);
        let depth = random.logarithmic(1.0..100.0);
        let disparity = camera.fx * baseline / depth;
        let noise = 1e-3 * disparity;
        let at = |error: f64| {
            depth_from_disparity(&camera, baseline, disparity + error).unwrap_or(f64::NAN)
        };
        let end = 3.0_f64.sqrt() * noise;
        let mean = (at(-end) + 4.0 * at(0.0) + at(end)) / 6.0;
        let sigma = ((at(-noise) - at(noise)) / 2.0).abs();
        comparison.add(&[formula(depth, sigma)], &[mean - depth]);
    }
    comparison
}

/// A motion after which points a few metres ahead are still in front of the camera.
fn motion(random: &mut Random) -> Isometry3<f64> {
    let length = random.uniform(0.2..1.0);
    Isometry3::from_parts(random.direction(length).into(), random.rotation(0.35).into())
}
