//! What a widget draws, as a list of numbers that a script can read without knowing what they mean.

/// What a line or mark stands for; the page decides about its colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// What is there.
    Ink,
    /// What helps to see it.
    Faint,
    /// What was measured.
    Measured,
    /// What was computed from it.
    Estimated,
    /// What was known before.
    Prior,
    /// Something to be told apart from others.
    First,
    /// The same.
    Second,
    /// The same.
    Third,
}

/// How places are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Joined; a place that is not a number breaks the line.
    Line,
    /// The same, dashed.
    Dashed,
    /// Joined, closed and filled.
    Area,
    /// One by one.
    Discs,
    /// The same, hollow.
    Rings,
    /// The same, as crosses.
    Crosses,
    /// As squares of length one around them, filled.
    Cells,
    /// The same, so that they are only just seen.
    PaleCells,
}

/// Marks of a scene that are none of places.
const VIEW: f64 = 100.0;
const HANDLE: f64 = 101.0;
const WORD: f64 = 102.0;

/// A picture and its numbers.
#[derive(Debug, Default)]
pub struct Scene {
    readings: Vec<f64>,
    marks: Vec<f64>,
    said: String,
}

impl Scene {
    /// Forgets all, and keeps the memory.
    pub fn clear(&mut self) {
        self.readings.clear();
        self.marks.clear();
        self.said.clear();
    }

    /// Adds the next number of the face; `None` where there is none.
    pub fn read(&mut self, value: impl Into<Option<f64>>) {
        self.readings.push(value.into().unwrap_or(f64::NAN));
    }

    /// The numbers, in the order of the face.
    pub fn readings(&self) -> &[f64] {
        &self.readings
    }

    /// Says a sentence beside the picture, after those that were said before.
    pub fn say(&mut self, sentence: &str) {
        if !self.said.is_empty() {
            self.said.push(' ');
        }
        self.said.push_str(sentence);
    }

    /// All that was said.
    pub fn said(&self) -> &str {
        &self.said
    }

    /// Draws places in a panel. `size` is the width of a line or the radius of a mark, in pixels of the page.
    pub fn draw(
        &mut self,
        panel: usize,
        (shape, style, size): (Shape, Style, f64),
        places: impl IntoIterator<Item = [f64; 2]>,
    ) {
        let start = self.marks.len();
        self.marks.extend([shape as u8 as f64, panel as f64, style as u8 as f64, size, 0.0]);
        self.marks.extend(places.into_iter().flatten());
        let numbers = self.marks.len() - start - 5;
        self.marks[start + 4] = numbers as f64;
    }

    /// Shows another part of a panel than its face says.
    pub fn view(&mut self, panel: usize, x: [f64; 2], y: [f64; 2]) {
        self.marks.extend([VIEW, panel as f64, 0.0, 0.0, 4.0, x[0], x[1], y[0], y[1]]);
    }

    /// Puts a handle where it can be taken hold of.
    pub fn handle(&mut self, panel: usize, handle: usize, style: Style, at: [f64; 2]) {
        let kind = style as u8 as f64;
        self.marks.extend([HANDLE, panel as f64, kind, handle as f64, 2.0, at[0], at[1]]);
    }

    /// Writes a word of the face to the right of a place.
    pub fn word(&mut self, panel: usize, word: usize, style: Style, at: [f64; 2]) {
        let kind = style as u8 as f64;
        self.marks.extend([WORD, panel as f64, kind, word as f64, 2.0, at[0], at[1]]);
    }

    /// The readings and then, for each mark: its shape, panel, style, size, how many numbers follow, and those.
    pub fn write(&self, into: &mut Vec<f64>) {
        into.clear();
        into.extend(&self.readings);
        into.extend(&self.marks);
    }
}
