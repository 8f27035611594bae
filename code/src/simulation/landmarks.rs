//! Points that a camera can see.

use nalgebra::Vector3;
use rand::RngExt;

use super::flight::nanoseconds;
use super::random::{Purpose, random};
use super::{Flight, FlightError};

/// Landmarks on all sides of a place, six to ten metres away, spread evenly by the golden angle.
pub fn landmarks_around(centre: &Vector3<f64>, count: usize) -> Vec<Vector3<f64>> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let landmark = |index: usize| {
        let height = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let radius = (1.0 - height * height).sqrt();
        let (sine, cosine) = (golden * index as f64).sin_cos();
        // A second irrational turn makes the distances different from one another.
        let distance = 6.0 + 4.0 * (0.754_877_666 * index as f64).fract();
        centre + distance * Vector3::new(radius * cosine, radius * sine, height)
    };
    (0..count).map(landmark).collect()
}

impl Flight {
    /// Landmarks on the walls, the floor and the ceiling of a room, spread by chance and as densely
    /// everywhere. The room is the box around the places of the pictures and `margin` metres larger
    /// on every side, so that a camera sees some of it wherever it looks.
    ///
    /// # Errors
    ///
    /// A [`FlightError`] names the number that can be none of a flight, or the margin.
    pub fn room(
        &self,
        margin: f64,
        count: usize,
        seed: u64,
    ) -> Result<Vec<Vector3<f64>>, FlightError> {
        self.check()?;
        FlightError::positive("margin", margin)?;
        let (mut low, mut high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
        for k in 0..self.pictures() {
            let position = self.at(nanoseconds(k, self.picture_rate))?.state.position;
            (low, high) = (low.inf(&position), high.sup(&position));
        }
        let (low, size) = (low.add_scalar(-margin), (high - low).add_scalar(2.0 * margin));
        let mut random = random(seed, Purpose::Landmarks);
        Ok((0..count).map(|_| low + on_walls(&size, &mut random)).collect())
    }
}

/// A place on the faces of a box with a corner at the origin.
fn on_walls(size: &Vector3<f64>, random: &mut impl RngExt) -> Vector3<f64> {
    let areas = [0, 1, 2].map(|axis| size[(axis + 1) % 3] * size[(axis + 2) % 3]);
    let chosen = random.random::<f64>() * areas.iter().sum::<f64>();
    let across = [areas[0], areas[0] + areas[1]].iter().filter(|&&sum| chosen >= sum).count();
    let mut place = size.map(|length| length * random.random::<f64>());
    place[across] = if random.random() { size[across] } else { 0.0 };
    place
}
