//! Entering an exercise in the lists of the repository, beside the one that it follows.

/// The exercise that a new one stands beside, in the order of the book.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Beside {
    /// Its name.
    pub name: String,
    /// Whether the new one comes after it.
    pub after: bool,
}

impl Beside {
    /// The neighbour of an exercise in a summary that has its page.
    pub fn of(name: &str, summary: &str) -> Option<Self> {
        let pages = pages(summary);
        let at = pages.iter().position(|page| *page == name)?;
        let after = at > 0;
        let neighbour = if after { pages.get(at - 1) } else { pages.get(at + 1) };
        Some(Self { name: (*neighbour?).to_owned(), after })
    }

    /// Puts a line behind or before the neighbour's.
    pub fn line(&self, text: &str, is_its: &dyn Fn(&str) -> bool, new: &str) -> Option<String> {
        let mut lines: Vec<&str> = text.lines().collect();
        let at = lines.iter().position(|line| is_its(line))?;
        lines.insert(at + usize::from(self.after), new);
        Some(lines.join("\n") + "\n")
    }

    /// Puts a section behind or before the neighbour's, which is the one with the line `has`. A
    /// section begins with a line that starts with `begin`.
    pub fn section(&self, text: &str, begin: &str, has: &str, new: &str) -> Option<String> {
        let mut parts = sections(text, begin);
        let is_its =
            |part: &String| part.starts_with(begin) && part.lines().any(|line| line == has);
        let at = parts.iter().position(is_its)?;
        if self.after {
            parts[at] = format!("{}\n\n", parts[at].trim_end());
        }
        parts.insert(at + usize::from(self.after), format!("{}\n\n", new.trim_end()));
        Some(parts.concat().trim_end().to_owned() + "\n")
    }
}

/// A text in pieces that begin with a line which starts with `begin`, but for the first one.
pub fn sections(text: &str, begin: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    for line in text.lines() {
        if line.starts_with(begin) {
            parts.push(String::new());
        }
        if let Some(part) = parts.last_mut() {
            *part += line;
            part.push('\n');
        }
    }
    parts
}

/// The text with a module more, in the order of the alphabet.
pub fn module(text: &str, name: &str) -> Option<String> {
    let mut lines: Vec<&str> = text.lines().collect();
    let new = format!("pub mod {name};");
    let is_module = |line: &&str| line.starts_with("pub mod ");
    let greater = |line: &&str| is_module(line) && *line > new.as_str();
    let behind_all = || lines.iter().rposition(is_module).map(|last| last + 1);
    let at = lines.iter().position(greater).or_else(behind_all)?;
    lines.insert(at, &new);
    Some(lines.join("\n") + "\n")
}

/// The pages of exercises in the summary, in the order of the book: their names.
pub fn pages(summary: &str) -> Vec<&str> {
    summary.lines().filter_map(|line| between(line, "](exercises/", ".md)")).collect()
}

/// The chapters of the summary that can have exercises below them.
pub fn chapters(summary: &str) -> Vec<&str> {
    let entries = summary.lines().filter(|line| line.starts_with("- ["));
    entries.filter_map(|line| between(line, "](", ".md)")).collect()
}

/// What stands between two marks in a line.
pub fn between<'a>(line: &'a str, from: &str, to: &str) -> Option<&'a str> {
    Some(line.split_once(from)?.1.split_once(to)?.0)
}

/// The summary with a page more, the last of those below its chapter.
pub fn page(summary: &str, chapter: &str, new: &str) -> Option<String> {
    let mut lines: Vec<&str> = summary.lines().collect();
    let of = format!("]({chapter}.md)");
    let at = lines.iter().position(|line| line.starts_with("- [") && line.ends_with(&of))?;
    let below = lines[at + 1..].iter().take_while(|line| line.starts_with("    ")).count();
    lines.insert(at + 1 + below, new);
    Some(lines.join("\n") + "\n")
}
