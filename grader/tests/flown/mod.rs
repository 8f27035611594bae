//! Answers to graded flights: those of the book's estimators, and faulty ones.

use std::path::Path;

use grader::fly::answer::{Answer, COVARIANCE, DECLARATION, Kind, TRAJECTORY, folder};
use grader::fly::flights::{Graded, STAND};
use grader::fly::judge::{Course, Judged};
use grader::fly::key::Key;
use grader::fly::measured::has_one_world;
use grader::fly::reference::{Line, followed, line};
use nalgebra::{Matrix6, Vector3, Vector6};
use vislam::datasets::written;
use vislam::inertial::NavState;
use vislam::initialization::Sensors;
use vislam::odometry::{Estimator, Odometry, OdometryOptions};
use vislam::simulation::FlightRecording;

/// The folder that flights of tests are drawn for.
pub const FOLDER: &str = "ada";

/// The flights of a key.
pub fn course(key: u128) -> Course {
    Course::of(Graded::all(&Key::of(key), FOLDER)).unwrap()
}

/// What an estimator of the book hands in.
pub fn reference(flights: &[Graded], estimator: Estimator) -> Answer {
    let of = |flight: &Graded| followed(&flight.flown().unwrap(), estimator).unwrap();
    Answer { kind: Kind::Causal, flights: flights.iter().map(of).collect() }
}

/// What an answer changed by a fault of what is written hands in.
pub fn written_by(
    answer: &Answer,
    flights: &[Graded],
    fault: impl Fn(&Graded, &Line) -> Line,
) -> Answer {
    let flight = |(flight, lines): (&Graded, &Vec<Line>)| {
        lines.iter().map(|line| fault(flight, line)).collect()
    };
    Answer { kind: answer.kind, flights: flights.iter().zip(&answer.flights).map(flight).collect() }
}

/// What the book's filter makes of flights on which it is told something else. Flights with a gap are those of
/// the whole filter.
pub fn run_with(
    whole: &Answer,
    flights: &[Graded],
    fault: impl Fn(&mut FlightRecording) -> OdometryOptions,
) -> Answer {
    let flight = |(flight, lines): (&Graded, &Vec<Line>)| {
        if !has_one_world(flight) {
            return lines.clone();
        }
        let mut recording = flight.flown().unwrap();
        let options = OdometryOptions { patience: f64::INFINITY, ..fault(&mut recording) };
        all_lines(&recording, options)
    };
    Answer { kind: whole.kind, flights: flights.iter().zip(&whole.flights).map(flight).collect() }
}

/// Everything that an odometry says, also before it was lost.
fn all_lines(recording: &FlightRecording, options: OdometryOptions) -> Vec<Line> {
    let mut odometry = Odometry::new(options);
    let mut lines: Vec<Line> = Vec::new();
    let told = |odometry: &Odometry, _| {
        let last = lines.last().map(|line| line.nanoseconds);
        let newest = odometry.newest().filter(|newest| Some(newest.nanoseconds) > last);
        lines.extend(newest.as_ref().map(line));
    };
    odometry.fly(&recording.readings, &recording.pictures, told).unwrap();
    lines
}

/// What the smoother says of each pose two seconds later, with the covariances that it had at once.
pub fn delayed(causal: &Answer, flights: &[Graded]) -> Answer {
    let flight = |(flight, lines): (&Graded, &Vec<Line>)| {
        if !has_one_world(flight) {
            return lines.clone();
        }
        let recording = flight.flown().unwrap();
        let sensors = Sensors::of_flight(&recording.flight);
        let mut odometry = Odometry::new(OdometryOptions::new(sensors, Estimator::Smoother));
        let mut late: Vec<Line> = Vec::new();
        let told = |odometry: &Odometry, _| {
            let ago = odometry.ago(2.0);
            let known = ago.and_then(|(time, state)| {
                let line = lines.iter().find(|line| line.nanoseconds == time)?;
                Some(Line { state, ..*line })
            });
            let last = late.last().map(|line| line.nanoseconds);
            late.extend(known.filter(|line| Some(line.nanoseconds) > last));
        };
        odometry.fly(&recording.readings, &recording.pictures, told).unwrap();
        late
    };
    Answer { kind: causal.kind, flights: flights.iter().zip(&causal.flights).map(flight).collect() }
}

/// The options of the filter that are true of a recording.
pub fn filter(recording: &FlightRecording) -> OdometryOptions {
    OdometryOptions::new(Sensors::of_flight(&recording.flight), Estimator::Msckf)
}

/// Pictures after the stand correct nothing.
pub fn blind(recording: &mut FlightRecording) -> OdometryOptions {
    let stood = recording.pictures[0].nanoseconds + (1e9 * STAND) as i64;
    let moving = recording.pictures.iter_mut().filter(|picture| picture.nanoseconds > stood);
    moving.for_each(|picture| picture.features.clear());
    filter(recording)
}

/// White noise whose density was taken for that of a reading.
pub fn per_sample(recording: &mut FlightRecording) -> OdometryOptions {
    let root = recording.flight.imu_rate.sqrt();
    recording.flight.noise.gyro /= root;
    recording.flight.noise.accelerometer /= root;
    filter(recording)
}

/// Free fall upwards.
pub fn falls_up(recording: &mut FlightRecording) -> OdometryOptions {
    let mut options = filter(recording);
    options.msckf.gravity = -options.msckf.gravity;
    options
}

/// The camera's mounting the wrong way round.
pub fn inverted(recording: &mut FlightRecording) -> OdometryOptions {
    let rig = &mut recording.flight.rig;
    rig.body_from_camera = rig.body_from_camera.inverse();
    filter(recording)
}

/// The camera's clock taken for the sensor's.
pub fn simultaneous(recording: &mut FlightRecording) -> OdometryOptions {
    recording.flight.rig.time_offset = 0.0;
    filter(recording)
}

/// Every track believed.
pub fn credulous(recording: &mut FlightRecording) -> OdometryOptions {
    let mut options = filter(recording);
    options.msckf.gate = 1.0;
    options
}

/// The covariance after a measurement of yaw that nobody made, twice as good as what was known.
pub fn yaw_seen(_: &Graded, line: &Line) -> Line {
    let up = line.state.world_from_body.inverse() * Vector3::z();
    let yaw = Vector6::new(up.x, up.y, up.z, 0.0, 0.0, 0.0);
    let gain = line.covariance * yaw;
    let variance = yaw.dot(&gain);
    let spread = line.covariance - gain * gain.transpose() / (variance * (1.0 + 1.0 / 15.0));
    Line { covariance: 0.5 * (spread + spread.transpose()), ..*line }
}

/// The lower triangle row by row where the upper one is asked for.
pub fn by_columns(_: &Graded, line: &Line) -> Line {
    let lower = (0..6).flat_map(|row| (0..=row).map(move |column| line.covariance[(row, column)]));
    let written: Vec<f64> = lower.collect();
    Line { covariance: grader::fly::answer::of_triangle(&written), ..*line }
}

/// Covariances with a factor.
pub fn scaled(factor: f64) -> impl Fn(&Graded, &Line) -> Line {
    move |_, line| Line { covariance: factor * line.covariance, ..*line }
}

/// The camera's pose in the place of the body's.
pub fn of_camera(flight: &Graded, line: &Line) -> Line {
    let pose = flight.rig().world_from_camera(&line.state);
    let mut line = *line;
    line.state.world_from_body = pose.rotation.to_rotation_matrix();
    line.state.position = pose.translation.vector;
    line
}

/// The body's pose made of the camera's by its mounting the wrong way round.
pub fn mounted_twice(flight: &Graded, line: &Line) -> Line {
    let pose = flight.rig().world_from_camera(&line.state) * flight.rig().body_from_camera;
    let mut line = *line;
    line.state.world_from_body = pose.rotation.to_rotation_matrix();
    line.state.position = pose.translation.vector;
    line
}

/// The real part of a quaternion first.
pub fn w_first(_: &Graded, line: &Line) -> Line {
    let q = line.state.pose().rotation;
    let written = nalgebra::Quaternion::new(q.k, q.w, q.i, q.j);
    let mut line = *line;
    line.state.world_from_body =
        nalgebra::UnitQuaternion::new_normalize(written).to_rotation_matrix();
    line
}

/// The name that an answer gets, or none.
pub fn named(judged: &Judged) -> Option<&'static str> {
    judged.symptom.map(|symptom| symptom.name)
}

/// What an answer earns of a hundred.
pub fn earned(judged: &Judged) -> f64 {
    let checks = judged.checks();
    let passed = checks.iter().filter(|check| check.sentence.is_empty());
    passed.map(|check| check.weight).sum()
}

/// Writes an answer as a student would.
pub fn write(answer: &Answer, root: &Path) {
    std::fs::create_dir_all(root).unwrap();
    let kind = if answer.kind == Kind::Causal { "causal" } else { "smoothed" };
    std::fs::write(root.join(DECLARATION), format!("kind = \"{kind}\"\n")).unwrap();
    for (number, lines) in answer.flights.iter().enumerate() {
        let to = root.join(folder(number));
        std::fs::create_dir_all(&to).unwrap();
        let tum = written::tum(lines.iter().map(|line| (line.nanoseconds, &line.state)));
        let spread = written::pose_covariances(
            lines.iter().map(|line| (line.nanoseconds, &line.covariance)),
        );
        std::fs::write(to.join(TRAJECTORY), tum).unwrap();
        std::fs::write(to.join(COVARIANCE), spread).unwrap();
    }
}

/// An answer that whoever holds the truth can make without an estimator.
pub fn of_truth(flights: &[Graded]) -> Answer {
    let after_gap = |flight: &Graded| {
        let mut lines = whole_truth(flight);
        lines.retain(|line| flight.seconds(line.nanoseconds) >= flight.from().ceil());
        lines
    };
    Answer { kind: Kind::Causal, flights: flights.iter().map(after_gap).collect() }
}

/// The truth of a flight, ten times a second.
pub fn whole_truth(flight: &Graded) -> Vec<Line> {
    let line = |tenth: i64| {
        let nanoseconds = flight.begins + 100_000_000 * tenth;
        let covariance = 1e-4 * Matrix6::identity();
        Line { nanoseconds, state: flight.truth(nanoseconds), covariance }
    };
    (0..=200).map(line).collect()
}

/// The same estimate with a line every hundredth of a second: between its lines it moves as the truth does.
pub fn at_readings(answer: &Answer, flights: &[Graded]) -> Answer {
    let carried = |flight: &Graded, line: &Line, later: i64| {
        let nanoseconds = line.nanoseconds + 10_000_000 * later;
        let [here, there] = [line.nanoseconds, nanoseconds].map(|time| flight.truth(time));
        let turn = line.state.world_from_body * here.world_from_body.inverse();
        let state = NavState {
            world_from_body: turn * there.world_from_body,
            velocity: turn * there.velocity,
            position: line.state.position + turn * (there.position - here.position),
        };
        Line { nanoseconds, state, ..*line }
    };
    let dense = |(flight, lines): (&Graded, &Vec<Line>)| {
        let last = lines.last().copied();
        let before = &lines[..lines.len().saturating_sub(1)];
        let each = before.iter().flat_map(|line| (0..10).map(move |at| carried(flight, line, at)));
        each.chain(last).collect()
    };
    Answer { kind: answer.kind, flights: flights.iter().zip(&answer.flights).map(dense).collect() }
}
