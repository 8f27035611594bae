//! The two depths of a chapter: the main road, and the sections that a reader may leave folded.

use super::Emitter;
use crate::attributes::Attributes;
use crate::blocks::{Block, Kind};
use crate::pages::anchor_of;

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
        // The main road reads this sentence, so it is resolved before depth begins.
        let establishes = self.resolve(block.line, attributes.value("establishes"));
        self.depth = block.depth;
        if establishes.is_empty() {
            let problem = "a section in depth does not say what it establishes";
            let mend = "write {.depth establishes=\"…\"}: the sentence that whoever leaves it out has to believe";
            self.fault(block.line, title, problem, mend);
        }
        let of = anchor_of(title, attributes);
        self.out.push_str(&format!(
            "\n<p class=\"establishes\"><span class=\"depth-mark\">In depth.</span> {establishes}</p>\n\n<div class=\"depth\" data-of=\"{of}\">\n\n"
        ));
    }

    /// Ends what is in depth when what comes next, a block or the end of the page, does not belong to it.
    pub(super) fn end_depth(&mut self, next: Option<usize>) {
        if self.depth.is_some() && self.depth != next {
            self.depth = None;
            self.out.push_str("\n\n</div>\n\n");
        }
    }
}
