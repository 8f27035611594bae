//! What a reader may take.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use allocation_counter::measure;

/// What a reader may take for a file.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// The largest file that it is given, in bytes. A reader whose work grows with the square of the file's length has
    /// to show with it.
    pub largest: usize,
    /// Memory at one time, in bytes for each byte of the file.
    pub memory: u64,
    /// Memory whatever the file is, in bytes.
    pub room: u64,
    /// Time, in seconds for each byte of the file.
    pub time: f64,
    /// Time whatever the file is, in seconds.
    pub start: f64,
}

impl Default for Bounds {
    fn default() -> Self {
        Self { largest: 256_000, memory: 200, room: 1_000_000, time: 1e-5, start: 0.5 }
    }
}

/// Of so many measurements the fastest counts: others may keep the machine busy.
const MEASUREMENTS: usize = 3;

impl Bounds {
    /// What a reader says of a file.
    ///
    /// # Errors
    ///
    /// A sentence when it panics or takes more than it may.
    pub fn hold(&self, input: &[u8], reader: &impl Fn(&[u8]) -> String) -> Result<String, String> {
        let length = input.len();
        let seconds = self.start + self.time * length as f64;
        let bytes = self.room + self.memory * length as u64;
        let mut fastest = f64::INFINITY;
        for _ in 0..MEASUREMENTS {
            let mut said = None;
            let begin = Instant::now();
            let memory = measure(|| said = catch_unwind(AssertUnwindSafe(|| reader(input))).ok());
            fastest = fastest.min(begin.elapsed().as_secs_f64());
            let said = said.ok_or("it panics")?;
            if memory.bytes_max > bytes {
                let took = memory.bytes_max;
                return Err(format!("it takes {took} bytes for {length}, and may take {bytes}"));
            }
            if fastest <= seconds {
                return Ok(said);
            }
        }
        Err(format!("it takes {fastest:.2} s for {length} bytes, and may take {seconds:.2} s"))
    }
}
