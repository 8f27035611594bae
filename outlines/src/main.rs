//! `outlines FONTS SVG PNG`: draws the letters of all figures in the folder `SVG`, where they stay, and makes a picture of
//! each in the folder `PNG`.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use outlines::Pen;

fn main() -> Result<()> {
    let folders: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    let [fonts, svg, png] = &folders[..] else {
        bail!("name the folders of the fonts, of the figures and of their pictures");
    };
    let pen = Pen::new(fonts)?;
    fs::create_dir_all(png).with_context(|| format!("cannot write {}", png.display()))?;
    let entries = fs::read_dir(svg).with_context(|| format!("cannot read {}", svg.display()))?;
    for entry in entries {
        let file = entry?.path();
        draw(&pen, &file, png).with_context(|| file.display().to_string())?;
    }
    Ok(())
}

fn draw(pen: &Pen, file: &Path, pictures: &Path) -> Result<()> {
    let figure = pen.draw(&fs::read_to_string(file)?)?;
    let name = file.file_stem().context("a file without a name")?;
    fs::write(file, figure.svg())?;
    fs::write(pictures.join(name).with_extension("png"), figure.png()?)?;
    Ok(())
}
