//! Drawing with plotters so that the page, light or dark, decides about the colours.

use std::error::Error;

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::{Cartesian2d, DrawingArea, IntoDrawingArea, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, RGBColor, TRANSPARENT, TextStyle};

/// A drawing and the numbers in it.
pub struct Figure {
    /// A single line of SVG whose colours are CSS variables.
    pub svg: String,
    /// Names of the columns of the data, with their units.
    pub columns: Vec<&'static str>,
    /// The data, as text. No cell contains a comma.
    pub rows: Vec<Vec<String>>,
}

pub const INK: RGBColor = RGBColor(1, 0, 0);
pub const GRID: RGBColor = RGBColor(2, 0, 0);
pub const GROUND: RGBColor = RGBColor(3, 0, 0);
pub const MEASURED: RGBColor = RGBColor(4, 0, 0);
pub const ESTIMATED: RGBColor = RGBColor(5, 0, 0);
pub const SERIES: [RGBColor; 4] = [
    RGBColor(6, 0, 0),
    RGBColor(7, 0, 0),
    RGBColor(8, 0, 0),
    RGBColor(9, 0, 0),
];

/// What the page puts in the place of each colour that a figure draws with.
const MEANING: [(RGBColor, &str); 9] = [
    (INK, "currentColor"),
    (GRID, "var(--grid)"),
    (GROUND, "var(--plot-ground)"),
    (MEASURED, "var(--measured)"),
    (ESTIMATED, "var(--estimated)"),
    (SERIES[0], "var(--series-1)"),
    (SERIES[1], "var(--series-2)"),
    (SERIES[2], "var(--series-3)"),
    (SERIES[3], "var(--series-4)"),
];

/// Width of every figure in units of its view box. A page shows it at a quarter to a half of that.
pub const WIDTH: u32 = 1280;

/// Height of letters in the same units.
pub const LETTERS: u32 = 36;

pub type Drawing<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Drawn = Result<(), Box<dyn Error>>;

/// Draws a figure of this height, and gives it as a single line of SVG.
pub fn draw(height: u32, paint: impl FnOnce(&Drawing) -> Drawn) -> String {
    let mut svg = String::new();
    {
        let drawing = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        paint(&drawing).expect("a drawing in memory fits its ranges");
        drawing
            .present()
            .expect("a drawing in memory is always written");
    }
    let size = format!("width=\"{WIDTH}\" height=\"{height}\" ");
    svg = svg.replacen(&size, "", 1).replace('\n', "");
    for (RGBColor(red, green, blue), meaning) in MEANING {
        svg = svg.replace(&format!("#{red:02X}{green:02X}{blue:02X}"), meaning);
    }
    svg
}

/// Axes with a faint grid, titles with units, and at most this many ticks.
pub fn axes<'a, X, Y>(
    drawing: &Drawing<'a>,
    (x_title, x_range, x_ticks): (&str, X, usize),
    (y_title, y_range, y_ticks): (&str, Y, usize),
) -> Result<Chart<'a, X, Y>, Box<dyn Error>>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let mut chart = ChartBuilder::on(drawing)
        .margin(20)
        .margin_right(40)
        .x_label_area_size(110)
        .y_label_area_size(if y_ticks == 0 { 70 } else { 150 })
        .build_cartesian_2d(x_range, y_range)?;
    chart
        .configure_mesh()
        .x_desc(x_title)
        .y_desc(y_title)
        .x_labels(x_ticks)
        .y_labels(y_ticks)
        .bold_line_style(GRID.stroke_width(2))
        .light_line_style(TRANSPARENT)
        .axis_style(INK.stroke_width(2))
        .label_style(letters(INK))
        .axis_desc_style(letters(INK))
        .draw()?;
    Ok(chart)
}

/// A chart with axes of the given ranges.
pub type Chart<'a, X, Y> = ChartContext<
    'a,
    SVGBackend<'a>,
    Cartesian2d<<X as AsRangedCoord>::CoordDescType, <Y as AsRangedCoord>::CoordDescType>,
>;

/// Text that begins at its place.
pub fn letters(colour: RGBColor) -> TextStyle<'static> {
    // The backend divides the size of a font by this number.
    let size = f64::from(LETTERS) * 1.24;
    ("sans-serif", size).into_font().color(&colour)
}

/// Text that stands to the right of its place, halfway up.
pub fn letters_right_of(colour: RGBColor) -> TextStyle<'static> {
    letters(colour).pos(Pos::new(HPos::Left, VPos::Center))
}

/// Text with its place in the middle.
pub fn letters_around(colour: RGBColor) -> TextStyle<'static> {
    letters(colour).pos(Pos::new(HPos::Center, VPos::Center))
}
