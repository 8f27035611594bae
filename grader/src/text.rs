//! Text that came from a submission, made harmless before anybody sees it.

/// The text without control characters, escape sequences and marks that turn the direction of
/// writing, cut to a number of characters. Line feeds stay.
pub fn harmless(text: &str, most: usize) -> String {
    let mut shown: String = text.chars().take(most).map(shown).collect();
    if text.chars().nth(most).is_some() {
        shown.push('…');
    }
    shown
}

/// The same on one line.
pub fn harmless_line(text: &str, most: usize) -> String {
    harmless(text, most).replace('\n', " ")
}

fn shown(letter: char) -> char {
    let turns = matches!(
        letter,
        '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}'
    );
    // These are no letters, and XML refuses a file that has one.
    let none = u32::from(letter) & 0xfffe == 0xfffe;
    match letter {
        '\n' => '\n',
        '\t' => ' ',
        _ if letter.is_control() || turns || none => '\u{fffd}',
        _ => letter,
    }
}
