//! What is asked about an answer, and on which instances.

mod descent;
mod motions;
mod stands;

use std::sync::LazyLock;

use nalgebra::{DMatrix, Matrix3};

use super::*;
use crate::Exercise;
use crate::answer::{Spoiled, Transport};
use crate::check::{Check, Failure, Misconception, compare, show_list};
use crate::draw::Draw;
use descent::{Free, Minimum};

pub use motions::{Kind, Motion, Range};
pub use stands::{Stand, Turn, Twice, leveled, resting, second};

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "align_gravity",
    title: "Gravity alignment at rest and in motion",
    chapter: "initialization",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Fit", "Known", "Solution", "View"],
    forbidden: &["factors", "initialization", "least_squares", "observability", "simulation"],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    FORCE_POINTS_DOWN, "force_points_down":
        "The body stands the wrong way round: its downward direction is taken to the world's third \
         axis. An accelerometer on a table reads a force. Does the table push it up or down?";
    TRANSPOSED, "transposed":
        "This is the rotation the other way, from the world to the body. Where does it take the mean \
         force, and where should that go?";
    HEADING_IN_BODY, "heading_in_body":
        "The heading turns the body about its own third axis, before it is leveled. About which axis, \
         and in whose coordinates, does a heading turn?";
    LEAST_ROTATION, "least_rotation":
        "The smallest rotation that levels the body came first, and the heading was added to it. \
         Where does that smallest rotation take the first axis, seen from above: is it always the \
         world's first axis?";
    UPRIGHT_ALWAYS, "upright_always":
        "Bodies that stand upside down come out upright. A roll angle from a quotient of two \
         coordinates is the same when both change their signs: what tells the two apart?";
    TILT_IN_WORLD, "tilt_in_world":
        "The tilt stands in the coordinates of the world here. On which side of the rotation does \
         Exp(φ) stand, and in which frame is φ therefore?";
    INDEPENDENT, "independent":
        "Tilt and bias are treated as if they were independent. A stand that is off by some bias is tilted \
         by exactly as much as that bias needs: how could you know one of the two and not the other?";
    NOT_OVER_GRAVITY, "not_over_gravity":
        "A variance of accelerations stands where one of angles should. What angle does a small bias turn gravity \
         by?";
    LENGTH_IGNORED, "length_ignored":
        "The bias along the vertical is as unknown as before the stand. The mean force should have been \
         as long as gravity: by what was it not?";
    ACROSS_UNTOUCHED, "across_untouched":
        "The length of the force was allowed to say something about the bias along the vertical and \
         nothing about the rest. The vertical is no axis of the sensor: with three different \
         deviations, are the bias along it and the bias across it independent?";
    TURNED_THE_OTHER_WAY, "turned_the_other_way":
        "A bias tilts the body the other way here. Draw a bias to the right of the upward force: \
         which way does the sum lean, and about which axis must the body turn to follow?";
    SIGMAS_NOT_SQUARED, "sigmas_not_squared":
        "Standard deviations stand where variances should. What adds up when independent errors do?";
    TURN_INVERTED, "turn_inverted":
        "The turn between the stands was taken the other way. Which coordinates does `first_from_second` \
         take, those of the first stand or those of the second?";
    BIAS_TURNED_ALONG, "bias_turned_along":
        "The bias was turned as gravity is. When a box is turned on a table, which of the two turns \
         with the box?";
    HALF_FORGOTTEN, "half_forgotten":
        "Gravity is half as large in effect as it should be, or twice. How far does a stone fall in a second, \
         if gravity is g: g metres?";
    GRAVITY_UPWARDS, "gravity_upwards":
        "Gravity points up. On which side of the equation does it stand, and with which sign?";
    LEVER_FORGOTTEN, "lever_forgotten":
        "The camera is taken to sit in the body's origin. Where does a camera beside it go while the body \
         turns on the spot?";
    FIRST_VIEW_FORGOTTEN, "first_view_forgotten":
        "Something is counted from the origin of its coordinates or of its clock, and should be from the \
         first view. What do the equations say at the first view itself?";
    GRAVITY_FREE, "gravity_free":
        "Gravity has come out with a length of its own. Which length is it known to have?";
    RESCALED, "rescaled":
        "Gravity was found with any length, and then given the right one. The other unknowns were found \
         beside the wrong gravity: do they still fit best?";
    WEIGHTS_FORGOTTEN, "weights_forgotten":
        "All views count the same. Which of them are known better, and how much more should one that is \
         known twice as well count?";
    NOISE_IN_METRES, "noise_in_metres":
        "The noise of the centres has the same size in metres whatever the scale. What does \
         a scale of nearly zero do to all residuals, and to their noise?";
    SECOND_LOST, "second_lost":
        "One scale came back, and another one fits as well as it does. How often does a line \
         through a sphere meet it?";
    GATE_IGNORED, "gate_ignored":
        "A scale is among these that fits visibly worse than the best one. What is `gate` for?";
    NEGATIVE_KEPT, "negative_kept":
        "A scale is negative. What would the pictures look like?";
    NEVER_REFUSED, "never_refused":
        "There is a scale for every motion here, for a body at rest too. By how much could it be another one, \
         as a part of itself?";
    ABSOLUTE_SIGMA, "absolute_sigma":
        "The standard deviation of the scale is in metres for a unit of the motion. Would the verdict be the \
         same if the pictures' motion had been drawn ten times as large?";
}

impl Spoiled for Rotation3<f64> {
    fn spoiled(number: f64) -> Self {
        Self::from_matrix_unchecked(Matrix3::repeat(number))
    }
}

impl Spoiled for Fit {
    fn spoiled(number: f64) -> Self {
        let vector = Vector3::repeat(number);
        Self { velocity: vector, gravity: vector, squares: number }
    }
}

impl Spoiled for Solution {
    fn spoiled(number: f64) -> Self {
        let vector = Vector3::repeat(number);
        Self { scale: number, sigma: number, velocity: vector, gravity: vector }
    }
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("the_mean_force_points_up_and_the_heading_stays", |answer| {
            let mut draw = Draw::new(31);
            (0..20).try_for_each(|_| leveled(answer, &Stand::drawn(&mut draw)))
        }),
        Check::new("what_rest_leaves_unknown_is_tilt_and_bias_together", |answer| {
            let mut draw = Draw::new(32);
            (0..20).try_for_each(|_| resting(answer, &Stand::drawn(&mut draw)))
        }),
        Check::new("a_second_stand_tells_bias_from_tilt_as_far_as_it_was_turned", |answer| {
            let mut draw = Draw::new(33);
            let turns = [Turn::None, Turn::Around, Turn::Tipped, Turn::Any];
            (0..20).try_for_each(|k| second(answer, &Twice::drawn(&mut draw, turns[k % 4])))
        }),
        Check::new("velocity_and_gravity_fit_at_a_given_scale", |answer| {
            HELD.iter().try_for_each(|(motion, scale)| fits(answer, motion, *scale))
        }),
        Check::new("scales_are_where_all_fits_best_with_gravity_on_its_sphere", |answer| {
            FREE.iter().try_for_each(|motion| found(answer, motion))
        }),
        Check::new("a_motion_that_hides_its_scale_is_refused", |answer| verdicts(answer, &JUDGED)),
    ]
}

/// The motions that students have, drawn once: at a scale that is held, with the scale free, and of all kinds.
static HELD: LazyLock<Vec<(Motion, f64)>> = LazyLock::new(|| {
    let mut draw = Draw::new(34);
    let held = |_| {
        let motion = Motion::drawn(&mut draw, Kind::Lively, motions::PUBLIC);
        let scale = draw.uniform(0.7..1.4) * motion.scale;
        (motion, scale)
    };
    (0..10).map(held).collect()
});
static FREE: LazyLock<Vec<Motion>> = LazyLock::new(|| {
    let mut draw = Draw::new(35);
    DETERMINED.map(|kind| Motion::drawn(&mut draw, kind, motions::PUBLIC)).into()
});
static JUDGED: LazyLock<Vec<Motion>> =
    LazyLock::new(|| motions_of_all_kinds(&mut Draw::new(36), motions::PUBLIC));

/// Kinds of motion that say their scale.
pub const DETERMINED: [Kind; 8] = [
    Kind::Lively,
    Kind::Parabola,
    Kind::Sinking,
    Kind::OffParabola,
    Kind::NearParabola,
    Kind::Swung,
    Kind::Barely,
    Kind::Lively,
];

/// One motion of each kind and some again, in any order.
pub fn motions_of_all_kinds(draw: &mut Draw, range: Range) -> Vec<Motion> {
    let mut kinds: Vec<Kind> = Kind::ALL.iter().map(|(kind, _)| *kind).collect();
    let mut again = kinds.clone();
    draw.shuffle(&mut again);
    again.truncate(draw.index(1..7));
    kinds.extend(again);
    draw.shuffle(&mut kinds);
    kinds.into_iter().map(|kind| Motion::drawn(draw, kind, range)).collect()
}

/// Numbers of a fit in units of those expected.
fn row(fit: &Fit, unit: &Fit) -> DMatrix<f64> {
    let (velocity, gravity) = (unit.velocity.norm(), unit.gravity.norm());
    let mut row: Vec<f64> = (fit.velocity / velocity).iter().copied().collect();
    row.extend((fit.gravity / gravity).iter());
    row.push(fit.squares / unit.squares);
    DMatrix::from_row_slice(1, row.len(), &row)
}

impl Motion {
    /// The best fit at a scale, by descent.
    fn fit(&self, scale: f64) -> Fit {
        let minima = self.equations(Free::AtScale(scale)).minima();
        let best = minima.iter().min_by(|a, b| a.squares.total_cmp(&b.squares));
        best.map_or(Fit::spoiled(f64::NAN), |best| Fit {
            velocity: best.velocity,
            gravity: best.gravity,
            squares: best.squares,
        })
    }

    /// The motion with other views.
    fn with(&self, change: impl Fn(usize, &mut View)) -> Self {
        let mut other = self.clone();
        other.views.iter_mut().enumerate().for_each(|(k, view)| change(k, view));
        other
    }

    /// Fits of those who count from another beginning.
    fn fits_from_elsewhere(&self, scale: f64) -> Vec<Fit> {
        let swing = self.views[0].motion_from_body * self.lever;
        let moved = |centre: bool, time: bool, swung: bool| {
            let other = self.with(|k, view| {
                if k == 0 && centre {
                    view.centre = Vector3::zeros();
                }
                if k == 0 && time {
                    view.seconds = 0.0;
                }
                if k > 0 && swung {
                    view.force_twice += swing;
                }
            });
            other.fit(scale)
        };
        let (yes, no) = (true, false);
        let which = [(yes, no, no), (no, yes, no), (no, no, yes), (yes, no, yes), (yes, yes, yes)];
        which.map(|(centre, time, swung)| moved(centre, time, swung)).into()
    }

    /// Fits of known mistakes.
    fn wrong_fits(&self, scale: f64) -> Vec<(&'static Misconception, Fit)> {
        let right = self.fit(scale);
        let heavy = Self { gravity: 2.0 * self.gravity, ..self.clone() }.fit(scale);
        let without_lever = Self { lever: Vector3::zeros(), ..self.clone() }.fit(scale);
        let equal = self.with(|_, view| view.sigma = 1.0).fit(scale);
        let roots = self.with(|_, view| view.sigma = view.sigma.sqrt()).fit(scale);
        let equations = self.equations(Free::AtScale(scale));
        let squares = |fit: &Fit| equations.squares_of(scale, &fit.velocity, &fit.gravity);
        let square = scale * scale;
        let mut wrong = vec![
            (&HALF_FORGOTTEN, Fit { gravity: 0.5 * heavy.gravity, ..heavy }),
            (&GRAVITY_UPWARDS, Fit { gravity: -right.gravity, ..right }),
            (&LEVER_FORGOTTEN, without_lever),
            (&WEIGHTS_FORGOTTEN, equal),
            (&WEIGHTS_FORGOTTEN, Fit { squares: square * equal.squares, ..equal }),
            (&WEIGHTS_FORGOTTEN, Fit { squares: squares(&equal), ..equal }),
            (&SIGMAS_NOT_SQUARED, roots),
            (&SIGMAS_NOT_SQUARED, Fit { squares: scale * roots.squares, ..roots }),
            (&SIGMAS_NOT_SQUARED, Fit { squares: squares(&roots), ..roots }),
            (&NOISE_IN_METRES, Fit { squares: square * right.squares, ..right }),
        ];
        if let Some(free) = equations.without_length() {
            let Minimum { velocity, gravity, squares: least, .. } = free;
            let fit = Fit { velocity, gravity, squares: least };
            let rescaled = Fit { gravity: gravity * (self.gravity / gravity.norm()), ..fit };
            wrong.push((&GRAVITY_FREE, fit));
            wrong.push((&RESCALED, rescaled));
            wrong.push((&RESCALED, Fit { squares: squares(&rescaled), ..rescaled }));
        }
        let elsewhere = self.fits_from_elsewhere(scale).into_iter();
        wrong.extend(elsewhere.map(|fit| (&FIRST_VIEW_FORGOTTEN, fit)));
        wrong
    }
}

const FIT: [&str; 7] = ["v x", "v y", "v z", "g x", "g y", "g z", "squares"];

/// Velocity, gravity and the sum of squares at a scale, against a descent on all five unknowns.
///
/// # Errors
///
/// A failure, which names the fit that came back where that is known.
pub fn fits(answer: &dyn Transport, motion: &Motion, scale: f64) -> Result<(), Failure> {
    let Motion { views, lever, gravity, .. } = motion;
    let obtained = Answer(answer).at_scale(views, lever, gravity, &scale)?;
    let fit = motion.fit(scale);
    let (obtained, expected) = (row(&obtained, &fit), row(&fit, &fit));
    let what = "the fit at a scale, in units of what it should be,";
    let mut comparison = compare(what, &obtained, &expected).within(1e-7).labelled(&[], &FIT);
    // Mistakes take a while, and are looked for only where there is one.
    if (obtained - expected).amax() > 1e-7 {
        for (misconception, wrong) in motion.wrong_fits(scale) {
            comparison = comparison.or(misconception, &row(&wrong, &fit));
        }
    }
    comparison.judge()
}

/// Whether two lists of scales are the same.
fn same(obtained: &[f64], expected: &[f64]) -> bool {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= PRECISION * b.abs();
    obtained.len() == expected.len() && obtained.iter().zip(expected).all(near)
}

/// How well scales must agree, as a part of them: as well as someone finds them who compares sums of squares.
const PRECISION: f64 = 1e-6;

fn scales_of(minima: &[Minimum]) -> Vec<f64> {
    minima.iter().map(|minimum| minimum.scale).collect()
}

impl Motion {
    /// Scales of known mistakes.
    fn wrong_scales(&self) -> Vec<(&'static Misconception, Vec<f64>)> {
        let expected = self.expected();
        let mut in_metres = self.equations(Free::InMetres).minima();
        in_metres.retain(|minimum| minimum.scale > 0.0);
        let best = in_metres.iter().min_by(|a, b| a.squares.total_cmp(&b.squares)).copied();
        let mut wrong = vec![
            (&NOISE_IN_METRES, scales_of(&self.fitting(&in_metres))),
            (&NOISE_IN_METRES, best.iter().map(|minimum| minimum.scale).collect()),
            (&GATE_IGNORED, scales_of(&self.candidates())),
            (&NEGATIVE_KEPT, scales_of(&self.fitting(&self.minima))),
        ];
        if let [first, second] = expected[..] {
            wrong.push((&SECOND_LOST, vec![first.scale]));
            wrong.push((&SECOND_LOST, vec![second.scale]));
        }
        let free = self.equations(Free::All).without_length();
        wrong.extend(free.map(|minimum| (&RESCALED, vec![minimum.scale])));
        wrong
    }
}

/// The scales that came back with all that belongs to them, against a descent on all six unknowns from many
/// directions of down.
///
/// # Errors
///
/// A failure, which names the scales that came back where that is known.
pub fn found(answer: &dyn Transport, motion: &Motion) -> Result<(), Failure> {
    let Motion { views, lever, gravity, most, gate, .. } = motion;
    let obtained = Answer(answer).scales(views, lever, gravity, most, gate)?;
    let expected = motion.expected();
    let (scales, right): (Vec<f64>, _) =
        (obtained.iter().map(|solution| solution.scale).collect(), scales_of(&expected));
    let earlier =
        |failure: Failure| failure.unless("at_scale", || fits(answer, motion, motion.scale));
    if !same(&scales, &right) {
        show_list("the scales", &scales, &right);
        let known = motion.wrong_scales().into_iter().find(|(_, wrong)| same(&scales, wrong));
        let failure = known.map_or_else(
            || Failure::new("The scales are not what they should be."),
            |(misconception, _)| Failure::known(misconception),
        );
        let lists = format!("expected: {right:?}\nobtained: {scales:?}\n{}", motion.kind.name());
        return Err(earlier(failure.with_numbers(lists)));
    }
    for (solution, minimum) in obtained.iter().zip(&expected) {
        let numbers = |solution: &Solution| {
            let v = solution.velocity / minimum.velocity.norm();
            let g = solution.gravity / *gravity;
            let sigma = solution.sigma / minimum.sigma;
            DMatrix::from_row_slice(1, 7, &[v.x, v.y, v.z, g.x, g.y, g.z, sigma])
        };
        let right = Solution {
            scale: minimum.scale,
            sigma: minimum.sigma,
            velocity: minimum.velocity,
            gravity: minimum.gravity,
        };
        let absolute = Solution { sigma: right.sigma * right.scale, ..right };
        compare(
            "the solution, in units of what it should be,",
            &numbers(solution),
            &numbers(&right),
        )
        .within(3.0 * PRECISION)
        .labelled(&[], &["v x", "v y", "v z", "g x", "g y", "g z", "sigma"])
        .or(&ABSOLUTE_SIGMA, &numbers(&absolute))
        .judge()
        .map_err(earlier)?;
    }
    Ok(())
}

/// What known ways of judging make of some motions: how many scales each has.
fn known_verdicts(motions: &[Motion]) -> Vec<(&'static Misconception, Vec<usize>)> {
    let count = |judge: &dyn Fn(&Motion, &[Minimum]) -> usize| -> Vec<usize> {
        motions.iter().map(|motion| judge(motion, &motion.candidates())).collect()
    };
    let absolute = |motion: &Motion, candidates: &[Minimum]| {
        let fitting = motion.fitting(candidates);
        let known = fitting.iter().all(|minimum| minimum.sigma * minimum.scale <= motion.most);
        if known { fitting.len() } else { 0 }
    };
    let negative = |motion: &Motion, _: &[Minimum]| {
        motion.unless_unknown(motion.fitting(&motion.minima)).len()
    };
    vec![
        (&NEVER_REFUSED, count(&|motion, candidates| motion.fitting(candidates).len())),
        (&ABSOLUTE_SIGMA, count(&absolute)),
        (&SECOND_LOST, count(&|motion, _| motion.expected().len().min(1))),
        (&GATE_IGNORED, count(&|motion, all| motion.unless_unknown(all.to_vec()).len())),
        (&NEGATIVE_KEPT, count(&negative)),
    ]
}

/// How many scales come back for all motions together, so that a guess is found out.
///
/// # Errors
///
/// A failure that lists the motions, and names the way of judging where that is known.
pub fn verdicts(answer: &dyn Transport, motions: &[Motion]) -> Result<(), Failure> {
    let ask = |motion: &Motion| {
        let Motion { views, lever, gravity, most, gate, .. } = motion;
        Ok(Answer(answer).scales(views, lever, gravity, most, gate)?.len())
    };
    let obtained: Vec<usize> = motions.iter().map(ask).collect::<Result<_, Failure>>()?;
    let expected: Vec<usize> = motions.iter().map(|motion| motion.expected().len()).collect();
    let numbers = |counts: &[usize]| counts.iter().map(|count| *count as f64).collect::<Vec<_>>();
    show_list("how many scales each motion has", &numbers(&obtained), &numbers(&expected));
    if obtained == expected {
        return Ok(());
    }
    // Where nothing fixes the scale, how many candidates there are is an accident.
    let agree = |counts: &[usize], others: &[usize]| {
        let pairs = motions.iter().zip(counts.iter().zip(others));
        { pairs }.all(|(motion, (count, other))| motion.kind.hides_all() || count == other)
    };
    let known = known_verdicts(motions).into_iter().find(|(_, counts)| {
        let is_empty = obtained.iter().all(|count| *count == 0);
        agree(counts, &obtained) && !agree(counts, &expected) && !is_empty
    });
    let failure = known.map_or_else(
        || {
            Failure::new(
                "Some motions have more scales than they should, or fewer. Take one of them and look at \
                 the sum of squares over a wide range of scales.",
            )
        },
        |(misconception, _)| Failure::known(misconception),
    );
    let mut table = format!("{:42}{:>10}{:>10}\n", "", "expected", "obtained");
    for (motion, (expected, obtained)) in motions.iter().zip(expected.into_iter().zip(obtained)) {
        let mark = if expected == obtained { ' ' } else { '*' };
        table += &format!("{:42}{expected:>10}{obtained:>10}{mark}\n", motion.kind.name());
    }
    Err(failure.with_numbers(table))
}
