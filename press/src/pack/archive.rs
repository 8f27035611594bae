//! The pages as one file.

use std::io::{Cursor, Write as _};
use std::path::Path;

use anyhow::{Context, Result};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::files;
use crate::pages::slashed;

/// What only a server needs: its page for what is not there, and what keeps one host from changing the pages.
const SERVED: [&str; 2] = ["404.html", ".nojekyll"];

/// A zip archive of a site, all of it in a folder `name`. The entries are sorted and have one time, so that the same
/// pages give the same bytes.
pub fn of(site: &Path, name: &str) -> Result<Vec<u8>> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(9))
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for path in files::below(site)? {
        let path = slashed(&path);
        if SERVED.contains(&path.as_str()) {
            continue;
        }
        let from = site.join(&path);
        let bytes =
            std::fs::read(&from).with_context(|| format!("cannot read {}", from.display()))?;
        zip.start_file(format!("{name}/{path}"), options)?;
        zip.write_all(&bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use zip::ZipArchive;

    use super::*;

    fn site(order: [&str; 4]) -> tempfile::TempDir {
        let site = tempfile::tempdir().unwrap();
        for path in order {
            files::write(&site.path().join(path), path.as_bytes()).unwrap();
        }
        site
    }

    #[test]
    fn the_same_pages_give_the_same_bytes_whenever_they_were_written() {
        let one = site(["index.html", "css/general.css", "404.html", "a.html"]);
        let other = site(["a.html", "404.html", "index.html", "css/general.css"]);
        let long_ago = std::time::UNIX_EPOCH + std::time::Duration::from_secs(1_000_000_000);
        let file = std::fs::File::options().write(true).open(other.path().join("a.html")).unwrap();
        file.set_modified(long_ago).unwrap();
        assert_eq!(of(one.path(), "book").unwrap(), of(other.path(), "book").unwrap());
    }

    #[test]
    fn all_that_a_reader_opens_is_in_one_folder_and_unchanged() {
        let site = site(["index.html", "css/general.css", "404.html", "a.html"]);
        let mut zip = ZipArchive::new(Cursor::new(of(site.path(), "book").unwrap())).unwrap();
        let names: Vec<String> = zip.file_names().map(str::to_owned).collect();
        assert_eq!(names, ["book/a.html", "book/css/general.css", "book/index.html"]);
        let mut text = String::new();
        zip.by_name("book/css/general.css").unwrap().read_to_string(&mut text).unwrap();
        assert_eq!(text, "css/general.css");
    }
}
