//! What the program prints and writes: JSON for the press, SVG and CSV for the reader.

use std::io;
use std::path::Path;

use serde_json::{Map, Value, json};

use crate::chapter::{
    Chapter, Counterexample, Equation, NamedFigure, counterexample_failure, text,
};
use crate::data::{NotMade, files_read};
use crate::figure::{Figure, Link};
use crate::record::{Record, asked};

/// The chapters and the names of their records.
pub fn list(chapters: &[Chapter]) -> Value {
    let chapters: Vec<Value> = chapters
        .iter()
        .map(|chapter| {
            let records: Vec<&str> = chapter.records.iter().map(|record| record.name).collect();
            json!({ "slug": chapter.slug, "records": records })
        })
        .collect();
    json!({ "chapters": chapters })
}

/// Writes `exhibits.json`, which names the files that were read, and an SVG and a CSV file for each figure.
pub fn write_chapter(chapter: &Chapter, folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut figures = Vec::new();
    for named in &chapter.figures {
        let drawn = (named.draw)();
        std::fs::write(folder.join(named.name).with_extension("svg"), &drawn.svg)?;
        write_csv(&drawn, &folder.join(named.name).with_extension("csv"))?;
        figures.push(figure(named, &drawn));
    }
    let summary = json!({
        "slug": chapter.slug,
        "equations": chapter.equations.iter().map(equation).collect::<Vec<_>>(),
        "counterexamples": chapter.counterexamples.iter().map(counterexample).collect::<Vec<_>>(),
        "numbers": numbers(chapter),
        "figures": figures,
        "records": records(chapter),
        "asked": asked(),
        "read": files_read(),
    });
    std::fs::write(folder.join("exhibits.json"), format!("{summary:#}\n"))
}

/// Runs a record.
pub fn record(chapter: &Chapter, record: &Record) -> Result<Value, NotMade> {
    let values = record.run.values()?;
    let values: Map<String, Value> = values
        .into_iter()
        .map(|result| {
            let described = json!({
                "value": result.value,
                "text": text(result.value, result.decimals),
                "unit": result.unit,
                "within": result.within,
            });
            (result.name.into_owned(), described)
        })
        .collect();
    Ok(json!({
        "name": record.name,
        "chapter": chapter.slug,
        "inputs": inputs(record),
        "values": values,
    }))
}

fn equation(equation: &Equation) -> Value {
    let comparison = equation.check();
    json!({
        "label": equation.label,
        "worst": comparison.worst,
        "tolerance": comparison.tolerance,
        "unit": comparison.unit,
        "states": comparison.states,
        "against": comparison.against,
        "failure": comparison.failure(),
        "mutants": equation.mutants,
        "survivors": equation.survivors(),
        "file": equation.place.file,
        "line": equation.place.line,
    })
}

fn counterexample(case: &Counterexample) -> Value {
    let comparisons = case.comparisons();
    let [kept, dropped] = &comparisons;
    json!({
        "theorem": case.theorem,
        "condition": case.condition,
        "kept": kept.worst,
        "dropped": dropped.worst,
        "tolerance": kept.tolerance,
        "unit": kept.unit,
        "against": kept.against,
        "failure": counterexample_failure(&comparisons),
        "file": case.place.file,
        "line": case.place.line,
    })
}

fn numbers(chapter: &Chapter) -> Vec<Value> {
    let numbers = chapter.numbers.iter();
    numbers
        .map(|number| {
            json!({
                "name": number.name,
                "value": number.value,
                "text": number.text,
                "unit": number.unit,
                "file": number.place.file,
                "line": number.place.line,
            })
        })
        .collect()
}

fn figure(named: &NamedFigure, drawn: &Figure) -> Value {
    json!({
        "name": named.name,
        "columns": drawn.columns,
        "rows": drawn.rows,
        "links": drawn.links.iter().map(link).collect::<Vec<_>>(),
        "file": named.place.file,
        "line": named.place.line,
    })
}

fn link(link: &Link) -> Value {
    json!({
        "name": link.name,
        "to": link.to,
        "before": link.before,
        "corner": link.corner,
        "size": link.size,
    })
}

fn records(chapter: &Chapter) -> Vec<Value> {
    let records = chapter.records.iter();
    records
        .map(|record| {
            json!({
                "name": record.name,
                "inputs": inputs(record),
                "file": record.place.file,
                "line": record.place.line,
            })
        })
        .collect()
}

fn inputs(record: &Record) -> Map<String, Value> {
    let inputs = record.inputs.iter();
    inputs.map(|(name, value)| (name.to_string(), json!(value))).collect()
}

fn write_csv(figure: &Figure, file: &Path) -> io::Result<()> {
    let mut writer = csv::Writer::from_path(file)?;
    writer.write_record(&figure.columns)?;
    for row in &figure.rows {
        writer.write_record(row)?;
    }
    writer.flush()
}
