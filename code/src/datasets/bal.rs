//! The text format of the "Bundle Adjustment in the Large" data sets.

use std::str::FromStr;

use nalgebra::{Vector2, Vector3};
use thiserror::Error;

use crate::bundle_adjustment::{BalCamera, Camera, TinyBa};
use crate::manifold::so3;
use crate::reprojection::ReprojFactor;

/// What is wrong with a BAL file, and in which line, counted from one.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}: {fault}")]
pub struct BalError {
    /// Where.
    pub line: usize,
    /// What.
    pub fault: BalFault,
}

/// What can be wrong with a line of a BAL file.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum BalFault {
    /// The file is too short.
    #[error("the file ends where {expected} should stand; it is not complete")]
    End {
        /// What is missing.
        expected: &'static str,
    },
    /// A line has too few or too many fields.
    #[error("{found} fields where {expected} should stand; there must be {wanted}")]
    Fields {
        /// What should stand there.
        expected: &'static str,
        /// How many fields that takes.
        wanted: usize,
        /// How many there are.
        found: usize,
    },
    /// A field is no number, or none that is allowed.
    #[error("`{text}` is not {wanted}")]
    Number {
        /// The field.
        text: String,
        /// What it should be.
        wanted: &'static str,
    },
    /// An observation names a camera or a point that the header does not announce.
    #[error("there is no {what} {index}, the header announces {count}; they count from zero")]
    Index {
        /// `camera` or `point`.
        what: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// Something stands after the last point.
    #[error("`{text}` stands after the last point; the header announces too few, or remove it")]
    Rest {
        /// The line.
        text: String,
    },
}

/// The problem in the text of a BAL file: a line with the numbers of cameras, points and
/// observations; a line for each observation with camera, point, and the pixel's two
/// coordinates; then one number a line, nine for each camera (rotation vector, translation,
/// focal length, k₁, k₂) and three for each point. Pixels are as good as one another,
/// with a standard deviation of one.
///
/// With `D` = 9 everything is free, with `D` = 6 the intrinsics are held.
///
/// # Errors
///
/// [`BalError`] tells the first line that is not as it should be.
// ANCHOR: read_bal
pub fn read_bal<const D: usize>(text: &str) -> Result<TinyBa<BalCamera, D>, BalError>
where
    BalCamera: Camera<D>,
{
    let mut lines = Lines { lines: text.trim_start_matches('\u{feff}').lines(), number: 0 };
    let [cameras, points, observations] = lines.header()?;
    let factors =
        (0..observations).map(|_| lines.observation(cameras, points)).collect::<Result<_, _>>()?;
    let cameras = (0..cameras).map(|_| lines.camera()).collect::<Result<_, _>>()?;
    let points = (0..points)
        .map(|_| lines.numbers("a coordinate of a point").map(Vector3::from))
        .collect::<Result<_, _>>()?;
    lines.end()?;
    Ok(TinyBa::new(cameras, points, factors))
}
// ANCHOR_END: read_bal

/// The lines of a text, counted.
struct Lines<'a> {
    lines: std::str::Lines<'a>,
    number: usize,
}

impl<'a> Lines<'a> {
    fn fault(&self, fault: BalFault) -> BalError {
        BalError { line: self.number, fault }
    }

    // ANCHOR: bal_fields
    /// The fields of the next line, which must be `N`.
    fn fields<const N: usize>(&mut self, expected: &'static str) -> Result<[&'a str; N], BalError> {
        self.number += 1;
        let line = self.lines.next().ok_or_else(|| self.fault(BalFault::End { expected }))?;
        let mut fields = line.split_whitespace();
        let found = fields.clone().count();
        if found != N {
            return Err(self.fault(BalFault::Fields { expected, wanted: N, found }));
        }
        Ok(std::array::from_fn(|_| fields.next().unwrap_or_default()))
    }

    fn number<T: FromStr>(&self, text: &str, wanted: &'static str) -> Result<T, BalError> {
        text.parse().map_err(|_| self.fault(BalFault::Number { text: text.into(), wanted }))
    }

    fn finite(&self, text: &str) -> Result<f64, BalError> {
        let wanted = "a finite number";
        let number: f64 = self.number(text, wanted)?;
        let fault = || self.fault(BalFault::Number { text: text.into(), wanted });
        number.is_finite().then_some(number).ok_or_else(fault)
    }
    // ANCHOR_END: bal_fields

    fn header(&mut self) -> Result<[usize; 3], BalError> {
        let [cameras, points, observations] =
            self.fields("the numbers of cameras, points and observations")?;
        let count = |text| self.number(text, "a number of things");
        Ok([count(cameras)?, count(points)?, count(observations)?])
    }

    fn observation(&mut self, cameras: usize, points: usize) -> Result<ReprojFactor, BalError> {
        let [camera, point, u, v] = self.fields("an observation")?;
        let index = |what, text, count| {
            let index = self.number(text, "an index")?;
            if index < count {
                Ok(index)
            } else {
                Err(self.fault(BalFault::Index { what, index, count }))
            }
        };
        let camera = index("camera", camera, cameras)?;
        let point = index("point", point, points)?;
        let pixel = Vector2::new(self.finite(u)?, self.finite(v)?);
        Ok(ReprojFactor { keyframe: camera, point, pixel, inverse_sigma: 1.0 })
    }

    fn camera(&mut self) -> Result<BalCamera, BalError> {
        let [rx, ry, rz, x, y, z, focal_length, k1, k2] =
            self.numbers("a parameter of a camera")?;
        let rotation = so3::exp(&Vector3::new(rx, ry, rz));
        let translation = Vector3::new(x, y, z);
        Ok(BalCamera { rotation, translation, focal_length, radial: [k1, k2] })
    }

    /// Finite numbers, one a line.
    fn numbers<const N: usize>(&mut self, expected: &'static str) -> Result<[f64; N], BalError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            let [text] = self.fields(expected)?;
            *number = self.finite(text)?;
        }
        Ok(numbers)
    }

    /// Nothing but empty lines is left.
    fn end(&mut self) -> Result<(), BalError> {
        while let Some(line) = self.lines.next() {
            self.number += 1;
            if !line.trim().is_empty() {
                return Err(self.fault(BalFault::Rest { text: line.trim().into() }));
            }
        }
        Ok(())
    }
}
