//! Which columns meet when variables are eliminated one after the other.

use std::collections::BTreeSet;
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
}

// ANCHOR: elimination_tree
/// The fronts of an elimination, from the blocks of columns in its order and the lists of columns
/// that rows of the Jacobian couple.
///
/// The rest of a front is what its rows name, together with the rests of the fronts that go into it
/// ([@duff1983]). A front that goes into one with the very same columns becomes part of it.
pub fn elimination_tree<'a>(
    blocks: &[Range<usize>],
    couplings: impl Iterator<Item = &'a [usize]>,
) -> Vec<Node> {
    let block_of = |column: usize| blocks.partition_point(|block| block.end <= column);
    let mut rests = vec![BTreeSet::new(); blocks.len()];
    for coupled in couplings {
        if let Some(first) = coupled.iter().min() {
            rests[block_of(*first)].extend(coupled.iter().copied());
        }
    }
    let mut nodes: Vec<Node> = Vec::with_capacity(blocks.len());
    let mut node_of_block = vec![0; blocks.len()];
    for (number, own) in blocks.iter().enumerate() {
        let rest: Vec<usize> = rests[number].split_off(&own.end).into_iter().collect();
        if let Some(first) = rest.first() {
            let parent = block_of(*first);
            rests[parent].extend(&rest);
        }
        match nodes.last_mut() {
            Some(last) if continues(last, own, &rest) => {
                (last.own.end, last.rest) = (own.end, rest);
            }
            _ => nodes.push(Node { own: own.clone(), rest, parent: None }),
        }
        node_of_block[number] = nodes.len() - 1;
    }
    for node in &mut nodes {
        node.parent = node.rest.first().map(|first| node_of_block[block_of(*first)]);
    }
    nodes
}
// ANCHOR_END: elimination_tree

/// Whether a block has the columns that the front before it leaves.
fn continues(last: &Node, own: &Range<usize>, rest: &[usize]) -> bool {
    last.rest.first() == Some(&own.start) && last.rest.len() == own.len() + rest.len()
}
