//! What chapter `two_views` shows: what binds two pictures together, the points they fix and how
//! sure those are.
//!
//! Each part registers its equations, then checks them. In formulas `k` is a camera, `m` the motion
//! `second_from_first`, `a` a parallax.

mod draws;
mod figures;
mod five_points;
mod gauge;
mod numbers;
mod oracle;
mod points;
mod worked;

use nalgebra::{Isometry3, Matrix3, Rotation3, Vector2, Vector3};
use vislam::manifold::so3;
use vislam::reprojection::Pinhole;
use vislam::two_views::{self as theory, View, essential_matrix};

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;
use oracle::seen;

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Stands for the pixel of a formula that gives none; no comparison accepts it.
const NOWHERE: Vector2<f64> = Vector2::new(f64::NAN, f64::NAN);

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    directions(chapter);
    lines(chapter);
    motions(chapter);
    gauge::equations(chapter);
    points::equations(chapter);
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
            vislam::bearing::bearing(&camera, &pixel).into_inner()
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
        let moved = theory::refine(&views, &point).map_or(f64::NAN, |found| 2.0 * found.cost);
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
        let nearest = nearest.unwrap_or(nalgebra::Matrix4::repeat(f64::NAN));
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

/// A motion after which points a few metres ahead are still in front of the camera.
fn motion(random: &mut Random) -> Isometry3<f64> {
    let length = random.uniform(0.2..1.0);
    Isometry3::from_parts(random.direction(length).into(), random.rotation(0.35).into())
}
