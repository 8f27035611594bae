//! Wrong answers to [`{name}`](crate::{name}).

use exercise_spec::{name}::*;

use super::Wrong;
use crate::{name} as right;

/// The reference answer.
pub const REFERENCE: Functions = Functions { doubled: right::doubled };

/// All of them. TODO: at least four, each the reference answer changed in one way.
pub fn wrong() -> Vec<Wrong> {
    vec![Wrong::new(&NEGATED, Functions { doubled: |number| -right::doubled(number) })]
}
