//! Feature tracks: where a camera saw what it follows from picture to picture.
//!
//! A file has the columns `timestamp [ns]`, `track`, `u`, `v`, and for a pair of cameras
//! `u_right` and `v_right` too, which are empty where only the left one sees the feature.
//! Lines with one time make a picture.

use nalgebra::Vector2;

use super::table::{self, Header, Row, TableError, TableFault};

// ANCHOR: tracks
/// What a camera saw at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Time, in nanoseconds on the clock of the camera.
    pub nanoseconds: i64,
    /// The features seen, in the order of their tracks, each once.
    pub features: Vec<Feature>,
}

/// Where a feature was seen, in pixels, or in normalized coordinates (X/Z, Y/Z), which are the
/// pixels of a camera with focal lengths of one and its principal point at zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// The track that it belongs to, the same number in every picture.
    pub track: usize,
    /// Where the camera, or the left one of two, sees it.
    pub pixel: Vector2<f64>,
    /// Where the right one sees it.
    pub right: Option<Vector2<f64>>,
}
// ANCHOR_END: tracks

const HEADERS: [Header; 2] =
    [&["timestamp", "track", "u", "v"], &["timestamp", "track", "u", "v", "u_right", "v_right"]];

// ANCHOR: read_tracks
/// The pictures in the text of a file of tracks, in the order of their times.
///
/// # Errors
///
/// [`TableError`] tells a line that is not as it should be.
pub fn read_tracks(text: &str) -> Result<Vec<Picture>, TableError> {
    let mut pictures = Vec::new();
    for row in table::rows(text, &HEADERS)? {
        let nanoseconds = row.nanoseconds(0)?;
        let right_is_empty = row.text(4).is_empty() && row.text(5).is_empty();
        let right = if right_is_empty { None } else { Some(pixel(&row, 4)?) };
        let feature = Feature { track: track(&row, 1)?, pixel: pixel(&row, 2)?, right };
        add(&mut pictures, nanoseconds, feature).map_err(|fault| row.fault(fault))?;
    }
    Ok(pictures)
}
// ANCHOR_END: read_tracks

/// The number of a track.
pub(super) fn track(row: &Row<'_>, column: usize) -> Result<usize, TableError> {
    row.parse(column, "the number of a track, which is whole and not negative")
}

/// The two coordinates in neighbouring columns.
pub(super) fn pixel(row: &Row<'_>, column: usize) -> Result<Vector2<f64>, TableError> {
    Ok(Vector2::new(row.number(column)?, row.number(column + 1)?))
}

/// Adds a feature to the last picture, or begins a picture with it when time has gone on.
pub(super) fn add(
    pictures: &mut Vec<Picture>,
    nanoseconds: i64,
    feature: Feature,
) -> Result<(), TableFault> {
    match pictures.last_mut() {
        Some(picture) if picture.nanoseconds == nanoseconds => {
            let track = feature.track;
            let Err(place) = picture.features.binary_search_by_key(&track, |known| known.track)
            else {
                return Err(TableFault::Twice { what: format!("track {track} of this picture") });
            };
            picture.features.insert(place, feature);
        }
        last => {
            table::in_order(last.map(|picture| picture.nanoseconds), nanoseconds)?;
            pictures.push(Picture { nanoseconds, features: vec![feature] });
        }
    }
    Ok(())
}
