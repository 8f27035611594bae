//! What exercises and checks are worth.

use grader::points::Points;

const FILE: &str = include_str!("../points.toml");

fn error(text: &str) -> String {
    Points::parse(text).expect_err("an error")
}

#[test]
fn the_file_of_the_repository_is_ten_points_for_each_exercise() {
    let points = Points::parse(FILE).expect("points");
    for exercise in exercise_spec::EXERCISES {
        assert_eq!(points.of(exercise.slug), 10.0, "{}", exercise.slug);
    }
    assert_eq!(points.weight("left_perturbation", "the_adjoint_takes_left_to_right", false), 1.0);
    assert_eq!(points.weight("left_perturbation", "adjoint_far_from_the_origin", true), 1.0);
}

#[test]
fn a_check_has_the_weight_of_its_line_and_the_others_that_of_their_kind() {
    let text = FILE.replace("hidden = 1.0", "hidden = 3.0")
        + "\n[checks.left_perturbation]\nadjoint_far_from_the_origin = 0.5\n";
    let points = Points::parse(&text).expect("points");
    assert_eq!(points.weight("left_perturbation", "adjoint_far_from_the_origin", true), 0.5);
    assert_eq!(points.weight("left_perturbation", "left_jacobian_anywhere", true), 3.0);
    assert_eq!(points.weight("fill_in", "anything", false), 1.0);
}

#[test]
fn an_exercise_that_there_is_not_is_told_with_its_line_and_those_there_are() {
    let said = error(&FILE.replace("stereo_gauge = 10", "stereo_gage = 10"));
    let line = FILE.lines().position(|line| line.starts_with("stereo_gauge")).expect("a line") + 1;
    assert!(said.contains(&format!("line {line}: ")), "{said}");
    assert!(said.contains("`stereo_gage`") && said.contains("stereo_gauge, "), "{said}");
}

#[test]
fn chapters_have_points_for_words_and_none_for_programs() {
    let points = Points::parse(&format!("{FILE}\n[words]\nbearing = 2\n")).expect("points");
    assert_eq!((points.of_words("bearing"), points.of("bearing")), (2.0, 0.0));
    let said = error(&FILE.replace("[points]", "[points]\nbearing = 10"));
    assert!(said.contains("there is no exercise `bearing`"), "{said}");
    let said = error(&format!("{FILE}\n[words]\nbaring = 2\n"));
    let line = FILE.lines().count() + 3;
    assert!(said.contains(&format!("line {line}: there is no exercise `baring`")), "{said}");
    assert!(said.contains("fill_in, ") && said.contains("in words bearing, manifold"), "{said}");
}

#[test]
fn a_check_that_there_is_not_is_told_with_its_line_and_those_there_are() {
    let said = error(&format!("{FILE}\n[checks.left_perturbation]\nthe_adjont = 2\n"));
    let line = FILE.lines().count() + 3;
    assert!(
        said.contains(&format!("line {line}: `left_perturbation` has no check `the_adjont`")),
        "{said}"
    );
    assert!(said.contains("the_adjoint_takes_left_to_right"), "{said}");
    assert!(said.contains("items.md"), "{said}");
}

#[test]
fn numbers_that_are_no_weight_are_told_with_their_line() {
    for bad in ["-1", "nan", "inf", "-inf", "1e300"] {
        let said = error(&FILE.replace("fill_in = 10", &format!("fill_in = {bad}")));
        assert!(said.contains("line ") && said.contains("`fill_in` is"), "{bad}: {said}");
        let said = error(&FILE.replace("public = 1.0", &format!("public = {bad}")));
        assert!(said.contains("`public` is"), "{bad}: {said}");
    }
}

#[test]
fn an_exercise_that_is_left_out_is_told() {
    let said = error(&FILE.replace("fill_in = 10", ""));
    assert!(said.contains("add `fill_in = 10`"), "{said}");
}

#[test]
fn points_that_nobody_can_earn_are_told() {
    let nothing = FILE.replace("public = 1.0", "public = 0").replace("hidden = 1.0", "hidden = 0");
    let said = error(&nothing);
    assert!(said.contains("nobody could earn"), "{said}");
    Points::parse(&FILE.replace("public = 1.0", "public = 0")).expect("hidden checks alone");
    let one = "\n[checks.fill_in]\n";
    let said = error(&(nothing + one));
    assert!(said.contains("`left_perturbation` is worth 10 points"), "{said}");
}

#[test]
fn a_file_of_another_form_is_told_with_its_line() {
    for (from, to) in
        [("\n[weights]", "\n[wieghts]"), ("= 10", "= \"ten\""), ("\n[points]", "\n[points")]
    {
        let said = error(&FILE.replacen(from, to, 1));
        assert!(said.contains("line "), "{to}: {said}");
    }
    assert!(error("").contains("weights"));
}

#[test]
fn a_value_that_is_no_number_is_told_with_its_line() {
    for (from, name, bad) in [
        ("null_space = 10", "null_space", "ten"),
        ("null_space = 10", "null_space", "\"10\""),
        ("null_space = 10", "null_space", ""),
        ("null_space = 10", "null_space", "10,5"),
        ("public = 1.0", "public", "yes"),
        ("hidden = 1.0", "hidden", "true"),
    ] {
        let said = error(&FILE.replace(&format!("\n{from}"), &format!("\n{name} = {bad} # why")));
        let line = FILE.lines().position(|line| line.starts_with(from)).expect("a line") + 1;
        let wanted = format!("line {line}: `{name}` must be a number");
        assert!(said.starts_with(&wanted), "{bad}: {said}");
    }
}
