//! mdBook warns and goes on. Here a warning is a fault.

use std::fmt::Write;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use regex::Regex;
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::layer::{Context, Layer};

use crate::fault::Faults;
use crate::formulas::REJECTED;

/// How mdbook-katex begins its warning of a formula that the press rejected before.
const UNRENDERED: &str = "Rendering failed";

/// Gathers warnings and errors that libraries report while they work.
#[derive(Clone, Default)]
pub struct Warnings(Arc<Mutex<Vec<String>>>);

impl Warnings {
    /// What was reported since the last time, as faults, except what is among the `known` ones already.
    pub fn take(&self, known: &Faults) -> Faults {
        let mut faults = Faults::default();
        let rejected = known.sorted().iter().any(|fault| fault.problem.starts_with(REJECTED));
        let taken = std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner));
        for message in
            taken.into_iter().filter(|message| !(rejected && message.starts_with(UNRENDERED)))
        {
            faults.add(
                (&file_in(&message), 0),
                "mdBook",
                message,
                "mend what it warns of; the build counts a warning as a fault",
            );
        }
        faults
    }
}

/// The chapter a message speaks of.
fn file_in(message: &str) -> String {
    static CHAPTER: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"`([\w./-]+\.md)`").expect("a valid pattern"));
    CHAPTER.captures(message).map_or("book.toml".to_owned(), |found| format!("src/{}", &found[1]))
}

struct Message(String);

impl Visit for Message {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        let result = match field.name() {
            "message" => write!(self.0, "{value:?}"),
            name => write!(self.0, " {name}={value:?}"),
        };
        debug_assert!(result.is_ok(), "writing to a string cannot fail");
    }
}

impl<S: Subscriber> Layer<S> for Warnings {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        if *event.metadata().level() <= Level::WARN {
            let mut message = Message(String::new());
            event.record(&mut message);
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push(message.0);
        }
    }
}
