//! Makes the book: exhibits, pages, links.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context, Result, anyhow};
use mdbook_driver::MDBook;
use mdbook_driver::config::Config;
use rayon::prelude::*;

use crate::answers::{self, Answers};
use crate::api::publish;
use crate::fault::Faults;
use crate::files;
use crate::formulas::RememberingKatex;
use crate::guard::Guard;
use crate::links;
use crate::preprocess::{Later, Press};
use crate::program::{Program, Speed};
use crate::recordings::Recordings;
use crate::settings::{Layout, Settings};
use crate::steps::Steps;
use crate::warnings::Warnings;
use crate::widgets::{Refreshed, Widgets};

/// What every build of the book needs.
#[derive(Clone)]
pub struct Maker {
    /// Where things lie.
    pub layout: Layout,
    /// How to tell what goes on.
    pub steps: Steps,
    /// What mdBook and its helpers warn of.
    pub warnings: Warnings,
    /// Whether pages of exercises show the reader's own answers.
    pub mine: bool,
}

impl Maker {
    /// Builds the book into a folder and gives the faults found on the way.
    ///
    /// # Errors
    /// What keeps the pages from being made at all: exhibits that do not compile, a damaged `book.toml`, a folder
    /// that cannot be written.
    pub fn build(&self, site: &Path) -> Result<Faults> {
        self.refresh_exhibits()?;
        let refreshed = self.refresh_widgets()?;
        let mut faults = self.pages(site, None, None, true)?;
        faults.extend(self.links(site)?);
        self.say_still(&refreshed);
        Ok(faults)
    }

    /// Builds as [`Maker::build`] does, for somebody who waits: `shown` is called as soon as there are pages, and
    /// those of the library come after that when they have to be made.
    ///
    /// # Errors
    /// As [`Maker::build`].
    pub fn build_live(&self, site: &Path, news: &str, shown: impl FnOnce()) -> Result<Faults> {
        self.refresh_exhibits()?;
        let widgets = Widgets::new(&self.layout);
        // The first pages wait for them; those after an edit do not.
        let before =
            if widgets.scripts()?.is_empty() { Some(self.refresh_widgets()?) } else { None };
        let later = Later::default();
        let mut faults = self.pages(site, Some(&later), Some(news), true)?;
        shown();
        let refreshed = match before {
            Some(refreshed) => refreshed,
            None => {
                let refreshed = self.refresh_widgets()?;
                if refreshed == Refreshed::Compiled {
                    write_generated(site, &widgets.scripts()?)?;
                }
                refreshed
            }
        };
        self.say_still(&refreshed);
        let plan = later.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(plan) = plan {
            faults.extend(self.steps.step("pages of the library", || plan.make())?);
            faults.extend(self.warnings.take(&faults));
            publish::copy(&self.layout.api(), &site.join("api"))?;
        }
        faults.extend(self.links(site)?);
        Ok(faults)
    }

    /// Builds only what somebody who reads one chapter waits for: its exhibits and all pages, as they are with the
    /// exhibits that there are of other chapters, without a search. Gives the faults, and whether exhibits are still to
    /// be computed.
    ///
    /// # Errors
    /// As [`Maker::build`].
    pub fn build_first(&self, site: &Path, news: &str, chapter: &str) -> Result<(Faults, bool)> {
        let rest = self.refresh_exhibits_of(|slug| slug == chapter)?;
        Ok((self.pages(site, Some(&Later::default()), Some(news), false)?, rest))
    }

    fn pages(
        &self,
        site: &Path,
        later: Option<&Later>,
        live_reload: Option<&str>,
        search: bool,
    ) -> Result<Faults> {
        let faults = Arc::new(Mutex::new(Faults::default()));
        let press = Press::new(self.layout.clone(), faults.clone(), later.cloned());
        let press = if self.mine { press.with_answers() } else { press };
        self.steps.step("pages", || self.render(site, press, live_reload, search))?;
        let mut faults =
            std::mem::take(&mut *faults.lock().unwrap_or_else(PoisonError::into_inner));
        faults.extend(self.warnings.take(&faults));
        Ok(faults)
    }

    fn links(&self, site: &Path) -> Result<Faults> {
        self.steps.step("links", || links::faults(site, &self.layout.src()))
    }

    /// Compiles the pictures to take hold of, unless that is done.
    pub fn refresh_widgets(&self) -> Result<Refreshed> {
        Widgets::new(&self.layout).refresh(&self.steps)
    }

    /// Compiles the reader's answers that changed, for the pages of a site. Gives whether one did.
    pub fn refresh_answers(&self, site: &Path) -> Result<bool> {
        let changed = Answers::new(&self.layout).refresh(&self.steps)?;
        write_generated(site, &changed)?;
        Ok(!changed.is_empty())
    }

    fn say_still(&self, refreshed: &Refreshed) {
        if let Refreshed::Impossible(why) = refreshed {
            self.steps.say(&format!("The pictures to take hold of stand still: {why}."));
        }
        if Recordings::new(&self.layout).are_stale().unwrap_or_default() {
            self.steps.say(
                "The scenes cannot be opened in three dimensions: the library is another one since they were recorded. \
                 `cargo book viewer` records them again.",
            );
        }
    }

    /// Makes what a page needs to open scenes in three dimensions.
    ///
    /// # Errors
    /// What keeps rerun from being compiled, or the scenes from being recorded.
    pub fn make_viewer(&self) -> Result<()> {
        let bytes = Recordings::new(&self.layout).make(&self.steps)?;
        self.steps.say(&format!(
            "The viewer has {:.1} MB. `cargo book build` and `cargo book serve` put it beside the book from now on; \
             deleting target/press/recordings leaves it out again.",
            bytes as f64 / 1e6
        ));
        Ok(())
    }

    /// Computes the exhibits of the chapters whose inputs changed.
    pub fn refresh_exhibits(&self) -> Result<()> {
        self.refresh_exhibits_of(|_| true).map(drop)
    }

    /// Computes those of them that are wanted; gives whether there are others.
    fn refresh_exhibits_of(&self, wanted: impl Fn(&str) -> bool) -> Result<bool> {
        let settings = Settings::read(&self.layout.root)?;
        let program = Program::new(&self.layout, &settings)?;
        program.forget_others()?;
        let (stale, others): (Vec<_>, Vec<_>) =
            program.stale()?.into_iter().partition(|slug| wanted(slug));
        if !stale.is_empty() {
            let compile = || program.compile(Speed::Everyday);
            let executable = self.steps.step("compiling the exhibits", compile)?;
            let length = stale.len() as u64;
            self.steps.counted("computing the exhibits", length, |bar| {
                stale.par_iter().try_for_each(|slug| {
                    program.run(&executable, slug)?;
                    bar.set_message(format!("computed the exhibits of {slug}"));
                    bar.inc(1);
                    Ok(())
                })
            })?;
        }
        Ok(!others.is_empty())
    }

    /// Makes a record with the program.
    pub fn make_record(&self, name: &str) -> Result<crate::records::Made> {
        let settings = Settings::read(&self.layout.root)?;
        let program = Program::new(&self.layout, &settings)?;
        let compile = || program.compile(Speed::Measured);
        let executable = self.steps.step("compiling the exhibits", compile)?;
        self.steps.step(&format!("making the record {name}"), || program.record(&executable, name))
    }

    /// The book as mdBook reads it. A chapter that nobody wrote is an error and not an empty file.
    pub fn load(&self) -> Result<MDBook> {
        let read = || {
            let mut config = Config::from_disk(self.layout.root.join("book.toml"))?;
            config.update_from_env()?;
            config.build.create_missing = false;
            MDBook::load_with_config(&self.layout.root, config)
        };
        read().map_err(|error| anyhow!("{error:#}")).context("mdBook cannot read the book")
    }

    fn render(
        &self,
        site: &Path,
        press: Press,
        live_reload: Option<&str>,
        search: bool,
    ) -> Result<()> {
        let mut book = self.load()?;
        book.config.build.build_dir = absolute(site)?;
        if let Some(endpoint) = live_reload {
            book.config.set("output.html.live-reload-endpoint", endpoint)?;
        }
        if !search {
            book.config.set("output.html.search.enable", false)?;
        }
        if self.mine {
            let key = "output.html.additional-js";
            let mut scripts: Vec<String> = book.config.get(key)?.unwrap_or_default();
            scripts.push(answers::SCRIPT.to_owned());
            book.config.set(key, scripts)?;
        }
        book.with_preprocessor(press);
        book.with_preprocessor(RememberingKatex::new(&self.layout.work()));
        book.with_preprocessor(Guard);
        book.build().map_err(|error| anyhow!("{error:#}")).context("mdBook cannot make the pages")
    }

    /// Builds into `book/`, which is replaced only when nothing is wrong.
    pub fn build_book(&self) -> Result<Faults> {
        let site = self.layout.work().join("site");
        let faults = self.build(&site)?;
        if faults.is_empty() {
            files::replace_folder(&site, &self.layout.root.join("book"))?;
        }
        Ok(faults)
    }
}

/// Puts scripts where the pages of a site load them.
fn write_generated(site: &Path, scripts: &BTreeMap<PathBuf, Vec<u8>>) -> Result<()> {
    scripts
        .iter()
        .try_for_each(|(path, script)| files::write(&site.join("generated").join(path), script))
}

fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).with_context(|| format!("{} is not a path", path.display()))
}
