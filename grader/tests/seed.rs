//! The secret of hidden instances, and what may be told of them.

use book_tests::hidden_checks;
use exercise_spec::check::compare;
use exercise_spec::{EXERCISES, answer::Transport};
use grader::seed::Seed;
use nalgebra::DMatrix;
use solutions::answers;

#[test]
fn a_seed_is_written_with_all_of_its_bits_and_read_back() {
    let seeds: Vec<Seed> = (0..50).map(|_| Seed::draw().expect("a seed")).collect();
    for (number, seed) in seeds.iter().enumerate() {
        assert_eq!(Seed::parse(&seed.text()), Ok(*seed));
        assert!(!seeds[..number].contains(seed), "one was drawn twice");
        assert!(!seed.text().contains(&seed.mark()), "the mark is a part of the seed");
        assert!(!format!("{seed:?}").contains(&seed.text()));
    }
    let or = seeds.iter().fold(0, |bits, seed| bits | seed.number());
    assert_eq!(or, u128::MAX, "a bit is never set");
}

/// What a right answer is asked.
struct Listening(Box<dyn Transport>, std::sync::Mutex<Vec<u8>>);

impl Transport for Listening {
    fn call(&self, function: usize, input: &[u8]) -> Result<Vec<u8>, exercise_spec::answer::Fault> {
        self.1.lock().expect("held by nobody").extend_from_slice(input);
        self.0.call(function, input)
    }
}

fn inputs(slug: &str, seed: u128) -> Vec<u8> {
    let answer = answers().into_iter().find(|answers| answers.slug == slug).expect("an answer");
    let listening = Listening(answer.reference, std::sync::Mutex::default());
    for check in hidden_checks(slug, seed).expect("checks") {
        assert_eq!(check.run(&listening), Ok(()));
    }
    listening.1.into_inner().expect("held by nobody")
}

#[test]
fn every_half_of_a_seed_decides_the_instances_of_every_exercise() {
    for exercise in EXERCISES {
        let [one, low, high] = [5, 6, 5 | 1 << 127].map(|seed| inputs(exercise.slug, seed));
        assert!(one != low && one != high && low != high, "{}", exercise.slug);
        assert_eq!(one, inputs(exercise.slug, 5), "{}", exercise.slug);
    }
}

#[test]
fn what_an_answer_returned_is_told_by_no_quiet_sentence() {
    let expected = DMatrix::repeat(2, 3, 1.0);
    let shaped = DMatrix::repeat(843, 307, 1.0);
    let failure = compare("the Jacobian", &shaped, &expected).judge().expect_err("another shape");
    assert!(failure.sentence.contains("843×307"));
    assert!(!failure.quiet.expect("a quiet sentence").contains(|c: char| c.is_ascii_digit()));
    let quiet = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(|number| {
        let wrong = DMatrix::repeat(2, 3, number);
        compare("the Jacobian", &wrong, &expected).judge().expect_err("no number").quiet
    });
    assert!(quiet[0].is_some() && quiet[0] == quiet[1] && quiet[1] == quiet[2], "{quiet:?}");
}
