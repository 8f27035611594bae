//! What the measurements of two keyframes leave free, and what each thing known beforehand is for.

use vislam::least_squares::Kernel;

use super::two_keyframes::{BIAS, Graph, READINGS, STATE, STEP, Scene};
use crate::chapter::Chapter;

pub fn numbers(chapter: &mut Chapter) {
    let scene = Scene::exact();
    let graph = Graph::measured(&scene, Kernel::Squared).expect("the sensors fit the graph");
    chapter.number("unknowns", graph.problem.columns().count as f64, "", 0);
    chapter.number("equations", graph.problem.rows() as f64, "", 0);
    chapter.number("readings", READINGS as f64, "", 0);
    chapter.number("seconds", READINGS as f64 * STEP, "s", 0);
    chapter.number("landmarks", scene.truth.landmarks.len() as f64, "", 0);
    chapter.number("pixel_sigma", scene.pixel_sigma, "px", 1);
    let [first, second] = scene.truth.states;
    let turn = first.world_from_body.angle_to(&second.world_from_body);
    chapter.number("turn", turn.to_degrees(), "°", 0);
    chapter.number("way", (second.position - first.position).norm(), "m", 1);
    for (name, value, unit, decimals) in [
        ("known_turn", 1e3 * STATE[0], "mrad", 0),
        ("known_velocity", 1e2 * STATE[3], "cm/s", 0),
        ("known_position", 1e2 * STATE[6], "cm", 0),
        ("known_gyro", 1e3 * BIAS[0], "mrad/s", 1),
        ("known_accelerometer", 1e2 * BIAS[3], "cm/s²", 0),
    ] {
        chapter.number(name, value, unit, decimals);
    }

    // Without its own noise a turn has that of its bias alone, which walks for as long.
    let seconds = READINGS as f64 * STEP;
    let walked = scene.noise.gyro_walk * seconds / 3.0_f64.sqrt();
    chapter.number("surer", scene.noise.gyro / walked, "", 0);

    let free = |state, bias| Graph::free(state, bias).expect("there is a gap") as f64;
    let (no_state, no_bias) = ([f64::INFINITY; 9], [f64::INFINITY; 6]);
    chapter.number("free", free(no_state, no_bias), "", 0);
    for (name, at) in
        [("free_without_turn", 0), ("free_without_velocity", 3), ("free_without_position", 6)]
    {
        chapter.number(name, free(without(STATE, at), BIAS), "", 0);
    }
    for (name, at) in [("free_without_gyro", 0), ("free_without_accelerometer", 3)] {
        chapter.number(name, free(STATE, without(BIAS, at)), "", 0);
    }
}

/// What is known, without three numbers of it.
fn without<const N: usize>(mut sigmas: [f64; N], at: usize) -> [f64; N] {
    sigmas[at..at + 3].fill(f64::INFINITY);
    sigmas
}
