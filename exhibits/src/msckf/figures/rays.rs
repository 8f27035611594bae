//! Three bearings to one point, and what becomes of them when a place is wrong.

use nalgebra::Vector2;

use crate::figure::{
    self, Draw, Drawing, Drawn, ESTIMATED, Figure, INK, MEASURED, decimals, letters_around,
};

const PLACES: [[f64; 2]; 3] = [[-1.5, 0.0], [0.2, 0.3], [1.8, 0.0]];
const POINT: [f64; 2] = [0.5, 3.6];
/// By how much the last place is believed too far to the side.
const WRONG: f64 = 0.45;

fn directions() -> [Vector2<f64>; 3] {
    PLACES.map(|place| (Vector2::from(POINT) - Vector2::from(place)).normalize())
}

fn believed(wrong: f64) -> [Vector2<f64>; 3] {
    let [first, second, third] = PLACES.map(Vector2::from);
    [first, second, third + Vector2::new(wrong, 0.0)]
}

/// Where the rays of two places meet.
fn meeting(places: &[Vector2<f64>; 3], [one, other]: [usize; 2]) -> Vector2<f64> {
    let directions = directions();
    let (d, e) = (directions[one], directions[other]);
    let between = places[other] - places[one];
    let along = between.perp(&e) / d.perp(&e);
    places[one] + along * d
}

pub fn rays() -> Figure {
    let pairs = [[0, 1], [0, 2], [1, 2]];
    let meetings = |wrong| pairs.map(|pair| meeting(&believed(wrong), pair));
    let (right, wrong) = (meetings(0.0), meetings(WRONG));
    let columns = vec![
        (
            "rays",
            ["first and second", "first and third", "second and third"].map(str::to_owned).to_vec(),
        ),
        ("they meet at x (m)", decimals(2, right.iter().map(|at| at.x))),
        ("y (m)", decimals(2, right.iter().map(|at| at.y))),
        ("with the third place wrong, x (m)", decimals(2, wrong.iter().map(|at| at.x))),
        ("y (m), third place wrong", decimals(2, wrong.iter().map(|at| at.y))),
    ];
    Figure::new(700, columns, |drawing| {
        let (left, right_half) = drawing.split_horizontally(640);
        half(&left, 0.0, &right)?;
        half(&right_half, WRONG, &wrong)
    })
}

fn half(drawing: &Drawing, wrong: f64, meetings: &[Vector2<f64>; 3]) -> Drawn {
    let mut chart = figure::axes(drawing, ("x (m)", -2.4..3.0, 5), ("y (m)", -1.3..5.4, 6))?;
    let places = believed(wrong);
    for (place, direction) in places.iter().zip(directions()) {
        let far = place + 5.3 * direction;
        chart.line([(place.x, place.y), (far.x, far.y)], MEASURED, 4)?;
    }
    if wrong > 0.0 {
        let corners = [0, 1, 2, 0].map(|k| (meetings[k].x, meetings[k].y));
        chart.line(corners, INK, 7)?;
        let truth = Vector2::from(PLACES[2]);
        let short = places[2] - Vector2::new(0.22, 0.0);
        chart.arrow(&truth, &short, (0.4, 0.16), INK)?;
    }
    chart.dots(places.iter().map(|place| (place.x, place.y)), 15, ESTIMATED)?;
    let title = if wrong > 0.0 { "one place is wrong" } else { "places as they were" };
    chart.write(title, (0.3, -0.8), letters_around(INK))
}
