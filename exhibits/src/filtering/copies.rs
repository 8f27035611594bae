//! Copies of a variable, and what they keep.

use nalgebra::{DMatrix, Vector3};
use vislam::filtering::Belief;

use super::{STATES, draws};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered};

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Copied = |covariance, by_all, noise| {
        let mut belief = Belief::new();
        let first = covariance.view((0, 0), (3, 3)).into_owned();
        belief.add(Vector3::<f64>::zeros(), &first).expect("it fits");
        let before =
            covariance.view((3, 0), (3, 3)) * first.clone().try_inverse().expect("a covariance");
        let left = covariance.view((3, 3), (3, 3)) - &before * covariance.view((0, 3), (3, 3));
        belief.add_function(Vector3::<f64>::zeros(), &before, &left).expect("it fits");
        belief.add_function(Vector3::<f64>::zeros(), by_all, noise).expect("it fits");
        belief.covariance().clone()
    };
    let mutants: [(_, Copied); 4] = [
        ("independent", |p, a, n| {
            altered(whole(p, a, n), |after| {
                after.view_mut((6, 0), (3, 6)).fill(0.0);
                after.view_mut((0, 6), (6, 3)).fill(0.0);
            })
        }),
        ("noise dropped", |p, a, n| whole(p, a, &(0.0 * n))),
        ("noise subtracted", |p, a, n| whole(p, a, &-n)),
        ("sign of the ties", |p, a, n| {
            altered(whole(p, a, n), |after| {
                after.view_mut((6, 0), (3, 6)).neg_mut();
                after.view_mut((0, 6), (6, 3)).neg_mut();
            })
        }),
    ];
    chapter.equation("cloned-covariance", cloned_covariance, formula, &mutants);
}

type Copied = fn(&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>) -> DMatrix<f64>;

/// By a product of whole matrices.
fn whole(p: &DMatrix<f64>, a: &DMatrix<f64>, n: &DMatrix<f64>) -> DMatrix<f64> {
    let mut both = DMatrix::zeros(9, 6);
    both.view_mut((0, 0), (6, 6)).fill_with_identity();
    both.view_mut((6, 0), (3, 6)).copy_from(a);
    let mut after = &both * p * both.transpose();
    let mut own = after.view_mut((6, 6), (3, 3));
    own += n;
    after
}

fn cloned_covariance(formula: Copied) -> Comparison {
    let against = "the scatter of errors that are copied one by one";
    Comparison::relative(against, 1e-10).over(STATES, 31, |random| {
        let (p, noise) = (draws::covariance(random, 6), draws::covariance(random, 3));
        let by_all = draws::matrix(random, 3, 6);
        let noises = draws::ensemble(&noise);
        let errors = draws::ensemble(&p);
        let copied = errors.iter().flat_map(|error| {
            let by_all = &by_all;
            noises.iter().map(move |noise| {
                let mut both = error.clone().resize_vertically(9, 0.0);
                both.rows_mut(6, 3).copy_from(&(by_all * error + noise));
                both
            })
        });
        (formula(&p, &by_all, &noise), draws::scatter(copied))
    })
}
