//! The numbers that the chapter quotes.

use vislam::marginalization::{Couplings, Layout, divergence, fill_in, zero_link};

use super::digits::{SEEDS as WINDOWS, all, lost};
use super::links::{COUNTEREXAMPLE, of_rows};
use super::trees::{best_tree, left_out, tree};
use super::windows::{
    Freeze, GONE, SEEDS, forgotten, free_after_two_slides, replaced, slid, usual, zeroed,
};
use crate::chapter::Chapter;
use crate::statistics::median;

pub fn numbers(chapter: &mut Chapter) {
    pattern(chapter);
    forgetting(chapter);
    precision(chapter);
    links(chapter);
    trees(chapter);
    slides(chapter);
}

fn pattern(chapter: &mut Chapter) {
    let layout = Layout::eight_keyframes();
    chapter.number("keyframes", layout.keyframes as f64, "", 0);
    chapter.number("landmarks", layout.seen_by.len() as f64, "", 0);
    chapter.number("unknowns", usual(0).root().ncols() as f64, "", 0);
    chapter.number("measurements", usual(0).root().nrows() as f64, "", 0);
    let sights = layout.seen_by.iter().map(Vec::len).sum::<usize>();
    chapter.number("sights", sights as f64, "", 0);
    chapter.number("odometry", layout.odometry.len() as f64, "", 0);
    let gone = layout.slide(0);
    chapter.number("gone_landmarks", (gone.len() - 1) as f64, "", 0);
    let new = |layout: &Layout| {
        fill_in(&layout.couplings(), &layout.slide(0)).expect("they are there").new.len() as f64
    };
    chapter.number("new_with", new(&layout), "", 0);
    chapter.number("new_without", new(&layout.clone().without_odometry()), "", 0);
    let landmarks_first = layout.slide(GONE);
    chapter.number("fourth_landmarks", (landmarks_first.len() - 1) as f64, "", 0);
    let keyframe_first: Vec<usize> = landmarks_first.iter().rev().copied().collect();
    let along = |order: &[usize]| {
        fill_in(&layout.couplings(), order).expect("they are there").along_the_way as f64
    };
    chapter.number("along_landmarks", along(&landmarks_first), "", 0);
    chapter.number("along_keyframe", along(&keyframe_first), "", 0);
    let alone = fill_in(&layout.couplings(), &[0]).expect("it is there").new.len() as f64;
    chapter.number("new_alone", alone, "", 0);
}

fn forgetting(chapter: &mut Chapter) {
    let all: Vec<_> = (0..SEEDS).map(forgotten).collect();
    let nats = |way: usize| all.iter().map(move |f| f.nats[way]);
    let low = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
    let high = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    chapter.number("seeds", SEEDS as f64, "", 0);
    chapter.number("drop_least", low(&mut nats(0)), "nats", 0);
    chapter.number("drop_most", high(&mut nats(0)), "nats", 0);
    chapter.number("hold_least", low(&mut nats(1)), "nats", 0);
    chapter.number("hold_most", high(&mut nats(1)), "nats", 0);
    chapter.number("hold_ratio", high(&mut all.iter().map(|f| f.ratios[1][1])), "", 0);
    chapter.number("drop_ratio", high(&mut all.iter().map(|f| 1.0 / f.ratios[0][0])), "", 0);
    chapter.number("drop_above", high(&mut all.iter().map(|f| f.ratios[0][1])), "", 2);
}

/// The conditions of which the chapter speaks: well, badly and worse.
const QUOTED: [usize; 3] = [0, 2, 5];

fn precision(chapter: &mut Chapter) {
    let names = [
        ["condition_well", "hessian_well", "root_well"],
        ["condition_badly", "hessian_badly", "root_badly"],
    ];
    for (at, [condition, hessian, root]) in QUOTED.into_iter().zip(names) {
        let one = &all()[at];
        chapter.number(condition, one.condition, "", 0);
        let percent = one.errors.map(|error| 100.0 * error.unwrap_or(f64::NAN));
        chapter.number(hessian, percent[0], "%", 2);
        chapter.number(root, percent[1], "%", 4);
    }
    let worse = &all()[QUOTED[2]];
    chapter.number("condition_worse", worse.condition, "", 0);
    chapter.number("root_worse", 100.0 * worse.errors[1].unwrap_or(f64::NAN), "%", 3);
    chapter.number("gaussians_worse", worse.gaussians[0] as f64, "", 0);
    chapter.number("windows", WINDOWS as f64, "", 0);
    let failing = all().iter().find(|digits| digits.gaussians[1] < WINDOWS as usize);
    let failing = failing.expect("the worst roots fail");
    chapter.number("condition_failing", failing.condition, "", 0);
    let failed = WINDOWS as usize - failing.gaussians[1];
    chapter.number("roots_failing", failed as f64, "", 0);
    let ends = [QUOTED[0], QUOTED[1]];
    chapter.number("lost_hessian", lost(0, ends), "", 2);
    chapter.number("lost_root", lost(1, ends), "", 2);
}

fn links(chapter: &mut Chapter) {
    let truth = of_rows(COUNTEREXAMPLE);
    let without = zero_link(&truth, 0, 1).expect("a Gaussian");
    let variances = [&truth, &without].map(|of| of.covariance().expect("a Gaussian").diagonal());
    chapter.number("first_before", variances[0][0], "", 2);
    chapter.number("first_after", variances[1][0], "", 2);
    chapter.number("third_before", variances[0][2], "", 2);
    chapter.number("third_after", variances[1][2], "", 2);
    let all = zeroed();
    chapter.number("links", all.links as f64, "", 0);
    chapter.number("links_none", all.none as f64, "", 0);
    chapter.number("shrank", 100.0 * all.shrank as f64 / (all.shrank + all.grew) as f64, "%", 1);
    chapter.number("filter_least", all.filters[0], "", 2);
    chapter.number("filter_most", all.filters[1], "", 2);
    replacements(chapter);
}

fn replacements(chapter: &mut Chapter) {
    let slid = slid(0);
    let (blocks, links) = (slid.blocks().len(), Couplings::of(&slid).pairs().len());
    chapter.number("slid_links", links as f64, "", 0);
    chapter.number("slid_pairs", (blocks * (blocks - 1) / 2) as f64, "", 0);
    let all = replaced();
    chapter.number("positive", all.positive, "%", 0);
    chapter.number("kept_new", all.new, "", 0);
    chapter.number("kept_ratio", all.ratio, "", 2);
    let [zeroed, kept] = all.nats.map(median);
    chapter.number("zeroed_nats", zeroed, "nats", 0);
    chapter.number("kept_nats", kept, "nats", 2);
}

fn trees(chapter: &mut Chapter) {
    let window = slid(0);
    let keyframes: Vec<usize> = (1..8).collect();
    let gone: Vec<usize> =
        window.blocks().names().filter(|name| !keyframes.contains(name)).collect();
    let dense = vislam::marginalization::marginalize(&window, &gone).expect("determined");
    let best = best_tree(&dense);
    chapter.number("tree_edges", best.len() as f64, "", 0);
    chapter.number("tree_blocks", dense.blocks().len() as f64, "", 0);
    chapter.number("tree_nats", left_out(&dense, &best), "nats", 1);
    let star: Vec<(usize, usize)> = (2..8).map(|other| (1, other)).collect();
    chapter.number("star_nats", left_out(&dense, &star), "nats", 1);
    let off =
        divergence(&dense, &tree(&dense, &best)).expect("determined") - left_out(&dense, &best);
    assert!(off.abs() < 1e-6 * left_out(&dense, &best).max(1.0), "{off}");
}

fn slides(chapter: &mut Chapter) {
    let ways: [(_, Freeze); 3] = [
        ("free_first", |problem, _| {
            problem.freeze_priors();
        }),
        ("free_anew", |problem, named| problem.freeze_here(named).expect("they are there")),
        ("free_never", |_, _| {}),
    ];
    for (name, freeze) in ways {
        chapter.number(name, free_after_two_slides(freeze), "", 0);
    }
}
