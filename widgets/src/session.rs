//! A widget in the hands of a reader.

use crate::{Scene, Widget};

/// A widget, the values of its controls and what it shows.
pub struct Session<W> {
    widget: W,
    face: String,
    controls: Vec<f64>,
    scene: Scene,
    numbers: Vec<f64>,
}

impl<W: Widget> Session<W> {
    /// As it stands on the page at first.
    pub fn new() -> Self {
        Self {
            widget: W::default(),
            face: serde_json::to_string(&W::FACE).unwrap_or_default(),
            controls: W::FACE.controls.iter().map(|control| control.start).collect(),
            scene: Scene::default(),
            numbers: Vec::new(),
        }
    }

    /// With some controls changed, by name; `None` if there is no such control.
    pub fn with(settings: &[(&str, f64)]) -> Option<Self> {
        let mut session = Self::new();
        let known = settings.iter().all(|(name, value)| session.set(name, *value));
        known.then_some(session)
    }

    /// The face as JSON.
    pub fn face(&self) -> &str {
        &self.face
    }

    /// The values of the controls.
    pub fn controls(&self) -> &[f64] {
        &self.controls
    }

    /// Draws; the readings and the marks.
    pub fn show(&mut self) -> &[f64] {
        for (value, control) in self.controls.iter_mut().zip(W::FACE.controls) {
            let inside = value.clamp(control.least, control.most);
            *value = if inside.is_nan() { control.start } else { inside };
        }
        self.scene.clear();
        self.widget.show(&self.controls, &mut self.scene);
        self.scene.write(&mut self.numbers);
        &self.numbers
    }

    /// Drags a handle.
    pub fn drag(&mut self, handle: usize, to: [f64; 2]) {
        if to.iter().all(|number| number.is_finite()) {
            self.widget.drag(handle, to, &mut self.controls);
        }
    }
}

impl<W: Widget> Default for Session<W> {
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
    /// Draws; the readings by label.
    fn readings(&mut self) -> Vec<(&'static str, f64)>;
    /// Draws; all numbers of the scene.
    fn numbers(&mut self) -> &[f64];
}

impl<W: Widget> Player for Session<W> {
    fn face(&self) -> &str {
        &self.face
    }

    fn set(&mut self, name: &str, value: f64) -> bool {
        let Some(at) = W::FACE.controls.iter().position(|control| control.name == name) else {
            return false;
        };
        self.controls[at] = value;
        true
    }

    fn drag(&mut self, handle: usize, to: [f64; 2]) {
        Session::drag(self, handle, to);
    }

    fn controls(&self) -> Vec<(&'static str, f64)> {
        let names = W::FACE.controls.iter().map(|control| control.name);
        names.zip(self.controls.iter().copied()).collect()
    }

    fn readings(&mut self) -> Vec<(&'static str, f64)> {
        self.show();
        let labels = W::FACE.readings.iter().map(|reading| reading.label);
        labels.zip(self.scene.readings().iter().copied()).collect()
    }

    fn numbers(&mut self) -> &[f64] {
        self.show()
    }
}
