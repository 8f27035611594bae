//! What is asked about an answer, and on which instances.

mod vehicle;

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3, Vector4};
use vislam::filtering::chi_square_below;
use vislam::manifold::so3;
use vislam::preintegration::Vector9;

use super::*;
use crate::Exercise;
use crate::answer::{Spoiled, Transport};
use crate::check::{Check, Failure, Misconception, compare, compare_list, readable, show_list};
use crate::draw::Draw;
pub use vehicle::Flown;
use vehicle::Injected;

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "nees_diagnosis",
    title: "Fault diagnosis by NEES",
    chapter: "filtering",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Campaign", "Fault", "Matrix9", "Parts", "Report", "State"],
    forbidden: &[
        "BlockNees",
        "NeesBand",
        "StateError",
        "attitude_in_world",
        "chi_square_band",
        "msckf",
        "nees",
        "nis",
        "simulation",
    ],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    NOT_DIVIDED, "not_divided":
        "These are eᵀ P⁻¹ e. Their means are one, two and three for a consistent filter: by what is \
         each to be divided so that all are compared with the same number?";
    BODY_AXES, "body_axes":
        "Tilt and yaw are those about axes of the body. A telephone that lies on its side turns \
         about its own z axis and does not change its heading: along which axis does the world see \
         yaw?";
    COVARIANCE_IN_BODY, "covariance_in_body":
        "An error seen from the world is divided by a covariance that stands in the body. Is this \
         the covariance of these numbers? What becomes of P when its error is multiplied by a \
         rotation?";
    TURNED_BACK, "turned_back":
        "Something is turned the wrong way: this is what R̂ᵀ gives in the place of R̂. Which of the \
         two takes coordinates of the body to those of the world?";
    WORLD_AXIS, "world_axis":
        "This is the yaw about the third axis of the world. A world that a camera has begun stands \
         as the camera stood: where does `up` point in it?";
    BLOCK_OF_INVERSE, "block_of_inverse":
        "The block was cut out of P⁻¹, and it should be cut out of P. What is known of a part when \
         all the others are known exactly, and what when nobody tells them?";
    DIAGONAL_ALONE, "diagonal_alone":
        "Each number is divided by its own variance, and the squares are added. Two errors that \
         nearly always have the same sign: is a pair of one and minus one as likely as P's diagonal \
         says?";
    SIGMA_FOR_VARIANCE, "sigma_for_variance":
        "The square of an error is divided by its standard deviation. In which unit does this come \
         out, and what would it say of an error written in millimetres?";
    ONE_SIDED, "one_sided":
        "Only the upper side is tested. A filter whose covariance is ten times too large has a NEES \
         of a tenth: is it consistent?";
    SINGLE_RUN, "single_run":
        "This is the band of one run. The mean of a hundred independent numbers scatters less than \
         each of them: of how many squares is it the sum?";
    RUNS_FOR_DEGREES, "runs_for_degrees":
        "As many degrees of freedom were counted as there are runs. Each run has an error of several \
         numbers: how many squares of independent normal numbers are added up in all?";
    EACH_TEST_ALONE, "each_test_alone":
        "Each test may fail here with the whole probability, as if it were the only one. How often \
         does a filter without a fault pass thirty tests, each of which it passes with 95 in a \
         hundred?";
    SUM_FOR_MEAN, "sum_for_mean":
        "This is the band of the sum of all squares. What was it divided by to become a mean?";
    NORMAL_BAND, "normal_band":
        "This is the normal distribution with the right mean and variance, the same distance on both \
         sides. A sum of few squares is not normal: can it be below zero?";
    MORE_NOISE, "more_noise":
        "A missing term of the transition is taken for too small a noise. Both make a filter too \
         sure. How large is the part of a variance that comes through a term of F after one step, \
         and after a hundred, and how large is the part of the noise?";
    FIRST_STEP_UNREAD, "first_step_unread":
        "A wrong density is taken for a wrong transition. What enters the covariance in the very \
         first step, and how much of it can a term of F times dt have brought?";
    UPDATE_AS_PREDICTION, "update_as_prediction":
        "Clones without cross-covariance are taken for a fault of the prediction. Which numbers are \
         as they should be until the first displacement is used? And what does S become when two \
         positions with the same error are taken for independent?";
}

const PARTS: [&str; 4] = ["position", "velocity", "tilt", "yaw"];

impl Parts {
    fn column(&self) -> Vector4<f64> {
        Vector4::new(self.position, self.velocity, self.tilt, self.yaw)
    }
}

impl Spoiled for Parts {
    fn spoiled(number: f64) -> Self {
        Self { position: number, velocity: number, tilt: number, yaw: number }
    }
}

impl Spoiled for Fault {
    fn spoiled(_: f64) -> Self {
        Self::None
    }
}

/// An estimate and the truth.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    estimate: State,
    truth: State,
    /// A factor L of the covariance L Lᵀ.
    factor: Matrix9,
    up: Vector3<f64>,
}

/// An error and a factor of its covariance, in some frame. The rotation comes first.
#[derive(Clone)]
struct Seen {
    error: DVector<f64>,
    factor: DMatrix<f64>,
}

impl Seen {
    /// With the rotation of another.
    fn with_rotation_of(&self, other: &Self) -> Self {
        let mut mixed = self.clone();
        mixed.error.fixed_rows_mut::<3>(0).copy_from(&other.error.fixed_rows::<3>(0));
        mixed.factor.fixed_rows_mut::<3>(0).copy_from(&other.factor.fixed_rows::<3>(0));
        mixed
    }

    /// The parts by a measure, which is given rows that pick the numbers of a part out of the whole.
    fn parts(
        &self,
        up: &Vector3<f64>,
        measure: impl Fn(&Self, &DMatrix<f64>) -> f64,
    ) -> Vector4<f64> {
        let across = Rotation3::rotation_between(&Vector3::z(), up).unwrap_or_default();
        let axes = across.into_inner().transpose();
        let rows = |at: usize, axes: DMatrix<f64>| {
            let mut rows = DMatrix::zeros(axes.nrows(), 9);
            rows.view_mut((0, at), axes.shape()).copy_from(&axes);
            measure(self, &rows)
        };
        let of_rotation = |first: usize, count: usize| {
            DMatrix::from_fn(count, 3, |row, column| axes[(first + row, column)])
        };
        Vector4::new(
            rows(6, DMatrix::identity(3, 3)),
            rows(3, DMatrix::identity(3, 3)),
            rows(0, of_rotation(0, 2)),
            rows(0, of_rotation(2, 1)),
        )
    }

    /// The shortest vector of standard deviations that makes an error: its square, and how many
    /// numbers it explains.
    fn surprise(&self, rows: &DMatrix<f64>) -> f64 {
        shortest(&(rows * &self.factor), &(rows * &self.error)) / rows.nrows() as f64
    }

    /// The same when the part is all there is of the error, of the whole or of the rotation.
    fn alone(&self, rows: &DMatrix<f64>, within: usize) -> f64 {
        let error = rows.transpose() * rows * &self.error;
        let first = if within < 9 { error.iamax() / 3 * 3 } else { 0 };
        let (factor, error) = (self.factor.rows(first, within), error.rows(first, within));
        shortest(&factor.into_owned(), &error.into_owned()) / rows.nrows() as f64
    }

    /// The mean of the squares, each divided by a power of its own standard deviation.
    fn each(&self, rows: &DMatrix<f64>, power: i32) -> f64 {
        let (error, factor) = (rows * &self.error, rows * &self.factor);
        let one = |row: usize| error[row].powi(2) / factor.row(row).norm().powi(power);
        (0..rows.nrows()).map(one).sum::<f64>() / rows.nrows() as f64
    }
}

/// The square of the shortest x with A x = b, for independent rows.
fn shortest(a: &DMatrix<f64>, b: &DVector<f64>) -> f64 {
    let triangle = a.transpose().qr().r().transpose();
    triangle.solve_lower_triangular(b).map_or(f64::NAN, |x| x.norm_squared())
}

impl Case {
    /// A state that is turned by an angle of a range, in radians, with errors of which none is
    /// small, in a world that stands askew.
    pub fn drawn(draw: &mut Draw, angle: [f64; 2]) -> Self {
        let estimate =
            State { world_from_body: draw.rotation(angle[0]..angle[1]), ..State::drawn(draw) };
        let mut factor = draw.normals::<9, 9>();
        for (at, scale) in [(0, 0.05), (3, 0.3), (6, 0.8)] {
            factor.fixed_rows_mut::<3>(at).scale_mut(scale);
        }
        let truth = stepped(&estimate, &(factor * draw.normals::<9, 1>()));
        Self { estimate, truth, factor, up: draw.rotation(0.4..1.2) * Vector3::z() }
    }

    /// The error and its covariance in the body frame.
    fn in_body(&self) -> Seen {
        let Self { estimate, truth, factor, .. } = self;
        let back = estimate.world_from_body.inverse();
        let error = blocks(back.matrix()) * listed(&seen(estimate, truth));
        Seen { error, factor: DMatrix::from_column_slice(9, 9, factor.as_slice()) }
    }

    /// The same in the world: each column of the factor is a step, whose image is looked at.
    fn in_world(&self) -> Seen {
        const H: f64 = 1e-3;
        let Self { estimate, truth, factor, .. } = self;
        let image = |column: usize, h: f64| {
            seen(estimate, &stepped(estimate, &(h * factor.column(column))))
        };
        let slope = |column: usize| {
            let near = image(column, H) - image(column, -H);
            let far = image(column, 2.0 * H) - image(column, -2.0 * H);
            (8.0 * near - far) / (12.0 * H)
        };
        let images: Vec<DVector<f64>> = (0..9).map(|column| listed(&slope(column))).collect();
        Seen { error: listed(&seen(estimate, truth)), factor: DMatrix::from_columns(&images) }
    }

    fn given(&self, failure: Failure) -> Failure {
        let Self { estimate, truth, up, .. } = self;
        failure.given(&[
            ("log of estimate.world_from_body", &so3::log(&estimate.world_from_body).as_slice()),
            ("log of truth.world_from_body", &so3::log(&truth.world_from_body).as_slice()),
            ("up", &up.as_slice()),
        ])
    }
}

/// A state after a step in its body frame.
fn stepped(state: &State, step: &Vector9) -> State {
    let part = |at: usize| -> Vector3<f64> { step.fixed_rows::<3>(at).into() };
    let rotation = state.world_from_body;
    State {
        world_from_body: so3::retract(&rotation, &part(0)),
        velocity: state.velocity + rotation * part(3),
        position: state.position + rotation * part(6),
    }
}

/// What the world sees of the difference of two states.
fn seen(from: &State, to: &State) -> Vector9 {
    let turn = so3::log(&(to.world_from_body * from.world_from_body.inverse()));
    let (velocity, position) = (to.velocity - from.velocity, to.position - from.position);
    Vector9::from_iterator(turn.iter().chain(&velocity).chain(&position).copied())
}

fn listed(numbers: &Vector9) -> DVector<f64> {
    DVector::from_column_slice(numbers.as_slice())
}

/// A matrix for each of the three parts of an error.
fn blocks(matrix: &Matrix3<f64>) -> DMatrix<f64> {
    let mut blocks = DMatrix::zeros(9, 9);
    [0, 3, 6].iter().for_each(|at| blocks.fixed_view_mut::<3, 3>(*at, *at).copy_from(matrix));
    blocks
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("nees_is_that_of_the_parts_which_the_world_sees", |answer| {
            let mut draw = Draw::new(31);
            (0..20).try_for_each(|_| parts(answer, &Case::drawn(&mut draw, [0.6, 2.5])))
        }),
        Check::new("the_band_leaves_out_as_much_as_was_stated", bounds),
        Check::new("the_diagnosis_names_the_fault_that_was_injected", |answer| {
            diagnosed(answer, &Flown::all(&mut Draw::new(33), 3))
        }),
    ]
}

/// The NEES against the shortest vector of standard deviations that explains an error.
///
/// # Errors
///
/// A failure, which names what was divided by what where that is known.
pub fn parts(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { estimate, truth, factor, up } = case;
    let covariance = factor * factor.transpose();
    let obtained = Answer(answer).parts_of(estimate, truth, &covariance, up)?.column();
    let (body, world) = (case.in_body(), case.in_world());
    let expected = world.parts(up, Seen::surprise);
    // Which axes are horizontal is free, and what depends on that is not asked.
    let but_tilt = |parts: Vector4<f64>| Vector4::new(parts[0], parts[1], obtained[2], parts[3]);
    let back = blocks(estimate.world_from_body.inverse().matrix());
    let unturned = Seen { factor: body.factor.clone(), error: world.error.clone() };
    let against = Seen { factor: &back * &body.factor, error: world.error.clone() };
    let both = Seen { error: &back * &body.error, factor: against.factor.clone() };
    let surprise = |seen: &Seen| seen.parts(up, Seen::surprise);
    let mut comparison = compare("the NEES in parts", &obtained, &expected)
        .within(1e-6)
        .labelled(&PARTS, &[])
        .or(&NOT_DIVIDED, &expected.component_mul(&Vector4::new(3.0, 3.0, 2.0, 1.0)))
        .or(&BODY_AXES, &surprise(&body))
        .or(&WORLD_AXIS, &world.parts(&Vector3::z(), Seen::surprise))
        .or(&BLOCK_OF_INVERSE, &world.parts(up, |seen, rows| seen.alone(rows, 9)))
        .or(&BLOCK_OF_INVERSE, &world.parts(up, |seen, rows| seen.alone(rows, 3)));
    for wrong in [&unturned, &world.with_rotation_of(&unturned), &unturned.with_rotation_of(&world)]
    {
        comparison = comparison.or(&COVARIANCE_IN_BODY, &surprise(wrong));
    }
    for wrong in [against, both] {
        comparison = comparison
            .or(&TURNED_BACK, &surprise(&wrong))
            .or(&TURNED_BACK, &surprise(&world.with_rotation_of(&wrong)));
    }
    for seen in [&world, &body, &world.with_rotation_of(&body), &body.with_rotation_of(&world)] {
        for (misconception, power) in [(&DIAGONAL_ALONE, 2), (&SIGMA_FOR_VARIANCE, 1)] {
            let each = seen.parts(up, |seen, rows| seen.each(rows, power));
            comparison = comparison.or(misconception, &but_tilt(each));
        }
    }
    comparison.judge().map_err(|failure| case.given(failure))
}

/// A mean that is tested.
#[derive(Debug, Clone)]
pub struct Tested {
    dimensions: Vec<usize>,
    tests: usize,
    outside: f64,
}

impl Tested {
    /// A mean over runs with errors of the same dimension, or of several.
    pub fn drawn(draw: &mut Draw, alike: bool) -> Self {
        // More runs than any dimension, so that nobody's degrees of freedom are another's by chance.
        let runs = draw.index(10..40);
        let dimension = draw.index(2..7);
        let dimensions =
            (0..runs).map(|_| if alike { dimension } else { draw.index(1..9) }).collect();
        Self { dimensions, tests: draw.index(2..40), outside: draw.uniform(0.01..0.2) }
    }
}

/// What the sum of so many squares stays below with a probability, by halving.
fn quantile(probability: f64, degrees: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while chi_square_below(high, degrees) < probability {
        high *= 2.0;
    }
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        let half =
            if chi_square_below(middle, degrees) < probability { &mut low } else { &mut high };
        *half = middle;
    }
    low
}

/// The band against the distribution itself.
///
/// # Errors
///
/// A failure, which names what the band is instead where that is known.
pub fn bounded(answer: &dyn Transport, tested: &Tested) -> Result<(), Failure> {
    let Tested { dimensions, tests, outside } = tested;
    let (low, high) = Answer(answer).band(dimensions, tests, outside)?;
    let all: usize = dimensions.iter().sum();
    let ends = |share: f64, degrees: usize| {
        [share, 1.0 - share].map(|below| quantile(below, degrees) / degrees as f64)
    };
    let share = outside / (2 * tests) as f64;
    let expected = ends(share, all);
    let normal = (quantile(1.0 - 2.0 * share, 1) * 2.0 / all as f64).sqrt();
    let mut comparison = compare_list("the band", &[low, high], &expected)
        .within(1e-6)
        .labelled(&["low", "high"], &[])
        .or_list(&SINGLE_RUN, &ends(share, dimensions[0]))
        .or_list(&RUNS_FOR_DEGREES, &ends(share, dimensions.len()))
        .or_list(&EACH_TEST_ALONE, &ends(0.5 * outside, all))
        .or_list(&SUM_FOR_MEAN, &expected.map(|end| end * all as f64))
        .or_list(&NORMAL_BAND, &[1.0 - normal, 1.0 + normal]);
    for share in [share, 2.0 * share] {
        comparison = comparison.or_list(&ONE_SIDED, &[0.0, ends(share, all)[1]]);
    }
    let given: [(&str, &dyn std::fmt::Debug); 3] =
        [("dimensions", dimensions), ("tests", tests), ("outside", outside)];
    comparison.judge().map_err(|failure| failure.given(&given))
}

/// The bands that students are asked for.
fn bounds(answer: &dyn Transport) -> Result<(), Failure> {
    let mut draw = Draw::new(32);
    (0..20).try_for_each(|index| bounded(answer, &Tested::drawn(&mut draw, index % 2 == 0)))
}

/// What a mistake says of a filter with this fault.
type Mistake = fn(Injected) -> Fault;

/// Mistakes that take one fault for another, and always.
const MISTAKES: [(&Misconception, Mistake); 6] = [
    (&ONE_SIDED, |injected| match injected {
        Injected::TooLoud => Fault::None,
        other => other.fault(),
    }),
    (&MORE_NOISE, |injected| match injected.fault() {
        Fault::Transition => Fault::Density,
        other => other,
    }),
    (&MORE_NOISE, |injected| match injected.fault() {
        Fault::Transition | Fault::Clones => Fault::Density,
        other => other,
    }),
    (&FIRST_STEP_UNREAD, |injected| match injected.fault() {
        Fault::Density => Fault::Transition,
        other => other,
    }),
    (&UPDATE_AS_PREDICTION, |injected| match injected.fault() {
        Fault::Clones => Fault::Transition,
        other => other,
    }),
    (&UPDATE_AS_PREDICTION, |injected| match injected.fault() {
        Fault::Clones => Fault::Density,
        other => other,
    }),
];

/// Diagnoses against the faults that were injected.
///
/// # Errors
///
/// A failure when one is missed, which names what is taken for what where that is known.
pub fn diagnosed(answer: &dyn Transport, flown: &[Flown]) -> Result<(), Failure> {
    let mut said = Vec::new();
    for one in flown {
        said.push(Answer(answer).diagnosis(&one.campaign, &one.outside)?);
    }
    let numbers = |faults: Vec<Fault>| -> Vec<f64> {
        faults.into_iter().map(|fault| f64::from(fault as u8) + 1.0).collect()
    };
    let injected = flown.iter().map(|one| one.injected.fault()).collect();
    let what = "the list of verdicts (1 nothing, 2 density, 3 transition, 4 clones)";
    show_list(what, &numbers(said.clone()), &numbers(injected));
    let pairs = || flown.iter().zip(&said);
    let Some((missed, verdict)) = pairs().find(|(one, said)| one.injected.fault() != **said) else {
        return Ok(());
    };
    let known = MISTAKES
        .iter()
        .find(|(_, mistake)| pairs().all(|(one, said)| *said == mistake(one.injected)));
    let right = |one: &Flown, said: &Fault| one.injected.fault() == *said;
    let clean = |one: &Flown| one.injected.fault() == Fault::None;
    let (alarmed, faulty): (Vec<_>, Vec<_>) = pairs().partition(|(one, _)| clean(one));
    let found = faulty.iter().filter(|(one, said)| right(one, said)).count();
    let failure = match known {
        Some((misconception, _)) => Failure::known(misconception),
        None if alarmed.iter().all(|(_, said)| **said != Fault::None)
            && 2 * found > faulty.len() =>
        {
            Failure::known(&EACH_TEST_ALONE)
        }
        None => Failure::new("A campaign was given the wrong verdict."),
    };
    let wrong = pairs().filter(|(one, said)| !right(one, said)).count();
    Err(failure.with_numbers(format!(
        "{wrong} of {} campaigns are given another verdict than the fault that was injected. One of \
         them, with {} runs and {} for `outside`:\n{}expected {:?}\nobtained {verdict:?}",
        flown.len(),
        missed.campaign.runs,
        readable(missed.outside),
        missed.table(),
        missed.injected.fault(),
    )))
    .map_err(|failure: Failure| failure.unless("band", || bounds(answer)))
}
