//! What survivors keep, and which of them become coupled.

use nalgebra::{DMatrix, DVector};
use vislam::marginalization::{Information, SquareRoot, marginalize};

use super::STATES;
use super::draws::{blocks, columns, gaussian, inverse, matrix, part, scalars, vector};
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Schur); 4] = [
        ("blocks added", |window, gone| Some(by_parts(window, gone, [-1.0, 1.0]))),
        ("rows and columns struck out", |window, gone| Some(by_parts(window, gone, [0.0, 0.0]))),
        ("vector kept", |window, gone| Some(by_parts(window, gone, [1.0, 0.0]))),
        ("vector with the wrong sign", |window, gone| Some(by_parts(window, gone, [1.0, -1.0]))),
    ];
    chapter.equation("marg-schur", marg_schur, library, &mutants);

    let mutants: [(_, Rows); 3] = [
        ("rows kept that see what leaves", |root, offset, gone| {
            let axes = left(root, gone, true);
            of_rows(&axes.tr_mul(&after(root, gone)), &axes.tr_mul(offset))
        }),
        ("rows not turned but left out", |root, offset, gone| {
            let rows = root.nrows() - gone;
            let (below, end) = (after(root, gone), offset.rows(gone, rows).into_owned());
            of_rows(&below.rows(gone, rows).into_owned(), &end)
        }),
        ("offset with the wrong sign", |root, offset, gone| turned(root, &-offset, gone)),
    ];
    chapter.equation("marg-projection", marg_projection, turned, &mutants);

    let kept: Cost = |a, b| 0.5 * (a * a + (a - b - 0.4).powi(2) + 0.5 * (b - 1.0).powi(2));
    let bent: Cost = |a, b| 0.5 * ((a - 1.0).powi(2) + (a * b - 1.0).powi(2) + b * b);
    let free: Cost = |a, b| 0.5 * (-0.2 * a * a + a * b + 4.0 * b * b);
    for (condition, dropped) in [("straight", bent), ("positive", free)] {
        chapter.counterexample("survivors", condition, least_over_one, [kept, dropped]);
    }
    let kept = Graph { inner: 0.3, cancels: false };
    for (condition, dropped) in [
        ("connected", Graph { inner: 0.0, ..kept }),
        ("no-cancelling", Graph { cancels: true, ..kept }),
    ] {
        chapter.counterexample("blanket", condition, is_clique, [kept, dropped]);
    }
}

type Schur = fn(&Information<f64>, &[usize]) -> Option<(DMatrix<f64>, DVector<f64>)>;

fn library(window: &Information<f64>, gone: &[usize]) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let left = marginalize(window, gone).ok()?;
    Some((left.matrix().clone(), left.vector().clone()))
}

fn survivors(window: &Information<f64>, gone: &[usize]) -> Vec<usize> {
    window.blocks().names().filter(|name| !gone.contains(name)).collect()
}

/// The formula with a factor of what is subtracted from the matrix and from the vector.
fn by_parts(
    window: &Information<f64>,
    gone: &[usize],
    [of_matrix, of_vector]: [f64; 2],
) -> (DMatrix<f64>, DVector<f64>) {
    let (a, b) = (columns(window, gone), columns(window, &survivors(window, gone)));
    let gain = part(window.matrix(), &b, &a) * inverse(&part(window.matrix(), &a, &a));
    let matrix = part(window.matrix(), &b, &b) - of_matrix * &gain * part(window.matrix(), &a, &b);
    let vector = window.vector();
    (matrix, vector.select_rows(&b) - of_vector * gain * vector.select_rows(&a))
}

fn marg_schur(formula: Schur) -> Comparison {
    let against = "rows struck out of mean and covariance of all";
    Comparison::relative(against, 1e-7).over(STATES, 41, |random| {
        let window = gaussian(random, &[3, 2, 1, 4]);
        let gone = [2, 0];
        let kept = columns(&window, &survivors(&window, &gone));
        let covariance = inverse(window.matrix());
        let mean = &covariance * window.vector();
        let matrix = inverse(&part(&covariance, &kept, &kept));
        let vector = &matrix * mean.select_rows(&kept);
        (formula(&window, &gone), (matrix, vector))
    })
}

type Rows = fn(&DMatrix<f64>, &DVector<f64>, usize) -> (DMatrix<f64>, DVector<f64>);

/// The library's turned rows, as information.
fn turned(root: &DMatrix<f64>, offset: &DVector<f64>, gone: usize) -> (DMatrix<f64>, DVector<f64>) {
    let blocks = blocks(&[gone, root.ncols() - gone]);
    let window = SquareRoot::new(blocks, root.clone(), offset.clone()).expect("it fits");
    let left = window.marginalize(&[0]).expect("the columns are independent").information();
    (left.matrix().clone(), left.vector().clone())
}

/// The columns that stay.
fn after(root: &DMatrix<f64>, gone: usize) -> DMatrix<f64> {
    root.columns_range(gone..).into_owned()
}

/// An orthonormal basis of what the columns that leave reach, or the projection onto the rest.
fn left(root: &DMatrix<f64>, gone: usize, reached: bool) -> DMatrix<f64> {
    let own = root.columns_range(..gone).into_owned();
    let axes = own.qr().q();
    match reached {
        true => axes,
        false => DMatrix::identity(root.nrows(), root.nrows()) - &axes * axes.transpose(),
    }
}

fn of_rows(rows: &DMatrix<f64>, offset: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
    (rows.tr_mul(rows), -rows.tr_mul(offset))
}

fn marg_projection(formula: Rows) -> Comparison {
    let against = "the least cost over what leaves, found afresh for each value of the others";
    Comparison::relative(against, 1e-8).over(STATES, 42, |random| {
        let (root, offset) = (matrix(random, 12, 7), vector(random, 12));
        let gone = 3;
        let (information, pull) = formula(&root, &offset, gone);
        let own = root.columns_range(..gone).into_owned().svd(true, true);
        let least = |others: &DVector<f64>| {
            let residual = &offset + after(&root, gone) * others;
            let step = own.solve(&residual, 1e-12).expect("both sides were asked for");
            0.5 * (residual - root.columns_range(..gone) * step).norm_squared()
        };
        let zero = least(&DVector::zeros(4));
        let places: Vec<_> = (0..5).map(|_| vector(random, 4)).collect();
        let said = |x: &DVector<f64>| 0.5 * x.dot(&(&information * x)) - pull.dot(x);
        let said: Vec<f64> = places.iter().map(said).collect();
        let found: Vec<f64> = places.iter().map(|x| least(x) - zero).collect();
        (said, found)
    })
}

/// A cost of what leaves and of what stays, a number each.
type Cost = fn(f64, f64) -> f64;

/// What the Schur complement at zero says that a survivor costs, against a search over what leaves.
fn least_over_one(cost: Cost) -> Comparison {
    let h = 1e-4;
    let slope = |da: f64, db: f64| (cost(h * da, h * db) - cost(-h * da, -h * db)) / (2.0 * h);
    let bend = |da: f64, db: f64| {
        (cost(h * da, h * db) + cost(-h * da, -h * db) - 2.0 * cost(0.0, 0.0)) / (h * h)
    };
    let (aa, bb) = (bend(1.0, 0.0), bend(0.0, 1.0));
    let ab = 0.5 * (bend(1.0, 1.0) - aa - bb);
    let (left, pull) = (bb - ab * ab / aa, -slope(0.0, 1.0) + ab / aa * slope(1.0, 0.0));
    let places = (-4000..=4000).map(|k| 2.5e-3 * f64::from(k));
    let least = |b: f64| places.clone().map(|a| cost(a, b)).fold(f64::INFINITY, f64::min);
    let against = Comparison::absolute("the least cost over what leaves, on a grid", 1e-4, "");
    against.each([-1.0, -0.3, 0.5, 1.2], |b| (0.5 * left * b * b - pull * b, least(b) - least(0.0)))
}

/// Two numbers that leave, coupled with each other or not, the first of them with two survivors, the second with a
/// third one. The first two may be coupled beforehand by what elimination is going to subtract.
#[derive(Clone, Copy)]
struct Graph {
    inner: f64,
    cancels: bool,
}

/// How many pairs of the Markov blanket are not coupled.
fn is_clique(graph: Graph) -> Comparison {
    let left = |outer: f64| {
        let mut matrix = DMatrix::identity(5, 5);
        for (one, other, value) in
            [(0, 1, graph.inner), (0, 2, 0.5), (0, 3, 0.5), (1, 4, 0.5), (2, 3, outer)]
        {
            matrix[(one, other)] = value;
            matrix[(other, one)] = value;
        }
        marginalize(&scalars(matrix), &[0, 1]).expect("it is positive").matrix().clone()
    };
    let outer = if graph.cancels { -left(0.0)[(0, 1)] } else { 0.0 };
    let coupled = left(outer).map(|entry| entry.abs() > 1e-12);
    let missing = [(0, 1), (0, 2), (1, 2)].iter().filter(|pair| !coupled[**pair]).count();
    Comparison::absolute("a clique", 0.1, "pairs").once(missing as f64, 0.0)
}
