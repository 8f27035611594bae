//! How the camera moved, up to scale, from pictures alone.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Rotation3, Vector2, Vector3};

use super::{AlignmentRefused, Sensors};
use crate::datasets::tracks;
use crate::structure_from_motion::{
    MapPoint, Picture, PictureMatch, Reconstruction, ReconstructionError, ReconstructionOptions,
    reconstruct,
};

// ANCHOR: visual
/// A motion up to a similarity of the whole, from pictures alone. Coordinates are near those of
/// one of the two cameras with which the map began, lengths in a unit of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct VisualMotion {
    /// The pictures whose cameras were found, by number, ascending.
    pub pictures: Vec<usize>,
    /// Their times on the sensor's clock, in nanoseconds.
    pub nanoseconds: Vec<i64>,
    /// How the body was turned then, by the camera's place on it: `world_from_body`.
    pub rotations: Vec<Rotation3<f64>>,
    /// Where the camera was.
    pub centres: Vec<Vector3<f64>>,
    /// The landmarks, by track: where each is, and the places in these lists of those who saw it.
    pub landmarks: BTreeMap<usize, VisualLandmark>,
}

/// A landmark up to scale.
#[derive(Debug, Clone, PartialEq)]
pub struct VisualLandmark {
    /// Where it is.
    pub place: Vector3<f64>,
    /// The place of each picture in the lists of [`VisualMotion`], and the pixel.
    pub sightings: Vec<(usize, Vector2<f64>)>,
}
// ANCHOR_END: visual

impl VisualMotion {
    // ANCHOR: visual_of
    /// The motion that explains the tracks of some pictures, by
    /// [`reconstruct`]: each two pictures are matched by the tracks that both have.
    ///
    /// # Errors
    ///
    /// A [`ReconstructionError`]: without parallax there is none.
    pub fn of(
        sensors: &Sensors,
        pictures: &[tracks::Picture],
    ) -> Result<Self, ReconstructionError> {
        let given = pictures.iter().map(|picture| Picture {
            camera: sensors.camera,
            keypoints: picture.features.iter().map(|feature| feature.pixel).collect(),
        });
        let given: Vec<Picture> = given.collect();
        let options = ReconstructionOptions {
            sigma: sensors.pixel_sigma,
            least_points: LEAST_POINTS,
            ..ReconstructionOptions::default()
        };
        let found = reconstruct(&given, &matches(pictures), &options)?;
        Ok(Self::told(sensors, pictures, &found))
    }
    // ANCHOR_END: visual_of

    fn told(sensors: &Sensors, pictures: &[tracks::Picture], found: &Reconstruction) -> Self {
        let cameras = found.cameras.iter().enumerate();
        let (numbers, cameras): (Vec<usize>, Vec<Isometry3<f64>>) =
            cameras.filter_map(|(number, camera)| Some((number, camera.ok()?.inverse()))).unzip();
        let camera_from_body = sensors.rig.body_from_camera.rotation.inverse();
        let turned = |camera: &Isometry3<f64>| (camera.rotation * camera_from_body).into();
        let time = |number: &usize| sensors.rig.imu_nanoseconds(pictures[*number].nanoseconds);
        let landmark = |point: &MapPoint| {
            let [picture, keypoint] = *point.sightings.first()?;
            let track = pictures[picture].features[keypoint].track;
            let sighting = |[picture, keypoint]: &[usize; 2]| {
                let place = numbers.binary_search(picture).ok()?;
                Some((place, pictures[*picture].features[*keypoint].pixel))
            };
            let mut sightings: Vec<_> = point.sightings.iter().filter_map(sighting).collect();
            sightings.sort_by_key(|(place, _)| *place);
            Some((track, VisualLandmark { place: point.place, sightings }))
        };
        Self {
            nanoseconds: numbers.iter().map(time).collect(),
            rotations: cameras.iter().map(turned).collect(),
            centres: cameras.iter().map(|camera| camera.translation.vector).collect(),
            landmarks: found.points.iter().filter_map(landmark).collect(),
            pictures: numbers,
        }
    }

    /// That all lists have an entry for each picture, and that landmarks name entries of them.
    pub(super) fn check(&self) -> Result<(), AlignmentRefused> {
        let pictures = self.pictures.len();
        let lists = [self.nanoseconds.len(), self.rotations.len(), self.centres.len()];
        if lists != [pictures; 3] {
            let [times, rotations, centres] = lists;
            return Err(AlignmentRefused::Lists { pictures, times, rotations, centres });
        }
        for (track, landmark) in &self.landmarks {
            if let Some((place, _)) =
                landmark.sightings.iter().find(|(place, _)| *place >= pictures)
            {
                return Err(AlignmentRefused::Sighting { track: *track, place: *place, pictures });
            }
        }
        Ok(())
    }

    /// Seconds from the first camera to another.
    pub(super) fn seconds(&self, place: usize) -> f64 {
        1e-9 * self.nanoseconds[place].saturating_sub(self.nanoseconds[0]) as f64
    }
}

/// So many points with parallax make two pictures a beginning. Where a sensor holds the motion
/// together afterwards, fewer do than where nothing does.
const LEAST_POINTS: usize = 8;

/// What two pictures have the same track of, for each two.
fn matches(pictures: &[tracks::Picture]) -> Vec<PictureMatch> {
    let mut of_track: BTreeMap<usize, Vec<[usize; 2]>> = BTreeMap::new();
    for (number, picture) in pictures.iter().enumerate() {
        for (keypoint, feature) in picture.features.iter().enumerate() {
            of_track.entry(feature.track).or_default().push([number, keypoint]);
        }
    }
    let mut matches = Vec::new();
    for seen in of_track.values() {
        for (at, [first, keypoint]) in seen.iter().enumerate() {
            matches.extend(seen[at + 1..].iter().map(|[second, other]| PictureMatch {
                pictures: [*first, *second],
                keypoints: [*keypoint, *other],
            }));
        }
    }
    matches
}
