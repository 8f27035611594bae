//! Trees in the place of a dense prior, and factors recovered from it.

use nalgebra::{DMatrix, DVector};
use vislam::marginalization::{Information, divergence};

use super::draws::{columns, gaussian, inverse, matrix, part, put, scalars};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

const STATES: usize = 60;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Left); 3] = [
        ("what the tree keeps", |window, edges| total(window) - left_out(window, edges)),
        ("correlations summed over all pairs", |window, edges| {
            left_out(window, edges) + total(window) - left_out(window, &all_pairs(window))
        }),
        ("the tree keeps nothing", |window, _| total(window)),
    ];
    chapter.equation("tree-divergence", tree_divergence, left_out, &mutants);

    let formula: Weight = |row, covariance| 1.0 / (row.transpose() * covariance * row)[(0, 0)];
    let mutants: [(_, Weight); 3] = [
        ("the information along the row", |row, covariance| {
            (row.transpose() * inverse(covariance) * row)[(0, 0)]
        }),
        ("the variance itself", |row, covariance| (row.transpose() * covariance * row)[(0, 0)]),
        ("of a row of length one", |row, covariance| {
            row.norm_squared() / (row.transpose() * covariance * row)[(0, 0)]
        }),
    ];
    chapter.equation("recovered-factor", recovered_factor, formula, &mutants);
}

/// What all blocks say about each other: the divergence from the product of their marginals.
fn total(window: &Information<f64>) -> f64 {
    let covariance = inverse(window.matrix());
    let own = |name: usize| {
        let own = columns(window, &[name]);
        part(&covariance, &own, &own).determinant().ln()
    };
    0.5 * (window.blocks().names().map(own).sum::<f64>() - covariance.determinant().ln())
}

/// What two blocks say about each other, in nats.
pub fn mutual(window: &Information<f64>, a: usize, b: usize) -> f64 {
    let covariance = inverse(window.matrix());
    let size = |names: &[usize]| {
        let own = columns(window, names);
        part(&covariance, &own, &own).determinant().ln()
    };
    0.5 * (size(&[a]) + size(&[b]) - size(&[a, b]))
}

type Left = fn(&Information<f64>, &[(usize, usize)]) -> f64;

/// What is lost to a tree with these edges.
pub fn left_out(window: &Information<f64>, edges: &[(usize, usize)]) -> f64 {
    total(window) - edges.iter().map(|(a, b)| mutual(window, *a, *b)).sum::<f64>()
}

fn all_pairs(window: &Information<f64>) -> Vec<(usize, usize)> {
    let names: Vec<usize> = window.blocks().names().collect();
    let pairs = names.iter().enumerate();
    pairs.flat_map(|(at, a)| names[at + 1..].iter().map(move |b| (*a, *b))).collect()
}

/// The Gaussian over the tree: the joint marginals of its edges over those of its inner blocks.
pub fn tree(window: &Information<f64>, edges: &[(usize, usize)]) -> Information<f64> {
    let covariance = inverse(window.matrix());
    let mut sum = DMatrix::zeros(covariance.nrows(), covariance.nrows());
    let mut add = |names: &[usize], factor: f64| {
        let own = columns(window, names);
        let mut whole = DMatrix::zeros(sum.nrows(), sum.nrows());
        put(&mut whole, &own, &own, &inverse(&part(&covariance, &own, &own)));
        sum += factor * whole;
    };
    for (a, b) in edges {
        add(&[*a, *b], 1.0);
    }
    for name in window.blocks().names() {
        let degree = edges.iter().filter(|(a, b)| *a == name || *b == name).count();
        add(&[name], 1.0 - degree as f64);
    }
    let symmetric = 0.5 * (&sum + sum.transpose());
    let vector = &symmetric * (&covariance * window.vector());
    Information::new(window.blocks().clone(), symmetric, vector).expect("it is symmetric")
}

/// The edges of the tree that keeps most, the strongest first (Kruskal).
pub fn best_tree(window: &Information<f64>) -> Vec<(usize, usize)> {
    let mut pairs = all_pairs(window);
    pairs.sort_by(|one, other| {
        mutual(window, other.0, other.1).total_cmp(&mutual(window, one.0, one.1))
    });
    let mut group: Vec<usize> = (0..=window.blocks().names().max().unwrap_or(0)).collect();
    let mut edges = Vec::new();
    for (a, b) in pairs {
        let [old, new] = [group[a], group[b]];
        if old != new {
            edges.push((a, b));
            group.iter_mut().filter(|own| **own == old).for_each(|own| *own = new);
        }
    }
    edges
}

fn random_tree(random: &mut Random, count: usize) -> Vec<(usize, usize)> {
    let parent = |own: usize, random: &mut Random| random.uniform(0.0..own as f64) as usize;
    (1..count).map(|own| (parent(own, random), own)).collect()
}

fn tree_divergence(formula: Left) -> Comparison {
    let against = "the divergence from the Gaussian over the tree";
    Comparison::absolute(against, 1e-7, "nats").over(STATES, 61, |random| {
        let window = gaussian(random, &[2, 1, 3, 1, 2]);
        let edges = random_tree(random, 5);
        let nats = divergence(&window, &tree(&window, &edges)).unwrap_or(f64::NAN);
        (formula(&window, &edges), nats)
    })
}

type Weight = fn(&DVector<f64>, &DMatrix<f64>) -> f64;

fn recovered_factor(formula: Weight) -> Comparison {
    let against = "the weights of least divergence, by a search";
    Comparison::relative(against, 1e-4).over(STATES, 62, |random| {
        let truth = gaussian(random, &[1; 3]);
        let rows = matrix(random, 3, 3);
        let covariance = inverse(truth.matrix());
        let vector = truth.vector();
        let truth = Information::new(truth.blocks().clone(), truth.matrix().clone(), 0.0 * vector)
            .expect("symmetric");
        let nats = |weights: &[f64]| {
            let weights = DMatrix::from_diagonal(&DVector::from_column_slice(weights));
            let said = scalars(symmetric(&(rows.tr_mul(&weights) * &rows)));
            divergence(&truth, &said).unwrap_or(f64::INFINITY)
        };
        let mut found = vec![1.0; 3];
        for at in 0..3 {
            found[at] = least(|weight| {
                let mut weights = found.clone();
                weights[at] = weight;
                nats(&weights)
            });
        }
        let weights: Vec<f64> =
            (0..3).map(|at| formula(&rows.row(at).transpose(), &covariance)).collect();
        (weights, found)
    })
}

fn symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    0.5 * (matrix + matrix.transpose())
}

/// Where a function of a positive number is least, by thirds of the logarithm.
fn least(cost: impl Fn(f64) -> f64) -> f64 {
    let [mut low, mut high] = [1e-5_f64.ln(), 1e5_f64.ln()];
    for _ in 0..60 {
        let [left, right] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if cost(left.exp()) < cost(right.exp()) { high = right } else { low = left }
    }
    (0.5 * (low + high)).exp()
}
