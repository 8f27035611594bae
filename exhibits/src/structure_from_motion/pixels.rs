//! Measured pixels: a public problem of bundle adjustment without its cameras and points.

use crate::chapter::Chapter;
use crate::data::{DataFile, NotMade};
use crate::record::RecordValue;

#[allow(dead_code)]
#[path = "../../../code/examples/reconstruct.rs"]
mod example;

use example::Input;

pub const LADYBUG: DataFile = DataFile {
    path: "bal/problem-49-7776-pre.txt",
    sha256: "96ca2845519d89d0727953d983427ab38a42c54991cd4d73e46a4221da3c61b4",
};
const SEEDS: u64 = 20;
pub const WRONG: f64 = 0.2;

pub fn record(chapter: &mut Chapter) {
    let inputs = vec![
        ("seeds", format!("0 to {}", SEEDS - 1)),
        ("wrong matches", format!("{WRONG} of all")),
    ];
    chapter.record_of_data("real_pixels", &[LADYBUG], inputs, seeds);
}

/// Twenty maps, each of other wrong matches in another order.
fn seeds() -> Result<Vec<RecordValue>, NotMade> {
    let text = LADYBUG.read()?;
    let failed = |error: Box<dyn std::error::Error>| NotMade::Failed(error.to_string());
    let (mut all, mut worst) = (0, [f64::NEG_INFINITY; 4]);
    let (mut right, mut wrong) = (0, 0);
    for seed in 0..SEEDS {
        let input = Input::new(&text, WRONG, seed).map_err(failed)?;
        let found = input.reconstruct(seed).map_err(failed)?;
        all += usize::from(found.cameras.iter().all(Result::is_ok));
        let truth = input.truth.as_ref().ok_or(NotMade::Failed("no truth".into()))?;
        let judged = truth.judge(&found).map_err(failed)?;
        let [plain, truncated] = &judged.beside;
        let above = |least: f64| 100.0 * (judged.truncated / least - 1.0);
        let now = [
            above(plain.truncated),
            above(truncated.truncated),
            plain.root_mean_square,
            truncated.largest,
        ];
        worst = std::array::from_fn(|at| f64::max(worst[at], now[at]));
        (right, wrong) = (input.matches.len() - input.wrong, input.wrong);
    }
    let value =
        |name, value, unit, decimals, within| RecordValue::new(name, value, unit, decimals, within);
    Ok(vec![
        value("seeds", SEEDS as f64, "", 0, 0.0),
        value("right", right as f64, "", 0, 0.0),
        value("wrong", wrong as f64, "", 0, 0.01),
        value("all_registered", all as f64, "", 0, 0.0),
        value("above_plain", worst[0], "%", 1, 0.1),
        value("above_truncated", worst[1], "%", 1, 1.0),
        value("from_plain", worst[2], "%", 2, 0.1),
        value("from_truncated", worst[3], "%", 2, 0.5),
    ])
}
