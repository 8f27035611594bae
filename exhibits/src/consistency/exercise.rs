//! What one sighting of a landmark in the plane claims of motions of the world when its derivative is taken
//! at another estimate of the body: numbers of the exercise on first estimates.

use nalgebra::{Matrix2, Matrix2x3, Rotation2, Vector2};

use crate::chapter::Chapter;

/// The standard deviation of a sighting, in metres.
const SIGMA: f64 = 0.05;
/// How far the heading has changed in one window, in radians.
const TURNED: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// How far the position has changed in the other one, in metres.
const MOVED: f64 = 0.2;
/// How many sightings there are after a while.
const MANY: f64 = 100.0;

/// A body and the landmark that it sees, both in the world.
#[derive(Clone, Copy)]
struct Seen {
    heading: f64,
    position: Vector2<f64>,
    landmark: Vector2<f64>,
}

impl Seen {
    /// Derivatives of the landmark's coordinates in the body by heading, position and landmark, the last two of
    /// them in the world.
    fn derivatives(&self) -> (Vector2<f64>, Matrix2<f64>, Matrix2<f64>) {
        let body_from_world = *Rotation2::new(-self.heading).matrix();
        let seen = body_from_world * (self.landmark - self.position);
        (Vector2::new(seen.y, -seen.x), -body_from_world, body_from_world)
    }

    /// What the derivatives, whitened, claim along two shifts and a turn of the world that are taken at `trajectory`.
    /// `in_body` says whether steps of the position are counted in the body.
    fn claims(&self, trajectory: &Self, in_body: bool) -> Matrix2x3<f64> {
        let (by_heading, by_position, by_landmark) = self.derivatives();
        let moved = |place: &Vector2<f64>| Matrix2x3::new(1.0, 0.0, -place.y, 0.0, 1.0, place.x);
        let turned = if in_body { self.heading - trajectory.heading } else { 0.0 };
        let position = Rotation2::new(turned) * moved(&trajectory.position);
        let mut claims = by_position * position + by_landmark * moved(&trajectory.landmark);
        claims.set_column(2, &(claims.column(2) + by_heading));
        claims / SIGMA
    }
}

pub fn numbers(chapter: &mut Chapter) {
    let kept =
        Seen { heading: 0.6, position: Vector2::new(3.0, -1.0), landmark: Vector2::new(7.0, 4.0) };
    let moved = Seen { position: kept.position + MOVED * Vector2::x(), ..kept };
    let turned = Seen { heading: kept.heading + TURNED, ..kept };
    let turn_known = 1.0 / moved.claims(&kept, false).column(2).norm();
    let shift_known = 1.0 / turned.claims(&kept, true).column(0).norm();
    chapter.number("exercise_sigma", 100.0 * SIGMA, "cm", 0);
    chapter.number("exercise_turned", TURNED.to_degrees(), "°", 0);
    chapter.number("exercise_moved", 100.0 * MOVED, "cm", 0);
    chapter.number("exercise_many", MANY, "", 0);
    chapter.number("exercise_known", turn_known.to_degrees(), "°", 0);
    chapter.number("exercise_known_many", (turn_known / MANY.sqrt()).to_degrees(), "°", 1);
    chapter.number("exercise_shift_known", 100.0 * shift_known, "cm", 0);
}
