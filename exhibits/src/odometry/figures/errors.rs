//! How far off each trajectory of the real flight is over time, from four places, beside those of its kind.

use crate::figure::{self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters_right_of};
use crate::initialization::real::FROM;
use crate::odometry::real::{KINDS, off_by};

/// Where the recording ends, in seconds.
const END: f64 = 30.0;
/// Where a column of panels ends; the first has room for what stands on its axis.
const COLUMNS: [u32; 2] = [480, 880];
const TITLES: [&str; 3] = ["at once", "after two seconds", "in the end"];
/// Whose trajectories there are: their names in the record and in the key.
const WHOSE: [(&str, &str); 4] =
    [("smoother", "smoother"), ("isam", "ISAM2"), ("filter", "filter"), ("batch", "batch")];

fn panel(drawing: &Drawing, from: u32, kind: usize) -> Drawn {
    let all =
        KINDS.iter().flat_map(|(kind, whose)| whose.iter().map(|who| off_by(kind, who, from)));
    let most = all.flatten().map(|(_, off)| off).fold(0.0, f64::max);
    let is_last = from == FROM[FROM.len() - 1];
    let (begin, _) = off_by("causal", "smoother", from)[0];
    let x = (if is_last { "time (s)" } else { "" }, begin..END, 3);
    // The panels of a row have one scale.
    let y = if kind == 0 { ("off by (cm)", 0.0..1.2 * most, 4) } else { ("", 0.0..1.2 * most, 0) };
    let mut chart = figure::axes(drawing, x, y)?;
    let (name, whose) = KINDS[kind];
    for who in whose {
        let series = WHOSE.iter().position(|(known, _)| known == who).unwrap_or_default();
        let points = off_by(name, who, from);
        chart.line(points.iter().copied(), SERIES[series], 4)?;
        chart.marks(points.into_iter().skip(2 * series + 1).step_by(8), series)?;
    }
    if from == FROM[0] {
        chart.write(TITLES[kind], (begin + 0.3, 1.12 * most), letters_right_of(INK))?;
    }
    Ok(())
}

pub fn errors() -> Figure {
    let mut columns = vec![("begins at (s)", Vec::new()), ("time (s)", Vec::new())];
    for from in FROM {
        let times = off_by("causal", "smoother", from);
        columns[0].1.extend(times.iter().map(|_| from.to_string()));
        columns[1].1.extend(decimals(1, times.iter().map(|(time, _)| *time)));
    }
    let titles = [
        ["smoother, at once (cm)", "ISAM2 (cm)", "filter (cm)"],
        ["smoother, two seconds later (cm)", "ISAM2 (cm)", ""],
        ["batch, in the end (cm)", "ISAM2 (cm)", ""],
    ];
    for ((kind, whose), titles) in KINDS.iter().zip(titles) {
        for (who, title) in whose.iter().zip(titles) {
            let of = |from| {
                let mut said = decimals(1, off_by(kind, who, from).into_iter().map(|(_, off)| off));
                // What is two seconds old ends before.
                said.resize(off_by("causal", "smoother", from).len(), "–".to_owned());
                said
            };
            columns.push((title, FROM.into_iter().flat_map(of).collect()));
        }
    }
    Figure::new(1700, columns, |drawing| {
        let (head, panels) = drawing.split_vertically(80);
        figure::keys(&head, WHOSE.len(), WHOSE.iter().map(|(_, name)| *name))?;
        let rows = (1..FROM.len() as u32).map(|row| 405 * row).collect::<Vec<_>>();
        let panels = panels.split_by_breakpoints(COLUMNS, rows);
        for (number, panel) in panels.iter().enumerate() {
            self::panel(panel, FROM[number / KINDS.len()], number % KINDS.len())?;
        }
        Ok(())
    })
}
