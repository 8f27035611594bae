//! A recording that a scene is played into.

use std::path::Path;

use nalgebra::Vector3;
use rerun::log::ChunkBatcherConfig;
use rerun::{
    AsComponents, Color, Image, LineStrips3D, Points3D, RecordingStream, RecordingStreamBuilder,
    RecordingStreamError, Scalars, SeriesLines, SpawnError,
};
use thiserror::Error;

use crate::Ellipsoid;
use crate::layout::Layout;

/// The colours of the book on a dark ground, and those of what has no role in an estimate.
pub mod colour {
    /// What was measured.
    pub const MEASURED: [u8; 3] = [0x6c, 0xb4, 0xf0];
    /// What is estimated.
    pub const ESTIMATED: [u8; 3] = [0xf3, 0x9a, 0x60];
    /// What is known beforehand.
    pub const PRIOR: [u8; 3] = [0x53, 0xc4, 0xa2];
    /// How it truly is.
    pub const TRUTH: [u8; 3] = [0xd8, 0xd8, 0xde];
    /// A curve of something that has no role, on a light or a dark ground.
    pub const NEUTRAL: [u8; 3] = [0x8e, 0x92, 0x9c];
    /// What is in error, or has just come up.
    pub const STRIKING: [u8; 3] = [0xff, 0x6f, 0xb0];
    /// What is gone.
    pub const GONE: [u8; 3] = [0x5c, 0x60, 0x6a];
}

/// Why a recording cannot be made.
#[derive(Debug, Error)]
pub enum StageError {
    /// rerun says why.
    #[error("rerun cannot record this: {0}")]
    Recording(#[from] rerun::RecordingStreamError),
    /// There is no viewer to show it.
    #[error(
        "no program `rerun` is on the path; install the viewer with `pip install rerun-sdk=={VERSION}`, or write a \
         file with --save FILE"
    )]
    NoViewer,
    /// There is a viewer, and it does not open.
    #[error("the viewer does not open: {0}; write a file with --save FILE instead")]
    Viewer(rerun::RecordingStreamError),
    /// The file cannot be written.
    #[error("{file} cannot be written: {why}; name a file in a folder that is writable")]
    File {
        /// Its path.
        file: String,
        /// What rerun says.
        why: rerun::RecordingStreamError,
    },
    /// The library refuses what the scene asks of it.
    #[error("the scene cannot be computed: {0}")]
    Scene(String),
}

impl StageError {
    /// What the library says about a scene that it cannot compute.
    pub fn scene(why: impl ToString) -> Self {
        Self::Scene(why.to_string())
    }
}

/// The version of rerun that recordings are made for.
pub const VERSION: &str = "0.36.3";

/// A recording, in the units and colours of the book. The same scene makes the same recording: nothing in it depends on
/// the time of day.
pub struct Stage {
    stream: RecordingStream,
    name: &'static str,
}

impl Stage {
    /// A recording of a scene in a file.
    ///
    /// # Errors
    ///
    /// [`StageError::File`].
    pub fn in_file(name: &'static str, file: &Path) -> Result<Self, StageError> {
        let stream = builder(name)
            .save(file)
            .map_err(|why| StageError::File { file: file.display().to_string(), why })?;
        Ok(Self::of(stream, name))
    }

    /// A recording that the viewer shows while it is made.
    ///
    /// # Errors
    ///
    /// [`StageError::NoViewer`] and [`StageError::Viewer`].
    pub fn in_viewer(name: &'static str) -> Result<Self, StageError> {
        let stream = builder(name).spawn().map_err(|why| match why {
            RecordingStreamError::SpawnViewer(SpawnError::ExecutableNotFoundInPath { .. }) => {
                StageError::NoViewer
            }
            why => StageError::Viewer(why),
        })?;
        Ok(Self::of(stream, name))
    }

    /// A recording in memory, and what holds it.
    ///
    /// # Errors
    ///
    /// [`StageError::Recording`].
    pub fn in_memory(
        name: &'static str,
    ) -> Result<(Self, rerun::sink::MemorySinkStorage), StageError> {
        let (stream, storage) = builder(name).memory()?;
        Ok((Self::of(stream, name), storage))
    }

    fn of(stream: RecordingStream, name: &'static str) -> Self {
        stream.set_log_time_enabled(false);
        stream.set_log_tick_enabled(false);
        Self { stream, name }
    }

    /// From where the scene is looked at, and what stands beside it.
    ///
    /// # Errors
    ///
    /// [`StageError::Recording`].
    pub fn arrange(&self, layout: &Layout) -> Result<(), StageError> {
        Ok(layout.send(&self.stream, self.name)?)
    }

    /// What follows is recorded at this step of a timeline.
    pub fn at_step(&self, timeline: &'static str, step: usize) {
        self.stream.set_time_sequence(timeline, step as i64);
    }

    /// What follows is recorded this many seconds after the beginning.
    pub fn at_seconds(&self, timeline: &'static str, seconds: f64) {
        self.stream.set_duration_secs(timeline, seconds);
    }

    /// Records something that never changes.
    ///
    /// # Errors
    ///
    /// [`StageError::Recording`].
    pub fn always(&self, entity: &str, what: &impl AsComponents) -> Result<(), StageError> {
        Ok(self.stream.log_static(entity, what)?)
    }

    /// Records something at the present time.
    ///
    /// # Errors
    ///
    /// [`StageError::Recording`].
    pub fn now(&self, entity: &str, what: &impl AsComponents) -> Result<(), StageError> {
        Ok(self.stream.log(entity, what)?)
    }

    /// Names and colours a curve.
    ///
    /// # Errors
    ///
    /// [`StageError::Recording`].
    pub fn curve(&self, entity: &str, name: &str, colour: [u8; 3]) -> Result<(), StageError> {
        let lines = SeriesLines::new().with_names([name]).with_colors([rgb(colour)]);
        self.always(entity, &lines.with_widths([2.0]))
    }

    /// The value of a curve at the present time.
    ///
    /// # Errors
    ///
    /// [`StageError::Recording`].
    pub fn value(&self, entity: &str, value: f64) -> Result<(), StageError> {
        self.now(entity, &Scalars::single(value))
    }

    /// Waits until all is written.
    pub(crate) fn finish(&self) -> Result<(), StageError> {
        let flushed = self.stream.flush_blocking();
        flushed.map_err(|why| StageError::scene(format!("the recording is not written: {why}")))
    }
}

fn builder(name: &'static str) -> RecordingStreamBuilder {
    // Random names, the time of day, and what is written together because it came quickly would make two recordings differ.
    RecordingStreamBuilder::new(name)
        .recording_id(name)
        .send_properties(false)
        .batcher_config(ChunkBatcherConfig::NEVER)
}

fn rgb([red, green, blue]: [u8; 3]) -> Color {
    Color::from_rgb(red, green, blue)
}

/// A place or a direction in the numbers of a recording.
pub fn coordinates(place: &Vector3<f64>) -> [f32; 3] {
    [place.x as f32, place.y as f32, place.z as f32]
}

/// Points of one colour; the size is in points of the screen.
pub fn points<'a>(
    places: impl IntoIterator<Item = &'a Vector3<f64>>,
    colour: [u8; 3],
    size: f32,
) -> Points3D {
    Points3D::new(places.into_iter().map(coordinates))
        .with_colors([rgb(colour)])
        .with_radii([rerun::Radius::new_ui_points(size)])
}

/// Lines of one colour, as opaque as is said from 0 to 255; the width is in points of the screen.
pub fn lines(
    strips: impl IntoIterator<Item = Vec<Vector3<f64>>>,
    ([red, green, blue], opacity): ([u8; 3], u8),
    width: f32,
) -> LineStrips3D {
    let strip = |strip: Vec<Vector3<f64>>| strip.iter().map(coordinates).collect::<Vec<_>>();
    LineStrips3D::new(strips.into_iter().map(strip))
        .with_colors([Color::from_unmultiplied_rgba(red, green, blue, opacity)])
        .with_radii([rerun::Radius::new_ui_points(width)])
}

/// Ellipsoids of one colour, see-through with lines.
pub fn ellipsoids(
    all: impl IntoIterator<Item = Ellipsoid>,
    [red, green, blue]: [u8; 3],
) -> rerun::Ellipsoids3D {
    let all: Vec<Ellipsoid> = all.into_iter().collect();
    let turns = all.iter().map(|one| one.turn.coords.map(|part| part as f32).into());
    let turns = turns.map(|xyzw: [f32; 4]| rerun::Quaternion::from_xyzw(xyzw));
    rerun::Ellipsoids3D::from_centers_and_half_sizes(
        all.iter().map(|one| coordinates(&one.centre)),
        all.iter().map(|one| coordinates(&one.half_axes)),
    )
    .with_quaternions(turns)
    .with_colors([Color::from_unmultiplied_rgba(red, green, blue, 110)])
    .with_line_radii([rerun::Radius::new_ui_points(0.8)])
    .with_fill_mode(rerun::FillMode::TransparentFillMajorWireframe)
}

/// The entries of a square matrix: zeros dark, others brighter the larger they are, on a logarithmic scale over so many
/// powers of ten below the largest.
pub fn matrix(entries: &nalgebra::DMatrix<f64>, powers: f64) -> Image {
    let largest = entries.amax().log10();
    let (rows, columns) = entries.shape();
    let shade = |entry: f64| -> [u8; 3] {
        if entry == 0.0 {
            return [24, 26, 32];
        }
        let part = ((entry.abs().log10() - largest + powers) / powers).clamp(0.0, 1.0);
        colour::ESTIMATED.map(|most| (48.0 + part * (f64::from(most) - 48.0)) as u8)
    };
    let bytes: Vec<u8> = entries.transpose().iter().flat_map(|entry| shade(*entry)).collect();
    Image::from_rgb24(bytes, [columns as u32, rows as u32])
}
