//! Figures of the book for slides. A slide program has other fonts than the book, so letters become outlines; and some
//! show no SVG, so each figure becomes a picture too.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Result, anyhow, bail};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{
    FontResolver, FontSelectionFn, Group, Indent, Node, Options, Tree, WriteOptions, fontdb,
};

/// Where the letters of figures have their outlines. The last file has Greek alone.
const FILES: [&str; 3] = [
    "source-sans-3-latin-wght-normal.woff2",
    "source-sans-3-latin-ext-wght-normal.woff2",
    "source-sans-3-greek-wght-normal.woff2",
];
/// How Greek letters are told apart for whoever chooses the font of a letter.
const GREEK: &str = "Greek";
/// How wide a picture is, in pixels: as wide as most projectors show.
const WIDTH: f32 = 1920.0;
/// Decimals of coordinates. A figure is a thousand wide and more.
const DECIMALS: u8 = 2;

/// What draws the letters.
pub struct Pen {
    options: Options<'static>,
}

impl Pen {
    /// One with the book's fonts, which lie in a folder as WOFF2.
    ///
    /// # Errors
    /// A font that is not there, or is none.
    pub fn new(fonts: &Path) -> Result<Pen> {
        let mut known = fontdb::Database::new();
        for file in FILES {
            let path = fonts.join(file);
            let packed =
                fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
            let font = wuff::decompress_woff2(&packed)
                .map_err(|error| anyhow!("{} is no WOFF2: {error:?}", path.display()))?;
            known.load_font_data(font);
        }
        let faces: Vec<fontdb::ID> = known.faces().map(|face| face.id).collect();
        let [latin, _, greek] = faces[..] else {
            bail!("{} has a file that is no font", fonts.display())
        };
        // All files have one name, and a letter that is only missed makes words with ligatures fail.
        let select_font: FontSelectionFn<'static> = Box::new(move |font, _| {
            let is_greek = font.families().iter().any(|family| family.to_string().contains(GREEK));
            Some(if is_greek { greek } else { latin })
        });
        let font_resolver = FontResolver { select_font, ..FontResolver::default() };
        let fontdb = Arc::new(known);
        Ok(Pen { options: Options { fontdb, font_resolver, ..Options::default() } })
    }

    /// A figure with its letters drawn.
    ///
    /// # Errors
    /// What is no SVG, and a letter that no font has.
    pub fn draw(&self, svg: &str) -> Result<Figure> {
        let tree = Tree::from_str(&spelled(svg), &self.options);
        let tree = tree.context("this is no SVG")?;
        if let Some(letters) = unknown(tree.root()) {
            bail!("no font of the book has “{letters}”; write it otherwise, or add a font");
        }
        Ok(Figure(tree))
    }
}

/// The same with Greek letters marked, and with digits set low for those that Unicode has low, ₀ to ₉, which no font of the
/// book has.
fn spelled(svg: &str) -> String {
    let mut written = String::with_capacity(svg.len());
    let mut in_tag = false;
    for letter in svg.chars() {
        in_tag = letter == '<' || (in_tag && letter != '>');
        match letter {
            '₀'..='₉' if !in_tag => {
                let digit = u32::from(letter) - u32::from('₀');
                let low =
                    format!("<tspan baseline-shift=\"sub\" font-size=\"65%\">{digit}</tspan>");
                written.push_str(&low);
            }
            'Ͱ'..='Ͽ' if !in_tag => {
                written.push_str(&format!("<tspan font-family=\"{GREEK}\">{letter}</tspan>"));
            }
            other => written.push(other),
        }
    }
    written
}

/// A text that has a letter without an outline.
fn unknown(group: &Group) -> Option<String> {
    group.children().iter().find_map(|node| match node {
        Node::Group(group) => unknown(group),
        Node::Text(text) => {
            let mut glyphs = text.layouted().iter().flat_map(|span| &span.positioned_glyphs);
            glyphs.find(|glyph| glyph.id.0 == 0).map(|glyph| glyph.text.clone())
        }
        _ => None,
    })
}

/// A figure without fonts.
pub struct Figure(Tree);

impl Figure {
    /// It as SVG, with paths alone.
    pub fn svg(&self) -> String {
        let options = WriteOptions {
            coordinates_precision: DECIMALS,
            indent: Indent::None,
            ..WriteOptions::default()
        };
        self.0.to_string(&options)
    }

    /// It as PNG, on white.
    ///
    /// # Errors
    /// A figure of no size.
    pub fn png(&self) -> Result<Vec<u8>> {
        let size = self.0.size();
        let scale = WIDTH / size.width();
        let height = (size.height() * scale).round();
        let mut picture =
            Pixmap::new(WIDTH as u32, height as u32).context("the figure has no size")?;
        picture.fill(Color::WHITE);
        resvg::render(&self.0, Transform::from_scale(scale, scale), &mut picture.as_mut());
        Ok(picture.encode_png()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FONTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../press/theme/fonts");

    fn drawn(text: &str) -> Result<Figure> {
        let svg = format!(
            "<svg viewBox=\"0 0 640 320\" xmlns=\"http://www.w3.org/2000/svg\"><text x=\"40\" y=\"160\" dy=\"0.76em\" \
             font-family=\"sans-serif\" font-size=\"100\" fill=\"#000000\"{text}</text></svg>"
        );
        Pen::new(Path::new(FONTS))?.draw(&svg)
    }

    /// How much of a picture is ink, in pixels.
    fn ink(figure: &Figure) -> f64 {
        let picture = Pixmap::decode_png(&figure.png().unwrap()).unwrap();
        assert_eq!((picture.width(), picture.height()), (1920, 960));
        picture.pixels().iter().map(|pixel| 1.0 - f64::from(pixel.red()) / 255.0).sum()
    }

    #[test]
    fn letters_become_paths_and_no_font_is_named() {
        let svg =
            drawn(">influence ±²µ×éδρσφ’′₀₁−").unwrap_or_else(|error| panic!("{error:#}")).svg();
        assert!(svg.contains("<path"), "{svg}");
        assert!(!svg.contains("<text") && !svg.contains("font"), "{svg}");
    }

    #[test]
    fn a_low_digit_is_small_and_low() {
        let [digit, low] = [">1", ">₁"].map(|text| ink(&drawn(text).unwrap()));
        assert!(low > 0.2 * digit && low < 0.6 * digit, "{digit} {low}");
        assert_eq!(spelled("<a b=\"₁\">"), "<a b=\"₁\">");
    }

    #[test]
    fn a_figure_is_the_same_bytes_twice() {
        let (one, other) = (drawn(">σ = 1").unwrap(), drawn(">σ = 1").unwrap());
        assert_eq!(one.svg(), other.svg());
        assert_eq!(one.png().unwrap(), other.png().unwrap());
    }

    #[test]
    fn letters_have_the_weight_of_the_page_and_stand_on_white() {
        let [none, light, regular, bold] =
            ["> ", " font-weight=\"200\">m", ">m", " font-weight=\"700\">m"]
                .map(|text| ink(&drawn(text).unwrap()));
        assert!(none == 0.0 && light > 1000.0, "{none} {light}");
        assert!(regular > 1.3 * light && bold > 1.3 * regular, "{light} {regular} {bold}");
    }

    #[test]
    fn a_letter_that_no_font_has_is_named() {
        let error = drawn(">a 字 b").err().expect("an unknown letter");
        assert!(error.to_string().contains("no font of the book has “字”"), "{error}");
    }

    #[test]
    fn what_is_no_drawing_and_fonts_that_are_not_there_are_errors() {
        assert!(Pen::new(Path::new(FONTS)).unwrap().draw("a, b\n1, 2\n").is_err());
        let error = Pen::new(Path::new("nowhere")).err().expect("no fonts");
        assert!(error.to_string().contains("cannot read nowhere"), "{error}");
    }
}
