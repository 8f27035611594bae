//! Expected and obtained side by side, as an SVG.

use exercise_spec::picture::Picture;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

const EXPECTED: RGBColor = RGBColor(0, 90, 160);
const OBTAINED: RGBColor = RGBColor(200, 80, 0);

/// The drawing: rings where points should be, crosses where they are, and a line between.
///
/// # Errors
///
/// When there is nothing finite to draw.
pub fn svg(picture: &Picture) -> Result<String, String> {
    let [across, mut up] = [0, 1].map(|axis| range(picture, axis));
    if picture.downward {
        up = up.end..up.start;
    }
    if !(across.start.is_finite() && up.start.is_finite()) {
        return Err("no point is finite".to_owned());
    }
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (640, 480)).into_drawing_area();
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
    let mut chart: Chart<'_, '_> = ChartBuilder::on(area)
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
    chart
        .draw_series(picture.expected.at.iter().map(|p| Circle::new((p[0], p[1]), 6, EXPECTED)))?
        .label(&picture.expected.name)
        .legend(|(x, y)| Circle::new((x + 8, y), 6, EXPECTED));
    chart
        .draw_series(picture.obtained.at.iter().map(|p| Cross::new((p[0], p[1]), 5, OBTAINED)))?
        .label(&picture.obtained.name)
        .legend(|(x, y)| Cross::new((x + 8, y), 5, OBTAINED));
    chart.configure_series_labels().background_style(WHITE.mix(0.8)).border_style(BLACK).draw()?;
    area.present()?;
    Ok(())
}

/// What an axis has to hold, with a margin.
fn range(picture: &Picture, axis: usize) -> std::ops::Range<f64> {
    let points = picture.expected.at.iter().chain(&picture.obtained.at);
    let finite = points.map(|point| point[axis]).filter(|number| number.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| {
        (low.min(number), high.max(number))
    });
    let margin = (0.1 * (high - low)).max(1e-6);
    low - margin..high + margin
}
