//! Which blocks are not zero, before and after the points of a street are eliminated, and which
//! cameras see a point in common.

use std::collections::BTreeMap;

use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::style::{Color, RGBColor};

use crate::bundle_adjustment::progress::{shared_points, short_street};
use crate::bundle_adjustment::whole::{Ba, solver};
use crate::figure::{Drawing, Drawn, Figure, GRID, INK, SERIES, decimals, letters_around};

/// Side of a camera's block and of a point's, six and three unknowns.
const CAMERA: i32 = 12;
const POINT: i32 = 6;

/// Side of a block of the Schur complement.
const REDUCED: i32 = 44;

pub fn sparsity() -> Figure {
    let street = short_street();
    let shared = shared_points(&street);
    let (reduced, _) = solver(&street).schur_complement(0.0).expect("a street");
    let block = |first: usize, second: usize| {
        reduced.fixed_view::<6, 6>(6 * (first - 1), 6 * (second - 1)).norm()
    };
    let moving = street.cameras.len() - 1;
    let pairs = || (1..=moving).flat_map(|first| (1..first).map(move |second| (first, second)));
    let points = pairs().map(|pair| shared.get(&pair).copied().unwrap_or(0).to_string());
    let columns = vec![
        ("camera", pairs().map(|(first, _)| first.to_string()).collect()),
        ("camera", pairs().map(|(_, second)| second.to_string()).collect()),
        ("points in common", points.collect()),
        ("size of the block of S", decimals(0, pairs().map(|pair| block(pair.0, pair.1)))),
    ];
    Figure::new(960, columns, |drawing| {
        let (left, right) = drawing.split_horizontally(760);
        whole(&left, &street)?;
        let (above, below) = right.split_vertically(560);
        after(&above, moving, |first, second| block(first, second) > 0.0)?;
        graph(&below, moving, &shared)
    })
}

/// For each point that is adjusted, in the order along the street, the moving cameras that see it.
fn seen_by(street: &Ba) -> Vec<Vec<usize>> {
    let mut seen_by = vec![Vec::new(); street.points.len()];
    for factor in &street.factors {
        seen_by[factor.point].push(factor.keyframe);
    }
    let mut order: Vec<usize> = (0..street.points.len()).collect();
    order.retain(|point| seen_by[*point].len() > 1);
    order.sort_by(|a, b| street.points[*a].x.total_cmp(&street.points[*b].x));
    let moving = |point: usize| seen_by[point].iter().copied().filter(|k| !street.fixed[*k]);
    order.into_iter().map(|point| moving(point).collect()).collect()
}

fn square(area: &Drawing, corner: (i32, i32), size: (i32, i32), colour: RGBColor) -> Drawn {
    let end = (corner.0 + size.0 - 1, corner.1 + size.1 - 1);
    area.draw(&Rectangle::new([corner, end], colour.filled()))?;
    Ok(())
}

fn frame(area: &Drawing, corner: (i32, i32), size: i32) -> Drawn {
    let end = (corner.0 + size, corner.1 + size);
    area.draw(&Rectangle::new([corner, end], INK.stroke_width(2)))?;
    Ok(())
}

/// The whole matrix: cameras first, then the points along the street.
fn whole(area: &Drawing, street: &Ba) -> Drawn {
    let (x, y) = (20, 90);
    let points = seen_by(street);
    let moving = street.cameras.len() as i32 - 1;
    area.draw(&Text::new("H", (x + 350, 45), letters_around(INK)))?;
    let start = moving * CAMERA;
    for k in 0..moving {
        square(area, (x + k * CAMERA, y + k * CAMERA), (CAMERA, CAMERA), SERIES[0])?;
    }
    for (index, cameras) in points.iter().enumerate() {
        let along = start + index as i32 * POINT;
        square(area, (x + along, y + along), (POINT, POINT), SERIES[1])?;
        for camera in cameras {
            let k = (*camera as i32 - 1) * CAMERA;
            square(area, (x + along, y + k), (POINT, CAMERA), SERIES[2])?;
            square(area, (x + k, y + along), (CAMERA, POINT), SERIES[2])?;
        }
    }
    let size = start + points.len() as i32 * POINT;
    area.draw(&PathElement::new(vec![(x + start, y), (x + start, y + size)], INK.stroke_width(1)))?;
    area.draw(&PathElement::new(vec![(x, y + start), (x + size, y + start)], INK.stroke_width(1)))?;
    frame(area, (x, y), size)?;
    let below = y + size + 45;
    for (name, x, colour) in
        [("cameras", 110, SERIES[0]), ("points", 310, SERIES[1]), ("who saw whom", 560, SERIES[2])]
    {
        area.draw(&Text::new(name, (x, below), letters_around(colour)))?;
    }
    Ok(())
}

/// The Schur complement.
fn after(area: &Drawing, moving: usize, filled: impl Fn(usize, usize) -> bool) -> Drawn {
    let (x, y) = (60, 90);
    area.draw(&Text::new("S", (x + REDUCED * moving as i32 / 2, 45), letters_around(INK)))?;
    for (row, column) in (1..=moving).flat_map(|row| (1..=moving).map(move |c| (row, c))) {
        if row == column || filled(row.max(column), row.min(column)) {
            let corner = (x + (column as i32 - 1) * REDUCED, y + (row as i32 - 1) * REDUCED);
            let colour = if row == column { SERIES[0] } else { SERIES[3] };
            square(area, (corner.0 + 2, corner.1 + 2), (REDUCED - 4, REDUCED - 4), colour)?;
        }
    }
    frame(area, (x, y), REDUCED * moving as i32)
}

/// Cameras along the street, and an arc for each two that see a point in common. It is the thicker
/// the more of them there are.
fn graph(area: &Drawing, moving: usize, shared: &BTreeMap<(usize, usize), usize>) -> Drawn {
    let place = |camera: usize| 60 + REDUCED / 2 + (camera as i32 - 1) * REDUCED;
    let level = 290;
    for ((first, second), points) in shared {
        let (from, to) = (f64::from(place(*second)), f64::from(place(*first)));
        let arc = (0..=40).map(|step| {
            let (sine, cosine) = (f64::from(step) * 4.5).to_radians().sin_cos();
            let x = 0.5 * (from + to) - 0.5 * (to - from) * cosine;
            (x.round() as i32, level - (1.2 * (to - from) * sine).round() as i32)
        });
        let width = 1 + *points as u32 / 8;
        area.draw(&PathElement::new(arc.collect::<Vec<_>>(), SERIES[3].stroke_width(width)))?;
    }
    area.draw(&PathElement::new(vec![(60, level), (60 + REDUCED * moving as i32, level)], GRID))?;
    for camera in 1..=moving {
        area.draw(&Circle::new((place(camera), level), 15, SERIES[0].filled()))?;
    }
    area.draw(&Text::new("who shares points", (258, 360), letters_around(SERIES[3])))?;
    Ok(())
}
