//! How many products of two numbers a step of the covariance takes, counted while it is computed.

use nalgebra::{Matrix3, Rotation3, Vector3};
use vislam::inertial::{ImuBias, ImuNoise};
use vislam::manifold::so3;
use vislam::preintegration::{Matrix9, Preintegrated, Preintegrator, Rule, error_dynamics};

use super::oracle::readings;
use super::runs::DT;
use crate::chapter::Chapter;
use crate::counter::Counter;
use crate::random::Random;

/// Second moments of (θ, v, p).
#[derive(Default, Clone, Copy)]
struct Moments {
    tt: Matrix3<f64>,
    vt: Matrix3<f64>,
    vv: Matrix3<f64>,
    pt: Matrix3<f64>,
    pv: Matrix3<f64>,
    pp: Matrix3<f64>,
}

impl Moments {
    /// The printed step with the Euler rule. `fresh` is what the gyroscope's noise adds to the
    /// covariance of θ, and `c` what the step adds to velocity.
    fn advance(
        &mut self,
        counter: &Counter,
        fresh: &Matrix3<f64>,
        c: &Vector3<f64>,
        dt: f64,
        noise: &ImuNoise,
    ) {
        let half = 0.5 * dt;
        let white = noise.accelerometer * noise.accelerometer * dt * Matrix3::identity();
        let (vd, pd) = (counter.times_hat(&self.vt, c), counter.times_hat(&self.pt, c));
        let dd = counter.times_hat(&counter.times_hat(&self.tt, c).transpose(), c) + white;
        let dt_theta = counter.times_hat(&self.tt, c).transpose();
        let carried = self.vv + vd;
        let pp = counter.scaled(dt, &(self.pv + counter.scaled(half, &carried)))
            + counter.scaled(half, &pd)
            + counter.scaled(0.5 * half * half, &dd);
        self.pp += pp + pp.transpose();
        self.pv += pd + counter.scaled(dt, &carried) + counter.scaled(half, &(vd.transpose() + dd));
        self.vv = carried + vd.transpose() + dd;
        self.pt += counter.scaled(dt, &self.vt) + counter.scaled(half, &dt_theta);
        self.vt += dt_theta;
        self.tt += fresh;
    }

    /// In the order and the frames of the library.
    fn covariance(&self, body_from_first: &Matrix3<f64>) -> Matrix9 {
        let b = body_from_first;
        let mut of = Matrix9::zeros();
        let mut put = |row, column, block: Matrix3<f64>| {
            of.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
            of.fixed_view_mut::<3, 3>(column, row).copy_from(&block.transpose());
        };
        put(0, 0, b * self.tt * b.transpose());
        put(3, 0, self.vt * b.transpose());
        put(6, 0, self.pt * b.transpose());
        put(3, 3, self.vv);
        put(6, 3, self.pv);
        put(6, 6, self.pp);
        of
    }
}

/// N Nᵀ times the variance of a reading: the covariance of what noise adds to θ in a step.
fn from_gyro(
    counter: &Counter,
    rotation: &Rotation3<f64>,
    turn: &Vector3<f64>,
    variance: f64,
) -> Matrix3<f64> {
    let angle = turn.norm();
    let sinc = angle.sin() / angle;
    let (c, r) = ((1.0 - angle.cos()) / angle.powi(2), (1.0 - sinc) / angle.powi(2));
    let axis = counter.times(rotation.matrix(), turn);
    let squared = counter.times_hat(&so3::hat(&axis), &axis);
    variance * Matrix3::identity() + counter.scaled(variance * (r * (1.0 + sinc) - c * c), &squared)
}

/// Products of a step with matrices of 9×9, with the sums of the first frame, and the largest
/// relative difference of their outcomes and of the library's.
fn counted() -> (usize, usize, f64) {
    let noise = ImuNoise::mems();
    let mut integrator =
        Preintegrator::new(&ImuBias::default(), &noise).expect("the sensor is one");
    let (by_blocks, by_matrices) = (Counter::default(), Counter::default());
    let (mut moments, mut dense) = (Moments::default(), Matrix9::zeros());
    let mut rotation = Rotation3::identity();
    let samples = readings(&mut Random::new(431), 50);
    for sample in &samples {
        let of = error_dynamics(Rule::Euler, &rotation, sample, DT);
        let (a, b) = (of.from_errors, of.from_reading);
        let carried = by_matrices.times(&by_matrices.times(&a, &dense), &a.transpose());
        let fresh = by_matrices.times(&b, &noise.discrete(DT));
        dense = carried + by_matrices.times(&fresh, &b.transpose());
        let c = DT * (rotation * sample.accelerometer);
        let turn = DT * sample.gyro;
        let added = from_gyro(&by_blocks, &rotation, &turn, noise.gyro * noise.gyro * DT);
        moments.advance(&by_blocks, &added, &c, DT, &noise);
        rotation *= so3::exp(&turn);
        integrator.integrate(sample, DT).expect("the reading is finite");
    }
    let library: Preintegrated = integrator.finish().expect("there are steps");
    let found = moments.covariance(&rotation.matrix().transpose());
    let scale = library.covariance.diagonal().map(f64::sqrt);
    let against = |other: &Matrix9| {
        let difference = other - library.covariance;
        difference.component_div(&(scale * scale.transpose())).amax()
    };
    let per_step = |counter: &Counter| counter.products() / samples.len();
    (per_step(&by_matrices), per_step(&by_blocks), against(&found).max(against(&dense)))
}

pub fn numbers(chapter: &mut Chapter) {
    let (dense, fast, difference) = counted();
    assert!(difference < 1e-12, "the counted sums are those of the library: {difference}");
    chapter.number("covariance_products_dense", dense as f64, "", 0);
    chapter.number("covariance_products", fast as f64, "", 0);
    chapter.number("covariance_products_ratio", dense as f64 / fast as f64, "", 1);
}
