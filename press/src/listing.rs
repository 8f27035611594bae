//! Listings: pieces of compiled source, cut out by their anchors.

/// A piece of a source file.
#[derive(Debug, PartialEq, Eq)]
pub struct Listing {
    /// Its lines, without the marks of anchors and without common indentation.
    pub code: Vec<String>,
    /// The first line in the file, counted from 1.
    pub first: usize,
    /// The last line in the file.
    pub last: usize,
}

/// Cuts the piece between `ANCHOR: name` and `ANCHOR_END: name` out of a source file.
pub fn cut(source: &str, anchor: &str) -> Option<Listing> {
    let lines: Vec<&str> = source.lines().collect();
    let find = |mark: &str| {
        lines.iter().position(|line| mark_of(line).is_some_and(|found| found == (mark, anchor)))
    };
    let (begin, end) = (find("ANCHOR:")?, find("ANCHOR_END:")?);
    let kept: Vec<(usize, &str)> = (begin + 1..end)
        .map(|at| (at + 1, lines[at]))
        .filter(|(_, line)| mark_of(line).is_none())
        .collect();
    let (first, last) = (kept.first()?.0, kept.last()?.0);
    let indent = kept
        .iter()
        .filter(|(_, line)| !line.trim().is_empty())
        .map(|(_, line)| line.len() - line.trim_start().len())
        .min()?;
    let code =
        kept.iter().map(|(_, line)| line.get(indent..).unwrap_or_default().to_owned()).collect();
    Some(Listing { code, first, last })
}

/// The mark and the name on a line that holds nothing but an anchor.
fn mark_of(line: &str) -> Option<(&str, &str)> {
    let text = line.trim().trim_start_matches(['/', '#', '<', '!', '-']).trim_end_matches("-->");
    let text = text.trim();
    let (mark, name) = text.split_once(' ')?;
    matches!(mark, "ANCHOR:" | "ANCHOR_END:").then(|| (mark, name.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_loses_its_anchors_and_its_indentation() {
        let source = "use a;\nimpl X {\n    // ANCHOR: outer\n    fn a() {\n        // ANCHOR: inner\n        b();\n        // ANCHOR_END: inner\n    }\n    // ANCHOR_END: outer\n}\n";
        let piece = cut(source, "outer").unwrap();
        assert_eq!(piece.code, ["fn a() {", "    b();", "}"]);
        assert_eq!((piece.first, piece.last), (4, 8));
        assert_eq!(cut(source, "inner").unwrap().code, ["b();"]);
    }

    #[test]
    fn anchors_stand_in_comments_of_rust_python_and_markdown() {
        for [begin, end] in [["// ", ""], ["# ", ""], ["<!-- ", " -->"]] {
            let source = format!("{begin}ANCHOR: a{end}\nx\n{begin}ANCHOR_END: a{end}\n");
            assert_eq!(cut(&source, "a").unwrap().code, ["x"]);
        }
    }

    #[test]
    fn an_anchor_that_is_gone_gives_nothing() {
        assert_eq!(cut("fn a() {}", "a"), None);
        assert_eq!(cut("// ANCHOR: a\nfn a() {}", "a"), None);
        assert_eq!(cut("// ANCHOR: ab\nx\n// ANCHOR_END: ab", "a"), None);
    }
}
