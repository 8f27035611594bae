//! What the source screen refuses, what it says then, and what it lets pass.

use std::fs;

use exercise_spec::EXERCISES;
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
const SPEC: &str = "`exercise_spec`: an answer takes the types of its arguments from it and \
    nothing else, and by a `use` as in the skeleton. Take the lines of the skeleton.";

fn refusal(text: &str) -> String {
    screen("fill_in", text).expect_err(text)
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
fn reference_answers_and_skeletons_pass() {
    for folder in ["solutions/src", "exercises/src", "exercises/skeletons/1"] {
        for exercise in EXERCISES {
            let path = grader::repository().join(folder).join(format!("{}.rs", exercise.slug));
            let text = fs::read_to_string(&path).expect("an answer");
            assert_eq!(screen(exercise.slug, &text), Ok(()), "{}", path.display());
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
    ]);
}

#[test]
fn a_module_in_another_file_is_refused() {
    let in_macro = "`mod` in a macro can become a module in another file, and each exercise is one \
        file. Write the module without the macro.";
    let told = |name: &str| {
        format!(
            "`mod {name};` reads another file, and each exercise is one file. Put the content of \
                the module here: `mod {name} {{ … }}`."
        )
    };
    refused(&[
        ("mod helper;", &told("helper")),
        (
            "pub(super) mod helper;",
            &format!(
                "{}\nline 3: `super` leads out of the answer here, and each answer stands \
            alone. Leave it out.",
                told("helper")
            ),
        ),
        ("macro_rules! m { ($name:ident) => { mod $name; } }", in_macro),
        ("macro_rules! m { ($a:tt $b:tt $c:tt) => { $b $a $c } } m!(helper mod ;);", in_macro),
        ("#[path = \"/etc/x.rs\"] mod helper { }", &format!("`#[path]` {FILES}")),
        ("#[cfg_attr(all(), path = \"x\")] mod helper { }", &format!("`#[path]` {FILES}")),
    ]);
    passes(&["mod helper { pub fn f() {} }", "fn f() { let mut path = 1; path = 2; }"]);
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
        "use exercise_spec::left_perturbation::EXERCISE;",
        "fn f() { exercise_spec::EXERCISES.len(); }",
        "macro_rules! m { ($a:ident :: $b:ident $c:ident) => { use $a::$c::Native; } } \
            m!(exercise_spec::fill_in answer);",
        "exercise_spec::signatures! { fn f(x: f64) -> f64; }",
    ] {
        refused(&[(text, SPEC)]);
    }
    passes(&[
        "use exercise_spec::left_perturbation::{Camera, Side as Which};",
        "use ::exercise_spec::camera::Camera;",
        "use exercise_spec::{camera::Camera, fill_in::Layout};",
        "fn f(layout: exercise_spec::fill_in::Layout) {}",
    ]);
}

#[test]
fn paths_out_of_the_answer_are_refused() {
    let up = "`super` leads out of the answer here, and each answer stands alone. Leave it out.";
    refused(&[
        (
            "use crate::call;",
            "`crate::` leads out of the answer, and each answer stands alone. Write `self::`, or \
                `super::` in a module of it.",
        ),
        ("use super::other;", up),
        ("mod tests { use super::super::other; }", up),
    ]);
    passes(&[
        "mod tests { use super::*; }",
        "pub(crate) fn f() {}",
        "mod a { mod b { use super::super::f; } }",
    ]);
}

#[test]
fn items_of_the_library_that_are_the_answer_are_refused_kindly() {
    let told = |name: &str| {
        format!(
            "line 1: `{name}` of the library does what this exercise asks for. Write it yourself, \
                of the parts that its page names."
        )
    };
    for (slug, text, name) in [
        ("fill_in", "use vislam::marginalization::marginalize as m;", "marginalize"),
        ("fill_in", "fn f() { vislam::marginalization::r#marginalize(); }", "marginalize"),
        ("fill_in", "use vislam::marginalization::*; fn f() { marginalize(); }", "marginalize"),
        ("left_perturbation", "fn f(c: Camera) { c.pinhole().jacobians(); }", "jacobians"),
        ("null_space", "fn f(m: DMatrix<f64>) { m.qr(); }", "qr"),
        ("null_space", "fn f(m: DMatrix<f64>) { m.clone().svd::<f64>(true, true); }", "svd"),
        ("outlier_rescue", "use vislam::least_squares::*; fn f(kernel: Kernel) {}", "Kernel"),
        ("along_or_across", "use vislam::two_views::skew;", "two_views"),
    ] {
        assert_eq!(screen(slug, text), Err(told(name)), "{text}");
    }
}

#[test]
fn what_an_answer_calls_so_itself_is_not_the_librarys() {
    for (slug, text) in [
        ("fill_in", "// marginalize\nfn f() -> &'static str { \"marginalize\" }"),
        ("fill_in", "fn marginalize() {} fn f() { marginalize(); self::marginalize(); }"),
        (
            "residual_jacobian",
            "struct M; impl M { fn predict(&self) {} } fn f(m: M) { m.predict(); M::predict(&m); }",
        ),
        ("residual_jacobian", "use nalgebra::*; fn f() { let predict = 1.0; predict; }"),
        ("left_perturbation", "fn f(jacobians: Vec<f64>) { jacobians.len(); }"),
        ("left_perturbation", "struct S { jacobians: f64 } fn f(s: S) -> f64 { s.jacobians }"),
        ("null_space", "fn f() { let qr = 1.0; let svd = qr; }"),
        ("stereo_gauge", "use vislam::manifold::marginalize;"),
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
    assert!(begun.elapsed().as_secs() < 5, "{:?}", begun.elapsed());
}
