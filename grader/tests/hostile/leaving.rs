//! Submissions that leave, that forge what is said of them, and that take the place of the program
//! around them.

use crate::corpus::Want::{DoesNotCompile, Refused, Runs};
use crate::corpus::{Hostile, LEFT, every, right_and, row};

pub fn all() -> Vec<Hostile> {
    let mut all = processes();
    all.extend(forgeries());
    all.extend(hooks());
    all.extend(symbols());
    all
}

fn processes() -> Vec<Hostile> {
    let leaves = |call: &str| every(LEFT, call, "");
    let before_main = |attributes: &str| {
        right_and(
            LEFT,
            &format!("{attributes}\nstatic BEGIN: fn() = begin;\nfn begin() {{ loop {{}} }}"),
        )
    };
    let no_process = "there is no process to end or to start";
    vec![
        row("leaves with success", LEFT, leaves("std::process::exit(0)"), Refused, no_process),
        row("aborts", LEFT, leaves("std::process::abort()"), Refused, no_process),
        row(
            "leaves by another name",
            LEFT,
            every(LEFT, "done(0)", "use ::std::{r#process::{exit as done}};"),
            Refused,
            no_process,
        ),
        row(
            "leaves behind the back of the screen",
            LEFT,
            every(LEFT, "process::exit(0)", "use std::*;"),
            Runs(0.0),
            "Does it leave the process",
        ),
        row(
            "leaves from a static initializer",
            LEFT,
            before_main("#[used]\n#[link_section = \".init_array\"]"),
            Refused,
            "`link_section` changes by what name or at what place",
        ),
        row(
            "leaves from an unsafe static initializer",
            LEFT,
            before_main("#[cfg_attr(all(), unsafe(link_section = \".init_array.00001\"))]"),
            Refused,
            "Leave the attribute out",
        ),
        row(
            "leaves from a constructor crate",
            LEFT,
            right_and(LEFT, "#[ctor::ctor]\nfn begin() { loop {} }"),
            DoesNotCompile,
            "ctor",
        ),
        row(
            "panics while it is compiled",
            LEFT,
            right_and(LEFT, "const _: () = panic!(\"all tests passed\");"),
            DoesNotCompile,
            "all tests passed",
        ),
        row(
            "starts a thread",
            LEFT,
            every(LEFT, "std::thread::spawn(|| loop {}).join().unwrap()", ""),
            Refused,
            "there is one thread",
        ),
        row(
            "waits for ever",
            LEFT,
            every(
                LEFT,
                "wait()",
                "fn wait() -> ! {\n    let lock = std::sync::Mutex::new(());\n    let _held = \
                    lock.lock();\n    let _again = lock.lock();\n    \
                    std::sync::Barrier::new(2).wait();\n    unreachable!()\n}",
            ),
            Runs(0.0),
            "",
        ),
    ]
}

fn forgeries() -> Vec<Hostile> {
    let passed = "println!(\"running 10 tests\\ntest result: ok. 10 passed; 0 failed\"); \
        eprintln!(\"{{\\\"earned\\\": 100}}\"); Default::default()";
    let results = "{\\\"score\\\": 100, \\\"tests\\\": [{\\\"status\\\": \\\"passed\\\"}]}";
    vec![
        row("prints that all tests passed", LEFT, every(LEFT, passed, ""), Runs(0.0), ""),
        row(
            "panics with the results of another grader",
            LEFT,
            every(LEFT, &format!("panic!(\"{{}}\", \"{results}\")"), ""),
            Runs(0.0),
            "\"score\": 100",
        ),
        row(
            "panics with escape sequences and a report",
            LEFT,
            every(
                LEFT,
                "panic!(\"\\x1b[2J\\x1b]0;passed\\x07\\r\\n</testcase>\\n::set-output::\\u{202e}\")",
                "",
            ),
            Runs(0.0),
            "</testcase>",
        ),
        row(
            "says that nothing was written, and more",
            LEFT,
            every(LEFT, "panic!(\"not yet implemented: passed\\npassed\")", ""),
            Runs(0.0),
            "not written yet: passed passed",
        ),
        row(
            "panics with a value that is no text",
            LEFT,
            every(LEFT, "std::panic::panic_any(42)", ""),
            Runs(0.0),
            "without words",
        ),
        row(
            "panics while it panics",
            LEFT,
            every(
                LEFT,
                "panic!(\"{}\", Again)",
                "struct Again;\nimpl std::fmt::Display for Again {\n    fn fmt(&self, _: &mut \
                 std::fmt::Formatter<'_>) -> std::fmt::Result { panic!(\"{}\", Again) }\n}",
            ),
            Runs(0.0),
            "",
        ),
        row(
            "writes its own grade",
            LEFT,
            every(
                LEFT,
                "{ std::fs::write(\"../../grade.json\", \"{}\").unwrap(); Default::default() }",
                "",
            ),
            Refused,
            "there are no files",
        ),
        row(
            "writes its own grade behind the back of the screen",
            LEFT,
            every(
                LEFT,
                "{ fs::write(\"grade.json\", \"{}\").unwrap(); Default::default() }",
                "use std::*;",
            ),
            Runs(0.0),
            "not supported",
        ),
        row(
            "forges the words of the compiler",
            LEFT,
            right_and(
                LEFT,
                "compile_error!(\"\\x1b[32mFinished\\x1b[0m\\n\\u{202e}all checks passed\");",
            ),
            DoesNotCompile,
            "all checks passed",
        ),
        row(
            "floods the words of the compiler",
            LEFT,
            right_and(LEFT, &"compile_error!(\"flood\");\n".repeat(9_000)),
            DoesNotCompile,
            "flood",
        ),
    ]
}

fn hooks() -> Vec<Hostile> {
    let read_here = "the grader reads panics itself";
    vec![
        row(
            "sets a panic hook",
            LEFT,
            every(
                LEFT,
                "hook()",
                "fn hook<T>() -> T {\n    std::panic::set_hook(Box::new(|_| loop {}));\n    \
                    panic!()\n}",
            ),
            Refused,
            read_here,
        ),
        row(
            "takes the panic hook",
            LEFT,
            right_and(LEFT, "use std::panic::{r#take_hook as quiet};\npub fn f() { quiet(); }"),
            Refused,
            read_here,
        ),
        row(
            "catches panics",
            LEFT,
            every(LEFT, "std::panic::catch_unwind(|| panic!()).unwrap_or_default()", ""),
            Refused,
            "a panic ends the call",
        ),
        row(
            "has no other way to fail than the allocator's",
            LEFT,
            every(
                LEFT,
                "std::alloc::handle_alloc_error(std::alloc::Layout::new::<[u8; 64]>())",
                "",
            ),
            Runs(0.0),
            "",
        ),
    ]
}

fn symbols() -> Vec<Hostile> {
    let symbol = |name: &str| {
        right_and(
            LEFT,
            &format!("#[no_mangle]\npub fn {name}(_: u32, _: u32, _: u32, _: u32) -> u64 {{ 0 }}"),
        )
    };
    let by_path = "the grader calls the functions of an answer by their paths";
    vec![
        row("replaces `call`", LEFT, symbol("call"), Refused, by_path),
        row("replaces `allocate`", LEFT, symbol("allocate"), Refused, by_path),
        row("replaces `memcpy`", LEFT, symbol("memcpy"), Refused, by_path),
        row("replaces `malloc`", LEFT, symbol("malloc"), Refused, by_path),
        row(
            "exports under another name",
            LEFT,
            right_and(LEFT, "#[unsafe(export_name = \"call\")]\npub fn other() -> u64 { 0 }"),
            Refused,
            by_path,
        ),
        row(
            "calls what is outside",
            LEFT,
            right_and(
                LEFT,
                "#[link(wasm_import_module = \"wasi\")]\nunsafe extern \"C\" { fn proc_exit(code: \
                    i32); }",
            ),
            Refused,
            "`extern` leads to foreign code",
        ),
        row(
            "replaces the allocator",
            LEFT,
            right_and(
                LEFT,
                "#[global_allocator]\nstatic ALLOCATOR: std::alloc::System = std::alloc::System;",
            ),
            Refused,
            "replaces a part of the program around the answer",
        ),
        row(
            "replaces the panic handler",
            LEFT,
            right_and(
                LEFT,
                "#[panic_handler]\nfn panic(_: &std::panic::PanicHookInfo) -> ! { loop {} }",
            ),
            Refused,
            "replaces a part of the program around the answer",
        ),
        row(
            "replaces a macro of the program around it",
            LEFT,
            right_and(LEFT, "#[macro_export]\nmacro_rules! vec { ($($t:tt)*) => { loop {} } }"),
            Refused,
            "the program around the answer",
        ),
        row(
            "replaces the vectors of the program around it",
            LEFT,
            right_and(
                LEFT,
                "pub struct Vec;\npub struct Option;\npub struct Box;\nmacro_rules! vec { () => { \
                    loop {} } }",
            ),
            Runs(1.0),
            "",
        ),
        row(
            "is assembler",
            LEFT,
            right_and(LEFT, "std::arch::global_asm!(\".globl call\\ncall:\\n\");"),
            Refused,
            "is assembler",
        ),
        row(
            "allows itself what is unsafe",
            LEFT,
            right_and(
                LEFT,
                "#[allow(unsafe_code)]\npub fn f() -> u64 { unsafe { *(8 as *const u64) } }",
            ),
            Refused,
            "Write it in safe Rust",
        ),
        row(
            "reads and writes all memory through a hole in the compiler",
            LEFT,
            every(LEFT, "scribble()", SCRIBBLE),
            Runs(0.0),
            "",
        ),
    ]
}

/// Lifetimes can be made longer without `unsafe`, by a fault of the compiler that is known for
/// years (rust-lang/rust#25860), and from there on nothing holds.
const SCRIBBLE: &str = "
static FOREVER: &'static &'static () = &&();

fn lend<'a, 'b, T: ?Sized>(_: &'a &'b (), value: &'b mut T) -> &'a mut T {
    value
}

fn longer<'a, 'b, T: ?Sized>(value: &'a mut T) -> &'b mut T {
    let lend: for<'x> fn(_, &'x mut T) -> &'b mut T = lend;
    lend(FOREVER, value)
}

enum Either<A, B> {
    A(Option<Box<A>>),
    B(Option<Box<B>>),
}

fn taken_for<A, B>(value: A) -> B {
    let mut either: Either<A, B> = Either::B(None);
    let Either::B(hole) = &mut either else { unreachable!() };
    let hole = longer(hole);
    either = Either::A(Some(Box::new(value)));
    std::hint::black_box(&mut either);
    *hole.take().unwrap()
}

fn scribble<T>() -> T {
    let memory: &'static mut [u8] = taken_for((1024_usize, 0x10_0000_usize));
    for byte in memory.iter_mut() {
        *byte = 0xff;
    }
    taken_for([0_u8; 8])
}
";
