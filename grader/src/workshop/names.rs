//! What an exercise can be called.

/// Rust's words, those it keeps for later included, and what would hide something of it.
const RUST: &str = "abstract alloc as async await become bool box break char const continue core crate do dyn else \
    enum extern f32 f64 false final fn for gen i128 i16 i32 i64 i8 if impl in isize let loop macro match mod move mut \
    override priv proc_macro pub ref return self static std str struct super test trait true try type typeof u128 u16 \
    u32 u64 u8 union unsafe unsized use usize virtual where while yield";

/// Names that mean something else where modules, files and targets of exercises lie, and devices
/// of Windows.
const OURS: &str = "answers aux build con deps examples exercises incremental lib main misconceptions mod nul prn \
    skeletons solutions tests";

/// Longest name, so that lists stay lists.
const LONGEST: usize = 32;
/// Longest title.
const LONGEST_TITLE: usize = 60;

/// Whether a name can be one of a module, a file, a test and a label.
///
/// # Errors
///
/// A sentence when it cannot.
pub fn name(name: &str) -> Result<(), String> {
    let small = |letter: char| letter.is_ascii_lowercase();
    let good = |letter: char| small(letter) || letter.is_ascii_digit() || letter == '_';
    let shape = name.starts_with(small)
        && name.chars().all(good)
        && !name.ends_with('_')
        && !name.contains("__");
    if !shape || !(3..=LONGEST).contains(&name.len()) {
        let shown = crate::text::harmless_line(name, 2 * LONGEST);
        return Err(format!(
            "`{shown}` cannot be the name of an exercise; take small letters, digits and single \
             underscores, from 3 to {LONGEST} of them, and begin with a letter"
        ));
    }
    let device = ["com", "lpt"]
        .iter()
        .any(|port| name.strip_prefix(port).is_some_and(|rest| rest.len() == 1));
    let mut taken = RUST.split_whitespace().chain(OURS.split_whitespace());
    if device || taken.any(|word| word == name) {
        return Err(format!("`{name}` means something else already; choose another name"));
    }
    Ok(())
}

/// Whether a title can stand in a page, in a table and in a program.
///
/// # Errors
///
/// A sentence when it cannot.
pub fn title(title: &str) -> Result<(), String> {
    let bad = |letter: char| letter.is_control() || "\"\\`|[]{}<>$#*_@~^".contains(letter);
    let length = title.chars().count();
    if title.trim() != title || title.chars().any(bad) || !(3..=LONGEST_TITLE).contains(&length) {
        let shown = crate::text::harmless_line(title, 2 * LONGEST_TITLE);
        return Err(format!(
            "`{shown}` cannot be a title; take words without marks of Markdown or quotation, from 3 \
             to {LONGEST_TITLE} letters"
        ));
    }
    Ok(())
}

/// A title within a sentence: its first letter is small, unless more than that one is capital.
pub fn lower(title: &str) -> String {
    let mut letters = title.chars();
    match (letters.next(), letters.next()) {
        (Some(first), second) if !second.is_some_and(char::is_uppercase) => {
            first.to_lowercase().chain(title.chars().skip(1)).collect()
        }
        _ => title.to_owned(),
    }
}
