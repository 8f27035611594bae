//! Cases that drop a condition of the theorem on the projection.

use nalgebra::{DMatrix, Vector3};
use vislam::filtering::{Form, correct};

use super::draws::{Linear, Plan, Track, covariance, least, nothing, stacked};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered};

/// Random tracks of a case.
const CASES: usize = 20;

pub fn counterexamples(chapter: &mut Chapter) {
    let kept = Case {
        plan: Plan { off: 0.0, landmark_off: 0.0, ..Plan::new(6) },
        prior: nothing().0,
        elsewhere: 0.0,
        turned: |rows| rows,
    };
    let on_the_spot = Plan { spread: 0.0, ..kept.plan };
    let stretched: fn(Linear) -> Linear = |linear| {
        altered(linear, |linear| {
            let rows = linear.residual.len();
            let stretch = DMatrix::from_diagonal(&nalgebra::DVector::from_fn(rows, |row, _| {
                1.0 + row as f64
            }));
            linear.by_poses = &stretch * &linear.by_poses;
            linear.residual = &stretch * &linear.residual;
        })
    };
    for (condition, dropped) in [
        ("rank", Case { plan: on_the_spot, ..kept }),
        ("no-prior", Case { prior: 5.0, ..kept }),
        ("orthonormal", Case { turned: stretched, ..kept }),
        ("same-point", Case { elsewhere: 1.0, ..kept }),
    ] {
        chapter.counterexample("projection", condition, is_the_step, [kept, dropped]);
    }
}

#[derive(Clone, Copy)]
struct Case {
    plan: Plan,
    /// One over the standard deviation of a prior for the landmark, 0.2 m from where it is
    /// linearized, in 1/m.
    prior: f64,
    /// How far from there the problem that keeps the landmark has it, in metres.
    elsewhere: f64,
    /// What becomes of the projected rows.
    turned: fn(Linear) -> Linear,
}

/// The correction by the projected rows against the step with the landmark kept.
fn is_the_step(case: Case) -> Comparison {
    let against = "the step of the poses with the landmark kept";
    Comparison::relative(against, 1e-5).over(CASES, 21, |random| {
        let mut track = Track::drawn(random, case.plan);
        let mut p = covariance(random, 6 * track.sights.len(), 0.01);
        let projected = (case.turned)(Linear::projected(&track.linearized()));
        let poses = p.nrows();
        let away = random.direction(1.0);
        track.landmark += case.elsewhere * away;
        let whole = Linear::of(&track.linearized(), 0);
        let mean: Vector3<f64> = 0.2 * away;
        let (a, b) = stacked(&p, &whole, (case.prior, mean));
        let step = correct(&mut p, &projected.by_poses, &projected.residual, Form::Difference);
        let step = step.expect("a covariance").step;
        (step, least(&a, &b).0.rows(0, poses).into_owned())
    })
}
