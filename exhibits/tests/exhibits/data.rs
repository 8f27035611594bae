//! Data files by their digests.

use exhibits::data::{DataFile, NotMade, files_read};

/// This file, under a digest that it does not have.
const OTHER: DataFile = DataFile { path: "src/data.rs", sha256: "00" };

#[test]
fn data_that_is_absent_is_told_from_data_that_is_wrong() {
    let here = || Some(env!("CARGO_MANIFEST_DIR").into());
    assert!(matches!(OTHER.read_below("FOLDER", None), Err(NotMade::DataAbsent(_))));
    let nowhere = DataFile { path: "src/none.csv", sha256: "00" };
    assert!(matches!(nowhere.read_below("FOLDER", here()), Err(NotMade::DataAbsent(_))));
    let Err(NotMade::Failed(sentence)) = OTHER.read_below("FOLDER", here()) else {
        panic!("a wrong digest is refused");
    };
    assert!(sentence.contains("another file"), "{sentence}");
    assert!(files_read().keys().any(|file| file.ends_with("src/data.rs")));
}
