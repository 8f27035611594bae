//! A widget in the hands of a reader.

use crate::{Face, Scene, Steps, Widget};

/// A widget, the values of its controls and what it shows.
pub struct Session<W> {
    widget: W,
    face: Face,
    face_as_json: String,
    controls: Vec<f64>,
    scene: Scene,
    numbers: Vec<f64>,
    steps: Vec<f64>,
}

impl<W: Widget + Default> Session<W> {
    /// As it stands on the page at first.
    pub fn new() -> Self {
        Self::of(W::default())
    }

    /// With some controls changed, by name; `None` if there is no such control.
    pub fn with(settings: &[(&str, f64)]) -> Option<Self> {
        let mut session = Self::new();
        let known = settings.iter().all(|(name, value)| session.set(name, *value));
        known.then_some(session)
    }
}

impl<W: Widget> Session<W> {
    /// A widget as it stands on the page at first.
    pub fn of(widget: W) -> Self {
        let face = widget.face();
        Self {
            widget,
            face,
            face_as_json: serde_json::to_string(&face).unwrap_or_default(),
            controls: face.controls.iter().map(|control| control.start).collect(),
            scene: Scene::default(),
            numbers: Vec::new(),
            steps: Vec::new(),
        }
    }

    /// The face as JSON.
    pub fn face(&self) -> &str {
        &self.face_as_json
    }

    /// The values of the controls.
    pub fn controls(&self) -> &[f64] {
        &self.controls
    }

    /// Computes a little of what is shown; whether more is left.
    pub fn advance(&mut self) -> bool {
        self.settle();
        self.widget.advance(&self.controls)
    }

    /// Draws what has been computed; the readings and the marks.
    pub fn show(&mut self) -> &[f64] {
        self.settle();
        self.scene.clear();
        self.widget.show(&self.controls, &mut self.scene);
        self.scene.write(&mut self.numbers);
        &self.numbers
    }

    /// The decisions and numbers of the steps until what is shown.
    pub fn steps(&mut self) -> &[f64] {
        self.settle();
        self.steps.clear();
        self.widget.steps(&self.controls, &mut self.steps);
        &self.steps
    }

    /// Puts all controls between their ends.
    fn settle(&mut self) {
        for (value, control) in self.controls.iter_mut().zip(self.face.controls) {
            // Not `clamp`, which can panic with numbers in words, and a module would carry how to write them.
            let inside = value.max(control.least).min(control.most);
            *value = if value.is_nan() { control.start } else { inside };
        }
    }

    /// Computes all that is left, and draws it.
    fn show_whole(&mut self) -> &[f64] {
        while self.advance() {}
        self.show()
    }

    /// What the picture that was drawn last says in words.
    pub fn said(&self) -> &str {
        self.scene.said()
    }

    /// Drags a handle.
    pub fn drag(&mut self, handle: usize, to: [f64; 2]) {
        if to.iter().all(|number| number.is_finite()) {
            self.widget.drag(handle, to, &mut self.controls);
        }
    }
}

impl<W: Widget + Default> Default for Session<W> {
    fn default() -> Self {
        Self::new()
    }
}

/// A session whose widget is not known when compiling.
pub trait Player {
    /// The face as JSON.
    fn face(&self) -> &str;
    /// Sets a control by its name; false if there is none.
    fn set(&mut self, name: &str, value: f64) -> bool;
    /// Drags a handle.
    fn drag(&mut self, handle: usize, to: [f64; 2]);
    /// The values of the controls, by name.
    fn controls(&self) -> Vec<(&'static str, f64)>;
    /// Draws the whole picture; the readings by label.
    fn readings(&mut self) -> Vec<(&'static str, f64)>;
    /// Draws the whole picture; all numbers of the scene.
    fn numbers(&mut self) -> &[f64];
    /// What is told of each step until what is shown, and each of them.
    fn steps(&mut self) -> (Steps, Vec<Vec<f64>>);
}

impl<W: Widget> Player for Session<W> {
    fn face(&self) -> &str {
        &self.face_as_json
    }

    fn set(&mut self, name: &str, value: f64) -> bool {
        let Some(at) = self.face.controls.iter().position(|control| control.name == name) else {
            return false;
        };
        self.controls[at] = value;
        true
    }

    fn drag(&mut self, handle: usize, to: [f64; 2]) {
        Session::drag(self, handle, to);
    }

    fn controls(&self) -> Vec<(&'static str, f64)> {
        let names = self.face.controls.iter().map(|control| control.name);
        names.zip(self.controls.iter().copied()).collect()
    }

    fn readings(&mut self) -> Vec<(&'static str, f64)> {
        self.show_whole();
        let labels = self.face.readings.iter().map(|reading| reading.label);
        labels.zip(self.scene.readings().iter().copied()).collect()
    }

    fn numbers(&mut self) -> &[f64] {
        self.show_whole()
    }

    fn steps(&mut self) -> (Steps, Vec<Vec<f64>>) {
        self.show_whole();
        let width = W::STEPS.decisions.len() + W::STEPS.numbers.len();
        let steps = Session::steps(self).chunks(width.max(1)).map(<[f64]>::to_vec);
        (W::STEPS, steps.collect())
    }
}
