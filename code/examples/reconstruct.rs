//! Reconstructs cameras and points from matches alone.
//!
//! ```text
//! cargo run --release -p vislam --example reconstruct -- \
//!     FILE [--wrong SHARE] [--seed N] [--ply FILE] [--matches FILE] [--centres FILE]
//! ```
//!
//! `FILE` is a list of matches with the intrinsics in its head (see `vislam::datasets::matches`), or a
//! problem of the "Bundle Adjustment in the Large" data sets. Of such a problem only the observations
//! are taken, with the lens parameters: keypoints that show one point are matched, all with one
//! another, cameras and points are thrown away, and everything is shuffled. `--wrong 0.2` mixes in so
//! many matches of keypoints at random that they are a fifth of all. `--ply` writes the map for a
//! viewer, `--matches` the matches as a list, and `--centres` the centres that others are compared with, a
//! line for each picture.
//!
//! The last line says how many pictures were registered, the truncated and the plain cost, by how much
//! the camera centres are off after a similarity, in percent of their extent, and the seconds of the
//! reconstruction. Costs are halves of sums of squares in the file's pixels. The truncated one counts no
//! observation for more than 4 pixels, those of points that were not found for 4, and leaves out the points
//! that lie behind all cameras that see them at the file's own optimum. A point of the file is where the map
//! has the one to which most of its keypoints belong. Centres are compared with those of the optimum of the
//! truncated cost that the file's own start leads to; the lines before the last say how far that is.

use std::error::Error;
use std::fmt::Write;
use std::time::Instant;

use nalgebra::{Isometry3, Matrix3, Rotation3, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::bundle_adjustment::{BalCamera, TinyBa};
use vislam::datasets::bal::read_bal;
use vislam::datasets::matches::read_matches;
use vislam::datasets::written::ply;
use vislam::least_squares::Options;
use vislam::manifold::se3;
use vislam::reprojection::{DistortedPinhole, Pinhole, RadialTangential, ReprojFactor};
use vislam::structure_from_motion::{
    Joined, Picture, PictureMatch, Reconstruction, ReconstructionOptions, ScaleFreedom, Verified,
    absolute_orientation, reconstruct,
};

const USAGE: &str = "usage: reconstruct FILE [--wrong SHARE] [--seed N] [--ply FILE] \
                     [--matches FILE] [--centres FILE]";
/// No observation counts for more, in the truncated cost, in pixels.
const MOST_PIXELS: f64 = 4.0;

/// Rounds of choosing the observations within it.
const MOST_ROUNDS: usize = 20;

pub type Failure = Box<dyn Error>;
type Problem = TinyBa<BalCamera, 6>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or(USAGE)?;
    let (mut wrong, mut seed, mut map, mut list, mut centres) = (0.0, 0, None, None, None);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or(USAGE)?;
        match argument.as_str() {
            "--wrong" => wrong = value.parse()?,
            "--seed" => seed = value.parse()?,
            "--ply" => map = Some(value),
            "--matches" => list = Some(value),
            "--centres" => centres = Some(value),
            unknown => return Err(format!("{unknown} is not an option; {USAGE}").into()),
        }
    }
    if !(0.0..1.0).contains(&wrong) {
        return Err(format!("--wrong is {wrong}; give a share of all matches, below 1").into());
    }
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{file}: {error}"))?;
    let input = Input::new(&text, wrong, seed).map_err(|error| format!("{file}: {error}"))?;
    println!(
        "{} pictures, {} matches, {} wrong ones among them",
        input.pictures.len(),
        input.matches.len(),
        input.wrong
    );
    if let Some(list) = list {
        std::fs::write(list, matches_as_text(&input.pictures, &input.matches)?)?;
    }
    if let Some(centres) = centres {
        let truth =
            input.truth.as_ref().ok_or("a list of matches has no centres to compare with")?;
        std::fs::write(centres, truth.centres()?)?;
    }
    let start = Instant::now();
    let found = input.reconstruct(seed)?;
    let seconds = start.elapsed().as_secs_f64();
    tell(&found);
    if let Some(file) = map {
        std::fs::write(file, as_ply(&found))?;
    }
    let registered = found.cameras.iter().flatten().count();
    let [truncated, cost, centres] = match &input.truth {
        Some(truth) => truth.judge(&found)?.told(),
        None => [f64::NAN, plain_cost(&input.pictures, &found), f64::NAN],
    };
    let line = format!(
        "registered {registered}  of {}  truncated {truncated:.2}  cost {cost:.2}  centres_percent \
         {centres:.4}  seconds {seconds:.2}",
        input.pictures.len()
    );
    println!("{}", line.replace("NaN", "nan"));
    Ok(())
}

/// What is left of matches and how the map grew.
fn tell(found: &Reconstruction) {
    let Verified { pairs, verified_pairs, matches, verified_matches, tracks } = found.verified;
    println!(
        "verified: {verified_pairs} of {pairs} pairs, {verified_matches} of {matches} matches; \
         {tracks} tracks"
    );
    for Joined { picture, seen, inliers, points } in &found.joined {
        println!(
            "picture {picture:3} joined: {inliers:4} of {seen:4} points agree, {points:5} points"
        );
    }
    for (picture, camera) in found.cameras.iter().enumerate() {
        if let Err(refused) = camera {
            println!("picture {picture:3} refused: {refused}");
        }
    }
    println!("{} points", found.points.len());
}

/// What is to be reconstructed.
pub struct Input {
    pub pictures: Vec<Picture>,
    /// In no order.
    pub matches: Vec<PictureMatch>,
    /// How many of them were mixed in.
    pub wrong: usize,
    pub truth: Option<Truth>,
}

impl Input {
    pub fn new(text: &str, wrong: f64, seed: u64) -> Result<Self, Failure> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let is_list = text.lines().any(|line| line.trim_start().starts_with("camera"));
        let (pictures, mut matches, truth) = if is_list {
            let (pictures, matches) = read_matches(text)?;
            (pictures, matches, None)
        } else {
            let truth = Truth::new(read_bal::<6>(text)?, &mut random);
            let (pictures, matches) = truth.matches()?;
            (pictures, matches, Some(truth))
        };
        let mixed_in = wrong_matches(&pictures, &matches, wrong, &mut random);
        let wrong = mixed_in.len();
        matches.extend(mixed_in);
        shuffle(&mut matches, &mut random);
        Ok(Self { pictures, matches, wrong, truth })
    }

    pub fn reconstruct(&self, seed: u64) -> Result<Reconstruction, Failure> {
        let options = ReconstructionOptions { seed, ..ReconstructionOptions::default() };
        Ok(reconstruct(&self.pictures, &self.matches, &options)?)
    }
}

/// A map, and how it stands to two optima that the file's own start leads to.
pub struct Judged {
    pub truncated: f64,
    pub plain: f64,
    /// That of the plain cost, and from there that of the truncated one.
    pub beside: [Beside; 2],
}

/// An optimum, and how the centres of a map differ from its own.
pub struct Beside {
    pub truncated: f64,
    pub plain: f64,
    /// In percent of their extent.
    pub largest: f64,
    pub root_mean_square: f64,
}

impl Judged {
    /// What the last line says; the lines before it are printed.
    fn told(&self) -> [f64; 3] {
        for (name, beside) in ["plain", "truncated"].iter().zip(&self.beside) {
            println!(
                "the optimum of the {name} cost: truncated {:.2}  cost {:.2}; beside it truncated \
                 {:+.2} %, centres {:.4} % off, {:.4} % as a root mean square",
                beside.truncated,
                beside.plain,
                100.0 * (self.truncated / beside.truncated - 1.0),
                beside.largest,
                beside.root_mean_square
            );
        }
        [self.truncated, self.plain, self.beside[1].largest]
    }
}

/// A problem with its numbers shuffled, and where the keypoints come from.
pub struct Truth {
    problem: Problem,
    /// For each picture, in the order of its keypoints, the observations of the problem.
    observations: Vec<Vec<usize>>,
}

impl Truth {
    /// Shuffles pictures, and the keypoints of each.
    fn new(problem: Problem, random: &mut ChaCha8Rng) -> Self {
        let mut order: Vec<usize> = (0..problem.cameras.len()).collect();
        shuffle(&mut order, random);
        let mut number = vec![0; order.len()];
        order.iter().enumerate().for_each(|(at, camera)| number[*camera] = at);
        let cameras = order.iter().map(|camera| problem.cameras[*camera]).collect();
        let renumbered =
            |factor: &ReprojFactor| ReprojFactor { keyframe: number[factor.keyframe], ..*factor };
        let factors: Vec<ReprojFactor> = problem.factors.iter().map(renumbered).collect();
        let mut observations = vec![Vec::new(); order.len()];
        for (index, factor) in factors.iter().enumerate() {
            observations[factor.keyframe].push(index);
        }
        observations.iter_mut().for_each(|list| shuffle(list, random));
        Self { problem: Problem::new(cameras, problem.points, factors), observations }
    }

    /// Pictures with undistorted pixels, and a match for each two keypoints that show one point.
    ///
    /// A BAL camera looks along −z, with y upwards.
    fn matches(&self) -> Result<(Vec<Picture>, Vec<PictureMatch>), Failure> {
        let mut pictures = Vec::new();
        let mut seen_by = vec![Vec::new(); self.problem.points.len()];
        for (picture, observations) in self.observations.iter().enumerate() {
            let BalCamera { focal_length: f, radial: [k1, k2], .. } = self.problem.cameras[picture];
            let camera = Pinhole::new(f, f, 0.0, 0.0)?;
            let lens = RadialTangential::new(k1, k2, 0.0, 0.0, 0.0)?;
            let distorted = DistortedPinhole { pinhole: camera, lens };
            let mut keypoints = Vec::new();
            for (keypoint, observation) in observations.iter().enumerate() {
                let ReprojFactor { pixel, point, .. } = self.problem.factors[*observation];
                keypoints.push(f * distorted.unproject(&Vector2::new(pixel.x, -pixel.y))?);
                seen_by[point].push([picture, keypoint]);
            }
            pictures.push(Picture { camera, keypoints });
        }
        let mut matches = Vec::new();
        for seen in &seen_by {
            for (at, [b, j]) in seen.iter().enumerate() {
                let pair =
                    |[a, i]: &[usize; 2]| PictureMatch { pictures: [*a, *b], keypoints: [*i, *j] };
                matches.extend(seen[..at].iter().map(pair));
            }
        }
        Ok((pictures, matches))
    }

    /// The optima of the plain and of the truncated cost that the file's own start leads to, and which
    /// points are judged.
    fn optima(&self) -> Result<([Problem; 2], Vec<bool>), Failure> {
        let mut optimum = self.problem.clone();
        optimum.fixed.iter_mut().take(1).for_each(|fixed| *fixed = true);
        optimum.solve(&Options::large_problem())?;
        let is_judged = judged(&optimum);
        let robust = truncated_optimum(&optimum, &is_judged)?;
        Ok(([optimum, robust], is_judged))
    }

    /// The centres at the optimum of the truncated cost: x y z of each picture in a line.
    fn centres(&self) -> Result<String, Failure> {
        let ([_, robust], _) = self.optima()?;
        let mut text = String::new();
        for camera in &robust.cameras {
            let centre = centre(camera);
            writeln!(text, "{} {} {}", centre.x, centre.y, centre.z)?;
        }
        Ok(text)
    }

    // ANCHOR: judge
    /// The costs of a map, and how it stands to the optima that the file's own start leads to.
    pub fn judge(&self, found: &Reconstruction) -> Result<Judged, Failure> {
        let (optima, is_judged) = self.optima()?;
        let posed = |pose: &Result<_, _>, camera| Some(as_bal(pose.as_ref().ok()?, camera));
        let both = found.cameras.iter().zip(&self.problem.cameras);
        let cameras: Vec<_> = both.map(|(pose, camera)| posed(pose, camera)).collect();
        let [truncated, plain] = self.costs(&cameras, &self.places(found), &is_judged);
        let beside = optima.map(|reference| {
            let known: Vec<_> = reference.cameras.iter().copied().map(Some).collect();
            let points: Vec<_> = reference.points.iter().copied().map(Some).collect();
            let [truncated, plain] = self.costs(&known, &points, &is_judged);
            let centres = cameras.iter().zip(&reference.cameras);
            let centres: Vec<_> =
                centres.filter_map(|(a, b)| Some((centre(&(*a)?), centre(b)))).collect();
            let [largest, root_mean_square] = percent_off(&centres);
            Beside { truncated, plain, largest, root_mean_square }
        });
        Ok(Judged { truncated, plain, beside })
    }
    // ANCHOR_END: judge

    /// For each point of the problem the place of that point of the map which most of its keypoints
    /// belong to.
    fn places(&self, found: &Reconstruction) -> Vec<Option<Vector3<f64>>> {
        let mut votes = vec![std::collections::BTreeMap::new(); self.problem.points.len()];
        for (index, point) in found.points.iter().enumerate() {
            for [picture, keypoint] in &point.sightings {
                let observation = self.observations[*picture][*keypoint];
                *votes[self.problem.factors[observation].point].entry(index).or_insert(0) += 1;
            }
        }
        let most = |votes: &std::collections::BTreeMap<usize, usize>| {
            let (index, _) = votes.iter().max_by_key(|(_, count)| **count)?;
            Some(found.points[*index].place)
        };
        votes.iter().map(most).collect()
    }

    /// The truncated cost over the observations that are judged, and the plain one over all of points
    /// that are known to cameras that are.
    fn costs(
        &self,
        cameras: &[Option<BalCamera>],
        points: &[Option<Vector3<f64>>],
        is_judged: &[bool],
    ) -> [f64; 2] {
        let [mut truncated, mut plain] = [0.0, 0.0];
        for (factor, is_judged) in self.problem.factors.iter().zip(is_judged) {
            let pixel = cameras[factor.keyframe]
                .zip(points[factor.point])
                .and_then(|(camera, point)| camera.project(&point));
            let square = pixel.map(|pixel| (pixel - factor.pixel).norm_squared());
            plain += 0.5 * square.unwrap_or(0.0);
            if *is_judged {
                let most = MOST_PIXELS * MOST_PIXELS;
                truncated += 0.5 * square.unwrap_or(most).min(most);
            }
        }
        [truncated, plain]
    }
}

/// Where the truncated cost of the observations that are judged is least, near a start: what is beyond the
/// truncation is left out, until that does not change any more.
fn truncated_optimum(start: &Problem, is_judged: &[bool]) -> Result<Problem, Failure> {
    let (mut optimum, mut before) = (start.clone(), Vec::new());
    for _ in 0..MOST_ROUNDS {
        let is_near = |factor: &ReprojFactor| {
            let pixel = optimum.cameras[factor.keyframe].project(&optimum.points[factor.point]);
            pixel.is_some_and(|pixel| (pixel - factor.pixel).norm() <= MOST_PIXELS)
        };
        let judged = start.factors.iter().zip(is_judged).filter(|(_, is_judged)| **is_judged);
        let near: Vec<_> = judged.map(|(f, _)| *f).filter(is_near).collect();
        if near == before {
            break;
        }
        optimum.factors = near.clone();
        optimum.solve(&Options::large_problem())?;
        before = near;
    }
    Ok(optimum)
}

/// For each observation, that its point lies in front of some camera that sees it.
fn judged(problem: &Problem) -> Vec<bool> {
    let mut is_in_front = vec![false; problem.points.len()];
    for ReprojFactor { keyframe, point, .. } in &problem.factors {
        let BalCamera { rotation, translation, .. } = problem.cameras[*keyframe];
        is_in_front[*point] |= (rotation * problem.points[*point] + translation).z < 0.0;
    }
    problem.factors.iter().map(|factor| is_in_front[factor.point]).collect()
}

/// A pose as a BAL camera has it.
fn as_bal(pose: &Isometry3<f64>, camera: &BalCamera) -> BalCamera {
    let flip =
        Rotation3::from_matrix_unchecked(Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)));
    let rotation = flip * pose.rotation.to_rotation_matrix();
    BalCamera { rotation, translation: flip * pose.translation.vector, ..*camera }
}

fn centre(camera: &BalCamera) -> Vector3<f64> {
    -(camera.rotation.inverse() * camera.translation)
}

/// The largest distance between centres after the best similarity, and the root of the mean square, in
/// percent of the largest distance between those of the truth.
fn percent_off(pairs: &[(Vector3<f64>, Vector3<f64>)]) -> [f64; 2] {
    let Ok(similarity) = absolute_orientation(pairs, ScaleFreedom::Free) else {
        return [f64::NAN; 2];
    };
    let off = || pairs.iter().map(|(own, other)| (similarity.point(own) - other).norm());
    let apart = pairs.iter().flat_map(|(_, a)| pairs.iter().map(move |(_, b)| (a - b).norm()));
    let percent = 100.0 / apart.fold(0.0, f64::max);
    let square = off().map(|off| off * off).sum::<f64>() / pairs.len() as f64;
    [percent * off().fold(0.0, f64::max), percent * square.sqrt()]
}

/// For each pair of pictures matches of random keypoints, so many that they are a share of all.
fn wrong_matches(
    pictures: &[Picture],
    matches: &[PictureMatch],
    share: f64,
    random: &mut ChaCha8Rng,
) -> Vec<PictureMatch> {
    let mut right = std::collections::BTreeMap::<[usize; 2], std::collections::HashSet<_>>::new();
    for one in matches {
        right.entry(one.pictures).or_default().insert(one.keypoints);
    }
    let (mut wrong, mut due) = (Vec::new(), 0.0);
    for (pair, right) in &right {
        due += right.len() as f64 * share / (1.0 - share);
        while due >= 1.0 {
            due -= 1.0;
            let keypoints =
                pair.map(|picture| random.random_range(0..pictures[picture].keypoints.len()));
            if !right.contains(&keypoints) {
                wrong.push(PictureMatch { pictures: *pair, keypoints });
            }
        }
    }
    wrong
}

fn shuffle<T>(list: &mut [T], random: &mut ChaCha8Rng) {
    for at in (1..list.len()).rev() {
        list.swap(at, random.random_range(0..=at));
    }
}

/// Half the sum of squared errors of all sightings of the map.
fn plain_cost(pictures: &[Picture], found: &Reconstruction) -> f64 {
    let sightings =
        found.points.iter().flat_map(|p| p.sightings.iter().map(move |s| (p.place, *s)));
    let squares = sightings.filter_map(|(place, [picture, keypoint])| {
        let pose = found.cameras[picture].as_ref().ok()?;
        let Picture { camera, keypoints } = &pictures[picture];
        Some((camera.project(pose, &place)? - keypoints[keypoint]).norm_squared())
    });
    0.5 * squares.sum::<f64>()
}

/// A list of matches as `read_matches` takes it.
fn matches_as_text(pictures: &[Picture], matches: &[PictureMatch]) -> Result<String, Failure> {
    let mut text = String::new();
    for Picture { camera: Pinhole { fx, fy, cx, cy }, .. } in pictures {
        writeln!(text, "camera {fx} {fy} {cx} {cy}")?;
    }
    for PictureMatch { pictures: [a, b], keypoints: [i, j] } in matches {
        let (one, other) = (pictures[*a].keypoints[*i], pictures[*b].keypoints[*j]);
        writeln!(text, "{a} {} {} {b} {} {}", one.x, one.y, other.x, other.y)?;
    }
    Ok(text)
}

/// The points in grey, the cameras in red.
fn as_ply(found: &Reconstruction) -> String {
    let centres = found
        .cameras
        .iter()
        .flatten()
        .map(|pose| (se3::transform(&pose.inverse(), &Vector3::zeros()), [255, 0, 0]));
    let points = found.points.iter().map(|point| (point.place, [160, 160, 160]));
    ply(&centres.chain(points).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[ignore = "needs the BAL problem in the folder that VISLAM_DATA names"]
    fn real_pixels_with_a_fifth_of_wrong_matches_give_all_cameras() {
        let folder =
            std::env::var("VISLAM_DATA").expect("VISLAM_DATA names the folder of the data");
        let text = std::fs::read_to_string(format!("{folder}/bal/problem-49-7776-pre.txt"));
        let text = text.expect("the file");
        for seed in 0..3 {
            let input = Input::new(&text, 0.2, seed).unwrap();
            let found = input.reconstruct(seed).unwrap();
            assert_eq!(found.cameras.iter().flatten().count(), 49);
            let judged = input.truth.as_ref().unwrap().judge(&found).unwrap();
            for Beside { truncated, .. } in &judged.beside {
                assert!(judged.truncated < 1.01 * truncated, "{} {truncated}", judged.truncated);
            }
            assert!(judged.beside[1].largest < 0.5, "{}", judged.beside[1].largest);
        }
    }
}
