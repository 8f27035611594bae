//! The factors of a problem in the order in which elimination wants them: landmark by landmark,
//! and within a landmark by the row of the other variable.

use std::ops::Range;
use std::slice::ChunksExact;

use super::Manifold;
use super::linearized::Linearized;
use super::ordering::{envelope, neighbours, reverse_cuthill_mckee};
use super::problem::Problem;
use super::solver::SolveError;
use super::tiles::{Member, Place, Role, Roles, Tiles};

// ANCHOR: landmark
/// A landmark: where its coordinates are, and where its lists begin and end.
#[derive(Debug, Clone)]
pub struct Landmark {
    /// Its first coordinate in a step.
    pub coordinate: usize,
    /// Its part of [`Structure::runs`].
    pub runs: Range<usize>,
    /// Its part of [`Structure::slots`].
    pub slots: Range<usize>,
    /// The rows of the Jacobian that depend on it.
    pub rows: Range<usize>,
    /// The border's row of blocks, when some of them depend on it too.
    pub border: Option<usize>,
}

/// The rows of the Jacobian that depend on a landmark and on one other variable.
#[derive(Debug, Clone)]
pub struct Slot {
    /// That variable's row of blocks in the Schur complement.
    pub variable: usize,
    /// A part of the landmark's rows.
    pub rows: Range<usize>,
}

/// Factors of one group that see the same landmark and stand one after the other.
#[derive(Debug, Clone)]
pub struct Run {
    /// Index of the group.
    pub group: usize,
    /// Their part of [`Structure::factors`].
    pub factors: Range<usize>,
    /// Their rows of the Jacobian.
    pub rows: Range<usize>,
    /// Their part of [`Structure::on_border`].
    pub on_border: Range<usize>,
}
// ANCHOR_END: landmark

/// A variable of the border that a factor of a run sees.
#[derive(Debug, Clone, Copy)]
pub struct OnBorder {
    /// The factor's number in the run.
    pub factor: usize,
    /// The variable's in the factor.
    pub slot: usize,
    /// Its first coordinate in the border.
    pub first: usize,
}

/// Which of the variables of a group's factors is the landmark, and which has a row of blocks that
/// is not the border.
#[derive(Debug, Clone, Copy, Default)]
pub struct Places {
    pub landmark: usize,
    pub other: Option<usize>,
}

/// The factors of one group that see no landmark.
#[derive(Debug, Clone)]
pub struct Others {
    pub group: usize,
    /// Places in the group.
    pub factors: Vec<u32>,
    /// Where their variables stand, factor by factor.
    pub variables: Vec<Option<Place>>,
}

impl Others {
    /// Where a factor's variables stand that move, each with the derivatives by it, row by row.
    pub fn slopes<'a>(
        &'a self,
        linear: &'a Linearized,
        factor: usize,
    ) -> impl Iterator<Item = (Place, ChunksExact<'a, f64>)> {
        let (each, count) = (linear.rows(), self.variables.len() / self.factors.len());
        let variables = &self.variables[factor * count..(factor + 1) * count];
        variables.iter().enumerate().filter_map(move |(slot, place)| {
            let (place, columns) = ((*place)?, linear.columns(slot));
            let size = each * columns;
            Some((place, linear.jacobian(slot)[factor * size..][..size].chunks_exact(columns)))
        })
    }
}

// ANCHOR: structure
/// The structure of a problem with landmarks. It stays the same from step to step.
#[derive(Debug, Clone, Default)]
pub struct Structure {
    pub landmarks: Vec<Landmark>,
    /// By landmark, the factors that see it.
    pub runs: Vec<Run>,
    /// Places of factors in their groups.
    pub factors: Vec<u32>,
    /// How many rows of the Jacobian depend on landmarks.
    pub rows: usize,
    /// By landmark, the variables that see it, ascending.
    pub slots: Vec<Slot>,
    /// By run, the variables of the border.
    pub on_border: Vec<OnBorder>,
    /// By group.
    pub places: Vec<Places>,
    /// What sees no landmark.
    pub others: Vec<Others>,
    /// For each row of blocks in the Schur complement its variables.
    pub variables: Vec<Vec<Member>>,
    /// The row that variables share which any factor may see.
    pub border: Option<usize>,
    /// By row, the first column in which something stands.
    pub first_columns: Vec<usize>,
    /// Coordinates of rows that are held, or nobody's: row and axis.
    pub held: Vec<(usize, usize)>,
}
// ANCHOR_END: structure

/// A factor that sees a landmark, and the row of blocks of its other variable.
#[derive(Clone)]
struct Seen {
    row: Option<usize>,
    group: usize,
    factor: u32,
    /// How many numbers its residual has.
    len: usize,
    /// The variables of the border that it sees, with their first coordinates there.
    on_border: Vec<(usize, usize)>,
}

impl Structure {
    /// The structure of a problem in which the variables of the kind `L` are landmarks, and all
    /// others that move stand in tiles.
    pub fn new<L: Manifold>(problem: &Problem, tiles: &Tiles) -> Result<Self, SolveError> {
        let mut roles = Roles::of::<L>(problem, tiles)?;
        let mut structure = Self { border: roles.border, ..Self::default() };
        let mut seen_by = vec![Vec::new(); roles.landmarks.len()];
        for group in 0..problem.group_count() {
            structure.sort_group(problem, group, (&roles, tiles.seen), &mut seen_by)?;
        }
        let order = structure.order(&seen_by, roles.variables.len());
        roles.reorder(&order);
        for row in seen_by.iter_mut().flatten().filter_map(|seen| seen.row.as_mut()) {
            *row = order[*row];
        }
        let places = structure.others.iter_mut().flat_map(|other| &mut other.variables);
        places.flatten().for_each(|place| place.row = order[place.row]);
        for (coordinate, seen_by) in roles.landmarks.into_iter().zip(seen_by) {
            structure.add_landmark(coordinate, seen_by);
        }
        structure.landmarks.shrink_to_fit();
        structure.runs.shrink_to_fit();
        structure.factors.shrink_to_fit();
        structure.slots.shrink_to_fit();
        structure.on_border.shrink_to_fit();
        (structure.variables, structure.held) = (roles.variables, roles.held);
        Ok(structure)
    }

    /// Gives each factor of a group to its landmark.
    fn sort_group(
        &mut self,
        problem: &Problem,
        group: usize,
        (roles, seen): (&Roles, usize),
        seen_by: &mut [Vec<Seen>],
    ) -> Result<(), SolveError> {
        let factors = problem.group(group);
        let mut places = Places::default();
        let mut others = Others { group, factors: Vec::new(), variables: Vec::new() };
        let mut before = None;
        for factor in 0..factors.count() as u32 {
            let mut named = Vec::new();
            factors.variables(factor as usize, &mut |index| named.push(roles.of[index]));
            let wrong =
                |what| SolveError::Structure { factor: problem.number(group, factor), what };
            let landmark = named.iter().position(|role| matches!(role, Role::Landmark(_)));
            let place = |role: &Role| if let Role::Row(place) = role { Some(*place) } else { None };
            let stand: Vec<Option<Place>> = named.iter().map(place).collect();
            let moving = stand.iter().flatten().count();
            let Some(Role::Landmark(index)) = landmark.map(|slot| named[slot]) else {
                if moving > 0 {
                    others.factors.push(factor);
                    others.variables.extend(stand);
                }
                continue;
            };
            places.landmark = landmark.unwrap_or_default();
            if before.replace(places.landmark).is_some_and(|slot| slot != places.landmark) {
                return Err(wrong("has its landmark in another place than others of its type"));
            }
            if moving + 1 < named.iter().filter(|role| **role != Role::Held).count() {
                return Err(wrong("sees two landmarks; only factors of one can be eliminated"));
            }
            let (other, on_border) = roles
                .beside_landmark(&stand, |slot| factors.columns()[slot] == seen)
                .map_err(wrong)?;
            let slot = other.map(|(slot, _)| slot);
            if slot.and(places.other).is_some() && places.other != slot {
                return Err(wrong(
                    "has the variable that moves beside its landmark in another place than others of its type",
                ));
            }
            places.other = places.other.or(slot);
            let (row, len) = (other.map(|(_, row)| row), factors.rows());
            seen_by[index].push(Seen { row, group, factor, len, on_border });
        }
        self.places.push(places);
        if !others.factors.is_empty() {
            self.others.push(others);
        }
        Ok(())
    }

    /// The new place of each row: that which keeps the envelope small. The border stays the last.
    fn order(&mut self, seen_by: &[Vec<Seen>], rows: usize) -> Vec<usize> {
        let inner = rows - usize::from(self.border.is_some());
        let of_landmarks = seen_by.iter().map(|seen| seen.iter().filter_map(|s| s.row).collect());
        let of_others = self.others.iter().flat_map(|others| {
            let each = others.variables.len() / others.factors.len();
            let rows = |places: &[Option<Place>]| {
                let rows = places.iter().flatten().map(|place| place.row);
                rows.filter(|row| *row < inner).collect()
            };
            others.variables.chunks(each).map(rows)
        });
        let neighbours = neighbours(inner, of_landmarks.chain(of_others));
        let orders = [(0..inner).collect(), reverse_cuthill_mckee(&neighbours)];
        let [before, after] = orders.map(|order| (envelope(&neighbours, &order), order));
        let stored = |first: &[usize]| first.iter().zip(0..).map(|(f, row)| row - f).sum::<usize>();
        let better = if stored(&after.0) < stored(&before.0) { after } else { before };
        let (mut first_columns, mut order) = better;
        first_columns.extend(self.border.map(|_| 0));
        order.extend(self.border);
        self.first_columns = first_columns;
        order
    }

    /// Adds a landmark with the factors that see it. The rows of one variable stand together, in
    /// ascending order of variables, and behind them those of variables that are held.
    fn add_landmark(&mut self, coordinate: usize, mut seen_by: Vec<Seen>) {
        let (runs, slots, rows) = (self.runs.len(), self.slots.len(), self.rows);
        seen_by.sort_by_key(|seen| (seen.row.is_none(), seen.row, seen.group));
        let sees_border = seen_by.iter().any(|seen| !seen.on_border.is_empty());
        let border = self.border.filter(|_| sees_border);
        for Seen { row, group, factor, len, on_border } in seen_by {
            let (at, end, of_border) = (self.factors.len(), self.rows + len, self.on_border.len());
            self.factors.push(factor);
            if self.runs[runs..].last().is_none_or(|run| run.group != group) {
                let (factors, rows) = (at..at, self.rows..self.rows);
                self.runs.push(Run { group, factors, rows, on_border: of_border..of_border });
            }
            let run = self.runs.last_mut().expect("there is one by now");
            let of_factor = on_border.into_iter().map(|(slot, first)| {
                let factor = at - run.factors.start;
                OnBorder { factor, slot, first }
            });
            self.on_border.extend(of_factor);
            (run.factors.end, run.rows.end) = (at + 1, end);
            run.on_border.end = self.on_border.len();
            match (row, self.slots[slots..].last_mut()) {
                (Some(row), Some(slot)) if slot.variable == row => slot.rows.end = end,
                (Some(row), _) => self.slots.push(Slot { variable: row, rows: self.rows..end }),
                (None, _) => {}
            }
            self.rows = end;
        }
        let (runs, slots) = (runs..self.runs.len(), slots..self.slots.len());
        let rows = rows..self.rows;
        self.landmarks.push(Landmark { coordinate, runs, slots, rows, border });
    }

    /// How many rows of blocks the Schur complement has.
    pub fn row_count(&self) -> usize {
        self.variables.len()
    }

    // ANCHOR: block_products
    /// Products of two blocks that elimination takes: one for each pair of variables that share a
    /// landmark, a variable and itself included.
    ///
    /// Implements {eq:block-products}.
    pub fn block_products(&self) -> usize {
        let of_landmark = |landmark: &Landmark| {
            let variables = landmark.slots.len() + landmark.border.iter().len();
            variables * (variables + 1) / 2
        };
        self.landmarks.iter().map(of_landmark).sum()
    }
    // ANCHOR_END: block_products

    /// The memory that it holds, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.landmarks.as_slice())
            + size_of_val(self.runs.as_slice())
            + size_of_val(self.factors.as_slice())
            + size_of_val(self.slots.as_slice())
            + size_of_val(self.on_border.as_slice())
            + size_of::<usize>() * 6 * self.variables.len()
    }
}
