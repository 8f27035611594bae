//! What `cargo run -p exercises` does with a student's files, in a folder of its own.

use std::fs;
use std::path::Path;

use exercise_runner::edition::{self, Update};
use exercise_runner::folder::{Folder, write};
use exercise_runner::progress::{self, State, Verdicts};
use exercise_runner::watch::Watch;
use exercise_runner::{hints, picture, selection};
use exercise_spec::check::Failure;
use exercise_spec::{EXERCISES, Exercise};
use tempfile::TempDir;

const SLUG: &str = "left_perturbation";
const FIRST: &str =
    "//! A skeleton. Edition 1.\n\npub fn a() {\n    todo!()\n}\n\npub fn b() {\n    todo!()\n}\n";

/// A folder with the skeleton of one edition, and the answer as it was handed out.
fn folder() -> (TempDir, Folder) {
    let temporary = tempfile::tempdir().expect("a folder");
    let folder = Folder::at(temporary.path());
    fs::create_dir_all(folder.answers()).expect("a folder");
    hand_out(&folder, 1, FIRST);
    fs::write(folder.answer(SLUG), FIRST).expect("written");
    (temporary, folder)
}

fn hand_out(folder: &Folder, edition: u32, skeleton: &str) {
    fs::create_dir_all(folder.skeletons(edition)).expect("a folder");
    let path = folder.skeletons(edition).join(format!("{SLUG}.rs"));
    fs::write(path, skeleton).expect("written");
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).expect("readable")
}

#[test]
fn a_reset_puts_the_newest_skeleton_back_and_keeps_every_former_answer() {
    let (_temporary, folder) = folder();
    let mut former = Vec::new();
    for answer in ["first try", "second try"] {
        fs::write(folder.answer(SLUG), answer).expect("written");
        former.extend(edition::reset(&folder, SLUG).expect("reset"));
        assert_eq!(text(&folder.answer(SLUG)), FIRST);
        assert_eq!(edition::reset(&folder, SLUG), Ok(None), "there is nothing to keep");
    }
    assert_eq!(
        former.iter().map(|path| text(path)).collect::<Vec<_>>(),
        ["first try", "second try"]
    );
}

#[test]
fn pictures_go_with_a_reset_and_those_of_other_exercises_stay() {
    let (_temporary, folder) = folder();
    let [mine, other] = [SLUG, "left"].map(|slug| folder.picture(slug, "a_check"));
    for path in [&mine, &other] {
        write(path, "<svg/>").expect("written");
    }
    edition::reset(&folder, SLUG).expect("reset");
    assert!(!mine.exists() && other.exists());
}

#[test]
fn an_update_keeps_the_students_work_and_takes_the_new_text() {
    let (_temporary, folder) = folder();
    let mine = FIRST.replacen("    todo!()", "    1 + 1;", 1);
    fs::write(folder.answer(SLUG), &mine).expect("written");
    assert_eq!(edition::update(&folder, SLUG), Ok(Update::Current(1)));
    hand_out(&folder, 3, &FIRST.replace("Edition 1.", "Edition 3.").replace("fn b", "fn c"));
    let Ok(Update::Merged { edition: 3, former }) = edition::update(&folder, SLUG) else {
        panic!("not merged");
    };
    let merged = text(&folder.answer(SLUG));
    assert!(merged.contains("Edition 3.") && merged.contains("1 + 1;") && merged.contains("fn c"));
    assert_eq!(text(&former), mine);
    assert_eq!(edition::update(&folder, SLUG), Ok(Update::Current(3)));
}

#[test]
fn an_update_that_meets_the_students_lines_leaves_the_file_as_it_is() {
    let (_temporary, folder) = folder();
    let mine = FIRST.replacen("    todo!()", "    mine()", 1);
    fs::write(folder.answer(SLUG), &mine).expect("written");
    hand_out(&folder, 2, &FIRST.replace("1.", "2.").replacen("    todo!()", "    todo!(\"x\")", 1));
    let Ok(Update::Conflict { edition: 2, merged }) = edition::update(&folder, SLUG) else {
        panic!("no conflict");
    };
    assert_eq!(text(&folder.answer(SLUG)), mine);
    assert!(text(&merged).contains("mine()") && text(&merged).contains("todo!(\"x\")"));
    // What was settled there outlives another update.
    fs::write(&merged, "settled").expect("written");
    let Ok(Update::Conflict { merged: again, .. }) = edition::update(&folder, SLUG) else {
        panic!("no conflict");
    };
    assert_eq!(text(&merged), "settled");
    assert!(again != merged && text(&again).contains("mine()"));
}

#[test]
fn a_reset_brings_back_a_file_that_is_gone() {
    let (_temporary, folder) = folder();
    fs::remove_file(folder.answer(SLUG)).expect("removed");
    assert_eq!(edition::reset(&folder, SLUG), Ok(None));
    assert_eq!(text(&folder.answer(SLUG)), FIRST);
}

#[test]
fn an_answer_that_does_not_say_its_edition_is_told_how() {
    let (_temporary, folder) = folder();
    fs::write(folder.answer(SLUG), "fn mine() {}").expect("written");
    let error = edition::update(&folder, SLUG).expect_err("no edition");
    assert!(error.contains("Edition N."), "{error}");
    fs::remove_file(folder.answer(SLUG)).expect("removed");
    let error = edition::update(&folder, SLUG).expect_err("no file");
    assert!(error.contains("cannot read") && error.contains("left_perturbation.rs"), "{error}");
}

#[test]
fn hints_come_one_by_one_and_the_last_one_stays() {
    let (_temporary, folder) = folder();
    let exercise = EXERCISES[0];
    let count = exercise.hint_ladder().len();
    for number in 1..=count {
        let hint = hints::next(&folder, exercise).expect("a hint");
        assert!(hint.starts_with(&format!("Hint {number} of {count}")), "{hint}");
    }
    let again = hints::next(&folder, exercise).expect("a hint");
    assert!(again.starts_with(&format!("Hint {count} of {count}, the last")), "{again}");
}

#[test]
fn progress_knows_what_was_tested_as_it_is() {
    let (_temporary, folder) = folder();
    let exercise = EXERCISES[0];
    assert_eq!(progress::state(&folder, exercise), State::Untouched);
    fs::write(folder.answer(SLUG), "//! Edition 1.\nfn mine() {}").expect("written");
    assert_eq!(progress::state(&folder, exercise), State::Unknown);
    let mut verdicts = Verdicts::new(SLUG, "//! Edition 1.\nfn mine() {}");
    let checks = (exercise.checks)();
    verdicts.add(checks[0].name, &Ok(()));
    verdicts.keep(&folder).expect("kept");
    assert_eq!(
        progress::state(&folder, exercise),
        State::Unknown,
        "there are checks that nobody asked"
    );
    for check in &checks[1..] {
        verdicts.add(check.name, &Err(Failure::new("wrong")));
    }
    verdicts.keep(&folder).expect("kept");
    let of = checks.len();
    assert_eq!(progress::state(&folder, exercise), State::Judged { passed: 1, of });
    fs::write(folder.answer(SLUG), "//! Edition 1.\nfn changed() {}").expect("written");
    assert_eq!(progress::state(&folder, exercise), State::Unknown);
    assert!(progress::list(&folder).contains(exercise.slug));
}

#[test]
fn an_answer_that_is_refused_for_a_name_is_listed_as_that_and_not_asked_again() {
    let (_temporary, folder) = folder();
    let exercise = EXERCISES[0];
    let answer = "//! Edition 1.\nfn jacobians() {}";
    fs::write(folder.answer(SLUG), answer).expect("written");
    let is_asked = || progress::to_judge(&folder).iter().any(|asked| asked.slug == SLUG);
    assert!(is_asked());
    Verdicts::new(SLUG, answer).refused("jacobians").keep(&folder).expect("kept");
    assert_eq!(progress::state(&folder, exercise), State::Refused("jacobians".to_owned()));
    assert!(!is_asked() && !progress::is_solved(&folder, exercise));
    let list = progress::list(&folder);
    assert!(list.contains("refused: `jacobians` needs another name"), "{list}");
    fs::write(folder.answer(SLUG), answer.replace("jacobians", "mine")).expect("written");
    assert!(is_asked());
}

/// Tests of an answer that pass where it says so.
fn judged(folder: &Folder, exercise: &'static Exercise) {
    let answer = text(&folder.answer(exercise.slug));
    let mut verdicts = Verdicts::new(exercise.slug, &answer);
    for check in (exercise.checks)() {
        let outcome = if answer.contains("right") { Ok(()) } else { Err(Failure::new("wrong")) };
        verdicts.add(check.name, &outcome);
    }
    verdicts.keep(folder).expect("kept");
}

#[test]
fn a_watch_checks_at_once_and_goes_on_to_the_next_exercise_when_one_is_solved() {
    let (_temporary, folder) = folder();
    let [first, second, third] = [EXERCISES[0], EXERCISES[1], EXERCISES[2]];
    let answer = |exercise: &Exercise, answer: &str| {
        fs::write(folder.answer(exercise.slug), answer).expect("written");
    };
    answer(first, "wrong");
    answer(second, "wrong too");
    let ran = std::cell::RefCell::new(Vec::new());
    let taken = || ran.borrow_mut().drain(..).collect::<Vec<&str>>();
    let mut watch = Watch::new(&folder, |exercise| {
        judged(&folder, exercise);
        ran.borrow_mut().push(exercise.slug);
        Ok(())
    });
    watch.begin(first).expect("run");
    assert_eq!(taken(), [first.slug], "at once, and no farther");
    watch.look().expect("run");
    assert_eq!(taken(), [""; 0], "nothing was saved");
    answer(first, "right");
    watch.look().expect("run");
    assert_eq!(taken(), [first.slug, second.slug], "and the next one");
    let skeleton = folder.skeletons(1).join(format!("{}.rs", third.slug));
    fs::write(skeleton, FIRST).expect("written");
    answer(third, FIRST);
    answer(second, "right");
    watch.look().expect("run");
    assert_eq!(taken(), [second.slug], "the next one is not begun");
    let next = |after: Option<&str>| progress::next(&folder, after).map(|next| next.slug);
    assert_eq!([next(None), next(Some(third.slug))], [third, EXERCISES[3]].map(|it| Some(it.slug)));
}

#[test]
fn a_name_that_is_none_is_told_with_those_there_are() {
    let error = selection::named("left_pertubation").map(|_| ()).expect_err("a misspelt name");
    assert!(error.contains("left_pertubation") && error.contains("left_perturbation"), "{error}");
}

#[test]
fn long_sentences_are_broken_between_words() {
    assert_eq!(
        selection::wrapped("one two three\nfour\n\nfive", 9),
        "one two\nthree\nfour\n\nfive"
    );
}

#[test]
fn a_picture_has_both_kinds_of_points_and_one_without_finite_points_is_refused() {
    let dots =
        |name: &str, at: f64| exercise_spec::picture::Dots::new(name, [[at, 1.0], [2.0, 3.0]]);
    let mut drawn = exercise_spec::picture::Picture {
        title: "Moves <of> a pixel".to_owned(),
        axes: ["u, px".to_owned(), "v, px".to_owned()],
        expected: dots("expected", 0.5),
        obtained: dots("obtained", f64::NAN),
        downward: true,
    };
    let svg = picture::svg(&drawn).expect("drawn");
    assert!(svg.contains("expected") && svg.contains("obtained") && svg.contains("&lt;of&gt;"));
    for axis in ["u, px", "v, px", "0.5", "1.0"] {
        assert!(svg.contains(axis), "there is no {axis} at the axes: {svg}");
    }
    drawn.expected.at = vec![[f64::NAN; 2]];
    drawn.obtained.at = vec![[f64::INFINITY; 2]];
    assert!(picture::svg(&drawn).is_err());
}

#[test]
fn a_way_that_leads_elsewhere_is_a_difference_and_is_drawn() {
    let going = |name: &str, to: f64| {
        exercise_spec::picture::Dots::new(name, [[0.0, 0.0], [9.0, 9.0]]).with_ways([[to, 0.0]])
    };
    let drawn = |to: f64| exercise_spec::picture::Picture {
        title: "A velocity".to_owned(),
        axes: ["x, m".to_owned(), "y, m".to_owned()],
        expected: going("expected", 2.0),
        obtained: going("obtained", to),
        downward: false,
    };
    assert!(!drawn(2.0).shows_a_difference());
    assert!(drawn(4.0).shows_a_difference());
    let [right, wrong] = [2.0, 4.0].map(|to| picture::svg(&drawn(to)).expect("drawn"));
    assert_ne!(right, wrong);
}

#[test]
fn a_failure_says_of_one_number_how_far_it_is_off_and_what_went_in() {
    use exercise_spec::check::{compare_list, compare_number};
    let one = compare_number("the slope", 1.0, 2.0).judge().expect_err("wrong");
    let one = one.given(&[("dt", &0.1), ("gyro", &[0.1 + 0.2, 1.0])]).numbers;
    assert!(one.contains("differs by more than 1e-9 of it"), "{one}");
    assert!(one.ends_with("given:\n  dt: 0.1\n  gyro: [0.30000000000000004, 1.0]\n"), "{one}");
    let two = compare_list("the slopes", &[1.0, 1.0], &[1.0, 2.0]).judge().expect_err("wrong");
    assert!(two.numbers.contains("of the greatest entry"), "{}", two.numbers);
}
