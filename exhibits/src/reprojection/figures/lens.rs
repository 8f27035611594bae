//! What a real lens does to a square grid, and where a model of it folds over.

use std::ops::Range;

use nalgebra::Vector2;
use vislam::reprojection::RadialTangential;

use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, GRID, INK, SERIES, decimals, letters_around,
    letters_right_of,
};
use crate::reprojection::worked::{EUROC_SIZE, euroc, one_coefficient};

/// The part of the image plane that is drawn, in pixels.
const COLUMNS_DRAWN: Range<f64> = -60.0..812.0;
const ROWS_DRAWN: Range<f64> = -70.0..565.0;

/// Lines of the grid to each side of the middle, and between them the distance in the ideal plane.
const COLUMNS: i32 = 8;
const ROWS: i32 = 5;
const SPACING: f64 = 0.15;
const GRID_WIDTH: f64 = SPACING * COLUMNS as f64;
const GRID_HEIGHT: f64 = SPACING * ROWS as f64;

/// Largest radius of an ideal point that is drawn.
const LARGEST: f64 = 1.6;

pub fn lens() -> Figure {
    let radii = || (0..=16).map(|tenth| f64::from(tenth) / 10.0);
    let shown = |lens: RadialTangential| {
        decimals(4, radii().map(|radius| lens.distort(&Vector2::new(radius, 0.0)).norm()))
    };
    let columns = vec![
        ("ideal radius", decimals(1, radii())),
        ("radius shown by the EuRoC lens", shown(euroc().lens)),
        ("radius shown by its first coefficient alone", shown(one_coefficient())),
    ];
    Figure::new(1540, columns, |drawing| {
        let (above, below) = drawing.split_vertically(880);
        bent_grid(&above)?;
        folded_radius(&below)
    })
}

/// A grid of straight lines in the world, as the pinhole and as the lens show it.
fn bent_grid(drawing: &Drawing) -> Drawn {
    let camera = euroc();
    let pinhole = camera.pinhole;
    let x_axis = ("u (px)", COLUMNS_DRAWN, 5);
    let mut chart = figure::axes(drawing, x_axis, ("v (px)", ROWS_DRAWN.end..ROWS_DRAWN.start, 5))?;
    let (width, height) = EUROC_SIZE;
    let border = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0)];
    chart.line(border, INK, 4)?;
    let pixel = |x: f64, y: f64| (pinhole.fx * x + pinhole.cx, pinhole.fy * y + pinhole.cy);
    let bent = |x: f64, y: f64| {
        let shown = camera.lens.distort(&Vector2::new(x, y));
        pixel(shown.x, shown.y)
    };
    let fractions = || (0..=60).map(|step| f64::from(step) / 30.0 - 1.0);
    for column in -COLUMNS..=COLUMNS {
        let x = SPACING * f64::from(column);
        chart.line(fractions().map(|along| bent(x, GRID_HEIGHT * along)), SERIES[0], 4)?;
    }
    for row in -ROWS..=ROWS {
        let y = SPACING * f64::from(row);
        chart.line(fractions().map(|along| bent(GRID_WIDTH * along, y)), SERIES[0], 4)?;
        for column in -COLUMNS..=COLUMNS {
            let (u, v) = pixel(SPACING * f64::from(column), y);
            if COLUMNS_DRAWN.contains(&u) && ROWS_DRAWN.contains(&v) {
                chart.line([(u, v), bent(SPACING * f64::from(column), y)], SERIES[1], 4)?;
                chart.dots([(u, v)], 7, SERIES[1])?;
            }
        }
    }
    Ok(())
}

fn folded_radius(drawing: &Drawing) -> Drawn {
    let x_axis = ("ideal radius", 0.0..LARGEST, 8);
    let mut chart = figure::axes(drawing, x_axis, ("shown radius", 0.0..1.25, 5))?;
    let series = [
        (euroc().lens, SERIES[0], "EuRoC, k1 and k2", (1.2, 0.83)),
        (one_coefficient(), SERIES[1], "k1 alone", (1.18, 0.56)),
    ];
    chart.line([(0.0, 0.0), (1.25, 1.25)], GRID, 4)?;
    chart.write("no lens", (0.5, 0.72), letters_around(INK))?;
    for (lens, colour, name, place) in series {
        let radii = (0..=80).map(|step| LARGEST * f64::from(step) / 80.0);
        let shown = |radius| (radius, lens.distort(&Vector2::new(radius, 0.0)).x);
        chart.line(radii.map(shown), colour, 5)?;
        chart.write(name, place, letters_right_of(colour))?;
    }
    let fold = one_coefficient().monotonic_radius();
    let top = (fold, one_coefficient().distort(&Vector2::new(fold, 0.0)).x);
    chart.line([(fold, 0.0), top], SERIES[1], 3)?;
    chart.dots([top], 13, SERIES[1])?;
    chart.write("fold", (fold - 0.1, 0.12), letters_around(SERIES[1]))
}
