//! Faults of recordings on the way from nothing to the batch of a flight: each is an error, a refusal
//! by name, or it does no harm.

use nalgebra::{Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::datasets::euroc::{read_ground_truth, read_imu};
use vislam::datasets::tracks::{Feature, Picture, read_tracks};
use vislam::filtering::{Freedom, absolute_trajectory_error};
use vislam::inertial::{NavState, StampedSample, WindowError};
use vislam::initialization::{
    AlignmentRefused, BatchError, BeginOptions, Known, LandmarkRefused, NoStart, NotAtRest,
    RestOptions, Sensors, Whole, WholeOptions, at_rest, begin,
};
use vislam::preintegration::PreintegrationError;
use vislam::simulation::{Flight, FlightRecording, Trajectory};
use vislam::structure_from_motion::ReconstructionError;
use vislam::two_views::TriangulationError;

const LEVER: Vector3<f64> = Vector3::new(0.1, 0.05, -0.02);

/// Six seconds in the air from the first picture on, ten pictures a second.
fn flight() -> Flight {
    let motion = Trajectory::figure_eight();
    Flight { seconds: 6.0, picture_rate: 10.0, tracks: 40, ..Flight::new(motion) }.with_lever(LEVER)
}

fn flown(flight: &Flight) -> FlightRecording {
    flight.record(&flight.room(3.0, 400, 3).unwrap(), 3).unwrap()
}

/// What went wrong on the way, in one place.
#[derive(Debug)]
enum Failed {
    Begin(NoStart),
    Grow(BatchError),
}

fn estimated(
    recording: &FlightRecording,
    readings: &[StampedSample],
    pictures: &[Picture],
) -> Result<Whole, Failed> {
    let sensors = Sensors::of_flight(&recording.flight);
    let options = BeginOptions::default();
    let begun = begin(&sensors, readings, pictures, &options).map_err(Failed::Begin)?;
    Whole::grown(&sensors, readings, pictures, begun.known, &WholeOptions::default())
        .map_err(Failed::Grow)
}

/// How far positions are off after alignment, in metres, where there are these pictures.
fn position_error(whole: &Whole, recording: &FlightRecording, pictures: &[Picture]) -> f64 {
    let estimate: Vec<NavState> = whole.batch.states.iter().map(|key| whole.values[*key]).collect();
    let place = |picture: &Picture| {
        let time = |other: &Picture| other.nanoseconds.cmp(&picture.nanoseconds);
        recording.pictures.binary_search_by(time).unwrap()
    };
    let truth: Vec<NavState> =
        pictures.iter().map(|picture| recording.truth.states[place(picture)]).collect();
    absolute_trajectory_error(&estimate, &truth, Freedom::Four).unwrap().position
}

/// The error of an estimate that has to be there.
fn error_of(recording: &FlightRecording, readings: &[StampedSample], pictures: &[Picture]) -> f64 {
    let whole = estimated(recording, readings, pictures).unwrap();
    position_error(&whole, recording, pictures)
}

#[test]
fn states_that_belong_to_no_picture_are_refused() {
    let recording = flown(&flight());
    let sensors = Sensors::of_flight(&recording.flight);
    let begun = begin(&sensors, &recording.readings, &recording.pictures, &BeginOptions::default());
    let known = begun.unwrap().known;
    let pictures = recording.pictures.len();
    for (known, pictures) in [
        (known.clone(), 0),
        (Known { states: Vec::new(), ..known.clone() }, pictures),
        (Known { first: pictures, ..known.clone() }, pictures),
        (Known { first: usize::MAX, ..known }, pictures),
    ] {
        let pictures = &recording.pictures[..pictures];
        let options = WholeOptions::default();
        let refused = Whole::grown(&sensors, &recording.readings, pictures, known, &options);
        assert!(matches!(refused.err().unwrap(), BatchError::Known { .. }));
    }
}

#[test]
fn a_gap_in_the_readings_is_refused_wherever_it_is() {
    for gap in [[0.6, 1.2], [4.0, 4.6]] {
        let recording = flown(&Flight { gap: Some(gap), ..flight() });
        // While it is looked for, the flight may begin behind a gap; the batch has to cross it.
        let failed = estimated(&recording, &recording.readings, &recording.pictures);
        let failed = failed.err().unwrap();
        let Failed::Grow(BatchError::Readings(WindowError::Gap { from, to })) = failed else {
            panic!("{gap:?}: {failed:?}")
        };
        assert!(1e-9 * (to - from) as f64 >= gap[1] - gap[0]);
    }
}

#[test]
fn readings_carry_the_estimate_over_a_second_without_pictures() {
    let recording = flown(&flight());
    let second = 3_500_000_000..4_500_000_000;
    let mut pictures = recording.pictures.clone();
    pictures.retain(|picture| !second.contains(&picture.nanoseconds));
    assert_eq!(pictures.len(), recording.pictures.len() - 10);
    let error = error_of(&recording, &recording.readings, &pictures);
    assert!(error < 0.03, "{error} m off");
}

#[test]
fn one_reading_that_is_missing_does_no_harm() {
    let recording = flown(&flight());
    for missing in [150, 700] {
        let mut readings = recording.readings.clone();
        readings.remove(missing);
        let error = error_of(&recording, &readings, &recording.pictures);
        assert!(error < 0.03, "without reading {missing} {error} m off");
    }
}

#[test]
fn readings_whose_time_runs_back_are_refused() {
    let recording = flown(&flight());
    for late in [150, 705] {
        let mut readings = recording.readings.clone();
        readings.swap(late, late + 1);
        let failed = estimated(&recording, &readings, &recording.pictures).err().unwrap();
        let Failed::Grow(BatchError::Readings(WindowError::Unsorted { nanoseconds })) = failed
        else {
            panic!("{failed:?}");
        };
        assert_eq!(nanoseconds, recording.readings[late].nanoseconds);
    }
    let mut backwards = recording.readings.clone();
    backwards.reverse();
    let some = &recording.pictures[..25];
    let failed = estimated(&recording, &backwards, some).err().unwrap();
    assert!(matches!(failed, Failed::Begin(_)), "{failed:?}");
}

#[test]
fn pictures_whose_time_runs_back_are_refused() {
    let recording = flown(&flight());
    for late in [5, 40] {
        let mut pictures = recording.pictures.clone();
        pictures.swap(late, late + 1);
        let failed = estimated(&recording, &recording.readings, &pictures).err().unwrap();
        let names_it = matches!(
            failed,
            Failed::Grow(BatchError::Readings(WindowError::Order { .. })) | Failed::Begin(_)
        );
        assert!(names_it, "{failed:?}");
    }
    let mut backwards = recording.pictures.clone();
    backwards.reverse();
    assert!(estimated(&recording, &recording.readings, &backwards).is_err());
}

#[test]
fn a_landmark_at_infinity_is_refused_for_its_parallax_and_does_no_harm() {
    let mut recording = flown(&flight());
    let track = recording.truth.landmark_of_track.len();
    let Flight { camera, rig, .. } = recording.flight;
    for (picture, state) in recording.pictures.iter_mut().zip(&recording.truth.states) {
        let star = recording.truth.states[0].world_from_body * Vector3::x();
        let camera_from_world = rig.camera_from_world(state);
        if let Some(pixel) = camera.project_cam(&(camera_from_world.rotation * star)) {
            picture.features.push(Feature { track, pixel, right: None });
        }
    }
    let seen = recording.pictures.iter().flat_map(|picture| &picture.features);
    assert!(seen.filter(|feature| feature.track == track).count() > 10);
    let whole = estimated(&recording, &recording.readings, &recording.pictures).unwrap();
    let why = &whole.refused[&track];
    let is_parallax = matches!(why, LandmarkRefused::Rays(TriangulationError::Parallax { .. }));
    assert!(is_parallax, "{why}");
    let error = position_error(&whole, &recording, &recording.pictures);
    assert!(error < 0.03, "{error} m off");
}

#[test]
fn a_second_in_which_all_tracks_are_wrong_is_flown_by_the_readings() {
    let recording = flown(&flight());
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut pictures = recording.pictures.clone();
    let image = recording.flight.image;
    let mut wrong = std::collections::BTreeSet::new();
    for feature in pictures[35..45].iter_mut().flat_map(|picture| &mut picture.features) {
        feature.pixel =
            Vector2::new(random.random_range(0.0..image.x), random.random_range(0.0..image.y));
        wrong.insert(feature.track);
    }
    let whole = estimated(&recording, &recording.readings, &pictures).unwrap();
    let error = position_error(&whole, &recording, &pictures);
    assert!(error < 0.1, "{error} m off");
    // Those who would be believed nevertheless are few.
    let believed = wrong.iter().filter(|track| whole.batch.landmarks.contains_key(track)).count();
    assert!(10 * believed < wrong.len(), "{believed} of {} are landmarks", wrong.len());
}

#[test]
fn a_start_in_mid_air_is_no_stand() {
    let recording = flown(&flight());
    let sensors = Sensors::of_flight(&recording.flight);
    let begun = begin(&sensors, &recording.readings, &recording.pictures, &BeginOptions::default());
    let begun = begun.unwrap();
    assert!(begun.known.standing.is_empty());
    assert!(begun.scale_sigma.unwrap() < 0.1);
    let error = error_of(&recording, &recording.readings, &recording.pictures);
    assert!(error < 0.03, "{error} m off");
}

#[test]
fn pixels_that_are_worse_than_they_are_said_to_be_do_not_begin() {
    let recording = flown(&Flight { seconds: 3.0, ..flight() });
    let readings_and_pictures = (&recording.readings[..], &recording.pictures[..]);
    let begun = |pixel_sigma: f64| {
        let sensors = Sensors { pixel_sigma, ..Sensors::of_flight(&recording.flight) };
        let (readings, pictures) = readings_and_pictures;
        begin(&sensors, readings, pictures, &BeginOptions::default())
    };
    begun(1.0).unwrap();
    let refused = begun(0.2).unwrap_err();
    let NoStart::Misfit { misfit } = refused else { panic!("{refused}") };
    assert!(misfit > 4.0, "{misfit}");
}

#[test]
fn a_reading_that_is_no_number_is_refused() {
    let recording = flown(&flight());
    for broken in [100, 700] {
        let mut readings = recording.readings.clone();
        readings[broken].sample.gyro.y = f64::NAN;
        let failed = estimated(&recording, &readings, &recording.pictures).err().unwrap();
        let names_it = matches!(
            failed,
            Failed::Grow(BatchError::Preintegration(PreintegrationError::Sample { .. }))
        );
        assert!(names_it, "{failed:?}");
    }
    // Of a body that stands, too.
    let still = flown(&Flight { seconds: 1.0, ..Flight::new(Trajectory::hover()) });
    let mut readings = still.readings.clone();
    readings[50].sample.accelerometer.x = f64::NAN;
    let refused_at = NotAtRest::Reading { nanoseconds: readings[50].nanoseconds };
    let sensors = Sensors::of_flight(&still.flight);
    let options = RestOptions { motion: 5.0, ..RestOptions::default() };
    assert!(at_rest(&sensors, &still.readings, &still.pictures, &options).is_ok());
    for readings in [&mut readings, &mut still.readings.clone()] {
        readings[50].sample.gyro.x = f64::NAN;
        let refused = at_rest(&sensors, readings, &still.pictures, &options).unwrap_err();
        assert_eq!(refused, refused_at);
        readings[50].sample.gyro.x = 0.0;
    }
    // The one before is interpolated with it, and named in its place no more.
    let mut readings = still.readings.clone();
    readings[1].sample.gyro.x = f64::NAN;
    let refused = at_rest(&sensors, &readings, &still.pictures, &options).unwrap_err();
    assert_eq!(refused, NotAtRest::Reading { nanoseconds: readings[1].nanoseconds });
}

#[test]
fn without_gravity_a_stand_says_nothing_of_the_vertical() {
    let new = Flight::new(Trajectory::hover());
    let still = flown(&Flight { seconds: 1.0, gravity: Vector3::zeros(), ..new });
    let sensors = Sensors::of_flight(&still.flight);
    let options = RestOptions { motion: 5.0, ..RestOptions::default() };
    let refused = at_rest(&sensors, &still.readings, &still.pictures, &options).unwrap_err();
    assert_eq!(refused, NotAtRest::Weightless { gravity: 0.0 });
}

#[test]
fn a_pixel_that_is_no_number_is_refused_with_its_track() {
    let recording = flown(&flight());
    let mut pictures = recording.pictures.clone();
    let feature = &mut pictures[40].features[3];
    feature.pixel.x = f64::NAN;
    let track = feature.track;
    let whole = estimated(&recording, &recording.readings, &pictures).unwrap();
    assert!(whole.refused.contains_key(&track));
    let error = position_error(&whole, &recording, &pictures);
    assert!(error < 0.03, "{error} m off");
    // All of them, from the beginning on.
    for feature in pictures.iter_mut().flat_map(|picture| &mut picture.features) {
        feature.pixel.y = f64::NAN;
    }
    let failed = estimated(&recording, &recording.readings, &pictures).err().unwrap();
    assert!(matches!(failed, Failed::Begin(NoStart::Pictures(_))), "{failed:?}");
}

/// A start looks at some of the pictures alone, and tells the number that one has among all.
#[test]
fn a_pixel_that_is_no_number_is_told_with_the_number_of_its_picture() {
    let recording = flown(&flight());
    let sensors = Sensors::of_flight(&recording.flight);
    let options = BeginOptions { rate: 4.0, ..BeginOptions::default() };
    let told = (4..16).filter(|&broken| {
        let mut pictures = recording.pictures[..16].to_vec();
        pictures[broken].features.iter_mut().for_each(|feature| feature.pixel.x = f64::NAN);
        match begin(&sensors, &recording.readings, &pictures, &options) {
            Err(NoStart::Pictures(ReconstructionError::Keypoint { picture, .. })) => {
                assert_eq!(picture, broken);
                true
            }
            _ => false,
        }
    });
    assert!(told.count() > 2);
    // A track that stands twice in a picture, as well.
    let mut pictures = recording.pictures[..16].to_vec();
    let twice = pictures[15].features[0];
    pictures[15].features.insert(0, twice);
    let refused = begin(&sensors, &recording.readings, &pictures, &options).unwrap_err();
    let with_itself = |error: &ReconstructionError| {
        matches!(error, ReconstructionError::WithItself { picture: 15, .. })
    };
    assert!(matches!(&refused, NoStart::Pictures(error) if with_itself(error)), "{refused:?}");
}

#[test]
fn nothing_is_not_estimated() {
    let recording = flown(&flight());
    let failed = estimated(&recording, &recording.readings, &[]).err().unwrap();
    assert!(matches!(failed, Failed::Begin(NoStart::TooShort { pictures: 0, .. })), "{failed:?}");
    let mut blind = recording.pictures.clone();
    blind.iter_mut().for_each(|picture| picture.features.clear());
    let failed = estimated(&recording, &recording.readings, &blind).err().unwrap();
    assert!(matches!(failed, Failed::Begin(NoStart::Pictures(_))), "{failed:?}");
    let failed = estimated(&recording, &[], &recording.pictures).err().unwrap();
    assert!(matches!(failed, Failed::Begin(_)), "{failed:?}");
    for text in ["", "\n", "#timestamp"] {
        for error in [
            read_imu(text).map(|_| ()).unwrap_err(),
            read_tracks(text).map(|_| ()).unwrap_err(),
            read_ground_truth(text).map(|_| ()).unwrap_err(),
        ] {
            assert_eq!(error.line, 1, "{error}");
        }
    }
}

#[test]
fn tracks_that_never_meet_readings_are_refused() {
    let recording = flown(&flight());
    let mut pictures = recording.pictures[..25].to_vec();
    pictures.iter_mut().for_each(|picture| picture.nanoseconds += 3_600_000_000_000);
    let failed = estimated(&recording, &recording.readings, &pictures).err().unwrap();
    // A short path may look uniform as well; what could not be found stands inside then.
    let why = match failed {
        Failed::Begin(NoStart::Uniform { error, .. }) => *error,
        Failed::Begin(error) => error,
        Failed::Grow(error) => panic!("{error}"),
    };
    let is_not_covered = matches!(
        why,
        NoStart::Alignment(AlignmentRefused::Readings(WindowError::NotCovered { .. }))
    );
    assert!(is_not_covered, "{why}");
}
