//! Ways through the book: chapters and sections as stops, with the time that each takes.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::blocks::{Block, Kind};
use crate::pages::{Page, anchor_of, nearest};

/// A chapter or a section of it.
#[derive(Debug)]
pub struct Stop {
    /// Its page.
    pub path: PathBuf,
    /// Where on the page it begins.
    pub anchor: String,
    /// `2`, or `2.3`, or nothing.
    pub number: String,
    /// What the heading says.
    pub title: String,
    /// The time that it takes on the main road and with what is in depth, in seconds.
    pub seconds: [f64; 2],
}

/// Every chapter by its slug, and every section as `slug#anchor`.
#[derive(Debug, Default)]
pub struct Ways(BTreeMap<String, Stop>);

impl Ways {
    /// The stops of all pages.
    pub fn collect(pages: &[Page]) -> Ways {
        Ways(pages.iter().flat_map(stops).collect())
    }

    /// A stop, when there is one of this name.
    pub fn get(&self, name: &str) -> Option<&Stop> {
        self.0.get(name)
    }

    /// The stops that resemble one that is not there.
    pub fn like(&self, name: &str) -> Option<&str> {
        nearest(self.0.keys(), name)
    }
}

/// The stops of a page: what each of its headings begins.
fn stops(page: &Page) -> Vec<(String, Stop)> {
    let stop = |(at, block): (usize, &Block)| {
        let Kind::Heading { level, title, attributes } = &block.kind else { return None };
        let ends =
            |block: &Block| matches!(block.kind, Kind::Heading { level: l, .. } if l <= *level);
        let after = &page.blocks[at + 1..];
        let length = after.iter().position(ends).unwrap_or(after.len());
        let anchor = anchor_of(title, attributes);
        let (name, number) = match level {
            1 => (page.slug.clone(), page.number.clone().unwrap_or_default()),
            _ => (format!("{}#{anchor}", page.slug), block.number.clone()),
        };
        let seconds = seconds(&page.blocks[at..=at + length]);
        let (path, title) = (page.path.clone(), title.clone());
        Some((name, Stop { path, anchor, number, title, seconds }))
    };
    page.blocks.iter().enumerate().filter_map(stop).collect()
}

/// The time that blocks take without those in depth, and with them: prose at 200 words a minute, half a
/// minute for an equation or a figure, one for a listing.
pub fn seconds(blocks: &[Block]) -> [f64; 2] {
    let of = |block: &Block| match &block.kind {
        Kind::Text(text) | Kind::Choice { text, .. } | Kind::Step { text, .. } => {
            text.split_whitespace().count() as f64 * 0.3
        }
        Kind::Equation { .. } | Kind::Figure { .. } => 30.0,
        Kind::Fence { .. } => 60.0,
        _ => 0.0,
    };
    // A section in depth is no shorter for being one.
    let is_deep = blocks.first().is_some_and(|block| block.depth.is_some());
    let main: f64 = blocks.iter().filter(|block| is_deep || block.depth.is_none()).map(of).sum();
    [main, blocks.iter().map(of).sum()]
}

/// A time as a reader plans it: minutes, in steps of five where they are many, and then half hours.
pub fn planned(seconds: f64) -> String {
    let minutes = seconds / 60.0;
    if minutes <= 10.0 {
        let minutes = minutes.ceil().max(1.0);
        return format!("{minutes} minute{}", if minutes == 1.0 { "" } else { "s" });
    }
    if minutes <= 90.0 {
        return format!("{} minutes", fives(seconds));
    }
    let halves = (minutes / 30.0).ceil() as usize;
    format!("{}{} hours", halves / 2, if halves % 2 == 1 { "½" } else { "" })
}

/// Minutes in steps of five.
pub fn fives(seconds: f64) -> usize {
    (seconds / 300.0).ceil().max(1.0) as usize * 5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded_up_to_what_one_plans_with() {
        let said = [30.0, 61.0, 11.0 * 60.0, 89.0 * 60.0, 91.0 * 60.0, 130.0 * 60.0].map(planned);
        assert_eq!(
            said,
            ["1 minute", "2 minutes", "15 minutes", "90 minutes", "2 hours", "2½ hours"]
        );
    }
}
