//! A map that grows camera by camera, from above.

use crate::figure::{self, Draw, Figure, GRID, INK, SERIES, letters_right_of, plain};
use crate::structure_from_motion::street::{centre, shown};

/// One point in so many is drawn.
const POINTS: usize = 3;

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
        chart.line(way, SERIES[0], 2)?;
        chart.marks(joined.iter().take(2).map(|one| place(one.picture)), 1)?;
        for (at, one) in joined.iter().enumerate() {
            let (x, z) = place(one.picture);
            let above = if at % 2 == 0 { 1.0 } else { -1.0 };
            chart.write(
                &(at + 1).to_string(),
                (x - 0.4, z - 1.2 * above),
                letters_right_of(INK),
            )?;
        }
        Ok(())
    })
}
