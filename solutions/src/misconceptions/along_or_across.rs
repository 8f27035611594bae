//! Wrong answers to [`along_or_across`](crate::along_or_across).

use exercise_spec::along_or_across::*;
use nalgebra::{Matrix3, Vector3};

use super::Wrong;
use crate::along_or_across as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    drag_along: right::drag_along,
    drag_across: right::drag_across,
    predicted_moves: right::predicted_moves,
    exact_moves: right::exact_moves,
    least_noticed_drag: right::least_noticed_drag,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let along = |misconception, drag_along| {
        Wrong::new(misconception, Functions { drag_along, ..REFERENCE })
    };
    let least = |misconception, least_noticed_drag| {
        Wrong::new(misconception, Functions { least_noticed_drag, ..REFERENCE })
    };
    vec![
        along(&ALONG_THE_AXIS, |views, seen_from, _, distance| {
            views[seen_from].camera_from_world.inverse_transform_vector(&(distance * Vector3::z()))
        }),
        along(&TOWARDS_THE_CAMERA, |views, seen_from, point, distance| {
            -right::drag_along(views, seen_from, point, distance)
        }),
        along(&UNIT_FORGOTTEN, |views, seen_from, point, distance| {
            distance * from_centre(&views[seen_from], point)
        }),
        along(&DEPTH_FOR_DISTANCE, |views, seen_from, point, distance| {
            let view = &views[seen_from];
            let depth = view.camera_from_world.transform_point(&point.into()).z;
            distance / depth * from_centre(view, point)
        }),
        Wrong::new(
            &CAMERA_COORDINATES,
            Functions {
                drag_along: |views, seen_from, point, distance| {
                    let turn = views[seen_from].camera_from_world.rotation;
                    turn * right::drag_along(views, seen_from, point, distance)
                },
                drag_across: |views, seen_from, point, distance| {
                    let turn = views[seen_from].camera_from_world.rotation;
                    turn * right::drag_across(views, seen_from, point, distance)
                },
                least_noticed_drag: |views, point| {
                    let turn = views[0].camera_from_world.rotation;
                    turn * right::least_noticed_drag(views, point)
                },
                ..REFERENCE
            },
        ),
        along(&FROM_THE_ORIGIN, |_, _, point, distance| distance * point.normalize()),
        along(&TRANSLATION_FOR_CENTRE, |views, seen_from, point, distance| {
            let place = views[seen_from].camera_from_world.translation.vector;
            distance * (point - place).normalize()
        }),
        Wrong::new(
            &OTHER_CAMERA,
            Functions {
                drag_along: |views, _, point, distance| {
                    right::drag_along(views, 0, point, distance)
                },
                drag_across: |views, _, point, distance| {
                    right::drag_across(views, 0, point, distance)
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &ALONG_X,
            Functions {
                drag_across: |views, seen_from, _, distance| {
                    let across = distance * Vector3::x();
                    views[seen_from].camera_from_world.inverse_transform_vector(&across)
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &PRODUCT_NOT_UNIT,
            Functions {
                drag_across: |views, seen_from, point, distance| {
                    let pose = views[seen_from].camera_from_world;
                    let ray = pose.transform_point(&point.into()).coords.normalize();
                    pose.inverse_transform_vector(&(distance * Vector3::y().cross(&ray)))
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &TO_THE_LEFT,
            Functions {
                drag_across: |views, seen_from, point, distance| {
                    -right::drag_across(views, seen_from, point, distance)
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &DRAG_NOT_TURNED,
            Functions {
                predicted_moves: |views, point, drag| {
                    let seen =
                        |view: View| right::predicted_moves(vec![view], point, turned(&view, drag));
                    views.into_iter().flat_map(seen).collect()
                },
                exact_moves: |views, point, drag| {
                    let seen =
                        |view: View| right::exact_moves(vec![view], point, turned(&view, drag));
                    views.into_iter().flat_map(seen).collect()
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &OLD_MINUS_NEW,
            Functions {
                predicted_moves: |views, point, drag| right::predicted_moves(views, point, -drag),
                exact_moves: |views, point, drag| {
                    let moves = right::exact_moves(views, point, drag);
                    moves.into_iter().map(|pixel| -pixel).collect()
                },
                ..REFERENCE
            },
        ),
        Wrong::new(
            &EXACT_FOR_FIRST_ORDER,
            Functions { predicted_moves: right::exact_moves, ..REFERENCE },
        ),
        Wrong::new(
            &FIRST_ORDER_FOR_EXACT,
            Functions { exact_moves: right::predicted_moves, ..REFERENCE },
        ),
        least(&FIRST_RAY_ONLY, |views, point| right::drag_along(views, 0, point, 1.0)),
        least(&MOST_NOTICED, |views, point| {
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            let moves = axes.map(|axis| right::predicted_moves(views.clone(), point, axis));
            let information = Matrix3::from_fn(|row, column| {
                moves[row].iter().zip(&moves[column]).map(|(a, b)| a.dot(b)).sum()
            });
            let eigen = information.symmetric_eigen();
            eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned()
        }),
    ]
}

/// From the centre of a camera to a point.
fn from_centre(view: &View, point: Vector3<f64>) -> Vector3<f64> {
    point - view.camera_from_world.inverse().translation.vector
}

/// The drag in the world whose numbers in the axes of a camera are those given.
fn turned(view: &View, drag: Vector3<f64>) -> Vector3<f64> {
    view.camera_from_world.inverse_transform_vector(&drag)
}
