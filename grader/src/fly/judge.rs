//! Holds an answer against the truth, which nobody else has.

use nalgebra::Matrix6;
use vislam::odometry::Estimator;

use super::answer::{Answer, NoAnswer};
use super::flights::Graded;
use super::measured::{BLOCKS, Flown, Measured, has_one_world};
use super::reference::{Line, followed};
use super::series::{Series, TIMES};
use super::symptoms::{Bands, REREADINGS, SMOOTHED, Symptom, is_smoothed, symptom};
use crate::grade::{CheckGrade, Verdict};

/// Errors may be so many times those of the book's filter.
pub const NEAR: f64 = 2.0;
/// Flights with a gap begin anew in motion; their errors may be so many times those of the filter on flights
/// with nothing wrong.
pub const NEAR_AFTER_GAP: f64 = 6.0;
/// The scale may be off by this part.
pub const SCALE: f64 = 0.04;

/// Names of the checks, whether students can try them without the truth, and their weights.
pub const CHECKS: [(&str, bool, f64); 8] = [
    ("the_files_are_whole", false, 10.0),
    ("covariances_are_positive_definite", false, 10.0),
    ("positions_are_near", true, 30.0),
    ("the_scale_is_right", true, 10.0),
    ("tilt_is_as_wrong_as_it_says", true, 10.0),
    ("yaw_is_as_wrong_as_it_says", true, 10.0),
    ("position_is_as_wrong_as_it_says", true, 10.0),
    ("it_is_what_it_declares", true, 10.0),
];

/// Flights with what the book's filter makes of them.
#[derive(Debug, Clone)]
pub struct Course {
    flights: Vec<Graded>,
    /// Of the flights with one world.
    references: Vec<Option<Series>>,
}

impl Course {
    /// Flies the flights and follows them.
    ///
    /// # Errors
    ///
    /// A sentence when one of them cannot be flown or followed.
    pub fn of(flights: Vec<Graded>) -> Result<Self, String> {
        let reference = |flight: &Graded| {
            if !has_one_world(flight) {
                return Ok(None);
            }
            let lines = followed(&flight.flown()?, Estimator::Msckf)?;
            let series = Series::of(flight, &lines);
            series.map(Some).ok_or_else(|| "the book's filter loses a flight".to_owned())
        };
        let references = flights.iter().map(reference).collect::<Result<_, String>>()?;
        Ok(Self { flights, references })
    }

    /// The flights.
    pub fn flights(&self) -> &[Graded] {
        &self.flights
    }

    /// The answer beside truth and filter, its lines read in some way.
    fn flown(&self, answer: &Answer, read: impl Fn(&Line) -> Line) -> Vec<Flown<'_>> {
        let all = self.flights.iter().zip(&self.references).zip(&answer.flights);
        let beside = all.filter_map(|((flight, reference), lines)| {
            let lines: Vec<Line> = lines.iter().map(&read).collect();
            let answer = Series::of(flight, &lines)?;
            Some(Flown { flight, answer, reference: reference.as_ref()? })
        });
        beside.collect()
    }

    /// The largest aligned error of a flight with a gap beside the mean of the filter's in all others.
    fn after_gap(&self, answer: &Answer) -> f64 {
        let filter: Vec<f64> = self.references.iter().flatten().map(|it| it.aligned).collect();
        let mean = filter.iter().sum::<f64>() / filter.len() as f64;
        let flights = self.flights.iter().zip(&answer.flights);
        let off = flights.filter(|(flight, _)| !has_one_world(flight)).map(|(flight, lines)| {
            let since = flight.from();
            let after = lines.iter().filter(|line| flight.seconds(line.nanoseconds) >= since);
            let after: Vec<Line> = after.copied().collect();
            Series::of(flight, &after).map_or(f64::INFINITY, |series| series.aligned / mean)
        });
        off.fold(0.0, f64::max)
    }

    /// Everything that is measured of an answer.
    ///
    /// # Errors
    ///
    /// A sentence when there is nothing to measure.
    pub fn judged(&self, answer: &Answer) -> Result<Judged, String> {
        let measured = Measured::of(&self.flown(answer, |line| *line));
        let bands = Bands::of(measured.runs)?;
        let read =
            REREADINGS.map(|(symptom, read)| (symptom, Measured::of(&self.flown(answer, read))));
        let mut judged = Judged {
            after_gap: self.after_gap(answer),
            not_definite: not_definite(answer),
            smoothed: is_smoothed(answer.kind, &measured),
            bands,
            measured,
            symptom: None,
        };
        // What passes everything has no fault to be named.
        if judged.wrong().iter().any(Option::is_some) {
            judged.symptom = symptom(&judged.measured, &judged.bands, &read);
        }
        Ok(judged)
    }
}

/// What was measured of an answer.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Numbers.
    pub measured: Measured,
    /// Where its normalized errors must lie.
    pub bands: Bands,
    /// The largest error after a gap, as a multiple of the filter's.
    pub after_gap: f64,
    /// The first covariance that is none: flight and pose.
    pub not_definite: Option<(usize, usize)>,
    /// Whether it declares to be causal and is not.
    pub smoothed: bool,
    /// The fault that the numbers suggest.
    pub symptom: Option<Symptom>,
}

impl Judged {
    /// What is wrong by each of [`CHECKS`].
    fn wrong(&self) -> [Option<String>; 8] {
        let nees = |block: usize| {
            let inside = self.bands.contain(&self.measured.nees, block, 1.0);
            (!inside).then(|| self.outside(block))
        };
        let definite = self.not_definite.map(|(flight, pose)| {
            format!(
                "the covariance of pose {} of flight {} is not positive definite, so that it is none",
                pose + 1,
                flight + 1
            )
        });
        let scale = (self.measured.scale.is_nan() || self.measured.scale > SCALE)
            .then(|| "paths are longer or shorter than they were flown".to_owned());
        let declares = self.smoothed.then(|| SMOOTHED.sentence.to_owned());
        [None, definite, self.far(), scale, nees(0), nees(1), nees(2), declares]
    }

    fn far(&self) -> Option<String> {
        let kinds = ["with nothing wrong", "with wrong pixels", "with a late clock"];
        let errors = self.measured.errors.iter().zip(kinds);
        let far =
            errors.filter(|(error, _)| error.is_nan() || **error > NEAR).map(|(_, kind)| kind);
        let gap = (self.after_gap > NEAR_AFTER_GAP).then_some("with a gap");
        let far: Vec<&str> = far.chain(gap).collect();
        (!far.is_empty()).then(|| {
            format!(
                "positions are farther off than those of a plain filter by more than is allowed, in \
                 flights {}",
                far.join(", ")
            )
        })
    }

    /// That the mean errors of a block leave their bands.
    fn outside(&self, block: usize) -> String {
        let last = (0..TIMES.len()).map(|time| (time, self.measured.nees[time][block]));
        let (mut above, mut below) = (false, false);
        for (time, mean) in last {
            let band = self.bands.at(time, block);
            above |= mean > band.high;
            below |= mean < band.low;
        }
        let name = BLOCKS[block];
        match (above, below) {
            (true, _) => {
                format!(
                    "the {name} is more wrong than its covariance says, in the mean over the flights \
                     without a gap"
                )
            }
            (_, true) => {
                format!(
                    "the {name} is less wrong than its covariance says, in the mean over the flights \
                     without a gap"
                )
            }
            _ => format!("the {name} has no error that a covariance could be held against"),
        }
    }

    /// The numbers, for whoever may see them.
    pub fn table(&self) -> String {
        let Measured { nees, errors, scale, roughness, .. } = &self.measured;
        let mut text = format!(
            "NEES, {} flights   tilt                yaw                 position\n",
            self.measured.runs
        );
        for (time, row) in nees.iter().enumerate() {
            text += &format!("after {:>4.1} s  ", TIMES[time]);
            for (block, mean) in row.iter().enumerate() {
                let band = self.bands.at(time, block);
                text += &format!("  {mean:>8.2} [{:.2}, {:.2}]", band.low, band.high);
            }
            text.push('\n');
        }
        let [plain, outliers, late] = errors;
        text + &format!(
            "errors as multiples of a plain filter's: {plain:.2}, with wrong pixels {outliers:.2}, with \
             a late clock {late:.2}, after a gap {:.2}\nscale off by {scale:.4}; roughness {roughness:.2} of \
             the filter's\n",
            self.after_gap
        )
    }

    /// The outcomes of the checks.
    pub fn checks(&self) -> Vec<CheckGrade> {
        let mut symptom = self.symptom;
        let of = |((name, hidden, weight), wrong): ((&str, bool, f64), Option<String>)| {
            // A fault is told where it first shows.
            let named = wrong.as_ref().and_then(|_| match name {
                "it_is_what_it_declares" => Some(SMOOTHED),
                _ => symptom.take(),
            });
            let sentence = match (wrong, named) {
                (Some(wrong), Some(named)) if named != SMOOTHED => {
                    format!("{wrong}; {}", named.sentence)
                }
                (wrong, _) => wrong.unwrap_or_default(),
            };
            let failed = !sentence.is_empty();
            CheckGrade {
                name: name.to_owned(),
                hidden,
                weight,
                verdict: if failed { Verdict::Failed } else { Verdict::Passed },
                sentence,
                quiet: None,
                numbers: if failed && hidden { self.table() } else { String::new() },
                misconception: named.map(|named| named.name.to_owned()),
                picture: None,
            }
        };
        CHECKS.into_iter().zip(self.wrong()).map(of).collect()
    }
}

/// The checks of files that nobody can judge.
pub fn unread(why: &NoAnswer) -> Vec<CheckGrade> {
    let sentences = match why {
        NoAnswer::Missing => Vec::new(),
        NoAnswer::Refused(sentences) => sentences.clone(),
    };
    let check = |(name, hidden, weight): (&str, bool, f64)| {
        let (sentence, numbers) = match hidden {
            false if name == CHECKS[0].0 => {
                (sentences.first().cloned().unwrap_or_default(), sentences.join("\n"))
            }
            _ => ("nothing can be judged before the files are whole".to_owned(), String::new()),
        };
        let numbers = if sentences.len() > 1 { numbers } else { String::new() };
        CheckGrade {
            name: name.to_owned(),
            hidden,
            weight,
            verdict: Verdict::Failed,
            sentence,
            quiet: None,
            numbers,
            misconception: None,
            picture: None,
        }
    };
    CHECKS.into_iter().map(check).collect()
}

/// The first covariance that is not positive definite: flight and pose.
fn not_definite(answer: &Answer) -> Option<(usize, usize)> {
    let is_none = |matrix: &Matrix6<f64>| {
        let sizes = matrix.diagonal().map(|variance| variance.sqrt());
        // Correlations are judged, so that units do not decide.
        let correlations =
            matrix.zip_map(&(sizes * sizes.transpose()), |number, size| number / size);
        correlations.cholesky().is_none()
    };
    answer.flights.iter().enumerate().find_map(|(flight, lines)| {
        let pose = lines.iter().position(|line| is_none(&line.covariance))?;
        Some((flight, pose))
    })
}
