//! How tracks correct the filter.

use nalgebra::{DMatrix, DVector, Vector3};

use super::landmark::contradicts;
use super::track::entries;
use super::window::{Due, Kept, Waiting};
use super::{
    LinearizedTrack, Msckf, MsckfError, MsckfOptions, PictureReport, Sight, TrackError, landmark,
};
use crate::consistency::{Claimed, Linearization, Point, constrained};
use crate::datasets::tracks::{Feature, Picture};
use crate::factors::BodyPixel;
use crate::filtering::innovation_squared;

/// A track that may correct the filter.
struct Judged<'a> {
    track: usize,
    waiting: &'a Waiting,
    linear: LinearizedTrack,
    landmark: Vector3<f64>,
    /// Where its derivatives were taken.
    at: Vector3<f64>,
}

/// Where the columns of some rows stand in the belief; `None` for what is not estimated.
type Columns = Vec<Option<usize>>;

impl Msckf {
    // ANCHOR: correct
    /// Lets tracks correct the filter, all at once.
    pub(super) fn correct(
        &mut self,
        due: &[Due],
        picture: &Picture,
    ) -> Result<PictureReport, MsckfError> {
        let mut report = PictureReport::default();
        let mut passed = Vec::new();
        for due in due {
            match self.judge(due) {
                Ok(judged) => passed.push(judged),
                Err(refusal) => refusal.count(&mut report),
            }
        }
        // A landmark that enters now has had its pixel of this picture.
        let known = self.window.kept.len();
        for judged in &passed {
            self.keep_landmark(judged)?;
        }
        self.stacked.clear(self.belief.dimension() + 1);
        for Judged { waiting, linear, .. } in &passed {
            let columns = self.columns(waiting);
            linear.constraints().for_each(|row| self.stack(&columns, row));
        }
        report.used = passed.len();
        for place in 0..known {
            match self.kept_rows(&self.window.kept[place], picture) {
                Some((columns, rows)) => {
                    rows.iter().for_each(|row| self.stack(&columns, row));
                    report.used += 1;
                }
                None => report.refused.gated += 1,
            }
        }
        self.stacked.compress();
        report.rows = self.stacked.len();
        if !self.stacked.is_empty() {
            let (jacobian, residual) = self.stacked.system();
            report.claimed = self.apply(jacobian, &residual)?;
        }
        Ok(report)
    }
    // ANCHOR_END: correct

    // ANCHOR: apply
    /// Corrects the belief by whitened rows, and says what they claimed of the free directions.
    pub(super) fn apply(
        &mut self,
        mut jacobian: DMatrix<f64>,
        residual: &DVector<f64>,
    ) -> Result<Claimed, MsckfError> {
        let Linearization { chart, constrained, .. } = self.options.linearization;
        if constrained {
            let nothing = DMatrix::zeros(jacobian.nrows(), 4);
            jacobian = self.constrained(jacobian, &nothing);
        }
        let claimed = Claimed::of(&jacobian, self.belief.directions());
        let chart = (chart, self.state);
        self.belief.correct_on_chart(chart, &jacobian, residual, self.options.form)?;
        Ok(claimed)
    }
    // ANCHOR_END: apply

    /// The rows changed as little as can be to have this product with the free directions.
    fn constrained(&self, rows: DMatrix<f64>, wanted: &DMatrix<f64>) -> DMatrix<f64> {
        constrained(&rows, self.belief.directions(), wanted).unwrap_or(rows)
    }

    // ANCHOR: judge
    /// The rows of a track and its landmark, if it may correct the filter.
    fn judge<'a>(&self, due: &'a Due) -> Result<Judged<'a>, Refusal> {
        let MsckfOptions { ref camera, least_sights, largest_sigma, .. } = self.options;
        let Due { track, ref waiting, is_part } = *due;
        if waiting.len() < least_sights && !is_part {
            return Err(Refusal::Short);
        }
        let sights = self.sights(waiting);
        let landmark = self.place(&sights)?;
        let mut linear = LinearizedTrack::default();
        let at = match self.options.linearization.pixels {
            Point::Latest | Point::First => landmark,
            Point::Truth => self.true_landmark(track).ok_or(Refusal::Landmark)?,
        };
        let camera = (camera, self.options.pixel_sigma);
        linear.linearize_at(&sights, [&landmark, &at], &self.rig().body_from_camera, camera)?;
        linear.project(largest_sigma)?;
        let rows: Vec<&[f64]> = linear.constraints().collect();
        let passes = self.passes(&self.columns(waiting), &rows);
        passes.then_some(Judged { track, waiting, linear, landmark, at }).ok_or(Refusal::Gated)
    }
    // ANCHOR_END: judge

    /// Where the landmark of a track is, or whether its absence is a contradiction.
    fn place(&self, sights: &[Sight]) -> Result<Vector3<f64>, Refusal> {
        let MsckfOptions { ref camera, pixel_sigma, least_parallax, .. } = self.options;
        let (body_from_camera, camera) = (self.rig().body_from_camera, (camera, pixel_sigma));
        let contradicts = || contradicts(sights, &body_from_camera, camera);
        landmark(sights, &body_from_camera, camera, least_parallax)
            .map_err(|_| if contradicts() { Refusal::Unmet } else { Refusal::Landmark })
    }

    /// The pixels of a track, with the poses as they are believed.
    fn sights(&self, waiting: &Waiting) -> Vec<Sight> {
        let sight = |&(serial, pixel): &(usize, _)| {
            let (pose, linearized_at) = self.pose(serial)?;
            Some(Sight { pose, linearized_at, pixel })
        };
        waiting.iter().filter_map(sight).collect()
    }

    /// The columns of a track's rows: those of its poses, then those of the camera.
    fn columns(&self, waiting: &Waiting) -> Columns {
        let pose = |(serial, _): &(usize, _)| {
            let place = self.window.place(*serial)?;
            Some(self.window.clones[place].variable)
        };
        let camera = self.extrinsics.map(|key| key.index());
        let variables = waiting.iter().map(pose).chain([camera]);
        variables.flat_map(|variable| self.coordinates::<6>(variable)).collect()
    }

    /// The coordinates of a variable in the belief.
    fn coordinates<const N: usize>(&self, variable: Option<usize>) -> [Option<usize>; N] {
        let own = variable.and_then(|variable| self.belief.values().coordinates_of(variable));
        std::array::from_fn(|axis| own.as_ref().map(|own| own.start + axis))
    }

    // ANCHOR: passes
    /// Whether the normalized innovation squared of some rows, each with its residual at the end,
    /// passes the gate.
    fn passes(&self, columns: &Columns, rows: &[&[f64]]) -> bool {
        if self.options.gate == 1.0 {
            return true;
        }
        let named = columns.iter().enumerate();
        let named: Vec<(usize, usize)> =
            named.filter_map(|(place, column)| Some((place, (*column)?))).collect();
        let count = rows.len();
        let jacobian = DMatrix::from_fn(count, named.len(), |row, at| rows[row][named[at].0]);
        let residual = DVector::from_fn(count, |row, _| rows[row][columns.len()]);
        let covariance = self.belief.covariance();
        let covariance = DMatrix::from_fn(named.len(), named.len(), |row, column| {
            covariance[(named[row].1, named[column].1)]
        });
        let squared = innovation_squared(&covariance, &jacobian, &residual);
        squared.is_ok_and(|squared| self.gates.get(count).is_some_and(|gate| squared <= *gate))
    }
    // ANCHOR_END: passes

    /// Adds a row to those that correct the filter.
    fn stack(&mut self, columns: &Columns, from: &[f64]) {
        let into = self.stacked.add();
        for (number, column) in from.iter().zip(columns) {
            if let Some(column) = column {
                into[*column] = *number;
            }
        }
        if let (Some(into), Some(residual)) = (into.last_mut(), from.last()) {
            *into = *residual;
        }
    }

    // ANCHOR: keep_landmark
    /// Adds the landmark of a track to the state, if it was seen from the whole window and there is
    /// room. The first three rows of the track, R e_f + H e + r with white noise, say how its error
    /// follows from that of the poses.
    fn keep_landmark(&mut self, judged: &Judged) -> Result<(), MsckfError> {
        let Judged { track, waiting, ref linear, landmark, at } = *judged;
        let is_full = waiting.len() >= self.options.clones;
        let has_room = self.window.kept.len() < self.options.landmarks;
        let Some(inverse) = linear.landmark_root().try_inverse().filter(|_| is_full && has_room)
        else {
            return Ok(());
        };
        let rows = linear.rows();
        let column = |place: usize| Vector3::from_fn(|row, _| rows.row(row)[place]);
        let mut by_all = DMatrix::zeros(3, self.belief.dimension());
        for (place, into) in self.columns(waiting).iter().enumerate() {
            if let Some(into) = into {
                by_all.set_column(*into, &(-inverse * column(3 + place)));
            }
        }
        if self.options.linearization.constrained {
            let moved = self.motions().map(|motion| motion.of_point(&at));
            let wanted = DMatrix::from_fn(3, 4, |row, column| moved[column][row]);
            by_all = self.constrained(by_all, &wanted);
        }
        let estimate = landmark - inverse * column(rows.width() - 1);
        let noise = inverse * inverse.transpose();
        let noise = DMatrix::from_column_slice(3, 3, noise.as_slice());
        let key = self.belief.add_function(estimate, &by_all, &noise)?;
        self.window.kept.push(Kept { track, variable: key.index(), first: at });
        Ok(())
    }
    // ANCHOR_END: keep_landmark

    /// The two rows of a kept landmark, if its pixel passes the gate, and their columns: those of the
    /// newest pose, of the landmark and of the camera.
    fn kept_rows(&self, kept: &Kept, picture: &Picture) -> Option<(Columns, [[f64; 16]; 2])> {
        let feature = seen(picture, kept.track)?;
        let newest = self.window.clones.last()?;
        let (pose, linearized_at) = self.pose(newest.serial)?;
        let values = self.belief.values();
        let landmark = *values.get(values.key::<Vector3<f64>>(kept.variable)?)?;
        let linearized = match self.options.linearization.pixels {
            Point::Latest => landmark,
            // At the truth, its track was linearized there too.
            Point::First | Point::Truth => kept.first,
        };
        let (camera, inverse_sigma) = (&self.options.camera, 1.0 / self.options.pixel_sigma);
        let pixel = BodyPixel { camera, pixel: feature.pixel, inverse_sigma };
        let extrinsics = self.rig().body_from_camera;
        let residual = pixel.residual((&pose, &landmark, &extrinsics))?;
        if !residual.sum().is_finite() {
            return None;
        }
        let (_, (by_pose, by_landmark, by_camera)) =
            pixel.linearize((&linearized_at, &linearized, &extrinsics))?;
        let rows = [0, 1].map(|axis| {
            let mut row = [0.0; 16];
            row[..6].copy_from_slice(&entries(&by_pose, axis));
            row[6..9].copy_from_slice(&entries(&by_landmark, axis));
            row[9..15].copy_from_slice(&entries(&by_camera, axis));
            row[15] = residual[axis];
            row
        });
        let columns: Columns = (self.coordinates::<6>(Some(newest.variable)).into_iter())
            .chain(self.coordinates::<3>(Some(kept.variable)))
            .chain(self.coordinates::<6>(self.extrinsics.map(|key| key.index())))
            .collect();
        let slices: Vec<&[f64]> = rows.iter().map(|row| &row[..]).collect();
        self.passes(&columns, &slices).then_some((columns, rows))
    }
}

/// The feature of a track in a picture.
pub(super) fn seen(picture: &Picture, track: usize) -> Option<&Feature> {
    let at = picture.features.binary_search_by_key(&track, |feature| feature.track).ok()?;
    picture.features.get(at)
}

/// Why a track does not correct the filter.
enum Refusal {
    Short,
    Landmark,
    Unmet,
    Rank,
    Gated,
}

impl Refusal {
    fn count(&self, report: &mut PictureReport) {
        let refused = &mut report.refused;
        *match self {
            Self::Short => &mut refused.short,
            Self::Landmark => &mut refused.landmark,
            Self::Unmet => &mut refused.unmet,
            Self::Rank => &mut refused.rank,
            Self::Gated => &mut refused.gated,
        } += 1;
    }
}

impl From<TrackError> for Refusal {
    fn from(error: TrackError) -> Self {
        match error {
            TrackError::Behind { .. } => Self::Landmark,
            TrackError::Rank { .. } => Self::Rank,
        }
    }
}
