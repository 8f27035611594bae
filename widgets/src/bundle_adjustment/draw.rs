//! The four panels.

use nalgebra::Vector3;
use vislam::bundle_adjustment::PosedPinhole;

use super::{ABOVE, PROGRESS, REDUCED, Run, Scene, Shape, Style, WHOLE, World};

/// Where a line breaks.
const BREAK: [f64; 2] = [f64::NAN, f64::NAN];
/// How many steps of a camera's way are drawn; those after them are small.
const PATH: usize = 12;
/// Length of a camera and half its width, in metres.
const BODY: (f64, f64) = (0.42, 0.24);

/// The world from above: the truth faint, the estimate filled, and between them what is wrong.
pub fn above(run: &Run, at: usize, scene: &mut Scene) {
    match run.setting.world {
        World::Street => {
            scene.view(ABOVE, [-1.2, 10.2], [-2.2, 9.2]);
            covisibility(run, scene);
        }
        World::Ring | World::StereoRing => scene.view(ABOVE, [-5.2, 5.2], [-5.2, 5.2]),
    }
    let (truth, state) = (&run.scene, &run.states[at]);
    let errors = state.points.iter().zip(&truth.true_points);
    let lines = errors.flat_map(|(point, truth)| [on_floor(point), on_floor(truth), BREAK]);
    scene.draw(ABOVE, (Shape::Line, Style::Faint, 1.0), lines);
    let crosses = truth.true_points.iter().map(on_floor);
    scene.draw(ABOVE, (Shape::Crosses, Style::Ink, 2.5), crosses);
    scene.draw(ABOVE, (Shape::Discs, Style::Estimated, 3.0), state.points.iter().map(on_floor));
    let outlines = truth.true_cameras.iter().flat_map(outline);
    scene.draw(ABOVE, (Shape::Line, Style::Ink, 1.0), outlines);
    let paths = (0..state.cameras.len()).flat_map(|camera| {
        let centre = move |state: &super::State| on_floor(&state.cameras[camera].centre());
        run.states[..=at].iter().take(PATH).chain([state]).map(centre).chain([BREAK])
    });
    scene.draw(ABOVE, (Shape::Line, Style::Estimated, 1.0), paths);
    for (camera, fixed) in state.cameras.iter().zip(&truth.problem.fixed) {
        let style = if *fixed { Style::Prior } else { Style::Estimated };
        scene.draw(ABOVE, (Shape::Area, style, 1.0), outline(camera).into_iter().take(3));
    }
    if run.setting.held {
        let [x, y] = on_floor(&state.cameras[0].centre());
        scene.word(ABOVE, 3, Style::Prior, [x - 0.9, y + 0.5]);
    }
}

/// An arc below the street between each two cameras that share a point, thicker for more points.
fn covisibility(run: &Run, scene: &mut Scene) {
    for ([one, other], count) in &run.covisible {
        let [one, other] = [one, other].map(|camera| run.scene.true_cameras[*camera].centre().x);
        let (middle, half) = (0.5 * (one + other), 0.5 * (other - one));
        let arc = (0..=8).map(|part| {
            let (sine, cosine) = (f64::from(part) * std::f64::consts::PI / 8.0).sin_cos();
            [middle - half * cosine, -0.65 - 0.6 * half * sine]
        });
        scene.draw(ABOVE, (Shape::Line, Style::Third, *count as f64 / 30.0), arc);
    }
}

fn on_floor(point: &Vector3<f64>) -> [f64; 2] {
    [point.x, point.y]
}

/// The corners of a camera, whose tip is its centre and points where it looks.
fn outline(camera: &PosedPinhole) -> [[f64; 2]; 5] {
    let world_from_camera = camera.camera_from_world.rotation.inverse();
    let (ahead, right) = (world_from_camera * Vector3::z(), world_from_camera * Vector3::x());
    let tip = camera.centre();
    let (length, half) = BODY;
    let corner = |side: f64| on_floor(&(tip - length * ahead + side * half * right));
    [corner(-1.0), on_floor(&tip), corner(1.0), corner(-1.0), BREAK]
}

/// Cost and gradient before each step and after the last, and what refused steps would have cost.
pub fn progress(run: &Run, at: usize, scene: &mut Scene) {
    let states = || run.states[..=at].iter().enumerate();
    let costs = || states().map(|(step, state)| [step as f64, state.cost.log10()]);
    let gradients = || states().map(|(step, state)| [step as f64, state.gradient_norm.log10()]);
    let truth = run.cost_of_truth.log10();
    let tried = run.iterations().iter().take(at).enumerate().filter(|(_, step)| !step.accepted);
    let refused =
        tried.filter_map(|(step, tried)| Some([step as f64 + 1.0, tried.trial_cost?.log10()]));
    let right = (1.4 * at as f64 + 1.0).max(12.0);
    let all = costs()
        .chain(gradients())
        .chain(refused.clone())
        .map(|[_, power]| power)
        .filter(|power| power.is_finite());
    let (low, high) =
        all.fold((-4.0, 6.0), |(low, high): (f64, f64), power| (low.min(power), high.max(power)));
    scene.view(PROGRESS, [-0.5, right], [low - 0.4, high + 0.4]);
    scene.draw(PROGRESS, (Shape::Dashed, Style::Faint, 1.0), [[-0.5, truth], [right, truth]]);
    scene.word(PROGRESS, 2, Style::Faint, [0.58 * right, truth + 0.35]);
    scene.draw(PROGRESS, (Shape::Line, Style::First, 1.5), costs());
    scene.draw(PROGRESS, (Shape::Discs, Style::First, 3.5), costs());
    scene.draw(PROGRESS, (Shape::Dashed, Style::Second, 1.5), gradients());
    scene.draw(PROGRESS, (Shape::Rings, Style::Second, 3.0), gradients());
    scene.draw(PROGRESS, (Shape::Crosses, Style::Ink, 3.5), refused);
    for (word, style, line) in
        [(0, Style::First, costs().next_back()), (1, Style::Second, gradients().next_back())]
    {
        if let Some([step, power]) = line.filter(|[_, power]| power.is_finite()) {
            let under = if word == 0 { -0.75 } else { 0.25 };
            scene.word(PROGRESS, word, style, [step + 0.3, power + under]);
        }
    }
    if let Some(stop) = run.ended.filter(|_| at + 1 == run.states.len()) {
        let word = if stop.is_some_and(|stop| stop.is_convergence()) { 4 } else { 5 };
        scene.word(PROGRESS, word, Style::Ink, [0.62 * right, high - 0.3]);
    }
}

/// Blocks that are not zero: of cameras, of points, and where two of them meet.
pub fn patterns(run: &Run, scene: &mut Scene) {
    let truth = &run.scene.true_points;
    let points = truth.len();
    // The points in the order in which a street passes them.
    let mut order: Vec<usize> = (0..points).collect();
    order.sort_by(|one, other| truth[*one].x.total_cmp(&truth[*other].x));
    let mut places = vec![0; points];
    order.iter().enumerate().for_each(|(place, point)| places[*point] = run.rows + place);
    let place = |index: usize| index.checked_sub(run.rows).map_or(index, |point| places[point]);
    for (panel, blocks, size) in
        [(WHOLE, &run.whole, run.rows + points), (REDUCED, &run.reduced, run.rows)]
    {
        let range = [-0.5, size as f64 - 0.5];
        scene.view(panel, range, range);
        let place = |block: &&[usize; 2]| block.map(|index| place(index) as f64);
        let is_own = |block: &&[usize; 2]| block[0] == block[1];
        let is_point = |block: &&[usize; 2]| block[0] >= run.rows;
        let own = || blocks.iter().filter(is_own);
        let cameras = own().filter(|block| !is_point(block)).map(|block| place(&block));
        scene.draw(panel, (Shape::Cells, Style::First, 1.0), cameras);
        let landmarks = own().filter(is_point).map(|block| place(&block));
        scene.draw(panel, (Shape::Cells, Style::Second, 1.0), landmarks);
        let between = blocks.iter().filter(|block| !is_own(block)).map(|block| place(&block));
        scene.draw(panel, (Shape::PaleCells, Style::Ink, 1.0), between);
    }
}
