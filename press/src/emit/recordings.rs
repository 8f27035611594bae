//! Figures that are pictures of scenes in three dimensions.

use std::path::Path;

use maud::html;

use super::Emitter;
use crate::attributes::Attributes;
use crate::blocks::Block;
use crate::recordings::program;

impl Emitter<'_, '_> {
    /// A figure that shows the scene of a name.
    pub(super) fn recording(
        &mut self,
        block: &Block,
        caption: &str,
        name: &str,
        attributes: &Attributes,
    ) {
        let Some(recording) = self.known.recordings.get(name) else {
            self.missing(&attributes.id);
            let problem = "there is no picture of this scene";
            let mend = format!(
                "write recordings/src/{name}.rs, name it in recordings/src/lib.rs and run `.ci/recordings --pictures`"
            );
            return self.fault(block.line, name, problem, mend);
        };
        self.found.recordings.insert(name.to_owned());
        let alt = self.plain(block.line, attributes.value("alt"));
        let caption = self.resolve(block.line, caption);
        let way = |file: &str| self.page.way_to(&Path::new("generated/recordings").join(file));
        let [width, height] = recording.size;
        let picture = html! {
            div.plot {
                a href=(way(&format!("{name}.png"))) {
                    img src=(way(&format!("{name}.png"))) alt=(alt) width=(width) height=(height) loading="lazy";
                }
            }
        };
        let command = format!("cargo run -p recordings --release -- {name}");
        let (mut marks, mut button) = (String::new(), html! {});
        if let Some([viewer, scene]) = recording.load {
            let [viewer_script, opener, content] =
                [way("viewer.js"), way("recordings.js"), way(&format!("{name}.js"))];
            marks = format!(
                " data-recording=\"{name}\" data-script=\"{opener}\" data-viewer=\"{viewer_script}\" data-scene=\"{content}\""
            );
            button = html! {
                p.recording-open hidden {
                    button type="button" { "Open in three dimensions" }
                    " loads a viewer of " (megabytes(viewer)) " MB once, and "
                    (megabytes(scene)) " MB for this scene."
                }
            };
        }
        let program = self.source(&program(name), 1);
        let note = html! {
            p.recording-note {
                "To turn it and play it in a viewer of its own, in the book's repository: " code { (command) } " · "
                a href=(program) { "program" }
            }
        };
        let html = format!(
            "<figure class=\"exhibit\" id=\"{}\"{marks}>\n{}\n<figcaption>\n\n**Figure {}.** {}\n\n</figcaption>\n{}\n{}\n</figure>\n",
            attributes.id,
            picture.into_string(),
            block.number,
            caption.replace('\n', " "),
            button.into_string(),
            note.into_string(),
        );
        self.lines(&block.indent, &html);
    }
}

fn megabytes(bytes: usize) -> String {
    format!("{:.1}", bytes as f64 / 1e6)
}
