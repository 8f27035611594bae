//! From answers to a WebAssembly module, on a clean tree of the grader's own.
//!
//! Of a submission, only the text of its answers is here: no manifest, no build script, no macro
//! crate and no setting of a tool takes part. rustc is called directly and not through cargo.

mod confine;
mod factorized;
mod kit;
mod known;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Component, Path};
use std::process::Command;
use std::time::Duration;

use exercise_spec::{EXERCISES, Exercise};

use crate::memory::Memory;
use crate::repository;
use crate::text::harmless;
use confine::{Ended, Sandbox};
use kit::Kit;
use known::Known;
use toolchain::Toolchain;

/// How long it may take by the clock, on a machine that is busy. Who is stopped by this is not
/// graded, because it says more about the machine than about the answer.
const PATIENCE: Duration = Duration::from_secs(600);
/// Processor time for answers that are the grader's own.
const OWN: Duration = Duration::from_secs(60);
/// The largest module that is accepted; that of the reference answers has 0.4 MB.
const LARGEST_MODULE: u64 = 8_000_000;
/// How much of what the compiler says is passed on.
const LONGEST_MESSAGE: usize = 3_000;

/// Options of a module that runs.
const SPEED: &str = "-C opt-level=1 -C strip=symbols";
/// Options of a module that names what it holds, with all its types.
const NAMES: &str = "-C opt-level=0 -C symbol-mangling-version=v0";

/// The signal by which a system takes memory back. The limits here end a compiler by others.
const KILLED: i32 = 9;
/// What a compiler says on a full disk.
const DISK_FULL: &str = "No space left on device";

/// Texts of answers, by the slugs of their exercises.
pub type Answers = BTreeMap<&'static str, String>;

/// Turns answers into modules.
pub struct Compiler {
    toolchain: Toolchain,
    sandbox: Sandbox,
    kit: Kit,
    /// Tells this grader, its compiler and its libraries from others.
    maker: String,
}

/// What became of the answers.
pub enum Compiled {
    /// A module that imports nothing.
    Module(Vec<u8>),
    /// The compiler read what is not the student's.
    Refused(String),
    /// The compiler says no, or it took too much.
    DoesNotCompile(String),
    /// The compiler could not be run.
    CouldNotCompile(String),
}

impl Compiler {
    /// Finds a compiler and builds what answers are linked with. The first time takes minutes.
    ///
    /// # Errors
    ///
    /// When there is no compiler for WebAssembly, or the book's own crates do not compile.
    pub fn prepare() -> Result<Self, String> {
        let toolchain = Toolchain::find()?;
        let kit = Kit::build(&toolchain)?;
        let maker = format!("{} {} {:?}", edition(), stamp(&toolchain.rustc), kit.stamps());
        Ok(Self { toolchain, sandbox: Sandbox::find(), kit, maker })
    }

    /// What stands around the compiler, in a sentence.
    pub fn sandbox(&self) -> String {
        self.sandbox.sentence()
    }

    /// Compiles answers to one module, in as much of the processor's time.
    pub fn compile(&self, answers: &Answers, time: Duration, memory: &Memory) -> Compiled {
        for (slug, text) in answers.iter().filter(|(slug, _)| factorized::is_asked(slug)) {
            let alone = Answers::from([(*slug, text.clone())]);
            let found = match self.compiled(&alone, NAMES, (time, memory)) {
                Compiled::Module(module) => factorized::found(&module, slug),
                other => return other,
            };
            if let Some(name) = found {
                return Compiled::Refused(format!(
                    "The compiled answer contains nalgebra's `{name}`, which does what this exercise asks for. Write \
                     it yourself, of the parts that its page names."
                ));
            }
        }
        self.compiled(answers, SPEED, (time, memory))
    }

    /// The same with some options more, whatever is in it.
    fn compiled(
        &self,
        answers: &Answers,
        options: &str,
        (time, memory): (Duration, &Memory),
    ) -> Compiled {
        // Systems count whole seconds here.
        let seconds = time.as_millis().div_ceil(1_000).max(1) as u64;
        let megabytes = memory.of_compiler();
        let compiled = self.kit.folder().and_then(|folder| {
            write_tree(folder.path(), answers)
                .map_err(|error| format!("the answers cannot be written: {error}"))?;
            let rustc = self.rustc(folder.path(), (seconds, megabytes), options);
            let part = memory.take(megabytes);
            let ended = confine::run(rustc, PATIENCE)?;
            drop(part);
            judged(&ended, folder.path(), answers, seconds)
        });
        compiled.unwrap_or_else(Compiled::CouldNotCompile)
    }

    /// Compiles answers that are the grader's own, unless an earlier run has done it: with the same
    /// texts, grader, compiler and libraries.
    pub fn compile_once(&self, answers: &Answers, memory: &Memory) -> Compiled {
        let known = Known::of(&repository().join("target/grader/known"), &self.maker, answers);
        if let Some(module) = known.module() {
            return Compiled::Module(module);
        }
        let compiled = self.compile(answers, OWN, memory);
        if let Compiled::Module(module) = &compiled {
            known.keep(module);
        }
        compiled
    }

    /// The call of the compiler, which sees the folder, its own files and the kit.
    fn rustc(
        &self,
        folder: &Path,
        (processor_seconds, megabytes): (u64, u64),
        more: &str,
    ) -> Command {
        let mut rustc = vec![self.toolchain.rustc.clone().into_os_string()];
        let options = "--edition 2024 --crate-type cdylib --crate-name answers --color never \
            --target wasm32-unknown-unknown -C panic=abort -C codegen-units=2 -C lto=off -C debuginfo=0 \
            -C debug-assertions=on --emit link=answers.wasm,dep-info=answers.d lib.rs";
        rustc.extend(options.split_whitespace().chain(more.split_whitespace()).map(Into::into));
        rustc.extend(self.kit.options());
        let readable = [self.toolchain.root.as_path(), self.kit.path()];
        let limits = confine::Limits {
            processor_seconds,
            // What the linker, the sandbox and the system need beside it is left.
            memory_kb: 800 * megabytes,
            file_kb: 2 * LARGEST_MODULE / 1000,
        };
        let mut command = self.sandbox.command(&rustc, folder, &readable, &limits);
        command.envs(self.toolchain.variables());
        command
    }
}

/// Tells a file from another one as well as its bytes do, and at once: its size and its age.
fn stamp(file: &Path) -> String {
    let stamp = |file: fs::Metadata| Ok(format!("{} {:?}", file.len(), file.modified()?));
    fs::metadata(file).and_then(stamp).unwrap_or_default()
}

/// Tells this grader from others, which may grade otherwise.
pub fn edition() -> String {
    std::env::current_exe().map(|program| stamp(&program)).unwrap_or_default()
}

/// The clean tree: the answers, and what calls them.
fn write_tree(folder: &Path, answers: &Answers) -> std::io::Result<()> {
    fs::create_dir(folder.join("answers"))?;
    for (slug, text) in answers {
        fs::write(folder.join(format!("answers/{slug}.rs")), text)?;
    }
    fs::write(folder.join("lib.rs"), shim(answers.keys().copied()))
}

/// The crate around the answers. It takes bytes and gives bytes.
fn shim(slugs: impl Iterator<Item = &'static str>) -> String {
    let (mut modules, mut arms) = (String::new(), String::new());
    for slug in slugs {
        let Some(number) = number_of(slug) else { continue };
        let functions: String = EXERCISES[number]
            .functions
            .iter()
            .map(|name| format!("            {name}: answers::{slug}::{name},\n"))
            .collect();
        let _ = writeln!(modules, "    #[path = \"{slug}.rs\"] pub mod {slug};");
        let _ = writeln!(
            arms,
            "        {number} => exercise_spec::{slug}::Functions {{\n{functions}        }}.dispatch(function, input),"
        );
    }
    include_str!("compile/shim.rs.in").replace("@MODULES@", &modules).replace("@ARMS@", &arms)
}

/// The number by which a module knows an exercise: its place in the book.
pub fn number_of(slug: &str) -> Option<usize> {
    EXERCISES.iter().position(|exercise: &&Exercise| exercise.slug == slug)
}

/// What the compiler's end means.
fn judged(
    ended: &Ended,
    folder: &Path,
    answers: &Answers,
    seconds: u64,
) -> Result<Compiled, String> {
    if ended.out_of_patience {
        return Err(format!("the compiler was stopped after {} s", PATIENCE.as_secs()));
    }
    if ended.signal == Some(KILLED) {
        return Err("the compiler was killed from outside; is there enough memory?".to_owned());
    }
    if let Some(stranger) = stranger(folder, answers) {
        return Ok(Compiled::Refused(stranger));
    }
    if !ended.success && ended.said.contains(DISK_FULL) && is_full(folder) {
        return Err(format!("the compiler could not write: {DISK_FULL}"));
    }
    if !ended.success {
        return Ok(Compiled::DoesNotCompile(told(ended, seconds)));
    }
    let module = folder.join("answers.wasm");
    let size = fs::metadata(&module).map_err(|error| format!("there is no module: {error}"))?.len();
    if size > LARGEST_MODULE {
        return Ok(Compiled::DoesNotCompile(format!(
            "The compiled answers have {size} bytes and may have {LARGEST_MODULE}: is there a table or an array that \
             is better computed?"
        )));
    }
    fs::read(&module)
        .map(Compiled::Module)
        .map_err(|error| format!("the module cannot be read: {error}"))
}

/// Whether a disk has no room for what a compiler writes. An answer can make the compiler say so.
fn is_full(folder: &Path) -> bool {
    fs::write(folder.join("probe"), vec![0; 2 * LARGEST_MODULE as usize]).is_err()
}

fn told(ended: &Ended, seconds: u64) -> String {
    // What a compiler says of its own end is of no use to a student.
    let own =
        ["error: rustc interrupted", "memory allocation of", "error: internal compiler error"];
    let said = own.iter().fold(ended.said.as_str(), |said, end| {
        said.split_once(end).map_or(said, |(before, _)| before)
    });
    let said = harmless(said.trim(), LONGEST_MESSAGE);
    if ended.signal.is_some() || said.is_empty() {
        return format!(
            "The compiler was stopped: it took more than {seconds} s of processor time, \
             or more memory than it may have, or the compiled answer is too large. Is there a \
             constant, a macro, a type, a table or an expression that has no end? {said}"
        );
    }
    if said.contains("--> lib.rs:") {
        return format!("{CALLED}\n\n{said}");
    }
    said
}

/// What an error in the file that calls the answers means.
const CALLED: &str = "The grader calls each function as the skeleton declares it. One of them is missing, is not \
    `pub`, or takes or returns something else. Take its first line from the skeleton. The compiler shows below \
    where the grader, in its own file lib.rs, calls the function.";

/// The first file or variable that the compiler read and that is not part of the tree.
fn stranger(folder: &Path, answers: &Answers) -> Option<String> {
    let text = fs::read_to_string(folder.join("answers.d")).ok()?;
    let expected = |path: &str| {
        path == "lib.rs"
            || answers.keys().any(|slug| {
                let parts: Vec<_> = Path::new(path).components().collect();
                parts
                    == [
                        Component::Normal("answers".as_ref()),
                        Component::Normal(format!("{slug}.rs").as_ref()),
                    ]
            })
    };
    for line in text.lines() {
        if let Some(variable) = line.strip_prefix("# env-dep:") {
            let name = harmless(variable.split('=').next().unwrap_or_default(), 80);
            return Some(format!(
                "The answer reads the variable {name} of the compiler's environment."
            ));
        }
        // The first rule names all; the others, one for each file, say the same.
        let Some((_, read)) = line.split_once(": ") else { continue };
        if let Some(path) =
            read.replace("\\ ", "\0").split_whitespace().find(|path| !expected(path))
        {
            let path = harmless(&path.replace('\0', " "), 200);
            return Some(format!("The answer reads the file {path}. It may read none."));
        }
    }
    None
}
