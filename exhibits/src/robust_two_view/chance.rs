//! How much agreement wrong matches reach by chance.

use vislam::robust_two_view as theory;

use crate::chapter::Chapter;
use crate::comparison::Comparison;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Alarms); 5] = [
        ("samples not counted", |n, k, m, c| {
            (n - m) as f64 * binomial(n - m, k - m) * power(c, k - m)
        }),
        ("sample agrees by chance too", |n, k, m, c| {
            theory::false_alarms(n, k, m, c) * power(c, m)
        }),
        ("sizes not counted", |n, k, m, c| theory::false_alarms(n, k, m, c) / (n - m) as f64),
        ("others have to disagree", |n, k, m, c| {
            theory::false_alarms(n, k, m, c) * power(1.0 - c, n - k)
        }),
        ("sets of agreeing ones not counted", |n, k, m, c| {
            (n - m) as f64 * binomial(n, m) * power(c, k - m)
        }),
    ];
    chapter.equation("false-alarms", false_alarms, theory::false_alarms, &mutants);
    numbers(chapter);
}

/// Takes how many data there are, how many agree, the size of a sample and the chance of a datum.
type Alarms = fn(usize, usize, usize, f64) -> f64;

fn false_alarms(formula: Alarms) -> Comparison {
    let against = "sets of agreeing data, counted over all that chance can do";
    Comparison::relative(against, 1e-9).over(100, 21, |random| {
        let count = random.uniform(12.0..30.0) as usize;
        let sample = random.uniform(1.0..6.0) as usize;
        let agree = random.uniform(sample as f64 + 2.0..count as f64 - 2.0) as usize;
        let chance = random.uniform(0.05..0.5);
        let rest = count - sample;
        // With so many agreeing ones beside the sample, so many sets of the wanted size are among them.
        let sets = (agree - sample..=rest).map(|others| {
            let probability =
                binomial(rest, others) * power(chance, others) * power(1.0 - chance, rest - others);
            probability * binomial(others, agree - sample)
        });
        let expected = rest as f64 * binomial(count, sample) * sets.sum::<f64>();
        (formula(count, agree, sample, chance), expected)
    })
}

fn power(number: f64, exponent: usize) -> f64 {
    number.powi(exponent as i32)
}

/// How many ways there are to choose.
fn binomial(from: usize, chosen: usize) -> f64 {
    (0..chosen).map(|k| (from - k) as f64 / (k + 1) as f64).product()
}

/// How many wrong matches agree with the best of many motions that have nothing to do with them.
fn numbers(chapter: &mut Chapter) {
    const MATCHES: usize = 100;
    const CHANCE: f64 = 0.05;
    const TRIED: f64 = 1000.0;
    let of = |agree: usize| {
        binomial(MATCHES, agree) * power(CHANCE, agree) * power(1.0 - CHANCE, MATCHES - agree)
    };
    let mean_number = |least: usize| TRIED * (least..=MATCHES).map(of).sum::<f64>();
    let best = (0..MATCHES).take_while(|agree| mean_number(*agree) > 0.5).last().unwrap_or(0);
    chapter.number("lucky_matches", MATCHES as f64, "", 0);
    chapter.number("lucky_percent", 100.0 * CHANCE, "%", 0);
    chapter.number("lucky_tried", TRIED, "", 0);
    chapter.number("lucky_mean", CHANCE * MATCHES as f64, "", 0);
    chapter.number("lucky_best", best as f64, "", 0);
}
