//! Words for the terminal.

use std::fmt::Display;
use std::io::Write as _;

/// Says a line. Who reads no further, as `head` does, stops nothing of what is being done.
pub fn say(line: impl Display) {
    let _ = writeln!(std::io::stdout(), "{line}");
}
