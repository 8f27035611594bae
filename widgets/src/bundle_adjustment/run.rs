//! A solve, and where it stood before each of its steps.

use nalgebra::{DMatrix, Vector3};
use vislam::bundle_adjustment::{Camera, PosedPinhole};
use vislam::factors::MovingCamera;
use vislam::least_squares::{
    Iteration, LandmarkElimination, LinearSystem, Options, Problem, Search, Stop, Values,
};
use vislam::simulation::{Scene, at_true_scale};

use super::MOST_STEPS;
use super::world::Setting;

/// Where a solve stood.
pub struct State {
    /// The cameras.
    pub cameras: Vec<PosedPinhole>,
    /// The points in world coordinates, in metres.
    pub points: Vec<Vector3<f64>>,
    /// The cost with the kernel.
    pub cost: f64,
    /// The length of the gradient, each entry scaled by its own curvature.
    pub gradient_norm: f64,
}

/// A solve that has gone some steps.
pub struct Run {
    /// What was asked for.
    pub setting: Setting,
    /// The scene with its start.
    pub scene: Scene,
    /// Where the solve stood before each step, and where it stands.
    pub states: Vec<State>,
    /// Why it stopped, when it has; nothing more specific when a step failed.
    pub ended: Option<Option<Stop>>,
    /// The cost at the truth.
    pub cost_of_truth: f64,
    /// Where blocks of the whole matrix are, cameras first.
    pub whole: Vec<[usize; 2]>,
    /// Where blocks of the Schur complement are.
    pub reduced: Vec<[usize; 2]>,
    /// Pairs of moving cameras, and how many points they share, if any.
    pub covisible: Vec<([usize; 2], usize)>,
    /// How many rows of blocks the Schur complement has.
    pub rows: usize,
    problem: Problem,
    search: Search<LandmarkElimination<6>>,
}

impl Run {
    /// The start, if there is one.
    pub fn new(setting: Setting) -> Option<Self> {
        let scene = setting.scene();
        let problem = setting.problem(&scene).ok()?;
        let system = LandmarkElimination::new::<Vector3<f64>>(&problem).ok()?;
        let options = Options { max_iterations: MOST_STEPS, ..Options::default() };
        let search = Search::new(&problem, system, &options).ok()?;
        let truth = values(&scene.true_cameras, &scene.true_points);
        let rows = search.system().rows(&problem);
        let mut run = Self {
            setting,
            states: Vec::with_capacity(MOST_STEPS + 1),
            ended: None,
            cost_of_truth: problem.cost(&truth),
            whole: Vec::new(),
            reduced: Vec::new(),
            covisible: Vec::new(),
            rows: rows.iter().flatten().max().map_or(0, |last| last + 1),
            scene,
            problem,
            search,
        };
        run.find_blocks(&rows);
        run.count_shared_points();
        run.keep();
        Some(run)
    }

    /// Goes on until so many steps have been tried, or the solver stops.
    pub fn advance(&mut self, steps: usize) {
        while self.states.len() <= steps && self.ended.is_none() {
            let tried = self.search.iterations().len();
            let stop = self.search.levenberg_marquardt(&self.problem);
            self.ended = stop.map_or(Some(None), |stop| stop.map(Some));
            if self.search.iterations().len() > tried {
                self.keep();
            }
        }
    }

    /// The steps that were tried.
    pub fn iterations(&self) -> &[Iteration] {
        self.search.iterations()
    }

    /// The Schur complement where the solve stands, without damping, if there is one.
    pub fn schur_complement(&self) -> Option<DMatrix<f64>> {
        let (matrix, _) = self.search.system().clone().schur_complement(0.0).ok()?;
        Some(matrix)
    }

    fn keep(&mut self) {
        let values = self.search.values();
        let cameras = values.of_kind::<MovingCamera<PosedPinhole, 6>>();
        self.states.push(State {
            cameras: cameras.iter().map(|camera| camera.0).collect(),
            points: values.of_kind().to_vec(),
            cost: self.search.cost(),
            gradient_norm: self.search.system().gradient_norm(),
        });
    }

    /// A factor adds to the blocks of its camera and its point. What is left of them without the points
    /// is asked of the elimination.
    fn find_blocks(&mut self, rows: &[Option<usize>]) {
        let size = self.rows + self.scene.true_points.len();
        let mut whole = DMatrix::repeat(size, size, false);
        for factor in &self.scene.problem.factors {
            let point = self.rows + factor.point;
            whole[(point, point)] = true;
            if let Some(camera) = rows[factor.keyframe] {
                for place in [(camera, camera), (camera, point), (point, camera)] {
                    whole[place] = true;
                }
            }
        }
        self.whole = places(size).filter(|[row, column]| whole[(*row, *column)]).collect();
        let Some(matrix) = self.schur_complement() else { return };
        let is_there = |[row, column]: &[usize; 2]| {
            matrix.view((6 * row, 6 * column), (6, 6)).iter().any(|entry| *entry != 0.0)
        };
        self.reduced = places(self.rows).filter(is_there).collect();
    }
}

impl Run {
    fn count_shared_points(&mut self) {
        let problem = &self.scene.problem;
        let mut seen_by = vec![Vec::new(); problem.points.len()];
        for factor in problem.factors.iter().filter(|factor| !problem.fixed[factor.keyframe]) {
            seen_by[factor.point].push(factor.keyframe);
        }
        let shared = |[one, other]: [usize; 2]| {
            seen_by.iter().filter(|by| by.contains(&one) && by.contains(&other)).count()
        };
        let pairs = places(problem.cameras.len()).filter(|[one, other]| one < other);
        let counted = pairs.map(|pair| (pair, shared(pair)));
        self.covisible = counted.filter(|(_, count)| *count > 0).collect();
    }
}

/// All places of a square matrix.
fn places(size: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..size).flat_map(move |row| (0..size).map(move |column| [row, column]))
}

/// What can be said of a state.
impl Run {
    /// How far the first camera is from where it began, in metres.
    pub fn drift(&self, state: &State) -> f64 {
        (state.cameras[0].centre() - self.states[0].cameras[0].centre()).norm()
    }

    /// The distance from the first camera to the one that is truly the farthest, over the true one.
    pub fn size(&self, state: &State) -> f64 {
        let truth = &self.scene.true_cameras;
        let distance = |cameras: &[PosedPinhole], camera: usize| {
            (cameras[camera].centre() - cameras[0].centre()).norm()
        };
        let far =
            (1..truth.len()).max_by(|a, b| distance(truth, *a).total_cmp(&distance(truth, *b)));
        let far = far.unwrap_or(0);
        distance(&state.cameras, far) / distance(truth, far)
    }

    /// Root mean square of the errors in position of all cameras but the first rig, in metres, when the
    /// whole has been put where its first camera is right, and grown to the true size.
    pub fn camera_error(&self, state: &State) -> f64 {
        let truth = &self.scene.true_cameras;
        let back = state.cameras[0].camera_from_world.inverse() * truth[0].camera_from_world;
        let put = |camera: &PosedPinhole| PosedPinhole {
            camera_from_world: camera.camera_from_world * back,
            ..*camera
        };
        let put: Vec<_> = state.cameras.iter().map(put).collect();
        let rig = &self.scene.problem.rig;
        let pairs = at_true_scale(&put, truth).into_iter().zip(truth).zip(rig);
        let others = pairs.filter(|(_, rig)| **rig != 0);
        root_mean(others.map(|((one, other), _)| (one.centre() - other.centre()).norm_squared()))
    }

    /// Root of the mean squared length of the reprojection errors in pixels, of all matches or of those
    /// that are right.
    pub fn rmse(&self, state: &State, all: bool) -> f64 {
        let factors = self.scene.problem.factors.iter().enumerate();
        let counts =
            factors.filter(|(index, _)| all || self.scene.outliers.binary_search(index).is_err());
        root_mean(counts.map(|(_, factor)| {
            let pixel = state.cameras[factor.keyframe].project(&state.points[factor.point]);
            pixel.map_or(f64::NAN, |pixel| (pixel - factor.pixel).norm_squared())
        }))
    }
}

fn root_mean(squares: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    (sum / count).sqrt()
}

/// Cameras and then points, as variables.
fn values(cameras: &[PosedPinhole], points: &[Vector3<f64>]) -> Values {
    let mut values = Values::new();
    for camera in cameras {
        values.add(MovingCamera::<_, 6>(*camera));
    }
    for point in points {
        values.add(*point);
    }
    values
}
