//! Factorizations of nalgebra in an answer that has to do without them. They cannot be left out of
//! nalgebra, so the module tells: compiled without any change of its calls, it names what it holds.

use exercise_spec::exercise;
use rustc_demangle::try_demangle;

/// How a method of a matrix begins.
const METHOD: &str = "<nalgebra::base::matrix::Matrix<";
/// Factorizations that neither singular values nor eigenvalues are made of. Those alone are allowed.
const TYPES: [&str; 5] = [
    "nalgebra::linalg::qr::QR<",
    "nalgebra::linalg::col_piv_qr::ColPivQR<",
    "nalgebra::linalg::full_piv_lu::FullPivLU<",
    "nalgebra::linalg::hessenberg::Hessenberg<",
    "nalgebra::linalg::schur::Schur<",
];
/// Singular values of matrices so small are found by ways of their own, which factorize.
const SMALL: [&str; 2] = ["Const<2>", "Const<3>"];

/// Whether an exercise has to be done without factorizations.
pub fn is_asked(slug: &str) -> bool {
    exercise(slug).is_some_and(|exercise| exercise.forbidden.contains(&"qr"))
}

/// A factorization that a module holds and an exercise forbids: its method, or its type.
pub fn found(module: &[u8], slug: &str) -> Option<String> {
    let forbidden = exercise(slug).map_or(&[][..], |exercise| exercise.forbidden);
    let names: Vec<String> = symbols(module).filter(|name| !is_small(name)).collect();
    let method = |name: &String| {
        let (_, last) = name.strip_prefix(METHOD)?.rsplit_once("::")?;
        forbidden.contains(&last).then(|| last.to_owned())
    };
    let made = |name: &String| {
        let of = TYPES.iter().find(|of| name.contains(**of) && name.ends_with("::new"))?;
        of.trim_end_matches('<').rsplit("::").next().map(str::to_owned)
    };
    names.iter().find_map(method).or_else(|| names.iter().find_map(made))
}

/// The names of a module that say their types.
fn symbols(module: &[u8]) -> impl Iterator<Item = String> {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    module.split(move |byte| !is_part(byte)).filter_map(|word| {
        let word = std::str::from_utf8(word).ok()?;
        // The length before a name can look like a part of it.
        let symbol = try_demangle(&word[word.find("_R")?..]).ok()?;
        Some(format!("{symbol:#}"))
    })
}

fn is_small(name: &str) -> bool {
    SMALL.iter().any(|size| name.contains(&format!("{size}, nalgebra::base::dimension::{size}")))
}
