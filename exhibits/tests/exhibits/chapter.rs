//! What a chapter refuses, and what it finds in a check.

use exhibits::chapter::{Chapter, counterexample_failure, text};
use exhibits::comparison::Comparison;

type Formula = fn(f64) -> f64;

fn doubles(formula: Formula) -> Comparison {
    let mut comparison = Comparison::absolute("a sum", 1e-12, "m");
    comparison.add(&[formula(3.0)], &[3.0 + 3.0]);
    comparison
}

#[test]
fn a_condition_that_is_not_needed_is_found() {
    let chapter = Chapter::registered("test", |chapter| {
        let statement = |x: f64| {
            let mut comparison = Comparison::absolute("its absolute value", 1e-12, "m");
            comparison.add(&[x.abs()], &[x]);
            comparison
        };
        chapter.counterexample("absolute", "positive", statement, [1.0, -1.0]);
        chapter.counterexample("absolute", "whole", statement, [1.0, 1.5]);
        chapter.counterexample("absolute", "negative", statement, [-1.0, 1.0]);
    });
    let failures: Vec<_> = chapter
        .unwrap()
        .counterexamples
        .iter()
        .map(|case| counterexample_failure(&case.comparisons()))
        .collect();
    assert_eq!(failures[0], None);
    assert!(failures[1].as_ref().unwrap().contains("without the condition just as well"));
    assert!(failures[2].as_ref().unwrap().starts_with("with the condition, the error"));
}

#[test]
fn a_mutant_that_passes_is_named_as_a_survivor() {
    let chapter = Chapter::registered("test", |chapter| {
        let mutants: [(_, Formula); 2] = [("sign", |x| -2.0 * x), ("none", |x| x + x)];
        chapter.equation("double", doubles, |x| 2.0 * x, &mutants);
    });
    assert_eq!(chapter.unwrap().equations[0].survivors(), ["none"]);
}

#[test]
fn a_name_used_twice_is_refused_with_both_places() {
    let equations = Chapter::registered("test", |chapter| {
        chapter.equation("double", doubles, |x| 2.0 * x, &[]);
        chapter.equation("double", doubles, |x| 2.0 * x, &[]);
    });
    let sentence = equations.err().unwrap();
    assert!(sentence.contains("equation `double` is registered already at"), "{sentence}");
    assert!(sentence.starts_with("exhibits/tests/exhibits/chapter.rs:"), "{sentence}");

    let numbers = Chapter::registered("test", |chapter| {
        chapter.number("depth", 1.0, "m", 0);
        chapter.number("depth", 2.0, "m", 0);
    });
    assert!(numbers.err().unwrap().contains("number `depth`"));
}

#[test]
fn a_number_that_is_not_finite_is_refused() {
    let chapter = Chapter::registered("test", |chapter| {
        chapter.number("depth", f64::NAN, "m", 0);
    });
    assert!(chapter.err().unwrap().contains("number `depth` is NaN"));
}

#[test]
fn an_equation_and_a_number_may_share_a_name() {
    let chapter = Chapter::registered("test", |chapter| {
        chapter.equation("disparity", doubles, |x| 2.0 * x, &[]);
        chapter.number("disparity", 40.0, "px", 0);
    });
    assert!(chapter.is_ok());
}

#[test]
fn numbers_are_printed_as_in_print() {
    assert_eq!(text(40.0, 0), "40");
    assert_eq!(text(-0.1, 1), "\u{2212}0.1");
    assert_eq!(text(-0.001, 1), "0.0");
    assert_eq!(text(1600.0, 0), "1600");
    assert_eq!(text(10_000_000.0, 0), "10,000,000");
    assert_eq!(text(12345.678, 2), "12,345.68");
}
