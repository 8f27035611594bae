//! A batch of twenty submissions of the worst kind beside an honest one: it ends in time, in the memory
//! that there is, and goes on after it was killed.
//!
//! `cargo test -p grader --test worst -- --ignored` takes some minutes, on a machine that does nothing else. To see that the memory
//! suffices, run it where there is no more of it, in a container or a control group.

#[path = "hostile/corpus.rs"]
#[allow(dead_code, reason = "the corpus has more")]
mod corpus;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use corpus::{every, put, right, right_and};
use exercise_spec::EXERCISES;
use grader::grade::{Batch, Outcome};

/// Megabytes that the grader is told it may use.
const MEMORY: &str = "1200";
const COUNT: usize = 20;
const MOST: Duration = Duration::from_secs(720);

/// What an answer can do to hold a batch up.
const KINDS: [fn(&str) -> String; 7] = [leaps, fills, asks, loops, counts, doubles, grows];

/// Reads memory where no cache has it: few steps, much time.
fn leaps(slug: &str) -> String {
    let body = "let much = vec![1_usize; 24 << 20];\nlet mut at: usize = 1;\nloop { at = at.wrapping_mul(1_664_525).wrapping_add(much[at] + 1_013_904_223) % (24 << 20); std::hint::black_box(at); }";
    generic(slug, body)
}

/// Fills nearly all the memory that it may have, and holds it.
fn fills(slug: &str) -> String {
    generic(
        slug,
        "let mut much = vec![1_u8; 240 << 20];\nloop { much[7] += std::hint::black_box(0); }",
    )
}

/// Asks again and again for memory that it does not get.
fn asks(slug: &str) -> String {
    generic(slug, "loop { let _ = std::hint::black_box(Vec::<u8>::new().try_reserve(1 << 30)); }")
}

fn loops(slug: &str) -> String {
    generic(slug, "loop { std::hint::black_box(0); }")
}

fn generic(slug: &str, body: &str) -> String {
    every(slug, "worst()", &format!("fn worst<T>() -> T {{\n{body}\n}}"))
}

/// Counts while it is compiled.
fn counts(slug: &str) -> String {
    let more = "pub const NUMBER: u64 = {\n    let mut number = 0_u64;\n    while number < u64::MAX { number += 1; }\n    \
                number\n};";
    format!("#![allow(long_running_const_eval)]\n{}", right_and(slug, more))
}

/// Expands a macro to twice its size for ever.
fn doubles(slug: &str) -> String {
    right_and(slug, "macro_rules! m { ($($t:tt)*) => { m!($($t)* $($t)*); } }\nm!(x);")
}

/// Is compiled to as much code as a module may have.
fn grows(slug: &str) -> String {
    let step = "number = number.wrapping_mul(31).rotate_left((number & 7) as u32) ^ std::hint::black_box(number);\n";
    let one = |at: usize| {
        format!("pub fn huge{at}(mut number: u64) -> u64 {{\n{}number\n}}\n", step.repeat(500))
    };
    let call = (0..4).map(|at| format!("huge{at}(7);")).collect::<String>();
    let more: String = (0..4).map(one).collect();
    corpus::right_after(slug, &call, &more)
}

fn hand_in(root: &Path) {
    for (number, exercise) in
        (0..COUNT).flat_map(|number| EXERCISES.iter().map(move |it| (number, it)))
    {
        let at = EXERCISES.iter().position(|it| it.slug == exercise.slug).expect("a place");
        // Each kind alone, then all kinds, each in other exercises.
        let kind = if number < KINDS.len() { number } else { (number + at) % KINDS.len() };
        let path = format!("s{number:02}/{}.rs", exercise.slug);
        put(root, &path, KINDS[kind](exercise.slug));
    }
    for exercise in EXERCISES {
        put(root, &format!("honest/{}.rs", exercise.slug), right(exercise.slug));
    }
}

fn grade(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grade"));
    command.arg("run").arg(folder.join("batch")).arg("--out").arg(folder.join("grades"));
    command.args(["--memory", MEMORY]).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn kept(folder: &Path) -> usize {
    let entries = fs::read_dir(folder.join("grades/submissions")).into_iter().flatten().flatten();
    entries.filter(|entry| entry.path().join("grade.json").exists()).count()
}

fn batch(folder: &Path) -> Batch {
    let text = fs::read_to_string(folder.join("grades/grade.json")).expect("the grades");
    serde_json::from_str(&text).expect("a batch")
}

#[test]
#[ignore = "it takes minutes, and a machine that does nothing else"]
fn twenty_of_the_worst_kind_are_graded_in_time_and_the_honest_one_earns_all() {
    let temporary = tempfile::tempdir().expect("a folder");
    let folder = temporary.path();
    hand_in(&folder.join("batch"));
    let begun = Instant::now();
    let mut process = grade(folder).spawn().expect("the program");
    while kept(folder) < 3 {
        assert_eq!(process.try_wait().expect("a state"), None, "it ended early");
        sleep(Duration::from_millis(20));
    }
    process.kill().expect("killed");
    process.wait().expect("ended");
    let before = kept(folder);

    let again = grade(folder).output().expect("the program");
    println!("{} before the kill, all after {:?}", before, begun.elapsed());
    let said = String::from_utf8_lossy(&again.stderr);
    assert!(begun.elapsed() < MOST, "{:?}", begun.elapsed());
    let open: Vec<String> = batch(folder)
        .grades
        .into_iter()
        .filter(|grade| grade.earned().is_none())
        .map(|grade| grade.submission)
        .collect();
    assert!(open.len() <= 2, "what was under way when it was killed: {open:?}; {said}");

    grade(folder).output().expect("the program");
    println!("{open:?} besides, after {:?}", begun.elapsed());
    for grade in batch(folder).grades {
        let earned = grade.earned();
        if grade.submission == "honest" {
            assert_eq!(earned, Some(grade.points()));
            continue;
        }
        assert!(earned.is_some(), "{} is open", grade.submission);
        for exercise in grade.exercises {
            let at =
                format!("{} of {}: {:?}", exercise.exercise, grade.submission, exercise.outcome);
            assert_ne!(exercise.outcome, Outcome::Missing, "{at}");
            println!("{at:.120} {:?}", exercise.earned());
        }
    }
}
