//! How fast five points are solved, and how well a motion comes out of matches of which most are
//! wrong, beside an oracle that knows the right ones and, if wanted, beside PoseLib.
//!
//! ```text
//! cargo run -p vislam --example robust_two_view -- [SCENES [PYTHON]]
//! ```
//!
//! `PYTHON` is an interpreter that has `poselib` and `numpy`; it gets the same scenes in a file.

use std::error::Error;
use std::fmt::Write;
use std::process::Command;
use std::time::Instant;

use nalgebra::{Isometry3, UnitQuaternion, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vislam::bearing::back_project;
use vislam::reprojection::Pinhole;
use vislam::robust_two_view::{
    ConsensusOptions, Correspondences, Effort, GeneralMotion, Matches, RayPair, RelativeMotion,
    five_points, general_motion, motions_of_five,
};

const CAMERA: Pinhole = Pinhole { fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0 };
const RIGHT: usize = 200;
const WRONG: usize = 300;
const SIGMA: f64 = 1.0;
/// How often the time of something is taken; the least is told.
const REPEATS: usize = 5;

struct Scene {
    second_from_first: Isometry3<f64>,
    pixels: Vec<[Vector2<f64>; 2]>,
}

impl Scene {
    /// A turn of a few degrees and a baseline of half a metre; points 2 to 8 m away.
    fn new(random: &mut ChaCha8Rng) -> Self {
        let [turn, shift] =
            [(), ()].map(|()| Vector3::from_fn(|_, _| random.random_range(-1.0..1.0)));
        let turn = UnitQuaternion::from_scaled_axis(0.1 * turn);
        let shift: Vector3<f64> = 0.5 * shift.normalize();
        let second_from_first = Isometry3::from_parts(shift.into(), turn);
        let mut pixels = Vec::new();
        while pixels.len() < RIGHT {
            let first = any_pixel(random);
            let point = random.random_range(2.0..8.0) * back_project(&CAMERA, &first, 1.0);
            let second = CAMERA.project(&second_from_first, &point).filter(is_inside);
            let mut noise = || Vector2::from_fn(|_, _| SIGMA * normal(random));
            pixels.extend(second.map(|second| [first + noise(), second + noise()]));
        }
        pixels.extend((0..WRONG).map(|_| [any_pixel(random), any_pixel(random)]));
        Self { second_from_first, pixels }
    }

    fn matches(&self) -> Result<Matches, Box<dyn Error>> {
        Ok(Matches::new([&CAMERA, &CAMERA], &self.pixels, SIGMA)?)
    }

    /// The larger of the angles by which rotation and direction are wrong, in degrees.
    fn degrees_off(&self, found: &RelativeMotion) -> f64 {
        let rotation = self.second_from_first.rotation.to_rotation_matrix();
        let turn = found.rotation.rotation_to(&rotation).angle();
        turn.max(found.direction.angle(&self.second_from_first.translation.vector)).to_degrees()
    }
}

fn any_pixel(random: &mut ChaCha8Rng) -> Vector2<f64> {
    Vector2::new(random.random_range(0.0..640.0), random.random_range(0.0..480.0))
}

fn is_inside(pixel: &Vector2<f64>) -> bool {
    (0.0..640.0).contains(&pixel.x) && (0.0..480.0).contains(&pixel.y)
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// The least seconds that something takes, and what it gives.
fn least_seconds<T>(repeats: usize, mut act: impl FnMut() -> T) -> (f64, T) {
    let mut timed = || {
        let start = Instant::now();
        let result = act();
        (start.elapsed().as_secs_f64(), result)
    };
    let first = timed();
    (1..repeats).fold(first, |least, _| {
        let next = timed();
        if next.0 < least.0 { next } else { least }
    })
}

/// What half and what 95 % of the errors stay below.
fn quantiles(mut errors: Vec<f64>) -> [f64; 2] {
    errors.sort_by(f64::total_cmp);
    [0.5, 0.95].map(|part| errors[((errors.len() - 1) as f64 * part).round() as usize])
}

/// Microseconds of a solver over many samples.
fn microseconds<T>(samples: &[[RayPair; 5]], solve: impl Fn(&[RayPair; 5]) -> T) -> f64 {
    let all = || {
        for sample in samples {
            std::hint::black_box(solve(std::hint::black_box(sample)));
        }
    };
    1e6 * least_seconds(4 * REPEATS, all).0 / samples.len() as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().map_or(Ok(1000), |count| count.parse::<usize>())?;
    if count == 0 {
        return Err("there are no scenes to measure; give one or more".into());
    }
    for (name, value) in measured(count, arguments.next().as_deref())? {
        println!("{name} {value:.4}");
    }
    Ok(())
}

/// What is measured in so many scenes, here and in the PoseLib of an interpreter: names and numbers. Errors are in
/// degrees; `median` and `most` are what half and 95 % of them stay below.
pub fn measured(count: usize, python: Option<&str>) -> Result<Vec<(String, f64)>, Box<dyn Error>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let scenes: Vec<Scene> = (0..count).map(|_| Scene::new(&mut random)).collect();
    let mut samples = Vec::new();
    for scene in &scenes {
        let matches = scene.matches()?;
        samples.push(std::array::from_fn(|datum| matches.rays()[datum]));
    }
    let mut said = vec![
        ("scenes", count as f64),
        ("ours.all_us", microseconds(&samples, five_points)),
        ("ours.front_us", microseconds(&samples, motions_of_five)),
    ];

    let (mut ours, mut oracle, mut seconds, mut draws) = (Vec::new(), Vec::new(), 0.0, 0);
    let mut gate = 0.0;
    for (seed, scene) in scenes.iter().enumerate() {
        let matches = scene.matches()?;
        let options = ConsensusOptions { seed: seed as u64, ..ConsensusOptions::default() };
        let (time, found) = least_seconds(2, || general_motion(&matches, &options));
        let found = found?;
        (seconds, draws, gate) = (seconds + time, draws + found.draws, found.gate);
        ours.push(scene.degrees_off(&found.estimate));
        let truth = RelativeMotion::of(&scene.second_from_first).ok_or("a baseline of zero")?;
        let right: Vec<usize> = (0..RIGHT).collect();
        let best = GeneralMotion(&matches).refined(&truth, &right, Effort::Converge);
        oracle.push(scene.degrees_off(&best.ok_or("no minimum near the truth")?));
    }
    let ([median, most], [oracle_median, oracle_most]) = (quantiles(ours), quantiles(oracle));
    said.extend([
        ("oracle.median", oracle_median),
        ("oracle.most", oracle_most),
        ("ours.median", median),
        ("ours.most", most),
        ("ours.ms", 1e3 * seconds / count as f64),
        ("ours.draws", draws as f64 / count as f64),
    ]);
    let mut said: Vec<(String, f64)> =
        said.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    if let Some(python) = python {
        for line in beside_poselib(python, &scenes, &samples, gate)?.lines() {
            let (name, value) = line.split_once(' ').ok_or("a line without a value")?;
            said.push((name.to_owned(), value.parse()?));
        }
    }
    Ok(said)
}

/// What PoseLib does with the same samples and scenes at the same gate.
fn beside_poselib(
    python: &str,
    scenes: &[Scene],
    samples: &[[RayPair; 5]],
    gate: f64,
) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    let Pinhole { fx, fy, cx, cy } = CAMERA;
    writeln!(text, "camera {fx} {fy} {cx} {cy} {}", gate.sqrt() * SIGMA)?;
    for sample in samples {
        text.push_str("sample");
        for (first, second) in sample {
            for entry in first.iter().chain(second.iter()) {
                write!(text, " {entry}")?;
            }
        }
        text.push('\n');
    }
    for Scene { second_from_first, pixels } in scenes {
        let (q, t) = (second_from_first.rotation, second_from_first.translation.vector);
        write!(text, "scene {} {} {} {} {} {} {}", q.w, q.i, q.j, q.k, t.x, t.y, t.z)?;
        for pixel in pixels.iter().flatten() {
            write!(text, " {} {}", pixel.x, pixel.y)?;
        }
        text.push('\n');
    }
    let file = std::env::temp_dir().join(format!("robust_two_view_{}.txt", std::process::id()));
    std::fs::write(&file, text)?;
    let script =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../code/examples/robust_two_view_poselib.py");
    let output = Command::new(python).arg(script).arg(&file).output();
    std::fs::remove_file(&file)?;
    let output = output?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(String::from_utf8(output.stdout)?)
}
