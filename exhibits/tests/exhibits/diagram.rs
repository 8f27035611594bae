//! Drawings of blocks.

use exhibits::diagram::{Block, Row, diagram};
use exhibits::figure::{Figure, Link, WIDTH};

const ROWS: &[Row] = &[
    Row {
        name: "above",
        blocks: &[
            Block { lines: &["one line"], to: "sec:here", built: true },
            Block { lines: &["one line,", "and another"], to: "sec:there", built: false },
        ],
    },
    Row { name: "below", blocks: &[Block { lines: &["alone"], to: "sec:here", built: true }] },
];

fn height(figure: &Figure) -> i32 {
    let (view, _) = figure.svg.split_once("\" ").expect("a view box");
    view.rsplit(' ').next().expect("its height").parse().expect("a number")
}

fn apart(a: &Link, b: &Link) -> bool {
    let beside = |a: &Link, b: &Link| a.corner.0 + a.size.0 <= b.corner.0;
    let above = |a: &Link, b: &Link| a.corner.1 + a.size.1 <= b.corner.1;
    beside(a, b) || beside(b, a) || above(a, b) || above(b, a)
}

#[test]
fn blocks_lie_within_the_drawing_and_apart_from_each_other() {
    let figure = diagram(ROWS);
    for (index, link) in figure.links.iter().enumerate() {
        assert!(link.corner.0 >= 0 && link.corner.0 + link.size.0 <= WIDTH as i32);
        assert!(link.corner.1 >= 0 && link.corner.1 + link.size.1 <= height(&figure));
        assert!(figure.links[..index].iter().all(|other| apart(link, other)), "{}", link.name);
    }
}

#[test]
fn every_block_leads_somewhere_and_says_when_it_is_left_out() {
    let figure = diagram(ROWS);
    let led: Vec<_> = figure.links.iter().map(|link| (link.to, link.before)).collect();
    assert_eq!(led, [("sec:here", ""), ("sec:there", "left out: "), ("sec:here", "")]);
}

#[test]
fn a_row_of_two_comes_to_a_row_of_one_by_two_arrows() {
    let heads = diagram(ROWS).svg.matches("<polygon").count();
    assert_eq!(heads, 2);
}

#[test]
fn the_data_have_a_row_for_each_block() {
    let figure = diagram(ROWS);
    let names: Vec<_> = figure.rows.iter().map(|row| row[1].as_str()).collect();
    assert_eq!(names, ["one line", "one line, and another", "alone"]);
}
