//! Names that nothing of an answer may have, because the library calls the answer so.

use exercise_spec::Exercise;

use crate::tokens::Tokens;

/// Words before the name of an item.
const ITEMS: &[&str] =
    &["as", "const", "enum", "fn", "mod", "static", "struct", "trait", "type", "union"];

/// Those of them that an answer gives to something, in its order.
pub fn taken(exercise: &Exercise, source: &str) -> Vec<&'static str> {
    let Ok(tokens) = Tokens::of(source) else { return Vec::new() };
    let forbidden = |at: usize| exercise.forbidden.iter().find(|name| **name == tokens.word(at));
    let given = (0..tokens.len()).filter(|at| is_given(&tokens, *at));
    given.filter_map(forbidden).copied().collect()
}

/// Whether an item gets its name here, and is none of a test.
pub fn is_given(tokens: &Tokens, at: usize) -> bool {
    let before = |back: usize| at.checked_sub(back).map_or("", |at| tokens.keyword(at));
    !tokens.place(at).test && (ITEMS.contains(&before(1)) || before(2) == "macro_rules")
}

/// What is to be said of one.
pub fn refusal(name: &str) -> String {
    format!(
        "`{name}` is what the library calls something that does what this exercise asks for, and \
         nothing of yours may have its name. Give it another one."
    )
}
