//! Items of the libraries that are the answer.

use super::names::Root;
use super::tokens::Tokens;

/// Where an answer calls them, with the lines. What it calls so itself is no such item.
pub fn findings(tokens: &Tokens, items: &[&str]) -> Vec<(usize, String)> {
    let reaches = |at: &usize| items.contains(&tokens.word(*at)) && !tokens.place(*at).test;
    let finding = |at: usize| Some((tokens.line(at), finding(tokens, at)?));
    (0..tokens.len()).filter(reaches).filter_map(finding).collect()
}

fn finding(tokens: &Tokens, at: usize) -> Option<String> {
    let name = tokens.word(at);
    if is_the_librarys(tokens, at, name) {
        return Some(format!(
            "`{name}` of the library does what this exercise asks for. Write it yourself, of the \
                parts that its page names."
        ));
    }
    let hidden = tokens.place(at).in_macro() && !tokens.follows(at, '$');
    (hidden && !tokens.names().has(name)).then(|| {
        format!(
            "`{name}` stands in a macro of yours, and the library has a `{name}` that does what \
                this exercise asks for. If this is something else, give it another name."
        )
    })
}

fn is_the_librarys(tokens: &Tokens, at: usize, name: &str) -> bool {
    let names = tokens.names();
    let is_own = || names.root(tokens, at) != Root::Foreign && names.has(name);
    if tokens.place(at).import.is_some() {
        let is_given_here = at > 0 && tokens.keyword(at - 1) == "as";
        return !is_given_here && !is_own();
    }
    if tokens.follows_path(at) {
        return !names.has_type(tokens.word(at.saturating_sub(3))) && !is_own();
    }
    let (called, leads) = (tokens.is(at + 1, '('), tokens.separates(at + 1));
    if tokens.follows(at, '.') {
        return (called || leads) && !names.has_function(name);
    }
    if names.has(name) {
        return false;
    }
    let is_type = name.starts_with(char::is_uppercase);
    names.all_of_vislam && called || names.all_of_foreign && (leads || is_type)
}
