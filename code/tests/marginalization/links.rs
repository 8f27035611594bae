//! Links that are dropped, and who is then sure of what.

use nalgebra::DMatrix;
use vislam::marginalization::{
    Couplings, Information, Layout, MarginalizationError, OverConfidence, WindowSigmas, divergence,
    keep_marginals, marginalize, sparsify, zero_link,
};

use super::{expected, names, numbers, off, window};

/// What the first slide leaves of windows of the chapter.
fn slid() -> Vec<Information<f64>> {
    let layout = Layout::eight_keyframes();
    let slide = |seed| {
        let window = window(&layout, &WindowSigmas::default(), seed).information();
        marginalize(&window, &layout.slide(0)).unwrap()
    };
    (0..4).map(slide).collect()
}

fn variances(window: &Information<f64>) -> Vec<f64> {
    window.covariance().unwrap().diagonal().iter().copied().collect()
}

// ANCHOR: counterexample
#[test]
fn dropping_a_link_can_make_every_variable_less_sure_than_it_is() {
    // Three numbers, every two of them coupled by the same sign.
    let (x, y) = (0.5, 0.6);
    let truth = numbers(DMatrix::from_row_slice(3, 3, &[1.0, x, y, x, 1.0, y, y, y, 1.0]));
    let without = zero_link(&truth, 0, 1).unwrap();
    for (before, after) in variances(&truth).iter().zip(variances(&without)) {
        println!("variance {before:.3} becomes {after:.3}");
        assert!(after > 1.05 * before);
    }
    // It still claims too much, of a sum that no variable is.
    assert!(OverConfidence::of(&truth, &without).unwrap().largest() > 1.5);
}
// ANCHOR_END: counterexample

#[test]
fn where_all_couplings_pull_together_dropping_any_link_makes_every_variable_more_sure() {
    // Numbers in a ring, each measured against its neighbours and weakly itself: an M-matrix.
    let count = 6;
    let matrix = DMatrix::from_fn(count, count, |row, column| {
        match (row as i32 - column as i32).rem_euclid(count as i32) {
            0 => 2.1,
            1 | 5 => -1.0,
            _ => 0.0,
        }
    });
    let truth = numbers(matrix);
    for (first, second) in Couplings::of(&truth).pairs() {
        let without = zero_link(&truth, first, second).unwrap();
        for (before, after) in variances(&truth).iter().zip(variances(&without)) {
            assert!(after < *before, "{first}-{second}: {before} becomes {after}");
        }
    }
}

#[test]
fn a_zeroed_link_claims_too_much_in_as_many_directions_as_too_little() {
    for truth in slid() {
        let links = Couplings::of(&truth).pairs();
        let gaussian = |&(a, b): &(usize, usize)| Some(((a, b), zero_link(&truth, a, b).ok()?));
        let without: Vec<_> = links.iter().filter_map(gaussian).collect();
        assert!(without.len() > links.len() / 2);
        for ((first, second), without) in without {
            let ratios = OverConfidence::of(&truth, &without).unwrap().ratios;
            let rank = truth.between(first, second).unwrap().into_owned().rank(1e-6);
            let above = ratios.iter().filter(|ratio| **ratio > 1.0 + 1e-6).count();
            let below = ratios.iter().filter(|ratio| **ratio < 1.0 - 1e-6).count();
            assert_eq!((above, below), (rank, rank), "{first}-{second}");
        }
    }
}

#[test]
fn in_windows_of_keyframes_a_zeroed_link_makes_most_coordinates_too_sure_and_some_not_sure_enough()
{
    let (mut shrank, mut grew, mut oldest_grew, mut links) = (0, 0, 0, 0);
    for truth in slid() {
        let before = variances(&truth);
        let oldest = truth.blocks().columns_of(1).unwrap();
        for (first, second) in Couplings::of(&truth).pairs() {
            let Ok(without) = zero_link(&truth, first, second) else { continue };
            let after = variances(&without);
            let larger = |at: &usize| after[*at] > before[*at] * (1.0 + 1e-9);
            let count = (0..before.len()).filter(larger).count();
            links += 1;
            grew += count;
            shrank += before.len() - count;
            oldest_grew += usize::from(oldest.clone().any(|at| larger(&at)));
        }
    }
    println!(
        "of {links} links: {shrank} variances smaller, {grew} larger; the oldest keyframe has a larger \
         one after {oldest_grew}"
    );
    assert!(grew > 0, "the claim that all become smaller would be true here");
    assert!(shrank > 9 * grew);
}

#[test]
fn a_matrix_without_a_link_need_not_be_that_of_a_gaussian() {
    let strong =
        numbers(DMatrix::from_row_slice(3, 3, &[1.0, -0.8, 0.8, -0.8, 1.0, -0.8, 0.8, -0.8, 1.0]));
    assert!(strong.covariance().is_ok());
    let refused = zero_link(&strong, 0, 1).unwrap_err();
    assert!(matches!(refused, MarginalizationError::Indefinite { name: 2, .. }), "{refused}");
    assert!(keep_marginals(&strong, 0, 1).is_ok());
    assert!(sparsify(&strong, 0, &[1]).is_ok());
    let (mut none, mut all) = (0, 0);
    for truth in slid() {
        for (first, second) in Couplings::of(&truth).pairs() {
            all += 1;
            none += usize::from(zero_link(&truth, first, second).is_err());
        }
    }
    println!("{none} of {all} links of four windows leave no Gaussian");
    assert!(none > 0);
}

#[test]
fn every_way_of_dropping_a_link_keeps_the_mean_and_drops_it() {
    for truth in slid().iter().take(2) {
        let mean = truth.mean().unwrap();
        for (first, second) in Couplings::of(truth).pairs() {
            let ways = [
                zero_link(truth, first, second),
                keep_marginals(truth, first, second),
                sparsify(truth, first, &[second]),
            ];
            for found in ways.into_iter().flatten() {
                assert!((found.mean().unwrap() - &mean).norm() < 1e-8 * mean.norm());
                let link = found.between(first, second).unwrap().amax();
                assert!(link < 1e-9 * truth.matrix().amax(), "{first}-{second}: {link:e}");
            }
        }
    }
}

#[test]
fn a_link_dropped_with_marginals_kept_leaves_each_block_as_sure_as_it_is() {
    let truth = &slid()[0];
    for (first, second) in Couplings::of(truth).pairs() {
        let found = keep_marginals(truth, first, second).unwrap();
        for gone in [first, second] {
            let others: Vec<usize> =
                names(truth).into_iter().filter(|name| *name != gone).collect();
            let (_, before) = expected(truth, &others);
            let (_, after) = expected(&found, &others);
            assert!(off(&after, &before) < 1e-8, "{first}-{second} without {gone}");
        }
        // 1 ± ρ, with the correlations ρ of the two blocks when all others are known.
        let ratios = OverConfidence::of(truth, &found).unwrap().ratios;
        let count = ratios.len();
        for at in 0..count / 2 {
            assert!((ratios[at] + ratios[count - 1 - at] - 2.0).abs() < 1e-6);
        }
        assert!(ratios[count - 1] > 1.0 + 1e-6 && ratios[count - 1] < 2.0);
    }
}

#[test]
fn no_other_way_of_dropping_the_link_loses_less() {
    for truth in slid() {
        for (first, second) in Couplings::of(&truth).pairs() {
            let nats = |found| divergence(&truth, &found).unwrap();
            let least = nats(keep_marginals(&truth, first, second).unwrap());
            let filters = nats(sparsify(&truth, first, &[second]).unwrap());
            assert!(least > 0.0 && least < filters + 1e-9, "{first}-{second}");
            if let Ok(zeroed) = zero_link(&truth, first, second) {
                assert!(least < nats(zeroed) + 1e-9, "{first}-{second}");
            }
        }
    }
}

#[test]
fn the_filters_sparsification_keeps_all_but_the_robot_and_makes_that_sure_of_what_it_does_not_know()
{
    let mut most: f64 = 0.0;
    let mut least: f64 = 1.0;
    for truth in slid() {
        for (robot, cut) in Couplings::of(&truth).pairs() {
            let found = sparsify(&truth, robot, &[cut]).unwrap();
            let others: Vec<usize> =
                names(&truth).into_iter().filter(|name| *name != robot).collect();
            let (_, before) = expected(&truth, &others);
            let (_, after) = expected(&found, &others);
            assert!(off(&after, &before) < 1e-8, "{robot}-{cut}");
            let of_robot = OverConfidence::of_block(&truth, &found, robot).unwrap();
            most = most.max(of_robot.largest());
            least = least.min(of_robot.smallest());
        }
    }
    println!("true over reported variance of the robot: {least:.3} to {most:.3}");
    assert!(most > 1.5, "over-confident somewhere: {most}");
    assert!(least < 0.8, "and too modest elsewhere: {least}");
}

#[test]
fn where_everything_is_linked_with_the_robot_the_filters_sparsification_keeps_marginals() {
    let matrix = DMatrix::from_row_slice(
        4,
        4,
        &[3.0, 1.0, -0.5, 0.7, 1.0, 2.0, 0.4, 0.0, -0.5, 0.4, 2.0, 0.3, 0.7, 0.0, 0.3, 1.5],
    );
    let truth = numbers(matrix);
    let filters = sparsify(&truth, 0, &[1]).unwrap();
    assert!(off(filters.matrix(), keep_marginals(&truth, 0, 1).unwrap().matrix()) < 1e-12);
    // With a passive block it does not, and claims more than is known.
    let matrix = DMatrix::from_row_slice(3, 3, &[2.0, -1.0, 0.0, -1.0, 2.0, -1.0, 0.0, -1.0, 2.0]);
    let truth = numbers(matrix);
    let filters = sparsify(&truth, 0, &[1]).unwrap();
    // By hand: the variance of the first is 3/4; with the third held it is 2/3.
    assert!((variances(&truth)[0] - 0.75).abs() < 1e-12);
    assert!((variances(&filters)[0] - 2.0 / 3.0).abs() < 1e-12);
}

#[test]
fn inflated_by_the_largest_ratio_a_report_is_conservative_and_no_less_would_do() {
    let truth = &slid()[0];
    for (first, second) in Couplings::of(truth).pairs() {
        let found = sparsify(truth, first, &[second]).unwrap();
        let ratios = OverConfidence::of(truth, &found).unwrap();
        let inflated = ratios.inflate(&found);
        let largest = OverConfidence::of(truth, &inflated).unwrap().largest();
        assert!((largest - 1.0).abs() < 1e-9, "{largest}");
        let mean = truth.mean().unwrap();
        assert!((inflated.mean().unwrap() - &mean).norm() < 1e-8 * mean.norm());
    }
    let modest = OverConfidence::of(truth, truth).unwrap();
    assert!(off(modest.inflate(truth).matrix(), truth.matrix()) < 1e-9);
}

#[test]
fn the_ratio_of_a_direction_is_the_ratio_of_the_variances_of_that_quantity() {
    let truth = &slid()[1];
    let (first, second) = *Couplings::of(truth).pairs().iter().next().unwrap();
    let found = keep_marginals(truth, first, second).unwrap();
    let report = OverConfidence::of(truth, &found).unwrap();
    let (before, after) = (truth.covariance().unwrap(), found.covariance().unwrap());
    for (at, ratio) in report.ratios.iter().enumerate() {
        let quantity = report.quantities.column(at);
        let variance = |covariance: &DMatrix<f64>| quantity.dot(&(covariance * quantity));
        assert!((variance(&before) - 1.0).abs() < 1e-6);
        assert!((variance(&before) / variance(&after) / ratio - 1.0).abs() < 1e-6);
    }
    assert_eq!(report.largest(), report.ratios[report.ratios.len() - 1]);
    assert_eq!(report.smallest(), report.ratios[0]);
}

#[test]
fn in_single_precision_links_are_dropped_by_the_same_code() {
    let matrix = DMatrix::from_row_slice(
        4,
        4,
        &[3.0, 1.0, -0.5, 0.7, 1.0, 2.0, 0.4, 0.0, -0.5, 0.4, 2.0, 0.3, 0.7, 0.0, 0.3, 1.5],
    );
    let truth = numbers(matrix);
    let single = truth.cast::<f32>();
    let ways = [
        (zero_link(&truth, 0, 1), zero_link(&single, 0, 1)),
        (keep_marginals(&truth, 0, 1), keep_marginals(&single, 0, 1)),
        (sparsify(&truth, 0, &[1]), sparsify(&single, 0, &[1])),
    ];
    for (double, found) in ways {
        let (double, found) = (double.unwrap(), found.unwrap());
        assert!(off(found.cast::<f64>().matrix(), double.matrix()) < 1e-6);
        let nats = divergence(&single, &found).unwrap();
        assert!((f64::from(nats) - divergence(&truth, &double).unwrap()).abs() < 1e-5);
        let largest = OverConfidence::of(&single, &found).unwrap().largest();
        let expected = OverConfidence::of(&truth, &double).unwrap().largest();
        assert!((f64::from(largest) - expected).abs() < 1e-5);
    }
}
