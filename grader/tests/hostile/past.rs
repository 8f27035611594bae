//! What would get past the source screen meets other walls: a crate that forbids what is unsafe,
//! the list of what the compiler read, and a machine that has nothing to reach.

use std::collections::BTreeMap;

use exercise_spec::exercise;
use grader::grade::Outcome;
use grader::judge::Judge;
use grader::memory::Memory;
use grader::points::Points;
use grader::seed::Seed;

use crate::corpus::{LEFT, every, right, right_and};
use crate::{COMPILING, left_behind};

#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    Refused,
    DoesNotCompile,
    /// Either of both: it depends on what the compiler is shown of the disk.
    Never,
    Earns(f64),
}

fn texts() -> Vec<(&'static str, String, End)> {
    let and = |more: &str| right_and(LEFT, more);
    let tests = grader::repository().join("tests/src/left_perturbation.rs");
    vec![
        (
            "reads the file /usr/bin/env",
            and("pub const X: &[u8] = include_bytes!(\"/usr/bin/env\");"),
            End::Refused,
        ),
        (
            "",
            and(&format!("pub const X: &str = include_str!({:?});", tests.display().to_string())),
            End::Never,
        ),
        (
            "",
            and(&format!(
                "#[doc = include_str!({:?})]\npub fn x() {{}}",
                tests.display().to_string()
            )),
            End::Never,
        ),
        ("", and("#[path = \"/usr/bin/env\"]\nmod x;"), End::Never),
        ("", and("mod x;"), End::DoesNotCompile),
        ("", and("pub const X: &[u8] = include_bytes!(\"/dev/ptmx\");"), End::Never),
        (
            "The grader calls each function as the skeleton declares it.",
            and("").replace("pub fn forward_motion", "fn forward_motion"),
            End::DoesNotCompile,
        ),
        (
            "No space left on device",
            and("compile_error!(\"No space left on device\");"),
            End::DoesNotCompile,
        ),
        ("reads the variable PATH", and("pub const X: &str = env!(\"PATH\");"), End::Refused),
        (
            "reads the variable NOBODY",
            and("pub const X: Option<&str> = option_env!(\"NOBODY\");"),
            End::Refused,
        ),
        (
            "cannot find `check` in `exercise_spec`",
            and("pub type X = exercise_spec::check::Failure;"),
            End::DoesNotCompile,
        ),
        (
            "EXERCISE",
            and(
                "pub fn x() -> usize { (exercise_spec::left_perturbation::EXERCISE.checks)().len() }",
            ),
            End::DoesNotCompile,
        ),
        ("", and("pub use exercise_spec::left_perturbation::differences;"), End::DoesNotCompile),
        (
            "no method named `jacobians`",
            every(
                LEFT,
                "camera.pinhole().jacobians(&camera_from_world, &point_in_world).unwrap()",
                "",
            ),
            End::DoesNotCompile,
        ),
        (
            "no method named `project_with_jacobians`",
            and("macro_rules! ask { ($a:expr, $b:ident) => { $a.$b() } } pub fn x(c: Camera) { \
                    ask!(c.pinhole(), project_with_jacobians); }"),
            End::DoesNotCompile,
        ),
        ("least_squares", and("pub use vislam::least_squares::NullSpace;"), End::DoesNotCompile),
        ("simulation", and("pub type X = vislam::simulation::Scene;"), End::DoesNotCompile),
        ("Pinhole", and("pub use vislam::reprojection::Pinhole;"), End::DoesNotCompile),
        (
            "no method named `jacobians`",
            and("pub trait Dead { fn project(&self); } pub fn x(c: Camera) { \
                    std::convert::identity(c.pinhole()).jacobians(); }"),
            End::DoesNotCompile,
        ),
        (
            "unsafe_code",
            and("pub fn x() -> u8 { unsafe { *(8 as *const u8) } }"),
            End::DoesNotCompile,
        ),
        (
            "unsafe_code",
            and("#[allow(unsafe_code)]\npub fn x() { unsafe {} }"),
            End::DoesNotCompile,
        ),
        ("", and("#[unsafe(no_mangle)]\npub extern \"C\" fn call() {}"), End::DoesNotCompile),
        ("", and("#[unsafe(export_name = \"call\")]\npub fn x() {}"), End::DoesNotCompile),
        (
            "",
            and("#[unsafe(link_section = \".init_array\")]\n#[used]\nstatic X: extern \"C\" fn() \
                    = x;\nextern \"C\" fn x() { loop {} }"),
            End::DoesNotCompile,
        ),
        (
            "",
            every(
                LEFT,
                "{ leave(0); Default::default() }",
                "#[link(wasm_import_module = \"wasi\")]\nunsafe extern \"C\" { safe fn \
                    leave(code: i32); }",
            ),
            End::Never,
        ),
        ("unsafe_code", and("std::arch::global_asm!(\".globl call\");"), End::DoesNotCompile),
        ("", every(LEFT, "std::process::exit(0)", ""), End::Earns(0.0)),
        (
            "",
            every(
                LEFT,
                "hook()",
                "fn hook<T>() -> T {\n    std::panic::set_hook(Box::new(|_| loop {}));\n    \
                    panic!()\n}",
            ),
            End::Earns(0.0),
        ),
        (
            "",
            every(LEFT, "std::panic::catch_unwind(|| panic!()).unwrap_or_default()", ""),
            End::Earns(0.0),
        ),
        (
            "",
            and("#[macro_export]\nmacro_rules! vec { ($($t:tt)*) => { loop {} } }"),
            End::Earns(10.0),
        ),
    ]
}

#[test]
fn what_gets_past_the_screen_meets_other_walls() {
    let _alone = COMPILING.lock().unwrap_or_else(|held| held.into_inner());
    let points = Points::read(&grader::repository().join("grader/points.toml")).expect("points");
    let exercises: Vec<_> = exercise(LEFT).into_iter().collect();
    let memory = Memory::of(None).expect("enough memory");
    let judge = Judge::prepare(points, Seed::new(7), &exercises, memory).expect("a judge");
    for (says, text, end) in texts() {
        let graded = judge.grade_texts(&BTreeMap::from([(LEFT, text.clone())]));
        let (outcome, earned) = (&graded[0].outcome, graded[0].earned());
        let as_expected = match (outcome, end) {
            (Outcome::Refused(why), End::Refused | End::Never)
            | (Outcome::DoesNotCompile(why), End::DoesNotCompile | End::Never) => {
                why.contains(says)
            }
            (Outcome::Ran, End::Earns(most)) => earned.is_some_and(|earned| earned <= most),
            _ => false,
        };
        let new = text.lines().last().unwrap_or_default();
        assert!(as_expected, "{new}: {end:?} {says:?} was expected; {outcome:?}, {earned:?}");
    }
    assert_eq!(left_behind(), Vec::<String>::new());
}

/// Factorizations of nalgebra where rows are to be turned by hand, and what is allowed there.
#[test]
fn a_factorization_is_found_in_the_module_however_it_is_called() {
    let _alone = COMPILING.lock().unwrap_or_else(|held| held.into_inner());
    let points = Points::read(&grader::repository().join("grader/points.toml")).expect("points");
    let slugs = ["null_space", "square_root_prior"];
    let exercises: Vec<_> = slugs.into_iter().filter_map(exercise).collect();
    let memory = Memory::of(None).expect("memory");
    let judge = Judge::prepare(points, Seed::new(5), &exercises, memory).expect("a judge");
    let by = |slug: &str, function: &str, statement: &str| {
        let text = right(slug);
        let begin = text.find(&format!("pub fn {function}(")).expect("a function");
        let body = begin + text[begin..].find("{\n").expect("a body") + 2;
        format!("{}{statement}\n{}", &text[..body], &text[body..])
    };
    let projected = |statement: &str| by("null_space", "project_out", statement);
    let slid = |statement: &str| by("square_root_prior", "slide", statement);
    let in_a_macro = "macro_rules! ask { ($a:expr, $b:ident) => { $a.$b() } }
    let _ = ask!(by_landmark.clone(), qr).r();";
    for (slug, text, name) in [
        ("null_space", projected("let _ = by_landmark.clone().qr().q();"), "qr"),
        ("null_space", projected(in_a_macro), "qr"),
        (
            "null_space",
            projected("let _ = nalgebra::FullPivLU::new(by_landmark.clone()).l();"),
            "FullPivLU",
        ),
        ("null_space", projected("let _ = by_landmark.clone().svd(true, false).u;"), "svd"),
        ("square_root_prior", slid("let _ = rows.clone().qr().unpack();"), "qr"),
        ("square_root_prior", slid("let _ = rows.clone().col_piv_qr().r();"), "col_piv_qr"),
    ] {
        let grades = judge.grade_texts(&BTreeMap::from([(slug, text.clone())]));
        let grade = grades.iter().find(|grade| grade.exercise == slug).expect("a grade");
        let told = format!("contains nalgebra's `{name}`");
        assert!(
            matches!(&grade.outcome, Outcome::Refused(why) if why.contains(&told)),
            "{text}: {:?}",
            grade.outcome
        );
    }
    let allowed =
        "let (square, _) = (by_landmark.tr_mul(&by_landmark), by_landmark.singular_values());
    let _ = (square.symmetric_eigenvalues(), square.clone().cholesky(), square.try_inverse());";
    for (slug, text) in [("null_space", projected(allowed)), ("square_root_prior", slid(""))] {
        let grades = judge.grade_texts(&BTreeMap::from([(slug, text)]));
        let grade = grades.iter().find(|grade| grade.exercise == slug).expect("a grade");
        assert_eq!(grade.earned(), Some(10.0), "{slug}: {:?}", grade.outcome);
    }
}
