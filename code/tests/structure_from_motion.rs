//! Worked examples of incremental reconstruction: from matches to cameras and points.

#[path = "structure_from_motion/scenes.rs"]
mod scenes;

#[path = "structure_from_motion/maps.rs"]
mod maps;

#[path = "structure_from_motion/tracks.rs"]
mod tracks;

#[path = "structure_from_motion/refusals.rs"]
mod refusals;
