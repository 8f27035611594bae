//! What it costs to leave a part out.

use plotters::coord::combinators::IntoLogRange;

use crate::figure::{self, Draw, Figure, INK, SERIES, letters_right_of};
use crate::odometry::switches::Switch;
use crate::record::accepted;

fn of(estimator: &str, switch: Switch, what: &str) -> f64 {
    accepted("odometry_switches", &format!("{estimator}_{}_{what}", switch.name()))
}

/// Whether any flight without that part was not lost. The filter has no prior whose points could be frozen.
fn flew(estimator: &str, switch: Switch) -> bool {
    let is_there = (estimator, switch) != ("msckf", Switch::Frozen);
    is_there && of(estimator, switch, "lost") < accepted("odometry_switches", "seeds")
}

const SAID: [&str; Switch::ALL.len()] = [
    "nothing left out",
    "no kernel, no gate",
    "clock not estimated",
    "biases taken for zero",
    "readings told too noisy",
    "readings told too exact",
    "tilt taken for exact",
    "points not frozen",
];

pub fn switches() -> Figure {
    let of_all = |estimator: &str, what: &str| {
        let one = |switch: Switch| match flew(estimator, switch) {
            false => "–".to_owned(),
            true => crate::chapter::text(of(estimator, switch, what), 1),
        };
        Switch::ALL.map(one).to_vec()
    };
    let columns = vec![
        ("left out", SAID.map(str::to_owned).to_vec()),
        ("smoother (cm)", of_all("smoother", "rmse")),
        ("NEES of its position", of_all("smoother", "position")),
        ("of its yaw", of_all("smoother", "yaw")),
        ("filter (cm)", of_all("msckf", "rmse")),
        ("NEES of its position", of_all("msckf", "position")),
        ("of its yaw", of_all("msckf", "yaw")),
    ];
    let rmse = |estimator: &str| {
        let each = Switch::ALL.iter().enumerate();
        let flown = each.filter(|(_, switch)| flew(estimator, **switch));
        flown.map(|(at, switch)| (of(estimator, *switch, "rmse"), at as f64)).collect::<Vec<_>>()
    };
    let curves = [rmse("smoother"), rmse("msckf")];
    Figure::new(1000, columns, |drawing| {
        let all = || curves.iter().flatten().map(|at| at.0);
        let least = all().fold(f64::INFINITY, f64::min);
        let most = all().fold(0.0, f64::max);
        let x_axis = ("RMSE of the position (cm)", (2e-4 * least..6.0 * most).log_scale(), 6);
        let count = Switch::ALL.len() as f64;
        let mut chart = figure::axes(drawing, x_axis, ("", -1.6..count - 0.4, 0))?;
        for (at, said) in SAID.iter().enumerate() {
            let height = count - 1.0 - at as f64;
            chart.write(said, (2.5e-4 * least, height), letters_right_of(INK))?;
        }
        for (series, curve) in curves.iter().enumerate() {
            let lift = 0.12 - 0.24 * series as f64;
            let places = curve.iter().map(|(rmse, at)| (*rmse, count - 1.0 - at + lift));
            chart.marks(places, series)?;
        }
        chart.line([(curves[0][0].0, -0.5), (curves[0][0].0, count - 0.5)], SERIES[0], 2)?;
        chart.key(0, "smoother", (0.4 * least, -1.2), 0.7 * least)?;
        chart.key(1, "filter", (60.0 * least, -1.2), 105.0 * least)
    })
}
