//! Pictures, what is said to be the same in two of them, and an order that does not depend on how
//! they are given.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use nalgebra::Vector2;

use super::ReconstructionError;
use crate::reprojection::Pinhole;

// ANCHOR: picture
/// A picture: its camera, and the pixels of the points that were found in it.
///
/// Where a lens bends the image, undistort the pixels first.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The intrinsics.
    pub camera: Pinhole,
    /// The pixels, in any order.
    pub keypoints: Vec<Vector2<f64>>,
}

/// That a keypoint of one picture and one of another show the same point, which need not be so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PictureMatch {
    /// Which two pictures.
    pub pictures: [usize; 2],
    /// Which keypoint of each.
    pub keypoints: [usize; 2],
}
// ANCHOR_END: picture

/// Pictures, keypoints and matches in an order of their own: that of the pixels. All keypoints are
/// counted through.
pub(super) struct Arranged {
    /// By which each is sorted, and where it was given.
    pub(super) pictures: Vec<Picture>,
    pub(super) given_picture: Vec<usize>,
    /// The first keypoint of each picture, and the number of all.
    pub(super) first: Vec<usize>,
    pub(super) given_keypoint: Vec<usize>,
    /// The picture of each keypoint.
    pub(super) picture_of: Vec<usize>,
    /// The matches of two pictures, the smaller one first, ascending.
    pub(super) pairs: BTreeMap<[usize; 2], Vec<[usize; 2]>>,
}

impl Arranged {
    // ANCHOR: arranged
    /// Sorts pictures by their pixels, keypoints by their pixels and, where two are the same, by
    /// what they are matched with.
    pub(super) fn new(
        given: &[Picture],
        matches: &[PictureMatch],
    ) -> Result<Self, ReconstructionError> {
        check(given, matches)?;
        let sorted: Vec<Vec<Vector2<f64>>> = given
            .iter()
            .map(|picture| {
                let mut pixels = picture.keypoints.clone();
                pixels.sort_by(by_pixel);
                pixels
            })
            .collect();
        let mut given_picture: Vec<usize> = (0..given.len()).collect();
        given_picture.sort_by(|a, b| compare(&sorted[*a], &sorted[*b]));
        let place = inverse(&given_picture);
        let partners = partners(given, matches, &place);
        let (mut first, mut given_keypoint, mut picture_of) = (vec![0], Vec::new(), Vec::new());
        let mut pictures = Vec::new();
        let mut number: Vec<Vec<usize>> = vec![Vec::new(); given.len()];
        for (at, &from) in given_picture.iter().enumerate() {
            let Picture { camera, keypoints } = &given[from];
            let mut order: Vec<usize> = (0..keypoints.len()).collect();
            order.sort_by(|a, b| {
                let by_partner = || compare_partners(&partners[from][*a], &partners[from][*b]);
                by_pixel(&keypoints[*a], &keypoints[*b]).then_with(by_partner)
            });
            number[from] = inverse(&order).iter().map(|k| first[at] + k).collect();
            let keypoints = order.iter().map(|k| keypoints[*k]).collect();
            pictures.push(Picture { camera: *camera, keypoints });
            first.push(first[at] + order.len());
            picture_of.extend(std::iter::repeat_n(at, order.len()));
            given_keypoint.extend(order);
        }
        let mut pairs: BTreeMap<[usize; 2], Vec<[usize; 2]>> = BTreeMap::new();
        for PictureMatch { pictures: [a, b], keypoints: [i, j] } in matches {
            let (one, other) = ((place[*a], number[*a][*i]), (place[*b], number[*b][*j]));
            let (one, other) = if one < other { (one, other) } else { (other, one) };
            pairs.entry([one.0, other.0]).or_default().push([one.1, other.1]);
        }
        for matches in pairs.values_mut() {
            matches.sort_unstable();
            matches.dedup();
        }
        Ok(Self { pictures, given_picture, first, given_keypoint, picture_of, pairs })
    }
    // ANCHOR_END: arranged

    /// The pixel of a keypoint.
    pub(super) fn pixel(&self, keypoint: usize) -> Vector2<f64> {
        let picture = self.picture_of[keypoint];
        self.pictures[picture].keypoints[keypoint - self.first[picture]]
    }

    /// The picture and the keypoint as they were given.
    pub(super) fn given(&self, keypoint: usize) -> [usize; 2] {
        [self.given_picture[self.picture_of[keypoint]], self.given_keypoint[keypoint]]
    }

    /// How many keypoints there are.
    pub(super) fn count(&self) -> usize {
        self.picture_of.len()
    }
}

/// For each keypoint the pictures and pixels with which it is matched, ascending.
type Partners = Vec<Vec<Vec<(usize, Vector2<f64>)>>>;

fn partners(given: &[Picture], matches: &[PictureMatch], place: &[usize]) -> Partners {
    let mut partners: Partners =
        given.iter().map(|picture| vec![Vec::new(); picture.keypoints.len()]).collect();
    for PictureMatch { pictures: [a, b], keypoints: [i, j] } in matches {
        partners[*a][*i].push((place[*b], given[*b].keypoints[*j]));
        partners[*b][*j].push((place[*a], given[*a].keypoints[*i]));
    }
    for keypoint in partners.iter_mut().flatten() {
        keypoint.sort_by(|one, other| one.0.cmp(&other.0).then(by_pixel(&one.1, &other.1)));
    }
    partners
}

fn compare_partners(one: &[(usize, Vector2<f64>)], other: &[(usize, Vector2<f64>)]) -> Ordering {
    let differing = one.iter().zip(other).map(|(a, b)| a.0.cmp(&b.0).then(by_pixel(&a.1, &b.1)));
    first_difference(differing).then(one.len().cmp(&other.len()))
}

fn compare(one: &[Vector2<f64>], other: &[Vector2<f64>]) -> Ordering {
    let differing = one.iter().zip(other).map(|(a, b)| by_pixel(a, b));
    first_difference(differing).then(one.len().cmp(&other.len()))
}

fn first_difference(mut orders: impl Iterator<Item = Ordering>) -> Ordering {
    orders.find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

fn by_pixel(a: &Vector2<f64>, b: &Vector2<f64>) -> Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
}

/// Where each entry of a permutation stands.
fn inverse(order: &[usize]) -> Vec<usize> {
    let mut places = vec![0; order.len()];
    for (place, entry) in order.iter().enumerate() {
        places[*entry] = place;
    }
    places
}

/// That the numbers are numbers, and that what matches name is there.
fn check(given: &[Picture], matches: &[PictureMatch]) -> Result<(), ReconstructionError> {
    for (picture, Picture { camera: Pinhole { fx, fy, cx, cy }, keypoints }) in
        given.iter().enumerate()
    {
        Pinhole::new(*fx, *fy, *cx, *cy)
            .map_err(|error| ReconstructionError::Camera { picture, error })?;
        let is_finite = |pixel: &Vector2<f64>| pixel.x.is_finite() && pixel.y.is_finite();
        if let Some(keypoint) = keypoints.iter().position(|pixel| !is_finite(pixel)) {
            return Err(ReconstructionError::Keypoint { picture, keypoint });
        }
    }
    for (at, PictureMatch { pictures, keypoints }) in matches.iter().enumerate() {
        let is_there = |side: usize| {
            let picture = given.get(pictures[side]);
            picture.is_some_and(|picture| keypoints[side] < picture.keypoints.len())
        };
        if let Some(side) = [0, 1].into_iter().find(|side| !is_there(*side)) {
            let (picture, keypoint) = (pictures[side], keypoints[side]);
            return Err(ReconstructionError::Match { at, picture, keypoint });
        }
        if pictures[0] == pictures[1] {
            return Err(ReconstructionError::WithItself { at, picture: pictures[0] });
        }
    }
    Ok(())
}
