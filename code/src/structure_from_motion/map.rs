//! The cameras and points that are known so far.

use nalgebra::{Isometry3, Vector3};

use super::ReconstructionOptions;
use super::pictures::Arranged;
use crate::bearing::parallax;
use crate::manifold::se3;
use crate::two_views::{TriangulationError, View, triangulate, triangulate_nonlinear};

// ANCHOR: track
/// Keypoints that are said to show one point.
pub(super) struct Track {
    /// Ascending, at most one of each picture.
    pub(super) keypoints: Vec<usize>,
    /// For each whether the point explains it.
    pub(super) fits: Vec<bool>,
    /// Where the point is, when that is known.
    pub(super) point: Option<Vector3<f64>>,
}
// ANCHOR_END: track

impl Track {
    pub(super) fn new(keypoints: Vec<usize>) -> Self {
        Self { fits: vec![false; keypoints.len()], keypoints, point: None }
    }

    /// The keypoints that the point explains.
    pub(super) fn sightings(&self) -> impl Iterator<Item = usize> {
        self.keypoints.iter().zip(&self.fits).filter(|(_, fits)| **fits).map(|(k, _)| *k)
    }
}

/// Where a point is put that has no parallax, in multiples of the distance between the cameras.
const FAR: f64 = 1e4;
/// Tracks of more views are not tried with every pair of them.
const FEW_VIEWS: usize = 6;

/// What is known: poses, tracks, and which track has which keypoint.
pub(super) struct Map<'a> {
    pub(super) arranged: &'a Arranged,
    pub(super) options: &'a ReconstructionOptions,
    /// The largest squared error of a sighting, in pixels squared.
    pub(super) gate: f64,
    pub(super) poses: Vec<Option<Isometry3<f64>>>,
    pub(super) tracks: Vec<Track>,
    pub(super) track_of: Vec<Option<usize>>,
}

impl<'a> Map<'a> {
    pub(super) fn new(
        arranged: &'a Arranged,
        options: &'a ReconstructionOptions,
        gate: f64,
        tracks: &[Vec<usize>],
    ) -> Self {
        let mut track_of = vec![None; arranged.count()];
        for (track, keypoints) in tracks.iter().enumerate() {
            keypoints.iter().for_each(|keypoint| track_of[*keypoint] = Some(track));
        }
        let tracks = tracks.iter().cloned().map(Track::new).collect();
        let poses = vec![None; arranged.pictures.len()];
        let gate = gate * options.sigma * options.sigma;
        Self { arranged, options, gate, poses, tracks, track_of }
    }

    /// How many cameras are known.
    pub(super) fn registered(&self) -> usize {
        self.poses.iter().flatten().count()
    }

    /// How many points are known.
    pub(super) fn points(&self) -> usize {
        self.tracks.iter().filter(|track| track.point.is_some()).count()
    }

    /// How many keypoints are explained.
    pub(super) fn sightings(&self) -> usize {
        let known = self.tracks.iter().filter(|track| track.point.is_some());
        known.map(|track| track.sightings().count()).sum()
    }

    /// The squared distance, in pixels, from a keypoint to where its camera sees a point; infinite
    /// when it does not.
    pub(super) fn squared_error(&self, keypoint: usize, point: &Vector3<f64>) -> f64 {
        let picture = self.arranged.picture_of[keypoint];
        let Some(pose) = &self.poses[picture] else { return f64::INFINITY };
        let pixel = self.arranged.pictures[picture].camera.project(pose, point);
        pixel.map_or(f64::INFINITY, |pixel| (pixel - self.arranged.pixel(keypoint)).norm_squared())
    }

    /// Whether the camera of a keypoint is known.
    pub(super) fn is_posed(&self, keypoint: usize) -> bool {
        self.poses[self.arranged.picture_of[keypoint]].is_some()
    }

    /// A keypoint as a view of its camera, when that is known.
    fn view(&self, keypoint: usize) -> Option<View> {
        let picture = self.arranged.picture_of[keypoint];
        let camera = self.arranged.pictures[picture].camera;
        let (pixel, sigma) = (self.arranged.pixel(keypoint), self.options.sigma);
        self.poses[picture].map(|camera_from_world| View {
            camera,
            camera_from_world,
            pixel,
            sigma,
        })
    }

    /// The tracks that have a keypoint in a picture, each with that keypoint.
    pub(super) fn tracks_in(&self, picture: usize) -> impl Iterator<Item = (usize, usize)> {
        let keypoints = self.arranged.first[picture]..self.arranged.first[picture + 1];
        keypoints.filter_map(|keypoint| Some((self.track_of[keypoint]?, keypoint)))
    }

    // ANCHOR: triangulated_track
    /// The point with the least truncated cost that some keypoints give, and which of them show it, when
    /// two or more do. It is the best of the points of two views each, improved by all views that agree
    /// with it; or, where some do not, that of all views together.
    ///
    /// Without a least parallax, a point whose rays do not meet in front is put far away.
    pub(super) fn triangulated(
        &self,
        keypoints: &[usize],
        least_parallax: f64,
    ) -> Option<(Vector3<f64>, Vec<bool>)> {
        let seen: Vec<(usize, View)> =
            keypoints.iter().filter_map(|k| Some((*k, self.view(*k)?))).collect();
        let cost = |point: &Vector3<f64>| self.cost_of(seen.iter().map(|(k, _)| *k), point);
        let pairs = pairs_of(seen.len())
            .filter_map(|[one, other]| point_of_two(&[seen[one].1, seen[other].1], least_parallax));
        let mut best = least(pairs, cost)?;
        let agree = |point: &Vector3<f64>| {
            let within = |(k, _): &&(usize, View)| self.squared_error(*k, point) <= self.gate;
            seen.iter().filter(within).map(|(_, view)| *view).collect::<Vec<View>>()
        };
        if seen.len() > 2 {
            let all: Vec<View> = seen.iter().map(|(_, view)| *view).collect();
            let agreeing = agree(&best);
            let of_all = (agreeing.len() < all.len()).then(|| point_of_many(&all, least_parallax));
            let of_agreeing = triangulate(&agreeing, least_parallax).ok();
            best = least(of_all.flatten().into_iter().chain(of_agreeing).chain([best]), cost)?;
        }
        let fits: Vec<bool> =
            keypoints.iter().map(|k| self.squared_error(*k, &best) <= self.gate).collect();
        (fits.iter().filter(|fits| **fits).count() >= 2).then_some((best, fits))
    }
    // ANCHOR_END: triangulated_track

    /// The sum of squared errors of keypoints, each counted as at most the gate, in pixels squared.
    pub(super) fn cost_of(
        &self,
        keypoints: impl Iterator<Item = usize>,
        point: &Vector3<f64>,
    ) -> f64 {
        keypoints.map(|keypoint| self.squared_error(keypoint, point).min(self.gate)).sum()
    }

    /// Looks for the point of a track.
    pub(super) fn triangulate(&mut self, track: usize, least_parallax: f64) {
        let found = self.triangulated(&self.tracks[track].keypoints, least_parallax);
        if let Some((point, fits)) = found {
            (self.tracks[track].point, self.tracks[track].fits) = (Some(point), fits);
        }
    }

    // ANCHOR: filter_track
    /// Decides anew which keypoints of a track its point explains, and gives the point up when they
    /// are fewer than two, or their rays have less than a least parallax.
    pub(super) fn filter(&mut self, track: usize, least_parallax: f64) {
        let Some(point) = self.tracks[track].point else { return };
        let keypoints = &self.tracks[track].keypoints;
        let fits: Vec<bool> =
            keypoints.iter().map(|k| self.squared_error(*k, &point) <= self.gate).collect();
        let explained = keypoints.iter().zip(&fits).filter(|(_, fits)| **fits);
        let centres: Vec<Vector3<f64>> = explained
            .filter_map(|(k, _)| self.poses[self.arranged.picture_of[*k]])
            .map(|pose| centre(&pose))
            .collect();
        let is_wide = least_parallax == 0.0 || are_apart(&point, &centres, least_parallax);
        let track = &mut self.tracks[track];
        track.fits = fits;
        if centres.len() < 2 || !is_wide {
            track.point = None;
            track.fits.fill(false);
        }
    }
    // ANCHOR_END: filter_track
}

/// Where a camera stands.
pub(super) fn centre(camera_from_world: &Isometry3<f64>) -> Vector3<f64> {
    se3::transform(&camera_from_world.inverse(), &Vector3::zeros())
}

/// Whether any two cameras see a point at an angle of at least so much.
fn are_apart(point: &Vector3<f64>, centres: &[Vector3<f64>], least: f64) -> bool {
    let mut pairs = centres
        .iter()
        .enumerate()
        .flat_map(|(at, one)| centres[..at].iter().map(move |other| parallax(point, one, other)));
    pairs.any(|angle| angle >= least)
}

/// The pairs of views with which a track is tried: all of a few, and of many those that are far apart
/// in the list.
fn pairs_of(count: usize) -> impl Iterator<Item = [usize; 2]> {
    let apart = if count > FEW_VIEWS { count / 2..count / 2 + 1 } else { 1..count };
    apart.flat_map(move |apart| (0..count - apart).map(move |at| [at, at + apart]))
}

/// The point with the least cost.
fn least(
    points: impl Iterator<Item = Vector3<f64>>,
    cost: impl Fn(&Vector3<f64>) -> f64,
) -> Option<Vector3<f64>> {
    let costs = points.map(|point| (cost(&point), point));
    costs.min_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, point)| point)
}

/// The most likely point of many views.
fn point_of_many(views: &[View], least_parallax: f64) -> Option<Vector3<f64>> {
    let start = triangulate(views, least_parallax).ok()?;
    Some(triangulate_nonlinear(views, &start).map_or(start, |found| found.point))
}

/// The point of two views.
fn point_of_two(views: &[View; 2], least_parallax: f64) -> Option<Vector3<f64>> {
    match triangulate(views, least_parallax) {
        Ok(point) => Some(point),
        Err(
            TriangulationError::Behind { .. }
            | TriangulationError::Parallax { .. }
            | TriangulationError::AtInfinity { .. },
        ) if least_parallax == 0.0 => {
            let [first, second] = views.map(|view| view.centre());
            let direction = views[0].ray().normalize() + views[1].ray().normalize();
            let distance = FAR * (first - second).norm();
            Some(0.5 * (first + second) + distance * direction.normalize())
        }
        Err(_) => None,
    }
}
