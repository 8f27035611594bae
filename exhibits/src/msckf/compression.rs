//! Many rows turned into as few as there are columns.

use nalgebra::{DMatrix, DVector};
use vislam::filtering::{Form, correct};
use vislam::msckf::Rows;

use super::TRACKS;
use super::draws::covariance;
use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Compressed = compressed;
    let mutants: [(_, Compressed); 3] = [
        ("the first rows as they are", |h, r| {
            let columns = h.ncols();
            (h.rows(0, columns).into_owned(), r.rows(0, columns).into_owned())
        }),
        ("residual not turned", |h, r| {
            let (turned, _) = compressed(h, r);
            let rows = turned.nrows();
            (turned, r.rows(0, rows).into_owned())
        }),
        ("residual turned back", |h, r| {
            let qr = h.clone().qr();
            let columns = h.ncols();
            let back = qr.q().transpose().tr_mul(&r.rows(0, columns));
            (qr.r(), back.rows(0, columns).into_owned())
        }),
    ];
    chapter.equation("track-compressed", track_compressed, formula, &mutants);
}

/// What the library makes of rows.
fn compressed(h: &DMatrix<f64>, r: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let mut rows = Rows::new(h.ncols() + 1);
    for (row, residual) in h.row_iter().zip(r) {
        let into = rows.add();
        row.iter().zip(&mut *into).for_each(|(number, into)| *into = *number);
        into[h.ncols()] = *residual;
    }
    rows.compress();
    rows.system()
}

type Compressed = fn(&DMatrix<f64>, &DVector<f64>) -> (DMatrix<f64>, DVector<f64>);

fn track_compressed(formula: Compressed) -> Comparison {
    let against = "the information of all rows, inverted";
    let columns = 12;
    Comparison::relative(against, 1e-8).over(TRACKS, 41, |random| {
        let count = columns + 4 + random.uniform(0.0..60.0) as usize;
        let h = DMatrix::from_fn(count, columns, |_, _| random.normal(3.0));
        let r = DVector::from_fn(count, |_, _| random.normal(1.0));
        let mut p = covariance(random, columns, 0.3);
        let information = p.clone().try_inverse().expect("a covariance") + h.tr_mul(&h);
        let after = information.try_inverse().expect("more than the prior");
        let step = -&after * h.tr_mul(&r);
        let (h, r) = formula(&h, &r);
        let correction = correct(&mut p, &h, &r, Form::Joseph).expect("a covariance");
        ((correction.step, p), (step, after))
    })
}
