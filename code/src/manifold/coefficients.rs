//! The functions of the angle that multiply the matrices of [`so3`](super::so3) and
//! [`se3`](super::se3).
//!
//! All of them are even and finite at zero, so they take the *square* of the angle, which
//! costs no root. The *slope* of a function f is f'(t)/t, again even and finite: it is what
//! the chain rule asks for, since the angle of φ changes by φ·δ/t when φ changes by δ.
//!
//! Written as in a textbook, they subtract nearly equal numbers at small angles. Their
//! power series do not, and fourteen terms reach beyond π.

/// What multiplies φ^ and φ^ φ^ in a rotation by the angle t and in its Jacobian.
pub struct Turn {
    /// sin t / t, with an error relative to one.
    pub sinc: f64,
    /// (1 − cos t) / t².
    pub cosc: f64,
    /// (1 − sinc t) / t², that is (t − sin t) / t³.
    pub sinc_remainder: f64,
}

// ANCHOR: turn
/// The coefficients of a turn, from the square of its angle.
#[inline(always)]
pub fn turn(square: f64) -> Turn {
    if square < SHORT_END { turn_by_series::<SHORT>(square) } else { long_turn(square) }
}

/// Kept apart, so that the short series is compiled into what calls it.
#[inline(never)]
fn long_turn(square: f64) -> Turn {
    if square < SERIES_END {
        return turn_by_series::<14>(square);
    }
    let angle = square.sqrt();
    let (sine, cosine) = angle.sin_cos();
    let sinc = sine / angle;
    Turn { sinc, cosc: (1.0 - cosine) / square, sinc_remainder: (1.0 - sinc) / square }
}

/// By the first `N` terms of each series.
#[inline(always)]
fn turn_by_series<const N: usize>(square: f64) -> Turn {
    let sinc_remainder = polynomial(&SINC_REMAINDER[..N], square);
    let sinc = 1.0 - square * sinc_remainder;
    Turn { sinc, cosc: polynomial(&COSC[..N], square), sinc_remainder }
}
// ANCHOR_END: turn

/// The slopes of the two coefficients in the Jacobian of a turn.
pub struct Slopes {
    /// (sinc t − 2 cosc t) / t².
    pub cosc: f64,
    /// (cosc t − 3 sinc_remainder t) / t².
    pub sinc_remainder: f64,
}

/// The slopes, from the square of the angle.
pub fn slopes(square: f64) -> Slopes {
    if square < SERIES_END {
        Slopes {
            cosc: polynomial(&COSC_SLOPE, square),
            sinc_remainder: polynomial(&SINC_REMAINDER_SLOPE, square),
        }
    } else {
        let Turn { sinc, cosc, sinc_remainder } = turn(square);
        Slopes {
            cosc: (sinc - 2.0 * cosc) / square,
            sinc_remainder: (cosc - 3.0 * sinc_remainder) / square,
        }
    }
}

/// (1 − (t/2) cot(t/2)) / t², which has a pole at 2π.
pub fn cotangent_remainder(square: f64) -> f64 {
    let half = turn(0.25 * square);
    0.25 * (half.cosc - half.sinc_remainder) / half.sinc
}

/// The slope of [`cotangent_remainder`].
pub fn cotangent_remainder_slope(square: f64) -> f64 {
    let (half, slopes) = (turn(0.25 * square), slopes(0.25 * square));
    let ratio = (half.cosc - half.sinc_remainder) / half.sinc;
    (ratio * ratio + (slopes.cosc - slopes.sinc_remainder) / half.sinc) / 16.0
}

/// The squared angle, a little beyond π², up to which the series are used.
const SERIES_END: f64 = 10.0;

/// The squared angle, that of 7 degrees, up to which [`SHORT`] terms are enough: they leave out
/// less than 1e-17 of the sum.
const SHORT_END: f64 = 0.015;
const SHORT: usize = 5;

/// As many terms as leave out less than 1e-17 of the sum at [`SERIES_END`].
type Series = [f64; 14];

const COSC: Series = series(2);
const SINC_REMAINDER: Series = series(3);
const COSC_SLOPE: Series = slope_series(2);
const SINC_REMAINDER_SLOPE: Series = slope_series(3);

/// 1/n! − x/(n+2)! + x²/(n+4)! − …
const fn series(n: u32) -> Series {
    let mut terms = [0.0; 14];
    let (mut k, mut sign) = (0, 1.0);
    while k < terms.len() {
        terms[k] = sign / factorial(n + 2 * k as u32);
        (k, sign) = (k + 1, -sign);
    }
    terms
}

/// Twice the derivative of [`series`] by x: the slope, if x is the square of the angle.
const fn slope_series(n: u32) -> Series {
    let mut terms = [0.0; 14];
    let (mut k, mut sign) = (0, -1.0);
    while k < terms.len() {
        terms[k] = sign * 2.0 * (k + 1) as f64 / factorial(n + 2 * (k + 1) as u32);
        (k, sign) = (k + 1, -sign);
    }
    terms
}

const fn factorial(n: u32) -> f64 {
    if n == 0 { 1.0 } else { n as f64 * factorial(n - 1) }
}

// ANCHOR: polynomial
/// c₀ + c₁ x + c₂ x² + … Horner's rule is applied to the even and to the odd powers, since
/// a processor evaluates two short chains of operations side by side.
#[inline]
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    let square = x * x;
    let (mut even, mut odd) = (0.0, 0.0);
    for k in (0..coefficients.len()).rev() {
        let sum = if k % 2 == 0 { &mut even } else { &mut odd };
        *sum = *sum * square + coefficients[k];
    }
    even + x * odd
}
// ANCHOR_END: polynomial

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

    /// Compares a function of t² with its textbook formula in t, sin t and cos t, evaluated
    /// with digits to waste, at angles from 1e-300 to π.
    fn assert_accurate(function: fn(f64) -> f64, formula: fn(&Real, &Real, &Real) -> Real) {
        let mut angles: Vec<f64> = (1..=60).map(|k| 10_f64.powi(-5 * k)).collect();
        angles.extend((1..=62).map(|k| 0.05 * f64::from(k)));
        angles.extend([PI - 1e-3, PI - 1e-9, PI]);
        let mut worst = (0.0, 0.0);
        for t in angles {
            let angle = real(t);
            let truth = formula(&angle, &angle.sin(), &angle.cos());
            let error = ((real(function(t * t)) - &truth) / &truth).to_f64().value().abs();
            assert!(error < 1e-14, "relative error {error:.1e} at {t:e}");
            worst = if error > worst.0 { (error, t) } else { worst };
        }
        println!("largest relative error {:.1e}, at {:e}", worst.0, worst.1);
    }

    #[test]
    fn sinc_is_the_sine_by_the_angle() {
        // It passes zero at π, so its error is measured by one.
        assert_accurate(|square| 1.0 + turn(square).sinc, |t, sin, _| 1 + sin / t);
    }

    #[test]
    fn cosc_is_one_minus_the_cosine_by_the_squared_angle() {
        assert_accurate(|square| turn(square).cosc, |t, _, cos| (1 - cos) / (t * t));
    }

    #[test]
    fn sinc_remainder_is_the_angle_minus_the_sine_by_the_cubed_angle() {
        assert_accurate(|square| turn(square).sinc_remainder, |t, sin, _| (t - sin) / (t * t * t));
    }

    #[test]
    fn cotangent_remainder_is_what_half_angle_times_cotangent_lacks_to_one() {
        assert_accurate(cotangent_remainder, |t, sin, cos| {
            (1 - t * (1 + cos) / (2 * sin)) / (t * t)
        });
    }

    #[test]
    fn every_slope_is_the_derivative_by_the_angle() {
        assert_accurate(
            |square| slopes(square).cosc,
            |t, sin, cos| (t * sin - 2 * (1 - cos)) / (t * t * t * t),
        );
        assert_accurate(
            |square| slopes(square).sinc_remainder,
            |t, sin, cos| (3 * sin - 2 * t - t * cos) / (t * t * t * t * t),
        );
        assert_accurate(cotangent_remainder_slope, |t, sin, cos| {
            let cot = (1 + cos) / sin;
            ((1 + &cot * &cot) / 4 + cot / (2 * t) - 2 / (t * t)) / (t * t)
        });
    }

    #[test]
    fn the_series_meet_where_one_ends_and_the_next_begins() {
        let values = |square| {
            let (turn, slopes) = (turn(square), slopes(square));
            [turn.sinc, turn.cosc, turn.sinc_remainder, slopes.cosc, slopes.sinc_remainder]
        };
        for end in [SHORT_END, SERIES_END] {
            let (inside, outside) = (end * (1.0 - f64::EPSILON), end);
            for (below, above) in values(inside).into_iter().zip(values(outside)) {
                assert!((below - above).abs() < 1e-15, "{below} and {above}");
            }
        }
    }

    #[test]
    fn nan_stays_nan() {
        let Turn { sinc, cosc, sinc_remainder } = turn(f64::NAN);
        assert!([sinc, cosc, sinc_remainder].iter().all(|value| value.is_nan()));
        assert!(slopes(f64::NAN).cosc.is_nan() && slopes(f64::NAN).sinc_remainder.is_nan());
        assert!(cotangent_remainder(f64::NAN).is_nan());
        assert!(cotangent_remainder_slope(f64::NAN).is_nan());
    }
}
