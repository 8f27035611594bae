//! Measured flights. They are no part of the library.

/// A file of the folder that `VISLAM_DATA` names.
pub fn data(file: &str) -> String {
    let folder = std::env::var("VISLAM_DATA").expect("VISLAM_DATA names the folder of the data");
    std::fs::read_to_string(format!("{folder}/euroc/{file}")).expect("the file")
}
