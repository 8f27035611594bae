//! A list of matches, with the intrinsics of the pictures in its head.
//!
//! One line `camera fx fy cx cy` for each picture, in order; then one line `a u v b u v` for each match:
//! the number of a picture, counted from zero, and a pixel in it, and the same of another one. Pixels
//! are undistorted. Equal pixels of a picture are one keypoint. Empty lines and those that begin with
//! `#` are left out.

use std::collections::HashMap;
use std::str::{FromStr, SplitWhitespace};

use nalgebra::Vector2;
use thiserror::Error;

use crate::reprojection::{Pinhole, PinholeError};
use crate::structure_from_motion::{Picture, PictureMatch};

// ANCHOR: read_matches
/// The pictures and matches in a text of the form above.
///
/// # Errors
///
/// [`MatchListError`] tells the first line that is not as it should be.
pub fn read_matches(text: &str) -> Result<(Vec<Picture>, Vec<PictureMatch>), MatchListError> {
    let (mut pictures, mut matches) = (Vec::new(), Vec::new());
    let mut known: HashMap<(usize, [u64; 2]), usize> = HashMap::new();
    for (number, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let at = |fault| MatchListError { line: number + 1, fault };
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        if let Some(numbers) = line.strip_prefix("camera") {
            if !matches.is_empty() {
                return Err(at(MatchListFault::Late));
            }
            let [fx, fy, cx, cy] = numbers_of(numbers.split_whitespace()).map_err(at)?;
            let camera = Pinhole::new(fx, fy, cx, cy).map_err(|e| at(MatchListFault::Camera(e)))?;
            pictures.push(Picture { camera, keypoints: Vec::new() });
            continue;
        }
        let [a, u, v, b, s, t] = numbers_of(line.split_whitespace()).map_err(at)?;
        let mut keypoint = |picture: f64, pixel: Vector2<f64>| {
            let fault = MatchListFault::Picture { number: picture, count: pictures.len() };
            let is_there = picture >= 0.0 && picture.fract() == 0.0;
            let index = picture as usize;
            let Some(of) = pictures.get_mut(index).filter(|_| is_there) else {
                return Err(at(fault));
            };
            let key = (index, [pixel.x.to_bits(), pixel.y.to_bits()]);
            let keypoint = *known.entry(key).or_insert_with(|| {
                of.keypoints.push(pixel);
                of.keypoints.len() - 1
            });
            Ok((index, keypoint))
        };
        let one = keypoint(a, Vector2::new(u, v))?;
        let other = keypoint(b, Vector2::new(s, t))?;
        if one.0 == other.0 {
            return Err(at(MatchListFault::WithItself { picture: one.0 }));
        }
        matches.push(PictureMatch { pictures: [one.0, other.0], keypoints: [one.1, other.1] });
    }
    Ok((pictures, matches))
}
// ANCHOR_END: read_matches

/// The finite numbers of a line, which must be `N`.
fn numbers_of<const N: usize>(fields: SplitWhitespace) -> Result<[f64; N], MatchListFault> {
    let found = fields.clone().count();
    if found != N {
        return Err(MatchListFault::Fields { wanted: N, found });
    }
    let mut numbers = [0.0; N];
    for (number, field) in numbers.iter_mut().zip(fields) {
        let parsed = f64::from_str(field).ok().filter(|number| number.is_finite());
        *number = parsed.ok_or_else(|| MatchListFault::Number { text: field.into() })?;
    }
    Ok(numbers)
}

/// What is wrong with a list of matches, and in which line, counted from one.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}: {fault}")]
pub struct MatchListError {
    /// Where.
    pub line: usize,
    /// What.
    pub fault: MatchListFault,
}

/// What can be wrong with a line.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MatchListFault {
    /// Too few or too many numbers.
    #[error("{found} numbers where {wanted} should stand: `camera fx fy cx cy` or `a u v b u v`")]
    Fields {
        /// How many that takes.
        wanted: usize,
        /// How many there are.
        found: usize,
    },
    /// A field is no number.
    #[error("`{text}` is not a finite number")]
    Number {
        /// The field.
        text: String,
    },
    /// The intrinsics are none.
    #[error(transparent)]
    Camera(PinholeError),
    /// A camera stands below a match.
    #[error("a camera stands below a match; write all cameras first")]
    Late,
    /// A match names a picture without a camera.
    #[error("there is no picture {number}, only {count} cameras; they count from zero")]
    Picture {
        /// What it names.
        number: f64,
        /// How many there are.
        count: usize,
    },
    /// A match is one within a picture.
    #[error("both pixels are of picture {picture}; a match joins two pictures")]
    WithItself {
        /// Which picture.
        picture: usize,
    },
}
