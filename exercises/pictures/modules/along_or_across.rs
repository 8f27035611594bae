//! `exercises/src/along_or_across.rs` for the browser.

#[path = "../../src/along_or_across.rs"]
mod answer;

exercise_pictures::picture!(Beside of along_or_across: drag_along, drag_across, predicted_moves, exact_moves, least_noticed_drag);
