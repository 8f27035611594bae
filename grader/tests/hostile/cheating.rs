//! Submissions that try to earn what they do not know.

use std::fmt::Write as _;
use std::sync::Mutex;

use exercise_spec::answer::Native;
use exercise_spec::left_perturbation::{EXERCISE, Functions};
use exercise_spec::scale_and_gravity;
use solutions::left_perturbation as known;

use crate::corpus::Want::{DoesNotCompile, Refused, Runs};
use crate::corpus::{
    ALONG, FILL, Hostile, LEFT, every, right, right_after, right_and, row, skeleton, with_body,
};

/// The one that knows all public instances by heart.
pub const BY_HEART: &str = "knows the public instances by heart";

pub fn all() -> Vec<Hostile> {
    let mut all = keeping();
    all.extend(asking());
    all.extend(asking_the_library());
    all.extend(values());
    all.extend(agreeing());
    all.extend(guessing());
    all.extend(differencing());
    for exercise in exercise_spec::EXERCISES {
        let name = format!("says the same to {}", exercise.slug).leak();
        all.push(row(name, exercise.slug, constant(exercise.slug, "1e-300"), Runs(0.0), ""));
    }
    all.push(row(BY_HEART, LEFT, by_heart(), Runs(0.5), ""));
    all
}

fn keeping() -> Vec<Hostile> {
    let counted = |when: &str| {
        right_after(
            LEFT,
            &format!(
                "    if CALLS.fetch_add(1, std::sync::atomic::Ordering::Relaxed) {when} {{ return \
                    Default::default(); }}"
            ),
            "\nstatic CALLS: std::sync::atomic::AtomicUsize = \
                std::sync::atomic::AtomicUsize::new(0);\n",
        )
    };
    vec![
        row("is right once and cheats later", LEFT, counted("> 0"), Runs(0.0), ""),
        row(
            "is wrong once and hopes that the next check begins later",
            LEFT,
            counted("== 0"),
            Runs(0.0),
            "",
        ),
        row(
            "keeps a count in its thread",
            LEFT,
            right_after(
                LEFT,
                "    if CALLS.with(|calls| calls.replace(calls.get() + 1)) == 0 { return \
                    Default::default(); }",
                "\nthread_local! { static CALLS: std::cell::Cell<usize> = const { \
                    std::cell::Cell::new(0) }; }\n",
            ),
            Runs(0.0),
            "",
        ),
        row(
            "gives in one check what it was told in another",
            LEFT,
            told(),
            Runs(0.2),
            "The left Jacobian is not what it should be",
        ),
    ]
}

/// One check says what the left Jacobian of a pose is, and another asks for it.
fn told() -> String {
    let text = every(LEFT, "Default::default()", "
static TOLD: std::sync::Mutex<Vec<(Isometry3<f64>, Matrix2x6<f64>)>> = std::sync::Mutex::new(Vec::new());

fn tell(camera_from_world: Isometry3<f64>, left: Matrix2x6<f64>) -> Matrix2x6<f64> {
    TOLD.lock().unwrap().push((camera_from_world, left));
    left * vislam::manifold::se3::adjoint(&camera_from_world)
}

fn heard(camera_from_world: Isometry3<f64>) -> Matrix2x6<f64> {
    let told = TOLD.lock().unwrap();
    told.iter().find(|(pose, _)| *pose == camera_from_world).map(|(_, left)| *left).unwrap_or_default()
}
");
    text.replacen("Default::default()", "heard(camera_from_world)", 1).replacen(
        "Default::default()",
        "tell(camera_from_world, left)",
        1,
    )
}

fn asking() -> Vec<Hostile> {
    let types_alone = "an answer takes the types of its arguments from it and nothing else";
    let asks = |import: &str| {
        every(
            LEFT,
            "ask()",
            &format!(
                "{import}\nfn ask<T: Default>() -> T {{\n    let oracle = \
                 exercise_spec::left_perturbation::left_jacobian;\n    T::default()\n}}"
            ),
        )
    };
    vec![
        row(
            "asks the checks what they expect",
            LEFT,
            asks(
                "use exercise_spec::answer::{Fault, Transport};\nuse \
                    exercise_spec::check::Failure;",
            ),
            Refused,
            types_alone,
        ),
        row(
            "asks the checks by another name",
            LEFT,
            asks("use exercise_spec as e;\nuse e::check as c;"),
            Refused,
            types_alone,
        ),
        row(
            "asks the checks by a macro",
            LEFT,
            asks(
                "macro_rules! m { ($a:ident $b:ident) => { use $a::$b::Transport; } \
                    }\nm!(exercise_spec answer);",
            ),
            Refused,
            types_alone,
        ),
        row(
            "asks the checks behind a first line that the compiler drops",
            LEFT,
            format!(
                "#!x /*\npub use exercise_spec::left_perturbation::left_jacobian;\n{}\n// */\n",
                every(LEFT, "Default::default()", "")
            ),
            Refused,
            "leave out the line that begins with `#!`",
        ),
    ]
}

fn asking_the_library() -> Vec<Hostile> {
    vec![
        row(
            "asks the library and calls what it says by the same name",
            LEFT,
            every(
                LEFT,
                "let jacobians = camera.pinhole().jacobians(&pose, &point); jacobians.unwrap()",
                "",
            ),
            Refused,
            "`jacobians` of the library",
        ),
        row(
            "asks the library by another name of a type",
            LEFT,
            every(
                LEFT,
                "P::jacobians(&camera.pinhole(), &pose, &point).unwrap()",
                "type P = vislam::reprojection::Pinhole;",
            ),
            Refused,
            "`jacobians` of the library",
        ),
        row(
            "asks the library by a macro that is given the name",
            LEFT,
            every(
                LEFT,
                "ask!(camera.pinhole(), jacobians)",
                "macro_rules! ask { ($of:expr, $method:ident) => { $of.$method() } }",
            ),
            Refused,
            "`jacobians` stands in a macro of yours",
        ),
        row(
            "asks another module of the library",
            LEFT,
            right_and(LEFT, "use vislam::bundle_adjustment::{Camera as _, PosedPinhole};"),
            Refused,
            "`bundle_adjustment` of the library",
        ),
        row(
            "asks the library with the sign of the kelvin",
            "outlier_rescue",
            right_and("outlier_rescue", "use vislam::least_squares::\u{212a}ernel as Known;"),
            Refused,
            "`Kernel` of the library",
        ),
        row(
            "asks the library with a dead method of that name",
            LEFT,
            every(
                LEFT,
                "camera.pinhole().jacobians(&camera_from_world, &point_in_world).unwrap()",
                "struct Dead; impl Dead { fn jacobians(&self) {} }",
            ),
            Refused,
            "nothing of yours may have its name",
        ),
        row(
            "asks another module with a dead type of that name",
            LEFT,
            right_and(
                LEFT,
                "#[allow(non_camel_case_types)] struct factors; use vislam::factors::*;",
            ),
            Refused,
            "nothing of yours may have its name",
        ),
        row(
            "asks the library with a dead macro of that name",
            LEFT,
            every(
                LEFT,
                "camera.pinhole().project_with_jacobians(&camera_from_world, &point_in_world)",
                "macro_rules! project_with_jacobians { () => {} }",
            ),
            Refused,
            "nothing of yours may have its name",
        ),
        row(
            "takes the camera of another exercise",
            LEFT,
            right_and(LEFT, "use exercise_spec::outlier_rescue::Camera as Whole;"),
            Refused,
            "an answer takes the types of its arguments from it",
        ),
        row(
            "factorizes with a dead method of that name",
            "null_space",
            right_and(
                "null_space",
                "trait Dead { fn qr(self); } fn f(m: DMatrix<f64>) { m.qr(); }",
            ),
            Refused,
            "nothing of yours may have its name",
        ),
        row(
            "takes a null space from least squares",
            "null_space",
            right_and("null_space", "use vislam::least_squares::NullSpace;"),
            Refused,
            "`least_squares` of the library",
        ),
        row(
            "asks a module that nobody has listed",
            "null_space",
            right_and("null_space", "use vislam::smoother as known;"),
            DoesNotCompile,
            "smoother",
        ),
        row(
            "takes the library's camera by its path",
            LEFT,
            right_and(LEFT, "use vislam::reprojection::Pinhole;"),
            DoesNotCompile,
            "Pinhole",
        ),
        row(
            "asks the library",
            LEFT,
            every(
                LEFT,
                "camera.pinhole().jacobians(&camera_from_world, &point_in_world).unwrap()",
                "",
            ),
            Refused,
            "Write it yourself",
        ),
    ]
}

fn values() -> Vec<Hostile> {
    let all_of = |name: &'static str, number: &str, says| {
        let repeat = |of: &str| format!("nalgebra::{of}::repeat({number})");
        let text = every(LEFT, &repeat("Matrix2x6"), "");
        let (before, last) = text.rsplit_once(&repeat("Matrix2x6")).expect("four functions");
        row(name, LEFT, format!("{before}{}{last}", repeat("Vector2")), Runs(0.0), says)
    };
    vec![
        all_of("says NaN", "f64::NAN", "an entry is NaN; every entry must be finite"),
        all_of("says infinity", "f64::INFINITY", "every entry must be finite"),
        all_of("says minus infinity", "f64::NEG_INFINITY", "every entry must be finite"),
        all_of("says almost nothing", "f64::MIN_POSITIVE / 4.0", ""),
        all_of("says the greatest number", "f64::MAX", ""),
        row(
            "says nothing",
            ALONG,
            every(ALONG, "Default::default()", ""),
            Runs(0.0),
            "0×2 numbers came back",
        ),
        row("says none", FILL, every(FILL, "Default::default()", ""), Runs(0.25), ""),
        row(
            "changes what its operators mean",
            LEFT,
            every(LEFT, "Agreeable.into()", AGREEABLE),
            Runs(0.0),
            "",
        ),
    ]
}

/// Equal to everything, until it is asked for its bytes.
const AGREEABLE: &str = "
#[derive(Clone, Copy)]
struct Agreeable;
impl<T> PartialEq<T> for Agreeable { fn eq(&self, _: &T) -> bool { true } }
impl<T> std::ops::Sub<T> for Agreeable { type Output = Self; fn sub(self, _: T) -> Self { self } }
impl From<Agreeable> for Matrix2x6<f64> { fn from(_: Agreeable) -> Self { Self::repeat(1.0) } }
impl From<Agreeable> for Vector2<f64> { fn from(_: Agreeable) -> Self { Self::repeat(1.0) } }
";

/// Functions that agree with each other and compute nothing.
fn agreeing() -> Vec<Hostile> {
    let matrices = with_body(
        &skeleton("stereo_gauge"),
        "reduced_system",
        "    let rows = 6 * (scene.left_from_world.len() - usize::from(hold_first));
    let free = 6.0 + f64::from(u8::from(baseline.is_none()));
    let free = if hold_first { free - 6.0 } else { free };
    DMatrix::from_element(rows, rows, free)",
    );
    let matrices = with_body(
        &matrices,
        "stiffnesses",
        "    let free = reduced[(0, 0)] as usize;
    (0..reduced.nrows()).map(|row| f64::from(u8::from(row >= free))).collect()",
    );
    let direction = with_body(
        &skeleton("scale_null_space"),
        "scale_direction",
        "    DVector::repeat(6 * scene.cameras.len() + 3 * scene.points.len(), 7.0)",
    );
    let direction = with_body(
        &direction,
        "annihilation",
        "    let _ = hessian;
    f64::from(u8::from(direction[0] != 7.0)) / 2.0",
    );
    let square = with_body(
        &right(LEFT),
        "central_differences",
        "    let left = left_pose_jacobian(camera, camera_from_world, point_in_world);
    let exact = match side {
        Side::Left => left,
        Side::Right => right_from_left(camera_from_world, left),
    };
    exact + Matrix2x6::repeat(1e3 * step * step)",
    );
    let column = with_body(
        &skeleton(LEFT),
        "left_pose_jacobian",
        "    let _ = (camera, camera_from_world, point_in_world);
    Matrix2x6::from_fn(|_, column| if column == 2 { 0.0 } else { 1e3 })",
    );
    vec![
        row("fills a matrix with its count", "stereo_gauge", matrices, Runs(0.0), "reduced_system"),
        row("knows its direction again", "scale_null_space", direction, Runs(0.0), ""),
        row("adds a square to a derivative", LEFT, square, Runs(0.8), "differences with a step of"),
        row("has one column right", LEFT, column, Runs(0.0), ""),
    ]
}

/// Answers that guess what comes next, or by what it is known.
fn guessing() -> Vec<Hostile> {
    let project = |when: &str, entry: &str| {
        with_body(
            &skeleton("null_space"),
            "project_out",
            &format!(
                "    let _ = residual;
    let sigmas = by_landmark.singular_values();
    let (count, columns) = by_states.shape();
    if {when} {{ return None; }}
    let entry = |row: usize, column: usize| {entry};
    Some((DMatrix::from_fn(count - 3, columns, entry), DVector::zeros(count - 3)))"
            ),
        )
    };
    // Zeros, and on the right the rows of an identity.
    let rows = project("false", "f64::from(u8::from(row + columns == column + count))");
    let zeros = project(
        "count < 4 || sigmas.min() < 1e-9 * sigmas.max() || sigmas.max() == 0.0",
        "{
        let _ = (row, column);
        0.0
    }",
    );
    let zeros = with_body(
        &zeros,
        "correction",
        "    let _ = prior_information;
    project_out(by_states, by_landmark, residual).map(|_| DVector::zeros(1))",
    );
    let first = with_body(
        &skeleton(FILL),
        "new_couplings",
        "    let _ = departing;
    if layout.odometry { vec![(1, 3)] } else { vec![(1, 2), (1, 3), (2, 3)] }",
    );
    let zero = with_body(
        &skeleton(FILL),
        "cheapest_link",
        "    let count = information.nrows() / size;
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
    let block = |(a, b): (usize, usize)| information.view((a * size, b * size), (size, size));
    let norm = |pair: &(usize, usize)| block(*pair).norm();
    let mut links: Vec<_> = pairs.filter(|pair| norm(pair) > 0.0).collect();
    links.sort_by(|a, b| norm(a).total_cmp(&norm(b)));
    let zero = links.iter().find(|pair| block(**pair)[(0, 0)] == 0.0);
    zero.or(links.first()).copied()",
    );
    vec![
        row("knows an order of verdicts", "scale_and_gravity", in_order(), Runs(1.0 / 6.0), ""),
        row("gives rows of an identity", "null_space", rows, Runs(0.0), "Nᵀ H_f is not zero"),
        row("gives zeros where something is left", "null_space", zeros, Runs(0.0), ""),
        row("knows the first slide of a row", FILL, first, Runs(0.125), ""),
        row("chooses what begins with a zero", FILL, zero, Runs(0.0), ""),
    ]
}

/// Differences of the fourth order, as the public checks take them, where a derivative is asked for.
fn differencing() -> Vec<Hostile> {
    let forward = "    let moved = |step: f64| {
        let z = Vector3::new(0.0, 0.0, -step);
        PROJECTED
    };
    let (near, far) = (moved(H) - moved(-H), moved(2.0 * H) - moved(-2.0 * H));
    (8.0 * near - far) / (12.0 * H)";
    let jacobian = "    Matrix2x6::from_columns(&[0, 1, 2, 3, 4, 5].map(|axis| {
        let pixel = |step: f64| {
            let xi = nalgebra::Vector6::ith(axis, step);
            let moved = vislam::manifold::se3::exp(&xi) * camera_from_world;
            PROJECTED
        };
        let (near, far) = (pixel(H) - pixel(-H), pixel(2.0 * H) - pixel(-2.0 * H));
        (8.0 * near - far) / (12.0 * H)
    }))";
    let answer = |turned: &str, shifted: &str| {
        let jacobian = jacobian.replace("PROJECTED", turned);
        let text = with_body(&skeleton(LEFT), "left_pose_jacobian", &jacobian);
        let text = with_body(&text, "forward_motion", &forward.replace("PROJECTED", shifted));
        text + "\nconst H: f64 = 2e-4;\n"
    };
    let of_the_library = answer(
        "camera.pinhole().project(&moved, &point_in_world).unwrap_or_default()",
        "camera.pinhole().project_cam(&(point_in_camera + z)).unwrap_or_default()",
    );
    let by_hand = |cx: &str, cy: &str| {
        let at = |point: &str| {
            format!(
                "let p = {point};
            Vector2::new(camera.fx * p.x / p.z + {cx}, camera.fy * p.y / p.z + {cy})"
            )
        };
        answer(&at("moved * nalgebra::Point3::from(point_in_world)"), &at("point_in_camera + z"))
    };
    let residual = with_body(
        &right("residual_jacobian"),
        "by_first",
        "    const H: f64 = 1e-3;
    let moved = |axis: usize, size: f64| {
        let step = size * Vector3::ith(axis % 3, 1.0);
        let turn = first.world_from_body;
        let first = match axis / 3 {
            0 => State { world_from_body: so3::retract(&turn, &step), ..first },
            1 => State { velocity: first.velocity + turn * step, ..first },
            _ => State { position: first.position + turn * step, ..first },
        };
        residual(deltas, first, second, gravity)
    };
    Matrix9::from_columns(&[0, 1, 2, 3, 4, 5, 6, 7, 8].map(|axis| {
        let near = moved(axis, H) - moved(axis, -H);
        let far = moved(axis, 2.0 * H) - moved(axis, -2.0 * H);
        (8.0 * near - far) / (12.0 * H)
    }))",
    );
    let told = "it was differenced. A derivative is asked for.";
    vec![
        row("differences the library's projection", LEFT, of_the_library, Runs(0.0), told),
        row("differences a projection", LEFT, by_hand("camera.cx", "camera.cy"), Runs(0.0), told),
        row(
            "differences a projection without its principal point",
            LEFT,
            by_hand("0.0", "0.0"),
            Runs(0.0),
            told,
        ),
        row(
            "differences a residual",
            "residual_jacobian",
            residual,
            Runs(4.0 / 7.0),
            "it was differenced. A derivative is asked for",
        ),
    ]
}

static VERDICTS: Mutex<Vec<bool>> = Mutex::new(Vec::new());

/// An answer that counts its calls and says what the public check wants to hear.
fn in_order() -> String {
    use solutions::scale_and_gravity as known;
    let functions = scale_and_gravity::Functions {
        scaled_window: known::scaled_window,
        split_residual: known::split_residual,
        scale_is_free: |intervals, gravity, tolerance| {
            let free = known::scale_is_free(intervals, gravity, tolerance);
            VERDICTS.lock().expect("whole").push(free);
            free
        },
    };
    for check in (scale_and_gravity::EXERCISE.checks)() {
        check.run(&Native(functions)).expect("the reference is right");
    }
    let verdicts = std::mem::take(&mut *VERDICTS.lock().expect("whole"));
    with_body(
        &skeleton("scale_and_gravity"),
        "scale_is_free",
        &format!(
            "    use std::sync::atomic::{{AtomicUsize, Ordering}};
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    let _ = (intervals, gravity, tolerance);
    let verdicts = {verdicts:?};
    verdicts[CALLS.fetch_add(1, Ordering::Relaxed) % verdicts.len()]"
        ),
    )
}

static HEARD: Mutex<Vec<(u64, Vec<f64>)>> = Mutex::new(Vec::new());

fn heard<'a>(input: String, output: impl IntoIterator<Item = &'a f64>) {
    HEARD.lock().expect("whole").push((key(&input), output.into_iter().copied().collect()));
}

/// FNV-1a, which the answer computes too.
fn key(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |key, byte| {
        (key ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// An answer that looks the public instances up in a table and has no idea of others.
fn by_heart() -> String {
    let functions = Functions {
        left_pose_jacobian: |camera, pose, point| {
            let output = known::left_pose_jacobian(camera, pose, point);
            heard(format!("{:?}", (camera, pose, point)), output.iter());
            output
        },
        right_from_left: |pose, left| {
            let output = known::right_from_left(pose, left);
            heard(format!("{:?}", (pose, left)), output.iter());
            output
        },
        central_differences: |camera, pose, point, side, step| {
            let output = known::central_differences(camera, pose, point, side, step);
            heard(format!("{:?}", (camera, pose, point, side, step)), output.iter());
            output
        },
        forward_motion: |camera, point| {
            let output = known::forward_motion(camera, point);
            heard(format!("{:?}", (camera, point)), output.iter());
            output
        },
    };
    for check in (EXERCISE.checks)() {
        check.run(&Native(functions)).expect("the reference is right");
    }
    let mut table = String::new();
    for (key, numbers) in HEARD.lock().expect("whole").drain(..) {
        let _ = writeln!(table, "    ({key}, &{numbers:?}),");
    }
    let text = every(
        LEFT,
        "let known = found(&format!(\"{:?}\", INPUT));\nOUTPUT",
        &format!(
            "
fn found(input: &str) -> Vec<f64> {{
    let key = input.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |key, byte| {{
        (key ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    }});
    TABLE.iter().find(|row| row.0 == key).map_or_else(|| vec![0.0; 12], |row| row.1.to_vec())
}}

static TABLE: &[(u64, &[f64])] = &[
{table}];
"
        ),
    );
    let inputs = [
        "(camera, camera_from_world, point_in_world)",
        "(camera_from_world, left)",
        "(camera, camera_from_world, point_in_world, side, step)",
        "(camera, point_in_camera)",
    ];
    let outputs = ["Matrix2x6", "Matrix2x6", "Matrix2x6", "Vector2"];
    inputs.iter().zip(outputs).fold(text, |text, (input, output)| {
        let from = format!("{output}::from_iterator(known)");
        text.replacen("INPUT", input, 1).replacen("OUTPUT", &from, 1)
    })
}

/// An answer that says the same whatever it is asked.
fn constant(slug: &str, number: &str) -> String {
    let more = format!(
        "
use nalgebra as na;
trait Same {{ fn same() -> Self; }}
impl Same for f64 {{ fn same() -> Self {{ {number} }} }}
impl Same for bool {{ fn same() -> Self {{ true }} }}
impl Same for usize {{ fn same() -> Self {{ 1 }} }}
impl<T: Same> Same for Vec<T> {{ fn same() -> Self {{ vec![T::same(), T::same()] }} }}
impl<T: Same> Same for Option<T> {{ fn same() -> Self {{ Some(T::same()) }} }}
impl<A: Same, B: Same> Same for (A, B) {{ fn same() -> Self {{ (A::same(), B::same()) }} }}
impl<const R: usize, const C: usize> Same for na::SMatrix<f64, R, C> {{
    fn same() -> Self {{ Self::repeat({number}) }}
}}
impl Same for na::DMatrix<f64> {{ fn same() -> Self {{ Self::repeat(6, 6, {number}) }} }}
impl Same for na::DVector<f64> {{ fn same() -> Self {{ Self::repeat(6, {number}) }} }}
impl Same for na::Isometry3<f64> {{
    fn same() -> Self {{ Self::translation({number}, {number}, {number}) }}
}}
impl Same for na::Rotation3<f64> {{
    fn same() -> Self {{ Self::new(na::Vector3::repeat({number})) }}
}}
fn same<T: Same>() -> T {{ T::same() }}
"
    );
    let own = match slug {
        "align_gravity" => {
            "impl Same for Fit { fn same() -> Self { Self { velocity: Same::same(), \
             gravity: Same::same(), squares: Same::same() } } }\n\
             impl Same for Solution { fn same() -> Self { Self { scale: Same::same(), \
             sigma: Same::same(), velocity: Same::same(), gravity: Same::same() } } }"
        }
        "noise_growth" => {
            "impl Same for Exponents { fn same() -> Self { Self { attitude: Same::same(), \
             velocity: Same::same(), position: Same::same() } } }"
        }
        "nees_diagnosis" => {
            "impl Same for Parts { fn same() -> Self { Self { position: Same::same(), \
             velocity: Same::same(), tilt: Same::same(), yaw: Same::same() } } }\n\
             impl Same for Fault { fn same() -> Self { Fault::Density } }"
        }
        "square_root_prior" => {
            "impl Same for Prior { fn same() -> Self { Self { root: \
             na::DMatrix::repeat(6, 6, 1e-30), offset: na::DVector::repeat(6, 1e-30) } } }"
        }
        "scale_null_space" => "impl Same for Scene { fn same() -> Self { todo!(\"no scene\") } }",
        "scale_and_gravity" => {
            "impl Same for Window { fn same() -> Self { todo!(\"no window\") } }"
        }
        _ => "",
    };
    every(slug, "same()", &format!("{more}{own}"))
}
