//! Drawings of blocks, in rows from above to below, each of which leads to a place of the book.

use plotters::element::{PathElement, Polygon, Rectangle, Text};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::figure::{
    Column, Drawing, Drawn, Figure, GRID, INK, Link, PAPER, SERIES, WIDTH, letters_of,
};

/// A part of a system.
pub struct Block {
    /// What it is, in lines that fit its width.
    pub lines: &'static [&'static str],
    /// The label of the place that explains it.
    pub to: &'static str,
    /// Whether the book builds it.
    pub built: bool,
}

/// Blocks beside each other, and the part of a system that they make up.
pub struct Row {
    /// What the row is called.
    pub name: &'static str,
    /// One block or two.
    pub blocks: &'static [Block],
}

/// Height of the letters, in units of the view box: on a telephone a quarter of that in pixels.
const LETTERS: f64 = 50.0;
const LINE: i32 = 60;
const MARGIN: i32 = 20;
/// Between two rows, with the name of the lower one.
const GAP: i32 = 116;
/// Above and below the lines of a block.
const PADDING: i32 = 22;

/// A block where it is drawn.
struct Placed {
    row: usize,
    name: &'static str,
    block: &'static Block,
    corner: (i32, i32),
    size: (i32, i32),
}

impl Placed {
    /// Where an arrow comes in or goes out: far enough to the right for the name of the row.
    fn arrow_x(&self) -> i32 {
        self.corner.0 + self.size.0 * 4 / 5
    }

    fn bottom(&self) -> i32 {
        self.corner.1 + self.size.1
    }

    fn link(&self) -> Link {
        Link {
            name: self.block.lines.join(" "),
            to: self.block.to,
            before: if self.block.built { "" } else { "left out: " },
            corner: self.corner,
            size: self.size,
        }
    }
}

/// The figure of a system, with its blocks as data.
pub fn diagram(rows: &'static [Row]) -> Figure {
    let placed = place(rows);
    let height = placed.iter().map(Placed::bottom).max().unwrap_or(0) + MARGIN;
    let column =
        |name, cell: fn(&Placed) -> String| -> Column { (name, placed.iter().map(cell).collect()) };
    let columns = vec![
        column("part", |placed| placed.name.to_owned()),
        column("block", |placed| placed.block.lines.join(" ")),
        column("in this book", |placed| {
            if placed.block.built { "built" } else { "left out" }.into()
        }),
        column("leads to", |placed| placed.block.to.to_owned()),
    ];
    let links = placed.iter().map(Placed::link).collect();
    Figure::new(height as u32, columns, |drawing| paint(drawing, &placed)).with_links(links)
}

/// All blocks, rows below each other; those of a row share its width and are equally high.
fn place(rows: &'static [Row]) -> Vec<Placed> {
    let width = WIDTH as i32 - 2 * MARGIN;
    let mut top = 0;
    let mut placed = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        top += GAP;
        let count = row.blocks.len() as i32;
        let share = (width - 2 * MARGIN * (count - 1)) / count;
        let lines = row.blocks.iter().map(|block| block.lines.len()).max().unwrap_or(0) as i32;
        let size = (share, (lines + 1) * LINE + 2 * PADDING);
        for (column, block) in row.blocks.iter().enumerate() {
            let corner = (MARGIN + column as i32 * (share + 2 * MARGIN), top);
            placed.push(Placed { row: index, name: row.name, block, corner, size });
        }
        top += size.1;
    }
    placed
}

fn paint(drawing: &Drawing, placed: &[Placed]) -> Drawn {
    for one in placed {
        paint_block(drawing, one)?;
        if one.corner.0 == MARGIN {
            let style = letters_of(LETTERS, INK).pos(Pos::new(HPos::Left, VPos::Bottom));
            drawing.draw(&Text::new(one.name, (MARGIN, one.corner.1 - 14), style))?;
        }
        let above: Vec<&Placed> = placed.iter().filter(|above| above.row + 1 == one.row).collect();
        let below = placed.iter().filter(|below| below.row == one.row).count();
        // Where the rows have one and two blocks, the arrows stand where the two are.
        let stems = match above.len() > below {
            true => above.iter().map(|above| above.arrow_x()).collect(),
            false if above.is_empty() => Vec::new(),
            false => vec![one.arrow_x()],
        };
        for x in stems {
            arrow(drawing, x, one.corner.1 - GAP, one.corner.1)?;
        }
    }
    Ok(())
}

/// A block the book builds has a thick frame, one that it leaves out a thin one on grey.
fn paint_block(drawing: &Drawing, Placed { block, corner, size, .. }: &Placed) -> Drawn {
    let corners = [*corner, (corner.0 + size.0, corner.1 + size.1)];
    let ground = if block.built { PAPER } else { GRID };
    drawing.draw(&Rectangle::new(corners, ground.filled()))?;
    // A rectangle of the backend has a hairline, whatever is asked for; a path has not.
    let [(left, top), (right, bottom)] = corners;
    let frame = vec![(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
    let style = if block.built { SERIES[0].stroke_width(8) } else { INK.stroke_width(2) };
    drawing.draw(&PathElement::new(frame, style))?;
    for (number, line) in block.lines.iter().enumerate() {
        let at = (corner.0 + 24, corner.1 + PADDING + 4 + LINE * number as i32);
        drawing.draw(&Text::new(*line, at, letters_of(LETTERS, INK)))?;
    }
    Ok(())
}

/// An arrow downwards.
fn arrow(drawing: &Drawing, x: i32, from: i32, to: i32) -> Drawn {
    let stem = vec![(x, from + 6), (x, to - 26)];
    drawing.draw(&PathElement::new(stem, INK.stroke_width(4)))?;
    let head = vec![(x, to - 6), (x - 15, to - 34), (x + 15, to - 34)];
    drawing.draw(&Polygon::new(head, INK.filled()))?;
    Ok(())
}
