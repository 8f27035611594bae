//! The functions of the angle that multiply the matrices of [`so3`](super::so3) and
//! [`se3`](super::se3).
//!
//! All of them are even and finite at zero. The *slope* of a function f is f'(t)/t, which
//! is again even and finite: it is what the chain rule asks for, since the angle of φ
//! changes by φ·δ/t when φ changes by δ.
//!
//! Written as in a textbook, most of them subtract nearly equal numbers at small angles.
//! Products of half angles avoid that where they can. The four functions that remain
//! have two forms, and change over where both still have their digits.

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
    // Digits cancel here twice over, so the series has to reach farther.
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

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use dashu_float::{FBig, round::mode::HalfEven};

    use super::*;

    type Real = FBig<HalfEven, 2>;

    /// Enough for a formula in which four powers of 1e-300 cancel.
    const BITS: usize = 4200;

    fn real(value: f64) -> Real {
        Real::try_from(value).expect("a finite number").with_precision(BITS).value()
    }

    /// Compares a function with its textbook formula in t, sin t and cos t, evaluated
    /// with digits to waste, at angles from 1e-300 to π.
    fn assert_accurate(function: fn(f64) -> f64, formula: fn(&Real, &Real, &Real) -> Real) {
        let mut angles: Vec<f64> = (1..=60).map(|k| 10_f64.powi(-5 * k)).collect();
        angles.extend((1..=62).map(|k| 0.05 * f64::from(k)));
        // Both sides of the points at which a function of t or t/2 changes its form.
        angles.extend([1.0 - f64::EPSILON, 1.0, 2.0 - f64::EPSILON, 2.0]);
        angles.extend([PI - 1e-3, PI - 1e-9, PI]);
        let mut worst = (0.0, 0.0);
        for t in angles {
            let angle = real(t);
            let truth = formula(&angle, &angle.sin(), &angle.cos());
            let error = ((real(function(t)) - &truth) / &truth).to_f64().value().abs();
            assert!(error < 1e-14, "relative error {error:.1e} at {t:e}");
            worst = if error > worst.0 { (error, t) } else { worst };
        }
        println!("largest relative error {:.1e}, at {:e}", worst.0, worst.1);
    }

    #[test]
    fn sinc_is_the_sine_by_the_angle() {
        assert_accurate(sinc, |t, sin, _| sin / t);
    }

    #[test]
    fn cosc_is_one_minus_the_cosine_by_the_squared_angle() {
        assert_accurate(cosc, |t, _, cos| (1 - cos) / (t * t));
    }

    #[test]
    fn sinc_remainder_is_the_angle_minus_the_sine_by_the_cubed_angle() {
        assert_accurate(sinc_remainder, |t, sin, _| (t - sin) / (t * t * t));
    }

    #[test]
    fn cotangent_remainder_is_what_half_angle_times_cotangent_lacks_to_one() {
        assert_accurate(cotangent_remainder, |t, sin, cos| {
            (1 - t * (1 + cos) / (2 * sin)) / (t * t)
        });
    }

    #[test]
    fn every_slope_is_the_derivative_by_the_angle() {
        assert_accurate(sinc_slope, |t, sin, cos| (t * cos - sin) / (t * t * t));
        assert_accurate(sinc_second_slope, |t, sin, cos| {
            (3 * sin - 3 * t * cos - t * t * sin) / (t * t * t * t * t)
        });
        assert_accurate(cosc_slope, |t, sin, cos| (t * sin - 2 * (1 - cos)) / (t * t * t * t));
        assert_accurate(sinc_remainder_slope, |t, sin, cos| {
            (3 * sin - 2 * t - t * cos) / (t * t * t * t * t)
        });
        assert_accurate(cotangent_remainder_slope, |t, sin, cos| {
            let cot = (1 + cos) / sin;
            ((1 + &cot * &cot) / 4 + cot / (2 * t) - 2 / (t * t)) / (t * t)
        });
    }

    #[test]
    fn nan_stays_nan() {
        let functions = [
            sinc,
            cosc,
            sinc_remainder,
            cotangent_remainder,
            sinc_slope,
            sinc_second_slope,
            cosc_slope,
            sinc_remainder_slope,
            cotangent_remainder_slope,
        ];
        assert!(functions.iter().all(|function| function(f64::NAN).is_nan()));
    }
}
