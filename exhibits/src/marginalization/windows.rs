//! Windows that forget, in several ways.

use std::sync::OnceLock;

use nalgebra::{DMatrix, Isometry3, Matrix6, Vector6};
use vislam::factors::RelativePose;
use vislam::least_squares::{Kernel, Key, Problem};
use vislam::manifold::se3;
use vislam::marginalization::{
    Couplings, Information, Layout, OverConfidence, SquareRoot, WindowSigmas, divergence,
    keep_marginals, marginalize, sparsify, zero_link,
};

use crate::random::Random;

/// The window of a layout as measured, in square-root form.
pub fn window(layout: &Layout, sigmas: &WindowSigmas, seed: u64) -> SquareRoot<f64> {
    let problem = layout.problem(sigmas, seed).expect("it can be measured");
    SquareRoot::of_problem(&problem, problem.values()).expect("it can be linearized")
}

/// The window of the chapter.
pub fn usual(seed: u64) -> SquareRoot<f64> {
    window(&Layout::eight_keyframes(), &WindowSigmas::default(), seed)
}

/// What the first slide leaves of it.
pub fn slid(seed: u64) -> Information<f64> {
    let gone = Layout::eight_keyframes().slide(0);
    marginalize(&usual(seed).information(), &gone).expect("it is determined")
}

/// What it costs to take a keyframe out by forgetting its measurements, and by holding it at its mean: nats, and the
/// smallest and largest true over reported variance.
pub struct Forgotten {
    pub nats: [f64; 2],
    pub ratios: [[f64; 2]; 2],
}

pub const SEEDS: u64 = 10;
/// The keyframe that is taken out.
pub const GONE: usize = 3;

pub fn forgotten(seed: u64) -> Forgotten {
    let window = usual(seed);
    let kept = marginalize(&window.information(), &[GONE]).expect("determined");
    let dropped = window.drop_blocks(&[GONE]).expect("it is there").information();
    let held = window.information().hold_blocks(&[GONE]).expect("it has a mean");
    let others = [&dropped, &held];
    let ratios = others.map(|other| {
        let ratios = OverConfidence::of(&kept, other).expect("the truth is determined");
        [ratios.smallest(), ratios.largest()]
    });
    Forgotten { nats: others.map(|other| divergence(&kept, other).expect("determined")), ratios }
}

/// The ways of dropping a link, by their names.
pub const WAYS: [&str; 3] = ["zeroed", "marginals kept", "rule of the SEIF"];

/// What dropping a link, in one of the ways, does to one end of it.
pub struct Dropped {
    pub link: (usize, usize),
    /// True standard deviation of the end's position, in millimetres.
    pub sigma: f64,
    /// Reported over true standard deviation of it, by way; nothing when what is left is no Gaussian.
    pub reported: [Option<f64>; 3],
}

/// Windows whose links are dropped, one at a time.
pub const WINDOWS: u64 = 4;

/// The links of a window after its first slide: both ends of those between keyframes, the landmark of the others.
pub fn dropped_links() -> &'static [Dropped] {
    static ALL: OnceLock<Vec<Dropped>> = OnceLock::new();
    ALL.get_or_init(|| of_window(&slid(0)))
}

fn of_window(truth: &Information<f64>) -> Vec<Dropped> {
    let size = |of: &Information<f64>, name: usize| {
        let own = of.blocks().columns_of(name).ok()?.start;
        let covariance: DMatrix<f64> = of.covariance().ok()?;
        Some((0..3).map(|axis| covariance[(own + axis, own + axis)]).sum::<f64>().sqrt())
    };
    let mut all = Vec::new();
    for (first, second) in Couplings::of(truth).pairs() {
        // Names ascend, and landmarks come after the keyframes.
        let ends = match second < Layout::eight_keyframes().keyframes {
            true => vec![(first, second), (second, first)],
            false => vec![(second, first)],
        };
        let (zeroed, kept) =
            (zero_link(truth, first, second), keep_marginals(truth, first, second));
        for (end, other) in ends {
            let filters = sparsify(truth, end, &[other]);
            let sigma = size(truth, end).unwrap_or(f64::NAN);
            let ways = [zeroed.as_ref(), kept.as_ref(), filters.as_ref()];
            let reported = ways.map(|way| Some(size(way.ok()?, end)? / sigma));
            all.push(Dropped { link: (end, other), sigma: 1e3 * sigma, reported });
        }
    }
    all
}

/// What becomes of single variances and of windows when a link is zeroed.
#[derive(Default)]
pub struct Zeroed {
    pub links: usize,
    /// How many links leave no Gaussian.
    pub none: usize,
    pub shrank: usize,
    pub grew: usize,
    /// The most and the least that the robot's true variance is of the reported one with the SEIF's rule.
    pub filters: [f64; 2],
}

pub fn zeroed() -> Zeroed {
    let mut all = Zeroed { filters: [f64::INFINITY, 0.0], ..Zeroed::default() };
    for truth in (0..WINDOWS).map(slid) {
        let before = truth.covariance().expect("determined").diagonal();
        for (first, second) in Couplings::of(&truth).pairs() {
            all.links += 1;
            let filters = sparsify(&truth, first, &[second]).expect("always a Gaussian");
            let robot = OverConfidence::of_block(&truth, &filters, first).expect("determined");
            let [least, most] = all.filters;
            all.filters = [least.min(robot.smallest()), most.max(robot.largest())];
            let Ok(without) = zero_link(&truth, first, second) else {
                all.none += 1;
                continue;
            };
            let after = without.covariance().expect("determined").diagonal();
            let grew = before.iter().zip(after.iter()).filter(|(b, a)| **a > **b * (1.0 + 1e-9));
            let grew = grew.count();
            all.grew += grew;
            all.shrank += before.len() - grew;
        }
    }
    all
}

/// What stands for a window in which a link was zeroed, or removed with the marginals kept.
#[derive(Default)]
pub struct Replaced {
    /// Entries of links that are positive, in per cent.
    pub positive: f64,
    /// How many links come into being for one that is removed, when marginals are kept, on average.
    pub new: f64,
    /// The largest true over reported variance of any quantity, with marginals kept.
    pub ratio: f64,
    /// The divergence of the window from each, where it is a Gaussian.
    pub nats: [Vec<f64>; 2],
}

pub fn replaced() -> Replaced {
    let mut all = Replaced::default();
    let (mut links, mut entries, mut positive) = (0_usize, 0_usize, 0_usize);
    for truth in (0..WINDOWS).map(slid) {
        let couplings = Couplings::of(&truth).pairs();
        for &(first, second) in &couplings {
            let columns = |name| truth.blocks().columns_of(name).expect("a block");
            let link = truth.matrix().view_range(columns(first), columns(second));
            entries += link.len();
            positive += link.iter().filter(|entry| **entry > 0.0).count();
            let kept = keep_marginals(&truth, first, second).expect("always a Gaussian");
            links += 1;
            all.new += (Couplings::of(&kept).pairs().len() + 1 - couplings.len()) as f64;
            let ratios = OverConfidence::of(&truth, &kept).expect("determined");
            all.ratio = all.ratio.max(ratios.largest());
            let ways = [zero_link(&truth, first, second).ok(), Some(kept)];
            for (nats, way) in all.nats.iter_mut().zip(ways) {
                nats.extend(way.and_then(|way| divergence(&truth, &way).ok()));
            }
        }
    }
    all.new /= links as f64;
    all.positive = 100.0 * positive as f64 / entries as f64;
    all
}

/// How linearization points are kept over two slides.
pub type Freeze = fn(&mut Problem, &[usize]);

/// How many directions are free after two slides of a graph of poses in which nothing is known but where they stand
/// to one another; the estimate moves before each slide and after the last.
pub fn free_after_two_slides(freeze: Freeze) -> f64 {
    let mut random = Random::new(71);
    let mut problem = Problem::new();
    let mut keys: Vec<Key<Isometry3<f64>>> = Vec::new();
    for _ in 0..8 {
        let (shift, turn) = (random.direction(2.0), random.rotation(1.0));
        keys.push(problem.add_variable(Isometry3::from_parts(shift.into(), turn.into())));
    }
    for (at, first) in keys.iter().enumerate() {
        for second in keys.iter().skip(at + 1).take(3) {
            let truth = problem.values()[*second] * problem.values()[*first].inverse();
            let noise = Vector6::from_fn(|_, _| random.normal(0.01));
            let measured = se3::retract(&truth, &noise);
            let sqrt_information = Matrix6::identity() / 0.01;
            let factor =
                RelativePose { first: *first, second: *second, measured, sqrt_information };
            problem.add_factor(factor, Kernel::Squared).expect("both are there");
        }
    }
    let mut moved = |problem: &Problem| {
        let step: Vec<f64> =
            (0..problem.values().dimension()).map(|_| random.normal(0.05)).collect();
        problem.values().retract(&step)
    };
    for key in &keys[..2] {
        let values = moved(&problem);
        let named = problem.marginalize(&values, &[key.index()]).expect("it can go");
        freeze(&mut problem, &named);
    }
    let values = moved(&problem);
    problem.null_space(&values).map_or(f64::NAN, |free| free.nullity() as f64)
}
