//! Batches with a judge that needs no compiler: what is kept, what goes on, and what is told.

mod made_up;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::Ordering;

use grader::batch::{Finished, Order, Trouble, carry_out_with};
use grader::grade::{Batch, Grade};
use grader::seed::Seed;
use grader::submission::has_answers;
use made_up::{SEED, StandIn, hand_in, order, submissions};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn carry_out(order: &Order) -> Result<Finished, Trouble> {
    carry_out_with(order, |points, seed, exercises| Ok(StandIn::new(points, seed, exercises)))
}

/// The same, with how many submissions were graded.
fn counted(order: &Order) -> (Finished, usize) {
    let mut count = None;
    let finished = carry_out_with(order, |points, seed, exercises| {
        let judge = StandIn::new(points, seed, exercises);
        count = Some(judge.graded);
        Ok(judge)
    });
    (finished.expect("a batch"), count.expect("a judge").load(Ordering::SeqCst))
}

fn batch(out: &Path) -> Batch {
    serde_json::from_str(&read(out, "grade.json")).expect("a batch")
}

fn read(out: &Path, name: &str) -> String {
    fs::read_to_string(out.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Marks a batch as one that was stopped before its end.
fn unfinished(out: &Path) {
    let state = read(out, "batch.toml").replace("finished = true", "finished = false");
    fs::write(out.join("batch.toml"), state).expect("written");
}

fn usage(order: &Order) -> String {
    match carry_out(order) {
        Err(Trouble::Usage(sentence)) => sentence,
        other => panic!("no trouble of usage: {other:?}"),
    }
}

fn names(batch: &Batch) -> Vec<&str> {
    batch.grades.iter().map(|grade| grade.submission.as_str()).collect()
}

/// Another seed than that of orders.
const OTHER: Seed = Seed::new(u128::MAX);

const THREE: &[(&str, &str)] = &[("cem", "right"), ("ada", "one"), ("brook", "two")];

#[test]
fn every_submission_gets_a_grade_and_its_reports_in_the_order_of_names() {
    let temporary = folder();
    let out = temporary.path().join("grades");
    let finished = carry_out(&order(&submissions(temporary.path(), THREE), &out)).expect("a batch");
    assert_eq!((finished.graded, finished.ungraded, finished.seed), (3, 0, SEED));
    let batch = batch(&out);
    assert_eq!(names(&batch), ["ada", "brook", "cem"]);
    assert_eq!(
        (batch.instances.clone(), batch.sandbox.as_str()),
        (SEED.mark(), "Nothing was compiled.")
    );
    assert_eq!(batch.grades[2].earned(), Some(20.0));
    for name in ["summary.md", "gradebook.csv", "items.md", "similarity.md", "junit.xml"] {
        assert!(!read(&out, name).is_empty(), "{name}");
    }
    for name in names(&batch) {
        for report in ["grade.json", "feedback.md", "results.json", "junit.xml"] {
            assert!(!read(&out, &format!("submissions/{name}/{report}")).is_empty(), "{report}");
        }
    }
    assert!(!out.join("changes.md").exists(), "nothing was graded again");
    assert!(finished.told.contains("cem"), "{}", finished.told);
}

#[test]
fn the_same_seed_gives_the_same_grades_and_another_one_others() {
    let temporary = folder();
    let answers: Vec<(String, String)> =
        (0..20).map(|number| (format!("s{number}"), format!("answer {number}"))).collect();
    let answers: Vec<(&str, &str)> =
        answers.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    let path = submissions(temporary.path(), &answers);
    let texts = [7, 7, 8].map(|number| {
        let seed = Seed::new(number);
        let out = tempfile::tempdir_in(temporary.path()).expect("a folder");
        let order = Order { seed: Some(seed), ..order(&path, out.path()) };
        carry_out(&order).expect("a batch");
        let text = read(out.path(), "grade.json");
        text.replace(&seed.mark(), "any")
    });
    assert_eq!(texts[0], texts[1]);
    assert_ne!(texts[0], texts[2]);
}

#[test]
fn a_seed_that_nobody_gave_is_named_and_used_again() {
    let temporary = folder();
    let out = temporary.path().join("grades");
    let order = Order { seed: None, ..order(&submissions(temporary.path(), THREE), &out) };
    let first = carry_out(&order).expect("a batch");
    assert!(
        first.told.contains(&format!("Hidden instances {}", first.seed.mark())),
        "{}",
        first.told
    );
    let (again, graded) = counted(&order);
    assert_eq!((again.seed, graded), (first.seed, 0));
}

const MANY: usize = 25;
const FOLDER: &str = "GRADER_TEST_ABORTED_BATCH";

/// Runs in a process of its own, which the judge ends after ten grades.
#[test]
#[ignore = "started by the test of killed batches"]
fn a_batch_that_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else {
        return;
    };
    let folder = Path::new(&folder);
    let order = order(&folder.join("submissions"), &folder.join("grades"));
    let finished = carry_out_with(&Order { jobs: Some(1), ..order }, |points, seed, exercises| {
        let judge = StandIn::new(points, seed, exercises);
        Ok(StandIn { log: Some(folder.join("log")), last: 10, ..judge })
    });
    finished.expect("a batch that came to its end");
}

/// Whether such a process comes to its end.
fn runs_in_another_process(folder: &Path) -> bool {
    let process = Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "a_batch_that_is_killed", "--ignored"])
        .env(FOLDER, folder)
        .output();
    process.expect("a process").status.success()
}

#[test]
fn a_killed_batch_goes_on_without_losing_or_repeating_a_grade() {
    let temporary = folder();
    for number in 0..MANY {
        let path = temporary.path().join("submissions");
        hand_in(&path, &format!("s{number:02}"), &format!("answer {number}"));
    }
    let out = temporary.path().join("grades");
    let kill = || {
        assert!(!runs_in_another_process(temporary.path()), "the process was not killed");
        assert!(!out.join("grade.json").exists(), "nothing is published before the end");
        fs::read_dir(out.join("submissions")).expect("grades").count()
    };
    let kept = [kill(), kill()];
    assert!(kept[0] >= 8 && kept[1] > kept[0], "{kept:?}");
    let order = Order { seed: None, ..order(&temporary.path().join("submissions"), &out) };
    let (finished, graded) = counted(&order);
    assert_eq!(finished.seed, SEED, "the seed is that of the beginning");
    assert_eq!(names(&batch(&out)).len(), MANY);
    // What was under way when the process was ended last is open; what was when it was ended first
    // has been tried again.
    assert_eq!((finished.graded, finished.ungraded), (MANY - 1, 1));
    let log = fs::read_to_string(temporary.path().join("log")).expect("a log");
    assert_eq!(log.lines().count() + graded, MANY - 1);
    assert_eq!(counted(&order).1, 1, "what is open is tried again by the next run");
    let whole = temporary.path().join("whole");
    carry_out(&Order { seed: Some(SEED), out: whole.clone(), ..order }).expect("a batch");
    assert_eq!(read(&whole, "grade.json"), read(&out, "grade.json"));
}

#[test]
fn a_submission_at_which_the_grader_died_is_open_and_blocks_nobody() {
    let temporary = folder();
    let answers = [("ada", "right"), ("brook", "abort"), ("cem", "right"), ("dana", "right")];
    let path = submissions(temporary.path(), &answers);
    let out = temporary.path().join("grades");
    let begun = |name: &str| {
        let log = fs::read_to_string(temporary.path().join("log")).expect("a log");
        log.lines().filter(|line| *line == name).count()
    };
    let run = || runs_in_another_process(temporary.path());
    assert!(!run(), "it dies");
    assert_eq!((begun("brook"), begun("cem")), (1, 0));
    assert!(run(), "it goes on");
    assert_eq!((begun("ada"), begun("brook"), begun("cem"), begun("dana")), (1, 1, 1, 1));
    let grades = batch(&out).grades;
    let earned: Vec<Option<f64>> = grades.iter().map(Grade::earned).collect();
    assert_eq!(earned, [Some(20.0), None, Some(20.0), Some(20.0)]);
    assert!(read(&out, "summary.md").contains("It is passed over this time"));
    assert!(!out.join(".begun").exists(), "nothing is under way");

    hand_in(&path, "eve", "right");
    assert!(!run(), "what is open is tried again");
    assert_eq!((begun("brook"), begun("eve")), (2, 1), "those who wait come first");
    hand_in(&path, "brook", "right");
    assert!(run(), "other answers are graded at once");
    assert_eq!(batch(&out).grades[1].earned(), Some(20.0));
}

#[test]
fn an_answer_that_changed_since_the_batch_was_killed_is_graded_as_it_is_now() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    carry_out(&order(&path, &out)).expect("a batch");
    unfinished(&out);
    hand_in(&path, "ada", "right");
    assert_eq!(counted(&order(&path, &out)).1, 1);
    assert_eq!(batch(&out).grades[0].earned(), Some(20.0));
}

#[test]
fn a_grade_that_was_cut_off_is_made_again() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    carry_out(&order(&path, &out)).expect("a batch");
    let whole = read(&out, "grade.json");
    fs::write(out.join("submissions/ada/grade.json"), "{\"submission\": \"ada\", ")
        .expect("written");
    fs::write(out.join("submissions/brook/grade.json.new"), "{").expect("written");
    assert_eq!(counted(&order(&path, &out)).1, 1);
    assert_eq!(whole, read(&out, "grade.json"));
}

#[test]
fn a_panic_costs_nobody_a_point_and_is_tried_again() {
    let temporary = folder();
    let path =
        submissions(temporary.path(), &[("ada", "right"), ("brook", "panic"), ("cem", "right")]);
    let out = temporary.path().join("grades");
    let finished = carry_out(&order(&path, &out)).expect("a batch");
    assert_eq!((finished.graded, finished.ungraded), (2, 1));
    let brook: Grade = batch(&out).grades.swap_remove(1);
    assert_eq!((brook.earned(), brook.exercises.len(), brook.points()), (None, 2, 20.0));
    let told: Vec<&str> = finished.told.split_whitespace().collect();
    assert!(told.join(" ").contains("a judge that panics"), "{}", finished.told);
    assert!(!read(&out, "submissions/brook/feedback.md").contains("a judge that panics"));
    hand_in(&path, "brook", "right");
    let (finished, graded) = counted(&order(&path, &out));
    assert_eq!((finished.ungraded, graded), (0, 1));
    assert!(
        read(&out, "changes.md").contains("| brook | ? | 20 |"),
        "{}",
        read(&out, "changes.md")
    );
}

#[test]
fn a_panic_when_a_submission_is_read_again_keeps_no_report_back() {
    let temporary = folder();
    let path = submissions(temporary.path(), &[("ada", "right"), ("brook", "later")]);
    let out = temporary.path().join("grades");
    let finished = carry_out(&order(&path, &out)).expect("a batch");
    assert_eq!((finished.graded, finished.ungraded), (2, 0));
    assert_eq!(names(&batch(&out)), ["ada", "brook"]);
}

#[test]
fn what_could_not_be_graded_is_tried_again_though_nothing_changed() {
    let temporary = folder();
    let path = submissions(temporary.path(), &[("ada", "cannot"), ("brook", "right")]);
    let out = temporary.path().join("grades");
    assert_eq!(counted(&order(&path, &out)).1, 2);
    assert_eq!(counted(&order(&path, &out)).1, 1);
}

fn with_wrong_canaries(order: &Order) -> Result<Finished, Trouble> {
    carry_out_with(order, |points, seed, exercises| {
        let canaries = Err("the reference earns 3 of 10".to_owned());
        Ok(StandIn { canaries, ..StandIn::new(points, seed, exercises) })
    })
}

#[test]
fn nothing_is_published_when_the_canaries_come_out_wrong() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    let Err(Trouble::CouldNotGrade(sentence)) = with_wrong_canaries(&order(&path, &out)) else {
        panic!("grades were published");
    };
    assert!(sentence.contains("nothing published: the reference earns 3 of 10"), "{sentence}");
    let files = fs::read_dir(&out).expect("a folder").flatten();
    assert_eq!(files.map(|file| file.file_name()).collect::<Vec<_>>(), [".lock"]);
    carry_out(&order(&path, &out)).expect("the folder can be used afterwards");
}

#[test]
fn wrong_canaries_leave_a_finished_batch_as_it_is() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    carry_out(&order(&path, &out)).expect("a batch");
    let names = ["grade.json", "gradebook.csv", "summary.md", "batch.toml"];
    let before = names.map(|name| read(&out, name));
    hand_in(&path, "ada", "right");
    assert!(with_wrong_canaries(&order(&path, &out)).is_err());
    assert_eq!(before, names.map(|name| read(&out, name)));
}

#[test]
fn a_regrade_tells_what_changed_and_grades_nothing_else_again() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    carry_out(&order(&path, &out)).expect("a batch");
    hand_in(&path, "brook", "right");
    hand_in(&path, "dana", "right");
    fs::remove_dir_all(path.join("cem")).expect("removed");
    let (finished, graded) = counted(&order(&path, &out));
    assert_eq!(graded, 2);
    let changes = read(&out, "changes.md");
    assert!(
        changes.contains("1 grade as before, 1 otherwise. 1 new. 1 of the former"),
        "{changes}"
    );
    assert!(changes.contains("| brook | ") && changes.contains(" | 20 | `left_perturbation`: "));
    assert!(changes.contains("- dana") && changes.contains("- cem"), "{changes}");
    assert!(!changes.contains("ada"), "{changes}");
    assert!(finished.told.contains("brook: "), "{}", finished.told);
    let (_, graded) = counted(&order(&path, &out));
    assert_eq!(graded, 0);
    assert!(read(&out, "changes.md").contains("3 grades as before, 0 otherwise"));
}

#[test]
fn a_regrade_with_another_seed_says_so() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    carry_out(&order(&path, &out)).expect("a batch");
    let (_, graded) = counted(&Order { seed: Some(OTHER), ..order(&path, &out) });
    assert_eq!((graded, batch(&out).instances), (3, OTHER.mark()));
    let said = format!("The hidden instances were {} and are {}", SEED.mark(), OTHER.mark());
    assert!(read(&out, "changes.md").contains(&said));
}

#[test]
fn a_batch_that_is_not_finished_takes_no_other_seed() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    carry_out(&order(&path, &out)).expect("a batch");
    unfinished(&out);
    let sentence = usage(&Order { seed: Some(OTHER), ..order(&path, &out) });
    assert!(sentence.contains("with another seed; leave --seed out"), "{sentence}");
}

#[test]
fn an_unknown_exercise_is_told_with_those_there_are() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let exercises = vec!["left_perturbation".to_owned(), "right\u{1b}[2J".to_owned()];
    let sentence = usage(&Order { exercises, ..order(&path, &temporary.path().join("grades")) });
    assert!(
        sentence
            .starts_with("there is no exercise `right\u{fffd}[2J`; there is left_perturbation, ")
    );
    let last = exercise_spec::EXERCISES.last().expect("there are exercises").slug;
    assert!(sentence.ends_with(last), "{sentence}");
    assert!(!temporary.path().join("grades").exists(), "nothing is made for an order that fails");
}

#[test]
fn no_exercise_is_every_exercise_in_the_order_of_the_book() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    carry_out(&Order { exercises: Vec::new(), ..order(&path, &out) }).expect("a batch");
    let batch = batch(&out);
    let slugs: Vec<&str> = batch.grades[0].exercises.iter().map(|e| e.exercise.as_str()).collect();
    let all: Vec<&str> = exercise_spec::EXERCISES.iter().map(|exercise| exercise.slug).collect();
    assert_eq!(slugs, all);
}

#[test]
fn orders_that_cannot_be_carried_out_say_what_to_do() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let good = order(&path, &temporary.path().join("grades"));
    assert!(usage(&Order { jobs: Some(0), ..good.clone() }).contains("--jobs 0"));
    let nowhere = temporary.path().join("nowhere");
    assert!(
        usage(&Order { submissions: vec![nowhere.clone()], ..good.clone() }).contains("nowhere")
    );
    assert!(usage(&Order { points: Some(nowhere.clone()), ..good.clone() }).contains("nowhere"));
    assert!(usage(&Order { roster: Some(nowhere), ..good.clone() }).contains("nowhere"));
    assert!(
        usage(&Order { out: path.clone(), ..good.clone() })
            .contains("is not empty and holds no batch")
    );
    let file = temporary.path().join("file");
    fs::write(&file, "").expect("written");
    for out in [file.clone(), file.join("below")] {
        let sentence = usage(&Order { out, ..good.clone() });
        assert!(sentence.ends_with("; name a folder with --out"), "{sentence}");
    }
    let empty = temporary.path().join("empty");
    fs::create_dir(&empty).expect("a folder");
    let sentence = usage(&Order { submissions: vec![empty], ..good });
    assert!(sentence.contains("empty: there is no submission in it"), "{sentence}");
}

#[test]
fn two_batches_do_not_write_to_one_folder() {
    let temporary = folder();
    let order = order(&submissions(temporary.path(), THREE), &temporary.path().join("grades"));
    carry_out_with(&order, |points, seed, exercises| {
        assert!(usage(&order).contains("another batch writes to"));
        Ok(StandIn::new(points, seed, exercises))
    })
    .expect("the first batch");
}

#[test]
fn grades_that_lie_among_the_submissions_are_no_submission() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let order = order(&path, &path.join("grades"));
    for _ in 0..2 {
        carry_out(&order).expect("a batch");
        assert_eq!(names(&batch(&order.out)), ["ada", "brook", "cem"]);
    }
}

#[test]
fn a_single_submission_has_its_feedback_in_the_summary() {
    let temporary = folder();
    let path = submissions(temporary.path(), &[("ada", "one"), ("brook", "two")]);
    let out = temporary.path().join("grades");
    let finished = carry_out(&order(&path.join("ada"), &out)).expect("a batch");
    assert_eq!(names(&batch(&out)), ["ada"]);
    assert!(read(&out, "summary.md").contains("# Feedback for ada"));
    assert!(finished.told.starts_with("ada: "), "{}", finished.told);
}

fn with_roster(folder: &Path, roster: &str) -> Order {
    let path = folder.join("roster.csv");
    fs::write(&path, roster).expect("written");
    Order { roster: Some(path), ..order(&submissions(folder, THREE), &folder.join("grades")) }
}

#[test]
fn a_roster_gives_names_and_tells_who_is_missing_on_either_side() {
    let temporary = folder();
    let roster = "\u{feff}name,folder\r\n\"Lovelace, Ada\",ada\r\n=Brook,brook\r\nDana,dana\r\n";
    let order = with_roster(temporary.path(), roster);
    let finished = carry_out(&order).expect("a batch");
    let batch = batch(&order.out);
    let students: Vec<Option<&str>> =
        batch.grades.iter().map(|grade| grade.student.as_deref()).collect();
    assert_eq!(students, [Some("Lovelace, Ada"), Some("=Brook"), None]);
    for text in [&finished.told, &read(&order.out, "summary.md")] {
        assert!(text.to_lowercase().contains("not on the roster"), "{text}");
        assert!(text.contains("cem") && text.contains("Dana (dana)"), "{text}");
    }
    let book = read(&order.out, "gradebook.csv");
    assert!(book.contains("ada,\"Lovelace, Ada\","), "{book}");
    assert!(book.contains("brook,'=Brook,"), "{book}");
    assert!(book.contains("dana,Dana,,,,,,,,,dana,nothing handed in"), "{book}");
}

#[test]
fn a_name_that_was_corrected_reaches_a_grade_that_is_kept() {
    let temporary = folder();
    let order = with_roster(temporary.path(), "folder,name\nada,Adda\nbrook,B\ncem,C\n");
    carry_out(&order).expect("a batch");
    let order = with_roster(temporary.path(), "folder,name\nada,Ada\nbrook,B\ncem,C\n");
    assert_eq!(counted(&order).1, 0);
    assert_eq!(batch(&order.out).grades[0].student.as_deref(), Some("Ada"));
}

#[test]
fn a_roster_with_mistakes_is_told_with_its_line() {
    let mistakes = [
        ("ada,Ada\n", "no column `folder`"),
        ("folder\nada\n", "no column `name`"),
        ("folder,name\nada,Ada\nada,Adda\n", "line 3: `ada` has a line already"),
        ("folder,name\n,Ada\n", "line 2: the folder is empty"),
        ("folder,name\nada,Ada,extra\n", "line: 2"),
        ("", "no column `folder`"),
    ];
    for (roster, said) in mistakes {
        let temporary = folder();
        let sentence = usage(&with_roster(temporary.path(), roster));
        assert!(sentence.contains(said), "{roster:?}: {sentence}");
    }
}

#[test]
fn grades_of_other_exercises_are_not_thrown_away() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    let two = order(&path, &out);
    carry_out(&two).expect("a batch");
    let before = read(&out, "grade.json");
    let one = Order { exercises: vec!["left_perturbation".to_owned()], ..two.clone() };
    let all = Order { exercises: Vec::new(), ..two.clone() };
    for order in [&one, &all] {
        let sentence = usage(order);
        let wanted = "grades holds grades of left_perturbation, along_or_across; grade the same \
                      exercises, or choose another --out";
        assert!(sentence.ends_with(wanted), "{sentence}");
    }
    unfinished(&out);
    usage(&one);
    assert_eq!(before, read(&out, "grade.json"));
    let swapped = two.exercises.iter().rev().cloned().collect();
    carry_out(&Order { exercises: swapped, ..two.clone() }).expect("the same exercises");
    let state = read(&out, "batch.toml");
    let old = state.lines().filter(|line| !line.starts_with("exercises")).collect::<Vec<_>>();
    assert!(old.len() + 1 == state.lines().count(), "{state}");
    fs::write(out.join("batch.toml"), old.join("\n")).expect("written");
    carry_out(&two).expect("a batch of a grader that did not write them down");
}

#[test]
fn a_batch_that_goes_on_tells_how_many_were_graded_already() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    let first = carry_out(&order(&path, &out)).expect("a batch");
    assert!(!first.told.contains("already"), "{}", first.told);
    unfinished(&out);
    hand_in(&path, "ada", "right");
    let told = carry_out(&order(&path, &out)).expect("a batch").told;
    assert!(told.contains("\n2 of 3 were graded already.\n"), "{told}");
}

#[test]
fn what_lies_in_no_answer_is_one_submission_when_it_is_called_single() {
    let temporary = folder();
    let path = submissions(temporary.path(), THREE);
    let out = temporary.path().join("grades");
    carry_out(&Order { single: true, ..order(&path, &out) }).expect("a batch");
    assert_eq!(names(&batch(&out)), ["submissions"]);
}

fn laid_out(folder: &Path, folders: &[&std::ffi::OsStr], roster: &str) -> Order {
    for name in folders {
        let path = folder.join("batch").join(name);
        fs::create_dir_all(&path).expect("a folder");
        fs::write(path.join("left_perturbation.rs"), "one").expect("an answer");
    }
    fs::write(folder.join("roster.csv"), roster).expect("written");
    let roster = Some(folder.join("roster.csv"));
    Order { roster, ..order(&folder.join("batch"), &folder.join("grades")) }
}

fn students(order: &Order) -> Vec<(String, Option<String>)> {
    carry_out(order).expect("a batch");
    let grades = batch(&order.out).grades.into_iter();
    grades.map(|grade| (grade.submission, grade.student)).collect()
}

#[cfg(target_os = "linux")]
#[test]
fn a_row_belongs_to_the_folder_it_names_and_not_to_a_name_that_was_made() {
    let temporary = folder();
    let folders = ["A", "a", "a-2"].map(std::ffi::OsStr::new);
    let order = laid_out(temporary.path(), &folders, "folder,name\nA,Big\na,Small\na-2,Third\n");
    let mut found: Vec<Option<String>> = Vec::new();
    let submissions = grader::submission::find(&order.submissions, has_answers).expect("found");
    let students = students(&order);
    for folder in folders {
        let name = &submissions.iter().find(|it| it.path.ends_with(folder)).expect("found").name;
        found.push(students.iter().find(|it| it.0 == *name).expect("a grade").1.clone());
    }
    assert_eq!(found.iter().flatten().collect::<Vec<_>>(), ["Big", "Small", "Third"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_row_that_several_folders_claim_belongs_to_none_and_is_told() {
    use std::os::unix::ffi::OsStrExt;
    let temporary = folder();
    let folders = [&b"a\xff"[..], b"a\xfe", "a\u{fffd}".as_bytes(), b"b"];
    let folders = folders.map(std::ffi::OsStr::from_bytes);
    let order = laid_out(temporary.path(), &folders, "folder,name\na\u{fffd},First\nb,B\n");
    let students = students(&order);
    assert_eq!(students.iter().filter(|it| it.1.is_some()).count(), 1, "{students:?}");
    let summary = read(&order.out, "summary.md");
    assert!(summary.contains("## Rows of the roster that are in doubt\n"), "{summary}");
    assert!(summary.contains("it is given to none of them"), "{summary}");
    assert!(!summary.contains("handed in nothing"), "{summary}");
}

#[test]
fn a_folder_that_differs_from_a_row_in_capitals_is_told() {
    let temporary = folder();
    let order = with_roster(temporary.path(), "folder,name\nAda,Ada\nbrook,B\ncem,C\n");
    let told = carry_out(&order).expect("a batch").told;
    assert!(told.contains("`Ada` differs in capitals from the folder ada"), "{told}");
    assert!(told.contains("Not on the roster:\n  ada\n"), "{told}");
    assert!(!told.contains("handed in nothing"), "{told}");
    assert!(!read(&order.out, "gradebook.csv").contains("nothing handed in"));
    assert_eq!(batch(&order.out).grades[0].student, None);
}

#[test]
fn a_roster_may_have_another_separator_and_more_columns() {
    for separator in [";", "\t", ","] {
        let temporary = folder();
        let roster = "number,folder,points,mail,name,\n1,ada,x,=a@b,Ada,\n2,dana,y,d@b,Dana,\n";
        let order = with_roster(temporary.path(), &roster.replace(',', separator));
        carry_out(&order).expect("a batch");
        let book = read(&order.out, "gradebook.csv");
        let heading = "submission,student,number,roster points,mail,points,of,left_perturbation,";
        assert!(book.starts_with(heading), "{book}");
        assert!(book.contains("\nada,Ada,1,x,'=a@b,"), "{book}");
        assert!(book.contains("\nbrook,,,,,"), "{book}");
        assert!(book.contains("\ndana,Dana,2,y,d@b,,,,,,,,,dana,nothing handed in\n"), "{book}");
    }
}

#[test]
fn a_roster_in_another_encoding_is_told_to_be_saved_as_utf_8() {
    let temporary = folder();
    let order = with_roster(temporary.path(), "");
    let wide = |mark: &[u8]| {
        let text = "folder,name\nada,Ada\n".encode_utf16().flat_map(u16::to_le_bytes);
        mark.iter().copied().chain(text).collect::<Vec<u8>>()
    };
    for bytes in [b"folder,name\nada,Zo\xeb\n".to_vec(), wide(b"\xff\xfe"), wide(b"")] {
        fs::write(order.roster.as_ref().expect("a roster"), bytes).expect("written");
        let sentence = usage(&order);
        assert!(sentence.contains("save it as UTF-8"), "{sentence}");
    }
}

#[test]
fn an_archive_is_matched_without_its_ending_and_cannot_be_graded() {
    let temporary = folder();
    let order = with_roster(temporary.path(), "folder,name\nada,Ada\nzoe,Zoe\nbrook,B\ncem,C\n");
    fs::write(order.submissions[0].join("zoe.tar.gz"), "").expect("written");
    carry_out(&order).expect("a batch");
    let last = batch(&order.out).grades.pop().expect("a grade");
    assert_eq!((last.submission.as_str(), last.student.as_deref()), ("zoe.tar.gz", Some("Zoe")));
    assert_eq!(last.earned(), None);
}

#[test]
fn a_seed_that_is_none_is_told_what_a_seed_is() {
    for seed in ["-1", "seven", "7", "18446744073709551616", "0123456789abcdef0123456789abcde "] {
        let run =
            Command::new(env!("CARGO_BIN_EXE_grade")).args(["run", ".", "--seed", seed]).output();
        let run = run.expect("the program");
        let said = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(2));
        assert!(said.contains("a seed has 32 digits from 0 to 9 and a to f"), "{said}");
    }
}
