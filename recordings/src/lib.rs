//! Scenes of the book in three dimensions, recorded for rerun. What is recorded is computed by the library of the
//! book; a scene says only what of it is shown, in which colour, and from where it is looked at.

mod bundle_adjustment;
mod layout;
mod marginalization;
mod msckf;
mod odometry;
mod preintegration;
mod shapes;
mod stage;
mod two_views;
mod web;

pub use shapes::{Ellipsoid, frustum, ring_around};
pub use stage::{Stage, StageError, VERSION};
pub use web::{WebError, write_viewer};

/// A scene: the chapter that it belongs to, and what plays it.
#[derive(Clone, Copy)]
pub struct Scene {
    /// The slug of the chapter.
    pub name: &'static str,
    /// What is seen, in a line.
    pub shows: &'static str,
    play: fn(&Stage) -> Result<(), StageError>,
}

/// All scenes, in the order of the book.
pub const SCENES: [Scene; 5] = [
    Scene { name: "two_views", shows: two_views::SHOWS, play: two_views::play },
    Scene {
        name: "bundle_adjustment",
        shows: bundle_adjustment::SHOWS,
        play: bundle_adjustment::play,
    },
    Scene { name: "preintegration", shows: preintegration::SHOWS, play: preintegration::play },
    Scene { name: "msckf", shows: msckf::SHOWS, play: msckf::play },
    Scene { name: "marginalization", shows: marginalization::SHOWS, play: marginalization::play },
];

/// Scenes of data that are not in the repository. They are played where the data are, and are neither written for web pages
/// nor compared with pictures.
pub const SCENES_OF_DATA: [Scene; 1] =
    [Scene { name: "odometry", shows: odometry::SHOWS, play: odometry::play }];

impl Scene {
    /// The scene of a chapter.
    pub fn named(name: &str) -> Option<Self> {
        SCENES.into_iter().chain(SCENES_OF_DATA).find(|scene| scene.name == name)
    }

    /// Plays the scene into a recording.
    ///
    /// # Errors
    ///
    /// A [`StageError`] when the recording cannot be written.
    pub fn play(&self, stage: &Stage) -> Result<(), StageError> {
        (self.play)(stage)?;
        stage.finish()
    }
}
