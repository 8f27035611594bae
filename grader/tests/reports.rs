//! Reports of grades that nobody earned, with texts that wish them ill.

mod made_up;

use exercise_spec::EXERCISES;
use grader::changes::Changes;
use grader::grade::{Grade, Outcome, Verdict, WordsGrade};
use grader::items::{Correlation, Items};
use grader::report::gradebook::Gradebook;
use grader::report::markdown::{self, Summary, escaped};
use grader::report::terminal::Terminal;
use grader::report::{COULD_NOT_GRADE, Detail, gradescope, junit, points};
use grader::roster::Differences;
use made_up::{HOSTILE, check, every_kind, every_kind_graded, exercise, grade, hostile};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus};
use serde_json::Value;

/// A text of which a report may hold a part.
fn huge() -> String {
    "long `|<]]> ".repeat(100_000)
}

fn texts() -> Vec<String> {
    HOSTILE.iter().map(|text| (*text).to_owned()).chain([huge(), String::new()]).collect()
}

fn harmless(report: &str) -> bool {
    let bad = |letter: char| {
        (letter.is_control() && letter != '\n')
            || matches!(letter, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
    };
    !report.contains(bad)
}

fn terminal(grades: &[Grade]) -> String {
    let mut table = Terminal::new(EXERCISES);
    grades.iter().for_each(|grade| table.add(grade));
    table.finish("7", "Nothing was compiled.", &Differences::default())
}

fn summary(grades: &[Grade]) -> String {
    let mut summary = Summary::new(EXERCISES);
    grades.iter().for_each(|grade| summary.add(grade));
    summary.finish("7", "Nothing was compiled.", &Differences::default())
}

fn gradebook(grades: &[Grade]) -> Vec<Vec<String>> {
    let mut bytes = Vec::new();
    let mut book = Gradebook::new(&mut bytes, EXERCISES, &["fill_in"], &[]).expect("a gradebook");
    grades.iter().for_each(|grade| book.add(grade, "folder;=1+1", &[]).expect("a line"));
    book.add_absent("=gone", "@gone", &[]).expect("a line");
    book.finish().expect("an end");
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(&*bytes);
    let row = |row: csv::StringRecord| row.iter().map(str::to_owned).collect();
    reader.records().map(|record| row(record.expect("a line of the same length"))).collect()
}

fn gradescope(grade: &Grade, detail: Detail) -> Value {
    serde_json::from_str(&gradescope::json(grade, detail)).expect("JSON")
}

fn cases(grade: &Grade, detail: Detail) -> Vec<TestCase> {
    let xml = junit::xml(grade, detail).expect("XML");
    let mut report = Report::deserialize_from_str(&xml).expect("JUnit");
    assert_eq!(report.test_suites.len(), 1);
    report.test_suites.remove(0).test_cases
}

fn items(grades: &[Grade]) -> String {
    let mut items = Items::new(EXERCISES);
    grades.iter().for_each(|grade| items.add(grade));
    items.markdown()
}

// What could not be graded is no zero.

#[test]
fn the_gradebook_leaves_empty_what_could_not_be_graded() {
    let rows = gradebook(&[every_kind("ada"), every_kind_graded("brook")]);
    assert_eq!(rows[0][..5], ["submission", "student", "points", "of", "left_perturbation"]);
    assert_eq!(rows[1][..11], ["ada", "", "", "70", "10", "3.333", "0", "0", "0", "", ""]);
    let open = format!("could not be graded: {} {}", EXERCISES[5].slug, EXERCISES[6].slug);
    assert_eq!(rows[1].last(), Some(&open));
    assert_eq!(rows[2][..5], ["brook", "", "13.333", "50", "10"]);
    assert_eq!(rows[2].last().map(String::as_str), Some("graded"));
    assert_eq!(rows[3][0..4], ["'=gone", "'@gone", "", ""]);
    assert_eq!(rows[3].last().map(String::as_str), Some("nothing handed in"));
}

#[test]
fn gradescope_gets_no_score_at_all_when_something_could_not_be_graded() {
    let results = gradescope(&every_kind("ada"), Detail::Full);
    assert_eq!(results.get("score"), None);
    let tests = results["tests"].as_array().expect("tests");
    assert!(
        tests.iter().all(|test| test.get("score").is_none() && test.get("max_score").is_none())
    );
    let output = results["output"].as_str().expect("an output");
    assert!(output.contains(COULD_NOT_GRADE), "{output}");
    assert!(output.contains("3.333 of 10 points"), "{output}");
    let open: Vec<&Value> = tests.iter().filter(|test| test.get("status").is_none()).collect();
    assert_eq!(open.len(), 2);
    assert!(open.iter().all(|test| test["output"] == COULD_NOT_GRADE), "{open:?}");
}

#[test]
fn gradescope_gets_the_score_and_its_parts() {
    let results = gradescope(&every_kind_graded("ada"), Detail::Full);
    let score = results["score"].as_f64().expect("a score");
    let tests = results["tests"].as_array().expect("tests");
    let sum: f64 = tests.iter().filter_map(|test| test["score"].as_f64()).sum();
    let most: f64 = tests.iter().filter_map(|test| test["max_score"].as_f64()).sum();
    assert!((score - 40.0 / 3.0).abs() < 1e-9 && (sum - score).abs() < 1e-9, "{score} {sum}");
    assert!((most - 50.0).abs() < 1e-9, "{most}");
    for format in ["output_format", "test_output_format", "test_name_format"] {
        assert_eq!(results[format], "text", "or names are read as HTML");
    }
}

fn kind(case: &TestCase) -> Option<NonSuccessKind> {
    match &case.status {
        TestCaseStatus::NonSuccess { kind, .. } => Some(*kind),
        _ => None,
    }
}

#[test]
fn junit_calls_an_error_what_could_not_be_graded_and_a_failure_what_is_wrong() {
    let cases = cases(&every_kind("ada"), Detail::Hint);
    let of = |index: usize| -> Vec<Option<NonSuccessKind>> {
        let class = format!("ada.{}", EXERCISES[index].slug);
        let of = |case: &&TestCase| case.classname.as_ref().is_some_and(|c| c.as_str() == class);
        cases.iter().filter(of).map(kind).collect()
    };
    use NonSuccessKind::{Error, Failure};
    assert_eq!(of(0), [None, None]);
    assert_eq!(of(1), [Some(Failure), Some(Failure), None]);
    for index in [2, 3, 4] {
        assert_eq!(of(index), [Some(Failure)], "{}", EXERCISES[index].slug);
    }
    assert_eq!(of(5), [Some(Error)]);
    assert_eq!(of(6), [None, Some(Error)]);
}

#[test]
fn junit_names_every_case_once_and_every_failure_has_a_text() {
    for detail in [Detail::Full, Detail::Hint, Detail::None] {
        let mut grade = every_kind("ada");
        grade.exercises[1].checks.iter_mut().for_each(|check| check.name = "same".to_owned());
        grade.exercises[1].checks.truncate(2);
        let cases = cases(&grade, detail);
        let mut names: Vec<(String, String)> = cases
            .iter()
            .map(|case| (format!("{:?}", case.classname), case.name.as_str().to_owned()))
            .collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
        for case in &cases {
            if let TestCaseStatus::NonSuccess { description, .. } = &case.status {
                assert!(description.as_ref().is_some_and(|text| !text.as_str().is_empty()));
            }
        }
    }
}

#[test]
fn the_junit_file_of_a_batch_has_a_suite_for_each_submission() {
    let mut bytes = Vec::new();
    let mut suites = junit::Suites::new(&mut bytes).expect("a file");
    for text in texts() {
        suites.add(&hostile(&text), Detail::Full).expect("a suite");
    }
    suites.finish().expect("an end");
    let text = String::from_utf8(bytes).expect("UTF-8");
    let report = Report::deserialize_from_str(&text).expect("JUnit");
    assert_eq!(report.test_suites.len(), texts().len());
    assert!(report.test_suites.iter().all(|suite| suite.test_cases.len() == 11));
}

#[test]
fn tables_and_feedback_show_a_question_mark_or_open_for_what_could_not_be_graded() {
    let grades = [every_kind("ada"), every_kind_graded("brook")];
    let text = summary(&grades);
    assert!(text.contains("| ada | ? | 10 | 3.333 | - | r | c | ? | ? |"), "{text}");
    let open = format!("- ada, `{}`: there is no compiler", EXERCISES[5].slug);
    assert!(text.contains(&open), "{text}");
    let text = terminal(&grades);
    let line = text.lines().find(|line| line.starts_with("ada")).expect("a line");
    assert_eq!(
        line.split_whitespace().collect::<Vec<_>>(),
        ["ada", "?", "10", "3.333", "-", "r", "c", "?", "?"]
    );
    let text = markdown::feedback(&grades[0], Detail::Full);
    assert!(text.contains("Not graded in full") && text.contains("open of 10"), "{text}");
    assert!(!text.contains("there is no compiler"), "the reason is for the instructor");
}

#[test]
fn item_analysis_counts_what_could_not_be_graded_as_neither_right_nor_wrong() {
    let text = items(&vec![every_kind("ada"); 3]);
    assert!(text.contains("| 0 | 0 | 0 | 0 | 0 | 3 |  |"), "{text}");
    assert!(text.contains("| skew sign | 3 |"), "{text}");
}

/// A grade with points for words, and one without.
fn with_and_without_words() -> [Grade; 2] {
    let right = vec![check("a", false, Verdict::Passed)];
    let grades =
        ["ada", "brook"].map(|name| grade(name, vec![exercise(0, Outcome::Ran, right.clone())]));
    let [mut with, without] = grades;
    with.exercises[0].words = Some(WordsGrade { of: 2.0, earned: 2.0 });
    [with, without]
}

#[test]
fn item_analysis_is_about_programs() {
    let text = items(&with_and_without_words());
    assert!(text.contains("| 2 | 0 | 0 | 0 | 0 | 0 | 10 of 10 |"), "{text}");
}

#[test]
fn tables_are_of_the_most_that_anybody_can_earn() {
    let grades = with_and_without_words();
    assert!(terminal(&grades).contains("of 12"), "{}", terminal(&grades));
    assert!(summary(&grades).contains("of 12"), "{}", summary(&grades));
}

// What students are told.

#[test]
fn gradescope_shows_what_a_person_says_of_an_answer_that_never_ran() {
    for outcome in [Outcome::Missing, Outcome::DoesNotCompile("error".to_owned())] {
        for marked in [None, Some(3.0)] {
            let mut exercise = exercise(0, outcome.clone(), vec![]);
            exercise.comments = vec!["Come and see me.".to_owned()];
            exercise.words = Some(WordsGrade { of: 2.0, earned: 1.5 });
            exercise.marked = marked;
            let shown = gradescope(&grade("ada", vec![exercise]), Detail::Full);
            assert!(shown.to_string().contains("Come and see me."), "{shown}");
            let tests = shown["tests"].as_array().expect("tests");
            let sum = |of: &str| tests.iter().filter_map(|test| test[of].as_f64()).sum::<f64>();
            assert_eq!(shown["score"].as_f64(), Some(sum("score")), "{shown}");
            assert_eq!(sum("max_score"), 12.0, "{shown}");
        }
    }
}

#[test]
fn points_of_a_person_are_not_contradicted() {
    for outcome in [
        Outcome::Missing,
        Outcome::NotBegun,
        Outcome::Refused("unsafe".to_owned()),
        Outcome::DoesNotCompile("error".to_owned()),
        Outcome::CouldNotGrade("no compiler".to_owned()),
    ] {
        let mut exercise = exercise(0, outcome, vec![]);
        exercise.marked = Some(10.0);
        let grade = grade("ada", vec![exercise]);
        let shown = gradescope(&grade, Detail::Full);
        assert_uncontradicted(&grade);
        assert!(shown["tests"][0].get("status").is_none(), "{shown}");
    }
    let open = check("open", false, Verdict::CouldNotGrade);
    let mut exercise = exercise(0, Outcome::Ran, vec![open]);
    exercise.marked = Some(7.0);
    assert_uncontradicted(&grade("ada", vec![exercise]));
}

/// That no report says of what a person has marked that it earns nothing, or that its points are open.
fn assert_uncontradicted(grade: &Grade) {
    let told = [
        gradescope::json(grade, Detail::Full),
        markdown::feedback(grade, Detail::Full),
        junit::xml(grade, Detail::Full).expect("XML"),
    ];
    for text in told {
        for said in ["earns nothing", "will look at it", "are open"] {
            assert!(!text.contains(said), "{said}: {text}");
        }
    }
}

#[test]
fn detail_decides_what_students_read_of_hidden_checks_and_of_no_other() {
    let mut grade = grade("ada", vec![exercise(0, Outcome::Ran, vec![])]);
    for hidden in [false, true] {
        let mut check = check(if hidden { "deep" } else { "open" }, hidden, Verdict::Failed);
        check.sentence = format!("sentence that is {hidden}");
        check.numbers = format!("number {hidden}");
        grade.exercises[0].checks.push(check);
    }
    for (detail, sentence, number) in
        [(Detail::Full, true, true), (Detail::Hint, true, false), (Detail::None, false, false)]
    {
        let junit = junit::xml(&grade, detail).expect("XML");
        let reports = [markdown::feedback(&grade, detail), gradescope::json(&grade, detail), junit];
        for report in reports {
            assert!(
                report.contains("Sentence that is false") && report.contains("number false"),
                "{report}"
            );
            assert_eq!(report.contains("Sentence that is true"), sentence, "{detail:?} {report}");
            assert_eq!(report.contains("number true"), number, "{detail:?} {report}");
            assert!(report.contains("deep"), "that it failed is always told: {report}");
        }
    }
}

#[test]
fn feedback_shows_the_pictures_of_public_checks_and_hidden_ones_in_full_only() {
    let mut grade = grade("ada", vec![exercise(0, Outcome::Ran, vec![])]);
    for (name, hidden) in [("open", false), ("deep", true)] {
        grade.exercises[0].checks.push(check(name, hidden, Verdict::Failed));
    }
    grade.exercises[0].checks.push(check("right", false, Verdict::Passed));
    for check in &mut grade.exercises[0].checks {
        check.picture = Some("<svg/>".to_owned());
    }
    let slug = grade.exercises[0].exercise.clone();
    for detail in [Detail::Full, Detail::Hint, Detail::None] {
        let report = markdown::feedback(&grade, detail);
        let shows = |name: &str| report.contains(&format!("]({slug}-{name}.svg)"));
        assert!(shows("open") && !shows("right"), "{report}");
        assert_eq!(shows("deep"), detail == Detail::Full, "{report}");
    }
}

#[test]
fn a_hint_about_a_hidden_check_repeats_nothing_of_the_answer() {
    let mut panicked = check("deep", true, Verdict::Failed);
    panicked.sentence = "the answer panicked: fx 843.0307".to_owned();
    panicked.quiet = Some("the answer panicked".to_owned());
    let mut returned = check("deeper", true, Verdict::Failed);
    returned.sentence =
        "It is 0.8430307e3 and not 12: 43×3 numbers came back. See x0 of camera 0.".to_owned();
    returned.misconception = None;
    let mut stopped = check("deepest", true, Verdict::Failed);
    stopped.misconception = None;
    stopped.sentence = "the call was stopped: it took more than 4000 million steps.".to_owned();
    let checks = vec![panicked, returned, stopped];
    let grade = grade("ada", vec![exercise(0, Outcome::Ran, checks)]);
    for (detail, told) in [(Detail::Full, true), (Detail::Hint, false)] {
        let junit = junit::xml(&grade, detail).expect("XML");
        let reports = [markdown::feedback(&grade, detail), gradescope::json(&grade, detail), junit];
        for report in reports {
            assert_eq!(report.contains("843"), told, "{detail:?} {report}");
            assert!(report.contains("The answer panicked"), "{report}");
            assert_eq!(report.contains("43×3"), told, "{detail:?} {report}");
            let hint = "It is … and not …: …×… numbers came back. See x0 of camera ….";
            assert_eq!(report.contains(hint), !told, "{detail:?} {report}");
            assert!(report.contains("it took more than 4000 million steps."), "{report}");
        }
    }
}

// Texts that wish a report ill.

#[test]
fn the_terminal_gets_no_escape_and_no_line_of_more_than_eighty_columns() {
    for text in texts() {
        for grades in [vec![hostile(&text)], vec![hostile(&text), every_kind(&text)]] {
            let shown = terminal(&grades);
            assert!(harmless(&shown), "{shown:?}");
            // Words that are longer than the terminal stay whole; these texts have none.
            for line in shown.lines() {
                let wide =
                    line.chars().filter(|letter| ('\u{2e80}'..'\u{ffef}').contains(letter)).count();
                assert!(line.chars().count() + wide <= 80, "{} {line}", line.chars().count());
            }
            assert!(shown.len() < 40_000, "{}", shown.len());
        }
    }
}

/// Whether every mark of Markdown outside of blocks of code is escaped.
fn is_plain(text: &str) -> Result<(), String> {
    let mut fence: Option<String> = None;
    for line in text.lines() {
        let marks: String = line.trim_start().chars().take_while(|mark| *mark == '`').collect();
        match &fence {
            Some(open) if line.trim() == open => fence = None,
            Some(_) => {}
            None if marks.len() >= 3 => fence = Some(marks),
            None => {
                let line = line.replace("\\\\", "").replace("<br>", "");
                let letters: Vec<char> = line.chars().collect();
                let bare = |mark: char| {
                    (0..letters.len())
                        .any(|at| letters[at] == mark && (at == 0 || letters[at - 1] != '\\'))
                };
                if ['<', '[', ']', '$', '@', '~', '&'].iter().any(|mark| bare(*mark)) {
                    return Err(line);
                }
                if line.contains("https:/") || line.to_lowercase().contains("www.e") {
                    return Err(line);
                }
            }
        }
    }
    fence.map_or(Ok(()), |fence| Err(format!("a block {fence} does not end")))
}

#[test]
fn markdown_takes_every_text_as_text() {
    for text in texts() {
        let hostile = hostile(&text);
        let mut changes = Changes::default();
        changes.add(Some(&every_kind_graded(&text)), &hostile);
        changes.add(None, &hostile);
        let reports = [
            markdown::feedback(&hostile, Detail::Full),
            summary(&[hostile.clone(), every_kind(&text)]),
            items(std::slice::from_ref(&hostile)),
            changes.markdown("7", "8"),
        ];
        for report in reports {
            assert!(harmless(&report), "{report:?}");
            assert_eq!(is_plain(&report), Ok(()), "{report}");
            assert!(report.len() < 100_000, "{}", report.len());
        }
    }
}

#[test]
fn a_table_of_markdown_has_as_many_cells_in_each_line_whatever_stands_in_it() {
    for text in texts() {
        let report = summary(&[hostile(&text), every_kind(&text)]);
        let cells = |line: &str| line.replace("\\\\", "").replace("\\|", "").matches('|').count();
        let counts: Vec<usize> =
            report.lines().filter(|line| line.starts_with('|')).map(cells).collect();
        assert_eq!(counts, [EXERCISES.len() + 3; 4], "{report}");
    }
}

#[test]
fn text_begins_no_list_no_heading_and_no_quote() {
    for text in ["- item", "+ item", "1. item", "2024) item", "# heading", "> quote", "=== ", "---"]
    {
        let mut grade = every_kind("ada");
        grade.notices = vec![text.to_owned()];
        let report = markdown::feedback(&grade, Detail::Full);
        assert!(!report.lines().any(|line| line.trim() == text.trim()), "{report}");
    }
    assert_eq!(escaped("T exp(ξ) = exp(η) T: which?", 100), "T exp(ξ) = exp(η) T: which?");
}

#[test]
fn xml_takes_every_text_as_text() {
    for text in texts() {
        let grade = hostile(&text);
        let xml = junit::xml(&grade, Detail::Full).expect("XML");
        // What the standard lets no XML hold, and the parser below does not look at.
        let none = |letter: char| {
            (letter.is_control() && letter != '\n') || matches!(letter, '\u{fffe}' | '\u{ffff}')
        };
        assert!(!xml.contains(none), "{xml:?}");
        assert!(xml.len() < 400_000, "{}", xml.len());
        let cases = cases(&grade, Detail::Full);
        assert_eq!(cases.len(), 11, "{text:?}");
        let failed = cases.iter().filter(|case| kind(case).is_some()).count();
        assert_eq!(failed, 7, "a text makes no case pass: {text:?}");
    }
}

#[test]
fn no_cell_of_the_gradebook_is_a_formula() {
    for text in texts() {
        let rows = gradebook(&[hostile(&text), every_kind(&text)]);
        assert_eq!(rows.len(), 4);
        for cell in rows.iter().flatten() {
            assert!(!cell.trim_start().starts_with(['=', '+', '-', '@', '|', '%']), "{cell:?}");
            assert!(!cell.contains(";=") && !cell.contains("; ="), "{cell:?}");
            assert!(harmless(cell) && !cell.contains('\n'), "{cell:?}");
            assert!(cell.len() < 400, "{}", cell.len());
        }
    }
}

#[test]
fn gradescope_takes_every_text_as_text_and_no_text_makes_a_score() {
    for text in texts() {
        let json = gradescope::json(&hostile(&text), Detail::Full);
        assert!(json.len() < 200_000, "{}", json.len());
        let results: Value = serde_json::from_str(&json).expect("JSON");
        assert_eq!(results.get("score"), None);
        let tests = results["tests"].as_array().expect("tests");
        let strings = tests.iter().flat_map(|test| [&test["name"], &test["output"]]);
        for string in strings.chain([&results["output"]]) {
            assert!(harmless(string.as_str().expect("text")), "{string}");
        }
    }
}

// Numbers.

#[test]
fn a_correlation_is_told_where_there_are_enough_and_both_vary() {
    let of = |count: usize, y: fn(f64) -> f64| {
        let mut correlation = Correlation::default();
        (0..count).for_each(|x| correlation.add(x as f64, y(x as f64)));
        correlation.value()
    };
    assert!((of(10, |x| 2.0 * x + 1.0).expect("a value") - 1.0).abs() < 1e-12);
    assert!((of(10, |x| -x).expect("a value") + 1.0).abs() < 1e-12);
    assert_eq!(of(9, |x| x), None);
    assert_eq!(of(20, |_| 3.0), None);
}

#[test]
fn changes_name_the_checks_that_came_out_otherwise() {
    let before = every_kind_graded("ada");
    let mut after = before.clone();
    after.exercises[1].checks[0] = check("a", false, Verdict::Passed);
    after.exercises[2].outcome = Outcome::DoesNotCompile(String::new());
    let mut changes = Changes::default();
    changes.add(Some(&before), &after);
    changes.add(Some(&before), &before);
    let text = changes.markdown("7", "7");
    assert!(text.contains("1 grade as before, 1 otherwise"), "{text}");
    assert!(
        text.contains("| ada | 13.333 | 16.667 | `along_or_across`: 3.333 → 6.667; a passes<br>"),
        "{text}"
    );
    let third = format!("`{}`: 0 → 0, no file → does not compile", EXERCISES[2].slug);
    assert!(text.contains(&third), "{text}");
    assert!(!text.contains("seed"), "{text}");
}

#[test]
fn a_number_of_points_is_the_same_everywhere_and_halves_go_away_from_zero() {
    let cases = [(4.125, "4.125"), (0.0625, "0.063"), (-0.0625, "-0.063"), (10.0, "10")];
    for (number, shown) in cases.into_iter().chain([(100.0, "100"), (-0.0, "0"), (2.5, "2.5")]) {
        assert_eq!(points(number), shown);
    }
    let mut checks = vec![check("a", false, Verdict::Passed); 2];
    checks[0].weight = 4.125;
    checks[1].weight = 5.875;
    checks[1].verdict = Verdict::Failed;
    let grades = vec![grade("ada", vec![exercise(0, Outcome::Ran, checks)]); 2];
    let shown = terminal(&grades);
    let row: Vec<&str> = shown.lines().nth(2).expect("a row").split_whitespace().collect();
    assert_eq!(row, ["ada", "4.125", "4.125"], "{shown}");
    assert!(summary(&grades).contains("| ada | 4.125 | 4.125 |"));
    assert!(markdown::feedback(&grades[0], Detail::Full).contains("**4.125 of 10 points.**"));
    assert_eq!(gradebook(&grades)[1][2..5], ["4.125", "10", "4.125"]);
}

#[test]
fn an_untouched_skeleton_is_no_attempt_and_has_one_line() {
    let grades = vec![grade("ada", vec![exercise(0, Outcome::NotBegun, vec![])]); 2];
    assert_eq!(grades[0].earned(), Some(0.0));
    let row = "| Which side does the perturbation go on | 0 | 0 | 0 | 0 | 2 | 0 |  |";
    let text = items(&grades);
    assert!(
        text.contains(&row.replace("Which side does the perturbation go on", EXERCISES[0].title)),
        "{text}"
    );
    let text = markdown::feedback(&grades[0], Detail::Full);
    assert!(text.contains("| 0 of 10 | not begun |") && !text.contains("##"), "{text}");
    assert!(summary(&grades).contains("| ada | 0 | n |"));
    let row = gradebook(&grades).swap_remove(1);
    assert_eq!(row.last().map(String::as_str), Some("graded: no answer was begun"));
    assert_eq!(cases(&grades[0], Detail::Full).len(), 1);
    let text = gradescope::json(&grades[0], Detail::Full);
    assert!(text.contains("The file is as it was handed out"), "{text}");
}

#[test]
fn means_have_names_and_a_few_submissions_no_discrimination() {
    let few = vec![every_kind_graded("ada"); 9];
    assert!(terminal(&few).contains("\nmean of all "), "{}", terminal(&few));
    let text = items(&few);
    assert!(text.contains("| Mean of those handed in |\n"), "{text}");
    assert!(!text.contains("Discrimination"), "{text}");
    assert!(text.contains("| `a` | public | 100 % (9 of 9) |\n"), "{text}");
    let text = items(&vec![every_kind_graded("ada"); 10]);
    assert!(text.contains("| Mean of those handed in | Discrimination |\n"), "{text}");
    assert!(text.contains("| `a` | public | 100 % (10 of 10) |  |\n"), "{text}");
}

#[test]
fn the_terminal_keeps_its_heading_and_each_number_in_one_line() {
    let of = |points: f64| {
        let check = || vec![check("a", false, Verdict::Passed), check("b", true, Verdict::Failed)];
        let exercises = (0..EXERCISES.len()).map(|at| {
            let mut exercise = exercise(at, Outcome::Ran, check());
            exercise.points = points;
            exercise
        });
        vec![grade("Somebody with a name of many words", exercises.collect()); 2]
    };
    for (each, half) in [(10.5, "5.25"), (10.55, "5.275"), (100.25, "50.125")] {
        let shown = terminal(&of(each));
        let lines: Vec<Vec<&str>> =
            shown.lines().map(|line| line.split_whitespace().collect()).collect();
        assert_eq!(lines[0][..2], ["Submission", "of"], "{shown}");
        // Both submissions and the mean have every number.
        let cells = || lines.iter().flatten();
        assert_eq!(cells().filter(|cell| **cell == half).count(), 3 * EXERCISES.len(), "{shown}");
        let total = points(0.5 * each * EXERCISES.len() as f64);
        assert_eq!(cells().filter(|cell| **cell == total).count(), 3, "{shown}");
        let headings = lines.iter().filter(|line| line.first() == Some(&"Submission"));
        let numbered: Vec<&str> = headings.flat_map(|line| line[1..].to_vec()).collect();
        let numbers = (1..=EXERCISES.len()).map(|number| number.to_string());
        assert!(numbered[1..].iter().eq(&numbers.collect::<Vec<_>>()), "{shown}");
        assert!(shown.lines().all(|line| line.chars().count() <= 80), "{shown}");
    }
}

#[test]
fn submissions_without_an_answer_are_listed() {
    let mut grades = vec![every_kind_graded("ada"), every_kind_graded("brook")];
    grades[1].exercises.iter_mut().for_each(|exercise| exercise.outcome = Outcome::Missing);
    assert!(terminal(&grades).contains("\nNo answer found in:\n  brook\n"));
}

#[test]
fn a_reason_that_all_exercises_have_stands_once() {
    let why = || Outcome::CouldNotGrade("unpack it".to_owned());
    let all = (0..3).map(|at| exercise(at, why(), vec![])).collect();
    let shown = terminal(&[grade("ada", all), every_kind_graded("brook")]);
    assert_eq!(shown.matches("unpack it").count(), 1, "{shown}");
    assert!(shown.contains("\n  ada: unpack it\n"), "{shown}");
}
