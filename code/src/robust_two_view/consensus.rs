//! An estimate from data of which many are wrong.

use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thiserror::Error;

use super::chance::{chance_of_agreement, false_alarms};
use crate::filtering::chi_square_quantile;
use crate::least_squares::Options;

// ANCHOR: correspondences
/// Data that each say that something here is something there, and what can be estimated from them.
pub trait Correspondences {
    /// What is estimated.
    type Estimate: Clone;

    /// How many data a minimal solver needs.
    const SAMPLE: usize;

    /// The degrees of freedom of the squared error of a datum that is right.
    const DEGREES: usize;

    /// How many numbers an estimate has.
    const PARAMETERS: usize;

    /// How many data there are.
    fn count(&self) -> usize;

    /// Gives all estimates that fit the data of a sample: none, when it is degenerate
    /// or nothing fits it.
    fn through(&self, sample: &[usize], give: &mut dyn FnMut(Self::Estimate));

    /// A function of the squared error, in variances, of saying that the here of one datum is the
    /// there of another; a datum itself says so with both the same. Beyond `gate` any number that
    /// is larger will do.
    fn squared_errors(&self, estimate: &Self::Estimate, gate: f64) -> impl Fn(usize, usize) -> f64;

    /// The estimate with the least sum of squared errors of some data, from one near it: to the
    /// last digit, or as far as a few steps lead.
    fn refined(
        &self,
        start: &Self::Estimate,
        data: &[usize],
        effort: Effort,
    ) -> Option<Self::Estimate>;

    /// Its covariance, when these data are right.
    fn covariance(&self, estimate: &Self::Estimate, data: &[usize]) -> Option<DMatrix<f64>>;

    /// Their leverages {eq:leverage}: how much of each datum's prediction is that datum's own doing.
    /// None where a datum that is wrong can hardly have much.
    fn leverages(&self, _estimate: &Self::Estimate, _data: &[usize]) -> Option<Vec<f64>> {
        None
    }
}
// ANCHOR_END: correspondences

/// How far an estimate is refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// As far as a few steps lead.
    FewSteps,
    /// To the last digit.
    Converge,
}

impl Effort {
    /// What it means to a solver.
    pub fn options(self) -> Options {
        match self {
            Self::FewSteps => {
                Options { max_iterations: 5, decrease_tolerance: 1e-3, ..Options::default() }
            }
            Self::Converge => Options::default(),
        }
    }
}

// ANCHOR: consensus_options
/// How to look for an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConsensusOptions {
    /// The probability with which at least one sample shall hold right data alone.
    pub confidence: f64,
    /// The probability with which a right datum shall be taken for one: it gives the gate, a quantile
    /// of the chi-square distribution.
    pub inlier_probability: f64,
    /// How many estimates, on average, may be found in data that are all wrong.
    pub false_alarms: f64,
    /// The least number of draws, where few data are wrong.
    pub least_draws: usize,
    /// How many times as many samples are drawn as [`draws_needed`] says, which takes every sample of
    /// right data to lead to the right estimate: noise does not grant it.
    pub patience: f64,
    /// When to give up.
    pub most_draws: usize,
    /// Whether estimates are refined during the search, and at its end also from the inliers of other
    /// gates and without those of much leverage. Without it only the last one is refined, from its own
    /// inliers.
    pub local_optimization: bool,
    /// The same seed gives the same result.
    pub seed: u64,
}

impl Default for ConsensusOptions {
    fn default() -> Self {
        Self {
            confidence: 0.9999,
            inlier_probability: 0.99,
            false_alarms: 0.001,
            least_draws: 300,
            patience: 3.0,
            most_draws: 100_000,
            local_optimization: true,
            seed: 0,
        }
    }
}
// ANCHOR_END: consensus_options

// ANCHOR: consensus_result
/// An estimate, and who agrees with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Consensus<E> {
    /// What was estimated.
    pub estimate: E,
    /// The data whose squared errors lie within the gate, ascending.
    pub inliers: Vec<usize>,
    /// The sum of squared errors, each of them counted as at most the gate.
    pub score: f64,
    /// The squared error, in variances, up to which a datum is an inlier.
    pub gate: f64,
    /// How many samples were drawn.
    pub draws: usize,
    /// How many wrong data out of as many would lie within the gate, as far as data that are paired
    /// at random tell.
    pub by_chance: f64,
    /// The covariance of the estimate, when the inliers that made it are right: those with little
    /// leverage {eq:leverage}, where local optimization has left the others out. Wrong ones among them, which the estimate has made to fit, are not in it.
    pub covariance: Option<DMatrix<f64>>,
}
// ANCHOR_END: consensus_result

/// The inliers change in hardly any round after the third.
const MOST_ROUNDS: usize = 20;

// ANCHOR: consensus
/// The estimate with which the most data agree: RANSAC [@fischler1981] with the truncated score of
/// @torr2000 and the local optimization of @chum2003.
///
/// An estimate through a minimal sample is worth the sum of the squared errors of all data, each of
/// them counted as at most the gate. Samples are drawn until, for the share of inliers that the best
/// estimate has, one without a wrong datum has been among them with the wanted confidence, and some
/// times longer: [`ConsensusOptions::patience`]. Whatever is better than all before it is refined from
/// its inliers until they stay the same. It is refused when as many would agree by chance. In the end
/// inliers with much leverage [@hoaglin1978] are left out of the fit, since they draw it to themselves.
///
/// The result does not depend on units, on the number of processors or on the time of day. It
/// depends on the seed and on the order of the data.
///
/// # Errors
///
/// [`ConsensusError`] when there are too few data, no sample gives an estimate, none has more
/// behind it than chance, or an option is out of its range.
pub fn consensus<C: Correspondences>(
    data: &C,
    options: &ConsensusOptions,
) -> Result<Consensus<C::Estimate>, ConsensusError> {
    let gate = check::<C>(data.count(), options)?;
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let mut sample = vec![0; C::SAMPLE];
    let (mut best, mut least_raw) = (None::<Scored<C::Estimate>>, f64::INFINITY);
    let (mut draws, mut wanted) = (0, options.most_draws);
    while draws < wanted {
        draws += 1;
        draw(&mut random, data.count(), &mut sample);
        let mut better = None;
        data.through(&sample, &mut |estimate| {
            let score = score(data, &estimate, gate, least_raw);
            if score < least_raw {
                least_raw = score;
                better = Some(Scored { estimate, score });
            }
        });
        let Some(better) = better else { continue };
        let better = match options.local_optimization {
            true => optimized(data, better, gate, ONE_WAY),
            false => better,
        };
        if best.as_ref().is_none_or(|best| better.score < best.score) {
            let inliers = inliers(data, &better.estimate, gate).len();
            wanted = draws_wanted::<C>(inliers, data.count(), options);
            best = Some(better);
        }
    }
    let best = best.ok_or(ConsensusError::NoEstimate { draws })?;
    concluded(data, best, gate, draws, options)
}
// ANCHOR_END: consensus

/// After how many draws to stop, when so many of the data are taken for right.
fn draws_wanted<C: Correspondences>(
    inliers: usize,
    count: usize,
    options: &ConsensusOptions,
) -> usize {
    let needed = draws_needed(inliers, count, C::SAMPLE, options.confidence);
    let wanted = (options.patience * needed as f64) as usize;
    wanted.max(options.least_draws).min(options.most_draws)
}

/// An estimate and its score.
#[derive(Clone)]
struct Scored<E> {
    estimate: E,
    score: f64,
}

// ANCHOR: truncated_score
/// The truncated sum of squared errors, or some number above `bound` when it is above.
fn score<C: Correspondences>(data: &C, estimate: &C::Estimate, gate: f64, bound: f64) -> f64 {
    let squared_error = data.squared_errors(estimate, gate);
    let mut sum = 0.0;
    for datum in 0..data.count() {
        sum += squared_error(datum, datum).min(gate);
        if sum > bound {
            break;
        }
    }
    sum
}
// ANCHOR_END: truncated_score

/// The data within the gate.
fn inliers<C: Correspondences>(data: &C, estimate: &C::Estimate, gate: f64) -> Vec<usize> {
    let squared_error = data.squared_errors(estimate, gate);
    (0..data.count()).filter(|datum| squared_error(*datum, *datum) <= gate).collect()
}

// ANCHOR: local_optimization
// ANCHOR: settled
/// The estimate after rounds of refining it from its inliers, for as long as the score falls.
fn settled<C: Correspondences>(
    data: &C,
    start: Scored<C::Estimate>,
    gate: f64,
    effort: Effort,
) -> Scored<C::Estimate> {
    let mut best = start;
    let mut before = Vec::new();
    for _ in 0..MOST_ROUNDS {
        let now = inliers(data, &best.estimate, gate);
        let is_new = now.len() >= C::SAMPLE && now != before;
        let refined = is_new.then(|| data.refined(&best.estimate, &now, effort)).flatten();
        let Some(estimate) = refined else { break };
        let score = score(data, &estimate, gate, f64::INFINITY);
        let is_lower = score < best.score;
        if !is_lower {
            break;
        }
        (best, before) = (Scored { estimate, score }, now);
    }
    best
}
// ANCHOR_END: settled

/// Local optimization: the estimate is refined from its inliers, and again from those of other gates,
/// wider or narrower by these factors, on the way to its own. With one gate it would stay near the
/// inliers that it began with: wrong ones hold it, and right ones beyond the gate cannot pull.
fn optimized<C: Correspondences>(
    data: &C,
    start: Scored<C::Estimate>,
    gate: f64,
    (effort, ways): (Effort, &[&[f64]]),
) -> Scored<C::Estimate> {
    let mut best = settled(data, start, gate, effort);
    for way in ways {
        let mut estimate = best.estimate.clone();
        for factor in *way {
            let within = inliers(data, &estimate, factor * gate);
            estimate = data.refined(&estimate, &within, effort).unwrap_or(estimate);
        }
        let score = score(data, &estimate, gate, f64::INFINITY);
        let other = settled(data, Scored { estimate, score }, gate, effort);
        if other.score < best.score {
            best = other;
        }
    }
    best
}

/// During the search, and at its end.
const ONE_WAY: (Effort, &[&[f64]]) = (Effort::FewSteps, &[&[4.0, 2.0]]);
const ALL_WAYS: (Effort, &[&[f64]]) =
    (Effort::Converge, &[&[9.0, 4.0, 2.0], &[4.0, 2.0], &[2.0], &[0.3, 0.6], &[0.5]]);
// ANCHOR_END: local_optimization

/// An inlier makes the estimate when its leverage is at most so many times the mean one.
const MOST_LEVERAGE: f64 = 4.0;

/// The estimate by those of its inliers that others confirm, and these. One with much leverage draws
/// the estimate to itself, and agrees with it even if it is wrong.
fn confirmed<C: Correspondences>(
    data: &C,
    start: C::Estimate,
    gate: f64,
) -> (C::Estimate, Vec<usize>) {
    let mut kept = inliers(data, &start, gate);
    let mut estimate = start;
    for _ in 0..MOST_ROUNDS {
        let mut now = inliers(data, &estimate, gate);
        let Some(leverages) = data.leverages(&estimate, &now) else { break };
        let most = MOST_LEVERAGE * leverages.iter().sum::<f64>() / now.len() as f64;
        let mut leverages = leverages.into_iter();
        now.retain(|_| leverages.next().is_some_and(|leverage| leverage <= most));
        let is_new = now.len() > C::SAMPLE && now != kept;
        let refined = is_new.then(|| data.refined(&estimate, &now, Effort::Converge)).flatten();
        let Some(refined) = refined else { break };
        (estimate, kept) = (refined, now);
    }
    (estimate, kept)
}

/// The result, when it is more than chance.
fn concluded<C: Correspondences>(
    data: &C,
    best: Scored<C::Estimate>,
    gate: f64,
    draws: usize,
    options: &ConsensusOptions,
) -> Result<Consensus<C::Estimate>, ConsensusError> {
    let ways = if options.local_optimization { ALL_WAYS } else { (Effort::Converge, &[][..]) };
    let estimate = optimized(data, best, gate, ways).estimate;
    let inliers = inliers(data, &estimate, gate);
    let (agree, count) = (inliers.len(), data.count());
    let chance = chance_of_agreement(count, gate, &data.squared_errors(&estimate, gate));
    let by_chance = chance * count as f64;
    let expected = false_alarms(count, agree, C::SAMPLE, chance);
    let is_evidence = expected <= options.false_alarms;
    if !is_evidence {
        return Err(ConsensusError::Chance { agree, count, by_chance, expected });
    }
    let (estimate, makers) = match options.local_optimization {
        true => confirmed(data, estimate, gate),
        false => (estimate, inliers),
    };
    let covariance = data.covariance(&estimate, &makers);
    let inliers = self::inliers(data, &estimate, gate);
    let score = self::score(data, &estimate, gate, f64::INFINITY);
    Ok(Consensus { estimate, inliers, score, gate, draws, by_chance, covariance })
}

// ANCHOR: draws_needed
/// How many samples have to be drawn so that, with the probability `confidence`, one of them holds
/// right data alone, when `right` of `count` are: the number of @fischler1981, for samples without
/// repetition {eq:draws}. It takes every such sample to give the right estimate, which noise does not grant.
pub fn draws_needed(right: usize, count: usize, sample: usize, confidence: f64) -> usize {
    if right < sample || count < right || confidence.is_nan() || confidence > 1.0 {
        return usize::MAX;
    }
    let is_right = |drawn: usize| (right - drawn) as f64 / (count - drawn) as f64;
    let all_right: f64 = (0..sample).map(is_right).product();
    let draws = (-confidence).ln_1p() / (-all_right).ln_1p();
    draws.max(1.0).ceil() as usize
}
// ANCHOR_END: draws_needed

/// Draws different data.
fn draw(random: &mut ChaCha8Rng, count: usize, sample: &mut [usize]) {
    for drawn in 0..sample.len() {
        sample[drawn] = loop {
            let datum = random.random_range(0..count);
            if !sample[..drawn].contains(&datum) {
                break datum;
            }
        };
    }
}

/// That there is something to look for; the gate.
fn check<C: Correspondences>(
    count: usize,
    options: &ConsensusOptions,
) -> Result<f64, ConsensusError> {
    let needed = C::SAMPLE + 1;
    if count < needed {
        return Err(ConsensusError::TooFew { count, needed });
    }
    let ConsensusOptions { confidence, inlier_probability, false_alarms, .. } = *options;
    let between = [("confidence", confidence), ("inlier_probability", inlier_probability)];
    for (name, value) in between {
        if !(value > 0.0 && value < 1.0) {
            return Err(ConsensusError::Probability { name, value });
        }
    }
    if options.most_draws == 0 {
        return Err(ConsensusError::Probability { name: "most_draws", value: 0.0 });
    }
    if options.patience.is_nan() || options.patience <= 0.0 {
        return Err(ConsensusError::Probability { name: "patience", value: options.patience });
    }
    if false_alarms.is_nan() || false_alarms <= 0.0 {
        return Err(ConsensusError::Probability { name: "false_alarms", value: false_alarms });
    }
    let is_none =
        |_| ConsensusError::Probability { name: "inlier_probability", value: inlier_probability };
    chi_square_quantile(inlier_probability, C::DEGREES).map_err(is_none)
}

/// Why there is no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ConsensusError {
    /// A sample fits whatever it is; one datum more is what can contradict it.
    #[error(
        "there are {count} data; give at least {needed}, of which one can contradict the others"
    )]
    TooFew {
        /// How many there are.
        count: usize,
        /// The least number that says something.
        needed: usize,
    },
    /// An option is out of its range.
    #[error("{name} is {value}; give a number above 0, and below 1 if it is a probability")]
    Probability {
        /// Which option.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// No sample gave an estimate: all were degenerate, or contradict themselves.
    #[error(
        "none of {draws} samples gives an estimate: the data are wrong, collinear, repeated or otherwise \
         degenerate; give others"
    )]
    NoEstimate {
        /// How many were drawn.
        draws: usize,
    },
    /// The estimate has no more behind it than wrong data would give.
    #[error(
        "the best estimate agrees with {agree} of {count} data, and {by_chance:.1} of as many wrong \
         ones would agree by chance; there is no evidence in them: give more right data"
    )]
    Chance {
        /// How many lie within the gate.
        agree: usize,
        /// How many there are.
        count: usize,
        /// How many wrong ones would.
        by_chance: f64,
        /// In how many tries out of one, at most, wrong data would give as much.
        expected: f64,
    },
}
