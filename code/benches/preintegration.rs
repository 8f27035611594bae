//! Time of one reading, with covariance and derivatives by the biases.
//!
//! `cargo bench -p benches --bench preintegration`
//!
//! prints, last, `N ns per sample` for windows of 200 readings: the median of 101 runs over a
//! hundred windows, for either rule.

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample};
use vislam::preintegration::{
    Preintegrated, Preintegrator, Rule, correct_for_bias, linearize, preintegrate,
};
use vislam::simulation::Trajectory;

const WINDOW: usize = 200;

fn window(samples: &[ImuSample], rule: Rule) -> Preintegrated {
    let mut integrator =
        Preintegrator::new(&ImuBias::default(), &ImuNoise::euroc()).expect("finite");
    for index in 0..WINDOW {
        let sum = match rule {
            Rule::Euler => integrator.integrate(&samples[index], 0.005),
            Rule::Midpoint => {
                integrator.integrate_midpoint(&samples[index], &samples[index + 1], 0.005)
            }
        };
        sum.expect("a good reading");
    }
    integrator.finish().expect("readings")
}

fn preintegration(criterion: &mut Criterion) {
    let motion = Trajectory::figure_eight();
    let samples = motion.samples(&GRAVITY, 0.005, 100 * WINDOW + 1);
    let mut group = criterion.benchmark_group("window of 200 readings");
    group.throughput(Throughput::Elements(WINDOW as u64));
    for rule in [Rule::Euler, Rule::Midpoint] {
        group.bench_function(format!("{rule:?}"), |bencher| {
            bencher.iter(|| window(black_box(&samples[..=WINDOW]), rule));
        });
    }
    group.finish();
    let bias = ImuBias::default();
    let sums =
        preintegrate(&samples[..WINDOW], 0.005, &bias, &ImuNoise::euroc()).expect("readings");
    let (first, second) = (motion.at(0.0).state, motion.at(1.0).state);
    criterion.bench_function("correct_for_bias", |bencher| {
        bencher.iter(|| correct_for_bias(black_box(&sums), black_box(&bias)));
    });
    criterion.bench_function("residual with Jacobians", |bencher| {
        bencher.iter(|| linearize(black_box(&sums), &first, &second, &GRAVITY, black_box(&bias)));
    });
    for rule in [Rule::Euler, Rule::Midpoint] {
        println!("{rule:?}: {:.1} ns per sample", median(&samples, rule));
    }
}

fn median(samples: &[ImuSample], rule: Rule) -> f64 {
    let windows = samples.len() / WINDOW;
    let run = |_| {
        let start = Instant::now();
        for index in 0..windows {
            black_box(window(&samples[WINDOW * index..=WINDOW * (index + 1)], rule));
        }
        1e9 * start.elapsed().as_secs_f64() / (WINDOW * windows) as f64
    };
    let mut times: Vec<f64> = (0..101).map(run).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

criterion_group!(benches, preintegration);
criterion_main!(benches);
