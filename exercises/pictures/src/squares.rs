//! Matrices as squares: the larger a number, the larger its square; hollow if it is negative.

use nalgebra::DMatrix;
use widgets::{Scene, Shape, Style};

/// Columns of a list that is too long for one.
const LONGEST: usize = 12;

/// Where an entry is drawn: across and down.
fn place(matrix: &DMatrix<f64>, row: usize, column: usize) -> [f64; 2] {
    if matrix.ncols() > 1 || matrix.nrows() <= LONGEST {
        return [column as f64, row as f64];
    }
    let across = columns_of_list(matrix.nrows());
    [(row % across) as f64, (row / across) as f64]
}

/// About as many columns as rows.
fn columns_of_list(count: usize) -> usize {
    (1..count).find(|side| side * side >= count).unwrap_or(1)
}

/// Draws a matrix in a panel. `greatest` is the number whose square touches its neighbours.
pub fn draw(
    scene: &mut Scene,
    (panel, style): (usize, Style),
    matrix: &DMatrix<f64>,
    greatest: f64,
    differs: impl Fn(usize, usize) -> bool,
) {
    let (mut full, mut hollow, mut none, mut marked) = (vec![], vec![], vec![], vec![]);
    let mut corner = [0.0_f64; 2];
    for column in 0..matrix.ncols() {
        for row in 0..matrix.nrows() {
            let (at, number) = (place(matrix, row, column), matrix[(row, column)]);
            corner = [corner[0].max(at[0]), corner[1].max(at[1])];
            let side = 0.42 * (number.abs() / greatest).sqrt().min(1.0);
            if !number.is_finite() {
                none.push(at);
            } else if number < 0.0 {
                hollow.extend(square(at, side));
            } else {
                full.extend(square(at, side));
            }
            if differs(row, column) {
                marked.extend(square(at, 0.49));
            }
        }
    }
    scene.view(panel, [-0.6, corner[0].max(2.0) + 0.6], [-0.6, corner[1].max(2.0) + 0.6]);
    scene.draw(panel, (Shape::Area, style, 1.5), full);
    scene.draw(panel, (Shape::Line, style, 2.0), hollow);
    scene.draw(panel, (Shape::Crosses, Style::Ink, 5.0), none);
    scene.draw(panel, (Shape::Line, Style::Ink, 1.2), marked);
}

/// The corners of a square, and a gap behind them.
fn square([x, y]: [f64; 2], half: f64) -> [[f64; 2]; 6] {
    let corner = |dx: f64, dy: f64| [x + dx * half, y + dy * half];
    [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
        corner(-1.0, -1.0),
        [f64::NAN; 2],
    ]
}
