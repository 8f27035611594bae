//! Submissions that are no text, or no files, or have names that are traps.

#[cfg(unix)]
use std::os::unix::fs::symlink;

use crate::corpus::Want::{DoesNotCompile, Missing, NotBegun, NotGraded, Refused, Runs};
use crate::corpus::{Hostile, LEFT, folder, put, right, right_and, row, skeleton, untouched};

pub fn all() -> Vec<Hostile> {
    let mut all = texts();
    all.extend(nothing());
    #[cfg(unix)]
    all.extend(links());
    #[cfg(unix)]
    all.extend(names());
    all
}

const FILE: &str = "left_perturbation.rs";

fn texts() -> Vec<Hostile> {
    vec![
        folder(
            "is no UTF-8",
            |root| put(root, FILE, [right(LEFT).as_bytes(), b"// \xff\xfe\xc0\x80\n"].concat()),
            Refused,
            "Save the file as UTF-8",
        ),
        folder(
            "is UTF-16",
            |root| {
                let text = right(LEFT);
                let wide = text.encode_utf16().flat_map(u16::to_le_bytes);
                put(root, FILE, [0xff, 0xfe].into_iter().chain(wide).collect::<Vec<u8>>());
            },
            Refused,
            "in line 1",
        ),
        folder(
            "is 100 MB of source",
            |root| {
                put(root, FILE, format!("{}//", right(LEFT)));
                let file =
                    std::fs::File::options().append(true).open(root.join(FILE)).expect("a file");
                file.set_len(100 << 20).expect("100 MB");
            },
            Refused,
            "has 104857600 bytes and may have 256000",
        ),
        row(
            "is 100,000 nested brackets",
            LEFT,
            format!("{}\nfn f() {{ {}{} }}", right(LEFT), "(".repeat(100_000), ")".repeat(100_000)),
            Refused,
            "more than 100 brackets are open",
        ),
        row(
            "is 100,000 brackets without an end",
            LEFT,
            right_and(LEFT, &"[{(".repeat(33_000)),
            Refused,
            "may have no end",
        ),
        row(
            "is a comment without an end",
            LEFT,
            right_and(LEFT, &"/* ".repeat(50_000)),
            Refused,
            "may have no end",
        ),
        row("is empty", LEFT, String::new(), DoesNotCompile, "left_pose_jacobian"),
        row("is comments alone", LEFT, "// nothing\n".repeat(100), DoesNotCompile, "cannot find"),
        row("is NUL", LEFT, "\0".repeat(1000), Refused, "cannot be read as Rust"),
        row(
            "is text that turns its direction",
            LEFT,
            right_and(LEFT, "/* \u{202e} } \u{2066}if passed\u{2069} \u{2066} begin */"),
            DoesNotCompile,
            "",
        ),
        row(
            "is text in letters that look alike",
            LEFT,
            right(LEFT).replace("fn left_pose_jacobian", "fn left_p\u{43e}se_jacobian"),
            DoesNotCompile,
            "left_pose_jacobian",
        ),
        row(
            "has no function of the name",
            LEFT,
            right(LEFT).replace("pub fn forward_motion", "fn forward_motion"),
            DoesNotCompile,
            "forward_motion",
        ),
        row(
            "has a function of another type",
            LEFT,
            format!(
                "{}\n#[derive(Clone, Copy)]\npub struct Camera;\n",
                right(LEFT).replace("{Camera, Side}", "Side")
            ),
            DoesNotCompile,
            "Camera",
        ),
        row(
            "has a type of its own for numbers",
            LEFT,
            format!("#[allow(non_camel_case_types)]\ntype f64 = f32;\n{}", right(LEFT)),
            DoesNotCompile,
            "f32",
        ),
    ]
}

fn nothing() -> Vec<Hostile> {
    vec![
        folder("is an empty folder", |_| {}, Missing, "there is no answer in the submission"),
        folder(
            "has folders and no file",
            |root| {
                std::fs::create_dir_all(root.join("exercises/src/deep/deeper")).expect("folders")
            },
            Missing,
            "there is no answer in the submission",
        ),
        folder(
            "is an archive, a zip",
            |root| put(root, "work.zip", b"PK\x03\x04"),
            NotGraded,
            "cannot be unpacked",
        ),
        row("is the skeleton as it was", LEFT, untouched(LEFT), NotBegun, ""),
        row(
            "is the skeleton with other ends of lines",
            LEFT,
            format!("{}\r\n\r\n", untouched(LEFT).replace('\n', " \r\n")),
            NotBegun,
            "",
        ),
        folder(
            "has a folder in place of the answer",
            |root| put(root, "left_perturbation.rs/left_perturbation.rs", right(LEFT)),
            Refused,
            "is a folder",
        ),
        folder(
            "has ten thousand other files",
            |root| {
                put(root, FILE, skeleton(LEFT));
                (0..10_000).for_each(|number| put(root, &format!("helper{number}.rs"), ""));
            },
            Runs(0.0),
            "not written yet",
        ),
    ]
}

#[cfg(unix)]
fn links() -> Vec<Hostile> {
    let no_link = "links are not followed";
    fn leads(root: &std::path::Path, from: &str, to: impl AsRef<std::path::Path>) {
        symlink(to, root.join(from)).expect("a link");
    }
    vec![
        folder(
            "is a link to the reference answer",
            |root| leads(root, FILE, grader::repository().join("solutions/src").join(FILE)),
            Refused,
            no_link,
        ),
        folder("is a link to nowhere", |root| leads(root, FILE, "/nowhere"), Refused, no_link),
        folder("is a link to itself", |root| leads(root, FILE, FILE), Refused, no_link),
        folder(
            "is a link to zeros without end",
            |root| leads(root, FILE, "/dev/zero"),
            Refused,
            no_link,
        ),
        folder(
            "has a link for a folder",
            |root| leads(root, "src", grader::repository().join("solutions/src")),
            Missing,
            no_link,
        ),
        folder(
            "has a link for the folder around it",
            |root| leads(root, "exercises", grader::repository().join("solutions")),
            Missing,
            no_link,
        ),
        folder(
            "has a folder that leads to itself",
            |root| leads(root, "src", "."),
            Missing,
            no_link,
        ),
        folder(
            "is a link altogether",
            |root| {
                std::fs::remove_dir(root).expect("removed");
                symlink(grader::repository().join("solutions/src"), root).expect("a link");
            },
            Missing,
            no_link,
        ),
        folder(
            "is a pipe",
            |root| {
                let made = std::process::Command::new("mkfifo").arg(root.join(FILE)).status();
                assert!(made.expect("mkfifo").success());
            },
            Refused,
            "is a pipe or a device",
        ),
        folder(
            "is a socket",
            |root| drop(std::os::unix::net::UnixListener::bind(root.join(FILE)).expect("a socket")),
            Refused,
            "is a pipe or a device",
        ),
    ]
}

#[cfg(unix)]
fn names() -> Vec<Hostile> {
    let called = |name, folder: &'static str| Hostile {
        name,
        folder: Some(folder),
        exercise: LEFT,
        made: crate::corpus::Made::Answer(skeleton(LEFT)),
        want: Runs(0.0),
        says: "not written yet",
    };
    vec![
        called("has a name that clears the terminal", "\u{1b}[2J\u{1b}[31mgraded\u{7}"),
        called("has a name in two lines", "alice\nbob: 100 points"),
        called("has a name that turns its direction", "\u{202e}ecila\u{2066}"),
        called("has a name that leads upwards", "..\\..\\grades"),
        called("has a name of dots", "..."),
        called("has a name that is an option", "--detail=full"),
        called("has a name that is a formula", "=cmd|' |C'!A0"),
        called("has a name that is a device", "CON"),
        called("has a name that is a device with an ending", "nul.tar.gz"),
        called("has a name with other capitals", "con"),
        called(
            "has a name of tags",
            "<script>alert(1)</script>&amp;".split('/').next().unwrap_or_default(),
        ),
        called("has a name of the longest", LONG),
        called("has a name that is hidden", ".hidden"),
    ]
}

#[cfg(unix)]
const LONG: &str = "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\
    aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\
    aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa";
