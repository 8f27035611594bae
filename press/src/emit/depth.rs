//! The two depths of a chapter: the main road, and the sections that a reader may leave folded.

use super::Emitter;
use crate::attributes::Attributes;
use crate::blocks::{Block, Kind};
use crate::pages::Page;

impl Emitter<'_, '_> {
    /// Begins what a heading puts in depth: a sentence that the main road reads, and what folds.
    pub(super) fn begin_depth(&mut self, block: &Block, attributes: &Attributes) {
        let Kind::Heading { level, title, .. } = &block.kind else { return };
        if !matches!(level, 2 | 3) || self.depth.is_some() {
            let problem =
                "only a heading of level 2 or 3 that is not in depth yet leads into depth";
            self.fault(block.line, title, problem, "remove {.depth} here");
            return;
        }
        self.depth = Some(*level);
        let establishes = self.resolve_on_main(block.line, attributes.value("establishes"));
        if establishes.is_empty() {
            let problem = "a section in depth does not say what it establishes";
            let mend = "write {.depth establishes=\"…\"}: the sentence that whoever leaves it out has to believe";
            self.fault(block.line, title, problem, mend);
        }
        self.out.push_str(&format!(
            "\n<p class=\"establishes\"><span class=\"depth-mark\">In depth.</span> {establishes}</p>\n\n<div class=\"depth\">\n\n"
        ));
    }

    /// Ends what is in depth before a heading of this level, or at the end of the page.
    pub(super) fn end_depth(&mut self, level: usize) {
        if self.depth.is_some_and(|depth| level <= depth) {
            self.depth = None;
            self.out.push_str("\n\n</div>\n\n");
        }
    }
}

/// The time that a page takes, on the main road and with what is in depth, in minutes.
pub(super) fn minutes(page: &Page) -> (usize, usize) {
    let [main, deep] = [false, true].map(|deep| {
        let blocks = page.blocks.iter().filter(|block| block.deep == deep);
        blocks.map(|block| seconds(&block.kind)).sum::<f64>()
    });
    let rounded = |seconds: f64| (seconds / 300.0).ceil().max(1.0) as usize * 5;
    (rounded(main), rounded(main + deep))
}

/// Prose at 200 words a minute, half a minute for an equation or a figure, one for a listing.
fn seconds(kind: &Kind) -> f64 {
    match kind {
        Kind::Text(text) | Kind::Choice { text, .. } => {
            text.split_whitespace().count() as f64 * 0.3
        }
        Kind::Equation { .. } | Kind::Figure { .. } => 30.0,
        Kind::Fence { .. } => 60.0,
        _ => 0.0,
    }
}
