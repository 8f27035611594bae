//! What chapter `two_views` shows: what binds two pictures together, the points they fix and how
//! sure those are.
//!
//! Each part registers its equations, then checks them. In formulas `k` and `l` are cameras, `m` the
//! motion `second_from_first`, `q` and `r` directions before and after it, `a` a parallax and `s` a stereo camera.

mod conditions;
mod draws;
mod figures;
mod five_points;
mod numbers;
mod oracle;
mod worked;

use std::mem::swap;

use nalgebra::{
    Isometry3, Matrix3, Matrix4, Point3, Rotation3, Vector1, Vector2, Vector3, Vector6,
};
use vislam::bearing::{bearing, depth_from_disparity};
use vislam::manifold::{se3, so3};
use vislam::reprojection::Pinhole;
use vislam::two_views::{
    self as theory, StereoPinhole, StereoProjection, View, essential_matrix, fundamental_matrix,
    scale_direction, triangulate, triangulate_nonlinear,
};

use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences};
use crate::one_flight;
use crate::random::Random;
use oracle::{information, meeting_in_plane, nudged, seen};
use worked::facing;

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Stands for the pixel of a formula that gives none; no comparison accepts it.
const NOWHERE: Vector2<f64> = Vector2::new(f64::NAN, f64::NAN);

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
    one_flight::two_pictures::motion(chapter);
}

fn directions(chapter: &mut Chapter) {
    let formula: Coplanarity = |m, q, r| theory::epipolar_residual(&essential_matrix(m), q, r);
    let mutants: [(_, Coplanarity); 5] = [
        ("matrix transposed", |m, q, r| q.dot(&(essential_matrix(m) * r))),
        ("rotation transposed", |m, q, r| {
            r.dot(&m.translation.vector.cross(&m.rotation.inverse_transform_vector(q)))
        }),
        ("rotation on the left", |m, q, r| r.dot(&(m.rotation * m.translation.vector.cross(q)))),
        ("sign", |m, q, r| -r.dot(&(essential_matrix(m) * q))),
        ("centre for translation", |m, q, r| {
            r.dot(&m.inverse().translation.vector.cross(&(m.rotation * q)))
        }),
    ];
    chapter.equation("coplanarity", coplanarity, formula, &mutants);

    let formula: AnyBaseline = |turn, any, q, r| r.dot(&any.cross(&(turn * q)));
    let mutants: [(_, AnyBaseline); 3] = [
        ("rotation transposed", |turn, any, q, r| r.dot(&any.cross(&(turn.inverse() * q)))),
        ("rotation dropped", |_, any, q, r| r.dot(&any.cross(q))),
        ("directions exchanged", |turn, any, q, r| q.dot(&any.cross(&(turn * r)))),
    ];
    chapter.equation("any-baseline", any_baseline, formula, &mutants);
}

/// Takes a motion and a direction in each camera.
type Coplanarity = fn(&Isometry3<f64>, &Vector3<f64>, &Vector3<f64>) -> f64;

fn coplanarity(formula: Coplanarity) -> Comparison {
    let against =
        "zero for directions to one point, and the determinant of three columns for others";
    let mut random = Random::new(1);
    Comparison::absolute(against, 1e-13, "m³").each(0..STATES, |state| {
        let motion = motion(&mut random);
        let (point, other) = (random.point(2.0..50.0), random.direction(1.0));
        let first = point.normalize();
        let turned = motion.rotation.to_rotation_matrix() * first;
        let (second, volume) = if state % 2 == 0 {
            ((motion.rotation * point + motion.translation.vector).normalize(), 0.0)
        } else {
            let columns = [other, motion.translation.vector, turned];
            (other, Matrix3::from_columns(&columns).determinant())
        };
        (formula(&motion, &first, &second), volume)
    })
}

/// Takes a rotation, any vector, and a direction before and after the rotation.
type AnyBaseline = fn(&Rotation3<f64>, &Vector3<f64>, &Vector3<f64>, &Vector3<f64>) -> f64;

fn any_baseline(formula: AnyBaseline) -> Comparison {
    let against = "zero, for the pixels of a turning camera and any vector";
    Comparison::absolute(against, 1e-12, "m³").over(STATES, 2, |random| {
        let (camera, turn) = (random.camera(), random.rotation(0.35));
        let point = random.point(1.0..50.0);
        let [first, second] = [Rotation3::identity(), turn].map(|turn| {
            let pose = Isometry3::from_parts(Default::default(), turn.into());
            bearing(&camera, &seen(&camera, &pose, &point)).into_inner()
        });
        (formula(&turn, &random.direction(1.0), &first, &second), 0.0)
    })
}

fn lines(chapter: &mut Chapter) {
    let formula: Line = |k, l, m, pixel| line(k, l, essential_matrix(m), pixel);
    let mutants: [(_, Line); 4] = [
        ("matrix transposed", |k, l, m, pixel| line(k, l, essential_matrix(m).transpose(), pixel)),
        ("cameras exchanged", |k, l, m, pixel| line(l, k, essential_matrix(m), pixel)),
        ("motion inverted", |k, l, m, pixel| line(k, l, essential_matrix(&m.inverse()), pixel)),
        ("not scaled", |k, l, m, pixel| {
            Some(fundamental_matrix(k, l, &essential_matrix(m)) * pixel.push(1.0))
        }),
    ];
    chapter.equation("epipolar-line", epipolar_line, formula, &mutants);

    let mutants: [(_, Sampson); 4] = [
        ("distance in the second image only", |f, p, q| {
            Some(theory::epipolar_line(f, p)?.dot(&q.push(1.0)))
        }),
        ("algebraic", |f, p, q| Some(q.push(1.0).dot(&(f * p.push(1.0))))),
        ("third component counted", |f, p, q| {
            let lines = [f * p.push(1.0), f.transpose() * q.push(1.0)];
            Some(q.push(1.0).dot(&lines[0]) / lines[0].norm().hypot(lines[1].norm()))
        }),
        ("matrix transposed", |f, p, q| theory::sampson_distance(&f.transpose(), p, q)),
    ];
    chapter.equation("sampson", sampson, theory::sampson_distance, &mutants);
}

fn line(k: &Pinhole, l: &Pinhole, e: Matrix3<f64>, pixel: &Vector2<f64>) -> Option<Vector3<f64>> {
    theory::epipolar_line(&fundamental_matrix(k, l, &e), pixel)
}

/// Takes both cameras, a motion and a pixel of the first image.
type Line = fn(&Pinhole, &Pinhole, &Isometry3<f64>, &Vector2<f64>) -> Option<Vector3<f64>>;

fn epipolar_line(formula: Line) -> Comparison {
    let against = "the pixels of two points of the ray in the second image, and a length of one";
    Comparison::absolute(against, 1e-9, "px").over(STATES, 3, |random| {
        let (first, second) = (random.camera(), random.camera());
        let motion = motion(random);
        let point = random.point(3.0..6.0);
        let pixel = seen(&first, &Isometry3::identity(), &point);
        let line = formula(&first, &second, &motion, &pixel);
        let values = line.map(|line| {
            let distance = |point| line.dot(&seen(&second, &motion, &point).push(1.0));
            [distance(point), distance(1.7 * point), line.xy().norm()]
        });
        (values, [0.0, 0.0, 1.0])
    })
}

/// Takes a fundamental matrix and a pixel of each image.
type Sampson = fn(&Matrix3<f64>, &Vector2<f64>, &Vector2<f64>) -> Option<f64>;

fn sampson(formula: Sampson) -> Comparison {
    let against = "how far both pixels move to those of the most likely point, for small noise";
    Comparison::absolute(against, 1e-6, "px").over(STATES, 4, |random| {
        let camera = random.camera();
        let motion = motion(random);
        let point = random.point(2.0..10.0);
        let views = [Isometry3::identity(), motion].map(|pose| {
            let noise = Vector2::new(random.normal(1e-3), random.normal(1e-3));
            let pixel = seen(&camera, &pose, &point) + noise;
            View { camera, camera_from_world: pose, pixel, sigma: 1.0 }
        });
        let fundamental = fundamental_matrix(&camera, &camera, &essential_matrix(&motion));
        let missed = formula(&fundamental, &views[0].pixel, &views[1].pixel);
        let moved = triangulate_nonlinear(&views, &point).map_or(f64::NAN, |p| 2.0 * p.cost);
        (missed.map(f64::abs), moved.sqrt())
    })
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
    Comparison::relative(against, 1e-13).over(STATES, 5, |random| {
        let length = random.logarithmic(0.1..10.0);
        let (translation, rotation) = (random.direction(length), random.rotation(3.0));
        let column = |axis| translation.cross(&(rotation * Vector3::ith(axis, 1.0)));
        let motion = Isometry3::from_parts(translation.into(), rotation.into());
        let matrix = Matrix3::from_columns(&[0, 1, 2].map(column));
        (formula(&motion), matrix.singular_values())
    })
}

type Poses = fn(&Matrix3<f64>) -> Option<[Isometry3<f64>; 4]>;

fn essential_poses(formula: Poses) -> Comparison {
    let against = "the motion that the matrix was made from, with a baseline of one";
    Comparison::absolute(against, 1e-12, "entries").over(STATES, 6, |random| {
        let (translation, rotation) = (random.direction(1.0), random.rotation(3.0));
        let truth = Isometry3::from_parts(translation.into(), rotation.into());
        let found = formula(&(random.logarithmic(0.1..10.0) * essential_matrix(&truth)));
        let truth = truth.to_homogeneous();
        let error = |pose: &Matrix4<f64>| (pose - truth).norm();
        let found = found.into_iter().flatten().map(|pose| pose.to_homogeneous());
        (found.min_by(|one, other| error(one).total_cmp(&error(other))), truth)
    })
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
            let [x, y, z] = pose.translation.vector.into();
            Vector6::new(x, y, z, 0.0, 0.0, 0.0)
        }),
        ("camera stays", |_| Vector6::zeros()),
        ("camera turns as well", |pose| {
            let [x, y, z, ..]: [f64; 6] = scale_direction(pose).into();
            Vector6::new(x, y, z, x, y, z)
        }),
    ];
    chapter.equation("scale-null-vector", scale_null_vector, scale_direction, &mutants);

    let mutants: [(_, Observation); 4] = [
        ("sign of the baseline", |stereo, point| predicted(&with_baseline(stereo, -1.0), point)),
        ("baseline dropped", |stereo, point| predicted(&with_baseline(stereo, 0.0), point)),
        ("disparity for the right column", |stereo, point| {
            predicted(stereo, point).map(|seen| Vector3::new(seen.x, seen.y, seen.x - seen.z))
        }),
        ("right row for the right column", |stereo, point| {
            predicted(stereo, point).map(|seen| Vector3::new(seen.x, seen.y, seen.y))
        }),
    ];
    chapter.equation("stereo-projection", stereo_projection, predicted, &mutants);

    let formula: Blocks = StereoPinhole::project_with_jacobians;
    let mutants: [(_, Blocks); 4] = [
        ("baseline dropped", |s, m, p| with_baseline(s, 0.0).project_with_jacobians(m, p)),
        ("right camera on the left", |s, m, p| with_baseline(s, -1.0).project_with_jacobians(m, p)),
        ("pose block on the left", |s, m, p| {
            let seen = s.project_with_jacobians(m, p)?;
            Some(altered(seen, |seen| seen.by_pose *= se3::adjoint(&m.inverse())))
        }),
        ("point block in camera coordinates", |s, m, p| {
            let seen = s.project_with_jacobians(m, p)?;
            let turn = m.rotation.inverse().to_rotation_matrix();
            Some(altered(seen, |seen| seen.by_point *= turn))
        }),
    ];
    chapter.equation("stereo-blocks", stereo_blocks, formula, &mutants);
}

type Direction = fn(&Isometry3<f64>) -> Vector6<f64>;

fn scale_null_vector(formula: Direction) -> Comparison {
    let against = "what the motion of the points does to the pixel, with the sign turned";
    Comparison::relative(against, 1e-12).over(STATES, 21, |random| {
        let camera = random.camera();
        let pose = Isometry3::from_parts(random.direction(3.0).into(), random.rotation(3.0).into());
        let point = (pose.inverse() * Point3::from(random.point(1.0..50.0))).coords;
        let (by_pose, by_point) = camera.jacobians(&pose, &point).expect("the point is in front");
        (by_pose * formula(&pose), -by_point * point)
    })
}

/// Takes a stereo camera and a point in coordinates of the left one.
type Observation = fn(&StereoPinhole, &Vector3<f64>) -> Option<Vector3<f64>>;

fn stereo_projection(formula: Observation) -> Comparison {
    let against = "the projections into both cameras";
    Comparison::absolute(against, 1e-10, "px").over(STATES, 22, |random| {
        let (stereo, point) = (stereo(random), random.point(0.5..50.0));
        (formula(&stereo, &point), observed(&stereo, &Isometry3::identity(), &point))
    })
}

type Blocks = fn(&StereoPinhole, &Isometry3<f64>, &Vector3<f64>) -> Option<StereoProjection>;

fn stereo_blocks(formula: Blocks) -> Comparison {
    let against = "central differences of the projections into both cameras";
    Comparison::relative(against, 1e-7).over(STATES, 23, |random| {
        let (stereo, pose) = (stereo(random), motion(random));
        let point = random.point(2.0..20.0);
        let by_pose =
            differences(1e-5, |twist| observed(&stereo, &se3::retract(&pose, &twist), &point));
        let by_point = differences(1e-5, |step| observed(&stereo, &pose, &(point + step)));
        let blocks = formula(&stereo, &pose, &point);
        (blocks.map(|seen| (seen.by_pose, seen.by_point)), (by_pose, by_point))
    })
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

fn linear(chapter: &mut Chapter) {
    let formula: Linear = |views| triangulate(views, 0.0).ok();
    let mutants: [(_, Linear); 5] = [
        ("poses inverted", |views| changed(views, |view| view.camera_from_world.inverse_mut())),
        ("translations negated", |views| {
            changed(views, |view| view.camera_from_world.translation.vector.neg_mut())
        }),
        ("rotations dropped", |views| {
            changed(views, |view| view.camera_from_world.rotation = Default::default())
        }),
        ("focal lengths exchanged", |views| {
            changed(views, |View { camera, .. }| swap(&mut camera.fx, &mut camera.fy))
        }),
        ("principal point dropped", |views| {
            changed(views, |View { camera, .. }| (camera.cx, camera.cy) = (0.0, 0.0))
        }),
    ];
    chapter.equation("dlt-rows", dlt_rows, formula, &mutants);
}

type Linear = fn(&[View; 3]) -> Option<Vector3<f64>>;

fn dlt_rows(formula: Linear) -> Comparison {
    let against = "the point whose pixels the views hold, without noise";
    Comparison::relative(against, 1e-10).over(STATES, 31, |random| {
        let (point, views) = three_views(random);
        // A mutant's point may lie behind its cameras; then it is no point at all.
        (formula(&views).unwrap_or(Vector3::repeat(1e9)), point)
    })
}

/// The linear point of views that were changed.
fn changed(views: &[View; 3], change: fn(&mut View)) -> Option<Vector3<f64>> {
    let mut views = *views;
    views.iter_mut().for_each(change);
    triangulate(&views, 0.0).ok()
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
    let formula: Covariance =
        |views, point| Some(triangulate_nonlinear(views, point).ok()?.covariance);
    let mutants: [(_, Covariance); 5] = [
        ("not inverted", |views, point| Some(information(views, point))),
        ("sigma not squared", |views, point| {
            information(&views.map(|v| View { sigma: v.sigma.sqrt(), ..v }), point).try_inverse()
        }),
        ("noise dropped", |views, point| {
            information(&views.map(|v| View { sigma: 1.0, ..v }), point).try_inverse()
        }),
        ("one view only counted once more", |[first, second, _], point| {
            information(&[*first, *second, *second], point).try_inverse()
        }),
        ("rotations dropped", |views, point| {
            let mut information = Matrix3::zeros();
            for view in views {
                let in_camera = view.camera_from_world * Point3::from(*point);
                let row = view.camera.projection_jacobian(&in_camera.coords)? / view.sigma;
                information += row.tr_mul(&row);
            }
            information.try_inverse()
        }),
    ];
    chapter.equation("point-covariance", point_covariance, formula, &mutants);

    let mutants: [(_, Bias); 4] = [
        ("sign", |views, point| Some(-bias(views, point)?)),
        ("half dropped", |views, point| Some(2.0 * bias(views, point)?)),
        ("curvature of the first view only", |views, point| {
            let dull = |view: View| View { sigma: 1e3 * view.sigma, ..view };
            bias(&[views[0], dull(views[1]), dull(views[2])], point)
        }),
        ("curvature dropped", |_, _| Some(Vector3::zeros())),
    ];
    chapter.equation("point-bias", point_bias, bias, &mutants);
}

type Covariance = fn(&[View; 3], &Vector3<f64>) -> Option<Matrix3<f64>>;

fn point_covariance(formula: Covariance) -> Comparison {
    let against = "how the most likely point answers to each pixel, by central differences";
    Comparison::relative(against, 1e-5).over(200, 32, |random| {
        let (point, views) = three_views(random);
        let answers = differences::<3, 6>(1e-2, |change| {
            most_likely(&nudged(&views, change.as_slice()), &point)
        });
        (formula(&views, &point), answers * answers.transpose())
    })
}

type Bias = fn(&[View; 3], &Vector3<f64>) -> Option<Vector3<f64>>;

fn point_bias(formula: Bias) -> Comparison {
    let against = "half the second differences of the most likely point by each pixel";
    Comparison::relative(against, 5e-3).over(200, 33, |random| {
        let (point, views) = three_views(random);
        let (step, here) = (0.05, most_likely(&views, &point));
        let curvature = |coordinate: usize| {
            let along = |change| {
                let nudge = Vector6::ith(coordinate, change);
                most_likely(&nudged(&views, nudge.as_slice()), &point)
            };
            (along(step) - 2.0 * here + along(-step)) / (step * step)
        };
        (formula(&views, &point), (0..6).map(|pixel| 0.5 * curvature(pixel)).sum::<Vector3<f64>>())
    })
}

fn most_likely(views: &[View; 3], start: &Vector3<f64>) -> Vector3<f64> {
    triangulate_nonlinear(views, start).map_or(Vector3::repeat(f64::NAN), |found| found.point)
}

fn bias(views: &[View; 3], point: &Vector3<f64>) -> Option<Vector3<f64>> {
    Some(triangulate_nonlinear(views, point).ok()?.bias)
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
    Comparison::relative(against, 1e-6).over(STATES, 34, |random| {
        let (first, second) = (random.logarithmic(1.0..20.0), random.logarithmic(1.0..20.0));
        let parallax = random.uniform(0.02..2.0);
        let sigma = random.logarithmic(1e-4..1e-2);
        // The first ray runs along z, the second one meets it at the point.
        let start =
            Vector2::new(0.0, first) - second * Vector2::new(parallax.sin(), parallax.cos());
        let by_turns = differences(1e-4 * parallax, |turns: Vector2<f64>| {
            Vector1::new(meeting_in_plane(turns.x, parallax + turns.y, start).y)
        });
        (formula(first, second, parallax, sigma), sigma * by_turns.x.hypot(by_turns.y))
    })
}

type Condition = fn(f64) -> f64;

fn point_condition(formula: Condition) -> Comparison {
    let against = "eigenvalues of the information, from central differences of both projections";
    Comparison::relative(against, 1e-5).over(STATES, 35, |random| {
        let parallax = random.logarithmic(0.02..1.5);
        let (point, views) = facing(random.logarithmic(1.0..20.0), parallax);
        let eigenvalues = information(&views, &point).symmetric_eigenvalues();
        (formula(parallax), eigenvalues.max() / eigenvalues.min())
    })
}

/// Takes a depth and its standard deviation.
type DepthBias = fn(f64, f64) -> f64;

fn depth_bias(formula: DepthBias) -> Comparison {
    let against = "the average depth over a normally distributed disparity, by Gauss-Hermite nodes";
    Comparison::relative(against, 1e-4).over(STATES, 36, |random| {
        let camera = random.camera();
        let baseline = random.logarithmic(0.05..2.0);
        let depth = random.logarithmic(1.0..100.0);
        let disparity = camera.fx * baseline / depth;
        let noise = 1e-3 * disparity;
        let at =
            |error| depth_from_disparity(&camera, baseline, disparity + error).unwrap_or(f64::NAN);
        let end = 3.0_f64.sqrt() * noise;
        let mean = (at(-end) + 4.0 * at(0.0) + at(end)) / 6.0;
        let sigma = ((at(-noise) - at(noise)) / 2.0).abs();
        (formula(depth, sigma), mean - depth)
    })
}

/// A motion after which points a few metres ahead are still in front of the camera.
fn motion(random: &mut Random) -> Isometry3<f64> {
    let length = random.uniform(0.2..1.0);
    Isometry3::from_parts(random.direction(length).into(), random.rotation(0.35).into())
}
