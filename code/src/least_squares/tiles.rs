//! Which variables share a row of blocks in the Schur complement, and which are landmarks.

use std::ops::Range;

use super::Manifold;
use super::problem::Problem;
use super::solver::SolveError;

/// How variables share the rows of blocks of a Schur complement.
#[derive(Debug, Clone, Copy)]
pub struct Tiles<'a> {
    /// How many coordinates a row of blocks has.
    pub size: usize,
    /// How many of them factors see that see a landmark: the first ones.
    pub seen: usize,
    /// The variables of each row. Those that none of them names stand in the last row together, the
    /// border. `None` gives each variable a row of its own.
    pub variables: Option<&'a [Vec<usize>]>,
}

impl Tiles<'_> {
    /// The variables of a problem, each with the number of its row, row by row. Those of no row come
    /// last, landmarks among them.
    fn sequence(
        &self,
        count: usize,
        is_landmark: impl Fn(usize) -> bool,
    ) -> Result<Vec<(usize, usize)>, SolveError> {
        let Some(rows) = self.variables else { return Ok((0..count).map(|v| (v, v)).collect()) };
        let each = |(row, variables): (usize, &Vec<usize>)| {
            variables.iter().map(|variable| (row, *variable)).collect::<Vec<_>>()
        };
        let named = rows.iter().enumerate().flat_map(each);
        let mut sequence: Vec<_> = named.filter(|(_, variable)| !is_landmark(*variable)).collect();
        let mut is_named = vec![false; count];
        for &(_, variable) in &sequence {
            let known = is_named.get_mut(variable).ok_or(SolveError::NoSuchVariable { variable });
            *known? = true;
        }
        let others = (0..count).filter(|variable| !is_named[*variable]);
        sequence.extend(others.map(|variable| (rows.len(), variable)));
        Ok(sequence)
    }

    fn check(&self, variable: usize, fits: bool, found: usize) -> Result<(), SolveError> {
        let dimension = self.size;
        if fits { Ok(()) } else { Err(SolveError::Block { variable, found, dimension }) }
    }
}

/// Where a variable stands in the Schur complement: its row of blocks, and its first coordinate in
/// that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    pub row: usize,
    pub first: usize,
}

/// A variable in a row of blocks.
#[derive(Debug, Clone)]
pub struct Member {
    /// Its coordinates in a step.
    pub coordinates: Range<usize>,
    /// Its first coordinate in the row.
    pub first: usize,
}

/// What a variable is to the elimination.
#[derive(Clone, Copy, PartialEq)]
pub enum Role {
    Held,
    Landmark(usize),
    Row(Place),
}

/// The other variables of a factor that sees a landmark: the number and the row of the one that has
/// a row, and the numbers and first coordinates of those on the border.
pub type Beside = (Option<(usize, usize)>, Vec<(usize, usize)>);

/// What each variable of a problem is to the elimination.
pub struct Roles {
    pub of: Vec<Role>,
    /// First coordinate of each landmark.
    pub landmarks: Vec<usize>,
    /// The variables of each row.
    pub variables: Vec<Vec<Member>>,
    /// The row of those that no tile names.
    pub border: Option<usize>,
    /// Row and axis of single coordinates that are held, or nobody's.
    pub held: Vec<(usize, usize)>,
}

impl Roles {
    pub fn of<L: Manifold>(problem: &Problem, tiles: &Tiles) -> Result<Self, SolveError> {
        let (values, columns) = (problem.values(), problem.columns());
        let is_landmark = |variable| values.key::<L>(variable).is_some();
        let mut roles = Self {
            of: vec![Role::Held; values.len()],
            landmarks: Vec::new(),
            variables: Vec::new(),
            border: None,
            held: Vec::new(),
        };
        let (mut of_blocks, mut last_tile) = (vec![None; columns.blocks.len()], None);
        for (tile, variable) in tiles.sequence(values.len(), is_landmark)? {
            let coordinates = values.coordinates_of(variable).unwrap_or_default();
            let Some(block) = columns.block_of(coordinates.clone()) else { continue };
            let moves: Vec<bool> =
                columns.of[coordinates.clone()].iter().map(Option::is_some).collect();
            let role = match of_blocks[block] {
                Some(Role::Landmark(_)) => return Err(SolveError::TiedLandmark { variable }),
                Some(tied) => tied,
                None if is_landmark(variable) => {
                    let moves_in_space = moves.len() == 3 && moves.iter().all(|moves| *moves);
                    tiles.check(variable, moves_in_space, moves.len())?;
                    roles.landmarks.push(coordinates.start);
                    Role::Landmark(roles.landmarks.len() - 1)
                }
                None => {
                    if last_tile.replace(tile) != Some(tile) {
                        roles.variables.push(Vec::new());
                    }
                    Role::Row(roles.place_in_last_row(variable, &moves, tiles)?)
                }
            };
            if let Role::Row(Place { row, first }) = role {
                roles.variables[row].push(Member { coordinates, first });
            }
            of_blocks[block] = Some(role);
            roles.of[variable] = role;
        }
        let has_border =
            last_tile.zip(tiles.variables).is_some_and(|(tile, all)| tile == all.len());
        roles.border = has_border.then(|| roles.variables.len() - 1);
        for row in 0..roles.variables.len() {
            let nobodys = roles.end(row)..tiles.size;
            roles.held.extend(nobodys.map(|axis| (row, axis)));
        }
        Ok(roles)
    }

    /// Sorts the variables of a factor that sees a landmark, or says why it cannot be eliminated.
    pub fn beside_landmark(
        &self,
        places: &[Option<Place>],
        is_as_wide_as_seen: impl Fn(usize) -> bool,
    ) -> Result<Beside, &'static str> {
        let (mut other, mut on_border) = (None, Vec::new());
        for (slot, place) in places.iter().enumerate() {
            let Some(Place { row, first }) = *place else { continue };
            if self.border == Some(row) {
                on_border.push((slot, first));
            } else if first != 0 || !is_as_wide_as_seen(slot) {
                return Err("sees a landmark and another part of a tile than the first");
            } else if other.replace((slot, row)).is_some() {
                return Err("has a landmark and more than one variable that moves besides");
            }
        }
        Ok((other, on_border))
    }

    /// The place behind all variables that the last row has.
    fn place_in_last_row(
        &mut self,
        variable: usize,
        moves: &[bool],
        tiles: &Tiles,
    ) -> Result<Place, SolveError> {
        let row = self.variables.len() - 1;
        let first = self.end(row);
        let end = first + moves.len();
        let fits = end == tiles.size || (end < tiles.size && tiles.variables.is_some());
        tiles.check(variable, fits, end)?;
        let held = moves.iter().enumerate().filter(|(_, moves)| !**moves);
        self.held.extend(held.map(|(axis, _)| (row, first + axis)));
        Ok(Place { row, first })
    }

    /// How many coordinates of a row are somebody's.
    fn end(&self, row: usize) -> usize {
        let ends = self.variables[row].iter().map(|m| m.first + m.coordinates.len());
        ends.max().unwrap_or(0)
    }

    /// Gives each row its new place.
    pub fn reorder(&mut self, order: &[usize]) {
        let mut variables = vec![Vec::new(); order.len()];
        for (row, list) in self.variables.drain(..).enumerate() {
            variables[order[row]] = list;
        }
        self.variables = variables;
        self.held.iter_mut().for_each(|(row, _)| *row = order[*row]);
    }
}
