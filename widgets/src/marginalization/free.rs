//! What a window leaves free whose estimate moves between slides.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::least_squares::{Problem, Spectrum, Values};
use vislam::marginalization::{Layout, WindowSigmas};

use super::window::{Plan, SEED};

/// How far each coordinate moves before each slide: metres or radians, in standard deviations.
const MOVED: f64 = 0.05;

/// Which linearization points of variables that a prior names are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freeze {
    Never,
    Anew,
    First,
}

impl Freeze {
    pub const ALL: [Self; 3] = [Self::Never, Self::Anew, Self::First];

    fn act(self, problem: &mut Problem, named: &[usize]) -> Option<()> {
        match self {
            Self::Never => Some(()),
            Self::Anew => problem.freeze_here(named).ok(),
            Self::First => {
                problem.freeze_priors();
                Some(())
            }
        }
    }
}

/// How many directions are free after the slides in the window without what is known of its first keyframe; none if that
/// cannot be said.
pub fn free_directions(plan: &Plan, freeze: Freeze) -> Option<usize> {
    let sigmas = WindowSigmas { first_keyframe: f64::INFINITY, ..WindowSigmas::default() };
    let layout = plan.layout();
    let mut problem = layout.problem(&sigmas, SEED).ok()?;
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let leaving = plan.leaving();
    for gone in &leaving {
        let values = moved(&problem, &mut random);
        let named = problem.marginalize(&values, gone).ok()?;
        freeze.act(&mut problem, &named)?;
    }
    let values = moved(&problem, &mut random);
    let gone = leaving.concat();
    left_free(problem, &values, landmarks(&layout).filter(|name| !gone.contains(name)))
}

/// Whether the window is determined if its first keyframe is known.
pub fn is_determined(layout: &Layout, problem: Problem) -> bool {
    let values = problem.values().clone();
    left_free(problem, &values, landmarks(layout)) == Some(0)
}

fn landmarks(layout: &Layout) -> impl Iterator<Item = usize> + '_ {
    (0..layout.seen_by.len()).map(|landmark| layout.landmark(landmark))
}

/// How many directions a problem leaves free. That does not change when landmarks leave at the same linearization point,
/// and it is found sooner then.
fn left_free(
    mut problem: Problem,
    values: &Values,
    landmarks: impl Iterator<Item = usize>,
) -> Option<usize> {
    problem.marginalize(values, &landmarks.collect::<Vec<_>>()).ok()?;
    let (jacobian, _) = problem.jacobian(values).ok()?;
    Some(Spectrum::of(&jacobian).ok()?.zeros)
}

fn moved(problem: &Problem, random: &mut ChaCha8Rng) -> Values {
    let mut draw = || MOVED * Distribution::<f64>::sample(&StandardNormal, random);
    let step: Vec<f64> = (0..problem.values().dimension()).map(|_| draw()).collect();
    problem.values().retract(&step)
}
