//! Of many numbers one.

/// The middle one of numbers.
pub fn median(numbers: impl IntoIterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.into_iter().collect();
    let half = numbers.len() / 2;
    if numbers.is_empty() {
        return f64::NAN;
    }
    *numbers.select_nth_unstable_by(half, f64::total_cmp).1
}

/// The root of the mean of the squares.
pub fn root_mean_square(numbers: impl IntoIterator<Item = f64>) -> f64 {
    let (count, sum) =
        numbers.into_iter().fold((0.0, 0.0), |(count, sum), x| (count + 1.0, sum + x * x));
    (sum / f64::max(count, 1.0)).sqrt()
}
