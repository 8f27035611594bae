//! Submissions that reach for what is hidden while they are compiled, and that bring tools along.

use std::path::Path;

use crate::corpus::Want::{DoesNotCompile, Refused, Runs};
use crate::corpus::{Hostile, LEFT, every, folder, put, right, right_and, row, skeleton};

pub fn all() -> Vec<Hostile> {
    let mut all = files();
    all.extend(modules());
    all.extend(environment());
    all.extend(tools());
    all
}

const NO_OTHER_FILE: &str = "an answer is compiled without any other file";
const HIDDEN: &str = "/../tests/src/left_perturbation.rs";

fn files() -> Vec<Hostile> {
    let hidden = format!("{}{HIDDEN}", env!("CARGO_MANIFEST_DIR"));
    let read = |by: &str| right_and(LEFT, &format!("pub const HIDDEN: &str = {by}(\"{hidden}\");"));
    let macros = |rules: &str, call: &str| {
        right_and(
            LEFT,
            &format!("macro_rules! m {{ {rules} }}\npub const HIDDEN: &str = m!({call});"),
        )
    };
    vec![
        row("reads a hidden file as text", LEFT, read("include_str!"), Refused, NO_OTHER_FILE),
        row(
            "reads a hidden file as bytes",
            LEFT,
            right_and(LEFT, "pub const KEY: &[u8] = include_bytes!(\"/etc/shadow\");"),
            Refused,
            NO_OTHER_FILE,
        ),
        row(
            "reads the reference answer as code",
            LEFT,
            "include!(\"../../../solutions/src/left_perturbation.rs\");".to_owned(),
            Refused,
            NO_OTHER_FILE,
        ),
        row("reads by a raw identifier", LEFT, read("r#include_str!"), Refused, NO_OTHER_FILE),
        row("reads by a full path", LEFT, read("::core::include_str!"), Refused, NO_OTHER_FILE),
        row(
            "reads by another name",
            LEFT,
            right_and(
                LEFT,
                &format!("use std::include_str as x;\npub const HIDDEN: &str = x!(\"{hidden}\");"),
            ),
            Refused,
            NO_OTHER_FILE,
        ),
        row(
            "reads by a name that a macro is given",
            LEFT,
            macros("($name:ident) => { $name!(\"/etc/passwd\") }", "include_str"),
            Refused,
            "so that nobody can see which",
        ),
        row(
            "reads by words that a macro puts in order",
            LEFT,
            macros("($a:tt $b:tt $c:tt) => { $c $a $b }", "! (\"/etc/passwd\") include_str"),
            Refused,
            NO_OTHER_FILE,
        ),
        row(
            "reads for its documentation",
            LEFT,
            right_and(LEFT, &format!("#[doc = include_str!(\"{hidden}\")]\npub fn f() {{}}")),
            Refused,
            NO_OTHER_FILE,
        ),
        row(
            "reads on a condition",
            LEFT,
            right_and(
                LEFT,
                "#[cfg_attr(not(test), doc = include_str!(\"/etc/passwd\"))]\npub fn f() {}",
            ),
            Refused,
            NO_OTHER_FILE,
        ),
    ]
}

fn modules() -> Vec<Hostile> {
    vec![
        row(
            "is a module in another place",
            LEFT,
            right_and(LEFT, "#[path = \"/etc/passwd\"]\nmod passwords;"),
            Refused,
            NO_OTHER_FILE,
        ),
        row(
            "is a module in another place on a condition",
            LEFT,
            right_and(LEFT, "#[cfg_attr(all(), path = \"/etc/passwd\")]\nmod passwords;"),
            Refused,
            NO_OTHER_FILE,
        ),
        row(
            "is a module in another place by a macro",
            LEFT,
            right_and(
                LEFT,
                "macro_rules! m { ($p:ident $a:tt $b:tt $c:tt) => { #[$p = \"/etc/passwd\"] $b $a \
                    $c } }\nm!(path passwords mod ;);",
            ),
            Refused,
            "`mod` in a macro can become a module in another file",
        ),
        folder(
            "brings a module along",
            |root| {
                put(root, "src/left_perturbation.rs", "mod helper;\npub use helper::*;\n");
                put(root, "src/helper.rs", right(LEFT));
                put(root, "src/left_perturbation/helper.rs", right(LEFT));
            },
            Refused,
            "Put the content of the module here",
        ),
        row(
            "takes what is beside it in the grader's own tree",
            LEFT,
            right_and(LEFT, "pub use crate::SAID;"),
            Refused,
            "each answer stands alone",
        ),
        row(
            "climbs to the grader's own tree",
            LEFT,
            right_and(LEFT, "mod a { pub use super::super::super::call; }"),
            Refused,
            "each answer stands alone",
        ),
        row(
            "climbs out of what looks like a module",
            LEFT,
            right_and(
                LEFT,
                "pub struct r#mod;\ntrait Up { fn up(); }\nimpl Up for r#mod where { fn up() { \
                    super::allocate(9); } }",
            ),
            Refused,
            "each answer stands alone",
        ),
        row(
            "names the hidden checks",
            LEFT,
            right_and(LEFT, "use book_tests::hidden_checks;"),
            DoesNotCompile,
            "book_tests",
        ),
        row(
            "names the reference answers",
            LEFT,
            "pub use solutions::left_perturbation::*;".to_owned(),
            DoesNotCompile,
            "solutions",
        ),
    ]
}

fn environment() -> Vec<Hostile> {
    let no_place = "an answer must not depend on where it is compiled";
    vec![
        row(
            "reads the environment",
            LEFT,
            right_and(LEFT, "pub const PATH: &str = env!(\"PATH\");"),
            Refused,
            no_place,
        ),
        row(
            "asks for the environment",
            LEFT,
            right_and(LEFT, "pub const TOKEN: Option<&str> = option_env!(\"GITHUB_TOKEN\");"),
            Refused,
            no_place,
        ),
        row(
            "reads the environment by another name",
            LEFT,
            right_and(LEFT, "use core::{env as e};\npub const PATH: &str = e!(\"PATH\");"),
            Refused,
            no_place,
        ),
        row(
            "reads the environment by words that a macro puts in order",
            LEFT,
            right_and(
                LEFT,
                "macro_rules! m { ($a:tt $b:tt $c:tt) => { $c $a $b } }\npub const PATH: &str = \
                    m!(! (\"PATH\") env);",
            ),
            Refused,
            no_place,
        ),
        row(
            "uses what only a compiler of tomorrow has",
            LEFT,
            format!("#![feature(rustc_attrs, core_intrinsics)]\n{}", right(LEFT)),
            Refused,
            "the grader compiles all answers alike",
        ),
        row(
            "changes the limits of the compiler",
            LEFT,
            format!("#![recursion_limit = \"100000000\"]\n{}", right(LEFT)),
            Refused,
            "the grader compiles all answers alike",
        ),
        row(
            "forbids its own warnings",
            LEFT,
            format!("#![deny(warnings)]\n#![deny(dead_code)]\n{}\nfn unused() {{}}", right(LEFT)),
            DoesNotCompile,
            "function `unused` is never used",
        ),
        row(
            "allows itself what is forbidden",
            LEFT,
            format!("#![allow(unsafe_code)]\n{}", right(LEFT)),
            DoesNotCompile,
            "unsafe_code",
        ),
        row(
            "wants no standard library",
            LEFT,
            format!("#![no_std]\n#![no_main]\n#![crate_type = \"bin\"]\n{}", right(LEFT)),
            Runs(1.0),
            "",
        ),
    ]
}

/// An answer that is right only where somebody has set `cheat`.
fn conditional(root: &Path) {
    let text = every(LEFT, "cheat!()", "");
    let macros = "#[cfg(cheat)]\nmacro_rules! cheat { () => { Default::default() } }\n\
        #[cfg(not(cheat))]\nmacro_rules! cheat { () => { todo!(\"no cheat\") } }\n\n";
    let text = text.replacen("use exercise_spec", &format!("{macros}use exercise_spec"), 1);
    put(root, "exercises/src/left_perturbation.rs", text);
}

fn tools() -> Vec<Hostile> {
    let nothing = Runs(0.0);
    vec![
        folder(
            "brings a build script",
            |root| {
                conditional(root);
                let script = "fn main() { println!(\"cargo:rustc-cfg=cheat\"); loop {} }";
                put(root, "build.rs", script);
                put(root, "exercises/build.rs", script);
            },
            nothing,
            "no cheat",
        ),
        folder(
            "brings settings for cargo",
            |root| {
                conditional(root);
                let settings = "[build]\nrustflags = [\"--cfg\", \"cheat\"]\nrustc-wrapper = \
                    \"/bin/true\"\n[env]\nRUSTC_BOOTSTRAP = \"1\"\n";
                put(root, ".cargo/config.toml", settings);
                put(root, "exercises/src/.cargo/config.toml", settings);
            },
            nothing,
            "no cheat",
        ),
        folder(
            "brings a manifest that patches the library",
            |root| {
                put(root, "src/left_perturbation.rs", skeleton(LEFT));
                put(
                    root,
                    "Cargo.toml",
                    "[package]\nname = \"exercise-spec\"\nversion = \
                        \"99.0.0\"\n[patch.crates-io]\nnalgebra = { path = \"nalgebra\" \
                        }\n[lib]\nproc-macro = true\n",
                );
                put(root, "nalgebra/src/lib.rs", "compile_error!(\"mine\");");
            },
            nothing,
            "not written yet",
        ),
        folder(
            "brings a macro crate",
            |root| {
                put(root, "src/left_perturbation.rs", "cheat::answers!();\n");
                put(
                    root,
                    "cheat/Cargo.toml",
                    "[package]\nname = \"cheat\"\n[lib]\nproc-macro = true\n",
                );
                put(
                    root,
                    "cheat/src/lib.rs",
                    "#[proc_macro] pub fn answers(_: T) -> T { loop {} }",
                );
            },
            DoesNotCompile,
            "cheat",
        ),
        folder(
            "is a macro crate",
            |root| {
                let text = "extern crate proc_macro;\n#[proc_macro]\npub fn m(t: \
                    proc_macro::TokenStream) -> proc_macro::TokenStream { t }\n";
                put(root, "src/left_perturbation.rs", text);
            },
            Refused,
            "runs in the compiler",
        ),
        folder(
            "brings a toolchain",
            |root| {
                conditional(root);
                put(root, "rust-toolchain.toml", "[toolchain]\npath = \"toolchain\"\n");
                put(root, "rust-toolchain", "[toolchain]\nchannel = \"nightly\"\n");
                put(root, "toolchain/bin/rustc", "#!/bin/sh\ntouch /tmp/hostile-toolchain-ran\n");
            },
            nothing,
            "no cheat",
        ),
        folder(
            "brings a stale target folder",
            |root| {
                conditional(root);
                put(root, "target/debug/deps/libexercise_spec-0000000000000000.rlib", "!<arch>\n");
                put(root, "target/wasm32-unknown-unknown/debug/answers.wasm", "\0asm\x01\0\0\0");
                put(root, "exercises/src/answers.wasm", "\0asm\x01\0\0\0");
                put(root, "exercises/src/answers.d", "answers.wasm: lib.rs\n");
            },
            nothing,
            "no cheat",
        ),
        folder(
            "brings checks that always pass",
            |root| {
                put(root, "exercises/src/left_perturbation.rs", skeleton(LEFT));
                put(root, "exercises/tests/left_perturbation.rs", "fn main() {}");
                put(root, "exercises/spec/src/left_perturbation.rs", "pub fn checks() {}");
                put(root, "grader/points.toml", "[points]\nleft_perturbation = 1000\n");
                put(root, "grade.json", "{\"earned\": 1000}");
            },
            nothing,
            "not written yet",
        ),
        folder(
            "brings the tree that the grader makes",
            |root| {
                put(root, "src/lib.rs", "#[unsafe(no_mangle)] pub fn call() {}");
                put(root, "src/left_perturbation.rs", skeleton(LEFT));
                put(root, "src/answers/left_perturbation.rs", right(LEFT));
            },
            nothing,
            "not written yet",
        ),
    ]
}
