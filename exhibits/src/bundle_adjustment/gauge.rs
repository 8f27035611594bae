//! The gauge, three ways.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector, Matrix3x6, SMatrix, Vector1, Vector3};
use vislam::bundle_adjustment::PosedPinhole;
use vislam::least_squares::Options;
use vislam::manifold::so3;
use vislam::simulation::Scene;
use vislam::two_views::scale_direction;

use super::whole::{Ba, at_truth, moved, solver};
use crate::chapter::Chapter;
use crate::comparison::differences;

pub const CAMERAS: usize = 8;
const POINTS: usize = 40;
const SEED: u64 = 3;
/// Steps of the shortest kind, from the start of the ring.
const SHORTEST_STEPS: usize = 12;

/// The twist of a camera when the whole scene is shifted, turned and grown.
pub fn seven(camera: &PosedPinhole) -> SMatrix<f64, 6, 7> {
    let mut directions = SMatrix::<f64, 6, 7>::zeros();
    directions.fixed_view_mut::<6, 6>(0, 0).fill_diagonal(-1.0);
    directions.set_column(6, &scale_direction(&camera.camera_from_world));
    directions
}

/// What takes out of an error its part along the columns of N, so that the rows of Cᵀ do not change.
pub fn projection(free: &DMatrix<f64>, held: &DMatrix<f64>) -> DMatrix<f64> {
    let along = held.tr_mul(free).try_inverse().expect("what is held is enough");
    DMatrix::identity(free.nrows(), free.nrows()) - free * along * held.transpose()
}

/// The covariance of the same estimate under the condition that the rows of Cᵀ do not change,
/// where the columns of N are free.
pub fn changed(
    covariance: &DMatrix<f64>,
    free: &DMatrix<f64>,
    held: &DMatrix<f64>,
) -> DMatrix<f64> {
    let projection = projection(free, held);
    &projection * covariance * projection.transpose()
}

/// How the solve ended.
pub struct Ended {
    pub problem: Ba,
    pub cost: f64,
}

fn solved(held: Option<usize>) -> Ended {
    let mut problem = Scene::ring(CAMERAS, POINTS, 1.0, SEED).problem;
    problem.fixed = (0..CAMERAS).map(|camera| Some(camera) == held).collect();
    let options = Options { decrease_tolerance: 1e-13, ..Options::default() };
    let report = problem.solve(&options).expect("damping makes every system regular");
    Ended { problem, cost: report.cost }
}

/// Nothing is held, and of all undamped steps the shortest is taken.
fn by_shortest_steps() -> Ended {
    let mut problem = Scene::ring(CAMERAS, POINTS, 1.0, SEED).problem;
    problem.fixed.fill(false);
    for _ in 0..SHORTEST_STEPS {
        let step = solver(&problem).minimal_norm_step().expect("every point has parallax");
        problem = moved(&problem, &step, 1.0);
    }
    let cost = solver(&problem).cost();
    Ended { problem, cost }
}

/// Camera 0 held, camera 4 held, nothing held but the steps damped, and the shortest steps.
pub fn ways() -> &'static [Ended; 4] {
    static WAYS: OnceLock<[Ended; 4]> = OnceLock::new();
    WAYS.get_or_init(|| [solved(Some(0)), solved(Some(4)), solved(None), by_shortest_steps()])
}

/// The angles in degrees of all triangles of camera centres.
fn angles(cameras: &[PosedPinhole]) -> Vec<f64> {
    let centres: Vec<_> = cameras.iter().map(PosedPinhole::centre).collect();
    let mut angles = Vec::new();
    for at in 0..centres.len() {
        for one in (0..centres.len()).filter(|one| *one != at) {
            for other in (0..one).filter(|other| *other != at) {
                angles.push(angle(&[centres[at], centres[one], centres[other]]).to_degrees());
            }
        }
    }
    angles
}

/// The angle at the first place between the two others.
fn angle([at, one, other]: &[Vector3<f64>; 3]) -> f64 {
    (one - at).angle(&(other - at))
}

/// How a camera's centre moves with its twist.
fn centre_slope(camera: &PosedPinhole) -> Matrix3x6<f64> {
    let mut slope = Matrix3x6::zeros();
    slope.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(-1.0);
    slope.fixed_view_mut::<3, 3>(0, 3).copy_from(&so3::hat(&camera.centre()));
    slope
}

/// The columns that hold a camera, and its distance from the camera opposite.
fn held(cameras: &[PosedPinhole], camera: usize) -> DMatrix<f64> {
    let opposite = (camera + CAMERAS / 2) % CAMERAS;
    let mut held = DMatrix::zeros(6 * cameras.len(), 7);
    held.view_mut((6 * camera, 0), (6, 6)).fill_with_identity();
    let arm = (cameras[opposite].centre() - cameras[camera].centre()).normalize();
    let along = centre_slope(&cameras[opposite]).tr_mul(&arm);
    held.view_mut((6 * opposite, 6), (6, 1)).copy_from(&along);
    held
}

/// Covariances of all cameras where the ring was solved.
pub struct Covariances {
    cameras: Vec<PosedPinhole>,
    /// With camera 0 held, with camera 4 held, with nothing held.
    pub by_gauge: [DMatrix<f64>; 3],
}

/// Those of the ring of the chapter.
pub fn covariances() -> &'static Covariances {
    static COVARIANCES: OnceLock<Covariances> = OnceLock::new();
    COVARIANCES.get_or_init(Covariances::of_ring)
}

impl Covariances {
    fn of_ring() -> Self {
        let mut problem = ways()[0].problem.clone();
        problem.fixed.fill(false);
        let solver = solver(&problem);
        let free = solver.null_space().expect("every point has parallax");
        let shortest = solver.minimal_norm_covariance().expect("every point has parallax").cameras;
        let cameras = problem.cameras;
        let pinned = |camera| changed(&shortest, &free, &held(&cameras, camera));
        let by_gauge = [pinned(0), pinned(4), shortest.clone()];
        Self { cameras, by_gauge }
    }

    /// Standard deviation of a camera's position in millimetres, over all three axes.
    pub fn position_mm(&self, gauge: usize, camera: usize) -> f64 {
        let block = self.by_gauge[gauge].fixed_view::<6, 6>(6 * camera, 6 * camera);
        let slope = centre_slope(&self.cameras[camera]);
        1e3 * (slope * block * slope.transpose()).trace().max(0.0).sqrt()
    }

    /// Standard deviation in milliradians of the angle at a camera between two others.
    fn angle_mrad(&self, gauge: usize, cameras: [usize; 3]) -> f64 {
        let centres = cameras.map(|camera| self.cameras[camera].centre());
        let mut slope = DVector::zeros(6 * self.cameras.len());
        for (place, camera) in cameras.into_iter().enumerate() {
            let along = differences(1e-6, |step| {
                let mut centres = centres;
                centres[place] += step;
                Vector1::new(angle(&centres))
            });
            let along = centre_slope(&self.cameras[camera]).tr_mul(&along.transpose());
            slope.fixed_rows_mut::<6>(6 * camera).copy_from(&along);
        }
        1e3 * slope.dot(&(&self.by_gauge[gauge] * &slope)).sqrt()
    }
}

/// The weakest direction that the pixels of a street see, as a fraction of the strongest.
fn weakest(cameras: usize) -> f64 {
    let truth = solver(&at_truth(&Scene::street(cameras, 2.5, 1.0, SEED)));
    let null_space = truth.problem().null_space(truth.values());
    null_space.expect("a gap").least_seen.unwrap_or(f64::NAN)
}

pub fn numbers(chapter: &mut Chapter) {
    let [short, long] = [100, 200].map(weakest);
    chapter.number("weakest_100", 1e6 * short, "", 0);
    chapter.number("weakest_200", 1e6 * long, "", 0);
    let longest = long * (200.0_f64 / 2000.0).powi(2);
    chapter.number("weakest_2000", 1e6 * longest, "", 2);
    chapter.number("weakest_2000_square", 1e14 * longest * longest, "", 0);

    let ring = Scene::ring(CAMERAS, POINTS, 1.0, SEED);
    let free = |fixed: bool| {
        let mut problem = ring.problem.clone();
        problem.fixed[0] = fixed;
        let free = solver(&problem).gauge_freedom().expect("every point has parallax");
        free.count() as f64
    };
    chapter.number("gauge_free", free(false), "", 0);
    chapter.number("gauge_pinned_free", free(true), "", 0);

    let ways = ways();
    chapter.number("gauge_cost", ways[0].cost, "", 3);
    let costs = ways.iter().map(|way| (way.cost - ways[0].cost).abs() / ways[0].cost);
    chapter.number("gauge_cost_exponent", exponent_above(costs), "", 0);
    let reference = angles(&ways[0].problem.cameras);
    let differences = ways.iter().flat_map(|way| {
        let angles = angles(&way.problem.cameras);
        angles.into_iter().zip(&reference).map(|(one, other)| (one - other).abs())
    });
    chapter.number("gauge_angles_exponent", exponent_above(differences), "", 0);
    chapter.number("gauge_triangles", reference.len() as f64 / 3.0, "", 0);

    let start = &ring.problem.cameras;
    let moved = |way: usize| {
        let camera = &ways[way].problem.cameras[0];
        1e3 * (camera.centre() - start[0].centre()).norm()
    };
    chapter.number("gauge_damped_mm", moved(2), "mm", 1);
    chapter.number("gauge_shortest_mm", moved(3), "mm", 1);
    let size = |cameras: &[PosedPinhole]| (cameras[0].centre() - cameras[4].centre()).norm();
    for (name, way) in
        [("gauge_pinned_across", 0), ("gauge_damped_across", 2), ("gauge_shortest_across", 3)]
    {
        chapter.number(name, size(&ways[way].problem.cameras), "m", 3);
    }

    let covariances = covariances();
    chapter.number("gauge_across_pinned_mm", covariances.position_mm(0, 4), "mm", 1);
    chapter.number("gauge_across_shortest_mm", covariances.position_mm(2, 4), "mm", 1);
    chapter.number("gauge_own_shortest_mm", covariances.position_mm(2, 0), "mm", 1);
    let at_three = [0, 1, 2].map(|gauge| covariances.angle_mrad(gauge, [3, 0, 5]));
    chapter.number("gauge_angle_mrad", at_three[0], "mrad", 3);
    let spread = at_three.iter().map(|sigma| (sigma / at_three[0] - 1.0).abs());
    chapter.number("gauge_angle_exponent", exponent_above(spread), "", 0);
}

/// The smallest power of ten that is above all of these.
fn exponent_above(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::MIN_POSITIVE, f64::max).log10().ceil()
}
