//! The twenty constructs of the page for readers who come from C++ or Python, each as a test that
//! can be run and changed. `rust_bridge/counterparts.cpp` and `rust_bridge/counterparts.py` say the
//! same in the other two languages.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::{SMatrix, SVector, Vector2, Vector3};
use vislam::reprojection::Pinhole;

#[test]
fn bindings() {
    // ANCHOR: bindings
    let focal_length = 400.0;
    let mut pixel = 320.0;
    pixel += focal_length * 0.04;
    // ANCHOR_END: bindings
    assert_eq!(pixel, 336.0);
}

// ANCHOR: functions
fn clamped_depth(depth: f64, nearest: f64) -> f64 {
    if depth < nearest { nearest } else { depth }
}
// ANCHOR_END: functions

#[test]
fn the_last_expression_is_the_result() {
    assert_eq!(clamped_depth(0.01, 0.05), 0.05);
    assert_eq!(clamped_depth(5.0, 0.05), 5.0);
}

// ANCHOR: tuples
fn polar(x: f64, y: f64) -> (f64, f64) {
    (x.hypot(y), y.atan2(x))
}

#[test]
fn a_tuple_comes_apart_into_names() {
    let (radius, angle) = polar(0.0, 2.0);
    assert_eq!((radius, angle), (2.0, PI / 2.0));
}
// ANCHOR_END: tuples

// ANCHOR: slices
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn arrays_and_vectors_are_both_read_as_slices() {
    let baselines = [0.1, 0.5];
    let mut depths = vec![5.0, 10.0];
    depths.push(15.0);
    assert_eq!((mean(&baselines), mean(&depths)), (0.3, 10.0));
}
// ANCHOR_END: slices

#[test]
fn loops() {
    let depths = [2.0, 4.0];
    // ANCHOR: loops
    let mut cost = 0.0;
    for (index, depth) in depths.iter().enumerate() {
        cost += index as f64 * depth;
    }
    for k in 0..3 {
        cost += f64::from(k);
    }
    // ANCHOR_END: loops
    assert_eq!(cost, 7.0);
}

// ANCHOR: structs
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stereo {
    pub focal_length: f64,
    pub baseline: f64,
}
// ANCHOR_END: structs

// ANCHOR: methods
impl Stereo {
    pub fn new(focal_length: f64, baseline: f64) -> Self {
        Self { focal_length, baseline }
    }

    pub fn depth(&self, disparity: f64) -> f64 {
        self.focal_length * self.baseline / disparity
    }
}
// ANCHOR_END: methods

#[test]
fn a_struct_has_methods_and_no_constructor() {
    // ANCHOR: derived
    let rig = Stereo::new(400.0, 0.5);
    let wider = Stereo { baseline: 1.0, ..rig };
    assert_ne!(rig, wider);
    println!("{rig:?} sees {} m", rig.depth(40.0));
    // ANCHOR_END: derived
    assert_eq!(rig.depth(40.0), 5.0);
}

// ANCHOR: enums
enum Noise {
    None,
    Gaussian { sigma: f64 },
    Uniform { width: f64 },
}
// ANCHOR_END: enums

impl Noise {
    // ANCHOR: matching
    fn variance(&self) -> f64 {
        match self {
            Noise::None => 0.0,
            Noise::Gaussian { sigma } => sigma * sigma,
            Noise::Uniform { width } => width * width / 12.0,
        }
    }
    // ANCHOR_END: matching
}

#[test]
fn an_enum_is_one_of_several_shapes() {
    let noises = [Noise::None, Noise::Gaussian { sigma: 2.0 }, Noise::Uniform { width: 6.0 }];
    assert_eq!(noises.map(|noise| noise.variance()), [0.0, 4.0, 3.0]);
}

// ANCHOR: options
fn inverse_depth(disparity: f64) -> Option<f64> {
    if disparity > 0.0 { Some(1.0 / disparity) } else { None }
}
// ANCHOR_END: options

// ANCHOR: let_else
fn shift(before: Option<f64>, after: Option<f64>) -> f64 {
    let (Some(before), Some(after)) = (before, after) else {
        return 0.0;
    };
    after - before
}
// ANCHOR_END: let_else

#[test]
fn what_may_be_absent_says_so_in_its_type() {
    assert_eq!(inverse_depth(-1.0), None);
    assert_eq!(shift(Some(2.0), Some(5.0)), 3.0);
    assert_eq!(shift(None, Some(5.0)), 0.0);
}

// ANCHOR: results
fn focal_length(text: &str) -> Result<f64, std::num::ParseFloatError> {
    let value: f64 = text.trim().parse()?;
    Ok(value)
}
// ANCHOR_END: results

#[test]
fn what_may_fail_says_so_in_its_type() {
    assert_eq!(focal_length(" 400 "), Ok(400.0));
    assert!(focal_length("four hundred").is_err());
}

// ANCHOR: borrows
fn longest(points: &[Vector3<f64>]) -> f64 {
    points.iter().map(|point| point.norm()).fold(0.0, f64::max)
}

fn scale(points: &mut [Vector3<f64>], factor: f64) {
    for point in points {
        *point *= factor;
    }
}
// ANCHOR_END: borrows

#[test]
fn a_borrow_reads_or_writes_and_gives_back() {
    let mut points = vec![Vector3::new(0.0, 3.0, 4.0), Vector3::zeros()];
    scale(&mut points, 2.0);
    assert_eq!(longest(&points), 10.0);
}

#[test]
fn a_value_has_one_owner() {
    // ANCHOR: moves
    let track = vec![336.0, 296.0];
    let copy = track.clone();
    let moved = track;
    // From here on, `track` is gone: the vector belongs to `moved`.
    // ANCHOR_END: moves
    assert_eq!(moved, copy);
}

// ANCHOR: closures
fn derivative(f: impl Fn(f64) -> f64, x: f64) -> f64 {
    let step = 1e-6;
    (f(x + step) - f(x - step)) / (2.0 * step)
}

#[test]
fn a_closure_takes_what_it_needs_from_around_it() {
    let rig = Stereo::new(400.0, 0.5);
    let slope = derivative(|disparity| rig.depth(disparity), 40.0);
    assert_relative_eq!(slope, -0.125, max_relative = 1e-8);
}
// ANCHOR_END: closures

#[test]
fn iterators() {
    // ANCHOR: iterators
    let left = [336.0, 340.0];
    let right = [296.0, 320.0];
    let disparities: Vec<f64> = left.iter().zip(&right).map(|(l, r)| l - r).collect();
    let largest = disparities.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // ANCHOR_END: iterators
    assert_eq!((disparities, largest), (vec![40.0, 20.0], 40.0));
}

// ANCHOR: traits
trait Project {
    fn project(&self, point: &Vector3<f64>) -> Option<Vector2<f64>>;
}

impl Project for Pinhole {
    fn project(&self, point: &Vector3<f64>) -> Option<Vector2<f64>> {
        self.project_cam(point)
    }
}

fn seen<C: Project>(camera: &C, points: &[Vector3<f64>]) -> usize {
    points.iter().filter(|point| camera.project(point).is_some()).count()
}
// ANCHOR_END: traits

#[test]
fn a_trait_says_what_a_type_can_do() {
    let camera = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };
    assert_eq!(seen(&camera, &[Vector3::new(0.2, -0.1, 5.0), Vector3::new(0.0, 0.0, -5.0)]), 1);
}

// ANCHOR: const_generics
fn squared_error<const D: usize>(
    residual: &SVector<f64, D>,
    information: &SMatrix<f64, D, D>,
) -> f64 {
    (residual.transpose() * information * residual)[(0, 0)]
}

#[test]
fn a_size_is_part_of_a_type() {
    let residual = Vector3::new(1.0, 2.0, 2.0);
    let pixel_part = residual.fixed_rows::<2>(0).into_owned();
    assert_eq!(squared_error(&residual, &SMatrix::identity()), 9.0);
    assert_eq!(squared_error(&pixel_part, &SMatrix::identity()), 5.0);
}
// ANCHOR_END: const_generics

// ANCHOR: tests
mod units {
    pub fn degrees(radians: f64) -> f64 {
        radians.to_degrees()
    }

    #[test]
    fn half_a_turn_is_180_degrees() {
        approx::assert_relative_eq!(degrees(std::f64::consts::PI), 180.0);
    }
}
// ANCHOR_END: tests

#[test]
fn a_module_shows_what_it_marks_as_public() {
    assert_eq!(units::degrees(0.0), 0.0);
}
