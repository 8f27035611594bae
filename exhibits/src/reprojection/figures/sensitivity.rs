//! By how much small motions move a pixel, over the depth of its point.

use nalgebra::Vector3;
use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, SERIES, decimals, letters_right_of};
use crate::reprojection::worked::{POINT, blocks};

/// Metres along the optical axis.
const DEPTHS: [f64; 6] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0];

const MILLIRADIAN: f64 = 1e-3;
const CENTIMETRE: f64 = 1e-2;

/// What each curve is called, in two lines.
const NAMES: [[&str; 2]; 4] = [
    ["a milliradian", ""],
    ["1 cm sideways", ""],
    ["1 cm forward,", "same bearing"],
    ["1 cm forward,", "same offset"],
];

pub fn sensitivity() -> Figure {
    let moves = DEPTHS.map(moves);
    let of = |index: usize| moves.map(|moves| moves[index]);
    let columns = vec![
        ("depth (m)", DEPTHS.iter().map(f64::to_string).collect()),
        ("a milliradian about y (px)", decimals(5, of(0))),
        ("a centimetre to the side (px)", decimals(5, of(1))),
        ("a centimetre forward at the worked bearing (px)", decimals(5, of(2))),
        ("a centimetre forward at the worked offset (px)", decimals(5, of(3))),
    ];
    Figure::new(900, columns, |drawing| {
        let x_axis = ("depth (m)", (0.9..520.0).log_scale(), 3);
        let y_axis = ("move of the column (px)", (0.0001..10.0).log_scale(), 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        for (index, [first, second]) in NAMES.into_iter().enumerate() {
            let places = DEPTHS.into_iter().zip(of(index));
            chart.line(places.clone(), SERIES[index], 5)?;
            chart.marks(places, index)?;
            let (x, y) = (1.12 * DEPTHS[5], moves[5][index]);
            chart.write(first, (x, y), letters_right_of(SERIES[index]))?;
            chart.write(second, (x, y / 1.7), letters_right_of(SERIES[index]))?;
        }
        Ok(())
    })
}

/// Columns by which the pixel moves for each of the four motions.
fn moves(depth: f64) -> [f64; 4] {
    let (along_bearing, _) = blocks(&((depth / POINT.z) * POINT));
    let (at_offset, _) = blocks(&Vector3::new(POINT.x, POINT.y, depth));
    [
        MILLIRADIAN * along_bearing[(0, 4)].abs(),
        CENTIMETRE * along_bearing[(0, 0)].abs(),
        CENTIMETRE * along_bearing[(0, 2)].abs(),
        CENTIMETRE * at_offset[(0, 2)].abs(),
    ]
}
