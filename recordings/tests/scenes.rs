//! What the scenes promise: their entities, the numbers of the library, and the same recording each time.

use std::collections::BTreeSet;

use recordings::{Ellipsoid, SCENES, Scene, Stage, VERSION, ring_around};
use rerun::external::re_log_types::LogMsg;
use rerun::log::Chunk;

/// All that a scene records, without what says how it is looked at.
fn recorded(name: &str) -> Vec<Chunk> {
    let scene = Scene::named(name).expect("there is such a scene");
    let (stage, storage) = Stage::in_memory(scene.name).expect("a recording in memory");
    scene.play(&stage).expect("the scene can be recorded");
    let messages = storage.take();
    let chunks = messages.iter().filter_map(|message| match message {
        LogMsg::ArrowMsg(store, data) if store.is_recording() => {
            Some(Chunk::from_arrow_msg(data).expect("rerun reads what it wrote"))
        }
        _ => None,
    });
    chunks.collect()
}

fn entities(chunks: &[Chunk]) -> BTreeSet<String> {
    chunks.iter().map(|chunk| chunk.entity_path().to_string()).collect()
}

/// The values of a curve, in their order.
fn curve(chunks: &[Chunk], entity: &str) -> Vec<f64> {
    let own = chunks.iter().filter(|chunk| chunk.entity_path().to_string() == entity);
    let values = own.flat_map(|chunk| {
        let scalars = rerun::Scalars::descriptor_scalars().component;
        chunk.iter_slices::<f64>(scalars).flatten().copied().collect::<Vec<_>>()
    });
    values.collect()
}

fn has(name: &str, promised: &[&str]) {
    let there = entities(&recorded(name));
    for entity in promised {
        assert!(there.contains(*entity), "{name} has no {entity}: {there:?}");
    }
}

#[test]
fn every_scene_has_what_the_chapter_says_of_it() {
    has(
        "bundle_adjustment",
        &[
            "/world/estimate/cameras",
            "/world/estimate/held_camera",
            "/world/estimate/points",
            "/world/estimate/ways",
            "/world/rays",
            "/world/residuals",
            "/world/truth/cameras",
            "/schur_complement",
            "/progress/cost",
        ],
    );
    has("two_views", &["/world/cameras", "/world/rays", "/world/ellipsoids", "/world/dots"]);
    has(
        "preintegration",
        &["/world/keyframes", "/world/parts/tubes", "/world/whole/tube", "/world/whole/flights"],
    );
    has(
        "msckf",
        &[
            "/world/filter/window",
            "/world/filter/ellipsoid",
            "/world/tracks/rays",
            "/image/tails",
            "/position/error",
            "/position/sigma",
        ],
    );
    has(
        "marginalization",
        &[
            "/world/couplings/new",
            "/world/there/ellipsoids",
            "/world/gone/keyframes",
            "/information",
        ],
    );
}

#[test]
fn a_scene_is_named_as_its_file_and_its_picture() {
    for scene in SCENES {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/");
        assert!(std::fs::exists(format!("{root}src/{}.rs", scene.name)).unwrap(), "{}", scene.name);
        let picture = format!("{root}pictures/{}.png", scene.name);
        let size = std::fs::metadata(&picture).expect("the picture is there").len();
        assert!(size <= 150_000, "{picture} has {size} bytes");
    }
    assert!(Scene::named("nothing").is_none());
}

#[test]
fn the_viewer_that_is_named_is_that_of_the_crate() {
    let asked = format!("rerun = {{ version = \"={VERSION}\"");
    assert!(include_str!("../Cargo.toml").contains(&asked), "{asked}");
}

#[test]
fn a_ring_converges_to_the_cost_that_the_library_finds() {
    use vislam::simulation::Scene as World;

    let costs = curve(&recorded("bundle_adjustment"), "/progress/cost");
    assert!(costs.len() > 3 && costs.windows(2).all(|pair| pair[1] <= pair[0]), "{costs:?}");
    let mut problem = World::ring(8, 30, 1.0, 1).with_start(6.0).problem;
    let report = problem.solve(&Default::default()).expect("the ring converges");
    let last = costs.last().expect("there are steps");
    approx::assert_relative_eq!(*last, report.cost.log10(), epsilon = 1e-6);
}

#[test]
fn half_the_baseline_is_twice_the_uncertainty_of_a_far_point() {
    let chunks = recorded("two_views");
    let [far, baseline] = ["/depth/far", "/baseline"].map(|entity| curve(&chunks, entity));
    let ratio = far[far.len() - 1] / far[0];
    let expected = baseline[0] / baseline[baseline.len() - 1];
    approx::assert_relative_eq!(ratio, expected, max_relative = 0.05);
}

#[test]
fn the_sums_begin_again_at_each_keyframe_and_grow_without_one() {
    let chunks = recorded("preintegration");
    let [whole, part] = ["/sigma/whole", "/sigma/part"].map(|entity| curve(&chunks, entity));
    assert!(whole.windows(2).all(|pair| pair[0] < pair[1]));
    let again = part.windows(2).filter(|pair| pair[1] < pair[0]).count();
    assert_eq!(again, 7);
    // The first interval is the beginning of the whole.
    assert_eq!(whole[..20], part[..20]);
}

#[test]
fn the_filter_knows_how_far_off_it_is() {
    let chunks = recorded("msckf");
    let [error, sigma] =
        ["/position/error", "/position/sigma"].map(|entity| curve(&chunks, entity));
    assert_eq!(error.len(), sigma.len());
    let inside = error.iter().zip(&sigma).filter(|(error, sigma)| error < sigma).count();
    assert!(inside as f64 > 0.98 * error.len() as f64, "{inside} of {}", error.len());
}

#[test]
fn keyframes_that_leave_alone_couple_their_landmarks() {
    use vislam::marginalization::{Layout, fill_in};

    let couplings = Layout::eight_keyframes().couplings();
    let measured = couplings.pairs();
    let left = fill_in(&couplings, &[0, 1, 2, 3]).expect("keyframes of the window").couplings;
    let filled = left.pairs().difference(&measured).count();
    let chunks = recorded("marginalization");
    assert_eq!(curve(&chunks, "/couplings/filled_in").last(), Some(&(filled as f64)));
}

#[test]
fn an_ellipsoid_has_the_standard_deviations_as_its_axes() {
    let centre = nalgebra::Vector3::new(1.0, 2.0, 3.0);
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.2, 0.9);
    let variances = nalgebra::Vector3::new(4.0, 0.25, 1.0);
    let covariance = turn.matrix() * nalgebra::Matrix3::from_diagonal(&variances) * turn.inverse();
    let Ellipsoid { half_axes, turn, .. } = Ellipsoid::of(&centre, &covariance, 3.0);
    let axes = nalgebra::Matrix3::from_diagonal(&half_axes.component_mul(&half_axes));
    let again = turn.to_rotation_matrix() * axes * turn.to_rotation_matrix().inverse();
    approx::assert_relative_eq!(again, 9.0 * covariance, epsilon = 1e-9);
}

#[test]
fn a_ring_lies_across_the_direction_at_its_distance() {
    let (place, direction) =
        (nalgebra::Vector3::new(0.0, 1.0, 2.0), nalgebra::Vector3::new(1.0, 1.0, 0.0));
    let covariance = nalgebra::Matrix3::from_diagonal_element(0.04);
    for point in ring_around(&place, &direction, &covariance, 3.0) {
        approx::assert_relative_eq!((point - place).dot(&direction), 0.0, epsilon = 1e-12);
        approx::assert_relative_eq!((point - place).norm(), 0.6, epsilon = 1e-12);
    }
}
