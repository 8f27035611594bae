//! Registers that are chosen when the program runs.

/// Calls a function with the widest registers that the processor has. Every sum is rounded as
/// elsewhere, so results do not depend on the processor.
#[cfg(not(target_arch = "wasm32"))]
#[inline(always)]
pub fn wide<T>(compute: impl FnOnce() -> T) -> T {
    pulp::Arch::new().dispatch(compute)
}

/// Calls a function. What registers WebAssembly has is known when it is compiled.
#[cfg(target_arch = "wasm32")]
#[inline(always)]
pub fn wide<T>(compute: impl FnOnce() -> T) -> T {
    compute()
}
