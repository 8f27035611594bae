//! Drawn numbers.

use exhibits::random::Random;

#[test]
fn a_seed_gives_the_same_numbers_on_every_machine() {
    let drawn = Random::new(1).uniform(0.0..1.0);
    assert_eq!(drawn, Random::new(1).uniform(0.0..1.0));
    assert_ne!(drawn, Random::new(2).uniform(0.0..1.0));
}

#[test]
fn normal_draws_have_the_moments_of_a_normal_distribution() {
    let mut random = Random::new(3);
    let draws: Vec<f64> = (0..100_000).map(|_| random.normal(2.0)).collect();
    let moment = |power| draws.iter().map(|x| x.powi(power)).sum::<f64>() / 1e5;
    assert!(moment(1).abs() < 0.03);
    assert!((moment(2) / 4.0 - 1.0).abs() < 0.02);
    assert!((moment(4) / 48.0 - 1.0).abs() < 0.05);
}
