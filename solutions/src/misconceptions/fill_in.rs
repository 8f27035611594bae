//! Wrong answers to [`fill_in`](crate::fill_in).

use std::collections::BTreeSet;

use exercise_spec::fill_in::*;
use nalgebra::DMatrix;

use super::Wrong;
use crate::fill_in as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions {
    new_couplings: right::new_couplings,
    information_lost: right::information_lost,
    cheapest_link: right::cheapest_link,
};

/// All of them.
pub fn wrong() -> Vec<Wrong> {
    let count = |misconception, new_couplings| {
        Wrong::new(misconception, Functions { new_couplings, ..REFERENCE })
    };
    let loss = |misconception, information_lost| {
        Wrong::new(misconception, Functions { information_lost, ..REFERENCE })
    };
    let choice = |misconception, cheapest_link| {
        Wrong::new(misconception, Functions { cheapest_link, ..REFERENCE })
    };
    vec![
        count(&COUNTED_TWICE, |layout, departing| {
            let pairs = right::new_couplings(layout, departing);
            pairs.iter().flat_map(|(a, b)| [(*a, *b), (*b, *a)]).collect()
        }),
        count(&ODOMETRY_FORGOTTEN, |layout, departing| {
            right::new_couplings(Layout { odometry: false, ..layout }, departing)
        }),
        count(&OLD_AS_NEW, |layout, departing| {
            let mut met = seen_with(&layout, departing);
            if layout.odometry {
                met.extend(departing.checked_sub(1));
                met.extend(Some(departing + 1).filter(|next| *next < layout.keyframes));
            }
            pairs(&met)
        }),
        count(&CLIQUES_SKIPPED, |layout, departing| {
            right::new_couplings(Layout { seen_by: Vec::new(), ..layout }, departing)
        }),
        count(&SEPARATE_CLIQUES, |layout, departing| {
            let mut joined = BTreeSet::new();
            for seen_by in layout.seen_by.iter().filter(|seen_by| seen_by.contains(&departing)) {
                let others = seen_by.iter().copied().filter(|other| *other != departing);
                joined.extend(pairs(&others.collect()));
            }
            let (chain, keyframes) = (layout.odometry, layout.keyframes);
            if chain && departing > 0 && departing + 1 < keyframes {
                joined.insert((departing - 1, departing + 1));
            }
            joined.into_iter().filter(|(a, b)| !(chain && b - a == 1)).collect()
        }),
        count(&ALL_LANDMARKS, |layout, departing| {
            let chain = layout.odometry;
            let mut joined: BTreeSet<(usize, usize)> =
                right::new_couplings(layout.clone(), departing).into_iter().collect();
            for seen_by in layout.seen_by.iter().filter(|seen_by| !seen_by.contains(&departing)) {
                joined.extend(pairs(&seen_by.iter().copied().collect()));
            }
            joined.into_iter().filter(|(a, b)| !(chain && b - a == 1)).collect()
        }),
        count(&SHARED_AS_OLD, |layout, departing| {
            let stay: Vec<Vec<usize>> = layout.seen_by.clone();
            let shared = |a: usize, b: usize| {
                stay.iter().any(|seen| {
                    !seen.contains(&departing) && seen.contains(&a) && seen.contains(&b)
                })
            };
            let pairs = right::new_couplings(layout, departing);
            pairs.into_iter().filter(|(a, b)| !shared(*a, *b)).collect()
        }),
        Wrong::new(
            &EXCHANGED,
            Functions {
                information_lost: exchanged,
                cheapest_link: cheapest_exchanged,
                ..REFERENCE
            },
        ),
        loss(&HALF_FORGOTTEN, |information, size, link| {
            Some(2.0 * right::information_lost(information, size, link)?)
        }),
        loss(&DETERMINANTS_ALONE, |information, size, link| {
            let left = without(&information, size, link).cholesky()?;
            Some(0.5 * (information.cholesky()?.ln_determinant() - left.ln_determinant()))
        }),
        loss(&ONE_BLOCK, |information, size, (a, b)| {
            let mut half = information.clone();
            half.view_mut((size * a, size * b), (size, size)).fill(0.0);
            let (with, left) = (information.cholesky()?, half.clone().cholesky()?);
            let excess = with.solve(&half).trace() - half.nrows() as f64;
            Some(0.5 * (excess + with.ln_determinant() - left.ln_determinant()))
        }),
        loss(&ONE_BLOCK, |information, size, (a, b)| {
            let mut half = information.clone();
            half.view_mut((size * b, size * a), (size, size)).fill(0.0);
            let (with, left) = (information.cholesky()?, half.clone().cholesky()?);
            let excess = with.solve(&half).trace() - half.nrows() as f64;
            Some(0.5 * (excess + with.ln_determinant() - left.ln_determinant()))
        }),
        loss(&SINGLE_ENTRY, |information, size, link| {
            without(&information, size, link).cholesky()?;
            right::information_lost(information, 1, link)
        }),
        loss(&INDEFINITE, |information, size, link| {
            let left = without(&information, size, link);
            Some(divergence(&information, &left))
        }),
        choice(&SMALLEST_BLOCK, |information, size| {
            let count = information.nrows() / size;
            let norm = |(a, b): &(usize, usize)| {
                information.view((size * a, size * b), (size, size)).norm()
            };
            let links = pairs(&(0..count).collect()).into_iter().filter(|link| norm(link) > 0.0);
            links.min_by(|one, other| norm(one).total_cmp(&norm(other)))
        }),
        choice(&NO_LINK, |information, size| {
            let count = information.nrows() / size;
            let costs = pairs(&(0..count).collect()).into_iter().filter_map(|link| {
                Some((link, right::information_lost(information.clone(), size, link)?.abs()))
            });
            costs.min_by(|one, other| one.1.total_cmp(&other.1)).map(|(link, _)| link)
        }),
    ]
}

fn seen_with(layout: &Layout, departing: usize) -> BTreeSet<usize> {
    let leaving = layout.seen_by.iter().filter(|seen_by| seen_by.contains(&departing));
    leaving.flatten().copied().filter(|other| *other != departing).collect()
}

fn pairs(of: &BTreeSet<usize>) -> Vec<(usize, usize)> {
    of.iter().flat_map(|a| of.range(a + 1..).map(|b| (*a, *b))).collect()
}

fn without(information: &DMatrix<f64>, size: usize, (a, b): (usize, usize)) -> DMatrix<f64> {
    let mut left = information.clone();
    left.view_mut((size * a, size * b), (size, size)).fill(0.0);
    left.view_mut((size * b, size * a), (size, size)).fill(0.0);
    left
}

/// The formula, with whatever determinant there is.
fn divergence(with: &DMatrix<f64>, without: &DMatrix<f64>) -> f64 {
    let relative = with.clone().lu().solve(without).unwrap_or_else(|| without.clone());
    let excess = relative.trace() - relative.nrows() as f64;
    0.5 * (excess - relative.determinant().abs().ln())
}

fn exchanged(information: DMatrix<f64>, size: usize, link: (usize, usize)) -> Option<f64> {
    let left = without(&information, size, link);
    left.clone().cholesky()?;
    Some(divergence(&left, &information))
}

fn cheapest_exchanged(information: DMatrix<f64>, size: usize) -> Option<(usize, usize)> {
    let count = information.nrows() / size;
    let linked =
        |(a, b): &(usize, usize)| information.view((size * a, size * b), (size, size)).amax() > 0.0;
    pairs(&(0..count).collect())
        .into_iter()
        .filter(linked)
        .filter_map(|link| Some((link, exchanged(information.clone(), size, link)?)))
        .min_by(|one, other| one.1.total_cmp(&other.1))
        .map(|(link, _)| link)
}
