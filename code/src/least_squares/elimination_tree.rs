//! Which columns meet when variables are eliminated one after the other.

use std::mem::{replace, take};
use std::ops::Range;

// ANCHOR: node
/// A front: the columns that are eliminated in it, and those that they are coupled with by then.
/// Columns are numbered in the order of their elimination.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Node {
    /// What is eliminated.
    pub own: Range<usize>,
    /// What is left of the front, ascending.
    pub rest: Vec<usize>,
    /// The front that takes what is left: that of the first column of the rest.
    pub parent: Option<usize>,
}
// ANCHOR_END: node

impl Node {
    /// How many columns it has.
    pub fn width(&self) -> usize {
        self.own.len() + self.rest.len()
    }

    /// All columns, ascending.
    pub fn columns(&self) -> impl Iterator<Item = usize> {
        self.own.clone().chain(self.rest.iter().copied())
    }

    /// Where a column stands in the front.
    pub fn place(&self, column: usize) -> usize {
        if column < self.own.end {
            column - self.own.start
        } else {
            self.own.len() + self.rest.partition_point(|other| *other < column)
        }
    }

    /// The same for columns that ascend.
    pub fn places(&self, columns: &[usize]) -> impl Iterator<Item = usize> {
        let mut passed = 0;
        columns.iter().map(move |column| {
            if self.own.contains(column) {
                return column - self.own.start;
            }
            passed += self.rest[passed..].iter().take_while(|other| *other < column).count();
            self.own.len() + passed
        })
    }
}

// ANCHOR: elimination_tree
/// The fronts of an elimination, from the blocks of columns in its order and the lists of blocks
/// that rows of the Jacobian couple.
///
/// The rest of a front is what its rows name, together with the rests of the fronts that go into it
/// ([@duff1983]). A front that goes into one with the very same columns becomes part of it, as long
/// as the two are not wide: what is eliminated together should stay in the fastest memory.
pub fn elimination_tree(
    blocks: &[Range<usize>],
    couplings: impl Iterator<Item = impl Iterator<Item = usize> + Clone>,
) -> Vec<Node> {
    // Of each block what it is coupled with, some of it often; and for which block each was last counted.
    let room = || Vec::with_capacity(ROOM);
    let mut coupled_with: Vec<Vec<usize>> = blocks.iter().map(|_| room()).collect();
    let mut counted = vec![0; blocks.len()];
    for coupled in couplings {
        if let Some(first) = coupled.clone().min() {
            coupled_with[first].extend(coupled);
        }
    }
    let mut nodes: Vec<Node> = Vec::with_capacity(blocks.len());
    let (mut node_of_block, mut parents) = (Vec::with_capacity(blocks.len()), Vec::new());
    for (number, own) in blocks.iter().enumerate() {
        let mut later = take(&mut coupled_with[number]);
        later
            .retain(|block| *block > number && replace(&mut counted[*block], number + 1) <= number);
        later.sort_unstable();
        let mut rest = Vec::with_capacity(later.iter().map(|block| blocks[*block].len()).sum());
        later.iter().for_each(|block| rest.extend(blocks[*block].clone()));
        let parent = later.first().copied();
        if let Some(parent) = parent {
            coupled_with[parent].append(&mut later);
        }
        match nodes.last_mut() {
            Some(last) if continues(last, own, &rest) => {
                (last.own.end, last.rest) = (own.end, rest);
                parents.pop();
            }
            _ => nodes.push(Node { own: own.clone(), rest, parent: None }),
        }
        parents.push(parent);
        node_of_block.push(nodes.len() - 1);
    }
    for (node, parent) in nodes.iter_mut().zip(parents) {
        node.parent = parent.map(|parent| node_of_block[parent]);
    }
    nodes
}
// ANCHOR_END: elimination_tree

/// So many couplings few blocks have more of.
const ROOM: usize = 32;

/// So many columns of a front are eliminated together, or those of one block.
const MOST_TOGETHER: usize = 32;

/// Whether a block has the columns that the front before it leaves.
fn continues(last: &Node, own: &Range<usize>, rest: &[usize]) -> bool {
    last.rest.first() == Some(&own.start)
        && last.rest.len() == own.len() + rest.len()
        && last.own.len() + own.len() <= MOST_TOGETHER
}

// ANCHOR: fronts_in_order
/// The fronts in the order of their elimination, and where their columns are kept: one after the
/// other, each from the front's first row to its last and then the right-hand side.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    pub nodes: Vec<Node>,
    /// Where the columns of each begin, and where the last one's end.
    start: Vec<usize>,
    /// By column, the front that eliminates it.
    front_of: Vec<usize>,
}
// ANCHOR_END: fronts_in_order

impl Tree {
    pub fn new(nodes: Vec<Node>) -> Self {
        let (mut start, mut front_of) = (vec![0], Vec::new());
        for (front, node) in nodes.iter().enumerate() {
            start.push(start[front] + node.own.len() * (node.width() + 1));
            front_of.resize(node.own.end, front);
        }
        Self { nodes, start, front_of }
    }

    /// How many numbers the columns of all fronts have.
    pub fn len(&self) -> usize {
        self.start[self.nodes.len()]
    }

    /// Where the columns of a front are kept.
    pub fn panel(&self, front: usize) -> Range<usize> {
        self.start[front]..self.start[front + 1]
    }

    /// Which front eliminates a column.
    pub fn front_of(&self, column: usize) -> usize {
        self.front_of[column]
    }

    /// Where the entry of a column stands that belongs to a later one, or to itself.
    pub fn entry(&self, column: usize, row: usize) -> usize {
        let front = self.front_of(column);
        self.start_of(column, front) + self.nodes[front].place(row)
    }

    /// Where a column begins that a front eliminates.
    pub fn start_of(&self, column: usize, front: usize) -> usize {
        let node = &self.nodes[front];
        self.start[front] + node.place(column) * (node.width() + 1)
    }
}
