//! Which answers are alike, and which are not.

use std::fs;
use std::ops::Range;
use std::path::Path;

use exercise_spec::{EXERCISES, exercise};
use grader::repository;
use grader::similarity::{Pair, Similarity};

fn reference(slug: &str) -> String {
    fs::read_to_string(repository().join("solutions/src").join(format!("{slug}.rs")))
        .expect("a file")
}

fn skeleton(slug: &str) -> String {
    fs::read_to_string(repository().join("exercises/src").join(format!("{slug}.rs")))
        .expect("a file")
}

fn compared(slug: &str, answers: &[(&str, &str)]) -> Similarity {
    let mut similarity = Similarity::new(&[exercise(slug).expect("an exercise")], &repository());
    for (name, text) in answers {
        similarity.add(name, |asked| (asked == slug).then_some(*text));
    }
    similarity
}

fn pairs(pairs: &[Pair]) -> Vec<(&str, &str)> {
    pairs.iter().map(|pair| (pair.one.as_str(), pair.other.as_str())).collect()
}

/// An answer to the same question in another way.
const OTHER: &str = "
use exercise_spec::left_perturbation::{Camera, Side};
use nalgebra::{Isometry3, Matrix2x6, Vector2, Vector3, Vector6, Matrix2x3};

pub fn left_pose_jacobian(camera: Camera, camera_from_world: Isometry3<f64>, point_in_world: Vector3<f64>) -> Matrix2x6<f64> {
    let p = camera_from_world.rotation * point_in_world + camera_from_world.translation.vector;
    let z = 1.0 / p.z;
    let (fx, fy) = (camera.fx, camera.fy);
    let mut m = Matrix2x6::zeros();
    m[(0, 0)] = fx * z;
    m[(0, 2)] = -fx * p.x * z * z;
    m[(1, 1)] = fy * z;
    m[(1, 2)] = -fy * p.y * z * z;
    m[(0, 3)] = -fx * p.x * p.y * z * z;
    m[(0, 4)] = fx * (1.0 + p.x * p.x * z * z);
    m[(0, 5)] = -fx * p.y * z;
    m[(1, 3)] = -fy * (1.0 + p.y * p.y * z * z);
    m[(1, 4)] = fy * p.x * p.y * z * z;
    m[(1, 5)] = fy * p.x * z;
    m
}
";

#[test]
fn a_copy_of_the_reference_is_told_for_every_exercise() {
    for exercise in EXERCISES {
        let text = reference(exercise.slug);
        let alike = compared(exercise.slug, &[("copy", &text)]).with_reference(exercise.slug);
        assert_eq!(pairs(&alike), [("copy", "the reference")], "{}", exercise.slug);
        assert!(alike[0].share > 0.999, "{}: {alike:?}", exercise.slug);
    }
}

#[test]
fn new_names_new_comments_and_new_lines_do_not_hide_a_copy() {
    let text = reference("left_perturbation");
    let renamed = text
        .replace("point_in_camera", "q")
        .replace("jacobian.", "result.")
        .replace("let mut jacobian", "let mut result")
        .replace("    jacobian\n", "    result\n")
        .replace("projection", "p")
        .replace("p_jacobian", "projection_jacobian")
        .replace(";\n", "; // my own idea\n\n\n");
    assert_ne!(text, renamed);
    let alike =
        compared("left_perturbation", &[("copy", &renamed)]).with_reference("left_perturbation");
    assert!(alike.first().is_some_and(|pair| pair.share > 0.9), "{alike:?}");
}

#[test]
fn functions_in_another_order_do_not_hide_a_copy() {
    let text = reference("fill_in");
    let (uses, functions) =
        text.split_at(text.find("\n\n///").or_else(|| text.find("\n\npub")).expect("functions"));
    let parts = functions.rsplit("\n}\n").filter(|part| !part.trim().is_empty());
    let turned = parts.fold(uses.to_owned(), |text, part| text + part + "\n}\n");
    let alike = compared("fill_in", &[("copy", &turned)]).with_reference("fill_in");
    assert!(alike.first().is_some_and(|pair| pair.share > 0.8), "{alike:?}");
}

#[test]
fn an_answer_of_ones_own_is_not_told() {
    let similarity = compared("left_perturbation", &[("own", OTHER)]);
    assert!(similarity.with_reference("left_perturbation").is_empty());
}

#[test]
fn two_who_share_an_answer_are_told_and_a_third_is_not() {
    let text = reference("left_perturbation");
    let changed = text.replace("jacobian", "j").replace("projection", "p");
    let similarity =
        compared("left_perturbation", &[("ada", &text), ("brook", OTHER), ("cem", &changed)]);
    assert_eq!(pairs(&similarity.within("left_perturbation")), [("ada", "cem")]);
}

#[test]
fn a_first_line_that_the_compiler_drops_does_not_hide_an_answer() {
    let text = reference("left_perturbation");
    for first in ["#!x /*", "\u{feff}#!x [\""] {
        let hidden = format!("{first}\n{text}\n// */ \"]\n");
        let alike =
            compared("left_perturbation", &[("hid", &hidden)]).with_reference("left_perturbation");
        assert_eq!(pairs(&alike), [("hid", "the reference")]);
    }
}

#[test]
fn equal_pairs_stand_in_the_order_of_their_names_and_a_long_list_says_how_many_more() {
    let text = reference("left_perturbation");
    let names: Vec<String> = (0..24).map(|number| format!("s{number:02}")).collect();
    let mut answers: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), OTHER)).collect();
    // Half of the class, so that it is not what most have.
    answers.iter_mut().take(12).for_each(|answer| answer.1 = &text);
    answers.reverse();
    let similarity = compared("left_perturbation", &answers);
    let within = similarity.within("left_perturbation");
    assert_eq!(within.len(), 2 * 66);
    let key =
        |pair: &Pair| (-pair.share, -(pair.shared as f64), pair.one.clone(), pair.other.clone());
    assert!(within.is_sorted_by(|a, b| key(a) <= key(b)), "{within:?}");
    let report = similarity.markdown();
    assert_eq!(report.matches("| and 92 more | | |").count(), 2, "{report}");
    assert_eq!(report, compared("left_perturbation", &answers).markdown());
}

#[test]
fn those_who_are_alike_in_many_exercises_stand_on_top() {
    let mut similarity = Similarity::new(EXERCISES, &repository());
    let texts: Vec<(&str, String)> =
        EXERCISES.iter().map(|it| (it.slug, reference(it.slug))).collect();
    let text = |slug: &str| texts.iter().find(|(of, _)| *of == slug).map(|(_, text)| text.as_str());
    similarity.add("anna", text);
    similarity.add("cem", |slug| text(slug).filter(|_| slug == "fill_in"));
    similarity.add("hugo", |slug| text(slug).filter(|_| slug != "null_space"));
    let report = similarity.markdown();
    let all = EXERCISES.len();
    let of_all = format!(" of {all} ");
    let top: Vec<&str> = report
        .lines()
        .skip_while(|line| *line != "## Over all exercises")
        .filter(|line| line.contains(&of_all))
        .collect();
    let alike = [("anna | hugo", all - 1), ("anna | cem", 1), ("cem | hugo", 1)]
        .map(|(pair, shared)| format!("| {pair} | {shared} of {all} |"));
    assert_eq!(top, alike, "{report}");
}

#[test]
fn what_the_skeleton_has_does_not_count() {
    for exercise in EXERCISES {
        let text = skeleton(exercise.slug);
        let similarity = compared(exercise.slug, &[("ada", &text), ("brook", &text)]);
        assert!(similarity.within(exercise.slug).is_empty(), "{}", exercise.slug);
        assert!(similarity.with_reference(exercise.slug).is_empty(), "{}", exercise.slug);
    }
}

#[test]
fn what_most_of_a_class_writes_does_not_count() {
    let text = reference("left_perturbation");
    let names: Vec<String> = (0..20).map(|number| format!("student {number}")).collect();
    // Each has something of its own besides.
    let texts: Vec<String> =
        (0..20).map(|number| padded(&text, 100 * number..100 * number + 20)).collect();
    let answers: Vec<(&str, &str)> =
        names.iter().map(String::as_str).zip(texts.iter().map(String::as_str)).collect();
    let similarity = compared("left_perturbation", &answers);
    assert!(similarity.within("left_perturbation").is_empty());
    assert_eq!(similarity.with_reference("left_perturbation").len(), 20);
}

#[test]
fn texts_that_are_no_answers_harm_nobody() {
    let deep = "(".repeat(100_000) + &")".repeat(100_000);
    let open = "{".repeat(100_000);
    let long = "let x = y * z + 1; ".repeat(10_000);
    let texts =
        ["", "\"", "\u{0}\u{1}", "r#\"", "#![", "# # #", "#!", "'", "/*", &deep, &open, &long];
    let names: Vec<String> = (0..texts.len()).map(|number| number.to_string()).collect();
    let answers: Vec<(&str, &str)> = names.iter().map(String::as_str).zip(texts).collect();
    let similarity = compared("left_perturbation", &answers);
    assert!(!similarity.markdown().is_empty());
}

#[test]
fn a_repository_without_the_reference_compares_the_batch_alone() {
    let text = reference("fill_in");
    let mut similarity =
        Similarity::new(&[exercise("fill_in").expect("one")], Path::new("nowhere"));
    for name in ["ada", "brook"] {
        similarity.add(name, |_| Some(&text));
    }
    assert!(similarity.with_reference("fill_in").is_empty());
    assert_eq!(pairs(&similarity.within("fill_in")), [("ada", "brook")]);
}

#[test]
fn the_report_says_that_it_is_no_verdict_and_escapes_names() {
    let text = reference("fill_in");
    let report = compared("fill_in", &[("a|b", &text), ("<b>", &text)]).markdown();
    assert!(report.contains("no verdict"));
    assert!(report.contains("a\\|b") && report.contains("\\<b\\>"), "{report}");
}

/// An answer with items behind it that nobody calls, each of them another.
fn padded(text: &str, items: Range<usize>) -> String {
    let kinds = ["+", "-", "*", "/", "%", "^", "&", "|"];
    let kind = |number: usize, digit: u32| kinds[number / kinds.len().pow(digit) % kinds.len()];
    let item = |number: usize| {
        let signs = [0, 1, 2, 3, 4].map(|digit| kind(number, digit));
        format!("const X:u8=1{};", signs.map(|sign| format!("{sign}1")).concat())
    };
    items.map(item).fold(text.to_owned(), |text, item| text + &item)
}

/// A text with many more parentheses around what is assigned.
fn in_parentheses(text: &str) -> String {
    let line = |line: &str| match line.split_once(" = ") {
        Some((before, after)) if line.trim_start().starts_with("let ") && after.ends_with(';') => {
            format!("{before} = (((({}))));\n", after.trim_end_matches(';'))
        }
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

#[test]
fn what_is_put_around_a_copy_does_not_hide_it() {
    for exercise in EXERCISES {
        let text = reference(exercise.slug);
        let hidden = [
            padded(&text, 0..13_500),
            text.replace(";\n", ";;;\n").replace("{\n", "{\n;"),
            in_parentheses(&text),
            text.replace('{', "{{{").replace('}', "}}}"),
        ];
        for hidden in hidden {
            let alike = compared(exercise.slug, &[("copy", &hidden)]).with_reference(exercise.slug);
            let share = alike.first().map_or(0.0, |pair| pair.share);
            assert!(share > 0.9, "{}: {share} of\n{hidden:.600}", exercise.slug);
        }
    }
}

#[test]
fn two_padded_answers_that_share_nothing_else_are_told_by_what_they_share() {
    let (ada, brook) = (padded(OTHER, 0..2_000), padded("", 9_000..13_000) + OTHER);
    let similarity = compared("left_perturbation", &[("ada", &ada), ("brook", &brook)]);
    assert_eq!(pairs(&similarity.within("left_perturbation")), [("ada", "brook")]);
}

#[test]
fn five_of_nine_that_are_the_same_are_told_and_the_others_are_not() {
    let names: Vec<String> = (0..9).map(|number| format!("s{number}")).collect();
    let own = reference("left_perturbation");
    let texts: Vec<String> = (0..9)
        .map(|number| match number {
            0..5 => OTHER
                .replace("let z ", &format!("let z{number} "))
                .replace("* z", &format!("* z{number}")),
            5 => own.clone(),
            _ => skeleton("left_perturbation"),
        })
        .collect();
    let answers: Vec<(&str, &str)> =
        names.iter().map(String::as_str).zip(texts.iter().map(String::as_str)).collect();
    let similarity = compared("left_perturbation", &answers);
    let within = similarity.within("left_perturbation");
    assert_eq!(within.len(), 10, "{within:?}");
    assert!(within.iter().all(|pair| pair.share == 1.0 && pair.other.as_str() < "s5"));
    let report = similarity.markdown();
    assert!(report.contains("but for names: 5 answers, of s0, s1, s2, s3, s4."), "{report}");
}

#[test]
fn an_answer_that_is_too_short_to_be_compared_is_told_when_it_is_the_same() {
    let text = "pub fn f(x: f64) -> f64 { x.mul_add(2.0, 1.0) }";
    let other = "pub fn f(y: f64) -> f64 { y.mul_add(2.0, 1.0) }\n// Mine.";
    let third = "pub fn f(x: f64) -> f64 { 1.0 + 2.0 * x }";
    let answers = [("ada", text), ("brook", other), ("cem", third)];
    let similarity = compared("left_perturbation", &answers);
    assert_eq!(pairs(&similarity.within("left_perturbation")), [("ada", "brook")]);
}
