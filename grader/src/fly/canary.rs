//! Answers that are known to be right and wrong, judged before anybody's.

use vislam::odometry::Estimator;

use super::answer::{Answer, Kind};
use super::flights::Graded;
use super::judge::Course;
use super::key::Key;
use super::reference::followed;
use crate::grade::Verdict;

/// The folder of nobody.
const FOLDER: &str = "canary";
/// By how much a covariance is wrong that must not pass.
const TOO_SURE: f64 = 0.1;

/// Judges what the book's filter makes of flights of its own, and the same with too small a covariance.
///
/// # Errors
///
/// A sentence when the first does not pass every check, or the second does.
pub fn sing(key: &Key) -> Result<(), String> {
    let flights = Graded::all(key, FOLDER);
    let of = |flight: &Graded| followed(&flight.flown()?, Estimator::Msckf);
    let lines = flights.iter().map(of).collect::<Result<_, String>>()?;
    let right = Answer { kind: Kind::Causal, flights: lines };
    let mut wrong = right.clone();
    wrong.flights.iter_mut().flatten().for_each(|line| line.covariance *= TOO_SURE);
    let course = Course::of(flights)?;
    let failed = |answer: &Answer| {
        let checks = course.judged(answer)?.checks();
        Ok::<_, String>(checks.into_iter().find(|check| check.verdict != Verdict::Passed))
    };
    if let Some(check) = failed(&right)? {
        return Err(format!(
            "the book's filter does not pass `{}`: {}",
            check.name, check.sentence
        ));
    }
    if failed(&wrong)?.is_none() {
        return Err(format!("the book's filter passes with {TOO_SURE} of its covariance"));
    }
    Ok(())
}
