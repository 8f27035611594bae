//! How many products of two numbers a step of the covariance takes, counted while it is computed.

use std::cell::Cell;

use nalgebra::{Matrix3, Rotation3, Vector3};
use vislam::inertial::ImuNoise;
use vislam::manifold::so3;
use vislam::preintegration::Matrix9;

use super::oracle::readings;
use super::runs::{DT, of_readings};
use crate::chapter::Chapter;
use crate::random::Random;

/// Computes and counts. Adding and transposing are free.
#[derive(Default)]
struct Counter(Cell<usize>);

impl Counter {
    fn count(&self, products: usize) {
        self.0.set(self.0.get() + products);
    }

    fn scaled(&self, factor: f64, matrix: &Matrix3<f64>) -> Matrix3<f64> {
        self.count(9);
        factor * matrix
    }

    /// Each entry of the product with c^ has two products.
    fn times_hat(&self, a: &Matrix3<f64>, c: &Vector3<f64>) -> Matrix3<f64> {
        self.count(18);
        a * so3::hat(c)
    }
}

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
    counter.count(9);
    let axis = rotation * turn;
    let squared = counter.times_hat(&so3::hat(&axis), &axis);
    variance * Matrix3::identity() + counter.scaled(variance * (r * (1.0 + sinc) - c * c), &squared)
}

/// Products of a step with matrices: two of 9×9 with the covariance between, and those of 9×6 with
/// that of a reading between.
const DENSE: usize = 2 * 9 * 9 * 9 + 9 * 6 * 6 + 9 * 6 * 9;

/// Products of a step with the sums of the first frame, whose outcome is that of the library.
fn counted() -> usize {
    let (noise, counter) = (ImuNoise::mems(), Counter::default());
    let (mut moments, mut rotation) = (Moments::default(), Rotation3::identity());
    let samples = readings(&mut Random::new(431), 50);
    for sample in &samples {
        let c = DT * (rotation * sample.accelerometer);
        let turn = DT * sample.gyro;
        let added = from_gyro(&counter, &rotation, &turn, noise.gyro * noise.gyro * DT);
        moments.advance(&counter, &added, &c, DT, &noise);
        rotation *= so3::exp(&turn);
    }
    let library = of_readings(&samples, DT, &noise).covariance;
    let scale = library.diagonal().map(f64::sqrt);
    let difference = moments.covariance(&rotation.matrix().transpose()) - library;
    let difference = difference.component_div(&(scale * scale.transpose())).amax();
    assert!(difference < 1e-12, "the counted sums are those of the library: {difference}");
    counter.0.get() / samples.len()
}

pub fn numbers(chapter: &mut Chapter) {
    let fast = counted();
    chapter.number("covariance_products_dense", DENSE as f64, "", 0);
    chapter.number("covariance_products", fast as f64, "", 0);
    chapter.number("covariance_products_ratio", DENSE as f64 / fast as f64, "", 1);
}
