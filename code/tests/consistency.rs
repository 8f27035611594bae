//! What seven ways to linearize a filter come to know of directions that nobody measured.

use nalgebra::{DMatrix, DVector, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::consistency::{Chart, Claimed, Linearization, Point, Policy, certificate, constrained};
use vislam::inertial::{BodyPose, ImuNoise, NavState};
use vislam::least_squares::{Key, Values};
use vislam::manifold::so3;
use vislam::msckf::{Msckf, MsckfError, MsckfOptions, Start};
use vislam::observability::{WorldMotion, four_motions};
use vislam::simulation::{Flight, FlightRecording, Trajectory};

/// Twelve seconds with a poor sensor, so that estimates move.
fn flown(seed: u64) -> FlightRecording {
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let new = Flight::new(Trajectory::figure_eight()).with_lever(lever);
    let flight =
        Flight { seconds: 12.0, picture_rate: 5.0, tracks: 40, noise: ImuNoise::mems(), ..new };
    flight.record(&flight.room(3.0, 400, seed).unwrap(), seed).unwrap()
}

const SIGMAS: [f64; 4] = [0.01, 0.05, 2e-3, 0.02];

fn options(linearization: impl Into<Linearization>, landmarks: usize) -> MsckfOptions {
    let flight = flown(0).flight;
    let linearization = linearization.into();
    MsckfOptions { linearization, landmarks, gate: 1.0, ..MsckfOptions::of_flight(&flight) }
}

/// What a filter claims on a flight, and the filter at its end.
fn follow(linearization: impl Into<Linearization>, landmarks: usize) -> (Claimed, Msckf) {
    let recording = flown(0);
    let start = Start::at_the_origin(&recording, SIGMAS, 7).unwrap();
    let mut filter = Msckf::new(options(linearization, landmarks), &start).unwrap();
    let mut claimed = Claimed::default();
    for number in 0..recording.pictures.len() {
        claimed.add(&filter.follow(&recording, number).unwrap().unwrap().claimed);
    }
    (claimed, filter)
}

/// The part of the whole that is claimed along each direction.
fn parts(claimed: &Claimed) -> [f64; 4] {
    std::array::from_fn(|direction| claimed.gained[direction] / claimed.whole[direction])
}

#[test]
fn all_policies_but_the_standard_one_learn_nothing_of_shifts_and_of_the_heading() {
    for policy in Policy::ALL {
        for landmarks in [0, 20] {
            let parts = parts(&follow(policy, landmarks).0);
            assert!(parts[..3].iter().all(|part| *part < 1e-20), "{policy} {landmarks}: {parts:?}");
            match policy {
                Policy::Standard => assert!(parts[3] > 1e-5, "{landmarks}: {parts:?}"),
                _ => assert!(parts[3] < 1e-12, "{policy} {landmarks}: {parts:?}"),
            }
        }
    }
}

#[test]
fn first_estimates_of_transitions_or_of_pixels_alone_learn_the_heading() {
    let first = Policy::FirstEstimates.linearization();
    for mixed in [
        Linearization { transitions: Point::Latest, ..first },
        Linearization { pixels: Point::Latest, ..first },
    ] {
        let parts = parts(&follow(mixed, 20).0);
        assert!(parts[3] > 1e-6, "{mixed:?}: {parts:?}");
        assert!(parts[..3].iter().all(|part| *part < 1e-20), "{mixed:?}: {parts:?}");
    }
}

#[test]
fn a_kept_landmark_that_retracts_alone_loses_the_heading() {
    let alone = Linearization { chart: Chart::RightInvariantPoses, ..Linearization::default() };
    let [without, with] = [0, 20].map(|landmarks| parts(&follow(alone, landmarks).0)[3]);
    assert!(without < 1e-12, "{without}");
    assert!(with > 1e-6, "{with}");
}

#[test]
fn what_is_known_of_the_heading_grows_for_the_standard_policy_alone() {
    let recording = flown(0);
    let start = Start::at_the_origin(&recording, SIGMAS, 7).unwrap();
    for policy in Policy::ALL {
        let mut filter = Msckf::new(options(policy, 20), &start).unwrap();
        let (mut least, mut grown) = (f64::INFINITY, 0_usize);
        for number in 0..recording.pictures.len() {
            filter.follow(&recording, number).unwrap();
            // Before the first pose has left, the heading is known exactly.
            let Some(known) = filter.certificate().filter(|_| number > 12) else { continue };
            grown += usize::from(known[(3, 3)] > least * (1.0 + 1e-6));
            least = known[(3, 3)].min(least);
        }
        assert!(least.is_finite(), "{policy}");
        assert_eq!(grown > 0, policy == Policy::Standard, "{policy}: {grown}");
    }
}

#[test]
fn derivatives_at_a_truth_that_nobody_knows_are_refused() {
    let recording = flown(0);
    let start = Start::at_the_origin(&recording, SIGMAS, 7).unwrap();
    let mut filter = Msckf::new(options(Policy::Ideal, 0), &start).unwrap();
    let refused = filter.picture(&recording.pictures[0]).unwrap_err();
    assert_eq!(refused, MsckfError::NoTruth { picture: 0 });
    assert!(refused.to_string().contains("follow a simulated recording"), "{refused}");
}

#[test]
fn a_start_before_the_truth_has_no_derivatives_there() {
    let mut recording = flown(0);
    let start = Start::at_the_origin(&recording, SIGMAS, 7).unwrap();
    recording.pictures.remove(0);
    recording.truth.states.remove(0);
    recording.truth.biases.remove(0);
    let mut filter = Msckf::new(options(Policy::Ideal, 0), &start).unwrap();
    assert_eq!(filter.follow(&recording, 0), Err(MsckfError::StartBeforeTruth));
}

#[test]
fn a_truth_that_ends_is_told_and_one_that_grows_is_followed() {
    let recording = flown(0);
    let start = Start::at_the_origin(&recording, SIGMAS, 7).unwrap();
    let mut filter = Msckf::new(options(Policy::Ideal, 0), &start).unwrap();
    let mut growing = recording.clone();
    growing.truth.states.truncate(5);
    for number in 0..5 {
        filter.follow(&growing, number).unwrap();
    }
    let state = *filter.state();
    assert_eq!(filter.follow(&growing, 5), Err(MsckfError::NoTruth { picture: 5 }));
    assert_eq!(*filter.state(), state);
    growing.truth.states.clone_from(&recording.truth.states);
    for number in 5..20 {
        assert!(filter.follow(&growing, number).unwrap().is_some(), "{number}");
    }
}

#[test]
fn a_policy_is_read_by_its_name() {
    for policy in Policy::ALL {
        assert_eq!(policy.to_string().parse::<Policy>(), Ok(policy));
    }
    let refused = "fej".parse::<Policy>().unwrap_err().to_string();
    assert!(refused.contains("“fej”") && refused.contains("first_estimates"), "{refused}");
}

/// A state, two former poses and two landmarks.
struct Drawn {
    values: Values,
    body: Key<NavState>,
    random: ChaCha8Rng,
}

impl Drawn {
    fn new(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut values = Values::new();
        let mut vector = |size: f64| Vector3::from_fn(|_, _| size * normal(&mut random));
        let state = NavState {
            world_from_body: so3::exp(&vector(1.0)),
            velocity: vector(1.0),
            position: vector(3.0),
        };
        let body = values.add(state);
        for _ in 0..2 {
            values.add(BodyPose { world_from_body: so3::exp(&vector(1.0)), position: vector(3.0) });
            values.add(vector(5.0));
        }
        Self { values, body, random }
    }

    fn step(&mut self, size: f64) -> Vec<f64> {
        (0..self.values.dimension()).map(|_| size * normal(&mut self.random)).collect()
    }
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// The steps of all variables under a motion of the world.
fn steps(values: &Values, motion: &WorldMotion) -> DVector<f64> {
    let mut steps = Vec::new();
    for index in 0..values.len() {
        if let Some(key) = values.key::<NavState>(index) {
            steps.extend(motion.of_state(&values[key]));
        } else if let Some(key) = values.key::<BodyPose>(index) {
            let [phi, _, p] = motion.of_state(&values[key].at_rest());
            steps.extend([phi, p]);
        } else if let Some(key) = values.key::<Vector3<f64>>(index) {
            steps.push(motion.of_point(&values[key]));
        }
    }
    DVector::from_iterator(values.dimension(), steps.iter().flat_map(|step| step.iter().copied()))
}

#[test]
fn a_chart_moves_by_a_small_step_as_its_variables_do_alone() {
    for chart in [Chart::RightInvariant, Chart::RightInvariantPoses, Chart::Robocentric] {
        let mut drawn = Drawn::new(1);
        let step = drawn.step(1e-5);
        let together = chart.retract(&drawn.values, drawn.body, &step);
        let alone = drawn.values.retract(&step);
        let apart = DVector::from_vec(alone.local(&together)).amax();
        assert!(apart > 1e-12 && apart < 1e-8, "{chart:?}: {apart}");
    }
}

#[test]
fn what_a_chart_carries_to_another_estimate_moves_it_in_the_same_way() {
    for chart in [Chart::RightInvariant, Chart::RightInvariantPoses, Chart::Robocentric] {
        let mut drawn = Drawn::new(2);
        let (long, small) = (drawn.step(0.3), drawn.step(1e-6));
        let moved = chart.retract(&drawn.values, drawn.body, &long);
        let transport = chart.transport((&drawn.values, &moved), drawn.body).unwrap();
        let mut carried = DMatrix::from_column_slice(small.len(), 1, &small);
        transport.apply(&mut carried);
        // The four motions of the world are the same step in the chart at both estimates.
        let keeps_yaw = chart != Chart::RightInvariantPoses;
        for (number, motion) in four_motions(&Vector3::z()).iter().enumerate() {
            let before = steps(&drawn.values, motion);
            let mut there = DMatrix::from_column_slice(before.len(), 1, before.as_slice());
            transport.apply(&mut there);
            let off = (DVector::from_column_slice(there.as_slice()) - steps(&moved, motion)).amax();
            assert_eq!(off < 1e-9, keeps_yaw || number < 3, "{chart:?}, {number}: {off}");
        }
        let in_chart = chart.by_step(&drawn.values, drawn.body) * DVector::from_vec(small);
        let there = chart.by_step(&moved, drawn.body) * carried.column(0);
        assert!((&in_chart - there).amax() < 1e-12 * in_chart.amax(), "{chart:?}");
    }
}

#[test]
fn a_covariance_is_carried_from_both_sides() {
    let mut drawn = Drawn::new(3);
    let chart = Chart::Robocentric;
    let step = drawn.step(0.3);
    let moved = chart.retract(&drawn.values, drawn.body, &step);
    let transport = chart.transport((&drawn.values, &moved), drawn.body).unwrap();
    let dimension = drawn.values.dimension();
    let root = DMatrix::from_fn(dimension, 2, |_, _| normal(&mut drawn.random));
    let mut covariance = &root * root.transpose();
    transport.carry(&mut covariance);
    let mut carried = root.clone();
    transport.apply(&mut carried);
    assert!((covariance - &carried * carried.transpose()).amax() < 1e-9);
}

#[test]
fn constrained_rows_have_the_wanted_product_and_are_the_nearest_ones() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut drawn = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| normal(&mut random));
    let (rows, free, wanted) = (drawn(6, 20), drawn(20, 4), drawn(6, 4));
    let nearest = constrained(&rows, &free, &wanted).unwrap();
    assert!((&nearest * &free - &wanted).amax() < 1e-12);
    for _ in 0..20 {
        // Any other rows with the same product differ by something that the directions do not see.
        let other = drawn(6, 20);
        let unseen = constrained(&other, &free, &DMatrix::zeros(6, 4)).unwrap();
        let farther = &nearest + 0.1 * unseen;
        assert!((&farther - &rows).norm() > (&nearest - &rows).norm());
    }
    let dependent = DMatrix::from_fn(20, 4, |row, _| row as f64);
    assert_eq!(constrained(&rows, &dependent, &wanted), None);
}

#[test]
fn a_certificate_is_the_information_along_the_directions() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut drawn = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| normal(&mut random));
    let (root, free) = (drawn(12, 12), drawn(12, 4));
    let covariance = &root * root.transpose();
    let known = certificate(&covariance, &free).unwrap();
    let expected = free.transpose() * covariance.clone().try_inverse().unwrap() * &free;
    assert!((DMatrix::from_column_slice(4, 4, known.as_slice()) - expected).amax() < 1e-6);
    let known_exactly = DMatrix::zeros(12, 12);
    assert_eq!(certificate(&known_exactly, &free), None);
    assert_eq!(certificate(&covariance, &DMatrix::zeros(12, 0)), None);
    assert_eq!(certificate(&covariance, &DMatrix::zeros(11, 4)), None);
}
