//! How an answer is asked: a call takes plain data to plain data and may fail.
//!
//! The same checks run on an answer that is linked into a test and on one that was compiled to
//! WebAssembly, because all they see is a [`Transport`]. What goes through it are bytes.

use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

use nalgebra::{DMatrix, DVector, Isometry3, SMatrix};
use serde::{Serialize, de::DeserializeOwned};
use thiserror::Error;

use crate::declaration::Dispatch;

/// Why a call has no output.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Fault {
    /// The skeleton's `todo!` was reached.
    #[error("not written yet: {0}")]
    NotWritten(String),
    /// The answer panicked.
    #[error("the answer panicked{place}: {sentence}")]
    Panicked {
        /// What the panic says.
        sentence: String,
        /// ` at FILE:LINE`, or nothing.
        place: String,
    },
    /// The output is no value of its type.
    #[error("the output cannot be read: {0}")]
    Output(String),
    /// The call was stopped from outside.
    #[error("the call was stopped: {0}")]
    Stopped(String),
}

/// Carries a call to an answer, wherever it runs.
pub trait Transport: Send + Sync {
    /// Calls a function by its number in the order of the declaration.
    ///
    /// # Errors
    ///
    /// A [`Fault`] when there is no output.
    fn call(&self, function: usize, input: &[u8]) -> Result<Vec<u8>, Fault>;
}

/// Calls a function with typed data.
///
/// # Errors
///
/// As [`Transport::call`], and [`Fault::Output`] when the bytes that come back are no `Out`.
pub fn call<In: Serialize, Out: DeserializeOwned>(
    transport: &dyn Transport,
    function: usize,
    input: &In,
) -> Result<Out, Fault> {
    let unreadable = |error: postcard::Error| Fault::Output(error.to_string());
    let input = postcard::to_stdvec(input).map_err(unreadable)?;
    let output = transport.call(function, &input)?;
    match postcard::take_from_bytes(&output).map_err(unreadable)? {
        (value, []) => Ok(value),
        (_, rest) => Err(Fault::Output(format!("{} bytes are left over", rest.len()))),
    }
}

/// An answer in this process. A panic in it is a [`Fault`].
pub struct Native<F>(pub F);

impl<F: Dispatch> Transport for Native<F> {
    fn call(&self, function: usize, input: &[u8]) -> Result<Vec<u8>, Fault> {
        match caught(|| self.0.dispatch(function, input))? {
            Some(output) => Ok(output),
            None => Err(Fault::Output(format!("there is no function {function} of that type"))),
        }
    }
}

thread_local! {
    /// What the latest panic of a call says and where it happened.
    static PANIC: RefCell<Option<(String, String)>> = const { RefCell::new(None) };
    static CALLING: RefCell<bool> = const { RefCell::new(false) };
}

/// Runs a call and keeps a panic in it from reaching the terminal.
fn caught<T>(call: impl FnOnce() -> T) -> Result<T, Fault> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !CALLING.with_borrow(|calling| *calling) {
                return before(info);
            }
            let sentence = info.payload_as_str().unwrap_or("without words").to_owned();
            let place = info.location().map(|at| format!(" at {}:{}", at.file(), at.line()));
            PANIC.set(Some((sentence, place.unwrap_or_default())));
        }));
    });
    CALLING.set(true);
    let outcome = panic::catch_unwind(AssertUnwindSafe(call));
    CALLING.set(false);
    outcome.map_err(|_| {
        let (sentence, place) = PANIC.take().unwrap_or_default();
        Fault::of_panic(&sentence, place)
    })
}

impl Fault {
    /// The fault of a panic that says `sentence`.
    pub fn of_panic(sentence: &str, place: String) -> Self {
        match sentence.strip_prefix("not yet implemented") {
            Some(rest) => Self::NotWritten(rest.trim_start_matches([':', ' ']).to_owned()),
            None => Self::Panicked { sentence: sentence.to_owned(), place },
        }
    }
}

/// Values that no answer should give: their checks must refuse them.
pub trait Spoiled {
    /// A value whose numbers are all `number`. Where their count is free there is one, and none
    /// when `number` is zero.
    fn spoiled(number: f64) -> Self;
}

impl Spoiled for f64 {
    fn spoiled(number: f64) -> Self {
        number
    }
}

impl Spoiled for bool {
    fn spoiled(_: f64) -> Self {
        false
    }
}

impl Spoiled for usize {
    fn spoiled(_: f64) -> Self {
        usize::MAX
    }
}

impl<T: Spoiled> Spoiled for Vec<T> {
    fn spoiled(number: f64) -> Self {
        if number == 0.0 { Self::new() } else { vec![T::spoiled(number)] }
    }
}

impl<T: Spoiled> Spoiled for Option<T> {
    fn spoiled(number: f64) -> Self {
        Some(T::spoiled(number))
    }
}

impl<A: Spoiled, B: Spoiled> Spoiled for (A, B) {
    fn spoiled(number: f64) -> Self {
        (A::spoiled(number), B::spoiled(number))
    }
}

impl<const R: usize, const C: usize> Spoiled for SMatrix<f64, R, C> {
    fn spoiled(number: f64) -> Self {
        Self::from_element(number)
    }
}

impl Spoiled for DMatrix<f64> {
    fn spoiled(number: f64) -> Self {
        let size = usize::from(number != 0.0);
        Self::from_element(size, size, number)
    }
}

impl Spoiled for DVector<f64> {
    fn spoiled(number: f64) -> Self {
        Self::from_element(usize::from(number != 0.0), number)
    }
}

impl Spoiled for Isometry3<f64> {
    fn spoiled(number: f64) -> Self {
        Self::translation(number, number, number)
    }
}
