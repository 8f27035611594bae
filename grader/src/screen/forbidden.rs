//! Items of the libraries that are the answer.
//!
//! Of the book's library answers are linked with a part that does not have them. What is said here
//! is said before a compiler says less.

use exercise_runner::names::{is_given, refusal};
use exercise_runner::tokens::Tokens;

use super::names::Names;

/// Where an answer calls them, or something of its own by their names, with the lines.
pub fn findings(tokens: &Tokens, names: &Names, items: &[&str]) -> Vec<(usize, String)> {
    let reaches = |at: &usize| items.contains(&tokens.word(*at)) && !tokens.place(*at).test;
    let finding = |at: usize| Some((tokens.line(at), finding(tokens, names, at)?));
    (0..tokens.len()).filter(reaches).filter_map(finding).collect()
}

fn finding(tokens: &Tokens, names: &Names, at: usize) -> Option<String> {
    let name = tokens.word(at);
    if is_given(tokens, at) {
        return Some(refusal(name));
    }
    if is_the_librarys(tokens, names, at) {
        return Some(format!(
            "`{name}` of the library does what this exercise asks for. Write it yourself, of the \
                parts that its page names."
        ));
    }
    let hidden = tokens.place(at).in_macro() && !tokens.follows(at, '$');
    hidden.then(|| {
        format!(
            "`{name}` stands in a macro of yours, and the library has a `{name}` that does what \
                this exercise asks for. If this is something else, give it another name."
        )
    })
}

fn is_the_librarys(tokens: &Tokens, names: &Names, at: usize) -> bool {
    if tokens.place(at).import.is_some() || tokens.follows_path(at) {
        return true;
    }
    let (called, leads) = (tokens.is(at + 1, '('), tokens.separates(at + 1));
    if tokens.follows(at, '.') {
        return called || leads;
    }
    let is_type = tokens.word(at).starts_with(char::is_uppercase);
    names.all_of_vislam && called || names.all_of_foreign && (leads || is_type)
}
