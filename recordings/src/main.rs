//! `cargo run -p recordings --release -- NAME`: scenes of the book in three dimensions.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail};
use clap::Parser;
use recordings::{SCENES, SCENES_OF_DATA, Scene, Stage, VERSION, write_viewer};

/// Records a scene of the book for the viewer of rerun.
#[derive(Parser)]
#[command(name = "recordings", version, after_help = list())]
struct Arguments {
    /// The scene, named as its chapter; without it, all are listed.
    name: Option<String>,
    /// Show it in the viewer, which is what happens unless it is saved.
    #[arg(long)]
    view: bool,
    /// Write it into a file.
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Write all scenes and the viewer for web pages into a folder, as `cargo book viewer` asks for them.
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["name", "view", "save"])]
    web: Option<PathBuf>,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<()> {
    if let Some(folder) = &arguments.web {
        return web(folder);
    }
    let Some(name) = &arguments.name else {
        if arguments.view || arguments.save.is_some() {
            bail!("which scene? {}", names());
        }
        println!("{}\n\ncargo run -p recordings --release -- NAME [--view | --save FILE]", list());
        return Ok(());
    };
    let Some(scene) = Scene::named(name) else {
        bail!("there is no scene `{name}`: {}", names());
    };
    if let Some(file) = &arguments.save {
        scene.play(&Stage::in_file(scene.name, file)?)?;
    }
    if arguments.view || arguments.save.is_none() {
        scene.play(&Stage::in_viewer(scene.name)?)?;
    }
    Ok(())
}

fn web(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("the folder {} cannot be made", folder.display()))?;
    for scene in SCENES {
        let file = folder.join(format!("{}.rrd", scene.name));
        scene.play(&Stage::in_file(scene.name, &file)?)?;
    }
    Ok(write_viewer(folder)?)
}

fn names() -> String {
    let names: Vec<_> = SCENES.iter().chain(&SCENES_OF_DATA).map(|scene| scene.name).collect();
    format!("the scenes are {}", names.join(", "))
}

fn list() -> String {
    let line = |scene: &Scene| format!("  {:<18} {}", scene.name, scene.shows);
    let lines: Vec<_> = SCENES.iter().chain(&SCENES_OF_DATA).map(line).collect();
    let viewer = format!(
        "The viewer comes with `pip install rerun-sdk=={VERSION}`. It tells its makers that it is used, until \
         `rerun analytics disable`."
    );
    format!("Scenes:\n{}\n\n{viewer}", lines.join("\n"))
}
