//! The factors of a problem in the order in which elimination wants them: landmark by landmark,
//! and within a landmark by the row of the other variable.

use std::ops::Range;

use super::Manifold;
use super::linearized::Linearized;
use super::ordering::{envelope, neighbours, reverse_cuthill_mckee};
use super::problem::Problem;
use super::solver::SolveError;

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
}

/// The rows of the Jacobian that depend on a landmark and on one other variable.
#[derive(Debug, Clone)]
pub struct Slot {
    /// The variable's row of blocks in the Schur complement.
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
}
// ANCHOR_END: landmark

/// Which of the variables of a group's factors is the landmark, and which has a row of blocks.
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
    /// The rows of blocks of their variables, factor by factor.
    pub variables: Vec<Option<usize>>,
}

impl Others {
    /// The rows of blocks of a factor's variables that move, each with the derivatives by it.
    pub fn slopes<'a, const D: usize>(
        &'a self,
        linear: &'a Linearized,
        factor: usize,
    ) -> impl Iterator<Item = (usize, &'a [[f64; D]])> {
        let (each, count) = (linear.rows(), self.variables.len() / self.factors.len());
        let variables = &self.variables[factor * count..(factor + 1) * count];
        variables.iter().enumerate().filter_map(move |(slot, row)| {
            Some(((*row)?, &linear.rows_of(slot)[factor * each..(factor + 1) * each]))
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
    /// By group.
    pub places: Vec<Places>,
    /// What sees no landmark.
    pub others: Vec<Others>,
    /// For each row of blocks in the Schur complement the first coordinates of its variables.
    pub variables: Vec<Vec<usize>>,
    /// By row, the first column in which something stands.
    pub first_columns: Vec<usize>,
    /// Coordinates that are held although their variable has a row: row and axis.
    pub held: Vec<(usize, usize)>,
}
// ANCHOR_END: structure

/// What a variable is to the elimination.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Held,
    Landmark(usize),
    Row(usize),
}

/// A factor that sees a landmark, and the row of blocks of its other variable.
#[derive(Clone, Copy)]
struct Seen {
    row: Option<usize>,
    group: usize,
    factor: u32,
    /// How many numbers its residual has.
    len: usize,
}

impl Structure {
    /// The structure of a problem in which the variables of the kind `L` are landmarks, and all
    /// others that move have `dimension` coordinates.
    pub fn new<L: Manifold>(problem: &Problem, dimension: usize) -> Result<Self, SolveError> {
        let mut roles = Roles::of::<L>(problem, dimension)?;
        let mut structure = Self::default();
        let mut seen_by = vec![Vec::new(); roles.landmarks.len()];
        for group in 0..problem.group_count() {
            structure.sort_group(problem, group, &roles, &mut seen_by)?;
        }
        let order = structure.order(&seen_by, roles.variables.len());
        roles.reorder(&order);
        let new_row = |row: &mut Option<usize>| *row = row.map(|row| order[row]);
        seen_by.iter_mut().flatten().for_each(|seen| new_row(&mut seen.row));
        structure.others.iter_mut().flat_map(|other| &mut other.variables).for_each(new_row);
        for (coordinate, seen_by) in roles.landmarks.into_iter().zip(seen_by) {
            structure.add_landmark(coordinate, seen_by);
        }
        structure.landmarks.shrink_to_fit();
        structure.runs.shrink_to_fit();
        structure.factors.shrink_to_fit();
        structure.slots.shrink_to_fit();
        (structure.variables, structure.held) = (roles.variables, roles.held);
        Ok(structure)
    }

    /// Gives each factor of a group to its landmark.
    fn sort_group(
        &mut self,
        problem: &Problem,
        group: usize,
        roles: &Roles,
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
            let row = |role: &Role| if let Role::Row(row) = role { Some(*row) } else { None };
            let rows: Vec<Option<usize>> = named.iter().map(row).collect();
            let moving = rows.iter().flatten().count();
            let Some(Role::Landmark(index)) = landmark.map(|slot| named[slot]) else {
                if moving > 0 {
                    others.factors.push(factor);
                    others.variables.extend(rows);
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
            let other = rows.iter().position(Option::is_some);
            if moving > 1 || (places.other.is_some() && other.is_some() && places.other != other) {
                return Err(wrong("has a landmark and more than one variable that moves besides"));
            }
            places.other = places.other.or(other);
            let row = other.and_then(|slot| rows[slot]);
            seen_by[index].push(Seen { row, group, factor, len: factors.rows() });
        }
        self.places.push(places);
        if !others.factors.is_empty() {
            self.others.push(others);
        }
        Ok(())
    }

    /// The new place of each row: that which keeps the envelope small.
    fn order(&mut self, seen_by: &[Vec<Seen>], rows: usize) -> Vec<usize> {
        let of_landmarks = seen_by.iter().map(|seen| seen.iter().filter_map(|s| s.row).collect());
        let of_others = self.others.iter().flat_map(|others| {
            let each = others.variables.len() / others.factors.len();
            others.variables.chunks(each).map(|rows| rows.iter().flatten().copied().collect())
        });
        let neighbours = neighbours(rows, of_landmarks.chain(of_others));
        let orders = [(0..rows).collect(), reverse_cuthill_mckee(&neighbours)];
        let [before, after] = orders.map(|order| (envelope(&neighbours, &order), order));
        let stored = |first: &[usize]| first.iter().zip(0..).map(|(f, row)| row - f).sum::<usize>();
        let better = if stored(&after.0) < stored(&before.0) { after } else { before };
        self.first_columns = better.0;
        better.1
    }

    /// Adds a landmark with the factors that see it. The rows of one variable stand together, in
    /// ascending order of variables, and behind them those of variables that are held.
    fn add_landmark(&mut self, coordinate: usize, mut seen_by: Vec<Seen>) {
        let (runs, slots, rows) = (self.runs.len(), self.slots.len(), self.rows);
        seen_by.sort_by_key(|seen| (seen.row.is_none(), seen.row, seen.group));
        for Seen { row, group, factor, len } in seen_by {
            let (at, end) = (self.factors.len(), self.rows + len);
            self.factors.push(factor);
            match self.runs[runs..].last_mut().filter(|run| run.group == group) {
                Some(run) => (run.factors.end, run.rows.end) = (at + 1, end),
                None => self.runs.push(Run { group, factors: at..at + 1, rows: self.rows..end }),
            }
            match (row, self.slots[slots..].last_mut()) {
                (Some(row), Some(slot)) if slot.variable == row => slot.rows.end = end,
                (Some(row), _) => self.slots.push(Slot { variable: row, rows: self.rows..end }),
                (None, _) => {}
            }
            self.rows = end;
        }
        let (runs, slots) = (runs..self.runs.len(), slots..self.slots.len());
        self.landmarks.push(Landmark { coordinate, runs, slots, rows: rows..self.rows });
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
        let pairs = |landmark: &Landmark| landmark.slots.len() * (landmark.slots.len() + 1) / 2;
        self.landmarks.iter().map(pairs).sum()
    }
    // ANCHOR_END: block_products

    /// The memory that it holds, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.landmarks.as_slice())
            + size_of_val(self.runs.as_slice())
            + size_of_val(self.factors.as_slice())
            + size_of_val(self.slots.as_slice())
            + size_of::<usize>() * 4 * self.variables.len()
    }
}

/// What each variable of a problem is to the elimination.
struct Roles {
    of: Vec<Role>,
    /// First coordinate of each landmark.
    landmarks: Vec<usize>,
    /// First coordinates of the variables of each row.
    variables: Vec<Vec<usize>>,
    /// Row and axis of single coordinates that are held.
    held: Vec<(usize, usize)>,
}

impl Roles {
    fn of<L: Manifold>(problem: &Problem, dimension: usize) -> Result<Self, SolveError> {
        let columns = problem.columns();
        let mut roles =
            Self { of: Vec::new(), landmarks: Vec::new(), variables: Vec::new(), held: Vec::new() };
        let mut of_blocks: Vec<Option<Role>> = vec![None; columns.blocks.len()];
        for variable in 0..problem.values().len() {
            let coordinates = problem.values().coordinates_of(variable).unwrap_or_default();
            let own = &columns.of[coordinates.clone()];
            let Some(block) = columns.block_of(coordinates.clone()) else {
                roles.of.push(Role::Held);
                continue;
            };
            let is_landmark = problem.values().key::<L>(variable).is_some();
            let moves_whole = own.iter().all(Option::is_some);
            let role = match of_blocks[block] {
                Some(Role::Landmark(_)) => return Err(SolveError::TiedLandmark { variable }),
                Some(tied) => tied,
                None if is_landmark && moves_whole => Role::Landmark(roles.landmarks.len()),
                None if is_landmark || own.len() != dimension => {
                    return Err(SolveError::Block { variable, found: own.len(), dimension });
                }
                None => {
                    let row = roles.variables.len();
                    roles.variables.push(Vec::new());
                    let held = own.iter().enumerate().filter(|(_, column)| column.is_none());
                    roles.held.extend(held.map(|(axis, _)| (row, axis)));
                    Role::Row(row)
                }
            };
            match role {
                Role::Row(row) => roles.variables[row].push(coordinates.start),
                _ => roles.landmarks.push(coordinates.start),
            }
            of_blocks[block] = Some(role);
            roles.of.push(role);
        }
        Ok(roles)
    }

    /// Gives each row its new place.
    fn reorder(&mut self, order: &[usize]) {
        let mut variables = vec![Vec::new(); order.len()];
        for (row, list) in self.variables.drain(..).enumerate() {
            variables[order[row]] = list;
        }
        self.variables = variables;
        self.held.iter_mut().for_each(|(row, _)| *row = order[*row]);
    }
}
