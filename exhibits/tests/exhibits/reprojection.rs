//! Mixed conventions.

use exhibits::reprojection::mixing::{
    Convention, Experiment, largest_angle, measured_rate, predicted_rate,
};

#[test]
fn the_world_is_turned_by_as_much_as_was_asked_for() {
    for angle in [14.1, 40.0, 120.0] {
        let ring = Experiment::new(0.0, angle, 0.0).ring;
        assert!((largest_angle(&ring).to_degrees() - angle).abs() < 1e-9);
    }
}

#[test]
fn the_error_of_mixed_conventions_shrinks_as_the_theory_says() {
    for angle in [14.1, 40.0, 55.0, 70.0] {
        let ratio = measured_rate(angle) / predicted_rate(angle);
        assert!((ratio - 1.0).abs() < 0.04, "{angle}: {ratio}");
    }
}

#[test]
fn mixed_conventions_have_the_same_optimum_and_the_wrong_skew_has_not() {
    let experiment = Experiment::new(1.0, 14.1, 0.1);
    let optimum = experiment.optimum();
    let end = |convention| *experiment.errors(convention, &optimum, 40).last().unwrap();
    assert!(end(Convention::Consistent) < 1e-12);
    assert!(end(Convention::Mixed) < 1e-12);
    assert!(end(Convention::SkewOnly) > 1e-3);
}
