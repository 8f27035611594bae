//! The secret that flights are drawn from, and the numbers that come of it.

use std::fmt;
use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// A secret of 128 bits. Whoever has it can fly the flights again; from flights nobody gets it back.
#[derive(Clone, PartialEq, Eq)]
pub struct Key([u8; 16]);

/// What an export leaves with the instructor: `key.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exported {
    /// The key in hexadecimal digits.
    key: String,
    /// Folders of the roster that flights were exported for.
    pub folders: Vec<String>,
}

impl Key {
    /// A key from the randomness of the system.
    ///
    /// # Errors
    ///
    /// A sentence when the system has none to give.
    pub fn draw() -> Result<Self, String> {
        let mut bytes = [0; 16];
        let filled = getrandom::fill(&mut bytes);
        filled.map_err(|error| format!("the system gives no random numbers: {error}"))?;
        Ok(Self(bytes))
    }

    /// A key from its number.
    pub fn of(number: u128) -> Self {
        Self(number.to_be_bytes())
    }

    /// A number that tells one export from another and does not give the key away.
    pub fn fingerprint(&self) -> u64 {
        u64::from(self.draws("fingerprint", 0).word() as u32)
    }

    /// Numbers for one flight of one folder. Others do not tell them.
    pub fn draws(&self, folder: &str, flight: usize) -> Draws {
        let digest = Sha256::new()
            .chain_update(self.0)
            .chain_update((flight as u64).to_be_bytes())
            .chain_update(folder);
        Draws { seed: digest.finalize().into(), count: 0 }
    }
}

impl fmt::Debug for Key {
    /// A key is not shown.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Key(…)")
    }
}

/// A sequence of random numbers.
#[derive(Debug, Clone)]
pub struct Draws {
    seed: [u8; 32],
    count: u64,
}

impl Draws {
    /// 64 bits.
    pub fn word(&mut self) -> u64 {
        let digest = Sha256::new().chain_update(self.seed).chain_update(self.count.to_be_bytes());
        self.count += 1;
        let digest: [u8; 32] = digest.finalize().into();
        digest.iter().take(8).fold(0, |word, byte| (word << 8) | u64::from(*byte))
    }

    /// A number between two others.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// One of a mean of zero and a variance of one.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.between(0.0, 1.0)).ln()).sqrt();
        radius * self.between(0.0, std::f64::consts::TAU).cos()
    }
}

const HEAD: &str = "# Whoever has this file has the truth about every flight: keep it to yourself. \
                    `cargo grade fly run` asks for it.\n";

impl Exported {
    /// What is kept of a key and the folders it was used for.
    pub fn new(key: &Key, folders: Vec<String>) -> Self {
        Self { key: key.0.iter().map(|byte| format!("{byte:02x}")).collect(), folders }
    }

    /// The key.
    ///
    /// # Errors
    ///
    /// A sentence when the digits are none of a key.
    pub fn key(&self) -> Result<Key, String> {
        let number = u128::from_str_radix(&self.key, 16).ok().filter(|_| self.key.len() == 32);
        number.map(Key::of).ok_or_else(|| {
            "`key` has not 32 hexadecimal digits; take the file as the export wrote it".to_owned()
        })
    }

    /// Reads the file.
    ///
    /// # Errors
    ///
    /// A sentence when it cannot be read or is none.
    pub fn read(path: &Path) -> Result<Self, String> {
        let shown = path.display();
        let text = fs::read_to_string(path).map_err(|error| {
            format!("cannot read the key {shown}: {error}; name it with --key, it was written beside the export")
        })?;
        let exported: Self =
            toml::from_str(&text).map_err(|error| format!("{shown}: {}", error.message()))?;
        exported.key().map_err(|error| format!("{shown}: {error}"))?;
        Ok(exported)
    }

    /// Writes the file, for its owner alone where the system knows owners. One that is there stays.
    ///
    /// # Errors
    ///
    /// A sentence when it is there already or cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), String> {
        let cannot = |error: &dyn fmt::Display| {
            format!(
                "cannot write the key {}: {error}; without the key of an export nobody can grade \
                 it, so that no file is written over",
                path.display()
            )
        };
        let text = toml::to_string(self).map_err(|error| cannot(&error))?;
        let mut options = fs::OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let written = options.open(path).and_then(|mut file| {
            std::io::Write::write_all(&mut file, format!("{HEAD}{text}").as_bytes())
        });
        written.map_err(|error| cannot(&error))
    }
}
