//! What the picture of two cameras shows, against other ways to say it.

use approx::assert_relative_eq;
use widgets::bearing::Bearing;
use widgets::{Player, Session};

/// The readings with some controls set: both residuals in pixels, the parallax in degrees, σ_Z in
/// centimetres, and between which depths in metres nine in ten draws lie.
fn shown(settings: &[(&str, f64)]) -> [f64; 6] {
    let mut session = Session::<Bearing>::new();
    for (name, value) in settings {
        assert!(session.set(name, *value), "{name}");
    }
    let readings = session.readings();
    std::array::from_fn(|number| readings[number].1)
}

#[test]
fn a_landmark_on_the_ray_of_the_first_camera_contradicts_the_second_only() {
    for along in [0.5, 1.3, 2.9] {
        let [first, second, ..] = shown(&[("along", along), ("focal", 400.0), ("baseline", 0.4)]);
        assert!(first.abs() < 1e-9, "{first}");
        // The disparity f b / Z becomes one of f b / (s Z).
        let depth = shown_depth();
        assert_relative_eq!(second, 400.0 * 0.4 / depth * (1.0 - 1.0 / along), epsilon = 1e-9);
    }
}

fn shown_depth() -> f64 {
    let session = Session::<Bearing>::new();
    Player::controls(&session).iter().find(|(name, _)| *name == "depth").unwrap().1
}

#[test]
fn across_the_ray_both_cameras_contradict() {
    let [first, second, ..] = shown(&[("along", 1.0), ("across", 0.2)]);
    assert!(first > 5.0 && second > 5.0, "{first} {second}");
}

#[test]
fn a_depth_is_the_less_sure_the_farther_away_and_the_shorter_the_baseline() {
    let sigma = |settings: &[(&str, f64)]| shown(settings)[3];
    let near = sigma(&[("depth", 3.0)]);
    assert_relative_eq!(sigma(&[("depth", 6.0)]), 4.0 * near, max_relative = 1e-12);
    let long = sigma(&[("baseline", 1.0)]);
    assert_relative_eq!(sigma(&[("baseline", 0.5)]), 2.0 * long, max_relative = 1e-12);
    // Both pixels are noisy.
    let one = 36.0 / (400.0 * 0.4) * std::f64::consts::SQRT_2 * 100.0;
    let settings = [("depth", 6.0), ("focal", 400.0), ("baseline", 0.4), ("noise", 1.0)];
    assert_relative_eq!(sigma(&settings), one, max_relative = 1e-12);
}

#[test]
fn nine_in_ten_depths_lie_within_five_thirds_of_sigma_and_farther_ones_reach_out_more() {
    let [.., sigma, below, above] =
        shown(&[("depth", 6.0), ("noise", 1.0), ("focal", 400.0), ("baseline", 0.4)]);
    let sigma = sigma / 100.0;
    assert!((6.0 - below) / sigma > 0.9 && (6.0 - below) / sigma < 2.0, "{below}");
    assert!(above - 6.0 > 6.0 - below, "{below} {above}");
    let [.., below, above] = shown(&[("noise", 0.0), ("depth", 6.0)]);
    assert_relative_eq!(below, 6.0, epsilon = 1e-9);
    assert_relative_eq!(above, 6.0, epsilon = 1e-9);
}

#[test]
fn dragging_the_ring_puts_the_landmark_there() {
    let mut session = Session::<Bearing>::new();
    let before = session.readings()[1].1;
    session.drag(0, [7.0, 1.0]);
    let controls = Player::controls(&session);
    assert!(controls[0].1 > 1.0, "{controls:?}");
    assert!((session.readings()[1].1 - before).abs() > 1.0);
    session.drag(1, [0.0, 0.9]);
    assert_relative_eq!(Player::controls(&session)[3].1, 0.9);
    session.drag(0, [f64::NAN, 0.0]);
    assert!(Player::controls(&session).iter().all(|(_, value)| value.is_finite()));
}

#[test]
fn the_ends_of_all_sliders_are_shown_or_said_to_have_no_number() {
    let ends: [(&str, [f64; 2]); 6] = [
        ("along", [0.4, 3.0]),
        ("across", [-0.5, 0.5]),
        ("depth", [2.0, 8.0]),
        ("baseline", [0.05, 1.5]),
        ("focal", [200.0, 800.0]),
        ("noise", [0.0, 3.0]),
    ];
    for corner in 0..64_usize {
        let end = |(bit, (name, ends)): (usize, &(&'static str, [f64; 2]))| {
            (*name, ends[corner >> bit & 1])
        };
        let settings: Vec<(&str, f64)> = ends.iter().enumerate().map(end).collect();
        let readings = shown(&settings);
        assert!(readings.iter().all(|value| !value.is_infinite()), "{settings:?} {readings:?}");
        assert!(readings[2].is_finite() && readings[3].is_finite(), "{settings:?}");
    }
}
