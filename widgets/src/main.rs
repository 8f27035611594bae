//! Says what a widget shows in a state.
//!
//! ```text
//! cargo run -p widgets -- NAME [CONTROL=VALUE]…
//! ```

use std::process::ExitCode;

use serde_json::{Map, Value, json};
use widgets::WIDGETS;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match said(&arguments) {
        Ok(said) => {
            println!("{said}");
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::FAILURE
        }
    }
}

fn said(arguments: &[String]) -> Result<Value, String> {
    let names = || WIDGETS.iter().map(|(name, _)| *name).collect::<Vec<_>>();
    let Some((name, settings)) = arguments.split_first() else {
        return Ok(json!(names()));
    };
    let found = WIDGETS.iter().find(|(known, _)| known == name);
    let (_, player) =
        found.ok_or_else(|| format!("there is no widget {name}; there are {:?}", names()))?;
    let mut player = player();
    for setting in settings {
        let parsed =
            setting.split_once('=').and_then(|(name, value)| Some((name, value.parse().ok()?)));
        let (name, value) = parsed.ok_or_else(|| format!("{setting} is not CONTROL=VALUE"))?;
        if !player.set(name, value) {
            return Err(format!("there is no control {name}"));
        }
    }
    let numbers = |pairs: Vec<(&str, f64)>| -> Map<String, Value> {
        pairs.into_iter().map(|(label, value)| (label.to_owned(), json!(value))).collect()
    };
    let readings = numbers(player.readings());
    let (told, steps) = player.steps();
    let controls = numbers(player.controls());
    Ok(json!({ "controls": controls, "readings": readings, "told": told, "steps": steps }))
}
