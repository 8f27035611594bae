//! The window of eight keyframes, from which the oldest leave while the landmarks that they saw stay.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, Isometry3, Matrix3, Vector3};
use vislam::least_squares::Values;
use vislam::marginalization::{
    Couplings, Information, Layout as Window, SquareRoot, WindowSigmas, fill_in, marginalize,
};
use vislam::reprojection::Pinhole;

use crate::layout::{Beside, Layout};
use crate::stage::{colour, ellipsoids, lines, matrix, points};
use crate::{Ellipsoid, Stage, StageError, frustum};

pub const SHOWS: &str =
    "a window of eight keyframes; the oldest leave, and couple the landmarks that they saw";

/// How many keyframes leave.
const SLIDES: usize = 4;
const SEED: u64 = 0;
/// How many standard deviations the ellipsoids are drawn large.
const LARGE: f64 = 3.0;
/// Powers of ten between the faintest entry of a matrix and its largest.
const POWERS: f64 = 8.0;
/// The camera as it is drawn.
const CAMERA: Pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };
const IMAGE: f64 = 0.3;

/// The window while blocks leave it.
struct Sliding {
    window: Window,
    values: Values,
    couplings: Couplings,
    measured: BTreeSet<(usize, usize)>,
    information: Information<f64>,
    gone: Vec<usize>,
    new: BTreeSet<(usize, usize)>,
}

pub fn play(stage: &Stage) -> Result<(), StageError> {
    stage.arrange(&Layout {
        title: "Keyframes along a wall, landmarks, and who is coupled",
        eye: Vector3::new(-0.9, -6.4, -1.6),
        target: Vector3::new(1.55, -0.1, 3.6),
        up: -Vector3::y(),
        floor: None,
        beside: vec![
            Beside::Picture { title: "Information matrix, keyframes first", of: "information" },
            Beside::Curves { title: "Couplings", of: "couplings" },
        ],
        timeline: "left",
        speed: 2.0,
    })?;
    stage.curve("couplings/measured", "by a measurement", colour::MEASURED)?;
    stage.curve("couplings/filled_in", "by what has left", colour::PRIOR)?;
    let mut sliding = Sliding::new()?;
    stage.at_step("left", 0);
    sliding.draw(stage)?;
    for keyframe in 0..SLIDES {
        sliding.leave(keyframe)?;
        stage.at_step("left", sliding.gone.len());
        sliding.draw(stage)?;
    }
    Ok(())
}

impl Sliding {
    fn new() -> Result<Self, StageError> {
        let window = Window::eight_keyframes();
        let sigmas = WindowSigmas::default();
        let problem = window.problem(&sigmas, SEED).map_err(StageError::scene)?;
        let values = problem.values().clone();
        let root = SquareRoot::of_problem(&problem, &values).map_err(StageError::scene)?;
        let couplings = window.couplings();
        Ok(Self {
            measured: couplings.pairs(),
            information: root.information(),
            couplings,
            values,
            window,
            gone: Vec::new(),
            new: BTreeSet::new(),
        })
    }

    /// A block leaves.
    fn leave(&mut self, name: usize) -> Result<(), StageError> {
        let filled = fill_in(&self.couplings, &[name]).map_err(StageError::scene)?;
        self.information = marginalize(&self.information, &[name]).map_err(StageError::scene)?;
        (self.couplings, self.new) = (filled.couplings, filled.new);
        self.gone.push(name);
        Ok(())
    }

    fn keyframes(&self) -> &[Isometry3<f64>] {
        self.values.of_kind()
    }

    fn landmarks(&self) -> &[Vector3<f64>] {
        self.values.of_kind()
    }

    /// Where a block is in the world.
    fn place(&self, name: usize) -> Vector3<f64> {
        match name.checked_sub(self.window.keyframes) {
            Some(landmark) => self.landmarks()[landmark],
            None => self.keyframes()[name].inverse().translation.vector,
        }
    }

    /// Those that are there, or those that have left.
    fn names(&self, gone: bool) -> impl Iterator<Item = usize> + '_ {
        let all = 0..self.window.keyframes + self.window.seen_by.len();
        all.filter(move |name| self.gone.contains(name) == gone)
    }

    fn draw(&self, stage: &Stage) -> Result<(), StageError> {
        for (part, gone, own) in
            [("world/there", false, colour::ESTIMATED), ("world/gone", true, colour::GONE)]
        {
            let keyframes = self.window.keyframes;
            let (poses, marks): (Vec<_>, Vec<_>) =
                self.names(gone).partition(|name| *name < keyframes);
            let frusta =
                poses.iter().flat_map(|name| frustum(&CAMERA, &self.keyframes()[*name], IMAGE));
            let width = if gone { 0.8 } else { 1.8 };
            stage.now(&format!("{part}/keyframes"), &lines(frusta, (own, 255), width))?;
            let marks: Vec<_> = marks.iter().map(|name| self.place(*name)).collect();
            stage.now(&format!("{part}/landmarks"), &points(&marks, own, 4.0))?;
        }
        self.draw_ellipsoids(stage)?;
        self.draw_links(stage)?;
        stage.now("information", &matrix(self.information.matrix(), POWERS))
    }

    fn draw_ellipsoids(&self, stage: &Stage) -> Result<(), StageError> {
        let covariance: DMatrix<f64> = self.information.covariance().map_err(StageError::scene)?;
        let blocks = self.information.blocks();
        let around = self.names(false).filter(|name| *name >= self.window.keyframes);
        let around = around.filter_map(|name| {
            let own = blocks.columns_of(name).ok()?;
            let own = covariance.view_range(own.clone(), own);
            let own = Matrix3::from_fn(|row, column| own[(row, column)]);
            Some(Ellipsoid::of(&self.place(name), &own, LARGE))
        });
        stage.now("world/there/ellipsoids", &ellipsoids(around, colour::ESTIMATED))
    }

    fn draw_links(&self, stage: &Stage) -> Result<(), StageError> {
        let pairs = self.couplings.pairs();
        let (measured, filled): (Vec<_>, Vec<_>) =
            pairs.into_iter().partition(|pair| self.measured.contains(pair));
        let (new, old): (Vec<_>, Vec<_>) = filled.iter().partition(|pair| self.new.contains(pair));
        stage.value("couplings/measured", measured.len() as f64)?;
        stage.value("couplings/filled_in", filled.len() as f64)?;
        for (entity, pairs, look, width) in [
            ("world/couplings/measured", measured, (colour::MEASURED, 130), 0.9),
            ("world/couplings/filled_in", old, (colour::PRIOR, 200), 1.2),
            ("world/couplings/new", new, (colour::STRIKING, 255), 2.0),
        ] {
            let links = pairs.iter().map(|(one, other)| vec![self.place(*one), self.place(*other)]);
            stage.now(entity, &lines(links, look, width))?;
        }
        Ok(())
    }
}
