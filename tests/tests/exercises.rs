//! Skeletons, reference answers and wrong ones against the public and the hidden checks.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use book_tests::hidden_checks;
use exercise_runner::folder::Folder;
use exercise_runner::{edition, selection};
use exercise_spec::answer::Transport;
use exercise_spec::check::{Check, Failure};
use exercise_spec::{CHAPTERS, EXERCISES, Exercise};
use quote::ToTokens;
use solutions::misconceptions::Wrong;
use solutions::{Answers, answers};

const SEEDS: [u128; 3] = [101, 202, 303];

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn answers_of(exercise: &Exercise) -> Answers {
    let of = answers().into_iter().find(|answers| answers.slug == exercise.slug);
    of.unwrap_or_else(|| panic!("{} has no reference answer", exercise.slug))
}

/// Public checks, and hidden ones of all seeds.
fn checks(exercise: &Exercise) -> Vec<Check> {
    let hidden = |seed: &u128| {
        hidden_checks(exercise.slug, *seed)
            .unwrap_or_else(|| panic!("{} has no hidden checks", exercise.slug))
    };
    (exercise.checks)().into_iter().chain(SEEDS.iter().flat_map(hidden)).collect()
}

fn failures(checks: &[Check], answer: &dyn Transport) -> Vec<(&'static str, Failure)> {
    let run = |check: &Check| Some((check.name, check.run(answer).err()?));
    checks.iter().filter_map(run).collect()
}

#[test]
fn exercises_stand_in_the_order_and_with_the_titles_of_the_table_of_contents() {
    let summary = fs::read_to_string(root().join("src/SUMMARY.md")).expect("a table of contents");
    let entries = summary.lines().filter_map(|line| line.split_once("[Exercise: "));
    let listed: Vec<String> = entries.map(|(_, entry)| entry.to_lowercase()).collect();
    let entry = |e: &&Exercise| format!("{}](exercises/{}.md)", e.title.to_lowercase(), e.slug);
    assert_eq!(listed, EXERCISES.iter().map(entry).collect::<Vec<_>>());
}

#[test]
fn the_reference_passes_every_check() {
    for exercise in EXERCISES {
        let failed = failures(&checks(exercise), &*answers_of(exercise).reference);
        assert!(failed.is_empty(), "{}: {failed:?}", exercise.slug);
    }
}

#[test]
fn every_wrong_answer_is_rejected_by_its_own_name_and_by_no_other() {
    for exercise in EXERCISES {
        let checks = checks(exercise);
        let public: Vec<&str> = (exercise.checks)().iter().map(|check| check.name).collect();
        for wrong in answers_of(exercise).wrong {
            let failed = failures(&checks, &*wrong.answer);
            let named: BTreeSet<&str> = failed
                .iter()
                .filter_map(|(_, failure)| Some(failure.misconception?.name))
                .collect();
            let (slug, name) = (exercise.slug, wrong.misconception.name);
            assert_eq!(named, BTreeSet::from([name]), "{slug}: {name}: {failed:?}");
            assert!(
                failed.iter().any(|(check, failure)| {
                    public.contains(check) && failure.misconception.is_some()
                }),
                "{slug}: {name} is not named by a check that students have"
            );
        }
    }
}

#[test]
fn every_misconception_has_an_answer_that_shows_it_and_there_are_at_least_four() {
    for exercise in EXERCISES {
        let mut shown: Vec<&str> =
            answers_of(exercise).wrong.iter().map(|wrong| wrong.misconception.name).collect();
        // One mistake can be made in several places.
        shown.dedup();
        let named: Vec<&str> = exercise.misconceptions.iter().map(|known| known.name).collect();
        assert_eq!(shown, named, "{}", exercise.slug);
        assert!(named.len() >= 4, "{} has only {named:?}", exercise.slug);
    }
}

#[test]
fn numbers_that_are_none_earn_nothing_and_no_function_can_be_left_out() {
    for exercise in EXERCISES {
        let (checks, answers) = (checks(exercise), answers_of(exercise));
        for (index, spoiled) in answers.spoiled.iter().enumerate() {
            for check in &checks {
                let name = format!("{}::{} of spoiled answer {index}", exercise.slug, check.name);
                let failure = check.run(&**spoiled).expect_err(&name);
                // A wrong answer may give zeros and nothing else; then zeros are what it is told by.
                let is_it = |wrong: &Wrong| check.run(&*wrong.answer).as_ref() == Err(&failure);
                let known = failure.misconception.is_none() || answers.wrong.iter().any(is_it);
                assert!(known, "{name}: {failure}");
            }
        }
    }
}

#[test]
fn skeletons_are_those_of_the_newest_edition_and_say_so() {
    let folder = Folder::at(root().join("exercises"));
    for exercise in EXERCISES {
        let text = fs::read_to_string(folder.answer(exercise.slug)).expect("a skeleton");
        let newest = edition::newest(&folder, exercise.slug).expect("an edition");
        assert_eq!(edition::edition_of(&text), Some(newest), "{}", exercise.slug);
        let kept = folder.skeletons(newest).join(format!("{}.rs", exercise.slug));
        assert_eq!(text, fs::read_to_string(kept).expect("kept"), "{}", exercise.slug);
    }
}

/// Every public function of a file with its description and its types, and none of its body.
fn interface(path: PathBuf) -> Vec<String> {
    let text = fs::read_to_string(&path).expect("a file");
    let file: syn::File = syn::parse_str(&text).expect("Rust");
    let signature = |item: &syn::Item| match item {
        syn::Item::Fn(function) if matches!(function.vis, syn::Visibility::Public(_)) => {
            let docs = function.attrs.iter().map(|doc| doc.to_token_stream().to_string());
            Some(docs.collect::<String>() + &function.sig.to_token_stream().to_string())
        }
        _ => None,
    };
    file.items.iter().filter_map(signature).collect()
}

#[test]
fn skeletons_and_reference_answers_have_the_same_interface() {
    for exercise in EXERCISES {
        let file = format!("{}.rs", exercise.slug);
        let skeleton = interface(root().join("exercises/src").join(&file));
        assert_eq!(skeleton, interface(root().join("solutions/src").join(&file)));
        let names: Vec<String> =
            exercise.functions.iter().map(|name| format!("fn {name}")).collect();
        assert_eq!(skeleton.len(), names.len(), "{}", exercise.slug);
        for (signature, name) in skeleton.iter().zip(names) {
            assert!(signature.contains(&name), "{signature} is not {name}");
        }
    }
}

#[test]
fn every_name_selects_its_exercise_alone_and_at_least_one_check() {
    for exercise in EXERCISES {
        let selected: Vec<&str> =
            selection::selected(Some(exercise.slug)).iter().map(|found| found.slug).collect();
        assert_eq!(selected, [exercise.slug]);
        assert!(!(exercise.checks)().is_empty());
    }
}

#[test]
fn hints_lead_from_a_question_to_the_idea_in_at_least_three_steps() {
    for exercise in EXERCISES {
        let ladder = exercise.hint_ladder();
        assert!(ladder.len() >= 3, "{}", exercise.slug);
        assert!(ladder[0].contains('?'), "{}: the first hint asks nothing", exercise.slug);
        assert!(ladder.iter().all(|hint| !hint.contains('$')), "{}: TeX", exercise.slug);
    }
}

#[test]
fn no_reference_answer_calls_what_is_forbidden() {
    for exercise in EXERCISES {
        let path = root().join("solutions/src").join(format!("{}.rs", exercise.slug));
        let text = fs::read_to_string(path).expect("an answer");
        for item in exercise.forbidden {
            let word = |c: char| c.is_alphanumeric() || c == '_';
            let called = text.split(|c| !word(c)).any(|found| found == *item);
            assert!(!called, "{} calls {item}", exercise.slug);
        }
    }
}

/// Names and titles of the chapters, in the order of the book.
fn chapters() -> Vec<(String, String)> {
    let summary = fs::read_to_string(root().join("src/SUMMARY.md")).expect("a table of contents");
    let chapter = |line: &str| {
        let (title, slug) = line.strip_prefix("- [")?.split_once("](")?;
        Some((slug.strip_suffix(".md)")?.to_owned(), title.to_owned()))
    };
    summary.lines().filter_map(chapter).collect()
}

#[test]
fn every_chapter_has_an_exercise_or_a_question_in_words() {
    let mut chapters = chapters();
    let asked = |slug: &str| CHAPTERS.iter().any(|question| question.slug == slug);
    for (slug, _) in &chapters {
        let has = EXERCISES.iter().any(|exercise| exercise.chapter == slug);
        assert!(has || asked(slug), "{slug} asks for no program, and nothing in words");
    }
    chapters.retain(|(slug, _)| asked(slug));
    let entry = |slug: &str, title: &str| (slug.to_owned(), title.to_owned());
    let listed = CHAPTERS.iter().map(|question| entry(question.slug, question.title));
    assert_eq!(chapters, listed.collect::<Vec<_>>());
}

#[test]
fn the_pages_name_the_questions_of_chapters() {
    let page = |path: &str| fs::read_to_string(root().join("src").join(path)).expect("a page");
    let list = page("exercises.md");
    for slug in CHAPTERS.iter().map(|question| question.slug) {
        let named = page(&format!("{slug}.md"))
            .contains(&format!("**In words,** under `{slug}` in `exercises/answers.md`"));
        assert!(named, "{slug} does not name its question");
        assert!(list.contains(&format!("| `{slug}` | @sec:{slug} |")), "{slug} is in no list");
    }
}

#[test]
fn questions_in_words_stand_in_the_order_of_the_book_and_have_rubrics() {
    let answers = fs::read_to_string(root().join("exercises/answers.md")).expect("answers.md");
    let asked: Vec<&str> = answers.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    let mut expected = Vec::new();
    for (chapter, _) in chapters() {
        let own = CHAPTERS.iter().filter(|question| question.slug == chapter);
        expected.extend(own.map(|question| question.slug));
        let exercises = EXERCISES.iter().filter(|exercise| exercise.chapter == chapter);
        expected.extend(exercises.map(|exercise| exercise.slug));
    }
    assert_eq!(asked, expected);
    for slug in asked {
        let path = root().join("tests/rubrics").join(format!("{slug}.md"));
        let rubric = fs::read_to_string(path).unwrap_or_else(|_| panic!("{slug} has no rubric"));
        for part in ["**Full marks.** ", "\n**Half.** ", "\n**None.** ", "\nIts number: "] {
            assert!(rubric.contains(part), "the rubric of {slug} has no part {part}");
        }
    }
}

/// The tables of the instructor's part: every misconception, which check names it, and how.
fn tables() -> String {
    let mut text = String::new();
    for exercise in EXERCISES {
        text += &format!("\n## {}\n\nThe exercise is `{}`.\n", exercise.title, exercise.slug);
        text += "\n| Mistake | What the student reads | Named by |\n| --- | --- | --- |\n";
        let public = (exercise.checks)();
        let mut wrong = answers_of(exercise).wrong;
        wrong.dedup_by(|next, first| next.misconception == first.misconception);
        for wrong in wrong {
            let named = |check: &&Check| {
                check.run(&*wrong.answer).is_err_and(|failure| failure.misconception.is_some())
            };
            let check = public.iter().find(named).map_or("", |check| check.name);
            let known = wrong.misconception;
            let (name, check) = (known.name.replace('_', " "), check.replace('_', " "));
            text += &format!("| {name} | {} | {check} |\n", known.sentence.replace('|', "\\|"));
        }
    }
    text
}

/// `ACCEPT=1 cargo test -p book-tests --test exercises tables` writes them anew.
#[test]
fn the_tables_of_misconceptions_are_what_the_checks_say() {
    let path = root().join("src/instructors/misconceptions.md");
    let page = fs::read_to_string(&path).expect("the page");
    let (before, _) = page.split_once("\n## ").expect("a section for each exercise");
    let anew = format!("{before}{}", tables());
    if std::env::var_os("ACCEPT").is_some() {
        fs::write(&path, &anew).expect("written");
    }
    assert!(
        page == anew || std::env::var_os("ACCEPT").is_some(),
        "the tables have changed; ACCEPT=1"
    );
}
