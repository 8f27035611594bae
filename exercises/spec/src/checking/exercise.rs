//! What an exercise is.

use super::Question;
use super::check::{Check, Misconception};

/// An exercise.
pub struct Exercise {
    /// The word that leads to everything of it.
    pub slug: &'static str,
    /// What its page is called.
    pub title: &'static str,
    /// The chapter it belongs to.
    pub chapter: &'static str,
    /// Names of the functions to write.
    pub functions: &'static [&'static str],
    /// The wrong answers it names.
    pub misconceptions: &'static [&'static Misconception],
    /// Its types of arguments and outputs that an answer may import. Everything else of this crate
    /// belongs to the checks, which know what they expect.
    pub types: &'static [&'static str],
    /// Items of the library, and of nalgebra, that would be the answer, and may not be called.
    pub forbidden: &'static [&'static str],
    /// Hints as Markdown, from a question to a nudge to the idea.
    pub hints: &'static str,
    /// The checks that students have.
    pub checks: fn() -> Vec<Check>,
}

/// What may not be called where rows are to be turned by hand: nalgebra's factorizations but for those
/// of Cholesky, LU with pivots of rows alone, LBLᵀ and UDUᵀ, what is made of them, and the modules of the library that have the answer.
pub(crate) const FACTORIZATIONS: &[&str] = &[
    "Bidiagonal",
    "ColPivQR",
    "FullPivLU",
    "GivensRotation",
    "Hessenberg",
    "QR",
    "SVD",
    "Schur",
    "SymmetricEigen",
    "SymmetricTridiagonal",
    "bal",
    "bidiagonalize",
    "bundle_adjustment",
    "col_piv_qr",
    "filtering",
    "full_piv_lu",
    "hessenberg",
    "householder",
    "least_squares",
    "marginalization",
    "msckf",
    "observability",
    "orthonormal_subspace_basis",
    "orthonormalize",
    "polar",
    "pseudo_inverse",
    "qr",
    "schur",
    "simulation",
    "svd",
    "svd_unordered",
    "symmetric_eigen",
    "symmetric_tridiagonalize",
    "try_polar",
    "try_schur",
    "try_svd",
    "try_svd_unordered",
    "try_symmetric_eigen",
];

impl Exercise {
    /// What it asks in words.
    pub const fn question(&self) -> Question {
        Question { slug: self.slug, title: self.title }
    }

    /// The hints one by one. In the file each stands between `<!-- ANCHOR: N -->` and
    /// `<!-- ANCHOR_END: N -->`, so that its page can show them too.
    pub fn hint_ladder(&self) -> Vec<String> {
        let mut hints = Vec::new();
        let mut lines: Option<Vec<&str>> = None;
        for line in self.hints.lines() {
            if line.starts_with("<!-- ANCHOR_END") {
                hints.extend(lines.take().map(|lines| lines.join("\n")));
            } else if line.starts_with("<!-- ANCHOR") {
                lines = Some(Vec::new());
            } else if let Some(lines) = &mut lines {
                lines.push(line);
            }
        }
        hints
    }
}
