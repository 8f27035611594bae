//! Cost and scaled gradient over the iterations, on the ring and on the street.

use plotters::coord::combinators::IntoLogRange;
use vislam::bundle_adjustment::BaReport;

use crate::bundle_adjustment::progress::{solved_ring, solved_street};
use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, SERIES, decimals, letters_right_of, powers,
};

const NAMES: [&str; 2] = ["street", "ring"];

/// The last iteration on the axis.
const LAST: f64 = 16.4;

pub fn convergence() -> Figure {
    let reports = [solved_street(), solved_ring()];
    let steps = || reports.iter().flat_map(|report| &report.iterations);
    let named = NAMES.iter().zip(reports).flat_map(|(name, r)| vec![*name; r.iterations.len()]);
    let numbered = reports.iter().flat_map(|report| 0..report.iterations.len());
    let taken = |accepted| if accepted { "yes" } else { "no" };
    let columns = vec![
        ("scene", named.map(str::to_owned).collect()),
        ("iteration", numbered.map(|index| index.to_string()).collect()),
        ("cost", powers(6, steps().map(|step| step.cost))),
        ("gradient", powers(2, steps().map(|step| step.gradient_norm))),
        ("damping", powers(1, steps().map(|step| step.damping))),
        ("gain", decimals(3, steps().map(|step| step.gain_ratio.unwrap_or(f64::NAN)))),
        ("step taken", steps().map(|step| taken(step.accepted).to_owned()).collect()),
    ];
    Figure::new(1220, columns, |drawing| {
        let (above, below) = drawing.split_vertically(590);
        costs(&above, &reports)?;
        gradients(&below, &reports)
    })
}

fn costs(drawing: &Drawing, reports: &[&BaReport; 2]) -> Drawn {
    let range = (1e2..1e6).log_scale();
    let mut chart = figure::axes(drawing, ("", -0.3..LAST, 7), ("cost", range, 5))?;
    for (index, report) in reports.iter().enumerate() {
        let costs = report.iterations.iter().map(|step| step.cost).chain([report.cost]);
        let places: Vec<_> = costs.enumerate().map(|(i, cost)| (i as f64, cost)).collect();
        chart.line(places.iter().copied(), SERIES[index], 4)?;
        chart.marks(places, index)?;
        let name = if index == 0 { (6.0, 3.0 * report.cost) } else { (5.5, report.cost) };
        chart.write(NAMES[index], name, letters_right_of(SERIES[index]))?;
    }
    Ok(())
}

fn gradients(drawing: &Drawing, reports: &[&BaReport; 2]) -> Drawn {
    let y_axis = ("log\u{2081}\u{2080} of scaled gradient", -4.0..4.0, 5);
    let mut chart = figure::axes(drawing, ("iteration", -0.3..LAST, 7), y_axis)?;
    for (index, report) in reports.iter().enumerate() {
        let gradients = report.iterations.iter().map(|step| step.gradient_norm.log10());
        let places: Vec<_> = gradients.enumerate().map(|(i, norm)| (i as f64, norm)).collect();
        chart.line(places.iter().copied(), SERIES[index], 4)?;
        chart.marks(places, index)?;
    }
    Ok(())
}
