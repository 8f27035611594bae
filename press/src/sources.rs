//! Source files as pages of their own, so that every listing and check can be followed without a network.

use crate::prose::escape;

const STYLE: &str = "\
:root{color-scheme:light dark}\
body{margin:0;font:15px/1.5 ui-monospace,'Source Code Pro',Menlo,Consolas,monospace;background:Canvas;color:CanvasText}\
header{padding:.75rem 1rem;border-bottom:1px solid GrayText}\
h1{font-size:1rem;margin:0}\
main{overflow-x:auto;padding:1rem 0}\
ol{margin:0;padding:0;list-style:none;counter-reset:line;min-width:max-content}\
li{counter-increment:line;white-space:pre;tab-size:4;padding-right:1rem;min-height:1.5em}\
li::before{content:counter(line);display:inline-block;width:4ch;margin:0 1.5ch 0 1ch;text-align:right;color:GrayText;user-select:none}\
li:target{background:Mark;color:MarkText}\
.comment{font-style:italic}";

/// The page of a source file.
pub fn page(file: &str, source: &str) -> String {
    let lines: String = source
        .lines()
        .enumerate()
        .map(|(at, line)| format!("<li id=\"L{}\">{}</li>\n", at + 1, shown(line)))
        .collect();
    let name = escape(file);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\" class=\"source-page\">\n<head>\n<meta charset=\"utf-8\">\n<title>{name}</title>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"robots\" content=\"noindex\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>{STYLE}</style>\n</head>\n<body>\n<header><h1>{name}</h1></header>\n\
         <main tabindex=\"0\" aria-label=\"Source\"><ol>\n{lines}</ol></main>\n</body>\n</html>\n"
    )
}

fn shown(line: &str) -> String {
    match line.trim_start().starts_with("//") {
        true => format!("<span class=\"comment\">{}</span>", escape(line)),
        false => escape(line),
    }
}
