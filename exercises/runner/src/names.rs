//! Names that nothing of an answer may have, because the library calls the answer so.

use exercise_spec::Exercise;

/// Words before the name of an item.
pub const ITEMS: &[&str] =
    &["as", "const", "enum", "fn", "mod", "static", "struct", "trait", "type", "union"];

/// Those of them that an answer gives to something, in its order.
pub fn taken(exercise: &Exercise, source: &str) -> Vec<&'static str> {
    let code = source.lines().map(|line| line.split("//").next().unwrap_or_default());
    let code = code.collect::<Vec<_>>().join("\n");
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
    let words: Vec<&str> =
        code.split(|letter| !is_part(letter)).filter(|word| !word.is_empty()).collect();
    let named =
        words.windows(2).filter(|pair| ITEMS.contains(&pair[0]) || pair[0] == "macro_rules");
    let forbidden = |pair: &[&str]| exercise.forbidden.iter().find(|name| **name == pair[1]);
    named.filter_map(forbidden).copied().collect()
}

/// What is to be said of one.
pub fn refusal(name: &str) -> String {
    format!(
        "`{name}` is what the library calls something that does what this exercise asks for, and \
         nothing of yours may have its name. Give it another one."
    )
}
