//! The preprocessor that keeps the promises of the book.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Result;
use mdbook_preprocessor::book::Book;
use mdbook_preprocessor::config::Config;
use mdbook_preprocessor::{Preprocessor, PreprocessorContext};

use crate::accepted::Accepted;
use crate::answers::Answers;
use crate::api::Plan;
use crate::api::items::Library;
use crate::bibliography::{self, Bibliography};
use crate::blocks::Kind;
use crate::emit::Emitter;
use crate::exhibits::Exhibits;
use crate::fault::Faults;
use crate::files;
use crate::formulas;
use crate::index;
use crate::ledger;
use crate::lint::Lint;
use crate::main_road;
use crate::pages::{Labels, Page, number_of};
use crate::prose::{Found, Known};
use crate::recordings::{Recording, Recordings};
use crate::reports::Reports;
use crate::settings::{Layout, Settings};
use crate::sources;
use crate::theorems::Theorems;
use crate::ways::Ways;
use crate::widgets::Widgets;

/// Resolves labels, numbers, figures and listings, and finds what the book says and no program does.
///
/// Faults do not stop it: it gathers them for whoever runs it.
pub struct Press {
    layout: Layout,
    faults: Arc<Mutex<Faults>>,
    later: Option<Later>,
    mine: bool,
}

/// The pages of the library, when they are to be made after those of the chapters.
pub type Later = Arc<Mutex<Option<Plan>>>;

impl Press {
    /// A press for the book in `layout`, which adds what it finds to `faults`. It makes the pages of the library, or
    /// leaves them in `later` for somebody else to make.
    pub fn new(layout: Layout, faults: Arc<Mutex<Faults>>, later: Option<Later>) -> Press {
        Press { layout, faults, later, mine: false }
    }

    /// The same, whose pages of exercises show the reader's own answers.
    pub fn with_answers(self) -> Press {
        Press { mine: true, ..self }
    }

    fn make_or_leave(&self, plan: Plan) -> Result<Faults> {
        match &self.later {
            _ if plan.is_made()? => {}
            None => return plan.make(),
            Some(later) => {
                *later.lock().unwrap_or_else(PoisonError::into_inner) = Some(plan);
            }
        }
        Ok(Faults::default())
    }
}

impl Preprocessor for Press {
    fn name(&self) -> &str {
        "press"
    }

    fn run(&self, context: &PreprocessorContext, mut book: Book) -> Result<Book> {
        let (mut faults, plan) = press(&self.layout, &context.config, &mut book, self.mine)?;
        if let Some(plan) = plan {
            faults.extend(self.make_or_leave(plan)?);
        }
        self.faults.lock().unwrap_or_else(PoisonError::into_inner).extend(faults);
        Ok(book)
    }
}

/// Presses all chapters of a book, and plans the pages of the library.
fn press(
    layout: &Layout,
    config: &Config,
    book: &mut Book,
    mine: bool,
) -> Result<(Faults, Option<Plan>)> {
    let settings = Settings::read(&layout.root)?;
    let pages = Page::all(book);
    let mut faults = Faults::default();
    Page::parts(&pages, &mut faults);
    let labels = Labels::collect(&pages, &mut faults);
    let slugs: Vec<String> = pages.iter().map(|page| page.slug.clone()).collect();
    let exhibits = Exhibits::read(layout, &slugs)?;
    let works = files::read_if_there(&layout.root.join(bibliography::FILE))?.unwrap_or_default();
    let bibliography = Bibliography::parse(&works, &mut faults);
    faults.extend(exhibits.faults());
    let library = Library::read(&layout.root, &settings.library_package)?;
    let ways = Ways::collect(&pages);
    let accepted = Accepted::read_all(layout)?;
    let theorems = Theorems::collect(&pages, &mut faults);
    theorems.check(&pages, &exhibits, &mut faults);
    main_road::check(&pages, settings.longest_main_road, &mut faults);
    let widgets = Widgets::new(layout);
    let mut scripts = widgets.scripts()?;
    let size = |name: &String| Some(scripts.get(Path::new(&format!("widgets/{name}.js")))?.len());
    let names = widgets.names()?.into_iter().map(|name| (name.clone(), size(&name)));
    let names: BTreeMap<String, Option<usize>> = names.collect();
    let answers = Answers::new(layout);
    if mine {
        scripts.extend(answers.scripts()?);
    }
    let recordings = Recordings::new(layout).shown()?;
    let reports = Reports::new(config);
    let known = Known {
        widgets: &names,
        recordings: &recordings.scenes,
        labels: &labels,
        theorems: &theorems,
        ways: &ways,
        exhibits: &exhibits,
        bibliography: &bibliography,
        library: &library,
        accepted: &accepted,
        reports: &reports,
    };
    let mut found = Found::new(faults, Lint::new(&settings.allow));
    found.generated.extend(scripts.into_iter().chain(recordings.files.clone()));
    let mut contents = BTreeMap::new();
    for page in &pages {
        contents.insert(
            page.path.clone(),
            Emitter::new(page, &known, &settings, layout, &mut found).emit(),
        );
    }
    for page in &pages {
        if let Some(content) = contents.get_mut(&page.path) {
            if content.contains("{{ledger}}") {
                *content = content
                    .replace("{{ledger}}", &ledger::ledger(page, &pages, &known, &mut found));
            }
            if content.contains("{{mine}}") {
                let part = if mine { answers.part(page) } else { String::new() };
                *content = content.replace("{{mine}}", &part);
            }
            if content.contains("{{index}}") {
                *content =
                    content.replace("{{index}}", &index::index(page, &pages, &known, &found));
            }
            if content.contains("{{bibliography}}") {
                *content = content.replace(
                    "{{bibliography}}",
                    &ledger::bibliography(page, &pages, &known, &found),
                );
            }
        }
    }
    book.for_each_chapter_mut(|chapter| {
        if let Some(content) = chapter.source_path.as_ref().and_then(|path| contents.remove(path)) {
            chapter.content = content;
        }
        // The list of chapters would call a page below one as it calls a section.
        if let Some(places) = chapter.number.as_ref().filter(|places| places.len() > 1) {
            chapter.name = format!("{} {}", number_of(places), chapter.name);
        }
    });
    unused(&pages, &exhibits, &mut found);
    unshown(&recordings.scenes, &mut found);
    found.terms.check(&pages, &labels, &mut found.faults);
    found.symbols.check(&pages, &mut found.faults);
    found.lint.finish(&mut found.faults);
    let plan = Plan::new(layout, &settings, config, &pages, &known, &mut found)?;
    formulas::try_all(&layout.root, config, &layout.work(), &found.formulas, &mut found.faults)?;
    write_generated(layout, &labels, &mut found)?;
    Ok((found.faults, plan))
}

/// What the program makes and no chapter shows.
fn unused(pages: &[Page], exhibits: &Exhibits, found: &mut Found<'_>) {
    let asked: BTreeSet<&String> =
        exhibits.chapters.values().flat_map(|shown| &shown.asked).collect();
    for (name, file, line) in exhibits.number_names() {
        if !found.values.contains_key(&name) && !asked.contains(&name) {
            found.faults.add(
                (&file, line),
                &name,
                "no chapter uses this number",
                format!("write {{{{value {name}}}}} where it belongs, or remove it"),
            );
        }
    }
    for shown in exhibits.chapters.values() {
        for figure in &shown.figures {
            let name = format!("{}/{}", shown.slug, figure.name);
            if !found.figures.contains(&name) {
                found.faults.add(
                    (&figure.file, figure.line),
                    &name,
                    "no chapter shows this figure",
                    "show it, or remove it",
                );
            }
        }
        let labels: BTreeSet<&str> = pages
            .iter()
            .filter(|page| page.owner == shown.slug)
            .flat_map(|page| &page.blocks)
            .filter_map(|block| match &block.kind {
                Kind::Equation { attributes, .. } => attributes.id.strip_prefix("eq:"),
                _ => None,
            })
            .collect();
        for check in shown.equations.iter().filter(|check| !labels.contains(check.label.as_str())) {
            let problem = format!(
                "src/{}.md has no equation that this checks, nor has a page that is part of it",
                shown.slug
            );
            found.faults.add(
                (&check.file, check.line),
                format!("eq:{}", check.label),
                problem,
                "label the equation, or remove the check",
            );
        }
    }
}

/// Scenes that no chapter shows.
fn unshown(scenes: &BTreeMap<String, Recording>, found: &mut Found<'_>) {
    for name in scenes.keys().filter(|name| !found.recordings.contains(*name)) {
        found.faults.add(
            (&format!("recordings/pictures/{name}.png"), 0),
            name,
            "no chapter shows this picture of a scene",
            format!("show it as a figure recordings/{name}.png, or remove the scene"),
        );
    }
}

/// Writes data and source pages for mdBook to copy, and removes those of earlier builds.
fn write_generated(layout: &Layout, labels: &Labels, found: &mut Found<'_>) -> Result<()> {
    let mut made = std::mem::take(&mut found.generated);
    for file in &found.sources {
        let source = files::read(&layout.root.join(file))?;
        made.insert(
            format!("source/{file}.html").into(),
            sources::page(file, &source, labels).into_bytes(),
        );
    }
    let folder = layout.generated();
    for (path, content) in &made {
        files::write(&folder.join(path), content)?;
    }
    for stale in files::below(&folder)?.iter().filter(|path| !made.contains_key(*path)) {
        files::remove(&folder.join(stale))?;
    }
    Ok(())
}
