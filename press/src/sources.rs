//! Source files as pages of their own, so that every listing and check can be followed without a network.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use regex::Captures;

use crate::inline::NAMED_LABEL;
use crate::pages::{Labels, slashed};

const STYLE: &str = "\
:root{color-scheme:light dark;--ground:light-dark(#fdfcf9,#17181c);--ink:light-dark(#1f1e1b,#dcdad4);\
--muted:light-dark(#66645e,#9a988f);--mark:light-dark(#f6ecc4,#3a3520);--link:light-dark(#1f5490,#8ab8ee)}\
body{margin:0;font:14px/1.55 'Source Code Pro',ui-monospace,Menlo,Consolas,monospace;background:var(--ground);color:var(--ink)}\
header{position:sticky;top:0;padding:.7rem 1rem;background:var(--ground);border-bottom:1px solid var(--muted);display:flex;gap:2rem}\
h1{font-size:1rem;margin:0}\
a{color:var(--link)}\
main{overflow-x:auto;padding:1rem 0}\
ol{margin:0;padding:0;list-style:none;counter-reset:line;min-width:max-content}\
li{counter-increment:line;white-space:pre;tab-size:4;padding-right:1rem;min-height:1.55em;scroll-margin-top:5rem}\
li::before{content:counter(line);display:inline-block;width:4ch;margin:0 1.5ch 0 1ch;text-align:right;color:var(--muted);user-select:none}\
li:target{background:var(--mark)}\
.comment{color:var(--muted)}";

/// The page of a source file. Labels in its comments, `{eq:projection}`, lead back into the book.
pub fn page(file: &str, source: &str, labels: &Labels) -> String {
    let up = "../".repeat(file.matches('/').count() + 2);
    let page = html! {
        (DOCTYPE)
        html.source-page lang="en" {
            head {
                meta charset="utf-8"; title { (file) }
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="robots" content="noindex"; link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body {
                header { h1 { (file) } a href={ (up) "index.html" } { "The book" } }
                main tabindex="0" { ol {
                    @for (at, line) in source.lines().enumerate() {
                        li id={ "L" (at + 1) } { (shown(line, &up, labels)) } "\n"
                    }
                } }
            }
        }
    };
    page.into_string()
}

fn shown(line: &str, up: &str, labels: &Labels) -> Markup {
    let text = html! { (line) };
    if !line.trim_start().starts_with("//") {
        return text;
    }
    let linked =
        NAMED_LABEL.replace_all(&text.0, |found: &Captures<'_>| match labels.get(&found[1]) {
            Some(target) => {
                let page = slashed(&target.path.with_extension("html"));
                html! { a href={ (up) (page) "#" (found[1]) } { "{" (found[1]) "}" } }.into_string()
            }
            None => found[0].to_owned(),
        });
    html! { span.comment { (PreEscaped(linked)) } }
}
