//! The secret that hidden instances are drawn from.
//!
//! Feedback tells something of the instances, a bit with each verdict. From a seed of a few digits
//! that is enough to try all of them until one fits; of these there are too many to be tried, however
//! much is told. It stays in the folder of the grades. Reports have its mark, by which two of them
//! can be compared and nothing can be drawn.

use std::fmt::{self, Debug, Formatter};

use sha2::{Digest, Sha256};

/// A seed of 128 bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Seed(u128);

/// Digits of a seed as text.
const DIGITS: usize = 32;

impl Seed {
    /// The seed of a number.
    pub const fn new(number: u128) -> Self {
        Self(number)
    }

    /// A new one.
    ///
    /// # Errors
    ///
    /// When the system has no random numbers.
    pub fn draw() -> Result<Self, String> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes)
            .map_err(|error| format!("no seed can be drawn: {error}; give one with --seed"))?;
        Ok(Self(u128::from_le_bytes(bytes)))
    }

    /// A seed as text.
    ///
    /// # Errors
    ///
    /// A sentence that says what one is.
    pub fn parse(text: &str) -> Result<Self, String> {
        let digits = text.len() == DIGITS && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        let number = u128::from_str_radix(text, 16).ok().filter(|_| digits);
        number.map(Self).ok_or_else(|| {
            format!(
                "a seed has {DIGITS} digits from 0 to 9 and a to f, as `openssl rand -hex 16` makes them, because of \
                 shorter ones all can be tried; without --seed one is drawn"
            )
        })
    }

    /// The number.
    pub fn number(self) -> u128 {
        self.0
    }

    /// As text, for those who may know it.
    pub fn text(self) -> String {
        format!("{:032x}", self.0)
    }

    /// What reports call it.
    pub fn mark(self) -> String {
        let digest =
            Sha256::new().chain_update(b"mark").chain_update(self.0.to_le_bytes()).finalize();
        digest.iter().take(4).map(|byte| format!("{byte:02x}")).collect()
    }
}

impl Debug for Seed {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        write!(formatter, "Seed({}…)", self.mark())
    }
}
