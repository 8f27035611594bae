//! The graded flight: whole estimators get full marks, faulty ones a name, and hostile files a sentence.

mod flown;

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use flown::*;
use grader::batch::{Finished, Order};
use grader::fly::answer::{
    APART, Answer, Kind, LARGEST, LEAVES_OUT, LONGEST_TEXT, NoAnswer, folder,
};
use grader::fly::export::{export_drawn, sung};
use grader::fly::flights::{FLIGHTS, Graded};
use grader::fly::handed::{Handed, has_flights};
use grader::fly::judge::{CHECKS, Course, NEAR, NEAR_AFTER_GAP, SCALE};
use grader::fly::key::{Exported, Key};
use grader::fly::run::run_quietly;
use grader::fly::series::TIMES;
use grader::fly::symptoms::OUTSIDE;
use grader::marks::COLUMNS;
use grader::report::Detail;
use grader::roster::Roster;
use grader::submission::find;
use nalgebra::{UnitQuaternion, Vector3};
use tempfile::tempdir;
use vislam::odometry::Estimator;

/// Keys of flights on which names have to hold.
const KEYS: [u128; 4] = [1, 2, 3, 4];

/// Judges an answer, tells what came out, and returns the name that it got.
fn name_of(course: &Course, key: u128, answer: &Answer, fault: &str) -> Option<&'static str> {
    let judged = course.judged(answer).unwrap();
    let name = named(&judged);
    println!("{key} {fault}: {name:?}, {} points, {:.3?}", earned(&judged), judged.measured);
    assert!(earned(&judged) < 100.0, "{fault} gets everything");
    name
}

#[test]
fn the_filter_gets_full_marks_and_what_it_writes_wrongly_has_a_name() {
    let course = course(KEYS[0]);
    let flights = course.flights();
    let answer = reference(flights, Estimator::Msckf);
    let judged = course.judged(&answer).unwrap();
    println!("{}", judged.table());
    assert_eq!((earned(&judged), named(&judged)), (100.0, None));
    let dense = course.judged(&at_readings(&answer, flights)).unwrap();
    assert_eq!((earned(&dense), named(&dense)), (100.0, None));
    let rougher = dense.measured.roughness / judged.measured.roughness;
    assert!((0.7..1.4).contains(&rougher), "an answer with more lines is {rougher} times as rough");
    written_wrongly(&course, KEYS[0], &answer);
}

/// That faults of what is written have their names.
fn written_wrongly(course: &Course, key: u128, answer: &Answer) {
    let flights = course.flights();
    let name = |fault: &str, answer: Answer| name_of(course, key, &answer, fault);
    for (expected, answer) in [
        ("yaw_information_gained", written_by(answer, flights, yaw_seen)),
        ("transposed_covariance", written_by(answer, flights, by_columns)),
        ("covariance_scaled_by_guess", written_by(answer, flights, scaled(10.0))),
        ("covariance_scaled_by_guess", written_by(answer, flights, scaled(0.1))),
        ("pose_of_the_camera", written_by(answer, flights, of_camera)),
        ("extrinsics_inverted", written_by(answer, flights, mounted_twice)),
        ("quaternion_w_first", written_by(answer, flights, w_first)),
    ] {
        assert_eq!(name(expected, answer), Some(expected), "key {key}");
    }
}

#[test]
#[ignore = "runs estimators for minutes"]
fn filter_and_smoother_get_full_marks_on_any_flights() {
    for key in KEYS {
        let course = course(key);
        for estimator in [Estimator::Msckf, Estimator::Smoother] {
            let answer = reference(course.flights(), estimator);
            let judged = course.judged(&answer).unwrap();
            println!("{key} {estimator}\n{}", judged.table());
            assert_eq!((earned(&judged), named(&judged)), (100.0, None), "{key} {estimator}");
            assert!(!judged.smoothed, "{key} {estimator}");
            if estimator == Estimator::Smoother {
                let late = course.judged(&delayed(&answer, course.flights())).unwrap();
                println!("{key} delayed: {:.3?}", late.measured);
                assert!(late.smoothed, "{key}: a delayed estimate is taken for a causal one");
                written_wrongly(&course, key, &answer);
            }
        }
    }
}

#[test]
#[ignore = "runs estimators for minutes"]
fn estimators_with_a_fault_are_named_and_not_as_another() {
    for key in KEYS {
        let course = course(key);
        let flights = course.flights();
        let whole = reference(flights, Estimator::Msckf);
        let name = |fault: &str, answer: Answer| name_of(&course, key, &answer, fault);
        for (expected, answer) in [
            ("clones_uncorrelated", run_with(&whole, flights, blind)),
            ("density_taken_for_per_sample_noise", run_with(&whole, flights, per_sample)),
            ("gravitys_sign", run_with(&whole, flights, falls_up)),
            ("extrinsics_inverted", run_with(&whole, flights, inverted)),
            ("time_offset_ignored", run_with(&whole, flights, simultaneous)),
            ("outliers_believed", run_with(&whole, flights, credulous)),
        ] {
            assert_eq!(name(expected, answer), Some(expected), "key {key}");
        }
        written_wrongly(&course, key, &whole);
    }
}

/// Writes the flights of a key, whose file comes back.
fn export_of(dir: &Path, roster: &Roster, key: &Key) -> Result<PathBuf, String> {
    export_drawn(dir, roster, || Ok(key.clone()), |_| Ok(()))
}

/// An order about submissions in a folder.
fn order(at: &Path, out: &str) -> Order {
    Order {
        submissions: vec![at.join("submissions")],
        single: false,
        exercises: Vec::new(),
        seed: None,
        detail: Detail::Full,
        out: at.join(out),
        roster: None,
        points: None,
        marks: None,
        jobs: None,
        memory: None,
    }
}

/// Grades by the key in a folder.
fn run_in(at: &Path, order: &Order) -> Finished {
    run_quietly(order, &at.join("flights-key.toml")).unwrap()
}

#[test]
#[ignore = "flies a hundred flights"]
fn a_class_of_ten_is_graded() {
    let at = tempdir().unwrap();
    let names: Vec<String> = (0..10).map(|number| format!("student-{number}")).collect();
    let roster = Roster::of_folders(&names);
    let key = Key::of(77);
    export_of(&at.path().join("flights"), &roster, &key).unwrap();
    for name in &names {
        let answer = reference(&Graded::all(&key, name), Estimator::Msckf);
        write(&answer, &at.path().join("submissions").join(name));
    }
    let begun = Instant::now();
    let finished = run_in(at.path(), &order(at.path(), "grades"));
    println!("{} flights in {:.1} s", 10 * FLIGHTS, begun.elapsed().as_secs_f64());
    assert_eq!((finished.graded, finished.ungraded), (10, 0));
    let book = fs::read_to_string(at.path().join("grades/gradebook.csv")).unwrap();
    assert_eq!(book.matches(",100,100,100,graded").count(), 10, "{book}");
}

#[test]
fn an_export_reads_back_and_its_key_stays_outside() {
    let at = tempdir().unwrap();
    let dir = at.path().join("flights");
    let roster = Roster::parse("folder,name\nada,Ada\n").unwrap();
    let key = Key::of(5);
    let beside = export_of(&dir, &roster, &key).unwrap();
    assert_eq!(beside, at.path().join("flights-key.toml"));
    assert!(fs::read_dir(&dir).unwrap().all(|entry| entry.unwrap().file_name() == "ada"));
    let exported = Exported::read(&beside).unwrap();
    assert_eq!((exported.key().unwrap(), exported.folders), (key.clone(), vec!["ada".to_owned()]));
    for (number, flight) in Graded::all(&key, "ada").iter().enumerate() {
        let of = |name: &str| fs::read_to_string(dir.join("ada").join(folder(number)).join(name));
        let recording = flight.flown().unwrap();
        let imu = vislam::datasets::euroc::read_imu(&of("imu.csv").unwrap()).unwrap();
        let tracks = vislam::datasets::tracks::read_tracks(&of("tracks.csv").unwrap()).unwrap();
        let text = of("calibration.toml").unwrap();
        let sensors = vislam::datasets::calibration::read_calibration(&text).unwrap();
        assert_eq!((imu, tracks), (recording.readings, recording.pictures));
        assert_eq!(
            (sensors.noise, sensors.camera),
            (recording.flight.noise, recording.flight.camera)
        );
        assert_eq!(sensors.rig.time_offset, flight.rig().time_offset);
    }
    let again = export_of(&dir, &roster, &key).unwrap_err();
    assert!(again.contains("is there already"), "{again}");
    let unfit = Roster::parse("folder,name\n../ada,Ada\n").unwrap();
    let error = export_of(&at.path().join("others"), &unfit, &key).unwrap_err();
    assert!(error.contains("cannot be the name of a folder"), "{error}");
}

#[test]
fn flights_of_two_students_and_of_two_keys_differ() {
    let first = |key: u128, folder: &str| {
        let flight = Graded::of(&Key::of(key), folder, 0);
        (flight.begins, flight.flown().unwrap().readings[3_000].sample)
    };
    let (one, other, later) = (first(1, "ada"), first(1, "bob"), first(2, "ada"));
    assert!(one != other && one != later && one == first(1, "ada"));
    assert_ne!(one.0, other.0);
}

/// What is said of an answer in which a file was replaced.
fn refused(change: impl Fn(&Path)) -> Vec<String> {
    let at = tempdir().unwrap();
    let flights = Graded::all(&Key::of(9), FOLDER);
    write(&of_truth(&flights), at.path());
    assert!(Answer::read(at.path(), &flights).is_ok());
    change(at.path());
    match Answer::read(at.path(), &flights) {
        Err(NoAnswer::Refused(sentences)) => sentences,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_hostile_file_gets_a_sentence() {
    let trajectory = "flight-2/trajectory.txt";
    let covariance = "flight-2/covariance.txt";
    let edited = |name: &'static str, edit: &dyn Fn(String) -> String| {
        refused(|at| {
            let text = fs::read_to_string(at.join(name)).unwrap();
            fs::write(at.join(name), edit(text)).unwrap();
        })
    };
    let without = |text: String, lines: std::ops::Range<usize>| {
        let kept = text.lines().enumerate().filter(|(line, _)| !lines.contains(line));
        kept.map(|(_, line)| format!("{line}\n")).collect::<String>()
    };
    let word = |text: String, line: usize, with: &str| {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let (time, rest) = lines[line].split_once(' ').unwrap();
        let (_, rest) = rest.split_once(' ').unwrap();
        lines[line] = format!("{time} {with} {rest}");
        lines.join("\n")
    };
    for (said, sentences) in [
        ("line 8: `NaN` is not a finite number", edited(trajectory, &|text| word(text, 7, "NaN"))),
        ("`inf` is not a finite number", edited(covariance, &|text| word(text, 7, "inf"))),
        ("farther off than anything", edited(trajectory, &|text| word(text, 7, "1e9"))),
        ("there is nothing between", edited(trajectory, &|text| without(text, 50..70))),
        ("must begin by", edited(trajectory, &|text| without(text, 1..90))),
        ("must begin by", edited(trajectory, &|text| without(text, 190..300))),
        ("give one covariance for each pose", edited(covariance, &|text| without(text, 60..61))),
        ("bytes", edited(trajectory, &|text| text.clone() + &text.repeat(400))),
        ("more than 6000 lines", edited(trajectory, &|text| text.repeat(40))),
        ("is not later", edited(trajectory, &|text| text.clone() + &text)),
        ("more than 1000 bytes", edited(trajectory, &|text| text + &"7".repeat(1_500))),
        ("no line with numbers", edited(trajectory, &|_| String::new())),
        ("8 numbers and not 22", edited(covariance, &|_| "1 2 3 4 5 6 7 8".to_owned())),
        ("upper triangle alone", edited(covariance, &|_| "1 ".repeat(37))),
        ("is no text", refused(|at| fs::write(at.join(trajectory), [0xff, 0, 1]).unwrap())),
        ("there is no file", refused(|at| fs::remove_file(at.join(covariance)).unwrap())),
        ("there is no folder", refused(|at| fs::remove_dir_all(at.join("flight-3")).unwrap())),
        ("kind", refused(|at| fs::write(at.join("answer.toml"), "kind = \"both\"").unwrap())),
    ] {
        assert!(sentences.len() == 1 && sentences[0].contains(said), "{said}: {sentences:?}");
    }
}

#[test]
fn a_hole_is_seen_wherever_it_begins() {
    let at = tempdir().unwrap();
    let flights = Graded::all(&Key::of(9), FOLDER);
    for (flight, hole) in [(1, [2.4, 9.0]), (8, [4.9, 19.7])] {
        let mut answer = of_truth(&flights);
        answer.flights[flight] = whole_truth(&flights[flight]);
        write(&answer, at.path());
        assert!(Answer::read(at.path(), &flights).is_ok());
        answer.flights[flight].retain(|line| {
            let seconds = flights[flight].seconds(line.nanoseconds);
            seconds <= hole[0] || seconds >= hole[1]
        });
        write(&answer, at.path());
        let read = Answer::read(at.path(), &flights);
        let Err(NoAnswer::Refused(sentences)) = read else { panic!("{hole:?}: {read:?}") };
        assert!(sentences.len() == 1 && sentences[0].contains("must begin by"), "{sentences:?}");
    }
}

#[test]
fn a_million_lines_are_not_read_and_a_quaternion_has_norm_one() {
    let sentences = refused(|at| {
        fs::write(at.join("flight-1/trajectory.txt"), "1 2 3 4 5 6 7 8\n".repeat(1_000_000))
            .unwrap();
        let path = at.join("flight-2/trajectory.txt");
        let text = fs::read_to_string(&path).unwrap();
        let doubled = text.lines().map(|line| match line.rsplit_once(' ') {
            Some((rest, _)) if !line.starts_with('#') => format!("{rest} 2.0\n"),
            _ => format!("{line}\n"),
        });
        fs::write(path, doubled.collect::<String>()).unwrap();
    });
    assert!(sentences[0].contains(&format!("more than {LARGEST} bytes")), "{sentences:?}");
    assert!(sentences[1].contains("a rotation has norm 1"), "{sentences:?}");
}

#[test]
fn the_answer_of_another_student_is_known_by_its_times() {
    let others = Graded::all(&Key::of(9), "bob");
    let sentences = refused(|at| write(&of_truth(&others), at));
    assert_eq!(sentences.len(), FLIGHTS);
    assert!(
        sentences[0].starts_with("`flight-1/trajectory.txt`: there are times"),
        "{sentences:?}"
    );
    assert!(sentences[0].contains("that of another student"), "{sentences:?}");
}

#[cfg(unix)]
#[test]
fn links_are_not_followed() {
    use std::os::unix::fs::symlink;
    let elsewhere = tempdir().unwrap();
    let flights = Graded::all(&Key::of(9), FOLDER);
    write(&of_truth(&flights), elsewhere.path());
    let sentences = refused(|at| {
        fs::remove_dir_all(at.join("flight-1")).unwrap();
        symlink(elsewhere.path().join("flight-1"), at.join("flight-1")).unwrap();
        fs::remove_file(at.join("flight-2/trajectory.txt")).unwrap();
        let file = elsewhere.path().join("flight-2/trajectory.txt");
        symlink(file, at.join("flight-2/trajectory.txt")).unwrap();
    });
    assert!(sentences[0].contains("`flight-1` is no folder"), "{sentences:?}");
    assert!(sentences[1].contains("links are not followed"), "{sentences:?}");
}

#[test]
fn a_covariance_that_is_not_positive_definite_costs_what_it_should() {
    let course = course(9);
    let mut answer = of_truth(course.flights());
    answer.flights[1][5].covariance[(2, 2)] = -1e-4;
    let judged = course.judged(&answer).unwrap();
    assert_eq!(judged.not_definite, Some((1, 5)));
    let checks = judged.checks();
    let check = checks.iter().find(|check| check.name.contains("definite")).unwrap();
    assert!(check.sentence.starts_with("the covariance of pose 6 of flight 2"), "{check:?}");
}

/// Half turns about three axes and none have no mean, and nothing looks for it for ever.
#[test]
fn attitudes_without_a_mean_are_judged() {
    let course = course(9);
    let mut answer = of_truth(course.flights());
    let half = |axis: usize| UnitQuaternion::from_scaled_axis(PI * Vector3::ith(axis, 1.0));
    for (number, line) in answer.flights.iter_mut().flatten().enumerate() {
        if number % 4 < 3 {
            line.state.world_from_body *= half(number % 4).to_rotation_matrix();
        }
    }
    assert!(earned(&course.judged(&answer).unwrap()) < 80.0);
}

#[test]
fn hostile_submissions_harm_nobody() {
    let at = tempdir().unwrap();
    let key = Key::of(9);
    let folders = ["ada", "bob", "eve", "mallory"].map(str::to_owned).to_vec();
    Exported::new(&key, folders).write(&at.path().join("flights-key.toml")).unwrap();
    let submission = |name: &str| at.path().join("submissions").join(name);
    let flights = Graded::all(&key, "ada");
    write(&of_truth(&flights), &submission("bob"));
    write(&of_truth(&flights), &submission("stranger"));
    fs::create_dir_all(submission("eve")).unwrap();
    fs::write(submission("eve").join("text.md"), "=1+1 | <script>").unwrap();
    fs::create_dir_all(submission("mallory").join("flight-1")).unwrap();
    fs::write(submission("mallory").join("answer.toml"), "kind = \"\u{1b}[31m\"").unwrap();
    let roster = at.path().join("roster.csv");
    fs::write(&roster, "folder,name\nada,Ada\nbob,Bob\neve,Eve\nmallory,=1+1\n").unwrap();
    let order = Order { roster: Some(roster), ..order(at.path(), "grades") };
    let finished = run_in(at.path(), &order);
    assert_eq!((finished.graded, finished.ungraded), (3, 1));
    let read = |name: &str| fs::read_to_string(at.path().join("grades").join(name)).unwrap();
    let book = read("gradebook.csv");
    let row = |name: &str| book.lines().find(|line| line.starts_with(name)).unwrap_or_default();
    assert!(row("bob").contains(",0,100,0,graded,"), "{book}");
    assert!(row("eve").ends_with("no answer in it"), "{book}");
    assert!(row("ada").ends_with("nothing handed in"), "{book}");
    assert!(row("stranger").contains("could not be graded"), "{book}");
    assert!(book.contains("mallory,'=1+1,"), "{book}");
    let feedback = read("submissions/bob/feedback.md");
    assert!(feedback.contains("that of another student"), "{feedback}");
    assert!(!read("submissions/mallory/feedback.md").contains('\u{1b}'));
    for name in ["junit.xml", "results.json", "grade.json"] {
        assert!(!read(&format!("submissions/mallory/{name}")).is_empty());
    }
    // The key is in no report.
    let digits = Key::of(9);
    assert_eq!(format!("{digits:?}"), "Key(…)");
    assert!(!read("grade.json").contains("00000000000000000000000000000009"));
}

#[test]
fn a_zip_file_is_unpacked_and_its_text_is_marked_by_a_person() {
    let at = tempdir().unwrap();
    let key = Key::of(9);
    let names = ["ada", "bob", "cem"].map(str::to_owned);
    Exported::new(&key, names.to_vec()).write(&at.path().join("flights-key.toml")).unwrap();
    let submissions = at.path().join("submissions");
    let answer = at.path().join("work");
    write(&of_truth(&Graded::all(&key, "ada")), &answer);
    let text = "It integrates.\n".repeat(600) + "I do not trust it.\n";
    fs::write(answer.join("text.md"), &text).unwrap();
    fs::create_dir_all(&submissions).unwrap();
    zipped(&at.path().join("work"), &submissions.join("ada.zip"));
    write(&of_truth(&Graded::all(&key, "bob")), &submissions.join("bob/inner"));
    fs::write(submissions.join("cem.zip"), "PK\u{3}\u{4}").unwrap();
    let points = at.path().join("points.toml");
    let file = include_str!("../points.toml");
    fs::write(&points, format!("{file}\n[words]\ngraded_flight = 20\n")).unwrap();
    let order = Order { points: Some(points), ..order(at.path(), "grades") };
    let finished = run_in(at.path(), &order);
    assert_eq!((finished.graded, finished.ungraded), (2, 1), "a broken archive is no zero");
    let read = |name: &str| fs::read_to_string(at.path().join("grades").join(name)).unwrap();
    assert!(read("words.md").contains(&text), "a text of nine thousand characters is shown whole");
    assert!(
        read("unmarked.csv").contains("ada.zip,graded_flight,words,,"),
        "{}",
        read("unmarked.csv")
    );
    assert!(read("summary.md").contains("cannot be unpacked"));
    assert!(read("submissions/cem.zip/feedback.md").contains("it is no zero"));
    assert!(!at.path().join("grades/similarity.md").exists());
    let marks = at.path().join("marks.csv");
    let rows = read("unmarked.csv").replace("words,,", "words,15,well said");
    fs::write(&marks, rows).unwrap();
    let before = earned_in(&read("gradebook.csv"), "ada");
    assert!(before > 0.0, "{}", read("gradebook.csv"));
    assert_eq!(earned_in(&read("gradebook.csv"), "bob"), before);
    run_in(at.path(), &Order { marks: Some(marks.clone()), ..order.clone() });
    assert_eq!(earned_in(&read("gradebook.csv"), "ada"), before + 15.0);
    assert!(read("submissions/ada.zip/feedback.md").contains("well said"));

    // Marks may call an archive as the roster does.
    let roster = at.path().join("roster.csv");
    fs::write(&roster, "folder,name\nada,Ada\nbob,Bob\ncem,Cem\n").unwrap();
    fs::write(&marks, format!("{}\nada,graded_flight,words,12,\n", COLUMNS.join(","))).unwrap();
    let order = Order { marks: Some(marks), roster: Some(roster), ..order };
    assert!(!run_in(at.path(), &order).told.contains("these marks"));
    assert_eq!(earned_in(&read("gradebook.csv"), "ada"), before + 12.0);
}

#[test]
fn the_flights_of_one_student_are_one_submission() {
    let at = tempdir().unwrap();
    let ada = at.path().join("ada");
    for flight in 0..3 {
        fs::create_dir_all(ada.join(folder(flight))).unwrap();
    }
    let found = |path: &Path| find(&[path.to_owned()], has_flights).unwrap();
    let names = |path: &Path| found(path).into_iter().map(|it| it.name).collect::<Vec<_>>();
    assert_eq!(names(&ada), ["ada"]);
    fs::create_dir_all(at.path().join("bob").join(folder(1))).unwrap();
    assert_eq!(names(at.path()), ["ada", "bob"]);
}

#[test]
fn what_cannot_be_looked_into_is_left_to_a_person() {
    let at = tempdir().unwrap();
    let submission = |name: &str, files: &[&str]| {
        let folder = at.path().join(name);
        fs::create_dir_all(&folder).unwrap();
        files.iter().for_each(|file| fs::write(folder.join(file), "").unwrap());
        folder
    };
    let unpacked = submission("ada", &["answer.toml"]);
    zipped(&unpacked, &submission("bob", &[]).join("work.zip"));
    zipped(&at.path().join("bob"), &at.path().join("cem.zip"));
    for (path, said) in [
        (
            submission("dan", &["work.tar.gz"]),
            "`work.tar.gz` is an archive that nobody has unpacked",
        ),
        (submission("eve", &["work.7z"]), "`work.7z` is an archive that nobody has unpacked"),
        (submission("fay", &["one.zip", "two.zip"]), "there are several archives"),
        (at.path().join("cem.zip"), "`cem.zip` holds another archive"),
    ] {
        let error = Handed::find(&path).unwrap_err();
        assert!(error.starts_with(said), "{error}");
    }
    let found = |path: &Path| Handed::find(path).unwrap().folder().is_some();
    assert!(found(&unpacked) && found(&at.path().join("bob")));
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        let gil = submission("gil", &[]);
        symlink(at.path().join("bob/work.zip"), gil.join("work.zip")).unwrap();
        symlink(&unpacked, at.path().join("hal")).unwrap();
        assert!(!found(&gil) && !found(&at.path().join("hal")));
    }
}

#[test]
fn a_text_that_cannot_be_read_is_told() {
    let at = tempdir().unwrap();
    let inner = at.path().join("work");
    fs::create_dir_all(&inner).unwrap();
    fs::write(inner.join("answer.toml"), "kind = \"causal\"").unwrap();
    let handed = || Handed::find(at.path()).unwrap();
    assert_eq!((handed().text(), handed().unread()), ((None, vec![]), false));
    fs::write(at.path().join("text.md"), "It integrates.\n").unwrap();
    assert_eq!(handed().text(), (Some("It integrates.".to_owned()), vec![]));
    fs::write(at.path().join("text.md"), [0xff, 0xfe, 0]).unwrap();
    let why = vec!["`text.md` is no text; save it as UTF-8".to_owned()];
    assert_eq!((handed().text(), handed().unread()), ((None, why.clone()), true));
    assert_eq!(handed().notices(), why);
}

#[test]
fn a_text_beside_an_archive_is_read() {
    let at = tempdir().unwrap();
    let (work, ada) = (at.path().join("work"), at.path().join("ada"));
    [&work, &ada].iter().for_each(|folder| fs::create_dir_all(folder).unwrap());
    fs::write(work.join("answer.toml"), "kind = \"causal\"").unwrap();
    zipped(&work, &ada.join("flights.zip"));
    fs::write(ada.join("text.md"), "It integrates.\n").unwrap();
    let handed = || Handed::find(&ada).unwrap();
    assert!(handed().folder().is_some());
    assert_eq!((handed().text().0.as_deref(), handed().unread()), (Some("It integrates."), false));
    fs::write(work.join("text.md"), "It filters.\n").unwrap();
    zipped(&work, &ada.join("flights.zip"));
    assert_eq!((handed().text().0.as_deref(), handed().unread()), (Some("It filters."), true));
    assert_eq!(handed().notices().len(), 1);
    fs::write(ada.join("text.md"), "It filters.\n").unwrap();
    assert!(!handed().unread());
}

#[test]
fn a_text_that_stays_in_an_archive_is_told() {
    let at = tempdir().unwrap();
    let path = at.path().join("ada.zip");
    let mut zip = zip::ZipWriter::new(fs::File::create(&path).unwrap());
    zip.start_file("answer.toml", zip::write::SimpleFileOptions::default()).unwrap();
    zip.add_symlink("text.md", "/etc/passwd", zip::write::SimpleFileOptions::default()).unwrap();
    zip.finish().unwrap();
    let handed = Handed::find(&path).unwrap();
    assert!(handed.unread() && handed.notices()[0].starts_with("`text.md` was left"));
}

#[test]
fn the_folder_of_reports_claims_nobodys_flights() {
    let at = tempdir().unwrap();
    let folders = ["ada", "bob"].map(str::to_owned).to_vec();
    Exported::new(&Key::of(9), folders).write(&at.path().join("flights-key.toml")).unwrap();
    let submissions = at.path().join("submissions");
    fs::create_dir_all(submissions.join("bob")).unwrap();
    fs::create_dir_all(at.path().join("ada")).unwrap();
    fs::write(at.path().join("ada/text.md"), "It integrates.\n").unwrap();
    zipped(&at.path().join("ada"), &submissions.join("ada.zip"));
    let order = Order { out: submissions.join("ada"), ..order(at.path(), "") };
    fs::create_dir_all(&order.out).unwrap();
    let finished = run_in(at.path(), &order);
    assert_eq!((finished.graded, finished.ungraded), (2, 0));
}

#[test]
fn a_key_on_whose_flights_the_canaries_fail_is_drawn_again() {
    let drawn_after = |failing: u128| {
        let count = std::cell::Cell::new(0);
        let draw = || {
            count.set(count.get() + 1);
            Ok(Key::of(count.get()))
        };
        let fails = |key: &Key| (1..=failing).any(|number| *key == Key::of(number));
        let sing = |key: &Key| if fails(key) { Err("it fails".to_owned()) } else { Ok(()) };
        sung(draw, sing)
    };
    assert_eq!(drawn_after(0), Ok(Key::of(1)));
    assert_eq!(drawn_after(2), Ok(Key::of(3)));
    assert!(drawn_after(9).unwrap_err().starts_with("nothing is exported"));
}

#[test]
fn an_export_looks_whether_it_may_write_before_it_draws() {
    let at = tempdir().unwrap();
    let (dir, drawn) = (at.path().join("flights"), std::cell::Cell::new(0));
    let export = |roster: &str| {
        let draw = || {
            drawn.set(drawn.get() + 1);
            Ok(Key::of(drawn.get()))
        };
        let sing = |key: &Key| if *key == Key::of(1) { Err("it fails".to_owned()) } else { Ok(()) };
        export_drawn(&dir, &Roster::parse(roster).unwrap(), draw, sing)
    };
    let refused = |roster: &str, said: &str| {
        let error = export(roster).unwrap_err();
        assert!(error.contains(said) && drawn.get() == 0, "{error}");
    };
    refused("folder,name\n", "nobody to fly for");
    refused("folder,name\n../ada,Ada\n", "cannot be the name of a folder");
    let key = at.path().join("flights-key.toml");
    for there in [&dir, &key] {
        fs::create_dir(there).unwrap();
        refused("folder,name\nada,Ada\n", "is there already");
        fs::remove_dir(there).unwrap();
    }
    assert_eq!(export("folder,name\nada,Ada\n"), Ok(key.clone()));
    let exported = Exported::read(&key).unwrap();
    assert_eq!(exported.key(), Ok(Key::of(2)), "the one on whose flights the canaries sing");
}

#[test]
fn the_page_says_by_which_numbers_a_flight_is_judged() {
    let page = fs::read_to_string(grader::repository().join("src/graded_flight.md")).unwrap();
    let words = page.split_whitespace().collect::<Vec<_>>().join(" ");
    for (number, expected, phrase) in [
        (FLIGHTS as f64, 10.0, "ten flights"),
        (SCALE, 0.04, "within four per cent"),
        (NEAR, 2.0, "at most twice the error of the plain filter"),
        (NEAR_AFTER_GAP, 6.0, "after a gap at most six times its mean error"),
        (TIMES[0], 10.0, "ten, fifteen and twenty seconds after the beginning"),
        (TIMES[1], 15.0, "ten, fifteen and twenty seconds after the beginning"),
        (TIMES[2], 20.0, "ten, fifteen and twenty seconds after the beginning"),
        (OUTSIDE, 1e-3, "once in a thousand times"),
        (LEAVES_OUT[0], 6.0, "six seconds"),
        (APART, 0.25, "a quarter of a second"),
        (LONGEST_TEXT as f64, 10_000.0, "up to ten thousand characters"),
    ] {
        assert_eq!(number, expected, "the page says: {phrase}");
        assert!(words.contains(phrase), "the page does not say: {phrase}");
    }
    let table = page.lines().skip_while(|line| !line.starts_with("| What is asked | Points |"));
    let rows = table.skip(2).take_while(|line| line.starts_with('|'));
    let points =
        rows.map(|row| row.trim_end_matches([' ', '|']).rsplit('|').next().unwrap().trim());
    let points: Vec<f64> = points.map(|points| points.parse().unwrap()).collect();
    assert_eq!(points, CHECKS.map(|(_, _, points)| points));
}

/// The sum of points of a row.
fn earned_in(book: &str, name: &str) -> f64 {
    let row = book.lines().find(|line| line.starts_with(name)).expect("a row");
    row.split(',').nth(2).and_then(|sum| sum.parse().ok()).expect("points")
}

/// Packs a folder.
fn zipped(folder: &Path, to: &Path) {
    let mut zip = zip::ZipWriter::new(fs::File::create(to).unwrap());
    let mut open = vec![folder.to_owned()];
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()));
            continue;
        }
        let name = path.strip_prefix(folder.parent().unwrap()).unwrap().to_string_lossy();
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        std::io::copy(&mut fs::File::open(&path).unwrap(), &mut zip).unwrap();
    }
    zip.finish().unwrap();
}

/// Runs a program on all flights of a folder, and grades what it wrote.
fn earned_by(program: &str, arguments: &[&Path]) -> Option<f64> {
    let at = tempdir().unwrap();
    let key = Key::of(11);
    let roster = Roster::of_folders(&[FOLDER.to_owned()]);
    export_of(&at.path().join("flights"), &roster, &key).unwrap();
    for number in 0..FLIGHTS {
        let [from, to] = ["flights", "submissions"]
            .map(|top| at.path().join(top).join(FOLDER).join(folder(number)));
        let run = std::process::Command::new(program).args(arguments).arg(from).arg(to).output();
        let run = run.ok()?;
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    }
    let declaration = at.path().join("submissions").join(FOLDER).join("answer.toml");
    fs::write(declaration, "kind = \"causal\"\n").unwrap();
    let course = course(11);
    let answer = Answer::read(&at.path().join("submissions").join(FOLDER), course.flights());
    let judged = course.judged(&answer.expect("an example writes what is read")).unwrap();
    Some(earned(&judged))
}

/// What the examples earn: whole files and covariances, and little else.
fn is_an_example(earned: f64) {
    assert!((20.0..60.0).contains(&earned), "an example earns {earned}");
}

#[test]
fn the_example_in_python_writes_an_answer() {
    let script = grader::repository().join("code/examples/graded_flight.py");
    match earned_by("python3", &[&script]) {
        Some(earned) => is_an_example(earned),
        None => eprintln!("skipped: there is no python3"),
    }
}

#[test]
fn the_example_in_cpp_writes_an_answer() {
    let source = grader::repository().join("code/examples/graded_flight.cpp");
    let at = tempdir().unwrap();
    let program = at.path().join("graded_flight");
    let compiled = std::process::Command::new("c++")
        .args(["-std=c++20", "-Wall", "-Wextra", "-Werror", "-o"])
        .args([&program, &source])
        .output();
    let Ok(compiled) = compiled else {
        eprintln!("skipped: there is no C++ compiler");
        return;
    };
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    is_an_example(earned_by(program.to_str().unwrap(), &[]).unwrap());
}

#[test]
fn a_declaration_of_a_smoothed_answer_is_taken_at_its_word() {
    let course = course(9);
    let answer = Answer { kind: Kind::Smoothed, ..of_truth(course.flights()) };
    assert!(!course.judged(&answer).unwrap().smoothed);
    let answer = Answer { kind: Kind::Causal, ..answer };
    assert!(course.judged(&answer).unwrap().smoothed);
}
