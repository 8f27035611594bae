//! What a person decides is laid over what the grader did, today and whenever it is graded again.

mod made_up;

use std::fs;
use std::path::Path;

use exercise_spec::EXERCISES;
use grader::batch::{Finished, Order, Trouble, carry_out_with};
use grader::marks::Marks;
use grader::points::Points;
use grader::repository;
use made_up::{StandIn, order, submissions};
use tempfile::TempDir;

const POINTS: &str = include_str!("../points.toml");

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn carry_out(order: &Order) -> Result<Finished, Trouble> {
    carry_out_with(order, |points, seed, exercises| Ok(StandIn::new(points, seed, exercises)))
}

fn read(out: &Path, name: &str) -> String {
    fs::read_to_string(out.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Two who solved the exercise, of whom one has written a sentence, and points for sentences.
fn with_words(folder: &Path) -> Order {
    with_words_on("left_perturbation", folder)
}

fn with_words_on(question: &str, folder: &Path) -> Order {
    let path = submissions(folder, &[("ada", "right"), ("brook", "right")]);
    let questions =
        fs::read_to_string(repository().join("exercises/answers.md")).expect("questions");
    let heading = format!("## {question}\n");
    let words =
        questions.replace(&heading, &format!("{heading}\nThe point it heads for <b>stays</b>.\n"));
    fs::write(path.join("ada/exercises/answers.md"), words).expect("written");
    fs::write(path.join("brook/exercises/answers.md"), questions).expect("written");
    let points = folder.join("points.toml");
    let text =
        format!("{POINTS}\n[words]\n{question} = 2\n\n[late]\npercent_a_day = 10\nmost = 40\n");
    fs::write(&points, text).expect("written");
    Order { points: Some(points), ..order(&path, &folder.join("grades")) }
}

fn with_marks(order: &Order, rows: &str) -> Order {
    let path = order.out.with_file_name("marks.csv");
    fs::write(&path, format!("folder,exercise,part,points,comment\n{rows}")).expect("written");
    Order { marks: Some(path), ..order.clone() }
}

fn row_of<'a>(book: &'a str, name: &str) -> &'a str {
    book.lines().find(|line| line.starts_with(&format!("{name},"))).expect("a row")
}

#[test]
fn words_are_collected_and_count_when_a_person_has_marked_them() {
    let temporary = folder();
    let order = with_words(temporary.path());
    let told = carry_out(&order).expect("a batch").told;
    assert!(told.contains("1 answer in words without points, which do not count yet"), "{told}");
    let words = read(&order.out, "words.md");
    assert!(
        words.contains("### ada\n\n```text\nThe point it heads for <b>stays</b>.\n```"),
        "{words}"
    );
    assert!(!words.contains("brook"), "{words}");
    let open = read(&order.out, "unmarked.csv");
    assert_eq!(open, "folder,exercise,part,points,comment\nada,left_perturbation,words,,\n");
    assert!(row_of(&read(&order.out, "gradebook.csv"), "ada").starts_with("ada,,20,20,10,10,"));

    let order = with_marks(&order, "ada,left_perturbation,words,\"1,5\",Which point?\n");
    let told = carry_out(&order).expect("a batch").told;
    assert!(!told.contains("in words without points"), "{told}");
    let book = read(&order.out, "gradebook.csv");
    assert_eq!(row_of(&book, "ada"), "ada,,21.5,22,11.5,10,graded,graded,1.5,,21.5,ada,graded");
    assert_eq!(row_of(&book, "brook"), "brook,,20,22,10,10,graded,graded,0,,20,brook,graded");
    let feedback = read(&order.out, "submissions/ada/feedback.md");
    assert!(feedback.contains("The answer in words earns 1.5 of 2 points."), "{feedback}");
    assert!(feedback.contains("\nWhich point?\n"), "{feedback}");
    assert!(read(&order.out, "submissions/ada/results.json").contains("Which point?"));
}

#[test]
fn words_that_nobody_could_read_are_no_zero() {
    let temporary = folder();
    let order = with_words(temporary.path());
    let path = order.submissions[0].join("ada/exercises/answers.md");
    fs::write(path, b"\xff\xfe#\0#\0").expect("written");
    let order = with_marks(&order, "brook,left_perturbation,words,1,\n");
    let told = carry_out(&order).expect("a batch").told;
    let told = told.replace('\n', " ");
    assert!(told.contains("There may be words that were not read, which is no zero"), "{told}");
    assert!(told.contains("They are those of ada."), "{told}");
    let book = read(&order.out, "gradebook.csv");
    assert_eq!(row_of(&book, "ada"), "ada,,20,20,10,10,graded,graded,,,20,ada,graded");
    assert_eq!(row_of(&book, "brook"), "brook,,21,22,11,10,graded,graded,1,,21,brook,graded");
    let open = read(&order.out, "unmarked.csv");
    assert_eq!(open, "folder,exercise,part,points,comment\nada,left_perturbation,words,,\n");

    let both = "brook,left_perturbation,words,1,\nada,left_perturbation,words,2,\n";
    let told = carry_out(&with_marks(&order, both)).expect("a batch").told;
    assert!(!told.contains("not read"), "everything is marked: {told}");
    assert_eq!(read(&order.out, "unmarked.csv").lines().count(), 1);
    let told =
        carry_out(&Order { points: None, marks: None, ..order.clone() }).expect("a batch").told;
    assert!(!told.contains("not read"), "words have no points: {told}");
    assert_eq!(read(&order.out, "unmarked.csv").lines().count(), 1);
}

#[test]
fn many_whose_words_nobody_could_read_are_counted() {
    let temporary = folder();
    let order = with_words(temporary.path());
    let batch = temporary.path().join("batch");
    for number in 0..30 {
        let name = format!("{number:02} {}", "of a long name ".repeat(6).trim_end());
        with_the_words_of_ada(&order, &batch, &name);
        fs::write(batch.join(name).join("exercises/answers.md"), b"\xff\xfe").expect("written");
    }
    let order = Order { submissions: vec![batch], ..order };
    let told = carry_out(&order).expect("a batch").told.replace('\n', " ");
    assert!(told.contains(", 19 of a long") && told.contains(", and 10 more."), "{told}");
    assert_eq!(read(&order.out, "unmarked.csv").lines().count(), 31);
}

/// Hands in the same words for each folder.
fn with_the_words_of_ada(order: &Order, batch: &Path, name: &str) {
    made_up::hand_in(batch, name, "right");
    let words = order.submissions[0].join("ada/exercises/answers.md");
    fs::copy(words, batch.join(name).join("exercises/answers.md")).expect("copied");
}

/// Marks rows of unmarked.csv in turn with no point, half a point and so on.
fn marked_in_turn(order: &Order) -> Order {
    carry_out(order).expect("a batch");
    let open = read(&order.out, "unmarked.csv");
    let marked = |(number, row): (usize, &str)| {
        let row = row.strip_suffix(',').expect("a row without points and comment");
        format!("{row}{},\n", 0.5 * number as f64)
    };
    with_marks(order, &open.lines().skip(1).enumerate().map(marked).collect::<String>())
}

#[test]
fn folders_of_one_name_are_marked_apart() {
    let temporary = folder();
    let order = with_words(temporary.path());
    let sections = ["a", "b"].map(|section| temporary.path().join(section));
    sections.iter().for_each(|section| with_the_words_of_ada(&order, section, "group1"));
    let order = marked_in_turn(&Order { submissions: sections.to_vec(), ..order });
    let told = carry_out(&order).expect("a batch").told;
    assert!(!told.contains("these marks"), "{told}");
    let book = read(&order.out, "gradebook.csv");
    assert!(row_of(&book, "group1").ends_with(",0,,20,group1,graded"), "{book}");
    assert!(row_of(&book, "group1-2").ends_with(",0.5,,20.5,group1-2,graded"), "{book}");
}

#[cfg(unix)]
#[test]
fn rows_of_any_folder_come_back_to_it() {
    let temporary = folder();
    let order = with_words(temporary.path());
    let long = "Ada Lovelace_".repeat(9) + "assignsubmission_file";
    let batch = temporary.path().join("batch");
    let names = ["Doe, -J", "=1+1", "zero\u{200c}width", "'quoted", &long];
    names.iter().for_each(|name| with_the_words_of_ada(&order, &batch, name));
    let order = marked_in_turn(&Order { submissions: vec![batch], ..order });
    let told = carry_out(&order).expect("a batch").told;
    assert!(!told.contains("these marks") && !told.contains("without points"), "{told}");
    let book = read(&order.out, "gradebook.csv");
    for points in ["0", "0.5", "1", "1.5", "2"] {
        assert_eq!(book.matches(&format!(",graded,graded,{points},,")).count(), 1, "{book}");
    }
}

#[cfg(unix)]
#[test]
fn folders_that_a_spreadsheet_would_show_alike_are_marked_apart() {
    let temporary = folder();
    let order = with_words(temporary.path());
    let batch = temporary.path().join("batch");
    ["Doe, -J", "Doe, '-J"].iter().for_each(|name| with_the_words_of_ada(&order, &batch, name));
    let order = marked_in_turn(&Order { submissions: vec![batch], ..order });
    let told = carry_out(&order).expect("a batch").told;
    assert!(!told.contains("these marks") && !told.contains("without points"), "{told}");
    let book = read(&order.out, "gradebook.csv");
    for end in [",0,,20,\"Doe, '-J\",graded", ",0.5,,20.5,\"Doe, '-J-2\",graded"] {
        assert!(book.lines().any(|line| line.ends_with(end)), "{book}");
    }
    let first = with_marks(&order, "\"Doe, '-J\",left_perturbation,words,2,\n");
    let told = carry_out(&first).expect("a batch").told;
    assert!(told.contains("1 answer in words without points"), "a mark is no other one's: {told}");
}

#[test]
fn questions_of_chapters_are_collected_and_marked_as_those_of_exercises_are() {
    let temporary = folder();
    let order = with_words_on("bearing", temporary.path());
    let order = Order { exercises: Vec::new(), ..order };
    let told = carry_out(&order).expect("a batch").told;
    assert!(told.contains("1 answer in words without points, which do not count yet"), "{told}");
    let words = read(&order.out, "words.md");
    assert!(
        words.contains(
            "## The pinhole camera and depth\n\n1 answer to `bearing`.\n\n### ada\n\n```text\nThe"
        ),
        "{words}"
    );
    let open = read(&order.out, "unmarked.csv");
    assert_eq!(open, "folder,exercise,part,points,comment\nada,bearing,words,,\n");
    let all = 10 * EXERCISES.len();
    let book = read(&order.out, "gradebook.csv");
    assert!(row_of(&book, "ada").starts_with(&format!("ada,,{all},{all},10,")), "{book}");
    assert!(!read(&order.out, "submissions/ada/feedback.md").contains("pinhole"));

    let order = with_marks(&order, "ada,bearing,words,\"1,5\",From which look on?\n");
    let told = carry_out(&order).expect("a batch").told;
    assert!(!told.contains("in words without points"), "{told}");
    let book = read(&order.out, "gradebook.csv");
    assert!(book.contains(",bearing words,") && !book.contains("bearing status"), "{book}");
    let (ada, brook) = (row_of(&book, "ada"), row_of(&book, "brook"));
    let with_words = all as f64 + 1.5;
    assert!(ada.starts_with(&format!("ada,,{with_words},{},", all + 2)), "{ada}");
    assert!(ada.ends_with(&format!(",graded,1.5,,{with_words},ada,graded")), "{ada}");
    assert!(brook.starts_with(&format!("brook,,{all},{},", all + 2)), "{brook}");
    assert!(brook.ends_with(&format!(",graded,0,,{all},brook,graded")), "{brook}");
    let feedback = read(&order.out, "submissions/ada/feedback.md");
    let line = "| The pinhole camera and depth | 1.5 of 2 | in words |  |";
    assert!(feedback.contains(line), "{feedback}");
    assert!(feedback.contains("The answer in words earns 1.5 of 2 points."), "{feedback}");
    assert!(feedback.contains("\nFrom which look on?\n"), "{feedback}");
    let results = read(&order.out, "submissions/ada/results.json");
    assert!(results.contains("The pinhole camera and depth: in words"), "{results}");
}

#[test]
fn an_order_that_names_exercises_asks_nothing_of_chapters() {
    let temporary = folder();
    let order = with_words_on("bearing", temporary.path());
    let order = with_marks(&order, "ada,bearing,words,2,\n");
    carry_out(&order).expect("a batch");
    assert!(!read(&order.out, "words.md").contains("pinhole"));
    assert_eq!(read(&order.out, "unmarked.csv").lines().count(), 1);
    assert!(row_of(&read(&order.out, "gradebook.csv"), "ada").starts_with("ada,,20,20,10,10,"));
}

#[test]
fn a_marked_chapter_makes_no_program_of_what_has_none() {
    let temporary = folder();
    let order = with_words_on("bearing", temporary.path());
    made_up::hand_in(&order.submissions[0], "ada", "cannot");
    let order = Order { exercises: Vec::new(), ..order };
    let order = with_marks(&order, "ada,bearing,words,2,\n");
    carry_out(&order).expect("a batch");
    let book = read(&order.out, "gradebook.csv");
    assert!(row_of(&book, "ada").ends_with(",ada,could not be graded"), "{book}");
}

#[test]
fn points_and_comments_of_a_person_outlive_a_regrade_and_open_what_could_not_be_graded() {
    let temporary = folder();
    let path = submissions(temporary.path(), &[("ada", "cannot"), ("brook", "two")]);
    let order = with_marks(
        &order(&path, &temporary.path().join("grades")),
        "ada,left_perturbation,program,7,Read by hand.\nada,along_or_across,program,3,\nnobody,fill_in,program,,Hm\n",
    );
    for _ in 0..2 {
        let told = carry_out(&order).expect("a batch").told;
        let told = told.replace('\n', " ");
        assert!(told.contains("so they do not count: nobody; write folders as"), "{told}");
        let book = read(&order.out, "gradebook.csv");
        assert!(row_of(&book, "ada").starts_with("ada,,10,20,7,3,graded,graded,"), "{book}");
        assert!(read(&order.out, "submissions/ada/feedback.md").contains("Read by hand."));
        made_up::hand_in(&path, "brook", "right");
    }
    let without = Order { marks: None, ..order };
    carry_out(&without).expect("a batch");
    assert!(
        row_of(&read(&without.out, "gradebook.csv"), "ada")
            .starts_with("ada,,,20,,,could not be graded,")
    );
}

#[test]
fn what_is_taken_off_for_lateness_is_a_column() {
    let temporary = folder();
    let order = with_words(temporary.path());
    let roster = temporary.path().join("roster.csv");
    fs::write(&roster, "folder,name,days_late\nada,Ada,1.2\nbrook,Brook,30\n").expect("written");
    let order = Order { roster: Some(roster.clone()), ..order };
    carry_out(&order).expect("a batch");
    let book = read(&order.out, "gradebook.csv");
    assert!(row_of(&book, "ada").ends_with(",1.2,16,ada,graded"), "{book}");
    assert!(row_of(&book, "brook").ends_with(",30,12,brook,graded"), "{book}");
    let feedback = read(&order.out, "submissions/ada/feedback.md");
    assert!(
        feedback
            .contains("It came 1.2 days late, for which 20 % are taken off: 16 points are left."),
        "{feedback}"
    );
    fs::write(&roster, "folder,name,days_late\nada,Ada,soon\n").expect("written");
    let Err(Trouble::Usage(sentence)) = carry_out(&order) else { panic!("soon is no number") };
    assert!(sentence.contains("`soon` in the column `days_late` of `ada`"), "{sentence}");
}

#[test]
fn what_is_worth_nothing_is_no_part_of_the_course() {
    let temporary = folder();
    let path = submissions(temporary.path(), &[("ada", "right")]);
    let three = ["left_perturbation", "fill_in", "null_space"];
    let line = |line: &str| match line.split_once(" = 10") {
        Some((slug, _)) if !three.contains(&slug) => format!("{slug} = 0\n"),
        _ => format!("{line}\n"),
    };
    let points = temporary.path().join("points.toml");
    fs::write(&points, POINTS.lines().map(line).collect::<String>()).expect("written");
    let order = order(&path, &temporary.path().join("grades"));
    let order = Order { points: Some(points), exercises: Vec::new(), ..order };
    let told = carry_out(&order).expect("a batch").told;
    assert!(told.starts_with("ada: 30 of 30 points"), "{told}");
    assert!(!told.contains("stereo_gauge"), "{told}");
}

#[test]
fn marks_with_mistakes_are_told_with_their_line() {
    let points = Points::parse(&format!("{POINTS}\n[words]\nfill_in = 2\n")).expect("points");
    let error = |text: &str| Marks::parse(text, &points).expect_err("an error");
    let heading = "folder,exercise,part,points,comment\n";
    for (rows, said) in [
        ("ada,fill_out,words,1,\n", "line 2: there is no exercise `fill_out`"),
        ("ada,fill_in,sentences,1,\n", "line 2: the part is `sentences`"),
        ("ada,fill_in,words,3,\n", "line 2: `3` is no number of points from 0 to 2"),
        ("ada,null_space,words,1,\n", "line 2: `1` is no number of points from 0 to 0"),
        ("ada,bearing,words,1,\n", "line 2: `1` is no number of points from 0 to 0"),
        ("ada,bearing,program,1,\n", "line 2: `bearing` is a chapter and has no program"),
        ("ada,fill_in,program,-1,\n", "line 2: `-1` is no number of points from 0 to 10"),
        ("ada,fill_in,program,NaN,\n", "line 2: `NaN` is no number"),
        ("ada,fill_in,words,1,\nada,fill_in,words,2,\n", "line 3: the same was marked"),
    ] {
        let sentence = error(&format!("{heading}{rows}"));
        assert!(sentence.starts_with(said), "{sentence}");
    }
    assert!(error("folder,exercise\n").starts_with("line 1: there is no column `part`"));
    let semicolons = "folder;exercise;part;points;comment\n'=ada;fill_in;words;1,5;well\n";
    Marks::parse(semicolons, &points).expect("marks of a spreadsheet");
}
