//! What is asked about an answer, and on which instances.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use nalgebra::{DMatrix, DVector};

use super::*;
use crate::Exercise;
use crate::answer::Transport;
use crate::check::{Check, Failure, Misconception, compare_number, readable, show, show_list};
use crate::draw::Draw;

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "fill_in",
    title: "Fill-in of marginalization",
    chapter: "marginalization",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Layout"],
    forbidden: &[
        "Couplings",
        "Information",
        "SquareRoot",
        "bal",
        "bundle_adjustment",
        "couplings",
        "keep_marginals",
        "least_squares",
        "marginalize",
        "simulation",
        "sparsify",
        "zero_link",
    ],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    COUNTED_TWICE, "counted_twice":
        "The pairs are right, and some of them stand here more than once. A matrix of information \
         is symmetric, and two landmarks can join the same two keyframes: is that another pair?";
    ODOMETRY_FORGOTTEN, "odometry_forgotten":
        "This is the count without odometry. Which keyframes are neighbours of the departing one \
         without sharing a landmark, and which of the others are coupled already?";
    OLD_AS_NEW, "old_as_new":
        "These are all pairs that the elimination touches. Some of them were coupled before: which \
         ones has odometry linked?";
    CLIQUES_SKIPPED, "cliques_skipped":
        "Only the keyframe's own neighbours are joined here. The landmarks it saw leave with it: \
         whom do they join when they go?";
    SEPARATE_CLIQUES, "separate_cliques":
        "Each landmark joins those that saw it, and that is not all. The keyframe that departs has \
         met all of these landmarks: who is joined through it when it goes as well?";
    ALL_LANDMARKS, "all_landmarks":
        "Landmarks that the departing keyframe never saw have been eliminated here too. Which ones \
         stay in the window?";
    SHARED_AS_OLD, "shared_as_old":
        "Pairs that share a landmark which stays are missing. That landmark is a variable of its \
         own: is the block of the two keyframes zero before the slide or not?";
    EXCHANGED, "exchanged":
        "The divergence is taken the other way round, D(q‖p). Over which of the two is the mean \
         taken, over what was known or over what is left?";
    HALF_FORGOTTEN, "half_forgotten":
        "This is twice the divergence. What stands before the exponent of a normal density, and \
         what does the determinant stand under?";
    DETERMINANTS_ALONE, "determinants_alone":
        "This is the difference of two entropies, half the logarithm of the determinants' ratio. \
         The exponents of the two densities differ as well: is the mean of their difference zero?";
    ONE_BLOCK, "one_block":
        "Only one of the two blocks of the link was set to zero. Is the matrix that is left one of \
         a Gaussian? A Cholesky factorization does not ask: it reads one triangle only.";
    SINGLE_ENTRY, "single_entry":
        "One number was set to zero in each triangle. A keyframe has several rows: where does its \
         block begin, and how large is it?";
    INDEFINITE, "indefinite":
        "There is no Gaussian without this link: the matrix that is left has a negative \
         eigenvalue. Which property is to be tested before a logarithm is taken?";
    SMALLEST_BLOCK, "smallest_block":
        "This link has the smallest numbers. They have units, and one keyframe is known better than \
         another: is the smallest number the one whose loss matters least?";
    NO_LINK, "no_link":
        "These two keyframes have no link. It costs nothing to drop it; what is gained by that?";
}

/// A layout, one keyframe of which departs.
#[derive(Debug, Clone)]
pub struct Slide {
    /// The layout.
    pub layout: Layout,
    /// The keyframe that departs.
    pub departing: usize,
}

impl Slide {
    /// A layout in which landmarks are seen by some keyframes of those near each other.
    pub fn drawn(draw: &mut Draw, keyframes: usize, landmarks: usize, odometry: bool) -> Self {
        loop {
            let seen_by = (0..landmarks).map(|_| {
                let first = draw.index(0..keyframes - 2);
                let near: Vec<usize> = (first..keyframes.min(first + 6)).collect();
                let mut seen: BTreeSet<usize> = BTreeSet::new();
                while seen.len() < near.len().min(3) {
                    seen.insert(near[draw.index(0..near.len())]);
                }
                seen.into_iter().collect()
            });
            let layout = Layout { keyframes, odometry, seen_by: seen_by.collect() };
            let slide = Self { layout, departing: draw.index(0..keyframes) };
            if !slide.truth().is_empty() {
                return slide;
            }
        }
    }

    /// The layout of the chapter: keyframes, and landmarks each seen by four in a row.
    pub fn in_a_row(keyframes: usize, landmarks: usize, odometry: bool) -> Self {
        let first = |landmark: usize| landmark * (keyframes - 3) / landmarks;
        let seen_by =
            (0..landmarks).map(|landmark| (first(landmark)..first(landmark) + 4).collect());
        Self { layout: Layout { keyframes, odometry, seen_by: seen_by.collect() }, departing: 0 }
    }

    /// Who is coupled with whom: one where there is a pair.
    fn table(&self, pairs: &[Pair]) -> DMatrix<f64> {
        let coupled = |a, b| pairs.contains(&(a, b)) || pairs.contains(&(b, a));
        let keyframes = self.layout.keyframes;
        DMatrix::from_fn(keyframes, keyframes, |a, b| f64::from(coupled(a, b)))
    }

    /// Whether the keyframes before and after the departing one share no landmark with it.
    fn has_met_some_by_odometry_alone(&self) -> bool {
        let near = |seen: &usize| seen.abs_diff(self.departing) == 1;
        let seen_by = &self.layout.seen_by;
        !self.seen().iter().any(|landmark| seen_by[*landmark].iter().any(near))
    }

    /// Landmarks that the departing keyframe saw.
    fn seen(&self) -> Vec<usize> {
        let seen_by = self.layout.seen_by.iter().enumerate();
        seen_by
            .filter(|(_, keyframes)| keyframes.contains(&self.departing))
            .map(|(landmark, _)| landmark)
            .collect()
    }

    /// Brute force: a matrix of random information with the pattern of the layout, and what is
    /// left of it when some keyframes and landmarks are eliminated. Gives the pairs of surviving
    /// keyframes whose block has changed, each with whether it was zero.
    fn changed(&self, keyframes: &[usize], landmarks: &[usize]) -> Vec<(Pair, bool)> {
        let Layout { keyframes: count, odometry, ref seen_by } = self.layout;
        let total = count + seen_by.len();
        // One number for each variable, and a little knowledge of each.
        let mut information: DMatrix<f64> = 0.1 * DMatrix::identity(total, total);
        let mut draw = Draw::new(17);
        let mut measured = |a: usize, b: usize| {
            let mut row = DVector::zeros(total);
            (row[a], row[b]) = (draw.uniform(0.5..1.5), -draw.uniform(0.5..1.5));
            information += &row * row.transpose();
        };
        if odometry {
            (1..count).for_each(|next| measured(next - 1, next));
        }
        for (landmark, seen_by) in seen_by.iter().enumerate() {
            seen_by.iter().for_each(|keyframe| measured(*keyframe, count + landmark));
        }
        let gone: Vec<usize> =
            keyframes.iter().copied().chain(landmarks.iter().map(|index| count + index)).collect();
        let stays: Vec<usize> = (0..total).filter(|index| !gone.contains(index)).collect();
        let block = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |r, c| information[(rows[r], columns[c])])
        };
        // The matrix is positive definite, so each of its blocks on the diagonal has an inverse.
        let inverse = block(&gone, &gone).try_inverse().unwrap_or_default();
        let lost = block(&stays, &gone) * inverse * block(&gone, &stays);
        let mut pairs = Vec::new();
        for (row, &a) in stays.iter().enumerate() {
            for (column, &b) in stays.iter().enumerate().skip(row + 1) {
                if b < count && lost[(row, column)].abs() > 1e-12 {
                    pairs.push(((a, b), information[(a, b)] == 0.0));
                }
            }
        }
        pairs
    }

    /// Pairs that were not coupled and are when these are eliminated.
    fn joined(&self, keyframes: &[usize], landmarks: &[usize]) -> Vec<Pair> {
        let changed = self.changed(keyframes, landmarks);
        changed.into_iter().filter(|(_, new)| *new).map(|(pair, _)| pair).collect()
    }

    fn truth(&self) -> Vec<Pair> {
        self.joined(&[self.departing], &self.seen())
    }

    /// What wrong ideas of it give, where no two of them give the same.
    fn wrong(&self) -> Vec<(&'static Misconception, Vec<Pair>)> {
        let other = |layout: Layout| Self { layout, departing: self.departing };
        let without = other(Layout { odometry: false, ..self.layout.clone() });
        let bare = other(Layout { seen_by: Vec::new(), ..self.layout.clone() });
        let old_too = self.changed(&[self.departing], &self.seen());
        let alone = bare.joined(&[self.departing], &[]);
        let mut separate: BTreeSet<Pair> = alone.iter().copied().collect();
        for landmark in self.seen() {
            separate.extend(self.joined(&[], &[landmark]));
        }
        separate.retain(|(a, b)| ![*a, *b].contains(&self.departing));
        let stays = |(a, b): &Pair| {
            let both = |seen: &&Vec<usize>| seen.contains(a) && seen.contains(b);
            self.layout.seen_by.iter().filter(both).any(|seen| !seen.contains(&self.departing))
        };
        let all: Vec<usize> = (0..self.layout.seen_by.len()).collect();
        let candidates: Vec<(&'static Misconception, Vec<Pair>)> = vec![
            (&ODOMETRY_FORGOTTEN, without.truth()),
            (&OLD_AS_NEW, old_too.into_iter().map(|(pair, _)| pair).collect()),
            (&CLIQUES_SKIPPED, alone),
            (&SEPARATE_CLIQUES, separate.into_iter().collect()),
            (&ALL_LANDMARKS, self.joined(&[self.departing], &all)),
            (&SHARED_AS_OLD, self.truth().into_iter().filter(|pair| !stays(pair)).collect()),
        ];
        let truth = self.truth();
        let alike = |pairs: &Vec<Pair>| candidates.iter().filter(|(_, c)| c == pairs).count();
        let telling = |pairs: &Vec<Pair>| !pairs.is_empty() && *pairs != truth && alike(pairs) == 1;
        candidates.iter().filter(|(_, pairs)| telling(pairs)).cloned().collect()
    }
}

/// The pairs that a slide couples, against brute force.
///
/// # Errors
///
/// A failure, which names what was counted instead where that is known.
pub fn couplings(answer: &dyn Transport, slide: &Slide) -> Result<(), Failure> {
    let Slide { layout, departing } = slide;
    let obtained = Answer(answer).new_couplings(layout, departing)?;
    let truth = slide.truth();
    show("the table of couplings", &slide.table(&obtained), &slide.table(&truth));
    if obtained == truth {
        return Ok(());
    }
    let list = |pairs: &[Pair]| {
        let mut text = format!("{:>3} pairs:", pairs.len());
        for (a, b) in pairs.iter().take(30) {
            let _ = write!(text, " {a}-{b}");
        }
        text
    };
    let survives = |index: usize| index < layout.keyframes && index != *departing;
    if let Some((a, b)) = obtained.iter().find(|(a, b)| !survives(*a) || !survives(*b) || a == b) {
        return Err(Failure::new(format!(
            "{a}-{b} is no pair of two surviving keyframes: there are {} keyframes, and {departing} \
             departs.",
            layout.keyframes
        )));
    }
    let sorted: BTreeSet<Pair> = obtained.iter().map(|(a, b)| (*a.min(b), *a.max(b))).collect();
    let once: Vec<Pair> = sorted.into_iter().collect();
    let known = slide.wrong().into_iter().find(|(_, pairs)| *pairs == once);
    let failure = if once == truth && obtained.len() > truth.len() {
        Failure::known(&COUNTED_TWICE)
    } else if once == truth {
        Failure::new("These are the pairs, in another order than the ascending one.")
    } else if let Some((misconception, _)) = known {
        Failure::known(misconception)
    } else {
        Failure::new("These are not the pairs that the slide couples anew.")
    };
    let chain = if layout.odometry { "a chain of odometry" } else { "no odometry" };
    let mut seen = String::new();
    for keyframes in &layout.seen_by {
        let mark = if keyframes.contains(departing) { "leaves" } else { "stays" };
        let _ = writeln!(seen, "{mark:>10}: {keyframes:?}");
    }
    Err(failure.with_numbers(format!(
        "{} keyframes with {chain}; keyframe {departing} departs. Landmarks by who sees them:\n\
         {seen}expected {}\nobtained {}",
        layout.keyframes,
        list(&truth),
        list(&obtained)
    )))
}

/// A window in the form of its information matrix.
#[derive(Debug, Clone)]
pub struct Window {
    /// The matrix.
    pub information: DMatrix<f64>,
    /// How many rows each keyframe has.
    pub size: usize,
}

/// What dropping a link comes to: the eigenvalues of the matrix without the link in units of the
/// matrix with it.
struct Cut(DVector<f64>);

impl Cut {
    /// D(p‖q), if q exists.
    fn lost(&self) -> Option<f64> {
        self.sum(|value| 0.5 * (value - 1.0 - value.ln()))
    }

    fn sum(&self, term: impl Fn(f64) -> f64) -> Option<f64> {
        let exists = self.0.iter().all(|value| *value > 0.0);
        exists.then(|| self.0.iter().map(|value| term(*value)).sum())
    }
}

impl Window {
    /// A window of keyframes that are known more or less well, in a chain, and joined by landmarks
    /// that have left.
    /// Some links cannot be dropped, and the cheapest is not the one of the smallest numbers.
    pub fn drawn(draw: &mut Draw, keyframes: usize, size: usize) -> Self {
        loop {
            let total = keyframes * size;
            let mut information = DMatrix::zeros(total, total);
            let mut measured = |of: &[usize], strength: f64| {
                let rows = DMatrix::from_fn(size, total, |_, column| {
                    if of.contains(&(column / size)) { strength * draw.normal() } else { 0.0 }
                });
                information += rows.transpose() * rows;
            };
            (1..keyframes).for_each(|next| measured(&[next - 1, next], 1.0));
            // What a landmark of three keyframes leaves behind when it goes.
            for first in 0..keyframes - 3 {
                let strength = [2.0, 0.7][first % 2];
                measured(&[first, first + 1, (first + 3) % keyframes], strength);
            }
            let known = DVector::from_fn(total, |_, _| draw.uniform(0.2..4.0));
            information += DMatrix::from_diagonal(&known);
            // Keyframes differ in how well they are known, as if in other units.
            let units: Vec<f64> =
                (0..keyframes).map(|_| 10.0_f64.powf(draw.uniform(-0.6..0.6))).collect();
            let mut window = Self {
                information: DMatrix::from_fn(total, total, |row, column| {
                    information[(row, column)] * units[row / size] * units[column / size]
                }),
                size,
            };
            // A block that begins with a zero is a link all the same, and here it is the answer;
            // others that do are none.
            let cheapest = window.cheapest();
            let mut links = window.links();
            draw.shuffle(&mut links);
            if size > 1 {
                let zeros = links.into_iter().filter(|link| Some(*link) != cheapest).take(2);
                zeros.chain(cheapest).for_each(|link| window.begin_with_zero(link));
            }
            if window.is_telling() && window.cheapest() == cheapest {
                return window;
            }
        }
    }

    fn is_telling(&self) -> bool {
        let costs: Vec<Option<f64>> =
            self.links().into_iter().map(|link| self.cut(link).lost()).collect();
        let smallest = self.smallest();
        let differ = [self.cheapest(), self.cheapest_backward()]
            .iter()
            .all(|link| *link != smallest && *link != self.smallest_droppable());
        let size = |cost: &Option<f64>| cost.is_none_or(|cost| (1e-5..20.0).contains(&cost));
        let droppable = costs.iter().flatten().count();
        let mut sorted: Vec<f64> = costs.iter().flatten().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let clear = sorted.windows(2).all(|pair| pair[1] > 1.001 * pair[0]);
        differ && clear && costs.iter().all(size) && droppable >= 3 && droppable < costs.len()
    }

    fn keyframes(&self) -> usize {
        self.information.nrows() / self.size
    }

    /// Pairs, with or without a link.
    fn pairs(&self) -> Vec<Pair> {
        let count = self.keyframes();
        (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).collect()
    }

    fn norm(&self, (a, b): Pair) -> f64 {
        let size = self.size;
        self.information.view((a * size, b * size), (size, size)).norm()
    }

    fn begins_with_zero(&self, (a, b): Pair) -> bool {
        self.information[(a * self.size, b * self.size)] == 0.0
    }

    fn begin_with_zero(&mut self, (a, b): Pair) {
        self.information[(a * self.size, b * self.size)] = 0.0;
        self.information[(b * self.size, a * self.size)] = 0.0;
    }

    fn links(&self) -> Vec<Pair> {
        self.pairs().into_iter().filter(|link| self.norm(*link) > 0.0).collect()
    }

    /// The matrix with zeros where a function of row and column says so.
    fn without(&self, dropped: impl Fn(usize, usize) -> bool) -> DMatrix<f64> {
        let mut matrix = self.information.clone();
        for row in 0..matrix.nrows() {
            for column in 0..matrix.ncols() {
                if dropped(row, column) {
                    matrix[(row, column)] = 0.0;
                }
            }
        }
        matrix
    }

    fn cut_by(&self, dropped: impl Fn(usize, usize) -> bool) -> Cut {
        let matrix = self.without(dropped);
        // Windows have positive definite matrices.
        let factor = self.information.clone().cholesky().map(|factor| factor.l());
        let relative = factor.and_then(|lower| {
            let half = lower.solve_lower_triangular(&matrix)?;
            lower.solve_lower_triangular(&half.transpose())
        });
        Cut(relative.map_or_else(|| DVector::zeros(1), |matrix| matrix.symmetric_eigenvalues()))
    }

    fn cut(&self, (a, b): Pair) -> Cut {
        let size = self.size;
        self.cut_by(|row, column| {
            let pair = (row / size, column / size);
            pair == (a, b) || pair == (b, a)
        })
    }

    fn least(&self, cost: impl Fn(Pair) -> Option<f64>) -> Option<Pair> {
        let costs = self.links().into_iter().filter_map(|link| Some((link, cost(link)?)));
        costs.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(link, _)| link)
    }

    fn cheapest(&self) -> Option<Pair> {
        self.least(|link| self.cut(link).lost())
    }

    fn cheapest_backward(&self) -> Option<Pair> {
        self.least(|link| self.cut(link).sum(backward))
    }

    fn smallest_droppable(&self) -> Option<Pair> {
        self.least(|link| self.cut(link).lost().map(|_| self.norm(link)))
    }

    fn smallest(&self) -> Option<Pair> {
        self.least(|link| Some(self.norm(link)))
    }
}

/// The term of D(q‖p).
fn backward(value: f64) -> f64 {
    0.5 * (1.0 / value - 1.0 + value.ln())
}

/// What is lost with each link of some windows.
///
/// # Errors
///
/// A failure, which names what was computed instead where that is known.
pub fn losses(answer: &dyn Transport, windows: &[Window]) -> Result<(), Failure> {
    let links = |window| Window::links(window).into_iter().map(move |link| (window, link));
    let failed = |(window, link)| loss(answer, window, link).err();
    // One link may tell what another does not.
    let failures: Vec<Failure> = windows.iter().flat_map(links).filter_map(failed).collect();
    let known = failures.iter().find(|failure| failure.misconception.is_some());
    known.or(failures.first()).cloned().map_or(Ok(()), Err)
}

/// What is lost with one link.
fn loss(answer: &dyn Transport, window: &Window, link: Pair) -> Result<(), Failure> {
    let (information, size) = (&window.information, &window.size);
    let cut = window.cut(link);
    let obtained = Answer(answer).information_lost(information, size, &link)?;
    let what = format!("the divergence for the link {}-{}", link.0, link.1);
    let near = |one: f64, other: f64| (one - other).abs() <= 1e-6 * other.abs();
    match (cut.lost(), obtained) {
        (None, None) => {}
        (Some(_), None) => {
            return Err(Failure::new(format!(
                "{what} is missing. Without the link the matrix is positive definite; its \
                     smallest eigenvalue in units of the whole is {}.",
                readable(cut.0.min())
            )));
        }
        (None, Some(number)) if window.one_block(link).iter().any(|&half| near(number, half)) => {
            return Err(Failure::known(&ONE_BLOCK));
        }
        (None, Some(number)) if number.is_finite() && number != 0.0 => {
            return Err(Failure::known(&INDEFINITE));
        }
        (None, Some(number)) => {
            return Err(Failure::new(format!(
                "{what} is {number}, and without that link there is no Gaussian. What should \
                     come back then?"
            )));
        }
        (Some(lost), Some(number)) => {
            let mut comparison = compare_number(&what, number, lost)
                .within(1e-6)
                .labelled(&["nats"], &[])
                .or_number(&HALF_FORGOTTEN, 2.0 * lost);
            let others = [
                (&EXCHANGED, cut.sum(backward)),
                (&DETERMINANTS_ALONE, cut.sum(|value| -0.5 * value.ln())),
                (&SINGLE_ENTRY, window.single_entry(link)),
            ];
            for candidate in window.one_block(link) {
                comparison = comparison.or_number(&ONE_BLOCK, candidate);
            }
            for (misconception, candidate) in others {
                if let Some(candidate) = candidate {
                    comparison = comparison.or_number(misconception, candidate);
                }
            }
            comparison.judge()?;
        }
    }
    Ok(())
}

impl Window {
    /// What the formula gives when one of the two blocks is kept: with the determinant of the
    /// lopsided matrix, with that of the whole one, which a factorization reads when the other
    /// triangle was cut, and with that of the matrix that is cut rightly.
    fn one_block(&self, (a, b): Pair) -> Vec<f64> {
        let size = self.size;
        let matrix = self.without(|row, column| (row / size, column / size) == (a, b));
        let Some(inverse) = self.information.clone().try_inverse() else { return Vec::new() };
        let relative = inverse * matrix;
        let excess = relative.trace() - relative.nrows() as f64;
        let determinant = relative.determinant();
        let mut logarithms = vec![0.0];
        logarithms.extend((determinant > 0.0).then(|| determinant.ln()));
        logarithms.extend(self.cut((a, b)).sum(f64::ln));
        logarithms.into_iter().map(|logarithm| 0.5 * (excess - logarithm)).collect()
    }

    /// What is lost with the one number that has the indices of the keyframes.
    fn single_entry(&self, (a, b): Pair) -> Option<f64> {
        let entry = |row, column| (row, column) == (a, b) || (row, column) == (b, a);
        let lost = self.cut_by(entry).lost()?;
        (self.size > 1 && lost > 0.0).then_some(lost)
    }
}

/// Which links of some windows cost least.
///
/// # Errors
///
/// A failure, which names what was chosen instead where that is known.
pub fn cheapest(answer: &dyn Transport, windows: &[Window]) -> Result<(), Failure> {
    let ask = |window: &Window| Answer(answer).cheapest_link(&window.information, &window.size);
    let obtained = windows.iter().map(ask).collect::<Result<Vec<_>, _>>()?;
    let ends = |link: Option<Pair>| link.map_or([f64::NAN; 2], |(a, b)| [a as f64, b as f64]);
    let [said, right] = [obtained.clone(), windows.iter().map(Window::cheapest).collect()]
        .map(|links| links.into_iter().flat_map(ends).collect::<Vec<f64>>());
    show_list("the list of chosen links, window by window,", &said, &right);
    // A wrong idea shows in every window; in a single one it may be an accident.
    let chosen_by = |choice: &dyn Fn(&Window) -> Option<Pair>| {
        windows.iter().zip(&obtained).all(|(window, obtained)| choice(window) == *obtained)
    };
    let idea = if chosen_by(&Window::smallest) || chosen_by(&Window::smallest_droppable) {
        Some(&SMALLEST_BLOCK)
    } else if chosen_by(&Window::cheapest_backward) {
        Some(&EXCHANGED)
    } else {
        None
    };
    let mut judged = windows.iter().zip(obtained);
    judged
        .try_for_each(|(window, obtained)| chosen(window, obtained, idea))
        .map_err(|failure| failure.unless("information_lost", || losses(answer, windows)))
}

/// The link that was chosen in a window, and the idea that chose it, where it is known.
fn chosen(
    window: &Window,
    obtained: Option<Pair>,
    idea: Option<&'static Misconception>,
) -> Result<(), Failure> {
    let expected = window.cheapest();
    if obtained == expected {
        return Ok(());
    }
    let Some(chosen) = obtained else {
        return Err(Failure::new("No link was chosen, and there are some that can be dropped."));
    };
    if !window.pairs().contains(&chosen) {
        return Err(Failure::new(format!(
            "{}-{} is no pair of keyframes with the smaller index first; there are {} keyframes.",
            chosen.0,
            chosen.1,
            window.keyframes()
        )));
    }
    let failure = match idea {
        _ if !window.links().contains(&chosen) => Failure::known(&NO_LINK),
        Some(idea) => Failure::known(idea),
        None if expected.is_some_and(|link| window.begins_with_zero(link)) => Failure::new(
            "This is not the link whose loss costs least. The block of the one that is begins with \
             a zero, and has other numbers.",
        ),
        None => Failure::new("This is not the link whose loss costs least."),
    };
    let mut numbers = String::from("      link        norm   divergence\n");
    for link in window.links() {
        let lost = window.cut(link).lost().map_or("none".to_owned(), readable);
        let mark = match Some(link) {
            link if link == expected => " expected",
            link if link == obtained => " obtained",
            _ => "",
        };
        let name = format!("{}-{}", link.0, link.1);
        let _ = writeln!(numbers, "{name:>10}{:>12}{lost:>13}{mark}", readable(window.norm(link)));
    }
    Err(failure.with_numbers(numbers))
}

/// A window that has no link.
///
/// # Errors
///
/// A failure when a link was chosen all the same.
pub fn unlinked(answer: &dyn Transport, keyframes: usize, size: usize) -> Result<(), Failure> {
    let information = DMatrix::identity(keyframes * size, keyframes * size);
    match Answer(answer).cheapest_link(&information, &size)? {
        None => Ok(()),
        Some((a, b)) => Err(Failure::new(format!(
            "{a}-{b} was chosen in a window whose matrix is an identity. Which pairs does it link?"
        ))),
    }
}

/// Layouts that tell the wrong ideas apart come first.
fn slides() -> Vec<Slide> {
    let mut draw = Draw::new(3);
    let mut slides = Vec::new();
    while slides.len() < 3 {
        let slide = Slide::drawn(&mut draw, 9, 6, true);
        if slide.wrong().len() == 6 && slide.has_met_some_by_odometry_alone() {
            slides.push(slide);
        }
    }
    slides
}

fn windows() -> Vec<Window> {
    let mut draw = Draw::new(4);
    [(4, 2), (5, 1), (5, 3)].map(|(count, size)| Window::drawn(&mut draw, count, size)).into()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("a_slide_joins_whom_the_departing_have_met", |answer| {
            slides().iter().try_for_each(|slide| couplings(answer, slide))
        }),
        Check::new("the_first_slide_of_a_row_with_odometry_and_without", |answer| {
            couplings(answer, &Slide::in_a_row(8, 12, true))?;
            couplings(answer, &Slide::in_a_row(8, 12, false))
        }),
        Check::new("what_a_link_is_worth", |answer| losses(answer, &windows())),
        Check::new("the_link_that_costs_least", |answer| {
            cheapest(answer, &windows())?;
            unlinked(answer, 3, 2)
        }),
    ]
}
