//! The numbers that the chapter quotes.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector, Vector1, Vector2};
use vislam::filtering::{Belief, Form, NeesBand, chi_square_quantile};
use vislam::inertial::ImuNoise;

use super::carried::second_at_rest;
use super::digits::{CONDITIONS, DRAWS, ROUNDING, lost};
use super::faults::{self, FILTERS, LENGTHS, OUTSIDE};
use super::flown::{Filter, LANDMARKS, Moment, PICTURE_RATE, RIGHT, STEP_SIGMA, flown, recorded};
use super::hover;
use super::spot::{self, Believed, DISTANCE, ESTIMATE, SIGMA, SIGMAS, cost};
use crate::chapter::Chapter;

/// Of the flight that goes dark, in seconds.
pub const SECONDS: f64 = 20.0;
pub const DARK: [f64; 2] = [8.0, 14.0];

/// With one linearization of each picture, and with several.
pub fn darkened() -> &'static [Vec<Moment>; 2] {
    static FLOWN: OnceLock<[Vec<Moment>; 2]> = OnceLock::new();
    FLOWN.get_or_init(|| {
        let recording = recorded(SECONDS, 3);
        [1, 5].map(|iterations| flown(&Filter { dark: DARK, iterations, ..RIGHT }, &recording, 3))
    })
}

pub const LIVE_RUNS: usize = 30;
pub const LIVE_SECONDS: f64 = 12.0;
/// Of the state.
const DEGREES: usize = 9;

/// All moments of the flights that are flown for each build.
pub fn live() -> &'static [Vec<Moment>] {
    static LIVE: OnceLock<Vec<Vec<Moment>>> = OnceLock::new();
    LIVE.get_or_init(|| {
        let seeds = 100..100 + LIVE_RUNS as u64;
        seeds.map(|seed| flown(&RIGHT, &recorded(LIVE_SECONDS, seed), seed)).collect()
    })
}

/// In which the mean of the flights lies at a time, 95 times out of a hundred.
pub fn mean_band() -> NeesBand {
    NeesBand::new(LIVE_RUNS, DEGREES, 0.05).expect("a probability")
}

/// The same for one of them.
pub fn run_band() -> [f64; 2] {
    let band = NeesBand::new(1, DEGREES, 0.05).expect("a probability");
    [band.low, band.high]
}

/// One linearization of the bent measurement, and as many as it takes.
pub fn bent() -> [Believed; 2] {
    [1, 30].map(spot::after)
}

pub fn numbers(chapter: &mut Chapter) {
    spot_numbers(chapter);
    carried_numbers(chapter);
    bent_numbers(chapter);
    digit_numbers(chapter);
    gate_numbers(chapter);
    copy_numbers(chapter);
    live_numbers(chapter);
    fault_numbers(chapter);
    hover_numbers(chapter);
}

fn spot_numbers(chapter: &mut Chapter) {
    let once = spot::after(1);
    chapter.number("spot_distance", DISTANCE, "m", 1);
    chapter.number("spot_expected", ESTIMATE.norm(), "m", 2);
    chapter.number("spot_sigma_cm", 100.0 * SIGMA, "cm", 0);
    chapter.number("spot_before_x", SIGMAS[0], "m", 1);
    chapter.number("spot_before_y", SIGMAS[1], "m", 1);
    let along = ESTIMATE.normalize();
    let across = Vector2::new(-along.y, along.x);
    let sigma = |covariance: nalgebra::Matrix2<f64>, direction: &Vector2<f64>| {
        direction.dot(&(covariance * direction)).sqrt()
    };
    chapter.number("spot_along_before", sigma(spot::prior_covariance(), &along), "m", 2);
    chapter.number("spot_along_after_cm", 100.0 * sigma(once.covariance, &along), "cm", 1);
    chapter.number("spot_across_before", sigma(spot::prior_covariance(), &across), "m", 2);
    chapter.number("spot_across_after", sigma(once.covariance, &across), "m", 2);
    chapter.number("spot_nis", once.update.innovation, "", 1);
}

fn carried_numbers(chapter: &mut Chapter) {
    let second = second_at_rest(&ImuNoise::mems());
    let by = second.by_error;
    // An error of the tilt of a milliradian, after a second.
    chapter.number("tilt_to_speed_mm", (by[(3, 1)]).abs(), "mm/s", 1);
    chapter.number("tilt_to_place_mm", (by[(6, 1)]).abs(), "mm", 1);
    let [once, often] = darkened();
    let of =
        |moments: &[Moment], seconds: f64| moments[(seconds * PICTURE_RATE).round() as usize - 1];
    let at = |seconds: f64| of(once, seconds);
    let error = |moments| 1e3 * of(moments, DARK[1]).error.position.x.abs();
    chapter.number("dark_x_error_mm", error(once), "mm", 0);
    let sigmas_off = |seconds: f64| at(seconds).error.position.x.abs() / at(seconds).sigmas[1];
    chapter.number("dark_x_error_sigmas", sigmas_off(DARK[1]), "", 0);
    chapter.number("dark_x_later_sigmas", sigmas_off(DARK[1] + 1.0), "", 0);
    let until = |seconds: f64| at(seconds).innovations[0];
    chapter.number("dark_innovation", until(DARK[1]) - until(DARK[1] - 0.1), "", 0);
    let reset =
        |moments: &[Moment]| 100.0 * moments.iter().map(|moment| moment.reset).fold(0.0, f64::max);
    let bright = (DARK[0] * PICTURE_RATE) as usize;
    chapter.number("reset_before", reset(&once[..bright]), "%", 1);
    chapter.number("reset_after", reset(&once[bright..]), "%", 1);
    chapter.number("dark_x_iterated_mm", error(often), "mm", 0);
    let millimetres = |seconds: f64| 1e3 * at(seconds).sigmas[1];
    let milliradians = |seconds: f64| 1e3 * at(seconds).sigmas[0];
    let [out, on] = [DARK[0] - 0.1, DARK[1] - 0.1];
    chapter.number("dark_from", DARK[0], "s", 0);
    chapter.number("dark_length", DARK[1] - DARK[0], "s", 0);
    chapter.number("dark_x_before_mm", millimetres(out), "mm", 0);
    chapter.number("dark_x_end_mm", millimetres(on), "mm", 0);
    chapter.number("dark_x_after_mm", millimetres(DARK[1]), "mm", 0);
    chapter.number("dark_yaw_before_mrad", milliradians(out), "mrad", 1);
    chapter.number("dark_yaw_end_mrad", milliradians(on), "mrad", 1);
    chapter.number("map_landmarks", LANDMARKS as f64, "", 0);
    chapter.number("picture_rate", PICTURE_RATE, "", 0);
}

fn bent_numbers(chapter: &mut Chapter) {
    let [once, often] = bent();
    chapter.number("bent_iterations", often.update.iterations as f64, "", 0);
    let apart = (once.estimate - often.estimate).norm();
    chapter.number("bent_apart_cm", 100.0 * apart, "cm", 0);
    chapter.number("bent_cost_before", cost(&ESTIMATE), "", 0);
    chapter.number("bent_cost_promised", 0.5 * once.update.innovation, "", 1);
    chapter.number("bent_cost_once", cost(&once.estimate), "", 1);
    chapter.number("bent_cost_often", cost(&often.estimate), "", 1);
    chapter.number("bent_off_sigmas", (once.estimate.norm() - DISTANCE) / SIGMA, "", 1);
}

fn digit_numbers(chapter: &mut Chapter) {
    let exhausted = ROUNDING.recip();
    chapter.number("exhausted_exponent", exhausted.log10(), "", 1);
    let found = |condition: f64| CONDITIONS.iter().position(|own| *own == condition).unwrap_or(0);
    let at = |condition: f64| lost()[found(condition)].error;
    let below_zero = |condition: f64| lost()[found(condition)].below_zero;
    chapter.number("lost_root_8", 100.0 * at(1e8)[2], "%", 2);
    chapter.number("lost_joseph_8", at(1e8)[1], "", 1);
    chapter.number("lost_difference_8", at(1e8)[0], "", 1);
    chapter.number("lost_draws", DRAWS as f64, "", 0);
    for (names, condition) in [
        (["below_difference_7", "below_joseph_7"], 1e7),
        (["below_difference_8", "below_joseph_8"], 1e8),
    ] {
        for (form, name) in names.into_iter().enumerate() {
            chapter.number(name, below_zero(condition)[form] as f64, "", 0);
        }
    }
    let of_root: usize = lost().iter().map(|lost| lost.below_zero[2]).sum();
    chapter.number("below_root", of_root as f64, "", 0);
    for (name, form) in [("slope_difference", 0), ("slope_joseph", 1), ("slope_root", 2)] {
        let points = CONDITIONS.into_iter().zip(lost().iter().map(|lost| lost.error[form]));
        chapter.number(name, slope(points.collect()), "", 2);
    }
}

/// Of a straight line through the logarithms of some points.
fn slope(points: Vec<(f64, f64)>) -> f64 {
    let points: Vec<_> = points.into_iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
    let (x, y) = (x / count, y / count);
    let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    cross / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// A place, a step from it, and a measurement of the step.
fn copy_numbers(chapter: &mut Chapter) {
    let one = |value: f64| DMatrix::from_element(1, 1, value);
    let (before, step, noise) = (4.0, 1.0, 1.0);
    let by_both = DMatrix::from_row_slice(1, 2, &[-1.0, 1.0]) / f64::sqrt(noise);
    let after = |mut belief: Belief| {
        belief.correct(&by_both, &DVector::zeros(1), Form::Joseph).expect("a covariance");
        belief.covariance()[(1, 1)]
    };
    let mut tied = Belief::new();
    tied.add(Vector1::new(0.0), &one(before)).expect("it fits");
    let mut untied = tied.clone();
    tied.add_function(Vector1::new(0.0), &one(1.0), &one(step)).expect("it fits");
    untied.add(Vector1::new(0.0), &one(before + step)).expect("it fits");
    chapter.number("copy_before", before, "m²", 0);
    chapter.number("copy_step", step, "m²", 0);
    chapter.number("copy_noise", noise, "m²", 0);
    chapter.number("copy_after", after(tied), "m²", 1);
    chapter.number("copy_untied", after(untied), "m²", 1);
}

fn gate_numbers(chapter: &mut Chapter) {
    chapter.number("gate_percent", 99.0, "%", 0);
    let gate = |degrees| chi_square_quantile(0.99, degrees).expect("a probability");
    chapter.number("gate_two", gate(2), "", 2);
    chapter.number("gate_all", gate(2 * LANDMARKS), "", 1);
    chapter.number("gate_all_numbers", 2.0 * LANDMARKS as f64, "", 0);
    chapter.number("gate_two_sigmas", gate(2).sqrt(), "", 2);
    let a_minute = 0.01 * LANDMARKS as f64 * PICTURE_RATE * 60.0;
    chapter.number("gate_a_minute", a_minute, "", 0);
}

fn live_numbers(chapter: &mut Chapter) {
    let runs = live();
    let last = runs[0].len() - 1;
    let mean = runs.iter().map(|run| run[last].whole).sum::<f64>() / LIVE_RUNS as f64;
    chapter.number("live_runs", LIVE_RUNS as f64, "", 0);
    chapter.number("live_seconds", LIVE_SECONDS, "s", 0);
    chapter.number("live_mean", mean, "", 2);
    chapter.number("live_low", mean_band().low, "", 2);
    chapter.number("live_high", mean_band().high, "", 2);
    chapter.number("one_low", run_band()[0], "", 2);
    chapter.number("one_high", run_band()[1], "", 2);
    let [squares, count] = runs.iter().fold([0.0, 0.0], |sum, run| {
        [sum[0] + run[last].innovations[0], sum[1] + run[last].innovations[1]]
    });
    chapter.number("live_nis", squares / count, "", 3);
    let pooled = NeesBand::new(count as usize, 1, 0.05).expect("a probability");
    chapter.number("nis_low", pooled.low, "", 3);
    chapter.number("nis_high", pooled.high, "", 3);
    let outside = (0..=last).filter(|at| {
        let mean = runs.iter().map(|run| run[*at].whole).sum::<f64>() / LIVE_RUNS as f64;
        !(mean_band().low..=mean_band().high).contains(&mean)
    });
    chapter.number("live_outside", outside.count() as f64, "", 0);
    chapter.number("live_pictures", runs[0].len() as f64, "", 0);
    chapter.number("test_percent", 95.0, "%", 0);
    chapter.number("six_tests", 100.0 * (1.0 - 0.95_f64.powi(6)), "%", 0);
}

fn fault_numbers(chapter: &mut Chapter) {
    chapter.number("displacement_cm", 100.0 * STEP_SIGMA, "cm", 0);
    let lengths = ["length_0", "length_1", "length_2", "length_3"];
    for (name, length) in lengths.into_iter().zip(LENGTHS) {
        chapter.number(name, length, "s", 0);
    }
    chapter.number("fault_alpha", 100.0 * OUTSIDE, "%", 0);
    chapter.number("fault_tests", (5 * LENGTHS.len()) as f64, "", 0);
    let tested = faults::tested();
    let place = |word: &str| FILTERS.iter().position(|(own, _)| *own == word).unwrap_or(0);
    let outside = |word: &str| {
        let all = tested[place(word)].iter().flatten();
        all.filter(|tested| tested.verdict() != 0).count() as f64
    };
    chapter.number("map_outside", outside("map"), "", 0);
    chapter.number("transition_outside", outside("transition"), "", 0);
    chapter.number("odometry_outside", outside("odometry"), "", 0);
    let worse =
        |word: &str, right: &str| 100.0 * (faults::rmse(word, 3) / faults::rmse(right, 3) - 1.0);
    chapter.number("pixels_worse", worse("pixels", "map"), "%", 0);
}

fn hover_numbers(chapter: &mut Chapter) {
    let sigma = hover::told("latest", "sigma");
    let names = [
        "hover_time_0",
        "hover_time_1",
        "hover_time_2",
        "hover_time_3",
        "hover_time_4",
        "hover_time_5",
        "hover_time_6",
        "hover_time_7",
    ];
    for (name, time) in names.into_iter().zip(hover::TIMES) {
        chapter.number(name, time, "s", 0);
    }
    let [latest, first] = hover::live();
    chapter.number("hover_live_seconds", hover::LIVE_SECONDS, "s", 0);
    chapter.number("hover_live_latest", latest, "°", 2);
    chapter.number("hover_live_first", first, "°", 2);
    chapter.number("hover_kept", hover::KEPT as f64, "", 0);
    chapter.number("hover_start", sigma[0], "°", 1);
    chapter.number("hover_end", sigma[7], "°", 2);
    chapter.number("hover_error", hover::told("latest", "error")[7], "°", 2);
    chapter.number("hover_nees", hover::told("latest", "nees")[7], "", 1);
    chapter.number("hover_first_end", hover::told("first", "sigma")[7], "°", 2);
    let band = NeesBand::new(hover::SEEDS, 1, 0.05).expect("a probability");
    chapter.number("hover_low", band.low, "", 2);
    chapter.number("hover_first_error", hover::told("first", "error")[7], "°", 2);
    chapter.number("hover_first_nees", hover::told("first", "nees")[7], "", 2);
}
