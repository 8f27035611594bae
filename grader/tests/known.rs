//! Answers that are known, through compiler, machine and checks: the reference, the skeletons and every wrong answer.

use std::collections::BTreeMap;
use std::fs;

use exercise_spec::{EXERCISES, exercise};
use grader::compile::{Compiled, Compiler};
use grader::grade::{Outcome, Verdict};
use grader::judge::Judge;
use grader::memory::Memory;
use grader::points::Points;
use grader::repository;
use grader::seed::Seed;
use quote::{ToTokens, quote};
use solutions::answers;

const SEED: Seed = Seed::new(11);

fn judge() -> Judge {
    let points = Points::read(&repository().join("grader/points.toml")).expect("points");
    Judge::prepare(points, SEED, EXERCISES, memory()).expect("a compiler and a machine")
}

fn memory() -> Memory {
    Memory::of(None).expect("enough memory")
}

#[test]
fn the_reference_earns_everything_and_every_skeleton_nothing() {
    assert_eq!(judge().canaries(), Ok(()));
}

/// Wrong answers are functions that change the reference. This writes them as a student's file.
fn as_a_file(slug: &str, index: usize) -> String {
    let read = |path: String| fs::read_to_string(repository().join(path)).expect("a file");
    let plain = |text: String| {
        text.lines().filter(|line| !line.starts_with("//!")).collect::<Vec<_>>().join("\n")
    };
    let right = plain(read(format!("solutions/src/{slug}.rs")));
    let wrong = plain(read(format!("solutions/src/misconceptions/{slug}.rs")))
        .replace(&format!("use crate::{slug} as right;"), "use super::right;")
        .replace("use super::Wrong;", "use super::{Wrong, named::*};");
    let file: syn::File = syn::parse_str(&right).expect("Rust");
    let (mut uses, mut functions) = (String::new(), String::new());
    for item in &file.items {
        match item {
            syn::Item::Use(used) => uses += &used.to_token_stream().to_string(),
            syn::Item::Fn(function) if matches!(function.vis, syn::Visibility::Public(_)) => {
                functions += &forwarded(&function.sig, index);
            }
            _ => {}
        }
    }
    let known = exercise(slug).map_or(&[][..], |exercise| exercise.misconceptions);
    let names = known.iter().map(|known| known.name.to_uppercase()).collect::<Vec<_>>();
    let all =
        format!("pub static MISCONCEPTIONS: &[&Misconception] = &[&{}];\n", names.join(", &"));
    let one = |name: &String| {
        format!("pub static {name}: Misconception = Misconception {{ name: \"{name}\" }};\n")
    };
    let names = names.iter().map(one).collect::<String>() + &all;
    format!(
        "{uses}\nuse exercise_spec::{slug}::Functions;\n\
         pub struct Misconception {{ name: &'static str }}\nmod named {{\nuse super::Misconception;\n{names}}}\n\
         pub struct Wrong {{ misconception: &'static Misconception, functions: Functions }}\n\
         impl Wrong {{ fn new(misconception: &'static Misconception, functions: Functions) -> Self {{ Self {{ misconception, functions }} }} }}\n\
         mod right {{\n{right}\n}}\nmod wrong {{\n{wrong}\n}}\n{functions}"
    )
}

/// A function that calls the one of a wrong answer.
fn forwarded(signature: &syn::Signature, index: usize) -> String {
    let (name, output) = (&signature.ident, &signature.output);
    let (mut names, mut types) = (Vec::new(), Vec::new());
    for input in &signature.inputs {
        if let syn::FnArg::Typed(typed) = input
            && let syn::Pat::Ident(pattern) = &*typed.pat
        {
            names.push(pattern.ident.to_token_stream());
            types.push(typed.ty.to_token_stream());
        }
    }
    quote! {
        pub fn #name(#(#names: #types),*) #output {
            (wrong::wrong().swap_remove(#index).functions.#name)(#(#names),*)
        }
    }
    .to_string()
}

#[test]
fn a_misconception_of_each_exercise_is_named_and_loses_points() {
    named(1);
}

#[test]
#[ignore = "compiles every wrong answer"]
fn every_misconception_is_named_and_loses_points() {
    named(usize::MAX);
}

/// Grades so many wrong answers of each exercise: the first of all in one submission, and so on.
fn named(most: usize) {
    let judge = judge();
    let all = answers();
    let longest = all.iter().map(|answers| answers.wrong.len()).max().unwrap_or(0);
    for index in 0..longest.min(most) {
        let chosen: Vec<_> = all.iter().filter(|answers| index < answers.wrong.len()).collect();
        let texts: BTreeMap<_, _> =
            chosen.iter().map(|answers| (answers.slug, as_a_file(answers.slug, index))).collect();
        let graded = judge.grade_texts(&texts);
        for answers in chosen {
            let (slug, name) = (answers.slug, answers.wrong[index].misconception.name);
            let grade = graded.iter().find(|grade| grade.exercise == slug).expect("a grade");
            assert_eq!(grade.outcome, Outcome::Ran, "{slug}: {name}");
            assert_eq!(grade.misconceptions(), [name], "{slug}: {:?}", grade.checks);
            assert!(grade.earned().is_some_and(|earned| earned < grade.points), "{slug}: {name}");
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_grade_and_another_one_asks_otherwise() {
    let texts = BTreeMap::from([("left_perturbation", as_a_file("left_perturbation", 0))]);
    let first = judge().grade_texts(&texts);
    assert_eq!(first, judge().grade_texts(&texts));
    let points = Points::read(&repository().join("grader/points.toml")).expect("points");
    let other = Judge::prepare(points, Seed::new(12), EXERCISES, memory()).expect("a judge");
    let other = other.grade_texts(&texts);
    let hidden = |grades: &[grader::grade::ExerciseGrade]| {
        let checks = grades.iter().flat_map(|grade| grade.checks.clone());
        let failed = checks.filter(|check| check.hidden && check.verdict == Verdict::Failed);
        failed.map(|check| check.numbers).collect::<Vec<_>>()
    };
    assert_ne!(hidden(&first), hidden(&other));
}

#[test]
fn a_module_is_kept_for_the_texts_it_was_made_of_and_no_others() {
    let module = |path: &str| {
        let text = fs::read_to_string(repository().join(path)).expect("a file");
        let compiler = Compiler::prepare().expect("a compiler");
        match compiler.compile_once(&BTreeMap::from([("left_perturbation", text)]), &memory()) {
            Compiled::Module(module) => module,
            _ => panic!("{path} does not compile"),
        }
    };
    let taken = |slug: &str| if slug == "left_perturbation" { '1' } else { '0' };
    let name: String = EXERCISES.iter().map(|exercise| taken(exercise.slug)).collect();
    let kept = repository().join("target/grader/known").join(name);
    let written = || fs::metadata(&kept).and_then(|file| file.modified()).expect("a module");
    let skeleton = module("exercises/skeletons/1/left_perturbation.rs");
    let reference = module("solutions/src/left_perturbation.rs");
    assert_ne!(reference, skeleton);
    let before = written();
    assert_eq!(module("solutions/src/left_perturbation.rs"), reference);
    assert_eq!(written(), before, "it was compiled again");
}
