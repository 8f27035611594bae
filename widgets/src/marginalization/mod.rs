//! A window that slides: who is coupled then, and what is known.

mod draw;
mod free;
mod link;
mod window;

use vislam::marginalization::Information;

use crate::{Axis, Control, Face, Handle, Panel, Question, Reading, Scene, Widget};
use draw::{ENDS, MATRIX, Sorted, WORDS, draw_end, draw_graph, draw_link, draw_matrix};
use free::{Freeze, free_directions};
use link::{Dropped, Ends, Way};
use window::{Pair, Pattern, Plan};

/// The window of the chapter, which forgets its oldest keyframes.
#[derive(Default)]
pub struct Marginalization {
    pattern: Last<Plan, Pattern>,
    gaussian: Last<Plan, Option<Information<f64>>>,
    dropped: Last<(Plan, Pair, Way), Dropped>,
    free: Last<(Plan, Freeze), Option<usize>>,
}

/// What was computed last, and what for.
struct Last<K, V>(Option<(K, V)>);

impl<K, V> Default for Last<K, V> {
    fn default() -> Self {
        Self(None)
    }
}

impl<K: PartialEq, V> Last<K, V> {
    fn get(&mut self, key: K, compute: impl FnOnce() -> V) -> &V {
        let kept = self.0.take().filter(|(other, _)| *other == key);
        &self.0.insert(kept.unwrap_or_else(|| (key, compute()))).1
    }
}

/// The slides that leave two keyframes.
const MOST_SLIDES: f64 = 6.0;

// The controls.
const SLIDES: usize = 0;
const LEAVES: usize = 1;
const POINTS: usize = 2;
const ODOMETRY: usize = 3;
const DROP: usize = 4;
const LINK: usize = 5;

const fn end(title: &'static str) -> Panel {
    let x = Axis { label: "to the right, mm", range: [-1.0, 1.0] };
    let y = Axis { label: "depth, mm", range: [-1.0, 1.0] };
    Panel { title, x, y, aspect: 0.55, span: 3, equal: true, down: false }
}

const fn counted(label: &'static str) -> Reading {
    Reading { label, unit: "", digits: 0, none: "cannot be said", veiled: false }
}

const fn known(label: &'static str, unit: &'static str, digits: usize) -> Reading {
    Reading { label, unit, digits, none: "not determined", veiled: false }
}

const fn reported(label: &'static str, unit: &'static str, digits: usize) -> Reading {
    Reading { none: "no Gaussian", ..known(label, unit, digits) }
}

impl Widget for Marginalization {
    const FACE: Face = Face {
        lead: "Answer, then slide the window: squares with a dot, and their edges, are couplings that no measurement made. Then choose a way to drop the link of a and b, slide again, and drag the ring from link to link: the ellipses compare what is reported with the truth.",
        controls: &[
            Control::count("slides", "Slide the window", MOST_SLIDES),
            Control::choice("leaves", "What leaves", &["keyframe, landmarks", "keyframe alone"]),
            Control::choice(
                "points",
                "Linearization",
                &["not frozen", "frozen anew", "frozen at first"],
            ),
            Control::switch("odometry", "Odometry"),
            Control::choice(
                "drop",
                "Link of a and b",
                &["kept", "zeroed", "marginals kept", "as in the SEIF"],
            ),
            Control::count("link", "Next link", 9999.0),
        ],
        handles: &[Handle { panel: MATRIX, label: "link" }],
        panels: &[
            Panel {
                title: "Information matrix",
                x: Axis { label: "", range: [-0.6, 19.6] },
                y: Axis { label: "", range: [-2.2, 19.6] },
                aspect: 1.05,
                span: 3,
                equal: true,
                down: true,
            },
            Panel {
                title: "Graph (bold: new, dashed: older)",
                x: Axis { label: "", range: [-0.7, 7.7] },
                y: Axis { label: "", range: [-2.6, 5.6] },
                aspect: 1.05,
                span: 3,
                equal: false,
                down: false,
            },
            end("One σ of a: true (dashed), reported"),
            end("One σ of b: true (dashed), reported"),
        ],
        readings: &[
            counted("Blocks in the window"),
            counted("Coupled pairs"),
            Reading { veiled: true, ..counted("New in this slide") },
            Reading { veiled: true, ..counted("Coupled by no measurement") },
            counted("New on the way in this slide"),
            counted("Free directions, start unknown"),
            known("True σ of a, three axes together", "mm", 2),
            reported("Reported σ of a", "mm", 2),
            known("True σ of b, three axes together", "mm", 2),
            reported("Reported σ of b", "mm", 2),
            reported("Kullback-Leibler divergence", "nats", 2),
        ],
        question: Some(Question {
            ask: "The oldest keyframe leaves with the landmarks that it saw. Which of those that stay will be coupled?",
            choices: &[
                "none that was not: no measurement names two of them",
                "every two of those that were coupled with what leaves",
                "every two of all that stay",
            ],
            right: 1,
            why: "What leaves was all that coupled them, and to sum it out leaves its message among them: a clique.",
        }),
        words: WORDS,
    };

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let plan = plan(controls);
        let freeze = chosen(&Freeze::ALL, controls[POINTS]);
        let way = chosen(&Way::ALL, controls[DROP]);
        let pattern = self.pattern.get(plan, || Pattern::of(&plan));
        let truth = self.gaussian.get(plan, || plan.gaussian()).as_ref();
        let link = pattern.link(controls[LINK].round() as usize);
        let dropped =
            link.map(|link| self.dropped.get((plan, link, way), || Dropped::of(truth, link, way)));
        let couplings = dropped.and_then(|dropped| dropped.couplings.as_ref());
        let couplings = couplings.unwrap_or(&pattern.couplings);
        let sorted = Sorted::of(pattern, couplings);
        draw_matrix(scene, &pattern.names, &sorted);
        draw_graph(scene, &pattern.names, &sorted);
        if let Some(link) = link {
            draw_link(scene, link, way != Way::Kept && truth.is_some());
        }
        let counts = [
            pattern.names.len(),
            couplings.len(),
            pattern.new.len(),
            sorted.filled.len() + sorted.new.len(),
            pattern.along_the_way,
        ];
        counts.into_iter().for_each(|count| scene.read(count as f64));
        let free = self.free.get((plan, freeze), || free_directions(&plan, freeze));
        scene.read(free.map(|count| count as f64));
        show_ends(scene, dropped);
    }

    fn drag(&self, _handle: usize, to: [f64; 2], controls: &mut [f64]) {
        if let Some(number) = Pattern::of(&plan(controls)).nearest_link(to) {
            controls[LINK] = number as f64;
        }
    }
}

/// What the controls say of the window.
fn plan(controls: &[f64]) -> Plan {
    Plan {
        slides: controls[SLIDES].clamp(0.0, MOST_SLIDES).round() as usize,
        alone: controls[LEAVES].round() > 0.0,
        odometry: controls[ODOMETRY].round() > 0.0,
    }
}

/// One of some, by its number.
fn chosen<T: Copy>(all: &[T], number: f64) -> T {
    all[(number.round() as usize).min(all.len() - 1)]
}

/// The ends of the link, in pictures and numbers.
fn show_ends(scene: &mut Scene, dropped: Option<&Dropped>) {
    let truth = dropped.and_then(|dropped| dropped.truth.as_ref());
    let reported = dropped.and_then(|dropped| dropped.reported.as_ref());
    for end in 0..ENDS.len() {
        draw_end(scene, end, truth, reported);
        let millimetres = |ends: Option<&Ends>| ends.map(|ends| 1e3 * ends.sigma(end));
        scene.read(millimetres(truth));
        scene.read(millimetres(reported));
    }
    scene.read(dropped.and_then(|dropped| dropped.nats));
    if truth.is_some() && reported.is_none() {
        scene.say("Without this link some combination of the states would have a negative variance: choose another link.");
    }
}
