//! What the window that slides shows, against calls of the library and other ways to say it.

use vislam::marginalization::{
    Couplings, Information, Layout, SquareRoot, WindowSigmas, divergence, fill_in, keep_marginals,
    marginalize, sparsify, zero_link,
};
use widgets::marginalization::Marginalization;
use widgets::{Player, Session};

type Settings<'a> = &'a [(&'a str, f64)];

fn session(settings: Settings) -> Session<Marginalization> {
    Session::with(settings).expect("controls")
}

/// The readings with these controls.
struct Shown {
    blocks: f64,
    coupled: f64,
    new: f64,
    by_no_measurement: f64,
    on_the_way: f64,
    free: f64,
    /// Of both ends, in millimetres.
    truth: [f64; 2],
    reported: [f64; 2],
    nats: f64,
}

fn shown(settings: Settings) -> Shown {
    let readings = session(settings).readings();
    let numbers: Vec<f64> = readings.into_iter().map(|(_, value)| value).collect();
    let &[blocks, coupled, new, by_no_measurement, on_the_way, free, a, also_a, b, also_b, nats] =
        &numbers[..]
    else {
        panic!("{} readings", numbers.len())
    };
    let (truth, reported) = ([a, b], [also_a, also_b]);
    Shown { blocks, coupled, new, by_no_measurement, on_the_way, free, truth, reported, nats }
}

fn window(layout: &Layout) -> Information<f64> {
    let problem = layout.problem(&WindowSigmas::default(), 0).unwrap();
    SquareRoot::of_problem(&problem, problem.values()).unwrap().information()
}

/// The window with odometry after some slides, by one elimination after the other.
fn slid(slides: usize) -> Information<f64> {
    let layout = Layout::eight_keyframes();
    (0..slides).fold(window(&layout), |left, keyframe| {
        let is_there = |name: &usize| left.blocks().names().any(|own| own == *name);
        let gone: Vec<usize> = layout.slide(keyframe).into_iter().filter(is_there).collect();
        marginalize(&left, &gone).unwrap()
    })
}

/// The standard deviation of a block's position in millimetres, out of the covariance of all.
fn sigma(window: &Information<f64>, name: usize) -> f64 {
    let covariance = window.covariance().unwrap();
    let start = window.blocks().columns_of(name).unwrap().start;
    1e3 * (0..3).map(|axis| covariance[(start + axis, start + axis)]).sum::<f64>().sqrt()
}

fn close(found: f64, expected: f64, part: f64) {
    assert!((found - expected).abs() <= part * expected.abs().max(1e-3), "{found} {expected}");
}

/// The sigmas of the ends lose as many digits as the condition of the window has.
const ROUNDING: f64 = 1e-7;

#[test]
fn at_first_the_whole_window_stands_there_as_it_was_measured() {
    let at_first = shown(&[]);
    let layout = Layout::eight_keyframes();
    assert_eq!(at_first.blocks, 20.0);
    assert_eq!(at_first.coupled, layout.couplings().pairs().len() as f64);
    assert_eq!([at_first.new, at_first.by_no_measurement, at_first.on_the_way], [0.0; 3]);
    assert_eq!(at_first.free, 6.0);
    assert_eq!(at_first.nats.abs(), 0.0);
    for (end, name) in [0, 1].into_iter().enumerate() {
        close(at_first.truth[end], sigma(&window(&layout), name), ROUNDING);
        assert_eq!(at_first.truth[end], at_first.reported[end]);
    }
    // The first keyframe is known to a centimetre in each direction, and by nothing else.
    close(at_first.truth[0], 10.0 * 3_f64.sqrt(), 1e-4);
}

#[test]
fn each_slide_couples_what_the_numbers_of_the_marginal_say() {
    let layout = Layout::eight_keyframes();
    let measured = layout.couplings().pairs();
    let mut before = layout.couplings();
    for slides in 1..=6 {
        let left = slid(slides);
        let now = shown(&[("slides", slides as f64)]);
        let pairs = Couplings::of(&left).pairs();
        assert_eq!(now.blocks, left.blocks().len() as f64);
        assert_eq!(now.coupled, pairs.len() as f64);
        assert_eq!(now.by_no_measurement, pairs.difference(&measured).count() as f64);
        let is_there = |name: &usize| before.neighbours(*name).is_some();
        let gone: Vec<usize> = layout.slide(slides - 1).into_iter().filter(is_there).collect();
        let filled = fill_in(&before, &gone).unwrap();
        assert_eq!(now.new, filled.new.len() as f64);
        assert_eq!(now.on_the_way, filled.along_the_way as f64);
        before = filled.couplings;
        let (a, b) = *pairs.first().unwrap();
        close(now.truth[0], sigma(&left, a), ROUNDING);
        close(now.truth[1], sigma(&left, b), ROUNDING);
        // What is known of survivors does not change.
        close(now.truth[0], sigma(&window(&layout), a), ROUNDING);
    }
}

#[test]
fn the_first_slide_couples_one_pair_with_odometry_and_three_without() {
    assert_eq!(shown(&[("slides", 1.0)]).new, 1.0);
    assert_eq!(shown(&[("odometry", 0.0), ("slides", 1.0)]).new, 3.0);
}

#[test]
fn a_keyframe_that_leaves_alone_couples_its_landmarks_for_good() {
    for odometry in [0.0, 1.0] {
        for slides in 1..=6 {
            let by_none = |leaves| {
                let all =
                    [("odometry", odometry), ("leaves", leaves), ("slides", f64::from(slides))];
                shown(&all).by_no_measurement
            };
            let few = slides == 1 && odometry == 0.0;
            assert!(by_none(1.0) > by_none(0.0) || few, "{slides} {odometry}");
        }
    }
}

#[test]
fn what_is_free_stays_free_only_where_the_first_linearization_points_are_kept() {
    let free =
        |points, slides: i32| shown(&[("points", points), ("slides", f64::from(slides))]).free;
    for points in [0.0, 1.0, 2.0] {
        assert_eq!(free(points, 0), 6.0);
    }
    for slides in 1..=6 {
        assert_eq!(free(2.0, slides), 6.0);
        assert!(free(0.0, slides) < 6.0, "false certainty after {slides} slides");
    }
    assert_eq!(free(1.0, 1), 6.0);
    assert!(free(1.0, 2) < 6.0, "the second slide freezes anew");
}

#[test]
fn without_odometry_the_last_keyframe_can_turn_and_nothing_is_said_of_variances() {
    let without = shown(&[("odometry", 0.0)]);
    assert_eq!(without.free, 7.0);
    assert!(without.truth.iter().chain(&without.reported).all(|sigma| sigma.is_nan()));
}

#[test]
fn dropped_links_report_what_the_library_reports() {
    for slides in [1, 3] {
        let truth = slid(slides);
        for (number, (a, b)) in Couplings::of(&truth).pairs().into_iter().enumerate() {
            let all = [zero_link(&truth, a, b), keep_marginals(&truth, a, b), {
                sparsify(&truth, a, &[b])
            }];
            for (way, without) in [1.0, 2.0, 3.0].into_iter().zip(all) {
                let controls = [("drop", way), ("slides", slides as f64), ("link", number as f64)];
                let found = shown(&controls);
                let Ok(without) = without else {
                    assert!(found.nats.is_nan() && found.reported[0].is_nan());
                    continue;
                };
                close(found.nats, divergence(&truth, &without).unwrap(), 1e-6);
                close(found.reported[0], sigma(&without, a), ROUNDING);
                close(found.reported[1], sigma(&without, b), ROUNDING);
            }
        }
    }
}

#[test]
fn kept_marginals_keep_both_sigmas_and_lose_the_least() {
    let mut robots = Vec::new();
    for number in 0..20 {
        let drop = |way| shown(&[("drop", way), ("slides", 1.0), ("link", f64::from(number))]);
        let (zeroed, kept, filters) = (drop(1.0), drop(2.0), drop(3.0));
        for end in 0..2 {
            close(kept.reported[end], kept.truth[end], 1e-5);
        }
        // The filter's rule changes what is known of its robot alone.
        close(filters.reported[1], filters.truth[1], 1e-5);
        robots.push(filters.reported[0] / filters.truth[0]);
        // Where the robot is coupled with all others, both ways are the same.
        assert!(kept.nats > 0.0 && kept.nats < filters.nats + 1e-9, "{number}");
        assert!(zeroed.nats.is_nan() || kept.nats < zeroed.nats, "{number}");
    }
    assert!(robots.iter().any(|ratio| *ratio < 0.9), "{robots:?}");
}

#[test]
fn some_links_cannot_be_zeroed_and_most_of_the_others_make_their_ends_too_sure() {
    let (mut none, mut too_sure, mut others) = (0, 0, 0);
    for number in 0..43 {
        let zeroed = shown(&[("drop", 1.0), ("slides", 1.0), ("link", f64::from(number))]);
        for (reported, truth) in zeroed.reported.into_iter().zip(zeroed.truth) {
            none += i32::from(reported.is_nan());
            too_sure += i32::from(reported < truth);
            others += i32::from(reported >= truth);
        }
    }
    assert!(none > 0 && too_sure > 4 * others, "{none} {too_sure} {others}");
}

#[test]
fn a_dropped_link_is_no_coupling_and_kept_marginals_couple_its_neighbours() {
    for number in [0.0, 3.0, 11.0] {
        let drop = |way| shown(&[("drop", way), ("slides", 1.0), ("link", number)]);
        let (kept, zeroed) = (drop(0.0), drop(1.0));
        let is_gaussian = f64::from(u8::from(zeroed.nats.is_finite()));
        assert_eq!(zeroed.coupled, kept.coupled - is_gaussian);
        assert!(drop(2.0).coupled > kept.coupled);
    }
}

#[test]
fn the_ring_goes_to_the_link_that_is_nearest() {
    let pairs: Vec<_> = Layout::eight_keyframes().couplings().pairs().into_iter().collect();
    let mut session = session(&[]);
    for (number, (a, b)) in pairs.iter().enumerate() {
        let (a, b) = (*a as f64, *b as f64);
        for to in [[a, b], [b + 0.2, a - 0.3]] {
            session.drag(0, to);
            assert_eq!(Player::controls(&session)[5].1, number as f64);
        }
    }
    session.drag(0, [-100.0, 1e9]);
    assert!(session.readings()[10].1.is_finite());
    let last = shown(&[("link", pairs.len() as f64)]);
    assert_eq!(last.truth, shown(&[("link", 0.0)]).truth, "after the last comes the first");
}

/// Every combination of controls, with counts at their ends and between.
fn combinations() -> Vec<[(&'static str, f64); 6]> {
    let mut all = Vec::new();
    let ends = [0.0, 1.0];
    for (odometry, leaves) in ends.into_iter().flat_map(|o| ends.map(|l| (o, l))) {
        for (points, drop) in (0..3).flat_map(|p| (0..4).map(move |d| (p, d))) {
            for (slides, link) in (0..7).flat_map(|s| [0, 5, 9999].map(|l| (s, l))) {
                let (points, drop) = (f64::from(points), f64::from(drop));
                let choices = [
                    ("odometry", odometry),
                    ("leaves", leaves),
                    ("points", points),
                    ("drop", drop),
                ];
                let [one, two, three, four] = choices;
                let (slides, link) = (f64::from(slides), f64::from(link));
                all.push([one, two, three, four, ("slides", slides), ("link", link)]);
            }
        }
    }
    all
}

#[test]
fn every_combination_of_controls_has_numbers_or_says_why_not() {
    let mut session = session(&[]);
    for controls in combinations() {
        controls.iter().for_each(|(name, value)| assert!(session.set(name, *value)));
        let readings = session.readings();
        let [(_, odometry), .., (_, drop), _, _] = controls;
        for (at, (label, value)) in readings.into_iter().enumerate() {
            let may_be_none = at > 5 && (odometry == 0.0 || drop == 1.0);
            assert!(value.is_finite() || may_be_none && value.is_nan(), "{label} {controls:?}");
        }
        assert!(session.numbers().len() < 4000, "{controls:?}");
    }
    for value in [f64::NAN, f64::INFINITY, -3.0, 2.5] {
        for name in ["leaves", "points", "odometry", "drop", "slides", "link"] {
            assert!(session.set(name, value));
            assert!(session.numbers().len() < 4000);
        }
    }
}

#[test]
fn the_same_controls_show_the_same_whatever_came_before() {
    let mut wandering = session(&[]);
    for controls in combinations().iter().step_by(17) {
        controls.iter().for_each(|(name, value)| assert!(wandering.set(name, *value)));
        let bits = |numbers: &[f64]| numbers.iter().map(|n| n.to_bits()).collect::<Vec<_>>();
        let mut fresh = session(controls);
        assert_eq!(bits(wandering.numbers()), bits(fresh.numbers()));
        assert_eq!(bits(wandering.numbers()), bits(fresh.numbers()), "shown again");
    }
}
