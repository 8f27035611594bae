//! Whether there is a compiler for WebAssembly. Without a network, rustup takes its time to say that it cannot add one.

use std::time::{Duration, SystemTime};

use anyhow::Result;
use toolchain::Toolchain;

use crate::api::rustdoc;
use crate::files;
use crate::settings::Layout;
use crate::steps::Steps;

/// How long rustup is not asked again when it could not help.
const REFUSAL: Duration = Duration::from_secs(3600);

/// The compiler, or why there is none. rustup is asked to add what is missing, and when it could not, not again before an
/// hour has gone or Rust is another one. A compiler that was installed meanwhile is found all the same.
pub fn find(layout: &Layout, steps: &Steps) -> Result<Result<Toolchain, String>> {
    find_with(layout, Toolchain::find, || Toolchain::find_or_add(|what| steps.say(what)))
}

fn find_with<T>(
    layout: &Layout,
    find: impl FnOnce() -> Result<T, String>,
    find_or_add: impl FnOnce() -> Result<T, String>,
) -> Result<Result<T, String>> {
    let refusal = layout.work().join("no-compiler");
    let age = std::fs::metadata(&refusal).and_then(|file| file.modified()).ok();
    let age = age.and_then(|then| SystemTime::now().duration_since(then).ok());
    let same = files::read_if_there(&refusal)?.as_deref() == Some(rustdoc::version());
    if same && age.is_some_and(|age| age < REFUSAL) {
        return Ok(find());
    }
    let found = find_or_add();
    match found {
        Ok(_) => files::remove(&refusal)?,
        Err(_) => files::write(&refusal, rustdoc::version().as_bytes())?,
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused() -> Result<(), String> {
        Err("there is none".to_owned())
    }

    #[test]
    fn a_refusal_is_remembered_and_hides_no_compiler_that_is_installed_meanwhile() {
        let root = tempfile::tempdir().unwrap();
        let layout = Layout { root: root.path().to_path_buf() };
        let never = || -> Result<(), String> { panic!("rustup is asked again") };
        assert!(find_with(&layout, refused, refused).unwrap().is_err());
        assert!(find_with(&layout, refused, never).unwrap().is_err());
        assert!(find_with(&layout, || Ok(()), never).unwrap().is_ok());
    }

    #[test]
    fn another_rust_or_an_old_refusal_asks_again() {
        let root = tempfile::tempdir().unwrap();
        let layout = Layout { root: root.path().to_path_buf() };
        let refusal = layout.work().join("no-compiler");
        files::write(&refusal, b"rustdoc 0.1").unwrap();
        assert!(find_with(&layout, refused, || Ok(())).unwrap().is_ok(), "another Rust");
        assert!(!refusal.exists(), "what was added is there");
        assert!(find_with(&layout, refused, refused).unwrap().is_err());
        let old = SystemTime::now() - 2 * REFUSAL;
        std::fs::File::options().write(true).open(&refusal).unwrap().set_modified(old).unwrap();
        assert!(find_with(&layout, refused, || Ok(())).unwrap().is_ok(), "an old refusal");
    }
}
