//! The same readings from three first states, and what is left when these are taken off.

use nalgebra::{Rotation3, Vector2, Vector3};
use vislam::inertial::{GRAVITY, ImuSample, NavState};
use vislam::simulation::Trajectory;

use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, INK, SERIES, decimals, letters, letters_right_of,
};
use crate::preintegration::sums::oracle::deltas_of_states;

const DT: f64 = 0.005;
const STEPS: usize = 600;
/// A mark and a row of data for so many steps.
const EVERY: usize = 60;
const NAMES: [&str; 3] = ["as it was", "turned", "tilted"];

fn starts() -> [NavState; 3] {
    let truth = Trajectory::figure_eight().at(0.0).state;
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 1.2);
    let elsewhere = NavState {
        world_from_body: turn * truth.world_from_body,
        velocity: turn * truth.velocity + Vector3::new(-1.2, 0.3, 0.0),
        position: truth.position + Vector3::new(-3.0, -3.0, 0.0),
    };
    let tilt = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.09);
    let tilted = NavState {
        world_from_body: tilt * truth.world_from_body,
        position: truth.position + Vector3::new(4.5, 0.5, 0.0),
        ..truth
    };
    [truth, elsewhere, tilted]
}

/// Places seen from above at the beginning and after each step: in the world, and of the delta.
type Path = Vec<[Vector2<f64>; 2]>;

fn path(first: &NavState, samples: &[ImuSample]) -> Path {
    let mut state = *first;
    let mut path = vec![[first.position.xy(), Vector2::zeros()]];
    for (index, sample) in samples.iter().enumerate() {
        state = state.propagate(sample, &GRAVITY, DT);
        let deltas = deltas_of_states(first, &state, &GRAVITY, DT * (index + 1) as f64);
        path.push([state.position.xy(), deltas.position.xy()]);
    }
    path
}

pub fn any_start() -> Figure {
    let samples = Trajectory::figure_eight().samples(&GRAVITY, DT, STEPS);
    let paths = starts().map(|first| path(&first, &samples));
    let steps = || (0..=STEPS).step_by(EVERY);
    let places = |side: usize, start: usize, axis: usize| {
        decimals(3, steps().map(|step| paths[start][step][side][axis]))
    };
    let columns = vec![
        ("time (s)", decimals(1, steps().map(|step| DT * step as f64))),
        ("world x as it was (m)", places(0, 0, 0)),
        ("world y as it was (m)", places(0, 0, 1)),
        ("world x elsewhere (m)", places(0, 1, 0)),
        ("world y elsewhere (m)", places(0, 1, 1)),
        ("world x tilted (m)", places(0, 2, 0)),
        ("world y tilted (m)", places(0, 2, 1)),
        ("delta x as it was (m)", places(1, 0, 0)),
        ("delta y as it was (m)", places(1, 0, 1)),
        ("delta x elsewhere (m)", places(1, 1, 0)),
        ("delta y elsewhere (m)", places(1, 1, 1)),
        ("delta x tilted (m)", places(1, 2, 0)),
        ("delta y tilted (m)", places(1, 2, 1)),
    ];
    Figure::new(1500, columns, |drawing| {
        let (above, below) = drawing.split_vertically(760);
        panel(&above, &paths, 0, "in the world, from above")?;
        panel(&below, &paths, 1, "as the first body sees it, drift and fall taken off")
    })
}

fn panel(drawing: &Drawing, paths: &[Path; 3], side: usize, title: &str) -> Drawn {
    let places = || paths.iter().flatten().map(|place| place[side]);
    let low = places().reduce(|low, place| low.inf(&place)).expect("places");
    let high = places().reduce(|high, place| high.sup(&place)).expect("places");
    let room = 0.08 * (high - low);
    let (low, high) = (low - room, high + room);
    // Equal scales on both axes, for a panel twice as wide as it is tall.
    let half = (high.x - low.x).max(2.0 * (high.y - low.y) * 1.25) / 2.0;
    let (x, y) = ((low.x + high.x) / 2.0, (low.y + high.y) / 2.0 + 0.1 * half);
    let x_axis = ("x (m)", x - half..x + half, 7);
    let y_axis = ("y (m)", y - half / 2.0..y + half / 2.0, 5);
    let mut chart = figure::axes(drawing, x_axis, y_axis)?;
    for (index, path) in paths.iter().enumerate() {
        let places = path.iter().map(|place| (place[side].x, place[side].y));
        chart.line(places.clone(), SERIES[index], [12, 6, 3][index])?;
        // Marks take turns, so that none hides another where the paths are one.
        chart.marks(places.skip(20 * index).step_by(EVERY), index)?;
        if side == 0 {
            let end = path[[STEPS, 0, STEPS][index]][side];
            let beside = (end.x + 0.04 * half, end.y - [0.05, 0.0, 0.0][index] * half);
            chart.write(NAMES[index], beside, letters_right_of(SERIES[index]))?;
        }
    }
    chart.write(title, (x - 0.97 * half, y + 0.48 * half), letters(INK))
}
