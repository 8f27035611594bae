//! No measured or derived number is typed into prose: it would go on standing there when the code says another.

use std::sync::LazyLock;

use regex::Regex;

use crate::accepted::normal;
use crate::fault::Faults;
use crate::settings::Allowed;

/// Units of measurement, as they follow a number.
pub const UNITS: &str = r"px|pixels?|[kcmµn]?m|(?:kilo|centi|milli|micro)?met(?:re|er)s?|m?rad|(?:milli)?radians?|deg|degrees?|°|µs|[mn]?s|(?:milli|micro)?seconds?|min|minutes?|hours?|[kM]?Hz|k?g|%|percent|[kMG]?B|bytes?|m/s²?|fps|sigmas?";

static PROSE: LazyLock<Regex> = LazyLock::new(|| pattern(&format!(r"[\s\u{{202f}}-]?(?:{UNITS})")));
static TEX: LazyLock<Regex> = LazyLock::new(|| {
    pattern(&format!(
        r"(?:\\[,;:! ]|[~{{}} ])*(?:\\(?:text|mathrm)\{{[ ~]*(?:{UNITS})|\^\{{?\\circ)"
    ))
});

fn pattern(unit: &str) -> Regex {
    Regex::new(&format!(
        r"(?:^|[^\w.#/&@-])(?:\d[\d.]*-)?([-−]?\d[\d.,]*(?:e-?\d+)?{unit})(?:$|[^\w])"
    ))
    .expect("a valid pattern")
}

/// Looks for typed numbers with units and remembers which permissions were used.
#[derive(Debug)]
pub struct Lint<'a> {
    allowed: &'a [Allowed],
    used: Vec<bool>,
}

impl<'a> Lint<'a> {
    /// A lint with its permissions.
    pub fn new(allowed: &'a [Allowed]) -> Lint<'a> {
        Lint { allowed, used: vec![false; allowed.len()] }
    }

    /// Looks at a piece of prose.
    pub fn prose(&mut self, place: (&str, usize), slug: &str, text: &str, faults: &mut Faults) {
        self.look(&PROSE, place, slug, text, faults);
    }

    /// Looks at a formula.
    pub fn tex(&mut self, place: (&str, usize), slug: &str, tex: &str, faults: &mut Faults) {
        self.look(&TEX, place, slug, tex, faults);
    }

    fn look(
        &mut self,
        pattern: &Regex,
        place: (&str, usize),
        slug: &str,
        text: &str,
        faults: &mut Faults,
    ) {
        let mut at = 0;
        while let Some(number) = pattern.captures_at(text, at).and_then(|found| found.get(1)) {
            at = number.end();
            let said = normal(number.as_str());
            let allows =
                |allowed: &Allowed| allowed.chapter == slug && normal(&allowed.text) == said;
            match self.allowed.iter().position(allows) {
                Some(index) => self.used[index] = true,
                None => {
                    let line = place.1 + text[..number.start()].matches('\n').count();
                    faults.add(
                        (place.0, line),
                        said,
                        "a number with a unit is typed into the prose",
                        format!("compute it: register it in exhibits/src/{slug}.rs and write {{{{value {slug}.NAME}}}}; or allow it with a reason under [[preprocessor.press.allow]] in book.toml"),
                    );
                }
            }
        }
    }

    /// Permissions without a reason, and permissions that nothing needs.
    pub fn finish(&self, faults: &mut Faults) {
        for (allowed, used) in self.allowed.iter().zip(&self.used) {
            let label = format!("{}: {}", allowed.chapter, allowed.text);
            if !used {
                faults.add(
                    ("book.toml", 0),
                    &label,
                    "a typed number is allowed that no chapter has",
                    "remove the permission",
                );
            }
            if allowed.reason.trim().is_empty() {
                faults.add(
                    ("book.toml", 0),
                    &label,
                    "a typed number is allowed without a reason",
                    "say why it is not computed",
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str, tex: bool) -> Vec<String> {
        let mut faults = Faults::default();
        let mut lint = Lint::new(&[]);
        match tex {
            true => lint.tex(("a.md", 1), "a", text, &mut faults),
            false => lint.prose(("a.md", 1), "a", text, &mut faults),
        }
        faults.sorted().into_iter().map(|fault| fault.label).collect()
    }

    #[test]
    fn numbers_with_units_are_found() {
        for text in [
            "moves 3 px away",
            "0.5 m",
            "(12.5 cm)",
            "a 10-degree turn",
            "5 %",
            "200 Hz,",
            "3.5 mrad",
            "90°",
            "−2 m",
            "4\u{a0}s.",
            "moves 3\npx away",
            "5-10 m",
        ] {
            assert_eq!(found(text, false).len(), 1, "{text}");
        }
        assert_eq!(found("3 m 4 s", false).len(), 2);
        assert_eq!(found(r"b = 0.5\,\mathrm{m}", true).len(), 1);
        assert_eq!(found(r"90^\circ", true).len(), 1);
    }

    #[test]
    fn a_number_is_named_and_allowed_wherever_its_line_ends() {
        assert_eq!(found("moves 3\npx away", false), ["3 px"]);
        let allowed = [Allowed { chapter: "a".into(), text: "60 s".into(), reason: "so".into() }];
        let (mut lint, mut faults) = (Lint::new(&allowed), Faults::default());
        lint.prose(("a.md", 1), "a", "A minute has 60\ns.", &mut faults);
        lint.finish(&mut faults);
        assert!(faults.is_empty(), "{}", faults.report());
    }

    #[test]
    fn other_numbers_are_left_alone() {
        for text in [
            "3 cameras",
            "in 2017",
            "SE(3)",
            "the 2x6 block",
            "40/11",
            "Mars 4",
            "1 of 3",
            "MH_05 s",
            "three metres",
        ] {
            assert!(found(text, false).is_empty(), "{text}: {:?}", found(text, false));
        }
        assert!(found(r"2 m_1 + 3 s", true).is_empty(), "a product is not a quantity");
    }
}
