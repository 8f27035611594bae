//! Submissions that use up time, memory, stack or patience, where they run and where they are
//! compiled.

use crate::corpus::Want::{DoesNotCompile, Refused, Runs};
use crate::corpus::{ALONG, Hostile, LEFT, every, right, right_after, right_and, row};

/// It has the fewest checks, and each of them waits for what has no end.
const FEW: &str = "scale_and_gravity";

pub fn all() -> Vec<Hostile> {
    let mut all = running();
    all.extend(memory());
    all.extend(outputs());
    all.extend(compiling());
    all.extend(growing());
    all
}

/// Steps or time, whichever the machine has fewer of.
const NO_END: &str = "Is there a loop that does not end";

fn running() -> Vec<Hostile> {
    let one = |function: &str, statement: &str| {
        let (before, after) = split_at(FEW, function);
        format!("{before}\n{statement}\n{after}")
    };
    vec![
        row("loops for ever", FEW, every(FEW, "loop {}", ""), Runs(0.0), NO_END),
        row(
            "loops for ever in one of its functions",
            FEW,
            one("scale_is_free", "loop { std::hint::black_box(0); }"),
            Runs(0.67),
            NO_END,
        ),
        row(
            "loops where a value is dropped",
            FEW,
            one(
                "scaled_window",
                "struct Slow;\nimpl Drop for Slow { fn drop(&mut self) { loop { \
                    std::hint::black_box(0); } } }\nlet _slow = Slow;",
            ),
            Runs(0.67),
            NO_END,
        ),
        row(
            "copies memory for ever",
            FEW,
            one(
                "scaled_window",
                "let mut much = vec![1_u8; 100 << 20];\nloop { much.copy_within(..50 << 20, 50 << \
                    20); std::hint::black_box(&mut much); }",
            ),
            Runs(0.67),
            NO_END,
        ),
        row(
            "reads memory where no cache has it",
            FEW,
            every(
                FEW,
                "leap()",
                "fn leap<T>() -> T {\n    let much = vec![1_usize; 48 << 20];\n    let mut at: usize = 1;\n    \
                 loop { at = at.wrapping_mul(1_664_525).wrapping_add(much[at] + 1_013_904_223) % (48 << 20); \
                 std::hint::black_box(at); }\n}",
            ),
            Runs(0.0),
            "more time, in all its checks, than an answer may",
        ),
        row(
            "asks again and again for memory that there is not",
            FEW,
            every(
                FEW,
                "ask()",
                "fn ask<T>() -> T {\n    loop { let _ = \
                 std::hint::black_box(Vec::<u8>::new().try_reserve(1 << 30)); }\n}",
            ),
            Runs(0.0),
            NO_END,
        ),
        row(
            "asks for the time",
            FEW,
            every(FEW, "{ let begun = std::time::Instant::now(); loop { begun.elapsed(); } }", ""),
            Runs(0.0),
            "time",
        ),
        row(
            "sleeps",
            FEW,
            every(FEW, "loop { std::thread::sleep(std::time::Duration::MAX) }", ""),
            Refused,
            "there is one thread",
        ),
        row(
            "calls itself for ever",
            LEFT,
            every(
                LEFT,
                "deeper(0)",
                "fn deeper<T: Default>(depth: u64) -> T {\n    if std::hint::black_box(depth) == \
                    u64::MAX { return T::default(); }\n    std::hint::black_box(deeper::<T>(depth \
                    + 1))\n}",
            ),
            Runs(0.0),
            "recursion",
        ),
        row(
            "calls itself with much in hand",
            LEFT,
            every(
                LEFT,
                "deeper([0; 65_536])",
                "fn deeper<T: Default>(much: [u64; 65_536]) -> T {\n    let more = \
                 std::hint::black_box(much.map(|number| number + 1));\n    if more[0] == 0 { \
                 return T::default(); }\n    std::hint::black_box(deeper::<T>(more))\n}",
            ),
            Runs(0.0),
            "",
        ),
    ]
}

/// The right answer before and after the beginning of a function's body.
fn split_at(slug: &str, function: &str) -> (String, String) {
    let text = right(slug);
    let begin = text.find(&format!("pub fn {function}")).expect("the function");
    let body = begin + text[begin..].find("{\n").expect("a body") + 1;
    (text[..body].to_owned(), text[body..].to_owned())
}

fn memory() -> Vec<Hostile> {
    let memory = "more memory than the";
    vec![
        row(
            "fills the memory",
            LEFT,
            every(
                LEFT,
                "more()",
                "fn more<T>() -> T {\n    let mut all = Vec::new();\n    loop { \
                    all.push(vec![1_u8; 1 << 16]); }\n}",
            ),
            Runs(0.0),
            memory,
        ),
        row(
            "lets memory go and never gives it back",
            LEFT,
            right_after(
                LEFT,
                "    Box::leak(Box::new([1_u8; 32 << 10]));\n    LEAK.with(|leak| \
                    leak.borrow_mut().push(vec![1_u8; 50_000_000]));",
                "
thread_local! {
    static LEAK: std::cell::RefCell<Vec<Vec<u8>>> = const { std::cell::RefCell::new(Vec::new()) };
}
",
            ),
            Runs(0.5),
            memory,
        ),
        row(
            "takes all memory at once",
            LEFT,
            every(
                LEFT,
                "Some(Vec::<u64>::with_capacity(std::hint::black_box(200_000_000)).len()).map(|_| \
                    Default::default()).unwrap()",
                "",
            ),
            Runs(0.0),
            "",
        ),
        row(
            "grows the machine's memory",
            LEFT,
            every(
                LEFT,
                "core::arch::wasm32::memory_grow(0, 60_000).to_string().parse().map(|_: f64| \
                    todo!()).unwrap()",
                "",
            ),
            Refused,
            "no instruction of a certain processor",
        ),
        row(
            "grows the machine's memory behind the back of the screen",
            LEFT,
            every(
                LEFT,
                "grow()",
                "use core::*;\nfn grow<T>() -> T {\n    loop { arch::wasm32::memory_grow::<0>(1); \
                    vec![0_u8; 1 << 20].leak(); }\n}",
            ),
            Runs(0.0),
            memory,
        ),
        row(
            "begins with more memory than there is",
            LEFT,
            right_after(
                LEFT,
                "    std::hint::black_box(&HUGE);",
                "
static HUGE: std::sync::Mutex<[u64; 40_000_000]> = std::sync::Mutex::new([0; 40_000_000]);
",
            ),
            DoesNotCompile,
            "more memory than",
        ),
        row(
            "is as large as a module may not be",
            LEFT,
            right_after(
                LEFT,
                "    std::hint::black_box(&HUGE);",
                "
static HUGE: [u64; 3_000_000] = [7; 3_000_000];
",
            ),
            DoesNotCompile,
            "or the compiled answer is too large",
        ),
        row(
            "is a little larger than a module may be",
            LEFT,
            right_after(
                LEFT,
                "    std::hint::black_box(&LARGE);",
                "
static LARGE: [u64; 1_200_000] = [7; 1_200_000];
",
            ),
            DoesNotCompile,
            "is there a table or an array that is better computed?",
        ),
    ]
}

fn outputs() -> Vec<Hostile> {
    let moves = |body: &str| {
        let (before, _) = split_at(ALONG, "predicted_moves");
        let (_, after) = split_at(ALONG, "exact_moves");
        let signature = right(ALONG);
        let begin = signature.find("pub fn exact_moves").expect("the function");
        let end = begin + signature[begin..].find("{\n").expect("a body") + 1;
        format!("{before}\n{body}\n}}\n{}{after}", &signature[begin..end])
    };
    vec![
        row(
            "returns a thousand million numbers",
            ALONG,
            moves(
                "let _ = (views, point_in_world, drag);\nvec![Vector2::zeros(); \
                    std::hint::black_box(1_000_000_000)]",
            ),
            Runs(0.9),
            "capacity overflow",
        ),
        row(
            "returns as much as may be read",
            ALONG,
            moves(
                "let _ = (views, point_in_world, drag);\nvec![Vector2::repeat(f64::NAN); \
                    1_000_000]",
            ),
            Runs(0.9),
            "1000000×2 numbers came back",
        ),
        row(
            "returns more than may be read",
            ALONG,
            moves("let _ = (views, point_in_world, drag);\nvec![Vector2::zeros(); 2_000_000]"),
            Runs(0.9),
            "are the most that is read",
        ),
        row(
            "returns millions of pairs",
            "fill_in",
            every(
                "fill_in",
                "flood()",
                "
trait Flood { fn flood() -> Self; }
impl Flood for Vec<(usize, usize)> { fn flood() -> Self { vec![(1, 2); 8_000_000] } }
impl Flood for Option<f64> { fn flood() -> Self { Some(f64::NAN) } }
impl Flood for Option<(usize, usize)> { fn flood() -> Self { Some((usize::MAX, usize::MAX)) } }
fn flood<T: Flood>() -> T { T::flood() }
",
            ),
            Runs(0.0),
            "",
        ),
        row(
            "returns matrices as large as may be read",
            "scale_null_space",
            floods("scale_null_space", 1400, 1400),
            Runs(0.0),
            "",
        ),
        row(
            "returns matrices as wide as may be read",
            "stereo_gauge",
            floods("stereo_gauge", 1, 2_000_000),
            Runs(0.0),
            "",
        ),
        row(
            "returns matrices as large as may be eliminated",
            "stereo_gauge",
            floods("stereo_gauge", 1400, 1400),
            Runs(0.0),
            "",
        ),
        row(
            "returns matrices as high as may be read",
            "null_space",
            floods("null_space", 2_000_000, 1),
            Runs(0.0),
            "",
        ),
        row(
            "returns matrices as large as may be projected",
            "null_space",
            floods("null_space", 1400, 1400),
            Runs(0.0),
            "",
        ),
        row(
            "returns matrices of nothing, and many",
            "null_space",
            floods("null_space", 0, 4_000_000_000),
            Runs(0.0),
            "",
        ),
        row(
            "returns many matrices of nothing",
            "scale_null_space",
            floods("scale_null_space", 4_000_000_000, 0),
            Runs(0.0),
            "",
        ),
        row("returns windows without an end", FEW, windows(), Runs(0.0), ""),
        row(
            "panics with 100 MB of words",
            LEFT,
            every(LEFT, "panic!(\"{}\", \"flood\\n\".repeat(20_000_000))", ""),
            Runs(0.0),
            "flood flood",
        ),
    ]
}

/// Matrices of a shape, and whatever else functions return.
fn floods(slug: &str, rows: u32, columns: u32) -> String {
    let flood = format!(
        "
use nalgebra as na;
trait Flood {{ fn flood() -> Self; }}
impl Flood for na::DMatrix<f64> {{ fn flood() -> Self {{ Self::repeat({rows}, {columns}, 1.0) }} }}
impl Flood for na::DVector<f64> {{ fn flood() -> Self {{ Self::repeat(({rows} as usize).min(1_900_000), f64::INFINITY) }} }}
impl Flood for Vec<f64> {{ fn flood() -> Self {{ vec![f64::NAN; 1_900_000] }} }}
impl Flood for f64 {{ fn flood() -> Self {{ f64::NAN }} }}
impl Flood for na::Isometry3<f64> {{ fn flood() -> Self {{ Self::translation(f64::NAN, 0.0, f64::INFINITY) }} }}
impl<const R: usize, const C: usize> Flood for na::SMatrix<f64, R, C> {{ fn flood() -> Self {{ Self::repeat(f64::NAN) }} }}
impl<A: Flood, B: Flood> Flood for (A, B) {{ fn flood() -> Self {{ (A::flood(), B::flood()) }} }}
impl<T: Flood> Flood for Option<T> {{ fn flood() -> Self {{ Some(T::flood()) }} }}
fn flood<T: Flood>() -> T {{ T::flood() }}
"
    );
    let text = every(slug, "flood()", &flood);
    if slug == "scale_null_space" {
        return text.replacen("\nflood()\n", "\ntodo!(\"not flooded\")\n", 1);
    }
    text
}

fn windows() -> String {
    every(
        FEW,
        "flood()",
        "
trait Flood { fn flood() -> Self; }
impl Flood for Window {
    fn flood() -> Self { Self { states: Vec::new(), landmarks: vec![Vector3::repeat(f64::NAN); 600_000] } }
}
impl Flood for Vector9 { fn flood() -> Self { Self::repeat(f64::INFINITY) } }
impl<A: Flood, B: Flood> Flood for (A, B) { fn flood() -> Self { (A::flood(), B::flood()) } }
impl Flood for bool { fn flood() -> Self { true } }
fn flood<T: Flood>() -> T { T::flood() }
",
    )
}

fn compiling() -> Vec<Hostile> {
    let endless = "const fn endless() -> u64 {\n    let mut number = 0_u64;\n    loop { number = \
        number.wrapping_add(1); if number == u64::MAX { return number; } }\n}\npub const NUMBER: \
        u64 = endless();";
    vec![
        row(
            "counts for ever while it is compiled",
            LEFT,
            right_and(LEFT, endless),
            DoesNotCompile,
            "taking a long time",
        ),
        row(
            "counts for ever while it is compiled, and allows it",
            LEFT,
            format!("#![allow(long_running_const_eval)]\n{}", right_and(LEFT, endless)),
            DoesNotCompile,
            "that has no end",
        ),
        row(
            "expands a macro for ever",
            LEFT,
            right_and(LEFT, "macro_rules! m { ($($t:tt)*) => { m!(x $($t)*); } }\nm!();"),
            DoesNotCompile,
            "recursion limit",
        ),
        row(
            "expands a macro to twice its size for ever",
            LEFT,
            right_and(LEFT, "macro_rules! m { ($($t:tt)*) => { m!($($t)* $($t)*); } }\nm!(x);"),
            DoesNotCompile,
            "that has no end",
        ),
        row(
            "has functions of ever more types",
            LEFT,
            right_after(
                LEFT,
                "    std::hint::black_box(f as fn());",
                "fn f() { more(()) }\nfn more<T: Clone>(t: T) { more((t.clone(), t)) }",
            ),
            DoesNotCompile,
            "that has no end",
        ),
        row(
            "has a trait that asks for itself",
            LEFT,
            right_and(
                LEFT,
                "trait Again {}\nimpl<T> Again for Vec<T> where Vec<Vec<T>>: Again {}\nfn asks<T: \
                    Again>() {}\npub fn f() { asks::<Vec<u8>>() }",
            ),
            DoesNotCompile,
            "overflow",
        ),
        row(
            "has a type that doubles forty times",
            LEFT,
            right_and(LEFT, &doubled(40)),
            DoesNotCompile,
            "that has no end",
        ),
    ]
}

fn doubled(times: usize) -> String {
    let mut text = "pub type T0 = [u64; 2];\n".to_owned();
    for number in 1..=times {
        text += &format!("pub type T{number} = (T{}, T{});\n", number - 1, number - 1);
    }
    text + &format!(
        "pub fn f() -> usize {{ let it: Option<T{times}> = None; std::mem::size_of_val(&it) }}\n"
    )
}

fn growing() -> Vec<Hostile> {
    vec![
        row(
            "is an array of gigabytes",
            LEFT,
            right_and(
                LEFT,
                "pub static HUGE: [u64; 500_000_000] = [7; 500_000_000];\npub fn f() -> &'static \
                    [u64] { &HUGE }",
            ),
            DoesNotCompile,
            "too big for the target architecture",
        ),
        row(
            "is an expression without an end",
            LEFT,
            right_and(LEFT, &format!("pub fn f() -> f64 {{ {}1.0 }}", "-".repeat(200_000))),
            DoesNotCompile,
            "that has no end",
        ),
        row(
            "is a sum without an end",
            LEFT,
            right_and(LEFT, &format!("pub fn f(x: f64) -> f64 {{ {}x }}", "x+".repeat(100_000))),
            DoesNotCompile,
            "that has no end",
        ),
        row(
            "is a chain of calls without an end",
            LEFT,
            right_and(LEFT, &format!("pub fn f(x: f64) -> f64 {{ x{} }}", ".abs()".repeat(35_000))),
            DoesNotCompile,
            "that has no end",
        ),
        row(
            "is a match that is a puzzle",
            LEFT,
            right_and(LEFT, &bits(26)),
            DoesNotCompile,
            "non-exhaustive patterns",
        ),
        row("is a function as large as may be", LEFT, huge(), Runs(1.0), ""),
    ]
}

/// Whether these arms are all there are is as hard to say as a puzzle can be.
fn bits(count: usize) -> String {
    let arm = |at: usize| {
        let pattern: Vec<&str> = (0..count)
            .map(|bit| {
                if bit == at {
                    "true"
                } else if bit == (at + 7) % count {
                    "false"
                } else {
                    "_"
                }
            })
            .collect();
        format!("({}) => {at},\n", pattern.join(", "))
    };
    let arms: String = (0..count).map(arm).collect();
    let types = vec!["bool"; count].join(", ");
    format!("pub fn f(bits: ({types})) -> usize {{ match bits {{\n{arms}\n}} }}\n")
}

/// Much code that nobody can leave out, because it begins with what is not known before.
fn huge() -> String {
    let steps = "number = number.wrapping_mul(31).rotate_left((number & 7) as u32) ^ \
        std::hint::black_box(number);\n";
    let more = format!("fn huge(mut number: u64) -> u64 {{\n{}number\n}}\n", steps.repeat(300));
    right_after(LEFT, "    std::hint::black_box(huge(7));", &more)
}
