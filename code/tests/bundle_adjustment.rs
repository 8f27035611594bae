//! Worked examples of bundle adjustment.

use std::collections::BTreeSet;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix6, Rotation3, SMatrix, SVector, Vector2, Vector3, Vector6,
};
use vislam::bundle_adjustment::{
    BaError, BalCamera, Camera, GaugeFreedom, LinearizedPixel, Posed, PosedPinhole, Solver, TinyBa,
};
use vislam::factors::{MovingCamera, PixelByCamera, Prior};
use vislam::least_squares::{
    Covariance, Dense, Factor, Kernel, Key, LandmarkElimination, LinearSystem, Method, Options,
    Point, Problem, SolveError, Stop, Values,
};
use vislam::manifold::{se3, so3};
use vislam::reprojection::{DistortedPinhole, Pinhole, RadialTangential, ReprojFactor};
use vislam::simulation::{Scene, at_true_scale};

type Ba = TinyBa<PosedPinhole, 6>;

fn damped_by(initial_damping: f64) -> Options {
    let method = Method::LevenbergMarquardt { initial_damping };
    Options { method, ..Options::large_problem() }
}

fn pinhole() -> Pinhole {
    Pinhole::new(400.0, 400.0, 320.0, 240.0).expect("a valid camera")
}

fn solver(problem: &Ba) -> Solver<PosedPinhole, 6> {
    Solver::new(problem, &Options::large_problem()).expect("a problem")
}

/// The whole system H δ = −g, cameras first, without any elimination, for least squares.
/// The rows and columns of cameras that are fixed stay empty.
fn full_system<C: Camera<D>, const D: usize>(
    problem: &TinyBa<C, D>,
) -> (DMatrix<f64>, DVector<f64>) {
    let (cameras, points) = (problem.cameras.len(), problem.points.len());
    let size = D * cameras + 3 * points;
    let (mut h, mut g) = (DMatrix::zeros(size, size), DVector::zeros(size));
    for factor in &problem.factors {
        let view = problem.cameras[factor.keyframe].differentiate(&problem.points[factor.point]);
        let view = view.expect("a pixel");
        let mut jacobian = DMatrix::zeros(2, size);
        if !problem.fixed[factor.keyframe] {
            let rig = problem.rig[factor.keyframe];
            jacobian.view_mut((0, D * rig), (2, D)).copy_from(&view.by_camera);
        }
        jacobian.view_mut((0, D * cameras + 3 * factor.point), (2, 3)).copy_from(&view.by_point);
        jacobian *= factor.inverse_sigma;
        h += jacobian.transpose() * &jacobian;
        g += jacobian.transpose() * (factor.inverse_sigma * (view.pixel - factor.pixel));
    }
    (h, g)
}

/// The damped step of the whole system.
fn full_step<C: Camera<D>, const D: usize>(problem: &TinyBa<C, D>, damping: f64) -> DVector<f64> {
    let (mut h, g) = full_system(problem);
    for i in 0..h.nrows() {
        h[(i, i)] += damping * h[(i, i)];
        if h[(i, i)] == 0.0 {
            h[(i, i)] = 1.0; // a fixed camera
        }
    }
    h.cholesky().expect("positive definite").solve(&-g)
}

#[test]
fn the_ring_is_solved_to_the_noise() {
    let mut problem = Scene::ring(8, 40, 1.0, 1).problem;
    let report = problem.solve(&Options::large_problem()).unwrap();
    assert_eq!((report.full_dim, report.reduced_dim), (162, 42));
    assert!(matches!(report.stop, Stop::DecreaseSmall | Stop::PredictedDecreaseSmall));
    // 640 numbers of variance one, of which 161 are used up: 162 unknowns but one for scale.
    let expected = (479.0_f64 / 320.0).sqrt();
    assert_abs_diff_eq!(report.rmse_px, expected, epsilon = 0.15);
    assert_relative_eq!(report.cost, 160.0 * report.rmse_px.powi(2), max_relative = 1e-12);
    let gradient = solver(&problem).gradient_norm();
    assert!(gradient < 1e-4 * report.iterations[0].gradient_norm);
}

// ANCHOR: worked_example
#[test]
fn eliminating_the_points_does_not_change_the_step() {
    for seed in 0..20 {
        let problem = Scene::ring(8, 40, 1.0, seed).problem;
        for damping in [1e-4, 1e-2, 1.0] {
            let step = solver(&problem).step(damping).unwrap();
            let full = full_step(&problem, damping);
            let mut eliminated = DVector::zeros(full.len());
            for (k, change) in step.cameras.iter().enumerate() {
                eliminated.rows_mut(6 * k, 6).copy_from(change);
            }
            for (j, change) in step.points.iter().enumerate() {
                eliminated.rows_mut(48 + 3 * j, 3).copy_from(change);
            }
            assert!((&eliminated - &full).norm() < 1e-10 * full.norm());
        }
    }
}
// ANCHOR_END: worked_example

/// A camera on a rail along x that looks along z.
#[derive(Clone)]
struct OnRail(Vector3<f64>);

// ANCHOR: on_rail
impl Camera<1> for OnRail {
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        pinhole().project_cam(&(point_in_world - self.0))
    }

    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<LinearizedPixel<1>> {
        let by_point = pinhole().projection_jacobian(&(point_in_world - self.0))?;
        let pixel = self.project(point_in_world)?;
        // A twist moves the world, and the camera the other way.
        Some(LinearizedPixel { pixel, by_camera: by_point.column(0).into_owned(), by_point })
    }

    fn retract(&self, change: &SVector<f64, 1>) -> Self {
        Self(self.0 - change[0] * Vector3::x())
    }

    fn local(&self, to: &Self) -> SVector<f64, 1> {
        SVector::from([self.0.x - to.0.x])
    }

    fn local_jacobian(&self, _to: &Self) -> SMatrix<f64, 1, 1> {
        SMatrix::identity()
    }
}
// ANCHOR_END: on_rail

/// Four cameras around a point, two of them fixed and two on rails.
fn two_on_rails() -> TinyBa<OnRail, 1> {
    let places = [[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];
    let cameras = places.map(|[x, y]| OnRail(Vector3::new(x, y, 0.0))).to_vec();
    let point = Vector3::new(0.0, 0.0, 4.0);
    let factors = [0.0, 0.0, 3.0, 1.0_f64].into_iter().enumerate().map(|(keyframe, off)| {
        let pixel = cameras[keyframe].project(&point).unwrap() + off * Vector2::x();
        ReprojFactor::new(keyframe, 0, pixel, 1.0).unwrap()
    });
    let mut problem = TinyBa::new(cameras.clone(), vec![point], factors.collect());
    problem.fixed = vec![true, true, false, false];
    problem
}

// ANCHOR: by_hand
#[test]
fn two_cameras_on_rails_go_where_the_sum_by_hand_says() {
    let solver = Solver::new(&two_on_rails(), &Options::large_problem()).unwrap();
    let (s, rhs) = solver.schur_complement(0.0).unwrap();
    let by_hand = DMatrix::from_row_slice(2, 2, &[7500.0, -2500.0, -2500.0, 7500.0]);
    assert_abs_diff_eq!(s, by_hand, epsilon = 1e-9);
    assert_abs_diff_eq!(rhs, DVector::from_vec(vec![200.0, 0.0]), epsilon = 1e-9);

    let step = solver.step(0.0).unwrap();
    assert_abs_diff_eq!(step.cameras[2][0], 0.03, epsilon = 1e-12);
    assert_abs_diff_eq!(step.cameras[3][0], 0.01, epsilon = 1e-12);
    assert_abs_diff_eq!(step.points[0], Vector3::zeros(), epsilon = 1e-12);
    assert_abs_diff_eq!(step.cost, 0.0, epsilon = 1e-12);
}
// ANCHOR_END: by_hand

#[test]
fn a_sparse_schur_complement_gives_the_step_of_the_whole_system_too() {
    let problem = Scene::street(20, 2.5, 1.0, 2).problem;
    let solver = solver(&problem);
    let step = solver.step(1e-3).unwrap();
    let full = full_step(&problem, 1e-3);
    for camera in 1..20 {
        assert!((step.cameras[camera] - full.rows(6 * camera, 6)).norm() < 1e-10 * full.norm());
    }
}

/// A camera whose pose and focal length move.
#[derive(Clone)]
struct Zooming(BalCamera);

impl Camera<7> for Zooming {
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.0.project(point_in_world)
    }

    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<LinearizedPixel<7>> {
        let LinearizedPixel { pixel, by_camera, by_point } =
            Camera::<9>::differentiate(&self.0, point_in_world)?;
        Some(LinearizedPixel {
            pixel,
            by_camera: by_camera.fixed_columns::<7>(0).into_owned(),
            by_point,
        })
    }

    fn retract(&self, change: &SVector<f64, 7>) -> Self {
        let change = SVector::<f64, 9>::from_fn(|i, _| if i < 7 { change[i] } else { 0.0 });
        Self(self.0.retract(&change))
    }

    fn local(&self, to: &Self) -> SVector<f64, 7> {
        Camera::<9>::local(&self.0, &to.0).fixed_rows::<7>(0).into_owned()
    }

    fn local_jacobian(&self, to: &Self) -> SMatrix<f64, 7, 7> {
        Camera::<9>::local_jacobian(&self.0, &to.0).fixed_view::<7, 7>(0, 0).into_owned()
    }
}

#[test]
fn a_camera_may_move_in_any_number_of_directions() {
    let scene = Scene::ring(6, 30, 1.0, 24);
    let zooming = |camera: &PosedPinhole| {
        let pose = camera.camera_from_world;
        // The camera of the data sets looks backwards, with y up.
        let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let rotation = turn * pose.rotation.to_rotation_matrix();
        let translation = turn * pose.translation.vector;
        Zooming(BalCamera { rotation, translation, focal_length: 410.0, radial: [0.0; 2] })
    };
    let cameras = scene.problem.cameras.iter().map(zooming).collect();
    let mut factors = scene.problem.factors;
    for factor in &mut factors {
        factor.pixel = Vector2::new(factor.pixel.x - 320.0, 240.0 - factor.pixel.y);
    }
    let mut problem = TinyBa::new(cameras, scene.problem.points, factors);
    let step = Solver::new(&problem, &Options::large_problem()).unwrap().step(0.01).unwrap();
    let full = full_step(&problem, 0.01);
    for camera in 0..6 {
        assert!((step.cameras[camera] - full.rows(7 * camera, 7)).norm() < 1e-10 * full.norm());
    }
    let report =
        problem.solve(&Options { max_iterations: 200, ..Options::large_problem() }).unwrap();
    assert!(report.rmse_px < 1.5);
    assert_abs_diff_eq!(problem.cameras[0].0.focal_length, 400.0, epsilon = 20.0);
}

#[test]
fn a_point_that_one_camera_sees_tells_nothing_about_it() {
    let problem = Scene::ring(4, 12, 1.0, 30).problem;
    let mut jacobians = problem.factors.iter().map(|factor| {
        let camera = &problem.cameras[factor.keyframe];
        camera.differentiate(&problem.points[factor.point]).unwrap()
    });
    assert!(jacobians.all(|view| {
        let inverse = (view.by_point.tr_mul(&view.by_point)).pseudo_inverse(1e-6).unwrap();
        let coupling = view.by_camera.tr_mul(&view.by_point);
        let alone = view.by_camera.tr_mul(&view.by_camera);
        (alone - coupling * inverse * coupling.transpose()).norm() < 1e-9 * alone.norm()
    }));
}

#[test]
fn a_rig_of_two_cameras_takes_the_step_of_the_whole_system_too() {
    let problem = Scene::stereo_ring(6, 25, 0.1, 1.0, 3).problem;
    let step = solver(&problem).step(0.0).unwrap();
    let full = full_step(&problem, 0.0);
    for camera in 0..12 {
        let expected = full.rows(6 * (camera / 2), 6);
        assert!((step.cameras[camera] - expected).norm() < 1e-8 * full.norm());
    }
    for point in 0..25 {
        assert!((step.points[point] - full.rows(72 + 3 * point, 3)).norm() < 1e-8 * full.norm());
    }
}

// ANCHOR: lowers
#[test]
fn an_undamped_step_lowers_the_cost_as_predicted() {
    for seed in 0..20 {
        let problem = Scene::stereo_ring(8, 40, 0.1, 1.0, seed).problem;
        let solver = solver(&problem);
        let step = solver.step(0.0).unwrap();
        assert!(step.cost < solver.cost());
        // The linearized problem predicts half of −g·δ.
        let (_, g) = full_system(&problem);
        let full = full_step(&problem, 0.0);
        assert_relative_eq!(step.predicted_decrease, -0.5 * g.dot(&full), max_relative = 1e-9);
    }
}
// ANCHOR_END: lowers

#[test]
fn the_predicted_decrease_of_a_damped_step_is_that_of_the_undamped_model() {
    let problem = Scene::ring(8, 40, 1.0, 4).problem;
    let step = solver(&problem).step(0.1).unwrap();
    let (h, g) = full_system(&problem);
    let full = full_step(&problem, 0.1);
    let predicted = -g.dot(&full) - 0.5 * full.dot(&(&h * &full));
    assert_relative_eq!(step.predicted_decrease, predicted, max_relative = 1e-9);
}

#[test]
fn the_schur_complement_is_as_sparse_as_covisibility() {
    let problem = Scene::street(30, 2.5, 1.0, 5).problem;
    let solver = solver(&problem);
    let (schur, _) = solver.schur_complement(0.0).unwrap();
    let rows = solver.rows();
    let mut seen_by = vec![BTreeSet::new(); problem.points.len()];
    for factor in &problem.factors {
        seen_by[factor.point].extend(rows[factor.keyframe]);
    }
    seen_by.iter_mut().filter(|cameras| cameras.len() < 2).for_each(BTreeSet::clear);
    let count = rows.iter().flatten().count();
    let mut pairs = 0;
    for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
        let covisible = seen_by.iter().any(|cameras| cameras.contains(&i) && cameras.contains(&j));
        let block = schur.view((6 * i, 6 * j), (6, 6));
        assert_eq!(block.iter().any(|entry| *entry != 0.0), covisible, "cameras {i} and {j}");
        pairs += usize::from(covisible);
    }
    assert!(pairs < count * count / 3);
}

#[test]
fn the_number_of_block_products_is_what_covisibility_predicts() {
    let mut problem = Scene::street(30, 2.5, 1.0, 6).problem;
    let mut moving = vec![0; problem.points.len()];
    for factor in problem.factors.iter().filter(|factor| factor.keyframe != 0) {
        moving[factor.point] += 1;
    }
    let predicted: usize = moving.iter().map(|n| n * (n + 1) / 2).sum();
    assert_eq!(problem.solve(&Options::large_problem()).unwrap().block_products, predicted);
    let mut ring = Scene::ring(8, 40, 1.0, 6).problem;
    assert_eq!(ring.solve(&Options::large_problem()).unwrap().block_products, 40 * 28);
}

#[test]
fn growing_the_scene_about_the_fixed_camera_changes_no_pixel() {
    let scene = Scene::ring(8, 40, 0.0, 7);
    let problem = Ba {
        cameras: scene.true_cameras.clone(),
        points: scene.true_points.clone(),
        ..scene.problem
    };
    let (h, _) = full_system(&problem);
    let fixed = problem.cameras[0].centre();
    let mut growth = DVector::zeros(h.nrows());
    for (k, camera) in problem.cameras.iter().enumerate().skip(1) {
        // The camera's centre is moved by −ρ when the world is.
        growth.rows_mut(6 * k, 3).copy_from(&(fixed - camera.centre()));
    }
    for (j, point) in problem.points.iter().enumerate() {
        growth.rows_mut(48 + 3 * j, 3).copy_from(&(point - fixed));
    }
    assert!((&h * &growth).norm() < 1e-12 * h.norm() * growth.norm());
    let (schur, _) = solver(&problem).schur_complement(0.0).unwrap();
    let growth = growth.rows(6, 42);
    assert!((&schur * growth).norm() < 1e-12 * h.norm() * growth.norm());
}

#[test]
fn a_single_moving_camera_does_not_know_scale_and_the_error_says_so() {
    let mut problem = Scene::ring(8, 40, 1.0, 8).problem;
    let error = solver(&problem).step(0.0).unwrap_err();
    let free = GaugeFreedom { scale: 1, ..GaugeFreedom::default() };
    assert_eq!(error, BaError::RankDeficient { free });
    assert_eq!(
        error.to_string(),
        "no pixel changes in 1 of the directions in which the cameras move: scale is free: \
         pin one more thing, add stereo or an IMU"
    );
    assert_eq!(solver(&problem).covariance().unwrap_err(), error);

    problem.fixed[0] = false;
    let error = solver(&problem).step(0.0).unwrap_err();
    let free = GaugeFreedom { position: 3, orientation: 3, scale: 1, other: 0 };
    assert_eq!(error, BaError::RankDeficient { free });
    assert!(error.to_string().contains("position, orientation, scale are free"));
}

#[test]
fn a_stereo_rig_knows_scale_and_not_where_it_is() {
    let mut problem = Scene::stereo_ring(8, 40, 0.1, 1.0, 9).problem;
    assert!(solver(&problem).step(0.0).is_ok());
    assert_eq!(solver(&problem).gauge_freedom().unwrap().count(), 0);
    problem.fixed.fill(false);
    let free = GaugeFreedom { position: 3, orientation: 3, ..GaugeFreedom::default() };
    assert_eq!(solver(&problem).step(0.0).unwrap_err(), BaError::RankDeficient { free });
}

/// A street with camera 0 held, open or closed, at the truth.
fn street_at_truth(cameras: usize, is_closed: bool) -> Ba {
    let street = if is_closed { Scene::closed_street } else { Scene::street };
    let Scene { problem, true_cameras, true_points, .. } = street(cameras, 2.5, 1.0, 31);
    Ba { cameras: true_cameras, points: true_points, ..problem }
}

/// Pixels of a street leave free how large it is, and nothing else, however far it goes.
fn assert_that_only_scale_is_free(cameras: usize) {
    let free = GaugeFreedom { scale: 1, ..GaugeFreedom::default() };
    for is_closed in [false, true] {
        let solver = solver(&street_at_truth(cameras, is_closed));
        assert_eq!(solver.gauge_freedom().unwrap(), free, "{cameras}, closed: {is_closed}");
        assert_eq!(solver.step(0.0).unwrap_err(), BaError::RankDeficient { free });
    }
}

#[test]
fn scale_is_free_on_streets_of_50_and_400_cameras_and_nothing_else() {
    assert_that_only_scale_is_free(50);
    assert_that_only_scale_is_free(400);
}

#[test]
fn a_street_that_nothing_holds_is_free_in_the_seven_ways_and_a_camera_that_sees_little_in_others() {
    let mut street = street_at_truth(100, false);
    street.fixed.fill(false);
    let free = GaugeFreedom { position: 3, orientation: 3, scale: 1, other: 0 };
    assert_eq!(solver(&street).gauge_freedom().unwrap(), free);
    // Two pixels for six coordinates.
    let mut seen = 0;
    street.factors.retain(|factor| factor.keyframe != 50 || std::mem::replace(&mut seen, 1) == 0);
    let free = GaugeFreedom { other: 4, ..free };
    assert_eq!(solver(&street).gauge_freedom().unwrap(), free);
}

#[test]
#[ignore = "takes a while: 2,000 cameras and 20,000 points, twice"]
fn scale_is_free_on_a_street_of_2000_cameras_and_nothing_else() {
    assert_that_only_scale_is_free(2000);
    let (problem, ..) = of_factors(&street_at_truth(2000, false));
    println!("{:?}", problem.null_space(problem.values()).unwrap().least_seen);
}

fn stored_blocks(problem: &Ba) -> usize {
    solver(problem).report(Stop::IterationLimit).stored_blocks
}

#[test]
fn a_street_that_comes_back_stores_less_than_twice_the_blocks() {
    for cameras in [50, 200, 800] {
        let [open, closed] = [false, true].map(|is| stored_blocks(&street_at_truth(cameras, is)));
        assert!(closed < 2 * open, "{closed} against {open}");
    }
}

#[test]
fn a_street_whose_cameras_are_numbered_in_no_order_is_stored_as_a_band() {
    for is_closed in [false, true] {
        let ordered = street_at_truth(200, is_closed);
        let mut shuffled = ordered.clone();
        // 77 has no divisor in common with 199, so every camera but the first gets a new number.
        let new = |camera: usize| if camera == 0 { 0 } else { 1 + 77 * (camera - 1) % 199 };
        for (camera, pose) in ordered.cameras.iter().enumerate() {
            shuffled.cameras[new(camera)] = *pose;
        }
        shuffled.factors.iter_mut().for_each(|factor| factor.keyframe = new(factor.keyframe));
        let [stored, in_order] = [&shuffled, &ordered].map(stored_blocks);
        assert!(stored < in_order + in_order / 4, "{stored} against {in_order}");
        let [step, expected] = [&shuffled, &ordered].map(|ba| solver(ba).step(1e-3).unwrap());
        for camera in 1..200 {
            let difference = step.cameras[new(camera)] - expected.cameras[camera];
            assert!(difference.norm() < 1e-7 * expected.cameras[camera].norm());
        }
    }
}

type CameraKey = Key<MovingCamera<PosedPinhole, 6>>;

/// The same problem made of variables and factors by hand, with points that are seen once left
/// out.
fn of_factors(ba: &Ba) -> (Problem, Vec<CameraKey>, Vec<Key<Vector3<f64>>>) {
    let mut problem = Problem::new();
    let cameras: Vec<_> =
        ba.cameras.iter().map(|camera| problem.add_variable(MovingCamera(*camera))).collect();
    let points: Vec<_> = ba.points.iter().map(|point| problem.add_variable(*point)).collect();
    for (camera, _) in cameras.iter().zip(&ba.fixed).filter(|(_, fixed)| **fixed) {
        problem.hold(*camera).unwrap();
    }
    for (point, key) in points.iter().enumerate() {
        let seen: Vec<_> = ba.factors.iter().filter(|factor| factor.point == point).collect();
        if seen.len() < 2 {
            problem.hold(*key).unwrap();
            continue;
        }
        for ReprojFactor { keyframe, pixel, inverse_sigma, .. } in seen.into_iter().copied() {
            let factor =
                PixelByCamera { camera: cameras[keyframe], landmark: *key, pixel, inverse_sigma };
            problem.add_factor(factor, Kernel::Squared).unwrap();
        }
    }
    (problem, cameras, points)
}

fn elimination(problem: &Problem) -> LandmarkElimination<6> {
    LandmarkElimination::new::<Vector3<f64>>(problem).unwrap()
}

/// Solves with the dense system and with the landmarks eliminated, and gives both values.
fn solved_both_ways(problem: &mut Problem) -> [Values; 2] {
    let options = Options::default();
    let coarse = problem.solve(&options).unwrap().values;
    problem.set_values(coarse).unwrap();
    let last = Options { max_iterations: 3, ..Options::gauss_newton() };
    let dense = problem.solve(&last).unwrap().values;
    let eliminated = problem.solve_with(elimination(problem), &last).unwrap().values;
    [dense, eliminated]
}

#[test]
fn dense_and_eliminated_equations_have_one_solution_and_one_covariance() {
    for scene in [Scene::ring(8, 40, 1.0, 32), Scene::street(12, 2.5, 1.0, 33)] {
        let (mut problem, cameras, points) = of_factors(&scene.problem);
        // What is known of camera 1 beforehand says how large everything is.
        let anchor = MovingCamera(scene.true_cameras[1]);
        let sqrt_information = Matrix6::from_diagonal_element(1.0 / 0.02);
        let prior = Prior { variable: cameras[1], anchor, sqrt_information };
        problem.add_factor(prior, Kernel::Squared).unwrap();
        let [dense, eliminated] = solved_both_ways(&mut problem);
        let covariance = problem.covariance(&dense).unwrap();
        let columns = problem.columns();
        for (apart, column) in dense.local(&eliminated).into_iter().zip(columns.of) {
            let sigma = column.map_or(0.0, |c| covariance.matrix()[(c, c)].sqrt());
            assert!(apart.abs() <= 1e-6 * sigma);
        }

        let least_seen = problem.null_space(&dense).unwrap().least_seen.unwrap();
        let tolerance = 10.0 * f64::EPSILON / (least_seen * least_seen);
        assert!(tolerance < 1e-4);
        let at = Point { values: &dense, frozen: None };
        let systems: [Box<dyn LinearSystem>; 2] =
            [Box::new(Dense::new(&problem).unwrap()), Box::new(elimination(&problem))];
        let [one, other] = systems.map(|mut system| system.covariance(&problem, at).unwrap());
        assert_eq!(one, covariance);
        for camera in &cameras[1..] {
            let (one, other) = (one.of(*camera).unwrap(), other.of(*camera).unwrap());
            assert_same_covariance(&other, &one, tolerance);
        }
        let pair = (cameras[2], cameras[5]);
        let across = |covariance: &Covariance| covariance.between(pair.0, pair.1).unwrap();
        let size = one.of(pair.0).unwrap().norm() + one.of(pair.1).unwrap().norm();
        assert!((across(&one) - across(&other)).norm() < tolerance * size);
        for point in points {
            assert_eq!(one.of(point).is_some(), other.of(point).is_some());
            if let (Some(one), Some(other)) = (one.of(point), other.of(point)) {
                assert_same_covariance(&other, &one, tolerance);
            }
        }
    }
}

/// Entries differ by no more than a part of the standard deviations to which they belong.
fn assert_same_covariance(one: &DMatrix<f64>, other: &DMatrix<f64>, tolerance: f64) {
    for (row, column) in (0..one.nrows()).flat_map(|r| (0..one.ncols()).map(move |c| (r, c))) {
        let size = (other[(row, row)] * other[(column, column)]).sqrt();
        assert!((one[(row, column)] - other[(row, column)]).abs() <= tolerance * size);
    }
}

#[test]
fn a_bundle_adjustment_is_the_problem_of_its_factors() {
    for mut scene in [Scene::ring(8, 40, 1.0, 34), Scene::street(12, 2.5, 1.0, 35)] {
        scene.problem.cameras[1] = scene.true_cameras[1];
        scene.problem.fixed[1] = true;
        let (mut problem, cameras, points) = of_factors(&scene.problem);
        let [dense, _] = solved_both_ways(&mut problem);
        let precise = Options { decrease_tolerance: 1e-15, ..Options::default() };
        scene.problem.solve(&precise).unwrap();
        let covariance = problem.covariance(&dense).unwrap();
        let own = solver(&scene.problem).covariance().unwrap();
        for (index, key) in cameras.iter().enumerate().skip(2) {
            let expected = covariance.of(*key).unwrap();
            let apart = dense[*key].0.local(&scene.problem.cameras[index]);
            for axis in 0..6 {
                assert!(apart[axis].abs() < 1e-4 * expected[(axis, axis)].sqrt());
            }
            let found = own.camera(index).unwrap();
            let found = DMatrix::from_column_slice(6, 6, found.as_slice());
            assert_same_covariance(&found, &expected, 1e-4);
        }
        for (index, key) in points.iter().enumerate() {
            let Some(expected) = covariance.of(*key) else { continue };
            let found = own.point(index).unwrap();
            let found = DMatrix::from_column_slice(3, 3, found.as_slice());
            assert_same_covariance(&found, &expected, 1e-4);
        }
    }
}

#[test]
fn what_pixels_hardly_see_of_a_street_fades_with_the_square_of_its_length() {
    let least_seen = |cameras| {
        let (problem, ..) = of_factors(&street_at_truth(cameras, false));
        problem.null_space(problem.values()).unwrap().least_seen.unwrap()
    };
    let [short, middle, long] = [50, 100, 200].map(least_seen);
    println!("least singular values {short:.2e}, {middle:.2e}, {long:.2e}");
    assert!((3.0..5.5).contains(&(short / middle)) && (3.0..5.5).contains(&(middle / long)));
}

#[test]
fn the_minimal_norm_covariance_of_a_street_keeps_the_weakest_direction_that_pixels_see() {
    let street = street_at_truth(30, false);
    let (problem, cameras, points) = of_factors(&street);
    let (jacobian, _) = problem.jacobian(problem.values()).unwrap();
    let (rows, size) = jacobian.shape();
    // Growth about camera 0, which stands in the origin.
    let mut growth = DVector::zeros(size);
    let columns = problem.columns();
    let column = |index| columns.of[problem.values().coordinates_of(index).unwrap().start];
    for (key, camera) in cameras.iter().zip(&street.cameras).skip(1) {
        growth.fixed_rows_mut::<3>(column(key.index()).unwrap()).copy_from(&-camera.centre());
    }
    for (key, point) in points.iter().zip(&street.points) {
        let Some(column) = column(key.index()) else { continue };
        growth.fixed_rows_mut::<3>(column).copy_from(point);
    }
    assert!((&jacobian * &growth).norm() < 1e-12 * jacobian.norm() * growth.norm());
    // With growth measured too, nothing is free; then it is taken away.
    let unit = growth.normalize();
    let mut whole = jacobian.insert_row(rows, 0.0);
    whole.row_mut(rows).tr_copy_from(&(jacobian_size(&street) * &unit));
    let root = whole.qr().unpack_r().try_inverse().unwrap();
    let moving = 6 * 29;
    let of_cameras = root.rows(0, moving).into_owned();
    let growth = growth.rows(0, moving).normalize();
    let projected = &of_cameras - &growth * growth.tr_mul(&of_cameras);
    let expected = &projected * projected.transpose();

    let found = solver(&street).minimal_norm_covariance().unwrap().cameras;
    assert!((&found - &expected).norm() < 1e-6 * expected.norm());
    let weakest = |matrix: &DMatrix<f64>| matrix.symmetric_eigenvalues().max();
    assert_relative_eq!(weakest(&found), weakest(&expected), max_relative = 1e-6);
}

#[test]
fn a_street_of_200_cameras_keeps_all_directions_but_the_free_one() {
    let solver = solver(&street_at_truth(200, false));
    let covariance = solver.minimal_norm_covariance().unwrap().cameras;
    let (schur, _) = solver.schur_complement(0.0).unwrap();
    let free = solver.null_space().unwrap().column(0).normalize();
    // With its inverse the Schur complement makes a one of each direction that is seen.
    let traced = schur.component_mul(&covariance).sum();
    assert_abs_diff_eq!(traced, (schur.nrows() - 1) as f64, epsilon = 1e-3);
    assert!((&covariance * free).norm() < 1e-8 * covariance.norm());
}

#[test]
fn landmarks_that_are_tied_are_refused_and_the_dense_system_takes_them() {
    let (mut problem, _, points) = of_factors(&Scene::stereo_ring(5, 20, 0.2, 1.0, 37).problem);
    problem.tie(points[3], points[7]).unwrap();
    let refused = LandmarkElimination::<6>::new::<Vector3<f64>>(&problem).unwrap_err();
    let variable = points[7].index();
    assert_eq!(refused, SolveError::TiedLandmark { variable });
    assert!(refused.to_string().starts_with(&format!("landmark {variable} is tied")));
    assert!(Dense::new(&problem).is_ok());
    problem.hold(points[3]).unwrap();
    assert!(LandmarkElimination::<6>::new::<Vector3<f64>>(&problem).is_ok(), "they do not move");
}

/// About the largest length of a column of a street's Jacobian.
fn jacobian_size(street: &Ba) -> f64 {
    let (h, _) = full_system(&Ba { factors: street.factors[..100].to_vec(), ..street.clone() });
    h.diagonal().max().sqrt()
}

#[test]
fn cameras_with_a_lens_are_adjusted_too() {
    let scene = Scene::ring(8, 40, 0.0, 36);
    let lens = RadialTangential::new(-0.2, 0.05, 0.0, 0.0, 0.0).unwrap();
    let with_lens = |camera: &PosedPinhole| Posed {
        intrinsics: DistortedPinhole { pinhole: camera.intrinsics, lens },
        camera_from_world: camera.camera_from_world,
    };
    let truth: Vec<_> = scene.true_cameras.iter().map(with_lens).collect();
    let cameras = scene.problem.cameras.iter().map(with_lens).collect();
    let mut factors = scene.problem.factors;
    for factor in &mut factors {
        factor.pixel = truth[factor.keyframe].project(&scene.true_points[factor.point]).unwrap();
    }
    let mut problem = TinyBa::new(cameras, scene.problem.points, factors);
    problem.fixed[0] = true;
    let options = Options { decrease_tolerance: 1e-12, ..Options::large_problem() };
    let report = problem.solve(&options).unwrap();
    assert!(report.stop.is_convergence() && report.rmse_px < 1e-6, "{report:?}");
    let free = Solver::new(&problem, &options).unwrap().gauge_freedom().unwrap();
    assert_eq!(free, GaugeFreedom { scale: 1, ..GaugeFreedom::default() });
}

#[test]
fn a_second_fixed_camera_fixes_scale() {
    let scene = Scene::ring(8, 40, 1.0, 10);
    let mut problem = scene.problem;
    problem.cameras[1] = scene.true_cameras[1];
    problem.fixed[1] = true;
    let report = problem.solve(&Options::large_problem()).unwrap();
    assert_eq!(report.reduced_dim, 36);
    assert!(solver(&problem).covariance().is_ok());
}

#[test]
fn damping_and_minimal_norm_agree_on_all_that_pixels_see() {
    let problem = Scene::ring(8, 40, 1.0, 11).problem;
    let minimal = solver(&problem).minimal_norm_step().unwrap();
    let damped = solver(&problem).step(1e-9).unwrap();
    let stack = |cameras: &[Vector6<f64>]| {
        DVector::from_iterator(42, cameras[1..].iter().flat_map(|c| c.iter().copied()))
    };
    let difference = stack(&minimal.cameras) - stack(&damped.cameras);
    let null_space = solver(&problem).null_space().unwrap();
    let scale = null_space.column(0).normalize();
    let unseen = &scale * scale.dot(&difference);
    assert!((&difference - unseen).norm() < 1e-5 * stack(&minimal.cameras).norm());
    assert_abs_diff_eq!(scale.dot(&stack(&minimal.cameras)), 0.0, epsilon = 1e-8);
    assert_relative_eq!(minimal.predicted_decrease, damped.predicted_decrease, max_relative = 1e-6);
}

#[test]
fn covariances_are_blocks_of_the_inverse_of_the_whole_system() {
    let problem = Scene::stereo_ring(5, 20, 0.2, 1.0, 12).problem;
    let covariance = solver(&problem).covariance().unwrap();
    let (mut h, _) = full_system(&problem);
    for i in 0..h.nrows() {
        if h[(i, i)] == 0.0 {
            h[(i, i)] = 1.0;
        }
    }
    let inverse = h.try_inverse().unwrap();
    assert_eq!(covariance.camera(0), None);
    assert_eq!(covariance.camera(99), None);
    for camera in 2..10 {
        let block = inverse.fixed_view::<6, 6>(6 * (camera / 2), 6 * (camera / 2));
        let difference = covariance.camera(camera).unwrap() - block;
        assert!(difference.norm() < 1e-8 * block.norm());
    }
    for point in 0..20 {
        let block = inverse.fixed_view::<3, 3>(60 + 3 * point, 60 + 3 * point);
        let difference = covariance.point(point).unwrap() - block;
        assert!(difference.norm() < 1e-8 * block.norm());
    }
}

#[test]
fn the_errors_of_500_rings_are_as_large_as_their_covariances_say() {
    // With camera 0 fixed and scale taken from the truth, 41 directions are left.
    let (runs, degrees) = (500, 41.0);
    let mut errors = Vec::new();
    for seed in 0..runs {
        let mut scene = Scene::ring(8, 40, 1.0, seed);
        let options = Options { decrease_tolerance: 1e-10, ..Options::large_problem() };
        scene.problem.solve(&options).unwrap();
        scene.problem.cameras = at_true_scale(&scene.problem.cameras, &scene.true_cameras);
        // The information is singular along scale, so what is left of that error is ignored.
        let truth =
            Ba { points: scene.true_points, cameras: scene.true_cameras, ..scene.problem.clone() };
        let (information, _) = solver(&truth).schur_complement(0.0).unwrap();
        let pairs = truth.cameras.iter().zip(&scene.problem.cameras).skip(1);
        let error = DVector::from_iterator(
            42,
            pairs.flat_map(|(truth, estimate)| {
                let error = se3::local(&truth.camera_from_world, &estimate.camera_from_world);
                error.iter().copied().collect::<Vec<_>>()
            }),
        );
        errors.push(error.dot(&(&information * &error)));
    }
    let mean = errors.iter().sum::<f64>() / runs as f64;
    // The mean of 500 has 20500 degrees of freedom: nearly normal. 3.29 sigma are 99.9 %.
    let band = 3.29 * (2.0 * degrees / runs as f64).sqrt();
    println!("mean normalized error {mean:.2} of {degrees} ± {band:.2}");
    assert!((mean - degrees).abs() < band, "mean {mean}");
    // The 2.5 % and 97.5 % quantiles of chi-square with 41 degrees of freedom.
    let inside = errors.iter().filter(|error| (25.215..60.561).contains(*error)).count();
    let share = inside as f64 / runs as f64;
    println!("{share:.3} of the runs in their 95 % band");
    assert!((0.93..=0.97).contains(&share), "{share}");
}

#[test]
fn huber_keeps_outliers_from_bending_the_ring() {
    for seed in 0..5 {
        let scene = Scene::ring(8, 40, 1.0, seed).with_outliers(0.1, 30.0, seed + 100);
        assert!((15..60).contains(&scene.outliers.len()));
        let worst = |huber| {
            let mut problem = Ba { huber, ..scene.problem.clone() };
            problem.solve(&Options { max_iterations: 100, ..Options::large_problem() }).unwrap();
            let cameras = at_true_scale(&problem.cameras, &scene.true_cameras);
            let errors = cameras.iter().zip(&scene.true_cameras);
            errors.map(|(e, t)| (e.centre() - t.centre()).norm()).fold(0.0, f64::max)
        };
        let (squared, robust) = (worst(None), worst(Some(1.5)));
        assert!(robust < 0.6 * squared, "{robust} against {squared}");
    }
}

#[test]
fn every_accepted_step_lowers_the_cost_also_with_huber() {
    for huber in [None, Some(1.5)] {
        let scene = Scene::ring(8, 40, 1.0, 13).with_outliers(0.1, 30.0, 14);
        let mut problem = Ba { huber, ..scene.problem };
        let report = problem.solve(&Options::large_problem()).unwrap();
        let mut accepted = report.iterations.iter().filter(|step| step.accepted);
        assert!(accepted.all(|step| step.trial_cost.unwrap() < step.cost));
        assert!(report.iterations.windows(2).all(|pair| pair[1].cost <= pair[0].cost));
        assert!(report.cost <= report.iterations.last().unwrap().cost);
        assert!(report.iterations.len() < 30);
    }
}

#[test]
fn the_scaled_gradient_is_that_of_the_cost_also_beyond_the_threshold() {
    let scene = Scene::ring(4, 12, 1.0, 25).with_outliers(0.2, 30.0, 26);
    let problem = Ba { huber: Some(1.5), ..scene.problem };
    let step = 1e-6;
    // The curvature has the weights that the kernel gives.
    let mut weighted = problem.clone();
    for factor in &mut weighted.factors {
        let pixel = problem.cameras[factor.keyframe].project(&problem.points[factor.point]);
        let norm = factor.residual(&pixel.unwrap()).norm();
        factor.inverse_sigma *= (1.5 / norm).min(1.0).sqrt();
    }
    let (curvature, _) = full_system(&weighted);
    let mut squares = 0.0;
    let mut add = |unknown: usize, change: &dyn Fn(&mut Ba, f64)| {
        let cost = |sign: f64| {
            let mut moved = problem.clone();
            change(&mut moved, sign * step);
            solver(&moved).cost()
        };
        let slope = (cost(1.0) - cost(-1.0)) / (2.0 * step);
        squares += slope * slope / curvature[(unknown, unknown)];
    };
    for (index, axis) in (1..4).flat_map(|k| (0..6).map(move |axis| (k, axis))) {
        add(6 * index + axis, &|p, step| {
            p.cameras[index] = p.cameras[index].retract(&Vector6::ith(axis, step));
        });
    }
    for (index, axis) in (0..12).flat_map(|j| (0..3).map(move |axis| (j, axis))) {
        add(24 + 3 * index + axis, &|p, step| p.points[index][axis] += step);
    }
    let mut solver = solver(&problem);
    solver.iterate().unwrap();
    assert_relative_eq!(solver.iterations()[0].gradient_norm, squares.sqrt(), max_relative = 1e-5);
}

#[test]
fn a_solve_that_starts_with_too_little_damping_finds_the_damping_it_needs() {
    let mut problem = Scene::ring(8, 40, 1.0, 5).problem;
    let reference = problem.clone().solve(&Options::large_problem()).unwrap();
    let report = problem.solve(&damped_by(1e-300)).unwrap();
    // Scale is free, so the first systems had no inverse and there was no step to try.
    assert!(report.iterations[0].damping > 1e-12);
    assert_relative_eq!(report.cost, reference.cost, max_relative = 1e-6);
}

#[test]
fn the_blocks_of_a_street_grow_like_its_length() {
    let blocks = |cameras| {
        let report = Scene::street(cameras, 2.5, 1.0, 28).problem.solve(&Options::large_problem());
        report.unwrap().stored_blocks
    };
    assert!(blocks(100) < 5 * 99);
    assert!(blocks(200) < 5 * 199);
}

#[test]
fn no_memory_is_taken_while_iterating() {
    let problem = Scene::ring(8, 40, 1.0, 29).problem;
    let mut solver = solver(&problem);
    let before = solver.bytes();
    while solver.iterate().unwrap().is_none() {}
    assert_eq!(solver.bytes(), before);
}

#[test]
fn the_iteration_limit_is_kept_and_named() {
    let mut problem = Scene::ring(8, 40, 1.0, 15).problem;
    let report = problem.solve(&Options { max_iterations: 1, ..Options::large_problem() }).unwrap();
    assert_eq!((report.iterations.len(), report.stop), (1, Stop::IterationLimit));
    let before = problem.clone();
    let report = problem.solve(&Options { max_iterations: 0, ..Options::large_problem() }).unwrap();
    assert_eq!((report.iterations.len(), report.cost), (0, solver(&before).cost()));
    assert_eq!(problem, before);
}

#[test]
fn the_truth_is_a_minimum_of_noiseless_pixels() {
    let scene = Scene::ring(8, 40, 0.0, 16);
    let mut problem = scene.problem;
    problem.solve(&Options { decrease_tolerance: 1e-12, ..Options::large_problem() }).unwrap();
    let cameras = at_true_scale(&problem.cameras, &scene.true_cameras);
    for (camera, truth) in cameras.iter().zip(&scene.true_cameras) {
        assert_abs_diff_eq!(camera.centre(), truth.centre(), epsilon = 1e-6);
    }
}

/// Derivatives by central differences, and those of the camera.
fn assert_derivatives<C: Camera<D>, const D: usize>(camera: &C, point: &Vector3<f64>) {
    let view = camera.differentiate(point).unwrap();
    assert_abs_diff_eq!(view.pixel, camera.project(point).unwrap(), epsilon = 1e-10);
    let step = 1e-5;
    for axis in 0..D {
        let moved = |sign: f64| {
            let change =
                SVector::<f64, D>::from_fn(|i, _| if i == axis { sign * step } else { 0.0 });
            camera.retract(&change).project(point).unwrap()
        };
        let difference = (moved(1.0) - moved(-1.0)) / (2.0 * step);
        let column = view.by_camera.column(axis).into_owned();
        assert_abs_diff_eq!(column, difference, epsilon = 1e-5 * (1.0 + difference.norm()));
    }
    for axis in 0..3 {
        let moved =
            |sign: f64| camera.project(&(point + sign * step * Vector3::ith(axis, 1.0))).unwrap();
        let difference = (moved(1.0) - moved(-1.0)) / (2.0 * step);
        let column = view.by_point.column(axis).into_owned();
        assert_abs_diff_eq!(column, difference, epsilon = 1e-5 * (1.0 + difference.norm()));
    }
}

#[test]
fn derivatives_of_both_cameras_agree_with_differences() {
    let pose = se3::exp(&Vector6::new(0.3, -0.2, 0.5, 0.4, -0.6, 0.2));
    let intrinsics = Pinhole::new(400.0, 420.0, 320.0, 240.0).unwrap();
    let pinhole = PosedPinhole { intrinsics, camera_from_world: pose };
    let bal = BalCamera {
        rotation: so3::exp(&Vector3::new(0.4, -0.6, 0.2)),
        translation: Vector3::new(0.3, -0.2, 0.5),
        focal_length: 400.0,
        radial: [-0.3, 0.1],
    };
    for point in [Vector3::new(0.4, -0.3, 4.0), Vector3::new(-1.0, 0.6, 3.0)] {
        assert_derivatives::<_, 6>(&pinhole, &point);
        for point in [point, -point] {
            assert_derivatives::<_, 9>(&bal, &point);
            assert_derivatives::<_, 6>(&bal, &point);
        }
    }
}

/// Numbers without a pattern between -1 and 1.
struct Unit(u64);

impl Unit {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| size * self.next())
    }
}

/// Two states of a factor and its pixel: derivatives where it stands agree with differences, and so
/// do those of a problem at a linearization point that is frozen elsewhere.
fn assert_factor<C: Camera<D> + Copy, const D: usize>(
    states: [(&C, Vector3<f64>); 2],
    pixel: Vector2<f64>,
) {
    let mut problem = Problem::new();
    let camera = problem.add_variable(MovingCamera(*states[0].0));
    let landmark = problem.add_variable(states[0].1);
    let factor = PixelByCamera { camera, landmark, pixel, inverse_sigma: 2.0 };
    problem.add_factor(factor, Kernel::Squared).unwrap();
    for (frozen, (at, point)) in states.iter().enumerate() {
        if frozen == 1 {
            problem.freeze(camera, MovingCamera(**at)).unwrap();
            problem.freeze(landmark, *point).unwrap();
        }
        let (jacobian, residual) = problem.jacobian(problem.values()).unwrap();
        let expected = 2.0 * (states[0].0.project(&states[0].1).unwrap() - pixel);
        assert_abs_diff_eq!(Vector2::new(residual[0], residual[1]), expected, epsilon = 1e-9);
        for axis in 0..D + 3 {
            let moved = |step: f64| {
                let change = SVector::<f64, D>::from_fn(|i, _| if i == axis { step } else { 0.0 });
                let along = Vector3::from_fn(|i, _| if D + i == axis { step } else { 0.0 });
                let camera = MovingCamera(at.retract(&change));
                factor.residual((&camera, &(point + along))).unwrap()
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            let column = Vector2::new(jacobian[(0, axis)], jacobian[(1, axis)]);
            assert_abs_diff_eq!(column, difference, epsilon = 1e-5 * (1.0 + difference.norm()));
        }
    }
}

#[test]
fn factors_of_all_cameras_agree_with_differences_also_where_they_are_frozen_elsewhere() {
    let mut unit = Unit(1);
    let intrinsics = Pinhole::new(400.0, 420.0, 320.0, 240.0).unwrap();
    for _ in 0..1000 {
        let mut state = || {
            let depth = 8.0 + 6.0 * unit.next();
            let slopes = unit.vector(0.6);
            let in_camera = depth * Vector3::new(slopes.x, slopes.y, 1.0);
            let rotation = so3::exp(&unit.vector(1.5));
            let translation = unit.vector(3.0);
            let point = rotation.inverse() * (in_camera - translation);
            let pose = Isometry3::from_parts(translation.into(), rotation.into());
            (pose, point, [0.3 * unit.next(), 0.1 * unit.next()])
        };
        let states = [state(), state()];
        let pixel = Vector2::new(300.0 + 100.0 * unit.next(), 200.0 + 100.0 * unit.next());
        let points = states.map(|(_, point, _)| point);
        let posed = states.map(|(camera_from_world, ..)| Posed { intrinsics, camera_from_world });
        assert_factor::<_, 6>([(&posed[0], points[0]), (&posed[1], points[1])], pixel);
        let lens = RadialTangential::new(-0.1, 0.05, 0.01, -0.02, 0.0).unwrap();
        let intrinsics = DistortedPinhole { pinhole: intrinsics, lens };
        let posed = states.map(|(camera_from_world, ..)| Posed { intrinsics, camera_from_world });
        assert_factor::<_, 6>([(&posed[0], points[0]), (&posed[1], points[1])], pixel);
        let bal = states.map(|(pose, _, radial)| BalCamera {
            rotation: pose.rotation.to_rotation_matrix(),
            translation: pose.translation.vector,
            focal_length: 400.0,
            radial,
        });
        assert_factor::<_, 6>([(&bal[0], points[0]), (&bal[1], points[1])], pixel);
        assert_factor::<_, 9>([(&bal[0], points[0]), (&bal[1], points[1])], pixel);
    }
}

#[test]
fn the_way_from_a_camera_to_another_one_is_that_of_its_retraction() {
    let mut unit = Unit(2);
    for _ in 0..200 {
        let change = SVector::<f64, 9>::from_fn(|_, _| 0.5 * unit.next());
        let from = BalCamera {
            rotation: so3::exp(&unit.vector(1.5)),
            translation: unit.vector(3.0),
            focal_length: 400.0,
            radial: [0.1, -0.1],
        };
        let to = from.retract(&change);
        assert_abs_diff_eq!(Camera::<9>::local(&from, &to), change, epsilon = 1e-9);
        let jacobian = Camera::<9>::local_jacobian(&from, &to);
        for axis in 0..9 {
            let moved = |step: f64| {
                let small = SVector::<f64, 9>::from_fn(|i, _| if i == axis { step } else { 0.0 });
                Camera::<9>::local(&from, &to.retract(&small))
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert_abs_diff_eq!(jacobian.column(axis).into_owned(), difference, epsilon = 1e-6);
        }
    }
}

#[test]
fn a_pinhole_has_no_derivative_where_it_has_no_pixel() {
    let camera = Scene::ring(8, 40, 1.0, 17).true_cameras[0];
    let behind = camera.centre() * 2.0;
    assert_eq!(camera.project(&behind), None);
    assert_eq!(camera.differentiate(&behind), None);
}

fn factor(keyframe: usize, point: usize) -> ReprojFactor {
    ReprojFactor { keyframe, point, pixel: Vector2::new(320.0, 240.0), inverse_sigma: 1.0 }
}

#[test]
fn bad_input_is_an_error_that_names_it() {
    let good = Scene::ring(8, 40, 1.0, 18).problem;
    let options = Options::large_problem();
    let check = |change: &dyn Fn(&mut Ba), message: &str| {
        let mut problem = good.clone();
        change(&mut problem);
        let before = format!("{problem:?}");
        let error = problem.solve(&options).unwrap_err();
        assert_eq!(error.to_string(), message);
        assert_eq!(format!("{problem:?}"), before);
    };
    check(
        &|p| p.factors[17].pixel.x = f64::NAN,
        &format!(
            "observation 17: pixel is (NaN, {}); remove the observation",
            good.factors[17].pixel.y
        ),
    );
    check(
        &|p| p.factors[17].keyframe = 8,
        "observation 17: there is no camera 8, only 8; count from zero",
    );
    check(
        &|p| p.factors[17].point = usize::MAX,
        "observation 17: there is no point 18446744073709551615, only 40; count from zero",
    );
    check(
        &|p| p.factors[17].inverse_sigma = 0.0,
        "observation 17: inverse_sigma is 0; give a positive, finite number",
    );
    check(
        &|p| p.points[3].y = f64::INFINITY,
        "point 3 is not finite at the start; remove it or triangulate it again",
    );
    check(
        &|p| p.huber = Some(-1.0),
        "the Huber threshold is -1; give a positive number of standard deviations",
    );
    check(
        &|p| p.fixed.truncate(7),
        "`fixed` has 7 entries for 8 cameras; give one for each camera",
    );
    check(&|p| p.rig.push(1), "`rig` has 9 entries for 8 cameras; give one for each camera");
    check(
        &|p| p.rig[1] = 0,
        "rig 0 has a fixed camera and a moving one; fix all of its cameras or none",
    );
    check(
        &|p| p.factors.clear(),
        "there is nothing to adjust: 0 observations were given and none can be used; every point \
         needs two",
    );
    let mut empty = Ba::new(Vec::new(), Vec::new(), Vec::new());
    assert_eq!(empty.solve(&options).unwrap_err(), BaError::Empty { observations: 0 });
    for damping in [f64::NAN, -1.0] {
        let error = Solver::new(&good, &damped_by(damping)).err().unwrap();
        let is_named = |name: &str| name == "initial_damping";
        assert!(matches!(error, BaError::Solve(SolveError::Option { name, .. }) if is_named(name)));
    }
    let error = SolveError::Option { name: "damping", value: -1.0 };
    assert_eq!(solver(&good).step(-1.0).unwrap_err(), BaError::Solve(error));
}

#[test]
fn what_cannot_be_used_is_left_out_and_counted() {
    let mut problem = Scene::ring(8, 40, 1.0, 19).problem;
    let reference = problem.clone().solve(&Options::large_problem()).unwrap();
    let outside = problem.cameras[3].centre() * 3.0;
    // Point 40 is seen once, point 41 never, point 42 lies behind cameras 3 and 4, and
    // camera 8 sees nothing but it.
    let centre = Vector3::zeros();
    problem.points.extend([centre, centre, outside]);
    problem.cameras.push(problem.cameras[3]);
    problem.fixed.push(false);
    problem.rig.push(8);
    problem.factors.extend([factor(5, 40), factor(3, 42), factor(4, 42), factor(8, 42)]);
    let (camera, points) = (problem.cameras[8], problem.points[40..].to_vec());
    let report = problem.solve(&Options::large_problem()).unwrap();
    assert_eq!(report.dropped.seen_once, 1);
    assert_eq!(report.dropped.without_pixel, 3);
    assert_eq!(report.dropped.points, 3);
    assert_eq!(report.dropped.cameras, 1);
    assert_eq!((report.full_dim, report.reduced_dim), (162, 42));
    assert_relative_eq!(report.cost, reference.cost, max_relative = 1e-9);
    assert_eq!((problem.cameras[8], &problem.points[40..]), (camera, &points[..]));
}

#[test]
fn a_camera_that_is_not_finite_sees_nothing_and_is_counted() {
    let mut problem = Scene::ring(8, 40, 1.0, 20).problem;
    problem.cameras[4].camera_from_world.translation.x = f64::NAN;
    let report = problem.solve(&Options::large_problem()).unwrap();
    assert_eq!((report.dropped.cameras, report.dropped.without_pixel), (1, 40));
}

#[test]
fn a_point_on_one_ray_only_is_named_when_nothing_damps_it() {
    let mut problem = Scene::stereo_ring(8, 40, 0.1, 1.0, 21).problem;
    problem.points.push(Vector3::zeros());
    problem.factors.extend([factor(4, 40), factor(4, 40)]);
    let error = solver(&problem).step(0.0).unwrap_err();
    assert_eq!(error, BaError::Ray { point: 40 });
    assert_eq!(solver(&problem).covariance().unwrap_err(), error);
    assert_eq!(solver(&problem).gauge_freedom().unwrap_err(), error);
    assert_eq!(solver(&problem).null_space().unwrap_err(), error);
    assert_eq!(solver(&problem).minimal_norm_covariance().unwrap_err(), error);
    // Rays that lean a little hide it among rounding errors.
    let centre = problem.cameras[4].camera_from_world.inverse().translation.vector;
    for lean in [0.1, 0.03, 0.01, 1e-3, 1e-4] {
        for place in 1..20 {
            let along = Vector3::new(-centre.x, -centre.y, lean * centre.norm());
            problem.points[40] = centre + 0.05 * f64::from(place) * along;
            assert_eq!(solver(&problem).step(0.0).unwrap_err(), error, "{lean} {place}");
        }
    }
    problem.points[40] = Vector3::zeros();
    problem.fixed.fill(false);
    assert_eq!(solver(&problem).gauge_freedom().unwrap_err(), error, "beside six others");
    assert!(problem.solve(&Options::large_problem()).is_ok());
}

#[test]
fn a_camera_that_hangs_by_a_thread_has_no_covariance_without_a_gauge_either() {
    let found = |bend: f64| {
        let mut problem = Scene::ring(8, 23, 1.0, 20).problem;
        problem.fixed.fill(false);
        problem.cameras.push(problem.cameras[3]);
        problem.fixed.push(false);
        problem.rig.push(8);
        // The last camera sees three points on a line that is bent by so much, and nothing else.
        let line =
            [-0.3, 0.0, 0.3].map(|x| Vector3::new(x, 0.1, if x == 0.0 { bend } else { 0.0 }));
        for (number, place) in (23..).zip(line) {
            problem.points.push(place);
            for keyframe in 0..9 {
                let pixel = problem.cameras[keyframe].project(&place).unwrap();
                problem.factors.push(ReprojFactor { pixel, ..factor(keyframe, number) });
            }
        }
        solver(&problem).minimal_norm_covariance()
    };
    assert!(found(0.1).is_ok());
    for bend in [1e-8, 3e-9, 1e-9] {
        assert!(found(bend).is_err(), "{bend}");
    }
}

#[test]
fn two_observations_by_one_camera_count_twice() {
    let mut problem = Scene::ring(8, 40, 1.0, 22).problem;
    let again = problem.factors[10];
    problem.factors.push(again);
    let step = solver(&problem).step(0.01).unwrap();
    let full = full_step(&problem, 0.01);
    assert!((step.cameras[5] - full.rows(30, 6)).norm() < 1e-10 * full.norm());
}

#[test]
fn with_all_cameras_fixed_the_points_are_triangulated() {
    let scene = Scene::ring(8, 40, 0.0, 23);
    let mut problem = Ba { cameras: scene.true_cameras, ..scene.problem };
    problem.fixed.fill(true);
    let report = problem.solve(&Options::large_problem()).unwrap();
    assert_eq!((report.full_dim, report.reduced_dim, report.block_products), (120, 0, 0));
    for (point, truth) in problem.points.iter().zip(&scene.true_points) {
        assert_abs_diff_eq!(*point, *truth, epsilon = 1e-6);
    }
    let solver = solver(&problem);
    assert_eq!(solver.gauge_freedom().unwrap().count(), 0);
    assert!(solver.covariance().unwrap().point(0).is_some());
    assert_eq!(solver.minimal_norm_covariance().unwrap(), solver.covariance().unwrap());
    assert!(solver.minimal_norm_step().is_ok());
}

#[test]
fn where_nothing_is_free_the_shortest_step_is_the_only_one() {
    let solver = solver(&Scene::stereo_ring(8, 40, 0.1, 1.0, 9).problem);
    let (shortest, only) = (solver.minimal_norm_step().unwrap(), solver.step(0.0).unwrap());
    for (shortest, only) in shortest.cameras.iter().zip(&only.cameras) {
        assert!((shortest - only).norm() <= 1e-8 * only.norm());
    }
    let [shortest, only] = [solver.minimal_norm_covariance(), solver.covariance()]
        .map(|covariance| covariance.unwrap().cameras);
    assert!((&shortest - &only).norm() < 1e-8 * only.norm());
}

#[test]
fn a_start_too_bad_to_save_ends_without_a_panic() {
    for seed in 0..20 {
        let mut problem = Scene::ring(8, 40, 1.0, seed).problem;
        for (j, point) in problem.points.iter_mut().enumerate() {
            *point *= 1.0 + (seed as f64) * (j as f64 - 20.0);
        }
        problem.factors.iter_mut().step_by(7).for_each(|factor| factor.pixel *= -1e9);
        let report = problem.solve(&Options::large_problem()).unwrap();
        assert!(report.cost <= report.iterations[0].cost);
    }
}

#[test]
fn scenes_depend_on_their_seed_only() {
    let pixels = |seed| Scene::street(10, 3.0, 1.0, seed).problem.factors;
    assert_eq!(pixels(1), pixels(1));
    assert_ne!(pixels(1), pixels(2));
}

#[test]
fn a_damping_that_is_none_is_refused() {
    let problem = Scene::ring(8, 40, 1.0, 18).problem;
    let solver = solver(&problem);
    for damping in [-0.5, f64::NAN, f64::INFINITY, 1e305] {
        let is_damping = |error: BaError| {
            matches!(error, BaError::Solve(SolveError::Option { name: "damping", .. }))
        };
        assert!(solver.step(damping).is_err_and(is_damping));
        assert!(solver.schur_complement(damping).is_err_and(is_damping));
    }
}

#[test]
fn a_far_point_that_is_lost_to_rounding_is_not_called_free() {
    let intrinsics = Pinhole::new(500.0, 500.0, 320.0, 240.0).unwrap();
    let cameras = [0.0, -1.0].map(|x| PosedPinhole {
        intrinsics,
        camera_from_world: Isometry3::translation(x, 0.0, 0.0),
    });
    let point = 1e8 * Vector3::new(0.3, 0.2, 1.0);
    let mut problem = Ba::new(cameras.to_vec(), vec![point], vec![factor(0, 0), factor(1, 0)]);
    problem.fixed.fill(true);
    let solver = solver(&problem);
    assert_eq!(solver.gauge_freedom().unwrap().count(), 0);
    let lost = |error| matches!(error, BaError::Solve(SolveError::LostToRounding { .. }));
    assert!(solver.step(0.0).is_err_and(lost));
    assert_eq!(GaugeFreedom::default().to_string(), "nothing is free");
}
