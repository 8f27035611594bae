//! A command with nothing around it: no network, no files but those it is shown, and limits.

use std::ffi::OsString;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use process_wrap::std::CommandWrap;
#[cfg(windows)]
use process_wrap::std::JobObject;
#[cfg(unix)]
use process_wrap::std::ProcessGroup;

/// How much of its words is kept.
const KEPT: u64 = 64_000;

/// Address space that a compiler sets aside and does not use, in kilobytes.
const SET_ASIDE_KB: u64 = 2_000_000;

/// What can stand around a command.
pub enum Sandbox {
    /// Namespaces of Linux, by bubblewrap.
    Bubblewrap(PathBuf),
    /// Nothing but an empty environment, for the reason given.
    Nothing(String),
}

/// What a command may take.
pub struct Limits {
    pub processor_seconds: u64,
    pub memory_kb: u64,
    pub file_kb: u64,
}

/// How a command ended.
pub struct Ended {
    pub success: bool,
    /// The signal that ended it, if one did.
    pub signal: Option<i32>,
    /// It was still running when the patience was over.
    pub out_of_patience: bool,
    /// The beginning of what it said on its error stream.
    pub said: String,
}

impl Sandbox {
    /// bubblewrap, where it is installed and allowed.
    pub fn find() -> Self {
        if !cfg!(target_os = "linux") {
            return Self::Nothing("there is no bubblewrap for this system".to_owned());
        }
        let mut probe = Command::new("bwrap");
        probe.args(["--unshare-all", "--ro-bind", "/", "/", "--proc", "/proc", "true"]);
        match probe.output() {
            Ok(output) if output.status.success() => Self::Bubblewrap("bwrap".into()),
            Ok(output) => Self::Nothing(format!(
                "bubblewrap may not make namespaces ({})",
                String::from_utf8_lossy(&output.stderr).trim()
            )),
            Err(_) => Self::Nothing("bubblewrap is not installed".to_owned()),
        }
    }

    /// What stands around a command, in a sentence for the instructor.
    pub fn sentence(&self) -> String {
        match self {
            Self::Bubblewrap(_) => "The compiler ran in bubblewrap, without network, and saw no file of the repository \
                 but the libraries that answers are linked with."
                .to_owned(),
            Self::Nothing(why) => format!(
                "The compiler ran without a sandbox, because {why}. The source screen and the list of files that the \
                 compiler read are all that kept it from others."
            ),
        }
    }

    /// A command that works in a folder, where it may write, and sees what is readable.
    pub fn command(
        &self,
        words: &[OsString],
        folder: &Path,
        readable: &[&Path],
        limits: &Limits,
    ) -> Command {
        let mut all: Vec<OsString> = limits.words();
        if let Self::Bubblewrap(bubblewrap) = self {
            all.push(bubblewrap.into());
            let alone = "--unshare-all --die-with-parent --new-session --cap-drop ALL --proc /proc --tmpfs /tmp";
            all.extend(alone.split(' ').map(OsString::from));
            // No terminal is among these: who reads one waits for ever.
            for device in ["/dev/null", "/dev/zero", "/dev/urandom"] {
                all.extend(["--dev-bind".into(), device.into(), device.into()]);
            }
            let system =
                ["/usr", "/bin", "/sbin", "/lib", "/lib64", "/etc/alternatives"].map(Path::new);
            for path in system.iter().chain(readable) {
                all.extend(["--ro-bind-try".into(), path.into(), path.into()]);
            }
            all.extend([
                "--bind".into(),
                folder.into(),
                folder.into(),
                "--chdir".into(),
                folder.into(),
            ]);
        }
        all.extend_from_slice(words);
        let mut command = Command::new(&all[0]);
        command.args(&all[1..]).current_dir(folder).env_clear().env("PATH", "/usr/bin:/bin");
        command
    }
}

impl Limits {
    /// What stands before a command so that it has these limits: a shell, where the system has one.
    fn words(&self) -> Vec<OsString> {
        if !cfg!(unix) {
            return Vec::new();
        }
        let Self { processor_seconds, memory_kb, file_kb } = self;
        // At the lower limit of time the signal says so; at the upper one it would be that of
        // somebody who wants the memory back. Memory is what a program has written to; what it sets
        // aside besides, for threads and files, is much more. The shell counts files in blocks of
        // half a kilobyte.
        let script = format!(
            "ulimit -c 0; ulimit -S -t {processor_seconds}; ulimit -H -t {}; ulimit -d {memory_kb}; \
             ulimit -v {}; ulimit -f {}; exec \"$@\"",
            2 * processor_seconds,
            memory_kb + SET_ASIDE_KB,
            2 * file_kb
        );
        ["/bin/sh".into(), "-c".into(), script.into(), "sh".into()].into()
    }
}

/// Runs a command and all that it starts to the end, or to the end of patience.
pub fn run(mut command: Command, patience: Duration) -> Result<Ended, String> {
    let program = command.get_program().to_string_lossy().into_owned();
    let failed = |error: std::io::Error| format!("{program} does not run: {error}");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut command = CommandWrap::from(command);
    #[cfg(unix)]
    command.wrap(ProcessGroup::leader());
    #[cfg(windows)]
    command.wrap(JobObject);
    let mut child = command.spawn().map_err(failed)?;
    let words = child.stderr().take();
    let listener = thread::spawn(move || heard(words));
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            break Some(status);
        }
        if begun.elapsed() > patience {
            child.kill().map_err(failed)?;
            break None;
        }
        thread::sleep(Duration::from_millis(4));
    };
    let said = listener.join().unwrap_or_default();
    Ok(Ended {
        success: status.is_some_and(|status| status.success()),
        signal: status.and_then(signal),
        out_of_patience: status.is_none(),
        said,
    })
}

/// The signal of a status. A shell, or bubblewrap, tells it by a number above 128.
fn signal(status: ExitStatus) -> Option<i32> {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return Some(signal);
    }
    status.code().and_then(|code| (code > 128).then_some(code - 128))
}

fn heard(stream: Option<impl Read>) -> String {
    let Some(mut stream) = stream else { return String::new() };
    let mut kept = Vec::new();
    let _ = stream.by_ref().take(KEPT).read_to_end(&mut kept);
    // What comes after is read and forgotten, so that nobody waits to say it.
    let _ = std::io::copy(&mut stream, &mut std::io::sink());
    String::from_utf8_lossy(&kept).into_owned()
}
