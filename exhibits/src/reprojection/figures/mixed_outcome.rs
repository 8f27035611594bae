//! Mixed conventions over the angle from the world: the rate of Gauss-Newton, and where
//! Levenberg-Marquardt ends.

use crate::figure::{
    self, Draw, Drawing, Drawn, ESTIMATED, Figure, GRID, INK, SERIES, decimals, letters_around,
};
use crate::reprojection::mixing::{
    CONSISTENT, OUTCOME_ANGLES, OUTCOMES, RATE_ANGLES, RATES, predicted_rate,
};

pub fn mixed_outcome() -> Figure {
    let angles = [RATE_ANGLES, OUTCOME_ANGLES].concat();
    let none = vec!["none".to_owned(); RATE_ANGLES.len()];
    let rmses = decimals(3, OUTCOMES.iter().map(|outcome| outcome.rmse));
    let steps = OUTCOMES.iter().map(|outcome| outcome.iterations.to_string()).collect();
    let columns = vec![
        ("largest angle from the world (°)", angles.iter().map(f64::to_string).collect()),
        ("predicted rate", decimals(3, angles.iter().map(|angle| predicted_rate(*angle)))),
        ("measured rate of Gauss-Newton", [decimals(3, *RATES), none.clone()].concat()),
        ("RMSE at the end of Levenberg-Marquardt (px)", [none.clone(), rmses].concat()),
        ("its steps", [none, steps].concat()),
    ];
    Figure::new(1180, columns, |drawing| {
        let (above, below) = drawing.split_vertically(620);
        rate_panel(&above)?;
        outcome_panel(&below)
    })
}

fn rate_panel(drawing: &Drawing) -> Drawn {
    let y_axis = ("error left per step", 0.0..1.6, 4);
    let mut chart = figure::axes(drawing, ("largest angle (°)", 0.0..125.0, 6), y_axis)?;
    chart.line([(0.0, 1.0), (125.0, 1.0)], INK, 3)?;
    chart.line([(60.0, 0.0), (60.0, 1.6)], GRID, 4)?;
    let curve = (0..=104).map(f64::from).map(|angle| (angle, predicted_rate(angle)));
    chart.line(curve, SERIES[0], 5)?;
    chart.marks(RATE_ANGLES.into_iter().zip(*RATES), 1)?;
    chart.write("shrinks", (90.0, 0.87), letters_around(INK))?;
    chart.write("grows", (30.0, 1.12), letters_around(INK))
}

fn outcome_panel(drawing: &Drawing) -> Drawn {
    let y_axis = ("RMSE (px)", 0.0..14.0, 5);
    let mut chart = figure::axes(drawing, ("largest angle (°)", 0.0..125.0, 6), y_axis)?;
    let optimum = CONSISTENT.rmse;
    chart.line([(0.0, optimum), (125.0, optimum)], ESTIMATED, 5)?;
    chart.write("the optimum", (98.0, 2.3), letters_around(ESTIMATED))?;
    let rmses = OUTCOMES.iter().map(|outcome| outcome.rmse);
    chart.marks(OUTCOME_ANGLES.into_iter().zip(rmses), 2)
}
