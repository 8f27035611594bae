//! Pixels and Jacobians of many points: a file of numbers in, a file of numbers out.
//!
//! ```text
//! cargo run -p vislam --example jacobians -- 400 400 320 240 states.csv jacobians.csv
//! ```
//!
//! The four numbers are the camera's fx, fy, cx and cy in pixels. Every line of `states.csv`
//! describes a pose and a point. Every line of `jacobians.csv` has the pixel, the two rows of the
//! 2×6 pose block and the two rows of the 2×3 point block. A point without a pixel, being behind the
//! camera or too near, has an empty line of commas.

use std::process::ExitCode;

use nalgebra::{Isometry3, Vector3};
use vislam::manifold::so3;
use vislam::reprojection::Pinhole;

const HEADER: &str = "rx,ry,rz,tx,ty,tz,x,y,z";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(sentence) => {
            eprintln!("jacobians: {sentence}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<(), String> {
    let [intrinsics @ .., input, output] = arguments else {
        return Err("give FX FY CX CY STATES.csv JACOBIANS.csv".to_owned());
    };
    let camera = camera(intrinsics)?;
    let text = std::fs::read_to_string(input).map_err(|error| format!("{input}: {error}"))?;
    let table = convert(&camera, &text).map_err(|sentence| format!("{input}: {sentence}"))?;
    std::fs::write(output, table).map_err(|error| format!("{output}: {error}"))
}

fn camera(intrinsics: &[String]) -> Result<Pinhole, String> {
    let [fx, fy, cx, cy] = numbers(intrinsics.iter().map(String::as_str))?;
    Pinhole::new(fx, fy, cx, cy).map_err(|error| error.to_string())
}

// ANCHOR: convert
/// Differentiates the projection at every state of a table.
fn convert(camera: &Pinhole, states: &str) -> Result<String, String> {
    let mut lines = states.lines().enumerate();
    if lines.next().is_none_or(|(_, header)| header.trim() != HEADER) {
        return Err(format!("line 1 must name the columns: {HEADER}"));
    }
    let mut table = output_header();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let state = numbers(line.split(','));
        let state = state.map_err(|sentence| format!("line {}: {sentence}", index + 1))?;
        table += &row(camera, &state);
    }
    Ok(table)
}
// ANCHOR_END: convert

// ANCHOR: row
/// The pixel, the pose block and the point block of one state.
fn row(camera: &Pinhole, &[rx, ry, rz, tx, ty, tz, x, y, z]: &[f64; 9]) -> String {
    let rotation = so3::exp_quaternion(&Vector3::new(rx, ry, rz));
    let camera_from_world = Isometry3::from_parts(Vector3::new(tx, ty, tz).into(), rotation);
    let point = Vector3::new(x, y, z);
    let Some(found) = camera.project_with_jacobians(&camera_from_world, &point) else {
        return ",".repeat(19) + "\n";
    };
    let (pose, point) = (found.by_pose.transpose(), found.by_point.transpose());
    let cells = found.pixel.iter().chain(&pose).chain(&point);
    cells.map(f64::to_string).collect::<Vec<_>>().join(",") + "\n"
}
// ANCHOR_END: row

fn output_header() -> String {
    let pose = |pixel| (0..6).map(move |k| format!("d{pixel}_dxi{k}"));
    let point = |pixel| ["x", "y", "z"].map(|axis| format!("d{pixel}_d{axis}"));
    let mut columns = vec!["u".to_owned(), "v".to_owned()];
    columns.extend(pose("u").chain(pose("v")).chain(point("u")).chain(point("v")));
    columns.join(",") + "\n"
}

/// Exactly `N` finite numbers.
fn numbers<'a, const N: usize>(cells: impl Iterator<Item = &'a str>) -> Result<[f64; N], String> {
    let read = |cell: &str| match cell.trim().parse() {
        Ok(number) if f64::is_finite(number) => Ok(number),
        _ => Err(format!("`{}` is not a finite number", cell.trim())),
    };
    let found = cells.map(read).collect::<Result<Vec<f64>, _>>()?;
    let count = found.len();
    found.try_into().map_err(|_| format!("there are {count} numbers where {N} belong"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };

    fn converted(line: &str) -> Result<String, String> {
        convert(&CAMERA, &format!("{HEADER}\n{line}\n"))
    }

    #[test]
    fn a_state_gives_its_pixel_and_both_blocks() {
        let table = converted("0,0,0,0,0,0,0.2,-0.1,5").unwrap();
        let (header, row) = table.trim_end().split_once('\n').unwrap();
        assert_eq!(header.split(',').count(), 20);
        let row: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(row.len(), 20);
        for (found, expected) in row.iter().zip([336.0, 232.0, 80.0, 0.0, -3.2]) {
            assert!((found - expected).abs() < 1e-12, "{row:?}");
        }
    }

    #[test]
    fn a_point_behind_the_camera_leaves_its_line_empty() {
        let table = converted("0,0,0,0,0,0,0,0,-5").unwrap();
        assert_eq!(table.lines().nth(1), Some(",,,,,,,,,,,,,,,,,,,"));
    }

    #[test]
    fn what_is_wrong_with_a_line_is_said_with_its_number() {
        assert_eq!(
            converted("0,0,0,0,0,0,1,2").unwrap_err(),
            "line 2: there are 8 numbers where 9 belong"
        );
        let nan = converted("0,0,0,0,0,0,1,2,NaN").unwrap_err();
        assert_eq!(nan, "line 2: `NaN` is not a finite number");
        assert!(convert(&CAMERA, "").unwrap_err().starts_with("line 1 must name the columns"));
    }
}
