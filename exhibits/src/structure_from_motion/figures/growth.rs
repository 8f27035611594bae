//! A map that grows camera by camera, from above.

use crate::figure::{self, Draw, Figure, GRID, INK, SERIES, letters_around_of, plain};
use crate::structure_from_motion::street::{centre, shown};

/// One point in so many is drawn.
const POINTS: usize = 3;
/// Height of the numbers, small enough for every second one to stand on one side of the way.
const NUMBERS: f64 = 28.0;
/// How far from the way they stand, in metres.
const ASIDE: f64 = 1.5;

/// Where the number of a camera stands: across the way, on the other side than those of its neighbours.
fn beside(way: &[(f64, f64)], camera: usize) -> (f64, f64) {
    let (before, after) = (way[camera.saturating_sub(1)], way[(camera + 1).min(way.len() - 1)]);
    let (along_x, along_z) = (after.0 - before.0, after.1 - before.1);
    let side = if camera.is_multiple_of(2) { ASIDE } else { -ASIDE };
    let aside = side / along_x.hypot(along_z);
    let (x, z) = way[camera];
    (x - aside * along_z, z + aside * along_x)
}

pub fn growth() -> Figure {
    let shown = shown();
    let joined = &shown.found.joined;
    let place = |picture: usize| {
        let pose = shown.found.cameras[picture].as_ref().expect("joined");
        let place = shown.laid.point(&centre(pose));
        (place.x, place.z)
    };
    let columns = vec![
        ("picture", plain(joined.iter().map(|one| one.picture))),
        ("points seen", plain(joined.iter().map(|one| one.seen))),
        ("points that agree", plain(joined.iter().map(|one| one.inliers))),
        ("points of the map", plain(joined.iter().map(|one| one.points))),
    ];
    Figure::new(760, columns, |drawing| {
        let axes = [("x (m)", -3.0..52.0, 12), ("z (m)", -10.0..16.0, 6)];
        let [x_axis, y_axis] = axes;
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        let points = shown.found.points.iter().step_by(POINTS);
        let points = points.map(|point| shown.laid.point(&point.place));
        chart.dots(points.map(|place| (place.x, place.z)), 2, GRID)?;
        let way: Vec<(f64, f64)> = (0..joined.len()).map(place).collect();
        chart.line(way.iter().copied(), SERIES[0], 2)?;
        chart.marks(joined.iter().take(2).map(|one| place(one.picture)), 1)?;
        for (at, one) in joined.iter().enumerate() {
            let number = (at + 1).to_string();
            chart.write(&number, beside(&way, one.picture), letters_around_of(NUMBERS, INK))?;
        }
        Ok(())
    })
}
