//! Factorizations of nalgebra in an answer that has to do without them. They cannot be left out of
//! nalgebra, so the module tells: compiled without any change of its calls, it names what it holds.

use exercise_spec::exercise;
use rustc_demangle::try_demangle;

/// What the modules of the library's own triangles and similar forms are called.
const TYPES: [&str; 5] = [
    "nalgebra::linalg::qr::QR<",
    "nalgebra::linalg::col_piv_qr::ColPivQR<",
    "nalgebra::linalg::full_piv_lu::FullPivLU<",
    "nalgebra::linalg::hessenberg::Hessenberg<",
    "nalgebra::linalg::schur::Schur<",
];
/// How a method of a matrix begins.
const METHOD: &str = "<nalgebra::base::matrix::Matrix<";
/// Singular values of matrices so small are found by ways of their own, which factorize.
const SMALL: [&str; 2] = ["Const<2>", "Const<3>"];
/// The method that nobody may call who has to do without factorizations.
const FORBIDDEN: &str = "qr";

/// Whether an exercise has to be done without factorizations.
pub fn is_asked(slug: &str) -> bool {
    exercise(slug).is_some_and(|exercise| exercise.forbidden.contains(&FORBIDDEN))
}

/// A factorization that a module holds and an exercise forbids, by the name of its method.
pub fn found(module: &[u8], slug: &str) -> Option<String> {
    let forbidden = exercise(slug).map_or(&[][..], |exercise| exercise.forbidden);
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    module.split(|byte| !is_part(byte)).find_map(|word| {
        // A number before the name can look like a part of it.
        let word = std::str::from_utf8(word).ok()?;
        let symbol = &word[word.find("_R")?..];
        let name = format!("{:#}", try_demangle(symbol).ok()?);
        let (_, last) = name.rsplit_once("::")?;
        let large = !SMALL
            .iter()
            .any(|size| name.contains(&format!("{size}, nalgebra::base::dimension::{size}")));
        let of_matrix = name.starts_with(METHOD) && forbidden.contains(&last);
        let made = TYPES.iter().any(|of| name.contains(of)) && last == "new";
        (large && (of_matrix || made)).then(|| last_but_new(&name, last).to_owned())
    })
}

/// What a student calls it: the method, or the type that was made.
fn last_but_new<'a>(name: &'a str, last: &'a str) -> &'a str {
    let made = TYPES.iter().find(|of| last == "new" && name.contains(**of));
    made.and_then(|of| of.trim_end_matches('<').rsplit("::").next()).unwrap_or(last)
}
