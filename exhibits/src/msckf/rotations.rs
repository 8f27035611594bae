//! How many numbers the rotations of a track touch.

use super::TRACKS;
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Count = |m| 18.0 * m * m + 72.0 * m - 94.0;
    let mutants: [(_, Count); 3] = [
        ("in proportion to the length", |m| 90.0 * m - 94.0),
        ("whole rows turned", |m| (6.0 * m - 6.0) * (6.0 * m + 10.0)),
        ("the camera's columns forgotten", |m| 18.0 * m * m + 36.0 * m - 58.0),
    ];
    chapter.equation("rotation-count", rotation_count, formula, &mutants);
    chapter.number("rotations_11", 6.0 * 11.0 - 6.0, "", 0);
    chapter.number("turned_11", formula(11.0), "", 0);
    chapter.number("turned_22", formula(22.0), "", 0);
    chapter.number("turned_ratio", formula(22.0) / formula(11.0), "", 1);
}

type Count = fn(f64) -> f64;

/// Goes through the elimination with what can be other than zero, and counts the pairs of which one is.
fn rotation_count(formula: Count) -> Comparison {
    let against = "a walk through the elimination that counts what is not zero";
    Comparison::absolute(against, 0.5, "pairs")
        .each(2..TRACKS, |sights| (formula(sights as f64), counted(sights) as f64))
}

/// Pairs of numbers that the elimination of a landmark seen so often turns.
pub fn counted(sights: usize) -> usize {
    let width = 3 + 6 * sights + 6 + 1;
    let own = |row: usize, column: usize| {
        let pose = 3 + 6 * (row / 2);
        column < 3 || (pose..pose + 6).contains(&column) || column >= width - 7
    };
    let mut rows: Vec<Vec<bool>> =
        (0..2 * sights).map(|row| (0..width).map(|column| own(row, column)).collect()).collect();
    let mut pairs = 0;
    for column in 0..3 {
        for row in (column + 1..2 * sights).rev() {
            let (above, below) = rows.split_at_mut(row);
            for (upper, lower) in above[row - 1].iter_mut().zip(&mut below[0]) {
                let either = *upper || *lower;
                (*upper, *lower) = (either, either);
                pairs += usize::from(either);
            }
            below[0][column] = false;
        }
    }
    pairs
}
