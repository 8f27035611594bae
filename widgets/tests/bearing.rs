//! What the two cameras show is what the library computes, and their controls do what they say.

use approx::assert_relative_eq;
use nalgebra::{Isometry3, Vector3};
use vislam::bearing::{depth_sigma, disparity_sigma};
use vislam::reprojection::Pinhole;
use widgets::bearing::Bearing;
use widgets::parallax::Parallax;
use widgets::{Player, Session, Shape, Style, Widget};

const FIRST: &str = "Residual of the first camera";
const SECOND: &str = "Residual of the second camera";
const PARALLAX: &str = "Parallax of the landmark";
const SIGMA: &str = "σ of the depth";
const BELOW: &str = "5 % of the depths found are nearer than";
const ABOVE: &str = "5 % of them are farther than";

fn shown(settings: &[(&str, f64)]) -> impl Fn(&str) -> f64 + use<> {
    let mut session = Session::<Bearing>::with(settings).expect("controls");
    let readings = session.readings();
    move |label| {
        let found = readings.iter().find(|(known, _)| *known == label);
        found.unwrap_or_else(|| panic!("no reading {label}")).1
    }
}

#[test]
fn residuals_are_those_of_two_projections() {
    let camera = Pinhole { fx: 400.0, fy: 400.0, cx: 0.0, cy: 0.0 };
    let truth = Vector3::new(0.72, 0.0, 6.0);
    let second = Isometry3::translation(-0.3, 0.0, 0.0);
    let column =
        |pose: &Isometry3<f64>, point: &Vector3<f64>| camera.project(pose, point).unwrap().x;
    let shown = shown(&[("along", 1.5), ("depth", 6.0), ("noise", 2.0)]);
    for (label, pose) in [(FIRST, Isometry3::identity()), (SECOND, second)] {
        let wanted = column(&pose, &(1.5 * truth)) - column(&pose, &truth);
        assert!((shown(label) - wanted).abs() < 1e-9);
    }
    let sigma = depth_sigma(&camera, 0.3, 6.0, disparity_sigma(2.0, 2.0));
    assert_relative_eq!(shown(SIGMA), 100.0 * sigma, max_relative = 1e-9);
    let (to_first, to_second) = (-truth, Vector3::new(0.3, 0.0, 0.0) - truth);
    let parallax = to_first.angle(&to_second).to_degrees();
    assert_relative_eq!(shown(PARALLAX), parallax, max_relative = 1e-9);
}

#[test]
fn along_its_ray_a_landmark_leaves_the_first_picture_as_it_is() {
    for along in [0.4, 0.8, 1.6, 3.0] {
        let shown = shown(&[("along", along)]);
        assert!(shown(FIRST).abs() < 1e-9);
        assert_eq!(shown(SECOND) > 0.0, along > 1.0);
    }
    assert!(shown(&[("across", 0.1)])(FIRST).abs() > 1.0);
}

#[test]
fn depths_spread_with_noise_and_depth_and_less_with_baseline_and_focal_length() {
    let spread = |name: &str, value: f64| {
        let shown = shown(&[(name, value)]);
        shown(ABOVE) - shown(BELOW)
    };
    for (name, narrow, wide) in
        [("noise", 0.5, 2.0), ("depth", 3.0, 8.0), ("baseline", 1.0, 0.4), ("focal", 700.0, 300.0)]
    {
        assert!(spread(name, wide) > 1.5 * spread(name, narrow), "{name}");
    }
    // Nine in ten of a normal distribution are within 1.645 standard deviations; those far away lie farther away.
    let shown = shown(&[("depth", 2.0), ("noise", 0.5)]);
    let wanted = 2.0 * 1.645 * 1e-2 * shown(SIGMA);
    assert!(((shown(ABOVE) - shown(BELOW)) / wanted - 1.0).abs() < 0.15);
}

#[test]
fn dragging_a_handle_puts_it_there() {
    let mut session = Session::<Bearing>::new();
    let handle = |session: &mut Session<Bearing>, wanted: f64| {
        let numbers = Player::numbers(session);
        let at = numbers.windows(7).rposition(|mark| mark[0] == 101.0 && mark[3] == wanted);
        let at = at.expect("the handle is drawn");
        [numbers[at + 5], numbers[at + 6]]
    };
    Player::drag(&mut session, 0, [7.0, 1.0]);
    let [depth, right] = handle(&mut session, 0.0);
    assert!((depth - 7.0).abs() < 1e-9 && (right - 1.0).abs() < 1e-9);
    Player::drag(&mut session, 1, [5.0, 0.7]);
    assert_relative_eq!(handle(&mut session, 1.0)[1], 0.7, max_relative = 1e-12);
    Player::drag(&mut session, 0, [f64::NAN, 1.0]);
    assert!(session.readings().iter().all(|(_, value)| value.is_finite()));
}

#[test]
fn the_ring_can_be_seen_wherever_it_is_believed_to_be() {
    for depth in [2.0, 4.0, 10.0] {
        for (along, across) in [(0.4, -0.5), (3.0, -0.5), (3.0, 0.5)] {
            let settings = [("depth", depth), ("along", along), ("across", across)];
            let mut session = Session::<Bearing>::with(&settings).unwrap();
            let numbers = Player::numbers(&mut session);
            let of = |kind, handle| {
                let wanted = |mark: &&[f64]| mark[..4] == [kind, 0.0, mark[2], handle];
                numbers.windows(9).find(wanted).map(|mark| mark[5..].to_vec()).expect("it is drawn")
            };
            let (view, ring) = (of(100.0, 0.0), of(101.0, 0.0));
            assert!(ring[0] < view[1] && (view[2]..view[3]).contains(&ring[1]), "{settings:?}");
        }
    }
}

#[test]
fn the_cloud_is_seen_at_the_start() {
    let mut session = Session::<Bearing>::new();
    let panel = Bearing::FACE.panels[0];
    let mut rest = &Player::numbers(&mut session)[Bearing::FACE.readings.len()..];
    let wanted = [Shape::Discs as u8, 0, Style::Third as u8].map(f64::from);
    let mut depths = Vec::new();
    while let [shape, panel, style, _, count, after @ ..] = rest {
        let (places, later) = after.split_at(*count as usize);
        if [*shape, *panel, *style] == wanted {
            depths.extend(places.chunks(2).map(|place| place[0]));
        }
        rest = later;
    }
    depths.sort_by(f64::total_cmp);
    let ninety = depths[depths.len() * 19 / 20] - depths[depths.len() / 20];
    let [least, most] = panel.x.range;
    assert!(ninety > 0.1 * (most - least), "{ninety}");
}

#[test]
fn no_number_is_missing_but_where_there_is_none() {
    let mut session = Session::<Bearing>::new();
    let controls = Bearing::FACE.controls;
    for combination in 0..3_usize.pow(controls.len() as u32) {
        let mut rest = combination;
        for control in controls {
            session.set(control.name, [control.least, control.start, control.most][rest % 3]);
            rest /= 3;
        }
        for (label, value) in session.readings() {
            let may_be_none = label == ABOVE || label == BELOW;
            assert!(value.is_finite() || may_be_none, "{label} {:?}", session.controls());
        }
        assert!(Player::numbers(&mut session).len() < 1000);
    }
}

#[test]
fn with_the_same_parallax_a_depth_is_as_sure_as_a_part_of_itself() {
    let shown = |depth: f64, baseline: f64| {
        let mut session = Session::<Parallax>::with(&[("depth", depth), ("baseline", baseline)])
            .expect("controls");
        let readings = session.readings();
        assert_eq!(readings[4].0, "σ over the depth");
        [readings[2].1, readings[4].1]
    };
    for (near, far) in shown(4.0, 0.3).into_iter().zip(shown(8.0, 0.6)) {
        assert_relative_eq!(near, far, max_relative = 1e-9);
    }
    assert!(shown(8.0, 1.2)[1] < 0.6 * shown(8.0, 0.6)[1]);
    let veiled: Vec<_> = Parallax::FACE.readings.iter().filter(|reading| reading.veiled).collect();
    assert_eq!(veiled.len(), 1);
    assert_eq!(veiled[0].label, "σ over the depth");
}
