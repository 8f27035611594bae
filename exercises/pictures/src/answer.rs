//! An answer, as a picture asks it.

use std::panic;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use exercise_spec::answer::{Fault, Native, Transport};
use exercise_spec::declaration::Dispatch;

/// An answer that can be asked again and again.
pub type Asked = Arc<dyn Transport>;

/// What the latest panic says, and where it happened.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Whether answers are asked no more.
static SILENT: AtomicBool = AtomicBool::new(false);

/// Asks no answer from now on, so that a picture shows what is expected alone.
pub fn silence() {
    SILENT.store(true, Ordering::Relaxed);
}

/// Whether no answer is asked.
pub fn is_silent() -> bool {
    SILENT.load(Ordering::Relaxed)
}

/// The answer of these functions. In a module a panic ends the call, and what it said is kept for the page; elsewhere it
/// is a [`Fault`]. `nothing` are functions that answer NaN, in the place of one that may not be asked.
pub fn written<F: Dispatch + 'static>(functions: F, nothing: F) -> Asked {
    if cfg!(not(target_family = "wasm")) {
        return Arc::new(Native(functions));
    }
    panic::set_hook(Box::new(|info| {
        let place = info.location().map(|at| format!(" at {}:{}", at.file(), at.line()));
        let sentence = info.payload_as_str().unwrap_or("without words");
        let fault = Fault::of_panic(sentence, place.unwrap_or_default());
        *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = fault.to_string();
    }));
    Arc::new(Called { functions, nothing })
}

/// What the panic that ended a call said: its address in the upper half, its length in the lower one.
pub fn panic_said() -> u64 {
    let said = PANIC.lock().unwrap_or_else(PoisonError::into_inner);
    (said.as_ptr() as usize as u64) << 32 | said.len() as u64
}

/// An answer whose panics end all.
struct Called<F> {
    functions: F,
    nothing: F,
}

impl<F: Dispatch> Transport for Called<F> {
    fn call(&self, function: usize, input: &[u8]) -> Result<Vec<u8>, Fault> {
        let asked = if is_silent() { &self.nothing } else { &self.functions };
        let output = asked.dispatch(function, input);
        output.ok_or_else(|| Fault::Output(format!("there is no function {function} of that type")))
    }
}
