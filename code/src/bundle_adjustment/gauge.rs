use super::{BaError, Camera, Solver};
/// TODO
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeDirections { a: usize }
impl std::fmt::Display for FreeDirections {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result { write!(f, "{}", self.a) }
}
impl FreeDirections { /// x
 pub fn count(&self) -> usize { self.a } }
impl<C: Camera<D>, const D: usize> Solver<C, D> {
    pub(super) fn rank_deficient(&mut self) -> BaError { BaError::RankDeficient { free: FreeDirections { a: 0 } } }
}
