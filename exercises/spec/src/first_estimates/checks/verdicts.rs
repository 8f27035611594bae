//! Which estimates all derivatives can be taken at, and what is lost where they are not.

use super::*;
use crate::check::show_list;

/// A window some of whose measurements are kept.
#[derive(Debug, Clone)]
pub struct Kept {
    window: Window,
}

/// Known ways to choose an estimate of each variable, and what they choose.
type Choices = Vec<(&'static Misconception, Option<Vec<usize>>)>;

impl Kept {
    /// A window whose kept measurements agree or disagree, and in which known mistakes choose differently.
    pub fn drawn(draw: &mut Draw, range: &Range, agree: bool) -> Self {
        loop {
            let window = Window::drawn(draw, range).estimated(draw, range, [2, 5]);
            let mut kept = Self { window };
            kept.keep(draw);
            if (agree || kept.disagree(draw)) && kept.tells_mistakes_apart() {
                return kept;
            }
        }
    }

    /// Keeps some measurements, with one estimate of each variable, neither the first nor the latest.
    fn keep(&mut self, draw: &mut Draw) {
        let estimates = |variable| self.window.estimates(variable);
        let frozen: Vec<usize> = (0..self.window.variables())
            .map(|variable| draw.index(1..estimates(variable) - 1))
            .collect();
        let points = self.window.points_on(&frozen);
        for (measurement, points) in self.window.measurements.iter_mut().zip(points) {
            measurement.kept = (draw.index(0..5) < 2).then_some(points);
        }
    }

    /// Gives one kept measurement another estimate of a variable that a second one has as well.
    fn disagree(&mut self, draw: &mut Draw) -> bool {
        let poses = self.window.poses.len();
        let entries = self.entries(&|_, _| true);
        let twice = entries.iter().filter(|(variable, _)| {
            entries.iter().filter(|(other, _)| variable == other).count() == 2
        });
        let twice: Vec<usize> = twice.map(|(variable, _)| *variable).collect();
        if twice.is_empty() {
            return false;
        }
        let variable = twice[draw.index(0..twice.len())];
        for measurement in &mut self.window.measurements {
            let side = measurement.variables(poses).iter().position(|own| *own == variable);
            if let (Some(side), Some(points)) = (side, &mut measurement.kept) {
                points[side] -= 1;
                return true;
            }
        }
        false
    }

    /// Variables and numbers of estimates of all kept measurements, as far as somebody looks: at some
    /// measurements, and there at the first variable or the second.
    fn entries(&self, seen: &dyn Fn(&What, usize) -> bool) -> Vec<(usize, usize)> {
        let poses = self.window.poses.len();
        let mut entries = Vec::new();
        for measurement in &self.window.measurements {
            let variables = measurement.variables(poses);
            for (side, points) in measurement.kept.iter().flat_map(|kept| kept.iter().enumerate()) {
                if seen(&measurement.what, side) {
                    entries.push((variables[side], *points));
                }
            }
        }
        entries
    }

    /// The latest estimate of each variable that none of these entries forbids, found by trying them.
    fn latest_allowed(&self, entries: &[(usize, usize)]) -> Option<Vec<usize>> {
        let allows = |variable: usize, number: usize| {
            entries.iter().all(|(own, kept)| *own != variable || *kept == number)
        };
        let latest = |variable| {
            (0..self.window.estimates(variable)).rev().find(|number| allows(variable, *number))
        };
        (0..self.window.variables()).map(latest).collect()
    }

    fn expected(&self) -> Option<Vec<usize>> {
        self.latest_allowed(&self.entries(&|_, _| true))
    }

    fn choices(&self) -> Choices {
        let is_landmark = |what: &What, side: usize| matches!(what, What::Seen { .. }) && side == 1;
        let is_departure = |what: &What, side| matches!(what, What::Moved { .. }) && side == 0;
        let looking =
            |seen: &dyn Fn(&What, usize) -> bool| self.latest_allowed(&self.entries(seen));
        let entries = self.entries(&|_, _| true);
        let backwards: Vec<_> = entries.iter().rev().copied().collect();
        let one_of_each = |entries: &[(usize, usize)]| {
            let mut taken: Vec<(usize, usize)> = Vec::new();
            for entry in entries {
                if taken.iter().all(|(variable, _)| *variable != entry.0) {
                    taken.push(*entry);
                }
            }
            self.latest_allowed(&taken)
        };
        vec![
            (&LATEST_OF_ALL, looking(&|_, _| false)),
            (&FIRST_OF_ALL, Some(vec![0; self.window.variables()])),
            (&LANDMARKS_LATEST, looking(&|what, side| !is_landmark(what, side))),
            (&POSES_LATEST, looking(&is_landmark)),
            (&DEPARTURES_LATEST, looking(&|what, side| !is_departure(what, side))),
            (&NEVER_REFUSED, one_of_each(&entries)),
            (&NEVER_REFUSED, one_of_each(&backwards)),
        ]
    }

    fn tells_mistakes_apart(&self) -> bool {
        let (expected, choices) = (self.expected(), self.choices());
        // Where measurements agree every mistake but one chooses differently from what is right.
        let wrong = expected.is_none()
            || choices
                .iter()
                .all(|(mistake, choice)| *mistake == &NEVER_REFUSED || *choice != expected);
        wrong && apart(&choices, &expected)
    }
}

/// Whether no two mistakes of different names give the same, except what is right.
fn apart<T: PartialEq>(wrong: &[(&'static Misconception, T)], right: &T) -> bool {
    wrong.iter().enumerate().all(|(index, (name, outcome))| {
        outcome == right
            || wrong[index + 1..].iter().all(|(other, same)| name == other || outcome != same)
    })
}

fn numbers(numbers: &[usize]) -> Vec<f64> {
    numbers.iter().map(|number| *number as f64).collect()
}

/// One estimate of each variable, against a search from the latest one back.
///
/// # Errors
///
/// A failure, which names which were chosen instead where that is known.
pub fn chosen(answer: &dyn Transport, kept: &Kept) -> Result<(), Failure> {
    let (obtained, expected) = (Answer(answer).one_trajectory(&kept.window)?, kept.expected());
    // Where there is none, a list without numbers is shown.
    let shown = |choice: &Option<Vec<usize>>| choice.as_deref().map_or(vec![], numbers);
    show_list("the estimates, poses first,", &shown(&obtained), &shown(&expected));
    if obtained == expected {
        return Ok(());
    }
    let known = kept.choices().into_iter().find(|(_, choice)| *choice == obtained);
    let failure = match (known, &expected) {
        (Some((misconception, _)), _) if obtained.is_some() => Failure::known(misconception),
        (_, Some(_)) => Failure::new(
            "These are not the latest estimates at which all derivatives can be taken.",
        ),
        (_, None) => Failure::new(
            "Two kept measurements have been linearized at different estimates of a variable, and an \
             estimate of each variable came back.",
        ),
    };
    Err(failure
        .with_numbers(format!("expected: {expected:?}\nobtained: {obtained:?}"))
        .given(&[("latest", &kept.window.latest()), ("measurements", &kept.measurements())]))
}

impl Kept {
    /// Measurements in short: their variables, and where they have been linearized.
    fn measurements(&self) -> Vec<String> {
        let short = |measurement: &Measurement| {
            let kept =
                measurement.kept.map_or("not kept".to_owned(), |at| format!("kept at {at:?}"));
            match measurement.what {
                What::Seen { pose, landmark, .. } => {
                    format!("pose {pose}, landmark {landmark}: {kept}")
                }
                What::Moved { from, to, .. } => format!("pose {from}, pose {to}: {kept}"),
            }
        };
        self.window.measurements.iter().map(short).collect()
    }
}

/// How the estimates differ at which derivatives were taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// All derivatives belong to the trajectory.
    None,
    /// Headings have moved.
    Headings,
    /// Positions of poses have moved.
    Positions,
    /// Landmarks have moved.
    Landmarks,
    /// Everything was shifted alike.
    Shift,
    /// Everything was turned alike, about the origin.
    Turn,
    /// Everything has moved.
    All,
}

/// All of them.
pub const KINDS: [Kind; 7] = [
    Kind::None,
    Kind::Headings,
    Kind::Positions,
    Kind::Landmarks,
    Kind::Shift,
    Kind::Turn,
    Kind::All,
];

/// A window some of whose derivatives are taken off its trajectory.
#[derive(Debug, Clone)]
pub struct Displaced {
    window: Window,
    points: Vec<[usize; 2]>,
    trajectory: Vec<usize>,
    steps: Steps,
    kind: Kind,
}

/// Information that differences find where there is none: it is less than this.
const NOTHING: f64 = 1e-9;

/// The information that a measurement claims.
fn squared(claim: &[f64; 3]) -> f64 {
    claim.iter().map(|part| part * part).sum()
}

/// Which measurement claims most of each direction.
type Verdict = Vec<Option<usize>>;

impl Displaced {
    /// A window of each kind, for each way to step, in any order.
    pub fn of_all_kinds(draw: &mut Draw, range: &Range) -> Vec<Self> {
        let cases = KINDS.iter().flat_map(|kind| BOTH.map(|steps| (*kind, steps)));
        let mut all: Vec<Self> =
            cases.map(|(kind, steps)| Self::drawn(draw, range, kind, steps)).collect();
        draw.shuffle(&mut all);
        all
    }

    /// A window of a kind in which known mistakes blame others.
    fn drawn(draw: &mut Draw, range: &Range, kind: Kind, steps: Steps) -> Self {
        loop {
            let displaced = Self::any(draw, range, kind, steps);
            if displaced.is_plain() {
                return displaced;
            }
        }
    }

    fn any(draw: &mut Draw, range: &Range, kind: Kind, steps: Steps) -> Self {
        let mut window = Window::drawn(draw, range);
        let shift = error(draw, range.error);
        let turn = draw.uniform(range.turn[0]..range.turn[1]);
        // Estimate 0 is the trajectory's, 1 is where the kind says, and 2 is off in all ways.
        for estimates in &mut window.poses {
            let at = estimates[0];
            let own = error(draw, range.error);
            let own_turn = draw.uniform(range.turn[0]..range.turn[1]);
            let moved = match kind {
                Kind::None => at,
                Kind::Headings => Pose { heading: at.heading + own_turn, ..at },
                Kind::Positions => Pose { position: at.position + own, ..at },
                Kind::Landmarks => at,
                Kind::Shift => Pose { position: at.position + shift, ..at },
                Kind::Turn => with_the_world(&at, 2, turn, &Vector2::zeros()),
                Kind::All => Pose { heading: at.heading - own_turn, position: at.position + own },
            };
            let heading = at.heading + draw.uniform(range.turn[0]..range.turn[1]);
            estimates.push(moved);
            estimates.push(Pose { heading, position: at.position + error(draw, range.error) });
        }
        for estimates in &mut window.landmarks {
            let at = estimates[0];
            estimates.push(match kind {
                Kind::None | Kind::Headings | Kind::Positions => at,
                Kind::Landmarks | Kind::All => at + error(draw, range.error),
                Kind::Shift => at + shift,
                Kind::Turn => Rotation2::new(turn) * at,
            });
            estimates.push(at + error(draw, range.error));
        }
        let count = window.measurements.len();
        let mut points: Vec<[usize; 2]> = (0..count).map(|_| [draw.index(0..2); 2]).collect();
        points[draw.index(0..count)] = [1, 1];
        let trajectory = vec![0; window.variables()];
        let mut displaced = Self { window, points, trajectory, steps, kind };
        displaced.renumber(draw);
        displaced
    }

    /// Puts the estimates of each variable into another order.
    fn renumber(&mut self, draw: &mut Draw) {
        let Self { window, points, trajectory, .. } = self;
        let poses = window.poses.len();
        for (variable, number) in trajectory.iter_mut().enumerate() {
            let mut order = [0, 1, 2];
            draw.shuffle(&mut order);
            match variable.checked_sub(poses) {
                None => window.poses[variable] = order.map(|k| window.poses[variable][k]).to_vec(),
                Some(landmark) => {
                    let all = &mut window.landmarks[landmark];
                    *all = order.map(|k| all[k]).to_vec();
                }
            }
            let place = |number: usize| order.iter().position(|k| *k == number).unwrap_or(number);
            *number = place(*number);
            for (measurement, points) in window.measurements.iter().zip(points.iter_mut()) {
                let side = measurement.variables(poses).iter().position(|own| *own == variable);
                if let Some(side) = side {
                    points[side] = place(points[side]);
                }
            }
        }
    }

    /// What the numbers of each measurement claim along a direction at a trajectory.
    fn claims(&self, motion: usize, trajectory: &[usize]) -> Vec<[f64; 3]> {
        let pairs = self.window.measurements.iter().zip(&self.points);
        pairs
            .map(|(measurement, points)| {
                self.window.claims(measurement, *points, (motion, self.steps), trajectory)
            })
            .collect()
    }

    /// Who claims most by a measure of each measurement's claims, where all of them together are more than `least`.
    fn judged(
        &self,
        trajectory: &[usize],
        measure: &dyn Fn(&[f64; 3]) -> f64,
        least: f64,
    ) -> Verdict {
        let of_motion = |motion| {
            let claims = self.claims(motion, trajectory);
            let measured: Vec<f64> = claims.iter().map(measure).collect();
            let is_lost = measured.iter().sum::<f64>().abs() > least;
            let most = (0..measured.len()).max_by(|a, b| measured[*a].total_cmp(&measured[*b]));
            most.filter(|_| is_lost)
        };
        (0..3).map(of_motion).collect()
    }

    fn expected(&self) -> Verdict {
        self.judged(&self.trajectory, &squared, NOTHING)
    }

    fn wrong(&self) -> Vec<(&'static Misconception, Verdict)> {
        let signed = |claim: &[f64; 3]| claim.iter().sum();
        vec![
            (&DIRECTIONS_FOLLOW, vec![None; 3]),
            (&DIRECTIONS_AT_LATEST, self.judged(&self.window.latest(), &squared, NOTHING)),
            (&SIGNS_CANCEL, self.judged(&self.trajectory, &signed, NOTHING.sqrt())),
        ]
    }

    /// Whether each direction is lost or not beyond doubt, one measurement claims clearly more than the others, and
    /// every mistake has its own verdict.
    fn is_plain(&self) -> bool {
        let clear = |motion: usize| {
            let claims = self.claims(motion, &self.trajectory);
            let mut sizes: Vec<f64> = claims.iter().map(squared).collect();
            sizes.sort_by(|a, b| b.total_cmp(a));
            sizes[0] < 1e-3 * NOTHING || (sizes[0] > 1e3 * NOTHING && sizes[1] < 0.9 * sizes[0])
        };
        (0..3).all(clear) && apart(&self.wrong(), &self.expected())
    }

    /// The same with other standard deviations, all so many times as large.
    fn with_sigmas(&self, times: f64) -> Window {
        let mut window = self.window.clone();
        window.measurements.iter_mut().for_each(|measurement| measurement.sigma *= times);
        window
    }
}

/// Which directions are lost and by which measurement, against numbers that are moved along them; for standard
/// deviations of three sizes, since what is lost does not depend on that.
///
/// # Errors
///
/// A failure, which names how the verdict was found where that is known.
pub fn which_is_lost(answer: &dyn Transport, displaced: &Displaced) -> Result<(), Failure> {
    let Displaced { points, trajectory, steps, kind, .. } = displaced;
    let ask =
        |times: f64| Answer(answer).lost(&displaced.with_sigmas(times), points, trajectory, steps);
    let (obtained, others) = (ask(1.0)?, [ask(1e20)?, ask(1e-20)?]);
    let expected = displaced.expected();
    // Numbers from one, and zero where nothing is lost.
    let shown = |verdict: &Verdict| -> Vec<f64> {
        verdict.iter().map(|number| number.map_or(0.0, |number| number as f64 + 1.0)).collect()
    };
    show_list(
        "who claims each direction, from one, or zero,",
        &shown(&obtained),
        &shown(&expected),
    );
    let lost = |verdict: &Verdict| verdict.iter().map(Option::is_some).collect::<Vec<_>>();
    if obtained == expected && others.iter().all(|other| *other == expected) {
        return Ok(());
    }
    let known = displaced.wrong().into_iter().find(|(_, verdict)| *verdict == obtained);
    let failure = if obtained.len() != 3 {
        Failure::new(format!(
            "{} verdicts came back, and there are three directions.",
            obtained.len()
        ))
    } else if others.iter().any(|other| lost(other) != lost(&obtained)) {
        Failure::known(&ABSOLUTE_THRESHOLD)
    } else if let Some((misconception, _)) = known {
        Failure::known(misconception)
    } else if lost(&obtained) == lost(&expected) {
        Failure::new("The right directions are lost, and another measurement claims most of them.")
    } else {
        Failure::new("Other directions are lost here.")
    };
    let failure = failure.unless("linearized", || {
        let (window, points) = (displaced.window.clone(), points.clone());
        equations(answer, &Equations { window, points, steps: *steps })
    });
    let numbers = format!("expected: {expected:?}\nobtained: {obtained:?}\n{}", kind.says());
    Err(failure.with_numbers(numbers).given(&[
        ("window", &displaced.window),
        ("points", points),
        ("trajectory", trajectory),
        ("steps", steps),
    ]))
}

impl Kind {
    const fn says(self) -> &'static str {
        match self {
            Self::None => "All derivatives belong to the trajectory.",
            Self::Headings => "Some derivatives belong to other headings.",
            Self::Positions => "Some derivatives belong to other positions of the poses.",
            Self::Landmarks => "Some derivatives belong to other landmarks.",
            Self::Shift => "Some derivatives belong to a trajectory that is shifted as a whole.",
            Self::Turn => "Some derivatives belong to a trajectory that is turned as a whole.",
            Self::All => "Some derivatives belong to other estimates of everything.",
        }
    }
}
