//! The symbols of the book: what each letter of an equation means, and the place that says it.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::LazyLock;

use maud::{Markup, PreEscaped, html};
use regex::Regex;

use crate::attributes::Attributes;
use crate::blocks::Kind;
use crate::fault::Faults;
use crate::pages::Page;
use crate::prose::{link, listed, table};

/// The page whose symbols hold in every chapter that does not say otherwise.
const NOTATION: &str = "notation";

/// A symbol and what it means on a page.
#[derive(Debug)]
pub struct Symbol {
    /// As it was written where it is explained.
    pub tex: String,
    /// What it means.
    pub means: String,
    /// `3`, `2×3`; nothing for a number.
    pub shape: String,
    /// Its unit; nothing for a pure number.
    pub unit: String,
    /// The frame that it is written in, where it has one.
    pub frame: String,
    /// The page and line that explain it.
    pub place: (String, usize),
    /// Whether they are in depth.
    pub deep: bool,
}

impl Symbol {
    /// The symbol that a mark explains, or what is missing from it.
    pub fn marked(
        tex: &str,
        attributes: &Attributes,
        place: (&str, usize),
        deep: bool,
    ) -> Result<(String, Symbol), &'static str> {
        let [letter] = &letters(tex)[..] else {
            return Err("a mark explains one letter");
        };
        let said = |key: &str| attributes.value(key).to_owned();
        let symbol = Symbol {
            tex: tex.to_owned(),
            means: said("means"),
            shape: said("shape"),
            unit: said("unit"),
            frame: said("frame"),
            place: (place.0.to_owned(), place.1),
            deep,
        };
        if symbol.means.is_empty() {
            return Err("the mark does not say what the letter means");
        }
        if letter.starts_with('\\') && letter.contains('{') && symbol.shape.is_empty() {
            return Err("the mark does not say the shape of a vector or matrix");
        }
        Ok((letter.clone(), symbol))
    }
}

/// The symbols of each page, by letter.
#[derive(Debug, Default)]
pub struct Symbols(BTreeMap<PathBuf, BTreeMap<String, Symbol>>);

impl Symbols {
    /// The anchor of a letter where it is explained.
    pub fn anchor(letter: &str) -> String {
        let plain = letter.replace(|c: char| !c.is_alphanumeric(), "-");
        format!("symbol:{}", plain.trim_matches('-'))
    }

    /// Adds what a letter means on a page; a second meaning there is a fault.
    pub fn define(&mut self, page: &Page, letter: String, symbol: Symbol, faults: &mut Faults) {
        let symbols = self.0.entry(page.path.clone()).or_default();
        if let Some(first) = symbols.get(&letter) {
            let (file, line) = &symbol.place;
            let problem = format!("line {} says that it is: {}", first.place.1, first.means);
            let mend = "explain a letter once on a page, and take another letter for another thing";
            faults.add((file, *line), &letter, problem, mend);
            return;
        }
        symbols.insert(letter, symbol);
    }

    /// Whether every letter of a numbered equation is explained by its chapter, the chapter above it, or the page on
    /// notation, and for the main road on the main road.
    pub fn check(&self, pages: &[Page], faults: &mut Faults) {
        for page in pages.iter().filter(|page| page.number.is_some()) {
            let known: Vec<_> = pages
                .iter()
                .filter(|other| other.slug == NOTATION || holds_on(other, page))
                .filter_map(|other| self.0.get(&other.path))
                .collect();
            for block in &page.blocks {
                let Kind::Equation { tex, attributes, tex_line } = &block.kind else { continue };
                if attributes.id.is_empty() {
                    continue;
                }
                for letter in letters(tex) {
                    let meanings: Vec<_> =
                        known.iter().filter_map(|symbols| symbols.get(&letter)).collect();
                    let problem = if meanings.is_empty() {
                        "nothing explains this letter"
                    } else if block.depth.is_none() && meanings.iter().all(|symbol| symbol.deep) {
                        "the main road uses a letter that only depth explains"
                    } else {
                        continue;
                    };
                    let mend = "mark it where it is introduced: [$…$]{.symbol means=\"…\" shape=\"…\" unit=\"…\" frame=\"…\"}";
                    let label = format!("{} in {}", letter, attributes.id);
                    faults.add((&page.file, *tex_line), label, problem, mend);
                }
            }
        }
    }

    /// The table of all symbols: meaning, shape, unit, frame, and the places that say so.
    pub fn index(&self, here: &Page, pages: &[Page]) -> Markup {
        let mut entries: BTreeMap<(String, &str), Vec<(&Symbol, Markup)>> = BTreeMap::new();
        for page in pages {
            for (letter, symbol) in self.0.get(&page.path).into_iter().flatten() {
                let number = page.number.as_deref().unwrap_or("Notation");
                let way = link(here, &page.path, &Symbols::anchor(letter), number);
                let entry = entries.entry((sorted(letter), &symbol.means)).or_default();
                entry.push((symbol, way));
            }
        }
        let row = |places: &Vec<(&Symbol, Markup)>| {
            let symbol = places[0].0;
            let unit = if symbol.unit.is_empty() { "—" } else { &symbol.unit };
            html! {
                td { "$" (PreEscaped(&symbol.tex)) "$" }
                td { (symbol.means) }
                td { (symbol.shape) }
                td { (unit) }
                td { (symbol.frame) }
                td { (listed(places.iter().map(|(_, way)| way))) }
            }
        };
        let rows: Vec<_> = entries.values().map(row).collect();
        let columns = ["Symbol", "Meaning", "Shape", "Unit", "Frame", "Explained in"];
        table(Some("symbols"), &columns, &rows)
    }
}

/// Whether what one page explains holds on another: on itself, on the other pages of its chapter, and on those below.
fn holds_on(page: &Page, other: &Page) -> bool {
    let numbers = page.number.as_ref().zip(other.number.as_ref());
    page.slug == other.owner
        || page.path == other.path
        || numbers.is_some_and(|(above, below)| below.starts_with(&format!("{above}.")))
}

/// The order of letters: by their name, small before large, plain before bold.
fn sorted(letter: &str) -> String {
    let name = letter.trim_start_matches("\\vv").trim_start_matches("\\mat");
    let name = name.trim_matches(|c: char| !c.is_alphanumeric());
    format!("{} {letter}", name.to_lowercase())
}

/// Commands that wrap a letter and make another one of it.
const FONTS: [&str; 6] = ["vv", "mat", "mathcal", "mathbb", "mathfrak", "boldsymbol"];

/// Commands whose argument is words, or the name of a function.
const WORDS: [&str; 8] =
    ["text", "operatorname", "mathrm", "mathsf", "begin", "end", "htmlClass", "hspace"];

const GREEK: &str = "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi \
    pi varpi rho varrho sigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon \
    Phi Psi Omega ell";

/// The letters of a formula, each once: `Z`, `\lambda`, `\vv{P}`. Subscripts name members of a family, accents its
/// relatives; neither makes another letter. Names of functions are words.
pub fn letters(tex: &str) -> Vec<String> {
    static PIECE: LazyLock<Regex> = LazyLock::new(|| {
        Regex::new(r"\\\\(?:\[[^\]]*\])?|\\begin\{array\}\{[^}]*\}|\\[a-zA-Z]+|\\.|\{\{.*?\}\}|\S")
            .expect("a valid pattern")
    });
    let mut pieces = PIECE.find_iter(tex).map(|piece| piece.as_str());
    let mut found: Vec<String> = Vec::new();
    while let Some(piece) = pieces.next() {
        let letter = match (piece, piece.strip_prefix('\\')) {
            ("_", _) => {
                argument(&mut pieces);
                continue;
            }
            (_, Some(name)) if WORDS.contains(&name) => {
                argument(&mut pieces);
                continue;
            }
            (_, Some(name)) if FONTS.contains(&name) => {
                let inside = argument(&mut pieces);
                if inside.chars().all(|c| c.is_ascii_digit()) {
                    continue;
                }
                format!("\\{name}{{{inside}}}")
            }
            (_, Some(name)) if GREEK.split_whitespace().any(|greek| greek == name) => {
                piece.to_owned()
            }
            (_, Some(_)) => continue,
            (letter, None) if letter.len() == 1 && letter.chars().all(char::is_alphabetic) => {
                letter.to_owned()
            }
            _ => continue,
        };
        if !found.contains(&letter) {
            found.push(letter);
        }
    }
    found
}

/// The argument of a command: one piece, or what stands in braces.
fn argument<'a>(pieces: &mut impl Iterator<Item = &'a str>) -> String {
    let mut inside = String::new();
    let mut depth = 0;
    for piece in pieces {
        match piece {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => inside.push_str(piece),
        }
        if depth == 0 {
            break;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_letters_of_a_formula_are_found_once() {
        let tex = r"\measured{\tilde{\vv{z}}}_i = \frac{f_x X}{Z} + \sigma_Z^{2} Z \transpose";
        assert_eq!(letters(tex), [r"\vv{z}", "f", "X", "Z", r"\sigma"]);
    }

    #[test]
    fn columns_and_distances_of_lines_are_no_letters() {
        let tex = r"\begin{array}{lc} \mat{Q} \\[0.4em] \vv{0} \end{array}";
        assert_eq!(letters(tex), [r"\mat{Q}"]);
    }

    #[test]
    fn words_names_of_functions_and_layout_are_no_letters() {
        let tex = r"\begin{pmatrix} \mat{0} & \mat{R}_{cw} \\ \operatorname{rank} \mat{H} & 1 \end{pmatrix}^\wedge \text{where } \sin\theta";
        assert_eq!(letters(tex), [r"\mat{R}", r"\mat{H}", r"\theta"]);
    }
}
