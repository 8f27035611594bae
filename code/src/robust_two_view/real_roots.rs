//! The real roots of a polynomial by the theorem of Sturm.

use super::Candidates;

// ANCHOR: real_roots
/// The real roots of the polynomial with these coefficients, the constant first, each of them once,
/// in no order.
///
/// A Sturm chain begins with the polynomial and its derivative, and goes on with the negative
/// remainder of each pair. Between two places it loses as many changes of sign as there are roots,
/// so intervals are halved until each holds one root, and that one is found by steps of Halley that
/// may not leave the interval. No bound of the roots is needed, since places are
/// counted by t in z = t / (1 − |t|), which takes all of the line to the interval from −1 to 1.
///
/// Numbers below 1e-14 of a polynomial's largest coefficient count as rounding: roots that lie nearer
/// to each other than about 1e-7 by t can be found as one, a root at which the sign does not change is
/// found to 1e-7 by t, and those beyond 1e14 are not found. There are none of a polynomial that has an
/// infinite coefficient or NaN, or is zero.
// ANCHOR: isolated
pub fn real_roots<const N: usize>(coefficients: &[f64; N]) -> Candidates<f64, N> {
    let mut roots = Candidates::none(0.0);
    let Some(chain) = Chain::of(coefficients) else { return roots };
    let [low, high] = [-1.0, 1.0].map(|t| chain.at(t));
    let mut waiting = Candidates::<_, 64>::none((low, high)).with((low, high));
    while let Some((low, high)) = waiting.pop() {
        match low.changes.saturating_sub(high.changes) {
            0 => {}
            1 if low.negative != high.negative => roots.push(chain.refine(low, high)),
            1 if high.t - low.t < TOUCHING => roots.push(line(0.5 * (low.t + high.t))),
            _ if high.t - low.t < CLOSEST => roots.push(line(0.5 * (low.t + high.t))),
            _ => {
                let middle = chain.between(low, high);
                waiting.push((middle, high));
                waiting.push((low, middle));
            }
        }
    }
    roots
}
// ANCHOR_END: isolated
// ANCHOR_END: real_roots

/// Roots that lie nearer to each other are one.
const CLOSEST: f64 = 1e-12;
/// Nearer to a root at which the sign does not change the chain is rounding.
const TOUCHING: f64 = 1e-7;
/// Where the middle of an interval is a multiple root, it is divided in this share.
const ASIDE: f64 = 0.45;
/// A remainder that is smaller is rounding.
const NOTHING: f64 = 1e-14;
/// A step of Halley triples the number of digits.
const A_THIRD_OF_THE_DIGITS: f64 = 1e-6;
/// More steps than Halley or bisection need.
const MOST_STEPS: usize = 80;

/// The place on the line.
fn line(t: f64) -> f64 {
    t / (1.0 - t.abs())
}

/// What the chain says of a place.
#[derive(Debug, Clone, Copy)]
struct Place {
    t: f64,
    /// Whether the polynomial is negative.
    negative: bool,
    /// How often the sign changes along the chain.
    changes: usize,
    /// Whether all of the chain is zero, as at a multiple root.
    multiple: bool,
}

/// The chain, power by power, so that all of it is evaluated at once.
struct Chain<const N: usize> {
    /// By power, the coefficient of each polynomial.
    powers: [[f64; N]; N],
    /// The degree of each, and how many there are.
    degrees: [usize; N],
    length: usize,
}

impl<const N: usize> Chain<N> {
    // ANCHOR: sturm_chain
    /// The polynomial, its derivative, and the remainders.
    fn of(coefficients: &[f64; N]) -> Option<Self> {
        let mut polynomials = [[0.0; N]; N];
        let mut degrees = [0; N];
        (polynomials[0], degrees[0]) = scaled(*coefficients)?;
        let mut derivative = [0.0; N];
        for power in 1..N {
            derivative[power - 1] = power as f64 * polynomials[0][power];
        }
        let mut length = 1;
        let mut next = scaled(derivative);
        while let Some((polynomial, degree)) = next.filter(|_| length < N) {
            (polynomials[length], degrees[length]) = (polynomial, degree);
            length += 1;
            let [last, this] = [length - 2, length - 1];
            let pair = (&polynomials[last], degrees[last], &polynomials[this], degrees[this]);
            next = negative_remainder(pair);
        }
        let powers = std::array::from_fn(|power| polynomials.map(|polynomial| polynomial[power]));
        Some(Self { powers, degrees, length })
    }
    // ANCHOR_END: sturm_chain

    /// The signs at a place, of which −1 and 1 are the two infinities.
    fn at(&self, t: f64) -> Place {
        let values = if t.abs() < 1.0 { self.values(line(t)) } else { self.signs_at_infinity(t) };
        let is_negative = |value: f64| value < 0.0;
        let signs = &values[..self.length];
        let changes =
            signs.windows(2).filter(|pair| is_negative(pair[0]) != is_negative(pair[1])).count();
        let multiple = signs.iter().all(|value| *value == 0.0);
        Place { t, negative: is_negative(values[0]), changes, multiple }
    }

    /// A place between two, in the middle unless the chain vanishes there and counts nothing.
    fn between(&self, low: Place, high: Place) -> Place {
        let middle = self.at(0.5 * (low.t + high.t));
        if middle.multiple { self.at(low.t + ASIDE * (high.t - low.t)) } else { middle }
    }

    /// The values of all polynomials, by the scheme of Horner.
    fn values(&self, z: f64) -> [f64; N] {
        let mut values = [0.0; N];
        // The degree falls by one or more from each polynomial to the next.
        for power in (0..N).rev() {
            let coefficients = &self.powers[power][..N - power];
            for (value, coefficient) in values.iter_mut().zip(coefficients) {
                *value = *value * z + coefficient;
            }
        }
        values
    }

    fn signs_at_infinity(&self, t: f64) -> [f64; N] {
        std::array::from_fn(|k| {
            let degree = self.degrees[k];
            if degree % 2 == 1 { t * self.powers[degree][k] } else { self.powers[degree][k] }
        })
    }

    // ANCHOR: refine_root
    /// The root between two places of which one alone is negative.
    fn refine(&self, low: Place, high: Place) -> f64 {
        let (mut from, mut to) = (low.t, high.t);
        let mut t = 0.5 * (from + to);
        for _ in 0..MOST_STEPS {
            let z = line(t);
            let [value, slope, bend] = self.derivatives(z);
            *(if (value < 0.0) == low.negative { &mut from } else { &mut to }) = t;
            let next = z - value * slope / (slope * slope - value * bend);
            // The step after this one would be the cube of it.
            if (next - z).abs() <= A_THIRD_OF_THE_DIGITS * z.abs() {
                return next;
            }
            let step = next / (1.0 + next.abs());
            t = if step > from && step < to { step } else { 0.5 * (from + to) };
        }
        line(t)
    }
    // ANCHOR_END: refine_root

    /// The value, the first derivative and half the second.
    fn derivatives(&self, z: f64) -> [f64; 3] {
        self.powers.iter().rev().fold([0.0; 3], |[value, slope, bend], coefficients| {
            [value * z + coefficients[0], slope * z + value, bend * z + slope]
        })
    }
}

/// A polynomial times a positive number, so that its largest coefficient is one, and its degree;
/// `None` when it is zero or has a coefficient that is not finite.
fn scaled<const N: usize>(mut polynomial: [f64; N]) -> Option<([f64; N], usize)> {
    let largest = polynomial.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    // A sum is finite only when all that is added is.
    let is_finite = polynomial.iter().sum::<f64>().is_finite();
    if largest == 0.0 || !is_finite {
        return None;
    }
    let scale = largest.recip();
    polynomial.iter_mut().for_each(|coefficient| *coefficient *= scale);
    let degree = polynomial.iter().rposition(|coefficient| coefficient.abs() > NOTHING)?;
    polynomial[degree + 1..].fill(0.0);
    Some((polynomial, degree))
}

/// What is left of a polynomial after division by one of a lower degree, with the other sign; `None`
/// when nothing is.
fn negative_remainder<const N: usize>(
    (dividend, degree, divisor, by): (&[f64; N], usize, &[f64; N], usize),
) -> Option<([f64; N], usize)> {
    let mut rest = *dividend;
    let inverse = divisor[by].recip();
    for power in (by..=degree).rev() {
        let quotient = rest[power] * inverse;
        for lower in 0..by {
            rest[power - by + lower] -= quotient * divisor[lower];
        }
        rest[power] = 0.0;
    }
    let is_rest = rest.iter().any(|coefficient| coefficient.abs() > NOTHING);
    is_rest.then(|| scaled(rest.map(|coefficient| -coefficient))).flatten()
}
