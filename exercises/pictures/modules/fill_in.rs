//! `exercises/src/fill_in.rs` for the browser.

#[path = "../../src/fill_in.rs"]
mod answer;

exercise_pictures::picture!(Beside of fill_in: new_couplings, information_lost, cheapest_link);
