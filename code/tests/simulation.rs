//! What the sensors of a simulated flight bring home.

use approx::assert_relative_eq;
use nalgebra::{Vector2, Vector3};
use vislam::datasets::tracks::Feature;
use vislam::inertial::{ImuBias, ImuNoise, ImuSample, between};
use vislam::manifold::se3;
use vislam::preintegration::{LONGEST_STEP, Rule, imu_residual, preintegrate_stamped};
use vislam::simulation::{
    EulerAngles, Flight, FlightError, FlightRecording, Recorder, ScalarTrajectory, Trajectory,
};

const QUIET: ImuNoise =
    ImuNoise { gyro: 0.0, accelerometer: 0.0, gyro_walk: 0.0, accelerometer_walk: 0.0 };

const BIAS: ImuBias =
    ImuBias { gyro: Vector3::new(0.01, -0.02, 0.03), accelerometer: Vector3::new(0.1, 0.2, -0.1) };

/// Five seconds of the figure-eight, the camera beside the sensor.
fn flight() -> Flight {
    let lever = Vector3::new(0.1, 0.05, -0.02);
    let flight = Flight::new(Trajectory::figure_eight()).with_lever(lever);
    Flight { seconds: 5.0, initial_bias: BIAS, ..flight }
}

fn exact() -> Flight {
    Flight { noise: QUIET, initial_bias: ImuBias::default(), pixel_sigma: 0.0, ..flight() }
}

fn recorded(flight: &Flight, seed: u64) -> FlightRecording {
    flight.record(&flight.room(3.0, 500, seed).unwrap(), seed).unwrap()
}

/// Every observation with the index of its picture.
fn observations(recording: &FlightRecording) -> impl Iterator<Item = (usize, &Feature)> {
    let pictures = recording.pictures.iter().enumerate();
    pictures.flat_map(|(k, picture)| picture.features.iter().map(move |seen| (k, seen)))
}

/// A landmark in the coordinates of the camera at a picture.
fn in_camera(recording: &FlightRecording, picture: usize, track: usize) -> Vector3<f64> {
    let truth = &recording.truth;
    let camera_from_world = recording.flight.rig.camera_from_world(&truth.states[picture]);
    se3::transform(&camera_from_world, &truth.landmarks[truth.landmark_of_track[track]])
}

/// Whether numbers have mean zero and variance one, to five standard deviations.
fn assert_standard(numbers: impl IntoIterator<Item = f64>, fewest: usize) {
    let numbers: Vec<f64> = numbers.into_iter().collect();
    let count = numbers.len() as f64;
    assert!(numbers.len() >= fewest, "{count} numbers");
    let squares: f64 = numbers.iter().map(|number| number * number).sum();
    let sum: f64 = numbers.iter().sum();
    assert!((squares - count).abs() < 5.0 * (2.0 * count).sqrt(), "{} in {count}", squares / count);
    assert!(sum.abs() < 5.0 * count.sqrt(), "mean {}", sum / count);
}

#[test]
fn a_seed_makes_one_recording_and_another_seed_another() {
    let flight = Flight { outliers: 0.1, baseline: Some(0.1), ..flight() };
    assert_eq!(recorded(&flight, 7), recorded(&flight, 7));
    let [one, other] = [7, 8].map(|seed| recorded(&flight, seed));
    assert_ne!(one.readings, other.readings);
    assert_ne!(one.truth.biases, other.truth.biases);
    assert_ne!(one.truth.landmarks, other.truth.landmarks);
}

#[test]
fn a_flight_under_way_has_what_the_whole_one_begins_with_and_readings_that_reach_its_picture() {
    let rates = [(200.0, 20.0), (333.0, 30.0), (30.0, 70.0)];
    for (imu_rate, picture_rate) in rates {
        let flight = Flight { imu_rate, picture_rate, outliers: 0.1, ..flight() };
        let landmarks = flight.room(3.0, 100, 3).unwrap();
        let whole = flight.record(&landmarks, 3).unwrap();
        let mut recorder = Recorder::new(&flight, &landmarks, 3).unwrap();
        let mut pictures = 0;
        while recorder.picture().unwrap() {
            pictures += 1;
            let until = recorder.recording();
            assert_eq!(until.pictures, whole.pictures[..pictures]);
            assert_eq!(until.truth.states, whole.truth.states[..pictures]);
            assert_eq!(until.truth.biases, whole.truth.biases[..pictures]);
            assert_eq!(until.readings, whole.readings[..until.readings.len()]);
            let time = until.pictures[pictures - 1].nanoseconds;
            assert!(until.readings.last().unwrap().nanoseconds >= time);
        }
        assert_eq!(recorder.recording(), &whole);
        assert!(!recorder.picture().unwrap());
    }
}

#[test]
fn the_clocks_tick_at_their_rates_and_the_readings_cover_the_pictures() {
    for (imu_rate, picture_rate, readings, pictures) in
        [(200.0, 20.0, 1001, 101), (333.0, 30.0, 1666, 151), (100.0, 7.0, 501, 36)]
    {
        let recording = recorded(&Flight { imu_rate, picture_rate, ..flight() }, 1);
        assert_eq!(recording.readings.len(), readings);
        assert_eq!(recording.pictures.len(), pictures);
        assert_eq!(recording.truth.states.len(), pictures);
        assert_eq!(recording.truth.biases.len(), pictures);
        for pair in recording.readings.windows(2) {
            let error = pair[0].seconds_to(&pair[1]) - recording.flight.step();
            assert!(error.abs() < 1.1e-9);
        }
        let last = recording.pictures[pictures - 1].nanoseconds;
        assert!(between(&recording.readings, 0, last).is_ok());
    }
}

#[test]
fn a_reading_without_noise_is_what_is_felt_at_its_time_plus_the_bias() {
    let flight = Flight { noise: QUIET, ..flight() };
    for reading in recorded(&flight, 1).readings {
        let felt = flight.motion.at(reading.nanoseconds as f64 / 1e9).sample(&flight.gravity);
        assert_eq!(reading.sample, felt.biased(&BIAS));
    }
}

/// The largest residual of the intervals from one picture to the next.
fn largest_residual(imu_rate: f64, rule: Rule) -> f64 {
    let recording = recorded(&Flight { imu_rate, picture_rate: 2.0, ..exact() }, 1);
    let (truth, noise, bias) = (&recording.truth, ImuNoise::euroc(), ImuBias::default());
    let interval = |k: usize| {
        let [from, to] = [k, k + 1].map(|k| recording.pictures[k].nanoseconds);
        let readings = between(&recording.readings, from, to).unwrap();
        let sums = preintegrate_stamped(&readings, rule, LONGEST_STEP, &bias, &noise).unwrap();
        let gravity = recording.flight.gravity;
        imu_residual(&sums, &truth.states[k], &truth.states[k + 1], &gravity, &bias).amax()
    };
    (0..10).map(interval).fold(0.0, f64::max)
}

#[test]
fn readings_without_noise_lead_from_truth_to_truth_to_the_order_of_the_rule() {
    for (rule, order) in [(Rule::Euler, 1.0), (Rule::Midpoint, 2.0)] {
        let [coarse, fine] = [200.0, 800.0].map(|rate| largest_residual(rate, rule));
        let found = (coarse / fine).log2() / 2.0;
        assert!((found - order).abs() < 0.1, "{rule:?}: {found}");
        assert!(fine < 0.01);
    }
}

#[test]
fn the_noise_of_readings_has_the_variance_of_its_density() {
    let noise = ImuNoise { gyro_walk: 0.0, accelerometer_walk: 0.0, ..ImuNoise::mems() };
    let flight = Flight { seconds: 50.0, noise, ..flight() };
    let sigmas = noise.discrete(flight.step()).diagonal().map(f64::sqrt);
    let readings = flight.record(&[], 3).unwrap().readings;
    let six = |ImuSample { gyro, accelerometer }| ImuBias { gyro, accelerometer }.vector();
    let whitened = readings.iter().map(|reading| {
        let felt = flight.motion.at(reading.nanoseconds as f64 / 1e9).sample(&flight.gravity);
        (six(reading.sample) - six(felt.biased(&BIAS))).component_div(&sigmas)
    });
    for sensor in [0, 3] {
        let errors = whitened.clone().flat_map(|error| [0, 1, 2].map(|axis| error[sensor + axis]));
        assert_standard(errors, 30_000);
    }
}

#[test]
fn biases_walk_from_the_first_by_the_variance_of_their_density() {
    // With thirty pictures a second some intervals have six readings and some have seven.
    for picture_rate in [20.0, 30.0] {
        let flight = Flight { seconds: 300.0, picture_rate, ..flight() };
        let biases = flight.record(&[], 4).unwrap().truth.biases;
        assert_eq!(biases[0], BIAS);
        let steps = biases.windows(2).map(|pair| pair[1].vector() - pair[0].vector());
        let sigmas = flight.noise.bias_walk(1.0 / picture_rate).diagonal().map(f64::sqrt);
        let whitened = steps.map(|step| step.component_div(&sigmas));
        assert_standard(whitened.flat_map(|step| step.data.0[0]), 30_000);
    }
}

#[test]
fn the_noise_of_pixels_has_the_promised_variance_in_both_cameras() {
    let flight = Flight { pixel_sigma: 0.7, baseline: Some(0.2), ..flight() };
    let (noisy, clean) =
        (recorded(&flight, 5), recorded(&Flight { pixel_sigma: 0.0, ..flight.clone() }, 5));
    let pairs = || observations(&noisy).zip(observations(&clean));
    let left = pairs().map(|((_, a), (_, b))| (a.pixel - b.pixel) / 0.7);
    assert_standard(left.flat_map(|error| error.data.0[0]), 10_000);
    let right = pairs().filter_map(|((_, a), (_, b))| Some((a.right? - b.right?) / 0.7));
    assert_standard(right.flat_map(|error| error.data.0[0]), 10_000);
}

#[test]
fn a_pixel_without_noise_is_the_projection_of_its_landmark() {
    let recording = recorded(&exact(), 6);
    assert!(observations(&recording).count() > 5000);
    for (picture, seen) in observations(&recording) {
        let place = in_camera(&recording, picture, seen.track);
        assert_eq!(recording.flight.camera.project_cam(&place), Some(seen.pixel));
        assert_eq!(seen.right, None);
    }
    for (picture, state) in recording.pictures.iter().zip(&recording.truth.states) {
        let motion = recording.flight.motion;
        assert_eq!(*state, motion.at(picture.nanoseconds as f64 / 1e9).state);
    }
}

#[test]
fn a_late_clock_changes_the_stamps_of_the_pictures_and_nothing_else() {
    let on_time = recorded(&flight(), 9);
    let mut late = on_time.flight.clone();
    late.rig.time_offset = 0.013;
    let late = recorded(&late, 9);
    assert_eq!(late.readings, on_time.readings);
    assert_eq!(late.truth, on_time.truth);
    for (late_picture, picture) in late.pictures.iter().zip(&on_time.pictures) {
        assert_eq!(late_picture.features, picture.features);
        assert_eq!(late_picture.nanoseconds, picture.nanoseconds - 13_000_000);
        let read = late.flight.rig.imu_nanoseconds(late_picture.nanoseconds);
        assert_eq!(read, picture.nanoseconds);
    }
}

#[test]
fn a_landmark_is_seen_where_it_is_in_the_image_and_in_the_range_of_depths() {
    let flight = Flight { depths: [2.0, 6.0], tracks: usize::MAX, ..exact() };
    let recording = recorded(&flight, 10);
    let truth = &recording.truth;
    for (k, picture) in recording.pictures.iter().enumerate() {
        let camera_from_world = flight.rig.camera_from_world(&truth.states[k]);
        let is_seen = |landmark: &Vector3<f64>| {
            let place = se3::transform(&camera_from_world, landmark);
            let inside = |pixel: Vector2<f64>| {
                pixel.iter().zip(&flight.image).all(|(at, length)| (0.0..=*length).contains(at))
            };
            (2.0..=6.0).contains(&place.z) && flight.camera.project_cam(&place).is_some_and(inside)
        };
        let seen = truth.landmarks.iter().filter(|landmark| is_seen(landmark)).count();
        assert_eq!(picture.features.len(), seen);
    }
    assert!(recording.pictures.iter().any(|picture| picture.features.len() > 5));
}

#[test]
fn a_track_has_no_holes_and_a_landmark_that_comes_back_has_a_new_one() {
    let recording = recorded(&flight(), 11);
    let landmarks = &recording.truth.landmark_of_track;
    let mut pictures_of = vec![Vec::new(); landmarks.len()];
    for (picture, seen) in observations(&recording) {
        pictures_of[seen.track].push(picture);
    }
    for pictures in &pictures_of {
        assert!(!pictures.is_empty());
        assert!(pictures.windows(2).all(|pair| pair[1] == pair[0] + 1));
    }
    let mut last_of = std::collections::BTreeMap::new();
    let mut returned = 0;
    for (pictures, landmark) in pictures_of.iter().zip(landmarks) {
        if let Some(last) = last_of.insert(landmark, pictures[pictures.len() - 1]) {
            assert!(pictures[0] > last + 1);
            returned += 1;
        }
    }
    assert!(returned > 20, "{returned} landmarks came back");
}

#[test]
fn at_most_so_many_landmarks_are_followed_and_those_that_are_go_on() {
    let many = recorded(&Flight { tracks: usize::MAX, ..flight() }, 12);
    let few = recorded(&Flight { tracks: 30, ..flight() }, 12);
    assert!(few.pictures.iter().all(|picture| picture.features.len() == 30));
    let landmarks = |recording: &FlightRecording, picture: usize| -> Vec<usize> {
        let seen = recording.pictures[picture].features.iter();
        seen.map(|seen| recording.truth.landmark_of_track[seen.track]).collect()
    };
    for picture in 1..few.pictures.len() {
        let (seen, now) = (landmarks(&many, picture), landmarks(&few, picture));
        let before = landmarks(&few, picture - 1);
        let lost = before.iter().filter(|landmark| !now.contains(landmark));
        assert_eq!(lost.filter(|landmark| seen.contains(landmark)).count(), 0);
        let tracks = few.pictures[picture].features.iter().map(|seen| seen.track);
        assert!(tracks.is_sorted());
    }
}

#[test]
fn outliers_have_their_share_are_anywhere_and_leave_the_rest_as_it_is() {
    let clean = recorded(&flight(), 13);
    let spoiled = recorded(&Flight { outliers: 0.2, ..flight() }, 13);
    assert_eq!(clean.readings, spoiled.readings);
    assert_eq!(clean.truth.biases, spoiled.truth.biases);
    assert!(clean.truth.outliers.is_empty() && spoiled.truth.outliers.is_sorted());
    let (mut count, mut wrong) = (0.0, Vec::new());
    for ((picture, a), (_, b)) in observations(&clean).zip(observations(&spoiled)) {
        assert_eq!(a.track, b.track);
        count += 1.0;
        if spoiled.truth.outliers.binary_search(&(picture, b.track)).is_ok() {
            wrong.push(b.pixel.component_div(&spoiled.flight.image));
        } else {
            assert_eq!(a, b);
        }
    }
    let found = wrong.len() as f64;
    assert!((found - 0.2 * count).abs() < 5.0 * (0.16_f64 * count).sqrt(), "{found} of {count}");
    // A number between zero and one that may be any has variance 1/12.
    let centred = wrong.iter().flat_map(|place| (place.add_scalar(-0.5) * 12_f64.sqrt()).data.0[0]);
    assert_standard(centred, 1000);
    assert!(wrong.iter().flatten().all(|part| (0.0..=1.0).contains(part)));
}

#[test]
fn a_gap_takes_readings_out_and_leaves_the_others_as_they_are() {
    let [whole, torn] =
        [None, Some([1.0, 1.5])].map(|gap| recorded(&Flight { gap, ..flight() }, 14));
    assert_eq!(torn.readings.len(), whole.readings.len() - 100);
    let lost = 1_000_000_000..1_500_000_000;
    let kept = whole.readings.iter().filter(|reading| !lost.contains(&reading.nanoseconds));
    assert!(kept.eq(&torn.readings));
    assert_eq!((whole.pictures, whole.truth), (torn.pictures, torn.truth));
}

#[test]
fn a_second_camera_sees_the_disparity_and_leaves_the_first_as_it_is() {
    let stereo = recorded(&Flight { baseline: Some(0.2), ..exact() }, 15);
    for (picture, seen) in observations(&stereo) {
        let depth = in_camera(&stereo, picture, seen.track).z;
        let disparity = stereo.flight.camera.fx * 0.2 / depth;
        // What lies in the left image at its left edge is not in the right one.
        assert_eq!(seen.right.is_some(), seen.pixel.x >= disparity);
        let Some(right) = seen.right else { continue };
        assert!((seen.pixel.x - right.x - disparity).abs() < 1e-9);
        assert!((seen.pixel.y - right.y).abs() < 1e-9);
    }
    let [one, two] = [None, Some(0.2)].map(|baseline| {
        let recording = recorded(&Flight { baseline, outliers: 0.1, ..flight() }, 15);
        observations(&recording).map(|(_, seen)| (seen.track, seen.pixel)).collect::<Vec<_>>()
    });
    assert_eq!(one, two);
}

#[test]
fn a_room_has_landmarks_on_all_its_walls_and_a_camera_sees_some_wherever_it_looks() {
    let yaw = ScalarTrajectory::linear(1.0);
    let pitch = ScalarTrajectory::wave(1.2, 0.7, 0.0);
    let angles = EulerAngles { yaw, pitch, ..EulerAngles::default() };
    let motion = Trajectory { angles, ..Trajectory::figure_eight() };
    let flight = Flight { seconds: 20.0, ..Flight::new(motion) };
    let recording = recorded(&flight, 16);
    assert!(recording.pictures.iter().all(|picture| picture.features.len() > 20));
    // Three metres around a figure-eight of six metres by three by one.
    for (axis, half) in [6.0, 4.5, 3.5].into_iter().enumerate() {
        for side in [-half, half] {
            let on_wall = |place: &&Vector3<f64>| (place[axis] - side).abs() < 0.02;
            let count = recording.truth.landmarks.iter().filter(on_wall).count();
            let area = 12.0 * 9.0 * 7.0 / (2.0 * half);
            let share = area / (2.0 * (12.0 * 9.0 + 12.0 * 7.0 + 9.0 * 7.0));
            let expected = 500.0 * share;
            assert!((count as f64 - expected).abs() < 5.0 * expected.sqrt(), "{count}, {expected}");
        }
    }
}

#[test]
fn a_flight_that_cannot_be_is_refused_with_the_number_that_is_wrong() {
    let sentence = |flight: Flight| flight.record(&[], 1).unwrap_err().to_string();
    let refused = |change: fn(&mut Flight)| {
        let mut flight = flight();
        change(&mut flight);
        sentence(flight)
    };
    for (change, named) in [
        ((|flight| flight.seconds = f64::NAN) as fn(&mut Flight), "`seconds` of the flight is NaN"),
        (|flight| flight.seconds = 1e12, "give fewer"),
        (|flight| flight.imu_rate = 0.0, "`imu_rate` of the flight is 0"),
        (|flight| flight.picture_rate = -1.0, "`picture_rate` of the flight is -1"),
        (|flight| flight.image.y = f64::INFINITY, "`image` of the flight is inf"),
        (|flight| flight.image.x = f64::NAN, "`image` of the flight is NaN"),
        (|flight| flight.camera.fx = f64::NAN, "`camera` of the flight is NaN"),
        (
            |flight| flight.rig.body_from_camera.translation.vector.z = f64::NAN,
            "`body_from_camera` of the flight is NaN",
        ),
        (|flight| flight.baseline = Some(0.0), "`baseline` of the flight is 0"),
        (|flight| flight.initial_bias.gyro.x = f64::NAN, "`initial_bias`"),
        (|flight| flight.rig.time_offset = f64::NAN, "`time_offset`"),
        (|flight| flight.gravity.z = f64::NAN, "`gravity`"),
        (|flight| flight.pixel_sigma = -1.0, "`pixel_sigma` of the flight is -1"),
        (|flight| flight.depths = [3.0, 2.0], "`depths` of the flight is 3"),
        (|flight| flight.outliers = 1.5, "`outliers` of the flight is 1.5; give zero to one"),
        (|flight| flight.gap = Some([2.0, 1.0]), "`gap` of the flight is 2"),
        (|flight| flight.noise.gyro = -1.0, "the noise density `gyro` is -1"),
        (|flight| flight.motion.position[0].rate = f64::NAN, "the motion is not finite after 0 s"),
    ] {
        let sentence = refused(change);
        assert!(sentence.contains(named), "{sentence}");
    }
    let margin = flight().room(0.0, 10, 1).unwrap_err();
    assert!(matches!(margin, FlightError::Number { name: "margin", .. }));
    let nowhere = Flight { motion: Trajectory::level_turn(1.0, 0.0), ..flight() };
    assert!(matches!(nowhere.room(1.0, 10, 1), Err(FlightError::Motion { .. })));
}

/// The kinematics of a stand are those of the formulas with another time, so derivatives still are derivatives.
#[test]
fn a_body_stands_where_it_is_and_goes_on_from_there() {
    let stands: &[[f64; 2]] = &[[-1.0, 1.5], [4.0, 5.0]];
    let motion = Trajectory::figure_eight().with_stands(stands);
    let step = 1e-4;
    for time in [0.2, 1.4, 1.7, 2.3, 3.2, 3.9, 4.5, 5.4, 7.0] {
        let [before, now, after] = [time - step, time, time + step].map(|time| motion.at(time));
        let velocity = (after.state.position - before.state.position) / (2.0 * step);
        let acceleration = (after.state.velocity - before.state.velocity) / (2.0 * step);
        assert_relative_eq!(now.state.velocity, velocity, epsilon = 1e-6);
        assert_relative_eq!(now.acceleration, acceleration, epsilon = 1e-6);
        let rotation = before.state.world_from_body.inverse() * after.state.world_from_body;
        let rate = rotation.scaled_axis() / (2.0 * step);
        assert_relative_eq!(now.angular_velocity, rate, epsilon = 1e-6);
        let is_standing = stands.iter().any(|[from, to]| (*from..*to).contains(&time));
        assert_eq!(now.state.velocity.norm() == 0.0, is_standing, "at {time} s");
    }
    let [end, start] = [5.0, 4.0].map(|time| motion.at(time).state.position);
    assert_relative_eq!(end, start, epsilon = 1e-12);
}
