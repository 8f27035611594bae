//! Every chapter of the book: its equations, counterexamples and figures, computed once for all tests.

use std::sync::LazyLock;
use std::thread;

use exhibits::chapter::{Chapter, Equation, counterexample_failure};
use exhibits::comparison::Comparison;
use exhibits::figure::Figure;
use exhibits::{CHAPTERS, whole};

/// A value of every chapter, the chapters side by side.
fn of_each<C: Sync, T: Send>(chapters: &[C], value: fn(&C) -> T) -> Vec<T> {
    thread::scope(|scope| {
        let threads: Vec<_> = chapters.iter().map(|c| scope.spawn(move || value(c))).collect();
        threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
    })
}

fn book() -> &'static [Chapter] {
    static BOOK: LazyLock<Vec<Chapter>> = LazyLock::new(|| {
        of_each(CHAPTERS, |chapter| {
            whole(chapter).expect("names that are used once, and finite numbers")
        })
    });
    &BOOK
}

/// Every figure of the book, with its name.
fn figures() -> &'static [(String, Figure)] {
    static FIGURES: LazyLock<Vec<(String, Figure)>> = LazyLock::new(|| {
        let drawn = |chapter: &Chapter| {
            let slug = chapter.slug;
            let named = chapter.figures.iter();
            named.map(|f| (format!("{slug}/{}", f.name), (f.draw)())).collect::<Vec<_>>()
        };
        of_each(book(), drawn).into_iter().flatten().collect()
    });
    &FIGURES
}

/// An equation of the book with what its formula and its mutants are found to be off by.
struct Checked {
    label: String,
    formula: Comparison,
    mutants: Vec<(&'static str, Comparison)>,
}

impl Checked {
    fn of(slug: &str, equation: &Equation) -> Self {
        let mutants = equation.mutants.iter().copied().zip(equation.check_mutants()).collect();
        Self { label: format!("{slug}/{}", equation.label), formula: equation.check(), mutants }
    }
}

fn checked() -> &'static [Checked] {
    static CHECKED: LazyLock<Vec<Checked>> = LazyLock::new(|| {
        let of_chapter = |chapter: &Chapter| {
            let equations = chapter.equations.iter();
            equations.map(|equation| Checked::of(chapter.slug, equation)).collect::<Vec<_>>()
        };
        of_each(book(), of_chapter).into_iter().flatten().collect()
    });
    &CHECKED
}

#[test]
fn every_equation_of_the_book_passes_its_check() {
    for Checked { label, formula, .. } in checked() {
        assert_eq!(formula.failure(), None, "{label}");
        assert!(formula.states >= 20, "{label} is compared at too few states");
    }
}

#[test]
fn every_check_of_the_book_rejects_all_its_mutants_by_a_number() {
    for Checked { label, formula, mutants } in checked() {
        assert!(mutants.len() >= 2, "{label} has too few mutants");
        for (name, mutant) in mutants {
            assert!(mutant.failure().is_some(), "{label}, {name} survives");
            assert!(mutant.worst > 5.0 * formula.tolerance, "{label}, {name}");
        }
    }
}

#[test]
fn every_theorem_of_the_book_needs_its_conditions() {
    for chapter in book() {
        for case in &chapter.counterexamples {
            let label = format!("{}, {}", case.theorem, case.condition);
            assert_eq!(counterexample_failure(&case.comparisons()), None, "{label}");
        }
    }
}

#[test]
fn figures_are_one_line_that_can_stand_inside_markdown() {
    for (name, figure) in figures() {
        assert!(figure.svg.starts_with("<svg viewBox="), "{name}");
        assert!(figure.svg.ends_with("</svg>"), "{name}");
        assert!(!figure.svg.contains(['\n', '\r']), "{name}");
    }
}

#[test]
fn figures_leave_every_colour_to_the_page() {
    for (name, figure) in figures() {
        assert!(!figure.svg.contains('#'), "{name} has a colour of its own");
        assert!(figure.svg.contains("currentColor"), "{name} has no ink");
    }
}

#[test]
fn figures_carry_no_identifiers_that_could_meet_those_of_the_page() {
    for (name, figure) in figures() {
        assert!(!figure.svg.contains(" id="), "{name}");
    }
}

#[test]
fn figures_close_what_they_open() {
    for (name, figure) in figures() {
        let mut open = Vec::new();
        for tag in figure.svg.split('<').skip(1) {
            let (tag, _text) = tag.split_once('>').expect("a tag ends");
            if let Some(closed) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(closed), "{name}");
            } else if !tag.ends_with('/') {
                open.push(tag.split(' ').next().expect("a tag has a name"));
            }
            assert_eq!(tag.matches('"').count() % 2, 0, "{name}: {tag}");
        }
        assert!(open.is_empty(), "{name}");
    }
}

#[test]
fn figures_keep_their_data_in_a_table_that_is_full_and_not_too_long() {
    for (name, figure) in figures() {
        assert!((1..=60).contains(&figure.rows.len()), "{name}");
        for row in &figure.rows {
            assert_eq!(row.len(), figure.columns.len(), "{name}");
            assert!(row.iter().all(|cell| !cell.contains("NaN")), "{name}");
        }
    }
}
