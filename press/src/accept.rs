//! `cargo book accept` and `cargo book record`: what a person has looked at becomes what the build expects.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Result;
use dissimilar::Chunk;

use crate::accepted::{Accepted, normal};
use crate::blocks::Kind;
use crate::exhibits::Exhibits;
use crate::files;
use crate::make::Maker;
use crate::pages::Page;
use crate::records::Record;

/// Shows what changed since it was last accepted, and accepts it unless `only_show`. With `moved` it is only the
/// equations that moved from a chapter to another and say what they said: nobody has to look at them again.
pub fn accept(maker: &Maker, only_show: bool, moved: bool) -> Result<()> {
    // Records first: exhibits that show a new one, or one that cannot be read, end before their equations are known.
    let records = if moved { 0 } else { records(maker, only_show)? };
    let equations = match equations(maker, only_show, moved) {
        Err(why) if only_show && records > 0 => {
            println!("Before these records are accepted, equations cannot be compared: {why:#}");
            0
        }
        equations => equations?,
    };
    match (records + equations, only_show, moved) {
        (0, _, true) => println!("Nothing moved."),
        (0, _, false) => println!("Nothing changed."),
        (n, true, true) => println!("{n} moved; `cargo book accept --moved` carries them over."),
        (n, true, false) => println!("{n} changed; `cargo book accept` accepts."),
        (n, false, true) => println!("{n} carried over."),
        (n, false, false) => println!("{n} accepted."),
    }
    Ok(())
}

fn equations(maker: &Maker, only_show: bool, moved: bool) -> Result<usize> {
    let book = maker.load()?;
    let pages = Page::all(&book.book);
    let slugs: Vec<String> = pages.iter().map(|page| page.slug.clone()).collect();
    maker.refresh_exhibits()?;
    let exhibits = Exhibits::read(&maker.layout, &slugs)?;
    let old = Accepted::read_all(&maker.layout)?;
    // What was accepted for a chapter that is gone goes too.
    let mut new: BTreeMap<String, Accepted> =
        old.keys().map(|slug| (slug.clone(), Accepted::default())).collect();
    for page in &pages {
        let of_its_chapter = new.entry(page.owner.clone()).or_default();
        for (label, tex) in checkable_equations(page) {
            match exhibits.check(&page.owner, &label) {
                Some(_) => drop(of_its_chapter.equations.insert(label, tex)),
                None => println!("{} eq:{label} has no check to be held against", page.owner),
            }
        }
    }
    let (changes, after) = if moved {
        carried_over(&old, &new)
    } else {
        let nothing = Accepted::default();
        let before = |slug: &String| old.get(slug).unwrap_or(&nothing);
        let changes = new.iter().map(|(slug, new)| show_equations(slug, before(slug), new)).sum();
        (changes, new)
    };
    if !only_show {
        for (slug, accepted) in &after {
            accepted.write(&maker.layout.accepted(slug))?;
        }
    }
    Ok(changes)
}

/// What is accepted once all equations have gone where they stand now, and how many went.
fn carried_over(
    old: &BTreeMap<String, Accepted>,
    new: &BTreeMap<String, Accepted>,
) -> (usize, BTreeMap<String, Accepted>) {
    let has = |all: &BTreeMap<String, Accepted>, slug: &str, label: &str| {
        all.get(slug).is_some_and(|chapter| chapter.equations.contains_key(label))
    };
    let mut after = old.clone();
    let mut moves = 0;
    for (to, stands) in new {
        for (label, tex) in stands.equations.iter().filter(|(label, _)| !has(old, to, label)) {
            let left = |from: &&String| {
                old[*from].equations.get(label) == Some(tex) && !has(new, from, label)
            };
            let Some(from) = old.keys().find(left) else { continue };
            println!("eq:{label} moved from {from} to {to}");
            after.entry(from.clone()).or_default().equations.remove(label);
            after.entry(to.clone()).or_default().equations.insert(label.clone(), tex.clone());
            moves += 1;
        }
    }
    (moves, after)
}

/// The equations of a page that ask for a check, as they are now.
fn checkable_equations(page: &Page) -> impl Iterator<Item = (String, String)> {
    let equation = |kind: &Kind| match kind {
        Kind::Equation { tex, attributes, .. } if !attributes.has("definition") => {
            Some((attributes.id.strip_prefix("eq:")?.to_owned(), normal(tex)))
        }
        _ => None,
    };
    page.blocks.iter().filter_map(move |block| equation(&block.kind))
}

fn show_equations(slug: &str, old: &Accepted, new: &Accepted) -> usize {
    let mut changes = 0;
    for (label, tex) in &new.equations {
        match old.equations.get(label) {
            Some(known) if known == tex => continue,
            Some(known) => println!("{slug} eq:{label} changed:\n  {}", difference(known, tex)),
            None => println!("{slug} eq:{label} is new:\n  {tex}"),
        }
        changes += 1;
    }
    for (label, tex) in
        old.equations.iter().filter(|(label, _)| !new.equations.contains_key(*label))
    {
        println!("{slug} eq:{label} is gone:\n  {tex}");
        changes += 1;
    }
    changes
}

/// Two texts as one, with what went in [-…-] and what came in {+…+}.
fn difference(old: &str, new: &str) -> String {
    let mark = |chunk: &Chunk<'_>| match chunk {
        Chunk::Equal(text) => (*text).to_owned(),
        Chunk::Delete(text) => format!("[-{text}-]"),
        Chunk::Insert(text) => format!("{{+{text}+}}"),
    };
    dissimilar::diff(old, new).iter().map(mark).collect()
}

fn records(maker: &Maker, only_show: bool) -> Result<usize> {
    let (kept, proposed) = (maker.layout.records(), maker.layout.proposed_records());
    let new = Record::read_all(&proposed)?;
    for record in new.values() {
        println!("record {}:", record.name);
        show_record(known(&kept, &record.name).as_ref(), record);
        if !only_show {
            record.write(&kept)?;
            files::remove(&proposed.join(format!("{}.toml", record.name)))?;
        }
    }
    Ok(new.len())
}

/// The record as it is. One that cannot be read is made again as one that is not there.
fn known(folder: &Path, name: &str) -> Option<Record> {
    Record::read(folder, name).ok().flatten()
}

fn show_record(old: Option<&Record>, new: &Record) {
    match old.map(|old| old.differences(new)) {
        None => new.values.iter().for_each(|(name, value)| {
            println!("  {name} = {} {} ({})", value.text, value.unit, value.value)
        }),
        Some(differences) if differences.is_empty() => println!("  as before, within its margins"),
        Some(differences) => differences.iter().for_each(|difference| println!("  {difference}")),
    }
}

/// Makes a record anew and keeps it for `cargo book accept`; or, with `compare`, only says whether it still comes
/// out as it was accepted. Gives whether it does.
pub fn record(maker: &Maker, name: &str, compare: bool) -> Result<bool> {
    let made = maker.make_record(name)?;
    let record = Record::new(made, today(), machine());
    let old = known(&maker.layout.records(), name);
    println!("record {name}:");
    show_record(old.as_ref(), &record);
    let same = old.is_some_and(|old| old.differences(&record).is_empty());
    if !compare {
        record.write(&maker.layout.proposed_records())?;
        println!("Not accepted yet: `cargo book accept` does that.");
    }
    Ok(same)
}

/// The names of all accepted records.
pub fn record_names(maker: &Maker) -> Result<Vec<String>> {
    let files = files::below(&maker.layout.records())?;
    let name = |file: &PathBuf| Some(file.file_stem()?.to_string_lossy().into_owned());
    Ok(files.iter().filter_map(name).collect())
}

/// Today's date, UTC.
fn today() -> String {
    jiff::Timestamp::now().strftime("%Y-%m-%d").to_string()
}

/// The machine, as far as it matters for a number.
fn machine() -> String {
    let cpu = files::read_if_there("/proc/cpuinfo".as_ref()).ok().flatten().unwrap_or_default();
    let model = cpu.lines().find_map(|line| {
        line.strip_prefix("model name")?.split_once(": ").map(|(_, name)| name.to_owned())
    });
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let model = model.unwrap_or_else(|| "unknown processor".to_owned());
    format!("{} {}, {model}, {cores} cores", std::env::consts::OS, std::env::consts::ARCH)
}
