//! Orders of the rows of a symmetric matrix in which little fills in.

use std::collections::{BTreeSet, VecDeque};
use std::mem::take;

// ANCHOR: envelope
/// For each row, at its new place, the first column in which something stands. Between it and the
/// diagonal anything may fill in.
pub fn envelope(neighbours: &[Vec<usize>], place: &[usize]) -> Vec<usize> {
    let mut first = vec![0; place.len()];
    for (row, neighbours) in neighbours.iter().enumerate() {
        let columns = neighbours.iter().map(|other| place[*other]);
        first[place[row]] = columns.fold(place[row], usize::min);
    }
    first
}
// ANCHOR_END: envelope

// ANCHOR: reverse_cuthill_mckee
/// The new place of each row in the order of Cuthill and McKee, reversed ([@cuthill1969];
/// [@george1971]): neighbours before their neighbours, those with the fewest first.
pub fn reverse_cuthill_mckee(neighbours: &[Vec<usize>]) -> Vec<usize> {
    let rows = neighbours.len();
    let mut seeds: Vec<usize> = (0..rows).collect();
    seeds.sort_by_key(|row| neighbours[*row].len());
    let mut visited = vec![false; rows];
    let mut sequence = Vec::with_capacity(rows);
    for seed in seeds {
        if !visited[seed] {
            let reached = breadth_first(farthest(seed, neighbours), neighbours);
            reached.iter().for_each(|row| visited[*row] = true);
            sequence.extend(reached);
        }
    }
    let mut place = vec![0; rows];
    sequence.into_iter().rev().enumerate().for_each(|(new, row)| place[row] = new);
    place
}
// ANCHOR_END: reverse_cuthill_mckee

/// A row at the end of a longest way from another one, or nearly.
fn farthest(seed: usize, neighbours: &[Vec<usize>]) -> usize {
    let end = |from| breadth_first(from, neighbours).last().copied().unwrap_or(from);
    end(end(seed))
}

/// Every row that can be reached, neighbours with few neighbours first.
fn breadth_first(start: usize, neighbours: &[Vec<usize>]) -> Vec<usize> {
    let mut reached = vec![false; neighbours.len()];
    let (mut queue, mut sequence) = (VecDeque::from([start]), Vec::new());
    reached[start] = true;
    while let Some(row) = queue.pop_front() {
        sequence.push(row);
        let mut next: Vec<usize> =
            neighbours[row].iter().copied().filter(|other| !reached[*other]).collect();
        next.sort_by_key(|other| neighbours[*other].len());
        next.iter().for_each(|other| reached[*other] = true);
        queue.extend(next);
    }
    sequence
}

/// The rows in an order in which little fills in when they are eliminated: always one that is coupled
/// with the fewest others by then ([@george1989]). Rows count by their sizes. When all that is left
/// is coupled with all, any order will do.
// ANCHOR: minimum_degree
pub fn minimum_degree(neighbours: Vec<Vec<usize>>, sizes: &[usize]) -> Vec<usize> {
    let mut coupled: Vec<BTreeSet<usize>> =
        neighbours.into_iter().map(|others| others.into_iter().collect()).collect();
    let degree = |others: &BTreeSet<usize>| others.iter().map(|row| sizes[*row]).sum::<usize>();
    let mut degrees: Vec<usize> = coupled.iter().map(degree).collect();
    let mut left: BTreeSet<(usize, usize)> = degrees.iter().copied().zip(0..).collect();
    let mut order = Vec::with_capacity(sizes.len());
    while let Some((_, row)) = left.pop_first() {
        order.push(row);
        let others = take(&mut coupled[row]);
        if others.len() == left.len() {
            order.extend(others);
            break;
        }
        for &other in &others {
            left.remove(&(degrees[other], other));
            coupled[other].remove(&row);
            coupled[other].extend(others.iter().filter(|third| **third != other));
            degrees[other] = degree(&coupled[other]);
            left.insert((degrees[other], other));
        }
    }
    order
}
// ANCHOR_END: minimum_degree

/// For each row those that share the matrix's blocks with it, from lists of rows of which every pair
/// does.
pub fn neighbours(rows: usize, couplings: impl Iterator<Item = Vec<usize>>) -> Vec<Vec<usize>> {
    let mut neighbours = vec![Vec::new(); rows];
    for mut coupled in couplings {
        coupled.sort_unstable();
        coupled.dedup();
        for &row in &coupled {
            neighbours[row].extend(coupled.iter().filter(|other| **other != row));
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    neighbours
}
