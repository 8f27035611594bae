//! The whole book on paper: printed again until the page numbers in its references are those of the pages.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Result, bail};
use serde_json::json;

use super::browser::Browser;
use super::document::{Document, without_chance};
use super::imprint::Imprint;
use crate::fault::Faults;
use crate::steps::Steps;

/// The page that holds all of them.
const PAGE: &str = "print.html";
/// What prepares it; see there.
const SCRIPT: &str = include_str!("paper.js");
/// CSS pixels between the margins of the paper, which `print.css` sets.
const WIDTH: u32 = 590;
/// New numbers move what follows them, by less in every round.
const ROUNDS: usize = 6;

/// A book on paper.
pub struct Printed {
    /// The PDF.
    pub bytes: Vec<u8>,
    /// How many pages it has.
    pub pages: usize,
    /// How often it was printed.
    pub rounds: usize,
    /// What is cut, and what the PDF lacks.
    pub faults: Faults,
}

/// Prints a site with a browser that keeps what it needs in the folder `profile`.
///
/// # Errors
/// No browser, or one that does not print as expected.
pub fn print(steps: &Steps, site: &Path, imprint: &Imprint, profile: &Path) -> Result<Printed> {
    let mut browser = Browser::start(profile)?;
    let page = site.join(PAGE);
    let mut faults = steps.step("pages for paper", || prepare(&mut browser, &page, imprint))?;
    let mut known = BTreeMap::new();
    for round in 1..=ROUNDS {
        let bytes = steps.step(&format!("paper, round {round}"), || browser.pdf())?;
        let document = Document::read(&bytes)?;
        let names = document.names()?;
        if names == known {
            for problem in document.problems() {
                faults.add(
                    ("the PDF", 0),
                    "",
                    problem,
                    "look at press/theme/css/print.css and press/src/pack",
                );
            }
            let pages = document.page_count();
            return Ok(Printed { bytes: without_chance(bytes)?, pages, rounds: round, faults });
        }
        browser.evaluate(&format!("paper.number({})", json!(names)))?;
        known = names;
    }
    bail!(
        "after {ROUNDS} rounds the page numbers still change: a reference at the end of a page pushes its own target to \
         and fro; add or take a word near it"
    )
}

/// Opens the page as it is on paper. Gives what is wider than that.
fn prepare(browser: &mut Browser, page: &Path, imprint: &Imprint) -> Result<Faults> {
    // It asks for a printer as soon as it is there.
    let quiet = json!({ "source": "window.print = () => {};" });
    browser.call("Page.addScriptToEvaluateOnNewDocument", quiet)?;
    let light = json!([{ "name": "prefers-color-scheme", "value": "light" }]);
    browser.call("Emulation.setEmulatedMedia", json!({ "media": "print", "features": light }))?;
    let size = json!({ "width": WIDTH, "height": 840, "deviceScaleFactor": 1, "mobile": false });
    browser.call("Emulation.setDeviceMetricsOverride", size)?;
    browser.open(page)?;
    let cut = browser.evaluate(&format!("({SCRIPT})({})", json!(imprint)))?;
    let mut faults = Faults::default();
    for place in cut.as_array().into_iter().flatten().filter_map(|place| place.as_str()) {
        faults.add(
            (PAGE, 0),
            place,
            "it is wider than the paper",
            "break it into lines, or make it narrower",
        );
    }
    Ok(faults)
}
