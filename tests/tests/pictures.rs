//! Pictures of answers: right ones agree with what is expected, and wrong ones are seen.

use std::sync::Arc;

use exercise_pictures::widgets::{Player, Session, Widget};
use exercise_pictures::{Asked, Beside, LeftPerturbation, ResidualJacobian};
use exercise_spec::answer::Native;
use exercise_spec::{Exercise, exercise, left_perturbation, residual_jacobian};
use solutions::misconceptions::Wrong;
use solutions::{Answers, answers};

fn of(slug: &str) -> (&'static Exercise, Answers) {
    let found = answers().into_iter().find(|answers| answers.slug == slug);
    (exercise(slug).expect("declared"), found.expect("answered"))
}

fn reading<W: Widget>(session: &mut Session<W>, label: &str) -> f64 {
    let readings = session.readings();
    let found = readings.iter().find(|(known, _)| *known == label);
    found.unwrap_or_else(|| panic!("there is no reading {label}")).1
}

const YOURS: &str = "Steps until it is there, yours";
const BOOKS: &str = "The same, the book's";

#[test]
fn every_check_shows_numbers_and_the_reference_answers_agree_with_them() {
    let mut mute = Vec::new();
    for Answers { slug, reference, .. } in answers() {
        for check in (exercise(slug).expect("declared").checks)() {
            let (cases, failure) = check.watch(&*reference);
            let name = format!("{slug}::{}", check.name);
            if cases.is_empty() {
                mute.push(name.clone());
            }
            assert_eq!(failure, None, "{name}");
            for case in cases {
                assert_eq!(case.failure, None, "{name}: {}", case.what);
            }
        }
    }
    assert_eq!(mute, [""; 0], "these compare nothing");
}

#[test]
fn every_wrong_answer_is_seen_to_differ() {
    for Answers { slug, wrong, .. } in answers() {
        let exercise = exercise(slug).expect("declared");
        for Wrong { misconception, answer } in wrong {
            let differs = (exercise.checks)().iter().any(|check| {
                let (cases, failure) = check.watch(&*answer);
                failure.is_some() || cases.iter().any(|case| case.failure.is_some())
            });
            assert!(differs, "{slug}: {}", misconception.name);
        }
    }
}

#[test]
fn a_wrong_answer_is_named_beside_its_numbers() {
    let (exercise, answers) = of("noise_growth");
    for Wrong { misconception, answer } in answers.wrong {
        let mut session = Session::of(Beside::of(exercise, answer.into()));
        let said = (0..(exercise.checks)().len()).any(|check| {
            session.set("check", check as f64);
            (1..=40).any(|case| {
                session.set("case", f64::from(case));
                session.show();
                session.said().contains(misconception.sentence)
            })
        });
        assert!(said, "{}", misconception.name);
    }
}

#[test]
fn numbers_that_are_none_and_matrices_of_another_size_are_drawn_with_a_sentence() {
    for Answers { slug, spoiled, .. } in answers() {
        let exercise = exercise(slug).expect("declared");
        for answer in spoiled {
            let mut session = Session::of(Beside::of(exercise, answer.into()));
            for check in 0..(exercise.checks)().len() {
                session.set("check", check as f64);
                session.show();
                assert!(!session.said().is_empty(), "{slug}");
            }
        }
    }
}

#[test]
fn the_right_derivative_arrives_as_fast_as_the_books() {
    let (exercise, answers) = of("residual_jacobian");
    let mut session = Session::of(ResidualJacobian::of(exercise, answers.reference.into()));
    for problem in 1..=20 {
        for steps in [0.0, 1.0] {
            for residual in [0.0, 1.0] {
                let state =
                    [("problem", f64::from(problem)), ("steps", steps), ("residual", residual)];
                for (name, value) in state {
                    assert!(session.set(name, value));
                }
                let books = reading(&mut session, BOOKS);
                assert!(books >= 1.0, "problem {problem}: the book's does not arrive");
                assert_eq!(reading(&mut session, YOURS), books, "{state:?}");
            }
        }
    }
    let (exercise, answers) = of("left_perturbation");
    let mut session = Session::of(LeftPerturbation::of(exercise, answers.reference.into()));
    for problem in 1..=20 {
        for derivative in 0..4 {
            session.set("problem", f64::from(problem));
            session.set("derivative", f64::from(derivative));
            let books = reading(&mut session, BOOKS);
            assert!(books >= 1.0, "problem {problem}: the book's does not arrive");
            let hers = reading(&mut session, YOURS);
            // Differences are not quite the slope.
            assert!(
                (hers - books).abs() <= f64::from(derivative / 2),
                "{derivative}: {hers} {books}"
            );
        }
    }
}

#[test]
fn a_derivative_with_the_wrong_sign_diverges() {
    fn diverges<W: Widget>(mut session: Session<W>) {
        session.set("count", 8.0);
        assert!(reading(&mut session, YOURS).is_nan(), "it arrives");
        assert!(session.said().contains("has not fallen: look at signs"), "{}", session.said());
    }
    let inertial = residual_jacobian::Functions {
        by_first: |deltas, first, second, gravity| {
            -solutions::residual_jacobian::by_first(deltas, first, second, gravity)
        },
        ..solutions::misconceptions::residual_jacobian::REFERENCE
    };
    let answer: Asked = Arc::new(Native(inertial));
    diverges(Session::of(ResidualJacobian::of(&residual_jacobian::EXERCISE, answer)));
    let visual = left_perturbation::Functions {
        left_pose_jacobian: |camera, pose, point| {
            -solutions::left_perturbation::left_pose_jacobian(camera, pose, point)
        },
        ..solutions::misconceptions::left_perturbation::REFERENCE
    };
    let answer: Asked = Arc::new(Native(visual));
    diverges(Session::of(LeftPerturbation::of(&left_perturbation::EXERCISE, answer)));
}

#[test]
fn no_wrong_derivative_passes_for_the_books() {
    let (exercise, answers) = of("residual_jacobian");
    let of_derivative = [
        "untransposed_block",
        "world_steps",
        "inverse_jacobian_forgotten",
        "left_inverse_jacobian",
        "skew_sign",
        "measured_for_stated",
        "reversed",
    ];
    for Wrong { misconception, answer } in answers.wrong {
        if !of_derivative.contains(&misconception.name) {
            continue;
        }
        let mut session = Session::of(ResidualJacobian::of(exercise, answer.into()));
        session.set("turned", 60.0);
        session.set("count", 30.0);
        session.show();
        assert!(session.said().contains("differs from the book's"), "{}", misconception.name);
        // The inverse of a Jacobian of a rotation leaves the residual's own direction as it is, and with that the
        // gradient: such a step differs and arrives all the same.
        if misconception.name.contains("inverse_jacobian") {
            continue;
        }
        let slower = (1..=20).any(|problem| {
            session.set("problem", f64::from(problem));
            let (hers, books) = (reading(&mut session, YOURS), reading(&mut session, BOOKS));
            hers.is_nan() || hers > books
        });
        assert!(slower, "{}", misconception.name);
    }
}
