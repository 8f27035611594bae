//! Expected and obtained side by side, as an SVG.

use exercise_spec::picture::Picture;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

const EXPECTED: RGBColor = RGBColor(0, 90, 160);
const OBTAINED: RGBColor = RGBColor(200, 80, 0);

const WIDTH: u32 = 640;
const HEIGHT: u32 = 480;
/// Where the axes begin, in pixels.
const LEFT: i32 = 72;

/// The drawing: rings where points should be, crosses where they are, and a line between; broad
/// and narrow lines where ways should lead and where they do.
///
/// # Errors
///
/// When there is nothing finite to draw.
pub fn svg(picture: &Picture) -> Result<String, String> {
    let [mut across, mut up] = [0, 1].map(|axis| range(picture, axis));
    let unit = |axis: usize| picture.axes[axis].rsplit_once(", ").map(|(_, unit)| unit);
    if unit(0) == unit(1) {
        // One scale for both, in a plot that is about half as wide again as it is high.
        let per_height = ((across.end - across.start) / 1.5).max(up.end - up.start);
        across = widened(across, 1.5 * per_height);
        up = widened(up, per_height);
    }
    if picture.downward {
        up = up.end..up.start;
    }
    if !(across.start.is_finite() && up.start.is_finite()) {
        return Err("no point is finite".to_owned());
    }
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, HEIGHT)).into_drawing_area();
        draw(picture, &area, across, up).map_err(|error| error.to_string())?;
    }
    Ok(text)
}

fn draw(
    picture: &Picture,
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    across: std::ops::Range<f64>,
    up: std::ops::Range<f64>,
) -> Result<(), Box<dyn std::error::Error>> {
    area.fill(&WHITE)?;
    // The legend has a strip of its own, where no points are.
    let (above, strip) = area.split_vertically(HEIGHT - 30);
    let words = |name: &str, x: i32| Text::new(name.to_owned(), (x, 6), ("sans-serif", 14));
    strip.draw(&Circle::new((LEFT + 10, 12), 6, EXPECTED))?;
    strip.draw(&words(&picture.expected.name, LEFT + 24))?;
    strip.draw(&Cross::new((LEFT + 170, 12), 5, OBTAINED))?;
    strip.draw(&words(&picture.obtained.name, LEFT + 184))?;
    let mut chart: Chart<'_, '_> = ChartBuilder::on(&above)
        .caption(&picture.title, ("sans-serif", 16))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(across, up)?;
    let [x, y] = &picture.axes;
    chart.configure_mesh().x_desc(x).y_desc(y).light_line_style(TRANSPARENT).draw()?;
    let pairs = || picture.expected.at.iter().zip(&picture.obtained.at);
    chart.draw_series(
        pairs().map(|(a, b)| PathElement::new(vec![(a[0], a[1]), (b[0], b[1])], BLACK.mix(0.4))),
    )?;
    // A way that came back lies on the one expected where both lead in the same direction.
    for (dots, colour, width) in
        [(&picture.expected, EXPECTED.mix(0.35), 6), (&picture.obtained, OBTAINED.mix(1.0), 2)]
    {
        let ways = dots.at.iter().zip(&dots.ways);
        let style = colour.stroke_width(width);
        chart.draw_series(
            ways.map(|(a, b)| PathElement::new(vec![(a[0], a[1]), (b[0], b[1])], style)),
        )?;
    }
    chart
        .draw_series(picture.expected.at.iter().map(|p| Circle::new((p[0], p[1]), 6, EXPECTED)))?;
    chart.draw_series(picture.obtained.at.iter().map(|p| Cross::new((p[0], p[1]), 5, OBTAINED)))?;
    area.present()?;
    Ok(())
}

/// A range of this length about the same middle.
fn widened(range: std::ops::Range<f64>, length: f64) -> std::ops::Range<f64> {
    let middle = 0.5 * (range.start + range.end);
    middle - 0.5 * length..middle + 0.5 * length
}

/// What an axis has to hold, with a margin.
fn range(picture: &Picture, axis: usize) -> std::ops::Range<f64> {
    let points = picture.expected.ends().chain(picture.obtained.ends());
    let finite = points.map(|point| point[axis]).filter(|number| number.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| {
        (low.min(number), high.max(number))
    });
    let margin = (0.1 * (high - low)).max(1e-6);
    low - margin..high + margin
}
