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
/// A root at which the sign does not change is one of the last of the chain, the common divisor of all,
/// and is found there.
///
/// A leading coefficient below 1e-14 of the largest counts as rounding: roots that are huge beside one are
/// not found, and move others. Choose a unit in which roots are near one. A remainder below 1e-12 is
/// rounding too: roots nearer to each other than about 1e-6 by t can be found as one.
/// Above degree four more than that can be rounding, and then a root at which the sign does not change is
/// found twice or not at all. Where three roots are one it is found to about 1e-5. There are no roots of a
/// polynomial that has an infinite coefficient or NaN, or is zero.
// ANCHOR: isolated
pub fn real_roots<const N: usize>(coefficients: &[f64; N]) -> Candidates<f64, N> {
    let mut roots = Candidates::none(0.0);
    let Some(chain) = Chain::of(coefficients) else { return roots };
    let [low, high] = [-1.0, 1.0].map(|t| chain.at(t));
    let mut waiting = Candidates::<_, 64>::none((low, high)).with((low, high));
    while let Some((low, high)) = waiting.pop() {
        match low.changes.saturating_sub(high.changes) {
            0 => {}
            1 if low.first != high.first => roots.push(chain.refine(0, low.first, [low.t, high.t])),
            1 if low.last != high.last => {
                roots.push(chain.refine(chain.length - 1, low.last, [low.t, high.t]));
            }
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
/// Where the middle of an interval is nearly a multiple root, it is divided in this share.
const ASIDE: f64 = 0.45;
/// So near to a multiple root the signs of the chain are rounding.
const NEARLY: f64 = 1e-7;
/// A coefficient that is smaller is rounding.
const NOTHING: f64 = 1e-14;
/// So is a remainder.
const NO_REMAINDER: f64 = 1e-12;
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
    first: bool,
    /// How often the sign changes along the chain.
    changes: usize,
    /// Whether the last of the chain is.
    last: bool,
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
        let [first, last] = [0, self.length - 1].map(|k| is_negative(values[k]));
        Place { t, first, last, changes }
    }

    /// A place between two, in the middle unless a multiple root is there.
    fn between(&self, low: Place, high: Place) -> Place {
        let [middle, aside] = [0.5, ASIDE].map(|share| low.t + share * (high.t - low.t));
        self.at(if self.is_multiple(middle) { aside } else { middle })
    }

    /// Whether the last of the chain, which has the multiple roots, vanishes but for rounding.
    fn is_multiple(&self, t: f64) -> bool {
        let (last, z) = (self.length - 1, line(t));
        let degree = self.degrees[last] as i32;
        degree > 0 && self.values(z)[last].abs() <= NEARLY * z.abs().max(1.0).powi(degree)
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
    /// The root of one of the chain between two places at which its signs differ: whether it is
    /// negative at the first is given.
    fn refine(&self, which: usize, begins: bool, [mut from, mut to]: [f64; 2]) -> f64 {
        let mut t = 0.5 * (from + to);
        for _ in 0..MOST_STEPS {
            let z = line(t);
            let [value, slope, bend] = self.derivatives(which, z);
            if value == 0.0 {
                return z;
            }
            *(if (value < 0.0) == begins { &mut from } else { &mut to }) = t;
            let next = z - value * slope / (slope * slope - value * bend);
            let short = A_THIRD_OF_THE_DIGITS * z.abs();
            let beyond = next + short.copysign(next - z);
            let [step, end] = [next, beyond].map(|z| z / (1.0 + z.abs()));
            let is_inside = |t: f64| t > from && t < to;
            let is_short = (next - z).abs() <= short;
            // A step is short near a root, where the next would be the cube of it, and near a place
            // without slope.
            let crosses = || (self.derivatives(which, beyond)[0] < 0.0) != (value < 0.0);
            if is_short && is_inside(end) && crosses() {
                return next;
            }
            t = if !is_short && is_inside(step) { step } else { 0.5 * (from + to) };
        }
        line(t)
    }
    // ANCHOR_END: refine_root

    /// The value, the first derivative and half the second of one of the chain.
    fn derivatives(&self, which: usize, z: f64) -> [f64; 3] {
        self.powers.iter().rev().fold([0.0; 3], |[value, slope, bend], coefficients| {
            [value * z + coefficients[which], slope * z + value, bend * z + slope]
        })
    }
}

/// A polynomial times a positive number, so that its largest coefficient is one, and its degree;
/// `None` when it is zero or has a coefficient that is not finite.
fn scaled<const N: usize>(mut polynomial: [f64; N]) -> Option<([f64; N], usize)> {
    let largest = polynomial.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    let is_finite = polynomial.iter().all(|coefficient| coefficient.is_finite());
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
    let is_rest = rest.iter().any(|coefficient| coefficient.abs() > NO_REMAINDER);
    is_rest.then(|| scaled(rest.map(|coefficient| -coefficient))).flatten()
}
