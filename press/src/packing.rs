//! What a page loads when it is asked for, packed into scripts: they also load where a page is opened from a disk and
//! may not fetch.

use std::io::Write as _;
use std::path::Path;

use anyhow::Result;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use sha2::{Digest, Sha256};

use crate::files;
use crate::pages::slashed;
use crate::records::hex;

/// Bytes as text, compressed.
pub fn packed(bytes: &[u8], compression: Compression) -> Result<String> {
    let mut gzip = GzEncoder::new(Vec::new(), compression);
    gzip.write_all(bytes)?;
    Ok(STANDARD.encode(gzip.finish()?))
}

/// Bytes as text, in as few letters as a long search finds.
pub fn packed_tightly(bytes: &[u8]) -> Result<String> {
    let mut packed = Vec::new();
    zopfli::compress(zopfli::Options::default(), zopfli::Format::Gzip, bytes, &mut packed)?;
    Ok(STANDARD.encode(packed))
}

/// A digest of all files in some folders and of some single ones, below a root. A file that is not there counts as
/// empty.
pub fn digest(root: &Path, folders: &[&str], single: &[&str]) -> Result<String> {
    let mut hasher = Sha256::new();
    let mut add = |path: &Path| {
        let bytes = std::fs::read(root.join(path)).unwrap_or_default();
        hasher.update(format!("\n{} {}\n", slashed(path), bytes.len()));
        hasher.update(bytes);
    };
    for folder in folders {
        for file in files::below(&root.join(folder))? {
            add(&Path::new(folder).join(file));
        }
    }
    single.iter().for_each(|file| add(Path::new(file)));
    Ok(hex(&hasher.finalize()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_packed_can_be_unpacked() {
        for text in [packed(b"\0asm", Compression::fast()), packed_tightly(b"\0asm")] {
            let bytes = STANDARD.decode(text.unwrap()).unwrap();
            let mut unpacked = Vec::new();
            std::io::Read::read_to_end(
                &mut flate2::read::GzDecoder::new(&bytes[..]),
                &mut unpacked,
            )
            .unwrap();
            assert_eq!(unpacked, b"\0asm");
        }
    }
}
