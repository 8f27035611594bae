//! What the source screen refuses, what it says then, and what it lets pass.

use std::fs;

use exercise_runner::names::taken;
use exercise_spec::{EXERCISES, exercise};
use grader::export::every_skeleton;
use grader::screen::screen;

const SYMBOL: &str = "changes by what name or at what place the linker finds an item, and the \
    grader calls the functions of an answer by their paths. Leave the attribute out.";
const FILES: &str = "reads a file while it is compiled, and an answer is compiled without any \
    other file. Write what you need into the answer.";
const ENVIRONMENT: &str = "reads the environment of the compiler, and an answer must not depend \
    on where it is compiled. Write the value itself.";
const ASSEMBLER: &str =
    "is assembler, and an answer runs on a machine of another kind. Write it in Rust.";
const PROGRAM: &str =
    "replaces a part of the program around the answer, which is the grader's. Leave it out.";
const IN_THE_COMPILER: &str = "makes a macro that runs in the compiler, and an answer runs on its \
    own machine only. Write a function, or a macro with `macro_rules!`.";
const HOOK: &str =
    "changes what happens after a panic, and the grader reads panics itself. Leave it out.";
const LIMIT: &str = "changes a limit or a part of the compiler, and the grader compiles all \
    answers alike. Leave it out.";
const IN_MACRO: &str = "`mod` in a macro can become a module in another file, and each exercise is \
    one file. Write the module without the macro.";
const UP: &str =
    "`super` leads out of the answer here, and each answer stands alone. Leave it out.";
const VISIBLE: &str = "`pub(super)` leads out of the answer here, and each answer stands alone. \
    Write `pub`, or nothing, as in `pub fn` and `fn`.";
const SPEC: &str = "`exercise_spec`: an answer takes the types of its arguments from it and \
    nothing else, and by a `use` as in the skeleton. Take the lines of the skeleton.";

fn refusal(text: &str) -> String {
    screen("fill_in", text).expect_err(text)
}

fn the_librarys(name: &str) -> String {
    format!(
        "line 1: `{name}` of the library does what this exercise asks for. Write it yourself, of \
            the parts that its page names."
    )
}

/// Each text, in the third line of a file, is refused with one sentence.
fn refused(cases: &[(&str, &str)]) {
    for (text, sentence) in cases {
        assert_eq!(
            refusal(&format!("//! An answer.\n\n{text}\n")),
            format!("line 3: {sentence}"),
            "{text}"
        );
    }
}

fn passes(texts: &[&str]) {
    for text in texts {
        assert_eq!(screen("fill_in", text), Ok(()), "{text}");
    }
}

#[test]
fn a_simulated_world_is_refused_wherever_what_works_on_it_is() {
    let solves = |item: &&str| ["bundle_adjustment", "observability"].contains(item);
    let refusing = EXERCISES.iter().filter(|exercise| exercise.forbidden.iter().any(solves));
    let slugs: Vec<&str> = refusing.map(|exercise| exercise.slug).collect();
    assert!(!slugs.is_empty(), "no exercise refuses what works on a simulated world");
    for slug in slugs {
        for item in ["Scene", "at_true_scale", "Flight", "landmarks_around"] {
            for text in [
                format!("use vislam::simulation::{item};"),
                format!("fn f() {{ vislam::simulation::{item}::f() }}"),
            ] {
                let refusal = screen(slug, &text).expect_err(&text);
                assert_eq!(refusal, the_librarys("simulation"), "{slug}: {text}");
            }
        }
    }
}

#[test]
fn reference_answers_and_skeletons_pass() {
    let root = grader::repository();
    for exercise in EXERCISES {
        let slug = exercise.slug;
        let path = root.join("solutions/src").join(format!("{slug}.rs"));
        let mut texts = every_skeleton(&root, slug).expect("skeletons");
        texts.push(fs::read_to_string(path).expect("an answer"));
        for text in texts {
            assert_eq!(screen(slug, &text), Ok(()), "{slug}: {text}");
            assert_eq!(taken(exercise, &text), [""; 0], "{slug}");
        }
    }
}

#[test]
fn what_reads_files_while_compiling_is_refused_however_it_is_spelled() {
    for name in ["include", "include_str", "include_bytes"] {
        let sentence = format!("`{name}!` {FILES}");
        for text in [
            format!("const X: &str = {name}!(\"/etc/passwd\");"),
            format!("const X: &str = r#{name}!(\"/etc/passwd\");"),
            format!("const X: &str = std::{name}!(\"/etc/passwd\");"),
            format!("use std::{name} as x;"),
            format!("use ::core::{{f64, {name} as x}};"),
            format!("#[doc = {name}!(\"/etc/passwd\")] fn f() {{}}"),
            format!("#[cfg_attr(all(), doc = {name}!(\"/etc/passwd\"))] fn f() {{}}"),
            format!("macro_rules! m {{ () => {{ {name}!(\"/etc/passwd\") }} }}"),
            format!(
                "macro_rules! m {{ ($a:tt $b:tt $c:tt) => {{ $b $a $c }} }} const X: &str = m!(! \
                    {name} (\"x\"));"
            ),
        ] {
            refused(&[(&text, &sentence)]);
        }
    }
}

#[test]
fn a_macro_whose_name_is_given_to_another_is_refused() {
    let sentence = "`$name!` calls a macro whose name is given to another, so that nobody can see \
        which. Write its name here.";
    refused(&[("macro_rules! m { ($name:ident) => { $name!(\"x\") } }", sentence)]);
    passes(&[
        "macro_rules! m { ($a:ident) => { $a != 1.0 } }",
        "macro_rules! m { ($a:expr) => { if $a { 1 } else { 2 } } }",
    ]);
}

#[test]
fn the_environment_of_the_compiler_is_refused_and_a_variable_of_that_name_is_not() {
    let sentence = format!("`env!` {ENVIRONMENT}");
    refused(&[
        ("const X: &str = env!(\"PATH\");", &sentence),
        ("const X: &str = r#env! { \"PATH\" };", &sentence),
        (
            "use core::env as e;",
            &format!(
                "`core::env`: where answers run, there is no environment. An answer has its \
                    arguments, and gives its output back.\nline 3: {sentence}"
            ),
        ),
        (
            "macro_rules! m { ($a:tt $b:tt $c:tt) => { $b $a $c } } const X: &str = m!(! env \
                (\"x\"));",
            &sentence,
        ),
        ("const X: Option<&str> = option_env!(\"PATH\");", &format!("`option_env!` {ENVIRONMENT}")),
    ]);
    passes(&[
        "fn f(env: f64) -> bool { env != 1.0 }",
        "struct S { include: bool }",
        "fn f(s: S) -> bool { s.include }",
        "macro_rules! m { ($x:expr) => { $x } } fn f(env: f64) { println!(\"{}\", env); }",
        "macro_rules! m { ($x:expr) => { $x } } fn f(s: S) { format!(\"{}\", s.env); m!(s.env); }",
        "macro_rules! m { ($env:expr) => { $env } } fn f(env: f64) { assert!(true); m!(env); }",
        "macro_rules! m { () => {} } fn f(asm: bool) { if !(asm) { assert!(matches!(asm, true)); } }",
        "mod setup { pub fn env() {} } fn f() { setup::env(); }",
    ]);
    for text in [
        "macro_rules! m { ($a:tt $b:tt) => { $a ! $b } } m!(env (1));",
        "macro_rules! m { ($a:tt $b:tt $c:tt $d:tt) => { $d $b $c } } m!(f!(1) env);",
        "macro_rules! m { ($($a:tt)*) => { n!(! $($a)*) } } m!(env (1));",
    ] {
        refused(&[(text, &sentence)]);
    }
    // A macro of that name is not Rust's.
    for name in ["macro_rules! println", "use inner::m as println; macro_rules! m"] {
        let text = format!("{name} {{ ($a:tt $b:tt) => {{ $b $a (1) }} }} println!(! env);");
        refused(&[(&text, &sentence)]);
    }
}

#[test]
fn a_module_in_another_file_is_refused() {
    let told = |name: &str| {
        format!(
            "`mod {name};` reads another file, and each exercise is one file. Put the content of \
                the module here: `mod {name} {{ … }}`."
        )
    };
    refused(&[
        ("mod helper;", &told("helper")),
        ("pub(super) mod helper;", &format!("{}\nline 3: {VISIBLE}", told("helper"))),
        ("macro_rules! m { ($name:ident) => { mod $name; } }", IN_MACRO),
        ("macro_rules! m { ($body:tt) => { mod helper $body } }", IN_MACRO),
        ("macro_rules! m { ($a:tt $b:tt $c:tt $d:tt) => { $a $b $d } } m!(mod a {} ;);", IN_MACRO),
        ("#[cfg(test)] mod helper;", &told("helper")),
        ("macro_rules! m { ($a:tt $b:tt $c:tt) => { $b $a $c } } m!(helper mod ;);", IN_MACRO),
        ("#[path = \"/etc/x.rs\"] mod helper { }", &format!("`#[path]` {FILES}")),
        ("#[cfg_attr(all(), path = \"x\")] mod helper { }", &format!("`#[path]` {FILES}")),
    ]);
    passes(&[
        "macro_rules! m { ($($x:ident)*) => { #[cfg(test)] mod cases { $(fn $x() {})* } } } m!(a b);",
        "macro_rules! m { ($name:ident) => { mod $name { pub fn f() {} } } }",
        "mod helper { pub fn f() {} }",
        "fn f() { let mut path = 1; path = 2; }",
    ]);
}

#[test]
fn unsafe_and_foreign_code_are_refused() {
    let no_unsafe = "`unsafe` is for what the compiler cannot check, and an answer is \
        calculation. Write it in safe Rust.";
    let no_extern = "`extern` leads to foreign code, and there is none around an answer. Use the \
        standard library, nalgebra and vislam.";
    refused(&[
        ("fn f() { unsafe { } }", no_unsafe),
        ("macro_rules! m { () => { unsafe { } } }", no_unsafe),
        ("extern \"C\" fn f() {}", no_extern),
        ("extern crate alloc;", no_extern),
        (
            "extern crate nalgebra as na;",
            "`extern crate`: `nalgebra` is there without it. Leave the line out; write `use \
                nalgebra as na;`.",
        ),
        (
            "extern crate vislam;",
            "`extern crate`: `vislam` is there without it. Leave the line out.",
        ),
        (
            "core::arch::global_asm!(\"\");",
            &format!(
                "`core::arch`: where answers run, no instruction of a certain processor \
            can be called. Write it with numbers and nalgebra.\nline 3: `global_asm!` {ASSEMBLER}"
            ),
        ),
        ("fn f() { asm!(\"nop\") }", &format!("`asm!` {ASSEMBLER}")),
    ]);
}

#[test]
fn symbols_and_parts_of_the_program_are_refused() {
    refused(&[
        ("#[no_mangle] pub fn call() {}", &format!("`no_mangle` {SYMBOL}")),
        ("#[r#no_mangle] pub fn call() {}", &format!("`no_mangle` {SYMBOL}")),
        (
            "#[cfg_attr(all(), export_name = \"call\")] pub fn f() {}",
            &format!("`export_name` {SYMBOL}"),
        ),
        (
            "#[link_section = \".init_array\"] static F: fn() = f;",
            &format!("`link_section` {SYMBOL}"),
        ),
        ("#[used] static F: fn() = f;", &format!("`#[used]` {SYMBOL}")),
        ("#[link(name = \"c\")] struct S;", &format!("`#[link]` {SYMBOL}")),
        ("#[global_allocator] static A: A = A;", &format!("`global_allocator` {PROGRAM}")),
        ("#[panic_handler] fn f() {}", &format!("`panic_handler` {PROGRAM}")),
        (
            "#[macro_export] macro_rules! vec { () => {} }",
            "`macro_export` gives the macro to the program around the answer, which has its own. \
                Leave the attribute out.",
        ),
        ("#[proc_macro] pub fn f() {}", &format!("`proc_macro` {IN_THE_COMPILER}")),
        ("#![feature(rustc_attrs)]", &format!("`#![feature]` {LIMIT}")),
        ("#![recursion_limit = \"1000000\"]", &format!("`#[recursion_limit]` {LIMIT}")),
    ]);
    passes(&[
        "#[cfg(feature = \"x\")] fn f() {}",
        "fn f(used: usize, link: (usize, usize)) {}",
        "#![allow(dead_code)]",
    ]);
}

#[test]
fn panic_hooks_and_catching_panics_are_refused() {
    refused(&[
        ("fn f() { std::panic::set_hook(Box::new(|_| {})); }", &format!("`set_hook` {HOOK}")),
        ("use std::panic::{take_hook as t};", &format!("`take_hook` {HOOK}")),
        (
            "fn f() { let _ = std::panic::catch_unwind(|| 1); }",
            "`catch_unwind` catches panics, and where answers run a \
            panic ends the call. Ask for the condition before it panics.",
        ),
    ]);
}

#[test]
fn what_the_standard_library_has_of_a_system_is_refused_with_the_reason() {
    refused(&[
        (
            "fn f() { std::process::exit(0) }",
            "`std::process`: where answers run, there is no process to end or to start. A \
            call ends when it returns, or panics.",
        ),
        (
            "use std::{collections::BTreeMap, fs::{self, File}};",
            "`std::fs`: where answers run, there are no files. An answer \
            has its arguments, and gives its output back.",
        ),
        (
            "use ::std::net::TcpStream;",
            "`std::net`: where answers run, there is no network. An answer has its arguments, and \
            gives its output back.",
        ),
        (
            "use std::r#thread;",
            "`std::thread`: where answers run, there is one thread, and no way to start or to stop \
            another. Compute one thing after the other.",
        ),
        (
            "use std::os::fd::AsFd;",
            "`std::os`: where answers run, there is no operating system. An answer has its \
                arguments, and gives its output back.",
        ),
    ]);
    passes(&[
        "fn f() { let std = 2.0; let process = |x: f64| x * std; process(1.0); }",
        "use std::f64::consts::PI;",
    ]);
}

#[test]
fn only_data_are_taken_from_the_declaration_of_the_exercises() {
    for text in [
        "use exercise_spec::check::compare;",
        "use exercise_spec::answer::{Native, Transport};",
        "use exercise_spec as e;",
        "use exercise_spec::*;",
        "use exercise_spec::{self, fill_in::Layout};",
        "use exercise_spec::{fill_in::Layout, {answer::Native}};",
        "use exercise_spec::{fill_in::{Layout, Slide}, ::check::Failure};",
        "use exercise_spec::fill_in::{Layout, Slide};",
        "use exercise_spec::{camera::Camera, fill_in::{self, Layout}};",
        "use exercise_spec::left_perturbation::*;",
        "use exercise_spec::left_perturbation::left_jacobian;",
        "use exercise_spec::left_perturbation::Case;",
        "#[cfg(test)] struct S(f64); use exercise_spec::left_perturbation::Case;",
        "struct S(#[cfg(test)] fn(f64) -> f64, exercise_spec::left_perturbation::Case);",
        "#[cfg(all())] mod tests { use exercise_spec::left_perturbation::Case; }",
        "macro_rules! m { ($a:tt $b:tt $($c:tt)*) => { $($c)* } } m!(#[cfg(test)] use \
            exercise_spec::left_perturbation::Case;);",
        "use exercise_spec::left_perturbation::EXERCISE;",
        "fn f() { exercise_spec::EXERCISES.len(); }",
        "macro_rules! m { ($a:ident :: $b:ident $c:ident) => { use $a::$c::Native; } } \
            m!(exercise_spec::fill_in answer);",
        "exercise_spec::signatures! { fn f(x: f64) -> f64; }",
    ] {
        refused(&[(text, SPEC)]);
    }
    passes(&[
        "use exercise_spec::fill_in::Layout as Known;",
        "#[cfg(test)] mod tests { use exercise_spec::left_perturbation::Case; }",
        "#[cfg(test)] #[allow(x)] pub(crate) mod tests { use exercise_spec::fill_in::EXERCISE; }",
        "#[cfg(test)] use exercise_spec::{left_perturbation::{Case, Side}}; fn f() {}",
        "fn f(layout: exercise_spec::fill_in::Layout) {}",
    ]);
}

#[test]
fn paths_out_of_the_answer_are_refused() {
    refused(&[
        (
            "use crate::call;",
            "`crate::` leads out of the answer, and each answer stands alone. Write `self::`, or \
                `super::` in a module of it.",
        ),
        ("use super::other;", UP),
        ("mod tests { use super::super::other; }", UP),
        ("struct r#mod; impl Up for r#mod where { fn up() { super::f() } }", UP),
        (
            "macro_rules! m { (mod a { $($x:tt)* }) => { $($x)* } } m!(mod a { super::f(); });",
            &format!("{IN_MACRO}\nline 3: {UP}"),
        ),
        ("#[macro_use] mod a { macro_rules! m { () => { super::f() } } }", UP),
        ("pub(super) fn f() {}", VISIBLE),
        ("pub(in super) fn f() {}", VISIBLE),
    ]);
    passes(&[
        "mod tests { use super::*; }",
        "mod a { pub(super) fn f() {} }",
        "#[cfg(test)] mod tests { fn f() { std::fs::read(\"x\"); } }",
        "macro_rules! m { () => { mod a { use super::*; } } }",
        "pub(crate) fn f() {}",
        "mod a { mod b { use super::super::f; } }",
    ]);
}

#[test]
fn items_of_the_library_that_are_the_answer_are_refused_kindly() {
    for (slug, text, name) in [
        ("fill_in", "use vislam::marginalization::marginalize as m;", "marginalize"),
        ("fill_in", "fn f() { vislam::marginalization::r#marginalize(); }", "marginalize"),
        ("fill_in", "use vislam::least_squares::LandmarkElimination;", "least_squares"),
        ("fill_in", "use vislam::marginalization::*; fn f() { marginalize(); }", "marginalize"),
        ("left_perturbation", "fn f(c: Camera) { c.pinhole().jacobians(); }", "jacobians"),
        ("fill_in", "use vislam::marginalization::{Couplings, fill_in};", "Couplings"),
        ("fill_in", "use vislam::marginalization::{Information, divergence};", "Information"),
        ("null_space", "use vislam::msckf::LinearizedTrack;", "msckf"),
        ("null_space", "fn f() { vislam::filtering::correct_root(); }", "filtering"),
        ("along_or_across", "use vislam::msckf::landmark;", "msckf"),
        ("nees_diagnosis", "use vislam::filtering::NeesBand;", "NeesBand"),
        ("nees_diagnosis", "use vislam::filtering::attitude_in_world;", "attitude_in_world"),
        ("nees_diagnosis", "fn f() { vislam::filtering::nees(&error, &covariance); }", "nees"),
        (
            "nees_diagnosis",
            "use vislam::filtering::*; fn f() { chi_square_band(); }",
            "chi_square_band",
        ),
        ("square_root_prior", "use vislam::marginalization::SquareRoot;", "marginalization"),
        ("square_root_prior", "fn f() { vislam::filtering::carry_root(); }", "filtering"),
        ("square_root_prior", "fn f(m: DMatrix<f32>) { m.qr(); }", "qr"),
        ("square_root_prior", "fn f(m: DMatrix<f32>) { m.full_piv_lu(); }", "full_piv_lu"),
        ("null_space", "fn f(m: DMatrix<f64>) { m.qr(); }", "qr"),
        ("null_space", "fn f(m: DMatrix<f64>) { m.clone().svd::<f64>(true, true); }", "svd"),
        ("outlier_rescue", "use vislam::least_squares::*; fn f(kernel: Kernel) {}", "Kernel"),
        ("along_or_across", "use vislam::two_views::skew;", "two_views"),
        (
            "left_perturbation",
            "fn f() { let jacobians = camera.pinhole().jacobians(); }",
            "jacobians",
        ),
        (
            "left_perturbation",
            "type P = vislam::reprojection::Pinhole; fn f() { P::jacobians(); }",
            "jacobians",
        ),
        (
            "left_perturbation",
            "fn f() { <vislam::reprojection::Pinhole>::jacobians(); }",
            "jacobians",
        ),
        (
            "left_perturbation",
            "#[cfg(test)] fn jacobians() {} fn f(c: Camera) { c.pinhole().jacobians(); }",
            "jacobians",
        ),
        (
            "left_perturbation",
            "use vislam::{bundle_adjustment as b, manifold};",
            "bundle_adjustment",
        ),
        ("left_perturbation", "fn f() { vislam::factors::pixel_by_state(); }", "factors"),
        ("left_perturbation", "use vislam::factors::{PixelByBody, PixelByCamera};", "factors"),
        ("left_perturbation", "use vislam::observability::Window;", "observability"),
        (
            "outlier_rescue",
            "mod parts { pub use vislam::least_squares::*; } fn f() { parts::Kernel::Huber(1.0); }",
            "Kernel",
        ),
        ("outlier_rescue", "use vislam::least_squares::{Dense, Problem, Search};", "Problem"),
        ("outlier_rescue", "use vislam::factors::PixelByCamera;", "factors"),
        ("outlier_rescue", "fn f(w: vislam::observability::Window) {}", "observability"),
        ("residual_jacobian", "use vislam::observability::Window as Whole;", "observability"),
        ("residual_jacobian", "use vislam::factors::InertialFactor;", "factors"),
        ("residual_jacobian", "use vislam::preintegration::linearize as l;", "linearize"),
        ("scale_and_gravity", "use vislam::factors::{InertialFactor, PixelByBody};", "factors"),
        ("scale_and_gravity", "use vislam::least_squares::NullSpace;", "least_squares"),
        (
            "scale_and_gravity",
            "fn f() { vislam::observability::Similarity { scale }; }",
            "observability",
        ),
        ("scale_null_space", "use vislam::observability::{Direction, Window};", "observability"),
        ("scale_null_space", "use vislam::least_squares::{NullSpace, Spectrum};", "least_squares"),
        ("scale_null_space", "use vislam::factors::PixelByCamera;", "factors"),
        ("scale_null_space", "use vislam::bundle_adjustment::Solver;", "bundle_adjustment"),
        ("stereo_gauge", "use vislam::observability::Window;", "observability"),
        ("stereo_gauge", "use vislam::factors::StereoByPose;", "factors"),
        (
            "stereo_gauge",
            "fn f(p: vislam::least_squares::Problem, v: &Values) { p.null_space(v); }",
            "least_squares",
        ),
        ("null_space", "use vislam::least_squares::Spectrum;", "least_squares"),
        ("null_space", "fn f() { vislam::bundle_adjustment::Solver::new(); }", "bundle_adjustment"),
        ("fill_in", "use vislam::datasets::bal::read_bal;", "bal"),
        ("left_perturbation", "use vislam::datasets::bal as b;", "bal"),
        ("null_space", "fn f() { vislam::datasets::bal::read_bal::<6>(text); }", "bal"),
        ("outlier_rescue", "use vislam::datasets::{bal::read_bal, tracks};", "bal"),
        ("scale_null_space", "use vislam::datasets::*; fn f() { bal::read_bal(); }", "bal"),
        ("stereo_gauge", "use vislam::datasets::bal::*;", "bal"),
        ("noise_growth", "use vislam::preintegration::{Block, Turning};", "preintegration"),
        (
            "noise_growth",
            "use vislam::*; fn f() { preintegration::preintegrate(); }",
            "preintegration",
        ),
        (
            "null_space",
            "fn f() { nalgebra::linalg::Bidiagonal::new(square).unpack(); }",
            "Bidiagonal",
        ),
        ("null_space", "fn f() { square.try_svd(true, false, f64::EPSILON, 0); }", "try_svd"),
        ("null_space", "fn f() { square.svd_unordered(true, false); }", "svd_unordered"),
        ("null_space", "fn f() { square.symmetric_eigen(); }", "symmetric_eigen"),
        ("null_space", "use nalgebra::*; fn f() { ColPivQR::new(square); }", "ColPivQR"),
    ] {
        assert_eq!(screen(slug, text), Err(the_librarys(name)), "{text}");
    }
}

#[test]
fn a_variable_or_a_field_may_be_called_so() {
    for (slug, text) in [
        ("fill_in", "// marginalize\nfn f() -> &'static str { \"marginalize\" }"),
        ("residual_jacobian", "use nalgebra::*; fn f() { let predict = 1.0; predict; }"),
        ("left_perturbation", "fn f(jacobians: Vec<f64>) { jacobians.len(); }"),
        ("left_perturbation", "struct S { jacobians: f64 } fn f(s: S) -> f64 { s.jacobians }"),
        ("null_space", "fn f() { let qr = 1.0; let svd = qr; }"),
        ("stereo_gauge", "use vislam::manifold::marginalize;"),
        ("outlier_rescue", "#[cfg(test)] mod tests { use vislam::least_squares::Kernel; }"),
        ("null_space", "use nalgebra::*; fn f() { let qr = |x: f64| x; qr(1.0); }"),
        (
            "residual_jacobian",
            "fn f(predict: f64) { println!(\"{}\", predict); assert!(!(predict > 1.0)); }",
        ),
        (
            "residual_jacobian",
            "macro_rules! m { ($predict:expr) => { $predict } } fn f(predict: f64) { vec![predict]; }",
        ),
    ] {
        assert_eq!(screen(slug, text), Ok(()), "{text}");
    }
}

#[test]
fn no_item_of_an_answer_may_be_called_so() {
    for (slug, text, name) in [
        ("left_perturbation", "struct S; impl S { fn jacobians(&self) {} }", "jacobians"),
        ("left_perturbation", "macro_rules! jacobians { () => {} }", "jacobians"),
        ("null_space", "trait T { fn qr(self); } fn f(m: DMatrix<f64>) { m.qr(); }", "qr"),
        ("null_space", "type QR = f64;", "QR"),
        ("null_space", "mod qr {}", "qr"),
        ("null_space", "use std::mem::swap as svd;", "svd"),
        ("outlier_rescue", "struct Kernel; mod tests { use super::{Kernel, f}; }", "Kernel"),
        ("outlier_rescue", "enum Problem { Fine }", "Problem"),
        ("residual_jacobian", "fn predict() {} fn f() { predict(); }", "predict"),
        ("residual_jacobian", "macro_rules! m { () => { fn predict() {} } }", "predict"),
    ] {
        let refusal = screen(slug, text).expect_err(text);
        let told = format!(
            "line 1: `{name}` is what the library calls something that does what this exercise \
                asks for, and nothing of yours may have its name. Give it another one."
        );
        assert!(refusal.lines().any(|line| line == told), "{text}: {refusal}");
        let its = exercise(slug).expect("an exercise");
        assert!(taken(its, text).contains(&name), "the students' tests say nothing of {text}");
        assert_eq!(taken(its, &format!("// {text}\nfn f() {{ let {name} = 1; }}")), [""; 0]);
    }
}

/// Texts, with the names of the library that something of an answer gets in them.
const GIVEN: &[(&str, &str, &[&str])] = &[
    ("residual_jacobian", "fn r#predict() {}", &["predict"]),
    ("residual_jacobian", "fn /* mine */ predict() {}", &["predict"]),
    ("residual_jacobian", "fn // mine\npredict() {}", &["predict"]),
    ("residual_jacobian", "#[cfg(test)] fn predict() {}", &[]),
    ("residual_jacobian", "#[cfg(test)] mod tests { fn predict() {} } fn f() {}", &[]),
    ("residual_jacobian", "#[cfg(test)] fn f() {} fn predict() {}", &["predict"]),
    ("residual_jacobian", "/* fn predict() {} */ fn f() {}", &[]),
    ("residual_jacobian", "/// fn predict() {}\nfn f() {}", &[]),
    ("residual_jacobian", "fn f() -> &'static str { \"as predict says // fn predict\" }", &[]),
    ("residual_jacobian", "fn f() -> &'static str { r#\"fn predict() {}\"# }", &[]),
    ("null_space", "fn f() { panic!(\"rank, as svd says\") }", &[]),
    ("outlier_rescue", "fn f(robust: fn(Kernel) -> f64) {}", &[]),
    ("outlier_rescue", "struct S(Kernel); enum E { Kernel }", &[]),
];

#[test]
fn the_students_tests_refuse_the_names_that_the_grader_refuses() {
    for (slug, text, given) in GIVEN {
        assert_eq!(taken(exercise(slug).expect("an exercise"), text), *given, "{text}");
        let told = screen(slug, text).err().unwrap_or_default();
        let told = told.matches("nothing of yours may have its name").count();
        assert_eq!(told, given.len(), "{text}");
    }
}

#[test]
fn a_name_in_a_macro_could_become_the_librarys() {
    for (slug, text, name) in [
        (
            "left_perturbation",
            "macro_rules! ask { ($of:expr, $m:ident) => { $of.$m() } } fn f() { ask!(p, jacobians); }",
            "jacobians",
        ),
        ("outlier_rescue", "macro_rules! kernel { () => { Kernel } }", "Kernel"),
    ] {
        let told = format!(
            "line 1: `{name}` stands in a macro of yours, and the library has a `{name}` that does \
                what this exercise asks for. If this is something else, give it another name."
        );
        assert_eq!(screen(slug, text), Err(told), "{text}");
    }
}

#[test]
fn types_of_other_exercises_are_refused() {
    for (slug, text) in [
        ("left_perturbation", "use exercise_spec::camera::Camera;"),
        ("left_perturbation", "use exercise_spec::outlier_rescue::Camera;"),
        ("fill_in", "use exercise_spec::null_space::Projected;"),
        ("fill_in", "use exercise_spec::left_perturbation::Side;"),
    ] {
        assert_eq!(screen(slug, text), Err(format!("line 1: {SPEC}")), "{text}");
    }
    for (slug, text) in [
        ("outlier_rescue", "use exercise_spec::camera::Camera;"),
        ("left_perturbation", "use exercise_spec::left_perturbation::{Camera, Side as Which};"),
        (
            "left_perturbation",
            "fn f(side: Side) -> bool { matches!(side, exercise_spec::left_perturbation::Side::Left) }",
        ),
    ] {
        assert_eq!(screen(slug, text), Ok(()), "{text}");
    }
}

#[test]
fn comments_strings_and_lifetimes_are_not_words() {
    passes(&[
        "// unsafe extern include_str!(\"x\")\n/* #[no_mangle] */ fn f() -> &'static str { \
            \"std::process::exit unsafe\" }",
        "/// mod helper; and unsafe\nfn f<'env>(x: &'env str) {}",
        "",
        "// nothing but this",
        "this is no ; Rust [ but ] tokens",
    ]);
}

#[test]
fn a_first_line_that_the_compiler_drops_is_refused() {
    let refusal = "line 1: leave out the line that begins with `#!`.";
    for first in ["#!x /*", "#!x [\"", "#!", "#! [allow(x)]", "#!\u{a0}[", "#!/**/["] {
        for mark in ["", "\u{feff}"] {
            let text = format!("{mark}{first}\nfn f() {{ std::process::exit(0) }}\n// */ \"]\n");
            assert_eq!(screen("fill_in", &text), Err(refusal.to_owned()), "{text}");
        }
    }
    let said = self::refusal("\n---\n/*\n---\nfn f() { unsafe {} }\n// */");
    assert_eq!(said, "line 2: leave out the lines of `---` and what is between them.");
    passes(&["#![allow(x)]\nfn f() {}", "\u{feff}#![allow(x)]", "\u{feff}\nfn f() {}", "\n#!x\n"]);
}

#[test]
fn letters_of_other_alphabets_are_names_and_the_sign_of_the_kelvin_is_a_letter() {
    let text = "use vislam::least_squares::\u{212a}ernel as Known;";
    assert_eq!(screen("outlier_rescue", text), Err(the_librarys("Kernel")));
    passes(&["fn f(σ: f64) -> f64 { let Δφ = σ; Δφ }"]);
}

#[test]
fn what_cannot_be_read_says_from_which_line() {
    for text in ["fn f() {}\nfn g() { \"", "fn f() {}\n}", "fn f() {}\n/* /* */"] {
        let said = refusal(text);
        let end = ": from here on this cannot be read as Rust. A quote, a comment or a bracket \
            may have no end; the compiler says more.";
        assert!(said.starts_with("line ") && said.ends_with(end), "{said}");
    }
}

#[test]
fn nested_brackets_are_counted_and_do_not_fill_the_stack() {
    let nested =
        |count: usize| format!("fn f() {{\n{}{}\n}}", "(".repeat(count), ")".repeat(count));
    passes(&[&nested(98)]);
    let refusals = move || {
        for text in [nested(100), nested(127_000), "(".repeat(127_000), "[{".repeat(60_000)] {
            let said = refusal(&text);
            let deep = "line 2: more than 100 brackets are open here, one in the other. Give \
                parts of it names of their own.";
            assert!(said == deep || said.contains("cannot be read as Rust"), "{said}");
        }
    };
    let small = std::thread::Builder::new().stack_size(256 << 10);
    small.spawn(refusals).expect("a thread").join().expect("no overflow");
}

#[test]
fn many_findings_are_cut_short() {
    let said = refusal(&"fn f() { unsafe {} }\n".repeat(1000));
    assert_eq!(said.lines().count(), 6, "{said}");
    assert_eq!(said.lines().last(), Some("and 995 more of the kind"));
}

#[test]
fn a_long_answer_is_read_in_a_moment() {
    let text = "fn f() { let x = 1 + 1; }\n".repeat(9_800);
    let begun = std::time::Instant::now();
    assert_eq!(screen("fill_in", &text), Ok(()));
    for part in ["#[cfg(test)] ", "#[cfg(test)] use a;", "marginalize::", "use {a::{b,", "super::"]
    {
        let _ = screen("fill_in", &part.repeat(250_000 / part.len()));
    }
    let branches = "marginalize, ".repeat(19_000);
    assert!(screen("fill_in", &format!("use vislam::{{{branches}}};")).is_err());
    assert!(begun.elapsed().as_secs() < 5, "{:?}", begun.elapsed());
}
