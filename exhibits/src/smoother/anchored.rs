//! A pixel of a landmark by its inverse depth in the picture that showed it first.

use nalgebra::{Isometry3, Point3, Vector2, Vector3};

use crate::chapter::Chapter;
use crate::comparison::Comparison;

/// Random pairs of cameras and landmarks.
const LANDMARKS: usize = 300;

/// The image of the landmark (x, y, ρ) of a first camera in a second one, from the pose of the first in the second.
type Image = fn(&Isometry3<f64>, &Vector3<f64>) -> Vector2<f64>;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Image = |second_from_first, landmark| {
        let ray = landmark.xy().push(1.0);
        let scaled =
            second_from_first.rotation * ray + landmark.z * second_from_first.translation.vector;
        scaled.xy() / scaled.z
    };
    let mutants: [(_, Image); 4] = [
        ("shift not scaled", |second_from_first, landmark| {
            let ray = landmark.xy().push(1.0);
            let scaled = second_from_first.rotation * ray + second_from_first.translation.vector;
            scaled.xy() / scaled.z
        }),
        ("depth for inverse depth", |second_from_first, landmark| {
            let ray = landmark.xy().push(1.0);
            let scaled = second_from_first.rotation * ray
                + second_from_first.translation.vector / landmark.z;
            scaled.xy() / scaled.z
        }),
        ("turned the other way", |second_from_first, landmark| {
            let ray = landmark.xy().push(1.0);
            let scaled = second_from_first.rotation.inverse() * ray
                + landmark.z * second_from_first.translation.vector;
            scaled.xy() / scaled.z
        }),
        ("sign of the shift", |second_from_first, landmark| {
            let ray = landmark.xy().push(1.0);
            let scaled = second_from_first.rotation * ray
                - landmark.z * second_from_first.translation.vector;
            scaled.xy() / scaled.z
        }),
    ];
    chapter.equation("anchored-image", anchored_image, formula, &mutants);
}

fn anchored_image(formula: Image) -> Comparison {
    let against = "the image of the point itself, by its coordinates";
    Comparison::absolute(against, 1e-12, "").over(LANDMARKS, 5, |random| {
        let turn = random.rotation(0.4).into();
        let second_from_first = Isometry3::from_parts(random.direction(0.8).into(), turn);
        let point = random.point(2.0..40.0);
        let landmark = Vector3::new(point.x, point.y, 1.0) / point.z;
        let seen = second_from_first * Point3::from(point);
        (formula(&second_from_first, &landmark), seen.xy().coords / seen.z)
    })
}
