//! `cargo book` and `cargo test` share what they compile, because they ask the same features of it.

use std::collections::BTreeMap;
use std::process::Command;

/// The features of every crate that some packages and what they name need, by the crate and its version.
fn features(options: &[&str]) -> BTreeMap<String, Vec<String>> {
    let always = ["tree", "--offline", "--prefix", "none", "--format", "{p}\t{f}"];
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(always).args(options).current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let output = cargo.output().expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut features: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let line = line.trim_end_matches(" (*)");
        if let Some((package, of)) = line.split_once('\t') {
            let known = features.entry(package.to_owned()).or_default();
            known.extend((!known.contains(&of.to_owned())).then(|| of.to_owned()));
        }
    }
    features
}

#[test]
fn the_tests_ask_no_other_features_of_what_the_press_is_built_from() {
    let edges = "normal,no-proc-macro";
    let press = features(&["--package", "press", "--edges", edges]);
    let all = features(&["--edges", &format!("dev,{edges}")]);
    assert!(press.len() > 100, "{} crates", press.len());
    for (package, of_press) in press {
        assert_eq!(Some(&of_press), all.get(&package), "{package} would be compiled twice");
    }
}
