//! Registers that are chosen when the program runs.

use pulp::Arch;

/// Calls a function with the widest registers that the processor has. Every sum is rounded as
/// elsewhere, so results do not depend on the processor.
#[inline(always)]
pub fn wide<T>(compute: impl FnOnce() -> T) -> T {
    Arch::new().dispatch(compute)
}
