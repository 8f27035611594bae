//! The two cameras of [`Bearing`], asked how sure a depth is.

use crate::bearing::Bearing;
use crate::{Face, Question, Reading, Scene, Widget};

/// The same picture with another question.
#[derive(Default)]
pub struct Parallax(Bearing);

/// The place of the part of the depth that its σ is among the readings.
const RELATIVE: usize = 4;

const fn readings() -> [Reading; 7] {
    let mut readings = Bearing::READINGS;
    let mut number = 0;
    while number < readings.len() {
        readings[number].veiled = number == RELATIVE;
        number += 1;
    }
    readings
}

impl Widget for Parallax {
    const FACE: Face = Face {
        lead: "Answer, then draw the true depth to eight metres and the baseline to sixty centimetres, and compare the parallax and σ over the depth. Then lengthen the baseline alone. The cloud is where two noisy pixels put the landmark.",
        readings: &readings(),
        question: Some(Question {
            ask: "Depth and baseline both become twice as large. What becomes of σ, as a part of the depth?",
            choices: &[
                "it stays as it is",
                "it becomes twice as large",
                "it becomes four times as large",
            ],
            right: 0,
            why: "The angle between the rays is the same, and a pixel is the same part of it: σ and depth grow together.",
        }),
        ..Bearing::FACE
    };

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        self.0.show(controls, scene);
    }

    fn drag(&self, handle: usize, to: [f64; 2], controls: &mut [f64]) {
        self.0.drag(handle, to, controls);
    }
}
