//! From matches of two pictures to tracks through many.

use super::ReconstructionError;
use super::pictures::{Arranged, Picture, PictureMatch};

// ANCHOR: tracks
/// Keypoints that are joined by matches.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tracks {
    /// The picture and number of each keypoint of a track: two or more, of different pictures.
    pub tracks: Vec<Vec<[usize; 2]>>,
    /// How many matches were refused, because they would have put two keypoints of one picture into a
    /// track.
    pub refused: usize,
}

/// The tracks that matches make of keypoints, all matches taken for right that do not contradict others.
///
/// # Errors
///
/// [`ReconstructionError`] when the input is none.
pub fn join_matches(
    pictures: &[Picture],
    matches: &[PictureMatch],
) -> Result<Tracks, ReconstructionError> {
    let arranged = Arranged::new(pictures, matches)?;
    let all: Vec<[usize; 2]> = arranged.pairs.values().flatten().copied().collect();
    let (tracks, refused) = tracks(&arranged, &all);
    let given = |track: &Vec<usize>| track.iter().map(|k| arranged.given(*k)).collect();
    Ok(Tracks { tracks: tracks.iter().map(given).collect(), refused })
}

/// The keypoints that are joined by matches, each group ascending: at most one keypoint of each
/// picture, and two or more. Second, how many matches were refused.
///
/// Matches that close triangles are joined first, those that close more of them before: three
/// pictures that agree are harder to bring about by accident than two. A match that would put two
/// keypoints of one picture into a track is refused.
pub(super) fn tracks(arranged: &Arranged, matches: &[[usize; 2]]) -> (Vec<Vec<usize>>, usize) {
    let neighbours = neighbours(arranged.count(), matches);
    let mut order: Vec<(usize, [usize; 2])> =
        matches.iter().map(|&[a, b]| (common(&neighbours[a], &neighbours[b]), [a, b])).collect();
    order.sort_by(|one, other| other.0.cmp(&one.0).then(one.1.cmp(&other.1)));
    let mut groups = Groups::new(arranged);
    let refused = order.into_iter().filter(|(_, [a, b])| !groups.join(*a, *b)).count();
    (groups.tracks(), refused)
}
// ANCHOR_END: tracks

/// For each keypoint those that it is matched with, ascending.
fn neighbours(count: usize, matches: &[[usize; 2]]) -> Vec<Vec<usize>> {
    let mut neighbours = vec![Vec::new(); count];
    for &[a, b] in matches {
        neighbours[a].push(b);
        neighbours[b].push(a);
    }
    neighbours.iter_mut().for_each(|list| list.sort_unstable());
    neighbours
}

/// How many entries two ascending lists have in common.
fn common(one: &[usize], other: &[usize]) -> usize {
    let (mut i, mut j, mut count) = (0, 0, 0);
    while i < one.len() && j < other.len() {
        match one[i].cmp(&other[j]) {
            std::cmp::Ordering::Less => i += 1,
            std::cmp::Ordering::Greater => j += 1,
            std::cmp::Ordering::Equal => (i, j, count) = (i + 1, j + 1, count + 1),
        }
    }
    count
}

// ANCHOR: union_find
/// Groups of keypoints by union-find, which know their pictures.
struct Groups<'a> {
    arranged: &'a Arranged,
    /// A keypoint of the same group, nearer to its root; a root is its own.
    towards: Vec<usize>,
    /// Of each root, its members, ascending: and so their pictures ascend too.
    members: Vec<Vec<usize>>,
}

impl<'a> Groups<'a> {
    fn new(arranged: &'a Arranged) -> Self {
        let all = 0..arranged.count();
        Self { arranged, towards: all.clone().collect(), members: all.map(|k| vec![k]).collect() }
    }

    fn root(&mut self, keypoint: usize) -> usize {
        let mut at = keypoint;
        while self.towards[at] != at {
            self.towards[at] = self.towards[self.towards[at]];
            at = self.towards[at];
        }
        at
    }

    // ANCHOR: join
    /// Joins the groups of two keypoints, unless a picture would be in the result twice: `false`.
    fn join(&mut self, a: usize, b: usize) -> bool {
        let (one, other) = (self.root(a), self.root(b));
        if one == other {
            return true;
        }
        let (small, large) = match self.members[one].len() < self.members[other].len() {
            true => (one, other),
            false => (other, one),
        };
        let picture = |keypoint: &usize| self.arranged.picture_of[*keypoint];
        let has = |keypoint: &usize| {
            self.members[large].binary_search_by_key(&picture(keypoint), picture).is_ok()
        };
        if self.members[small].iter().any(has) {
            return false;
        }
        let moved = std::mem::take(&mut self.members[small]);
        self.members[large].extend(moved);
        self.members[large].sort_unstable();
        self.towards[small] = large;
        true
    }
    // ANCHOR_END: join

    fn tracks(self) -> Vec<Vec<usize>> {
        let mut tracks: Vec<_> = self.members.into_iter().filter(|group| group.len() > 1).collect();
        tracks.sort_unstable();
        tracks
    }
}
// ANCHOR_END: union_find
