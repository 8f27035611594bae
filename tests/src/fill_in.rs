//! Longer windows, keyframes that leave from anywhere, blocks of other sizes.

use exercise_spec::check::Check;
use exercise_spec::draw::Draw;
use exercise_spec::fill_in::{Slide, Window, cheapest, couplings, losses, unlinked};

/// The checks on instances of a seed.
pub fn checks(seed: [u8; 32]) -> Vec<Check> {
    let mut draw = Draw::of_seed(seed);
    let slides: Vec<Slide> = (0..12)
        .map(|index| {
            let (keyframes, landmarks) = (draw.index(6..14), draw.index(4..12));
            Slide::drawn(&mut draw, keyframes, landmarks, index % 3 > 0)
        })
        .collect();
    let windows: Vec<Window> = [(5, 2), (6, 1), (4, 3), (4, 6)]
        .map(|(keyframes, size)| Window::drawn(&mut draw, keyframes, size))
        .into();
    let dropped = windows.clone();
    let rows: Vec<Slide> = (0..8)
        .map(|index| {
            let (keyframes, landmarks) = (draw.index(5..14), draw.index(4..30));
            let row = Slide::in_a_row(keyframes, landmarks, index % 2 == 0);
            Slide { departing: draw.index(0..keyframes), ..row }
        })
        .collect();
    vec![
        Check::new("slides_of_any_layout", move |answer| {
            slides.iter().try_for_each(|slide| couplings(answer, slide))
        }),
        Check::new("rows_of_any_length", move |answer| {
            rows.iter().try_for_each(|row| couplings(answer, row))
        }),
        Check::new("losses_of_any_link", move |answer| losses(answer, &windows)),
        Check::new("cheapest_links_of_any_window", move |answer| {
            cheapest(answer, &dropped)?;
            unlinked(answer, 7, 1)
        }),
    ]
}
