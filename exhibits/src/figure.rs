//! Drawing with plotters so that the page, light or dark, decides about the colours.

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Display;
use std::ops::Range;

use nalgebra::Vector2;
use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::element::{Circle, EmptyElement, Polygon, Text};
use plotters::prelude::{Cartesian2d, DrawingArea, IntoDrawingArea, SVGBackend};
use plotters::series::LineSeries;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, RGBColor, TRANSPARENT, TextStyle};

/// A drawing and the numbers in it.
pub struct Figure {
    /// A single line of SVG whose colours are CSS variables.
    pub svg: String,
    /// Names of the columns of the data, with their units.
    pub columns: Vec<&'static str>,
    /// The data, as text.
    pub rows: Vec<Vec<String>>,
    /// The rectangles that lead to another place of the book.
    pub links: Vec<Link>,
}

/// A rectangle of a figure that leads to another place of the book. The press makes a link of it and writes the name
/// of the place at its lower edge.
pub struct Link {
    /// What the rectangle stands for.
    pub name: String,
    /// The label of the place, such as `sec:msckf`.
    pub to: &'static str,
    /// What is written before the name of the place.
    pub before: &'static str,
    /// Left and upper edge, in units of the view box.
    pub corner: (i32, i32),
    /// Width and height, in the same units.
    pub size: (i32, i32),
}

/// A column of a figure's data: its name with the unit, and a cell for every row.
pub type Column = (&'static str, Vec<String>);

impl Figure {
    /// A figure of this height with its data by columns.
    pub fn new(height: u32, columns: Vec<Column>, paint: impl FnOnce(&Drawing) -> Drawn) -> Self {
        let (columns, cells): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
        let length = cells.iter().map(Vec::len).max().unwrap_or(0);
        let row = |index| cells.iter().filter_map(move |column| column.get(index).cloned());
        let rows = (0..length).map(|index| row(index).collect()).collect();
        Self { svg: draw(height, paint), columns, rows, links: Vec::new() }
    }

    /// The same figure with rectangles that lead somewhere.
    pub fn with_links(self, links: Vec<Link>) -> Self {
        Self { links, ..self }
    }
}

/// Cells as short as they can be written.
pub fn plain(values: impl IntoIterator<Item = impl Display>) -> Vec<String> {
    values.into_iter().map(|value| value.to_string()).collect()
}

/// Cells with this many digits after the decimal point.
pub fn decimals(digits: usize, values: impl IntoIterator<Item = f64>) -> Vec<String> {
    values.into_iter().map(|value| format!("{value:.digits$}")).collect()
}

/// Cells as a number times a power of ten, with this many digits after the decimal point.
pub fn powers(digits: usize, values: impl IntoIterator<Item = f64>) -> Vec<String> {
    values.into_iter().map(|value| format!("{value:.digits$e}")).collect()
}

pub const INK: RGBColor = RGBColor(1, 0, 0);
pub const GRID: RGBColor = RGBColor(2, 0, 0);
/// The page behind a figure, for marks on what is filled.
pub const PAPER: RGBColor = RGBColor(3, 0, 0);
pub const MEASURED: RGBColor = RGBColor(4, 0, 0);
pub const ESTIMATED: RGBColor = RGBColor(5, 0, 0);
pub const SERIES: [RGBColor; 5] = [
    RGBColor(6, 0, 0),
    RGBColor(7, 0, 0),
    RGBColor(8, 0, 0),
    RGBColor(9, 0, 0),
    RGBColor(10, 0, 0),
];

/// What the page puts in the place of each colour that a figure draws with.
const MEANING: [(RGBColor, &str); 10] = [
    (INK, "currentColor"),
    (GRID, "var(--grid)"),
    (PAPER, "var(--plot-ground)"),
    (MEASURED, "var(--measured)"),
    (ESTIMATED, "var(--estimated)"),
    (SERIES[0], "var(--series-1)"),
    (SERIES[1], "var(--series-2)"),
    (SERIES[2], "var(--series-3)"),
    (SERIES[3], "var(--series-4)"),
    (SERIES[4], "var(--series-5)"),
];

/// Width of every figure in units of its view box. A page shows it at a quarter to a half of that.
pub const WIDTH: u32 = 1280;

/// Height of letters in the same units.
const LETTERS: f64 = 36.0;

pub type Drawing<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Drawn = Result<(), Box<dyn Error>>;

/// Draws a figure of this height, and gives it as a single line of SVG.
pub fn draw(height: u32, paint: impl FnOnce(&Drawing) -> Drawn) -> String {
    let mut svg = String::new();
    {
        let drawing = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        paint(&drawing).expect("a drawing in memory fits its ranges");
        drawing.present().expect("a drawing in memory is always written");
    }
    let size = format!("width=\"{WIDTH}\" height=\"{height}\" ");
    svg = without_repeats(&svg.replacen(&size, "", 1).replace('\n', ""));
    for (RGBColor(red, green, blue), meaning) in MEANING {
        svg = svg.replace(&format!("#{red:02X}{green:02X}{blue:02X}"), meaning);
    }
    svg
}

/// The same drawing, in which no point of a line stands twice in a row: coordinates are whole numbers, and the points of
/// a curve lie closer.
fn without_repeats(svg: &str) -> String {
    let mut lines = svg.split("points=\"");
    let mut drawn = lines.next().unwrap_or("").to_owned();
    for line in lines {
        let (points, rest) = line.split_once('"').unwrap_or((line, ""));
        let mut kept: Vec<&str> = points.split_whitespace().collect();
        kept.dedup();
        // A line of one point would not be drawn, and a round cap makes a dot of it.
        if let [point] = kept[..] {
            kept.push(point);
        }
        drawn.push_str(&format!("points=\"{}\"{rest}", kept.join(" ")));
    }
    drawn
}

/// Axes with a faint grid, titles with units, and at most this many ticks. A vertical axis without
/// ticks takes less room.
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
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .bold_line_style(GRID.stroke_width(2))
        .light_line_style(TRANSPARENT)
        .axis_style(INK.stroke_width(2))
        .label_style(letters(INK))
        .axis_desc_style(letters(INK))
        .draw()?;
    Ok(chart)
}

/// The marks of the series and their names, so many in a row, over the whole width.
pub fn keys<'a>(
    drawing: &Drawing,
    in_a_row: usize,
    names: impl ExactSizeIterator<Item = &'a str>,
) -> Drawn {
    let (across, rows) = (in_a_row as f64, names.len().div_ceil(in_a_row) as f64);
    let mut chart =
        ChartBuilder::on(drawing).margin(10).build_cartesian_2d(0.0..across, 0.0..rows)?;
    for (series, name) in names.enumerate() {
        let (column, row) = ((series % in_a_row) as f64, (series / in_a_row) as f64);
        let (x, y) = (column + across * 0.08 / 3.0, rows - 0.5 - row);
        chart.key(series, name, (x, y), x + across * 0.05 / 3.0)?;
    }
    Ok(())
}

/// What points in a plane reach over.
pub struct Extent {
    pub x: Range<f64>,
    pub y: Range<f64>,
}

/// Axes on which a metre is as long in both directions, and the height of a figure that has them.
pub struct Map {
    pub x: Range<f64>,
    pub y: Range<f64>,
    /// Of the horizontal axis, in metres.
    pub width: f64,
    pub height: u32,
}

impl Extent {
    pub fn of<'a>(points: impl Iterator<Item = &'a (f64, f64)> + Clone) -> Self {
        let range = |of: fn(&(f64, f64)) -> f64| {
            let all = points.clone().map(of);
            all.fold(f64::INFINITY..f64::NEG_INFINITY, |range, x| {
                range.start.min(x)..range.end.max(x)
            })
        };
        Self { x: range(|at| at.0), y: range(|at| at.1) }
    }

    /// A map of it with a margin in metres, and room for words above it, as a part of the width.
    pub fn map(&self, margin: f64, above: f64) -> Map {
        let Self { x, y } = self;
        let width = x.end - x.start + 2.0 * margin;
        let above = above * width;
        let tall = y.end - y.start + 2.0 * margin + above;
        // The plot is 1070 units wide.
        let height = (1070.0 * tall / width) as u32 + 150;
        let x = x.start - margin..x.end + margin;
        Map { x, y: y.start - margin..y.end + margin + above, width, height }
    }
}

/// A tick without needless zeros, so that 0.30000000000000004 is 0.3 and 20.0 is 20.
fn tick(value: &f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{rounded}").replace('-', "\u{2212}")
}

/// A chart with axes of the given ranges.
pub type Chart<'a, X, Y> = ChartContext<
    'a,
    SVGBackend<'a>,
    Cartesian2d<<X as AsRangedCoord>::CoordDescType, <Y as AsRangedCoord>::CoordDescType>,
>;

/// What most charts consist of.
pub trait Draw {
    /// A line through points.
    fn line(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        colour: impl Color,
        width: u32,
    ) -> Drawn;

    /// The mark of a series at each of these points.
    fn marks(&mut self, points: impl IntoIterator<Item = (f64, f64)>, series: usize) -> Drawn;

    /// Text at a point; the style says how it stands there.
    fn write(&mut self, text: &str, at: (f64, f64), style: TextStyle<'static>) -> Drawn;

    /// The mark of a series and, at the same height, its name from `name_x` on.
    fn key(&mut self, series: usize, name: &str, mark: (f64, f64), name_x: f64) -> Drawn {
        self.marks([mark], series)?;
        self.write(name, (name_x, mark.1), letters_right_of(SERIES[series]))
    }

    /// A filled circle at each of these points.
    fn dots(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        radius: i32,
        colour: impl Color,
    ) -> Drawn;

    /// An arrow with a head that is this part of its length, and at most so many units to each side
    /// of its end.
    fn arrow(
        &mut self,
        from: &Vector2<f64>,
        to: &Vector2<f64>,
        head: (f64, f64),
        colour: RGBColor,
    ) -> Drawn;
}

impl<X, Y> Draw for ChartContext<'_, SVGBackend<'_>, Cartesian2d<X, Y>>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    fn line(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        colour: impl Color,
        width: u32,
    ) -> Drawn {
        self.draw_series(LineSeries::new(points, colour.stroke_width(width)))?;
        Ok(())
    }

    fn marks(&mut self, points: impl IntoIterator<Item = (f64, f64)>, series: usize) -> Drawn {
        let marks = points.into_iter().map(|at| EmptyElement::at(at) + marker(series));
        self.draw_series(marks)?;
        Ok(())
    }

    fn write(&mut self, text: &str, at: (f64, f64), style: TextStyle<'static>) -> Drawn {
        self.draw_series([Text::new(text.to_owned(), at, style)])?;
        Ok(())
    }

    fn dots(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        radius: i32,
        colour: impl Color,
    ) -> Drawn {
        let circles = points.into_iter().map(|at| Circle::new(at, radius, colour.filled()));
        self.draw_series(circles)?;
        Ok(())
    }

    fn arrow(
        &mut self,
        from: &Vector2<f64>,
        to: &Vector2<f64>,
        head: (f64, f64),
        colour: RGBColor,
    ) -> Drawn {
        self.line([(from.x, from.y), (to.x, to.y)], colour, 5)?;
        self.draw_series([Polygon::new(arrow_head(from, to, head), colour.filled())])?;
        Ok(())
    }
}

/// Text that begins at its place.
pub fn letters(colour: RGBColor) -> TextStyle<'static> {
    letters_of(LETTERS, colour)
}

/// Text of this height that begins at its place.
pub fn letters_of(height: f64, colour: RGBColor) -> TextStyle<'static> {
    // The backend divides the size of a font by this number.
    ("sans-serif", height * 1.24).into_font().color(&colour)
}

/// Text that stands to the right of its place, halfway up.
pub fn letters_right_of(colour: RGBColor) -> TextStyle<'static> {
    letters(colour).pos(Pos::new(HPos::Left, VPos::Center))
}

/// Text with its place in the middle.
pub fn letters_around(colour: RGBColor) -> TextStyle<'static> {
    letters_around_of(LETTERS, colour)
}

/// Text of this height with its place in the middle.
pub fn letters_around_of(height: f64, colour: RGBColor) -> TextStyle<'static> {
    letters_of(height, colour).pos(Pos::new(HPos::Center, VPos::Center))
}

/// A filled mark around the origin in the colour of a series. Each of the four series has a shape
/// of its own, for readers who do not go by colour.
pub fn marker(series: usize) -> Polygon<(i32, i32)> {
    let corners = match series {
        0 => disc(14.0),
        1 => vec![(0, -17), (15, 11), (-15, 11)],
        2 => vec![(-12, -12), (12, -12), (12, 12), (-12, 12)],
        3 => vec![(0, -18), (18, 0), (0, 18), (-18, 0)],
        _ => vec![(0, 17), (15, -11), (-15, -11)],
    };
    Polygon::new(corners, SERIES[series].filled())
}

fn disc(radius: f64) -> Vec<(i32, i32)> {
    let corner = |index: i32| {
        let (sine, cosine) = (TAU * f64::from(index) / 20.0).sin_cos();
        ((radius * cosine).round() as i32, (radius * sine).round() as i32)
    };
    (0..20).map(corner).collect()
}

/// A triangle around the end of an arrow: a part of its length, and at most `largest` units to each
/// side of the end.
fn arrow_head(
    from: &Vector2<f64>,
    to: &Vector2<f64>,
    (part, largest): (f64, f64),
) -> Vec<(f64, f64)> {
    let length = (to - from).norm();
    if length == 0.0 {
        return vec![(to.x, to.y)];
    }
    let forward = part.min(largest / length) * (to - from);
    let across = Vector2::new(-forward.y, forward.x);
    let corners = [to + forward, to - forward + across, to - forward - across];
    corners.map(|corner| (corner.x, corner.y)).to_vec()
}

/// Numbers from `first` to `ratio` times as much in so many equal factors, for curves over logarithmic axes.
pub fn geometric(first: f64, ratio: f64, factors: u32) -> impl Iterator<Item = f64> + Clone {
    (0..=factors).map(move |k| first * ratio.powf(f64::from(k) / f64::from(factors)))
}
