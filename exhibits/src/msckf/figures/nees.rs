//! Normalized errors of a hundred flights, by block and time, with the bands they have to be in.

use plotters::element::Rectangle;
use plotters::style::Color;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_around};
use crate::msckf::consistency::{BLOCKS, TIMES, recorded};

pub fn nees() -> Figure {
    let recorded = BLOCKS.map(|(block, _)| recorded(block));
    let each = || BLOCKS.iter().zip(&recorded).flat_map(|(block, of)| TIMES.map(|_| (block.0, of)));
    let columns = vec![
        ("block", each().map(|(block, _)| block.to_owned()).collect()),
        ("time (s)", BLOCKS.iter().flat_map(|_| TIMES.map(|time| time.to_string())).collect()),
        ("mean NEES, divided", decimals(2, recorded.iter().flat_map(|(means, _)| *means))),
        ("band from", decimals(2, each().map(|(_, (_, [low, _]))| *low))),
        ("to", decimals(2, each().map(|(_, (_, [_, high]))| *high))),
    ];
    Figure::new(800, columns, |drawing| {
        let highest = recorded.iter().flat_map(|(means, [_, high])| means.iter().chain([high]));
        let highest = highest.fold(1.0_f64, |a, b| a.max(*b));
        let y_axis = ("mean normalized error squared", 0.0..1.25 * highest, 6);
        let mut chart = figure::axes(drawing, ("", 0.0..4.0, 0), y_axis)?;
        chart.line([(0.0, 1.0), (4.0, 1.0)], INK, 2)?;
        for (index, ((name, _), (means, [low, high]))) in BLOCKS.iter().zip(&recorded).enumerate() {
            let left = index as f64;
            let band = [(left + 0.1, *low), (left + 0.9, *high)];
            chart.draw_series([Rectangle::new(band, SERIES[index].mix(0.25).filled())])?;
            let at = |which: usize| left + 0.24 + 0.26 * which as f64;
            chart.marks(means.iter().enumerate().map(|(which, mean)| (at(which), *mean)), index)?;
            for (which, time) in TIMES.iter().enumerate() {
                let style = letters_around(INK);
                let text = if which == 2 { format!("{time} s") } else { time.to_string() };
                chart.write(&text, (at(which), 0.05 * highest), style)?;
            }
            let place = (left + 0.5, 1.15 * highest);
            chart.write(name, place, letters_around(SERIES[index]))?;
        }
        Ok(())
    })
}
