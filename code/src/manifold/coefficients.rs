//! The functions of the angle that multiply the matrices of [`so3`](super::so3) and
//! [`se3`](super::se3).
//!
//! All of them are even and finite at zero. The *slope* of a function f is f'(t)/t, which
//! is again even and finite: it is what the chain rule asks for, since the angle of φ
//! changes by φ·δ/t when φ changes by δ.
//!
//! Written as in a textbook, most of them subtract nearly equal numbers at small angles.
//! Products of half angles avoid that where they can. The three functions that remain
//! have two forms, and change over where the closed form still has its digits.

// ANCHOR: sinc
/// sin t / t.
pub fn sinc(t: f64) -> f64 {
    if t == 0.0 { 1.0 } else { t.sin() / t }
}

/// (1 − cos t) / t², as ½ sinc²(t/2).
pub fn cosc(t: f64) -> f64 {
    0.5 * sinc(0.5 * t).powi(2)
}
// ANCHOR_END: sinc

// ANCHOR: sinc_remainder
/// (1 − sinc t) / t², that is (t − sin t) / t³.
pub fn sinc_remainder(t: f64) -> f64 {
    const SERIES: [f64; 9] = [
        1.0 / factorial(3),
        -1.0 / factorial(5),
        1.0 / factorial(7),
        -1.0 / factorial(9),
        1.0 / factorial(11),
        -1.0 / factorial(13),
        1.0 / factorial(15),
        -1.0 / factorial(17),
        1.0 / factorial(19),
    ];
    // At 1 the difference has lost a factor of six; the series is short of 1e-19.
    if t < 1.0 { polynomial(&SERIES, t * t) } else { (t - t.sin()) / (t * t * t) }
}
// ANCHOR_END: sinc_remainder

/// The slope of [`sinc`]: (t cos t − sin t) / t³.
pub fn sinc_slope(t: f64) -> f64 {
    const SERIES: [f64; 9] = [
        -2.0 / factorial(3),
        4.0 / factorial(5),
        -6.0 / factorial(7),
        8.0 / factorial(9),
        -10.0 / factorial(11),
        12.0 / factorial(13),
        -14.0 / factorial(15),
        16.0 / factorial(17),
        -18.0 / factorial(19),
    ];
    if t < 1.0 { polynomial(&SERIES, t * t) } else { (t * t.cos() - t.sin()) / (t * t * t) }
}

/// The slope of [`sinc_slope`]: −(sinc t + 3 sinc_slope t) / t².
pub fn sinc_second_slope(t: f64) -> f64 {
    const SERIES: [f64; 12] = [
        2.0 * 4.0 / factorial(5),
        -4.0 * 6.0 / factorial(7),
        6.0 * 8.0 / factorial(9),
        -8.0 * 10.0 / factorial(11),
        10.0 * 12.0 / factorial(13),
        -12.0 * 14.0 / factorial(15),
        14.0 * 16.0 / factorial(17),
        -16.0 * 18.0 / factorial(19),
        18.0 * 20.0 / factorial(21),
        -20.0 * 22.0 / factorial(23),
        22.0 * 24.0 / factorial(25),
        -24.0 * 26.0 / factorial(27),
    ];
    // Five powers of t cancel here, so the series has to reach farther.
    if t < 2.0 { polynomial(&SERIES, t * t) } else { -(sinc(t) + 3.0 * sinc_slope(t)) / (t * t) }
}

/// The slope of [`cosc`], as ¼ sinc(t/2) times the slope of sinc at t/2.
pub fn cosc_slope(t: f64) -> f64 {
    0.25 * sinc(0.5 * t) * sinc_slope(0.5 * t)
}

/// The slope of [`sinc_remainder`]: −(sinc_slope t + 2 sinc_remainder t) / t².
pub fn sinc_remainder_slope(t: f64) -> f64 {
    const SERIES: [f64; 12] = [
        -2.0 / factorial(5),
        4.0 / factorial(7),
        -6.0 / factorial(9),
        8.0 / factorial(11),
        -10.0 / factorial(13),
        12.0 / factorial(15),
        -14.0 / factorial(17),
        16.0 / factorial(19),
        -18.0 / factorial(21),
        20.0 / factorial(23),
        -22.0 / factorial(25),
        24.0 / factorial(27),
    ];
    if t < 2.0 {
        polynomial(&SERIES, t * t)
    } else {
        -(sinc_slope(t) + 2.0 * sinc_remainder(t)) / (t * t)
    }
}

// ANCHOR: cotangent_remainder
/// (1 − (t/2) cot(t/2)) / t², which has a pole at 2π.
pub fn cotangent_remainder(t: f64) -> f64 {
    -0.25 * sinc_slope(0.5 * t) / sinc(0.5 * t)
}
// ANCHOR_END: cotangent_remainder

/// The slope of [`cotangent_remainder`].
pub fn cotangent_remainder_slope(t: f64) -> f64 {
    let half = 0.5 * t;
    let ratio = sinc_slope(half) / sinc(half);
    (ratio * ratio - sinc_second_slope(half) / sinc(half)) / 16.0
}

/// c₀ + c₁ x + c₂ x² + …, by Horner's rule.
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

const fn factorial(n: u32) -> f64 {
    if n == 0 { 1.0 } else { n as f64 * factorial(n - 1) }
}
