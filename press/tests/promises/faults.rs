//! Every way to break a promise, planted in a small book that keeps all others.

use crate::small::{SmallBook, says};

#[test]
fn a_sound_book_passes() {
    let output = SmallBook::sound().run(&["check"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn all_faults_are_reported_at_once() {
    let book = SmallBook::sound().with("src/one.md", "@eq:sum of", "@eq:nothing of").with(
        "src/one.md",
        " alt=\"A rising line.\"",
        "",
    );
    let report = book.faults();
    assert!(report.contains("@eq:nothing") && report.contains("alternative text"), "{report}");
    assert!(report.contains("breaks 2 promises"), "{report}");
}

#[test]
fn an_unknown_label_is_named_with_the_nearest_one() {
    let book = SmallBook::sound().with("src/one.md", "@eq:sum of", "@eq:summ of");
    says(
        &book.faults(),
        &["src/one.md:3: @eq:summ: nothing in the book has this label", "did you mean @eq:sum?"],
    );
}

#[test]
fn an_unknown_label_in_printed_code_is_named() {
    let book = SmallBook::sound().with("code/src/one.rs", "{eq:sum}", "{eq:total}");
    says(&book.faults(), &["src/one.md:19: lst:add", "eq:total", "mend the comment"]);
}

#[test]
fn a_label_that_stands_twice_is_named_with_its_first_place() {
    let book = SmallBook::sound().with("src/one.md", "{#sec:more}", "{#eq:sum}").with(
        "src/one.md",
        "(#sec:more)",
        "(#eq:sum)",
    );
    says(
        &book.faults(),
        &["src/one.md:23: eq:sum: the label is taken: src/one.md:5 has it", "choose another label"],
    );
}

#[test]
fn an_equation_without_a_check_is_named_with_the_function_to_write() {
    let book = SmallBook::sound()
        .with("src/one.md", "{#eq:sum}", "{#eq:big-sum}")
        .with("src/one.md", "@eq:sum", "@eq:big-sum")
        .with("code/src/one.rs", "{eq:sum}", "{eq:big-sum}");
    let report = book.faults();
    assert!(
        report.contains("src/one.md:5: eq:big-sum: no check computes this equation"),
        "{report}"
    );
    assert!(report.contains("write `fn big_sum` in exhibits/src/one.rs"), "{report}");
}

#[test]
fn a_check_without_an_equation_is_named() {
    let book = SmallBook::sound().with("src/one.md", "$$ d = a - b $$ {#eq:difference}", "");
    let report = book.faults();
    assert!(
        report.contains(
            "exhibits/src/one.rs:2: eq:difference: src/one.md has no equation that this checks"
        ),
        "{report}"
    );
}

#[test]
fn a_check_that_fails_says_why() {
    let book = SmallBook::sound().with(
        "target/press/exhibits/one/exhibits.json",
        "\"failure\":null",
        "\"failure\":\"NaN at state 4\"",
    );
    says(
        &book.faults(),
        &[
            "exhibits/src/one.rs:1: eq:sum: the check fails: NaN at state 4",
            "the equation, the library or the check",
        ],
    );
}

#[test]
fn a_check_that_accepts_a_wrong_formula_is_named() {
    let book = SmallBook::sound().with(
        "target/press/exhibits/one/exhibits.json",
        "\"survivors\":[]",
        "\"survivors\":[\"sign\"]",
    );
    says(
        &book.faults(),
        &["eq:sum: the check does not notice the wrong formula “sign”", "tighten the tolerance"],
    );
}

#[test]
fn a_check_that_was_tried_on_no_wrong_formula_is_named() {
    let book = SmallBook::sound().with(
        "target/press/exhibits/one/exhibits.json",
        "\"mutants\":[\"sign\"]",
        "\"mutants\":[]",
    );
    says(&book.faults(), &["eq:sum: the check was tried on no wrong formula", "give it mutants"]);
}

#[test]
fn a_check_needs_a_function_of_its_name() {
    let book = SmallBook::sound().with("exhibits/src/one.rs", "fn sum()", "fn total()");
    says(&book.faults(), &["exhibits/src/one.rs:1: eq:sum", "no function `sum`"]);
}

#[test]
fn tex_that_was_never_held_against_its_check_is_named() {
    let book = SmallBook::sound().with("exhibits/accepted/one.toml", "sum = 'c = a + b'\n", "");
    says(
        &book.faults(),
        &[
            "src/one.md:5: eq:sum: this equation was never held against its check",
            "cargo book accept",
        ],
    );
}

#[test]
fn changed_tex_fails_until_it_is_accepted() {
    let book = SmallBook::sound().with("src/one.md", "c = a + b", "c = a - b");
    says(&book.faults(), &["src/one.md:5: eq:sum", "was: c = a + b", "cargo book accept"]);
    let accepted = book.run(&["accept"]);
    let shown = String::from_utf8_lossy(&accepted.stdout).into_owned();
    assert!(
        accepted.status.success() && shown.contains("[-+-]") && shown.contains("{+-+}"),
        "{shown}"
    );
    assert!(book.run(&["check"]).status.success());
}

#[test]
fn what_has_no_check_is_not_accepted_and_what_has_no_chapter_goes() {
    let book = SmallBook::sound().with("src/one.md", "{#eq:product}", "{#eq:times}");
    book.write("exhibits/accepted/gone.toml", "[equations]\nold = 'a'\n");
    let output = book.run(&["accept"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        said.contains("one eq:times has no check") && said.contains("gone eq:old is gone"),
        "{said}"
    );
    assert!(!book.read("exhibits/accepted/one.toml").contains("times"));
    assert!(!book.path("exhibits/accepted/gone.toml").exists());
}

#[test]
fn a_moved_line_break_does_not_change_an_equation() {
    let book = SmallBook::sound().with("src/one.md", "c = a + b", "c =\n a +  b");
    assert!(book.run(&["check"]).status.success());
}

#[test]
fn too_many_definitions_are_counted() {
    let book = SmallBook::sound().with(
        "src/one.md",
        "$$ e = a b $$ {#eq:product}",
        "$$ e = 2 $$ {#eq:two .definition}",
    );
    let report = book.faults();
    assert!(report.contains("src/one.md: 2 of 4 numbered equations are definitions"), "{report}");
}

#[test]
fn a_definition_with_a_check_is_named() {
    let book = SmallBook::sound()
        .with(
            "target/press/exhibits/one/exhibits.json",
            "\"label\":\"product\"",
            "\"label\":\"unit\"",
        )
        .with("exhibits/src/one.rs", "product", "unit")
        .with("src/one.md", "$$ e = a b $$ {#eq:product}", "");
    let report = book.faults();
    assert!(
        report.contains("src/one.md:13: eq:unit: a definition has nothing to check"),
        "{report}"
    );
}

#[test]
fn a_numbered_equation_needs_a_numbered_chapter() {
    let book = SmallBook::sound().with(
        "src/references.md",
        "{{bibliography}}",
        "$$ x = 1 $$ {#eq:x}\n\n{{bibliography}}",
    );
    let report = book.faults();
    assert!(
        report.contains(
            "src/references.md:3: eq:x: a numbered equation stands in a chapter that has no number"
        ),
        "{report}"
    );
}

#[test]
fn an_unknown_number_is_named() {
    let book = SmallBook::sound().with(
        "src/one.md",
        "is {{value one.sum}}",
        "is {{value one.sum}} or {{value one.product}}",
    );
    says(
        &book.faults(),
        &[
            "src/one.md:15: one.product: no program computes this number",
            "register it in exhibits/src/one.rs",
        ],
    );
}

#[test]
fn an_unknown_number_in_a_formula_is_named() {
    let book = SmallBook::sound().with("src/one.md", "A sum,", "A sum $x = {{value one.x}}$,");
    says(&book.faults(), &["src/one.md:3: one.x: no program computes this number"]);
}

#[test]
fn a_number_that_is_not_finite_is_named() {
    let book = SmallBook::sound().with(
        "target/press/exhibits/one/exhibits.json",
        "\"value\":3.0",
        "\"value\":null",
    );
    let report = book.faults();
    assert!(
        report.contains("src/one.md:15: one.sum: the computed number is not finite"),
        "{report}"
    );
}

#[test]
fn a_number_that_no_chapter_uses_is_named() {
    let book = SmallBook::sound().with("src/one.md", "is {{value one.sum}}", "is three");
    says(
        &book.faults(),
        &["exhibits/src/one.rs:1: one.sum: no chapter uses this number", "or remove it"],
    );
}

#[test]
fn an_unknown_figure_is_named() {
    let book = SmallBook::sound().with(
        "src/one.md",
        "## More",
        "![More.](one/more.svg){#fig:more alt=\"More.\"}\n\n## More",
    );
    says(
        &book.faults(),
        &["src/one.md:23: one/more.svg: no program draws this figure", "exhibits/src/one.rs"],
    );
}

#[test]
fn a_figure_that_no_chapter_shows_is_named() {
    let book = SmallBook::sound()
        .with("src/one.md", "![Sums.](one/sums.svg){#fig:sums alt=\"A rising line.\"}", "")
        .with("src/one.md", "see @fig:sums and", "see");
    says(&book.faults(), &["exhibits/src/one.rs:1: one/sums: no chapter shows this figure"]);
}

#[test]
fn a_figure_without_alternative_text_is_named() {
    let book = SmallBook::sound().with("src/one.md", " alt=\"A rising line.\"", "");
    says(&book.faults(), &["src/one.md:17: fig:sums: the figure has no alternative text", "alt="]);
}

#[test]
fn a_typed_number_with_a_unit_is_named() {
    let book = SmallBook::sound().with("src/one.md", "A sum,", "A sum of\n12.5 cm,");
    says(
        &book.faults(),
        &[
            "src/one.md:4: 12.5 cm: a number with a unit is typed into the prose",
            "{{value one.NAME}}",
            "book.toml",
        ],
    );
}

#[test]
fn a_typed_number_with_a_unit_in_a_formula_is_named() {
    let book = SmallBook::sound().with("src/one.md", "A sum,", r"A sum $5\,\mathrm{m}$,");
    says(&book.faults(), &["src/one.md:3", "a number with a unit is typed into the prose"]);
}

#[test]
fn a_permission_that_nothing_needs_is_named() {
    let book = SmallBook::sound().with("src/one.md", "60 s", "sixty seconds");
    says(
        &book.faults(),
        &[
            "book.toml: one: 60 s: a typed number is allowed that no chapter has",
            "remove the permission",
        ],
    );
}

#[test]
fn a_permission_without_a_reason_is_named() {
    let book = SmallBook::sound().with("book.toml", "a minute is a definition", "");
    says(&book.faults(), &["book.toml: one: 60 s: a typed number is allowed without a reason"]);
}

#[test]
fn a_listing_whose_anchor_is_gone_is_named() {
    let book = SmallBook::sound().with("code/src/one.rs", "ANCHOR: add", "ANCHOR: sub");
    says(
        &book.faults(),
        &["src/one.md:19: lst:add: code/src/one.rs has no anchor `add`", "// ANCHOR: add"],
    );
}

#[test]
fn code_in_another_language_is_cut_from_its_file_too() {
    let book = SmallBook::sound();
    let include = "```python\n{{#include ../code/add.py:add}}\n```\n";
    book.write("src/one.md", &(book.read("src/one.md") + include));
    book.write("code/add.py", "# ANCHOR: add\na + b\n# ANCHOR_END: add\n");
    assert!(book.run(&["build"]).status.success());
    assert!(book.read("book/one.html").contains("a + b\n</code>"));
    let book = book.with("code/add.py", "ANCHOR: add", "ANCHOR: sub");
    says(&book.faults(), &["code/add.py has no anchor `add`"]);
}

#[test]
fn a_listing_of_a_file_that_is_gone_is_named() {
    let book = SmallBook::sound().with("src/one.md", "../code/src/one.rs", "../code/src/two.rs");
    says(&book.faults(), &["src/one.md:19: lst:add: ../code/src/two.rs is not a file of the book"]);
}

#[test]
fn a_listing_from_outside_the_book_is_refused() {
    let book = SmallBook::sound().with("src/one.md", "../code/src/one.rs", "../../../etc/passwd");
    says(&book.faults(), &["lst:add: ../../../etc/passwd is not a file of the book"]);
}

#[test]
fn a_listing_that_is_too_long_is_named() {
    let book =
        SmallBook::sound().with("code/src/one.rs", "    a + b\n", &"    a + b;\n".repeat(30));
    says(
        &book.faults(),
        &["src/one.md:19: lst:add: the listing has 33 lines, and 25", "cut it in two"],
    );
}

#[test]
fn a_listing_without_a_label_or_a_caption_is_named() {
    let book = SmallBook::sound().with("src/one.md", " caption=\"A sum.\"", "");
    says(&book.faults(), &["src/one.md:19: lst:add: the listing has no caption"]);
    let book = SmallBook::sound().with("src/one.md", "#lst:add ", "").with(
        "src/one.md",
        " and @lst:add",
        "",
    );
    says(&book.faults(), &["src/one.md:19: a listing needs a label of its kind", "{#lst:name}"]);
}

#[test]
fn inline_rust_is_refused() {
    let book =
        SmallBook::sound().with("src/one.md", "## More", "```rust\nfn main() {}\n```\n\n## More");
    says(&book.faults(), &["src/one.md:23: Rust is typed into the chapter", "{{#include"]);
}

#[test]
fn code_of_no_language_is_refused() {
    let book =
        SmallBook::sound().with("src/one.md", "## More", "```\nfn main() {}\n```\n\n## More");
    says(&book.faults(), &["src/one.md:23: a code block does not say its language"]);
    let book = SmallBook::sound().with("src/one.md", "## More", "    fn main() {}\n\n## More");
    says(&book.faults(), &["src/one.md:23: fn main() {}: four spaces make this a block of code"]);
}

#[test]
fn an_include_in_the_prose_is_refused() {
    let book = SmallBook::sound().with(
        "src/one.md",
        "## More",
        "{{#include ../code/src/one.rs}}\n\n## More",
    );
    says(
        &book.faults(),
        &["src/one.md:23", "the press knows no such directive", "code is included by a listing"],
    );
}

#[test]
fn a_dead_link_is_found_in_the_rendered_pages() {
    let book = SmallBook::sound().with("src/one.md", "(ledger.md)", "(legend.md)");
    let report = book.faults();
    assert!(
        report
            .contains("src/one.md:25: legend.html: the link leads nowhere: there is no such file"),
        "{report}"
    );
}

#[test]
fn a_link_from_the_root_of_a_host_is_found_in_the_rendered_pages() {
    let book = SmallBook::sound().with("src/one.md", "(ledger.md)", "(/ledger.html)");
    says(&book.faults(), &["/ledger.html: the link leads nowhere"]);
}

#[test]
fn a_dead_fragment_is_found_in_the_rendered_pages() {
    let book = SmallBook::sound().with("src/one.md", "(ledger.md)", "(ledger.md#nothing)");
    let report = book.faults();
    assert!(report.contains("src/one.md:25: ledger.html#nothing: the link leads nowhere: ledger.html has no `#nothing`"), "{report}");
}

#[test]
fn a_request_to_another_host_is_found_in_the_rendered_pages() {
    let book = SmallBook::sound().with(
        "src/one.md",
        "An [inner",
        "<img alt=\"\" src=\"https://example.org/a.png\"> An [inner",
    );
    let report = book.faults();
    assert!(
        report.contains("src/one.md:25: https://example.org/a.png: the page asks another host"),
        "{report}"
    );
}

#[test]
fn tex_that_katex_rejects_is_found_with_its_line() {
    let book = SmallBook::sound().with("src/one.md", "c = a + b", "c = a\n + \\nothing b").with(
        "exhibits/accepted/one.toml",
        "c = a + b",
        "c = a + \\nothing b",
    );
    let report = book.faults();
    assert!(report.contains("src/one.md:7: eq:sum: KaTeX rejects the formula"), "{report}");
    assert!(report.contains("nothing"), "{report}");
}

#[test]
fn inline_tex_that_katex_rejects_is_found_with_its_line() {
    let book = SmallBook::sound().with("src/one.md", "An [inner", "An $\\frac{1}$ [inner");
    let report = book.faults();
    assert!(report.contains("src/one.md:25: KaTeX rejects the formula"), "{report}");
}

#[test]
fn katex_settings_that_would_ask_another_host_are_refused() {
    let book = SmallBook::sound().with("book.toml", "no-css = true", "no-css = false");
    let report = book.faults();
    assert!(report.contains("book.toml: [preprocessor.katex] would ask another host"), "{report}");
    let book = SmallBook::sound().with("book.toml", "trust = true", "trust = 3");
    let report = book.faults();
    assert!(report.contains("book.toml: [preprocessor.katex] cannot be read"), "{report}");
}

#[test]
fn a_warning_of_mdbook_is_a_fault() {
    let book = SmallBook::sound().with("src/one.md", "An [inner", "An <em>open [inner");
    let report = book.faults();
    assert!(report.contains("src/one.md: mdBook: unclosed HTML tag `<em>`"), "{report}");
}

#[test]
fn marks_and_attributes_that_nothing_reads_are_named() {
    for (old, new, said) in [
        (
            "A sum,",
            "A [sum]{defined},",
            "src/one.md:3: [: braces behind these brackets are no attributes",
        ),
        (
            "A sum,",
            "A {{value sum,",
            "src/one.md:3: {{: two braces begin here and are never closed",
        ),
        (
            "A sum,",
            "A [sum]{.measured mean=\"x\"},",
            "src/one.md:3: mean: no span has such an attribute",
        ),
        (
            "A sum,",
            "A [sum]{.defined .measured},",
            "src/one.md:3: measured: a span has one class, and this is its second",
        ),
        (
            "A sum,",
            "A [sum]{.measured #sum},",
            "src/one.md:3: sum: only a saying has a name to link to",
        ),
        ("{#sec:more}", "{#sec:more .dept}", "src/one.md:23: dept: nothing reads this attribute"),
        (
            "{#fig:sums alt",
            "{#fig:sums widgt=\"a\" alt",
            "src/one.md:17: widgt: nothing reads this attribute",
        ),
        (
            "\n## More",
            "\n<!-- to do --> More.\n\n## More",
            "src/one.md:23: More.: what stands behind a comment",
        ),
        (
            "## Letters",
            "## Letters {#sec:letters .depth establishes=\"A sentence.}",
            "src/one.md:27: the list of a heading's attributes",
        ),
        (
            "\n## More",
            "\n```{.text caption=\"A sum.}\na\n```\n\n## More",
            "src/one.md:23: the list of a listing's attributes",
        ),
    ] {
        says(&SmallBook::sound().with("src/one.md", old, new).faults(), &[said]);
    }
}

#[test]
fn a_comment_inside_of_a_paragraph_changes_nothing_and_moves_no_line() {
    let book =
        SmallBook::sound().with("src/one.md", "[both are", "[both\n<!-- why\nso -->\nare").with(
            "src/one.md",
            "A sum,",
            "A [sum\n<!-- why -->\nof two]{.measured} $a\n<!-- b -->\n+ b$,",
        );
    let output = book.run(&["build"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(book.read("book/one.html").contains(">sum\nof two</span>"));
    let book = book.with("src/one.md", "@eq:sum of", "@eq:summ of");
    says(&book.faults(), &["src/one.md:7: @eq:summ"]);
}

#[test]
fn two_pages_of_one_name_are_named() {
    let book = SmallBook::sound().with("src/SUMMARY.md", "\n---", "- [One](more/one.md)\n\n---");
    book.write("src/more/one.md", "# One\n\nThe same.\n");
    let report = book.faults();
    assert!(report.contains("src/more/one.md: one: src/one.md has the same name"), "{report}");
}

#[test]
fn a_formula_that_never_ends_is_named() {
    let book = SmallBook::sound().with("src/one.md", "A sum,", "A $sum,");
    let report = book.faults();
    assert!(report.contains("src/one.md:3: $: a formula begins here and never ends"), "{report}");
}

#[test]
fn blocks_that_never_end_are_named() {
    let book = SmallBook::sound().with("src/one.md", "## More", "::: note\nA note.\n\n## More");
    let report = book.faults();
    assert!(report.contains("src/one.md:23: note: a division (:::) is never closed"), "{report}");
    let book = SmallBook::sound().with("src/one.md", "## More", "$$ x\n\n## More");
    let report = book.faults();
    assert!(report.contains("src/one.md:23: a display equation"), "{report}");
}

#[test]
fn a_division_of_an_unknown_class_is_named() {
    let book =
        SmallBook::sound().with("src/one.md", "## More", "::: aside\nA note.\n:::\n\n## More");
    says(
        &book.faults(),
        &["src/one.md:23: aside: a division has no class that the book knows", "opening, predict"],
    );
}

#[test]
fn a_prediction_needs_one_right_choice_and_a_reveal() {
    let book = SmallBook::sound().with(
        "src/one.md",
        "## More",
        "::: {.predict #predict:x}\nWhat?\n\n- [ ] This.\n- [ ] That.\n:::\n\n## More",
    );
    says(
        &book.faults(),
        &[
            "src/one.md:23: predict:x: a prediction has one right choice and one reveal, and this one has 0 and 0",
        ],
    );
}

#[test]
fn a_choice_stays_one_paragraph_whatever_its_lines_begin_with() {
    let choices = "::: {.predict #predict:x}\nWhat?\n\n- [ ] The depth\n  + the baseline.\n- [x] That.\n\n\
        ::: reveal\nWhy.\n:::\n:::\n\n## More";
    let book = SmallBook::sound().with("src/one.md", "## More", choices);
    assert!(book.run(&["build"]).status.success());
    assert!(book.read("book/one.html").contains("<p>The depth + the baseline.</p>"));
}

#[test]
fn an_unknown_work_is_named() {
    let book = SmallBook::sound().with("src/one.md", "[@author2001]", "[@author2001; @other1999]");
    says(
        &book.faults(),
        &["src/one.md:3: @other1999: the bibliography has no such work", "src/references.bib"],
    );
}

#[test]
fn a_work_without_an_annotation_is_named() {
    let book = SmallBook::sound().with("src/references.bib", "  annotation = {Adds.}\n", "");
    says(&book.faults(), &["src/references.bib:1: author2001: the work has no annotation"]);
}

#[test]
fn a_record_that_was_never_made_or_from_other_inputs_is_named() {
    let records = "\"records\":[{\"name\":\"long\",\"inputs\":{\"draws\":\"9\"},\"file\":\"exhibits/src/one.rs\",\"line\":3}]";
    let book = SmallBook::sound().with(
        "target/press/exhibits/one/exhibits.json",
        "\"records\":[]",
        records,
    );
    says(
        &book.faults(),
        &["exhibits/src/one.rs:3: long: this record was never made", "cargo book record long"],
    );
    let record = "name = \"long\"\nchapter = \"one\"\ncommand = \"\"\ninput-digest = \"\"\nmachine = \"\"\ndate = \"\"\n[inputs]\ndraws = \"8\"\n[values]\n";
    book.write("exhibits/records/long.toml", record);
    says(&book.faults(), &["long: the record was made from other inputs"]);
}

/// The small book with its second section in depth.
fn in_depth() -> SmallBook {
    let heading = "## More {#sec:more .depth establishes=\"There is more.\"}";
    SmallBook::sound().with("src/one.md", "## More {#sec:more}", heading)
}

#[test]
fn the_main_road_that_needs_what_is_in_depth_is_named() {
    let book = in_depth().with("src/one.md", "A sum, as in", "By @sec:more, a sum, as in");
    says(
        &book.faults(),
        &["src/one.md:3: @sec:more: the main road needs something that is in depth"],
    );
}

#[test]
fn the_main_road_may_point_into_depth_and_what_is_there_needs_what_it_likes() {
    let book = in_depth()
        .with("src/one.md", "A sum, as in", "By [@sec:more]{.further}, a sum, as in")
        .with("src/one.md", "An [inner link]", "By @eq:sum and @sec:more, an [inner link]");
    assert!(book.run(&["check"]).status.success());
}

#[test]
fn a_pointer_into_depth_is_one_reference() {
    let book =
        in_depth().with("src/one.md", "A sum, as in", "[See @sec:more]{.further}. A sum, as in");
    says(&book.faults(), &["a pointer into depth is one reference"]);
}

#[test]
fn a_section_in_depth_that_does_not_say_what_it_establishes_is_named() {
    let book =
        SmallBook::sound().with("src/one.md", "## More {#sec:more}", "## More {#sec:more .depth}");
    says(&book.faults(), &["a section in depth does not say what it establishes"]);
}

#[test]
fn a_term_that_is_defined_twice_is_named_with_its_first_place() {
    let text = "A [sum]{.defined}, and again a [sum]{.defined}, as in";
    let book = SmallBook::sound().with("src/one.md", "A sum, as in", text);
    says(&book.faults(), &["src/one.md:3: sum: src/one.md:3 defines this term"]);
}

#[test]
fn a_saying_has_an_address_of_its_own() {
    let saying = |text| SmallBook::sound().with("src/one.md", "A sum, as in", text);
    assert!(saying("[A sum]{.saying #sum}, as in").run(&["check"]).status.success());
    let nameless = saying("[A sum]{.saying}, as in").faults();
    says(&nameless, &["src/one.md:3: A sum: a saying has no name to link to"]);
    let twice = saying("[A sum]{.saying #sum} and [a sum]{.saying #sum}, as in").faults();
    says(&twice, &["src/one.md:3: saying:sum: an earlier saying of this page has this name"]);
}

#[test]
fn a_term_that_only_depth_defines_is_not_for_the_main_road() {
    let book =
        in_depth().with("src/one.md", "An [inner link]", "A [Sum]{.defined}, and an [inner link]");
    let said = "Sum: the main road uses a term that src/one.md:25 defines in depth";
    let report = book.faults();
    assert!(report.contains(said), "{report}");
    let elsewhere =
        SmallBook::sound().with("src/one.md", "A sum, as in", "A [sum]{.defined}, as in");
    assert!(elsewhere.run(&["check"]).status.success());
}

#[test]
fn only_an_equation_is_shown_again() {
    let again = |what| {
        let text = format!("\n\n{{{{again {what}}}}}\n\nAn [inner link]");
        SmallBook::sound().with("src/one.md", "An [inner link]", &text)
    };
    assert!(again("eq:sum").run(&["check"]).status.success());
    says(&again("lst:add").faults(), &["lst:add: this is no equation to show again"]);
}

#[test]
fn a_way_to_a_section_that_is_not_there_is_named_with_the_nearest_one() {
    let way = "A sum ({{way one#sec:mor}}), as in";
    let book = SmallBook::sound().with("src/one.md", "A sum, as in", way);
    says(
        &book.faults(),
        &["one#sec:mor: the book has no such chapter or section", "did you mean one#sec:more?"],
    );
}

#[test]
fn a_title_that_names_a_way_is_named_where_a_way_leads_to_it() {
    let way = "A sum ({{way one#sec:more}}), as in";
    let book = SmallBook::sound().with("src/one.md", "A sum, as in", way);
    let book = book.with("src/one.md", "## More", "## More {{way one#sec:more}}");
    let report = book.faults();
    for line in [3, 23] {
        let fault = "one#sec:more: the title that a way leads to names a way";
        assert!(report.contains(&format!("src/one.md:{line}: {fault}")), "{report}");
    }
}

#[test]
fn a_chapter_that_the_contents_call_something_else_is_named() {
    let book = SmallBook::sound().with("src/SUMMARY.md", "[One]", "[Two]");
    let said = "src/one.md:1: One: the table of contents calls this page “Two”";
    says(&book.faults(), &[said]);
}

#[test]
fn a_chapter_that_summary_names_and_nobody_wrote_is_an_error() {
    let book = SmallBook::sound().with("src/SUMMARY.md", "(one.md)", "(two.md)");
    let report = book.faults();
    assert!(
        report.contains("mdBook cannot read the book") && report.contains("two.md"),
        "{report}"
    );
}

#[test]
fn a_folder_without_a_book_says_where_to_go() {
    let folder = tempfile::tempdir().unwrap();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_press"))
        .args(["check", "--root"])
        .arg(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && text.contains("there is no book.toml"), "{text}");
}

#[test]
fn a_theorem_without_conditions_is_named() {
    let book = SmallBook::sound().with(
        "src/one.md",
        "[both are positive]{.condition name=\"positive\"}",
        "both are positive",
    );
    let report = book.faults();
    assert!(report.contains("thm:grows: the theorem names no conditions"), "{report}");
}

#[test]
fn a_condition_without_a_counterexample_is_named() {
    let shown = "::: {.counterexample of=\"thm:grows\" without=\"positive\"}";
    let book = SmallBook::sound().with("src/one.md", shown, "::: note");
    let report = book.faults();
    assert!(
        report.contains("thm:grows: 0 counterexamples drop its condition “positive”"),
        "{report}"
    );
    assert!(report.contains("thm:grows, positive: no page shows this counterexample"), "{report}");
}

#[test]
fn a_counterexample_that_no_program_computes_is_named() {
    let computed = "{\"theorem\":\"grows\"";
    let book = SmallBook::sound().with(
        "target/press/exhibits/one/exhibits.json",
        computed,
        "{\"theorem\":\"other\"",
    );
    let report = book.faults();
    assert!(
        report.contains("thm:grows, positive: no program computes this counterexample"),
        "{report}"
    );
}

#[test]
fn a_counterexample_that_shows_nothing_is_named() {
    let book = SmallBook::sound().with(
        "target/press/exhibits/one/exhibits.json",
        "\"against\":\"counting\",\"failure\":null,\"file\":\"exhibits/src/one.rs\",\"line\":1}],\n\"numbers\"",
        "\"against\":\"counting\",\"failure\":\"it holds\",\"file\":\"exhibits/src/one.rs\",\"line\":1}],\n\"numbers\"",
    );
    says(&book.faults(), &["thm:grows, positive: the counterexample shows nothing: it holds"]);
}

#[test]
fn two_conditions_of_one_name_are_named() {
    let condition = "{.condition name=\"positive\"}";
    let book = SmallBook::sound().with(
        "src/one.md",
        "If [both",
        &format!("If [the first is]{condition} and [both"),
    );
    says(&book.faults(), &["positive: the theorem has a condition of this name already"]);
}

#[test]
fn a_condition_inside_another_mark_is_a_condition() {
    let (condition, marked) = ("{.condition name=\"positive\"}", "]{.measured}");
    let book = SmallBook::sound().with("src/one.md", "If [both", "If [[both").with(
        "src/one.md",
        condition,
        &format!("{condition}{marked}"),
    );
    let output = book.run(&["check"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_condition_outside_of_a_theorem_is_named() {
    let book =
        SmallBook::sound().with("src/one.md", "A sum, as", "A [sum]{.condition name=\"x\"}, as");
    says(&book.faults(), &["src/one.md:3: sum: a condition has a name, and stands in a theorem"]);
}

#[test]
fn a_letter_that_nothing_explains_is_named() {
    let book = SmallBook::sound().with("src/one.md", "[$e$]{.symbol means=\"a product\"}", "$e$");
    says(&book.faults(), &["src/one.md:11: e in eq:product: nothing explains this letter"]);
}

#[test]
fn a_letter_with_two_meanings_is_named_with_the_first() {
    let book = SmallBook::sound().with("src/one.md", "is one.", "is [$a$]{.symbol means=\"one\"}.");
    says(&book.faults(), &["src/one.md:31: a: line 29 says that it is: the first"]);
}

#[test]
fn a_letter_that_only_depth_explains_is_not_for_the_main_road() {
    let book = SmallBook::sound().with(
        "src/one.md",
        "Two numbers",
        "### Less {.depth establishes=\"Sums add.\"}\n\nTwo numbers",
    );
    let report = book.faults();
    assert!(
        report.contains("a in eq:sum: the main road uses a letter that only depth explains"),
        "{report}"
    );
}

#[test]
fn a_mark_that_does_not_say_what_a_letter_means_is_named() {
    let book = SmallBook::sound().with("src/one.md", "means=\"a product\"", "unit=\"m\"");
    let report = book.faults();
    assert!(report.contains("the mark does not say what the letter means"), "{report}");
}

#[test]
fn a_work_that_was_never_compared_with_its_own_page_is_named() {
    let book = SmallBook::sound().with("src/references.bib", "verified = {its page},", "");
    says(&book.faults(), &["author2001: nothing says whether the entry was compared"]);
}

/// A small book with the accepted record `long`, whose one value says this text.
fn with_record(text: &str) -> SmallBook {
    let records = "\"records\":[{\"name\":\"long\",\"inputs\":{},\"file\":\"exhibits/src/one.rs\",\"line\":3}]";
    let book = SmallBook::sound()
        .with("target/press/exhibits/one/exhibits.json", "\"records\":[]", records)
        .with("src/one.md", "{{value one.sum}}", "{{value one.sum}} and {{value long.most}}");
    let value =
        format!("[values.most]\nvalue = 3.1\ntext = \"{text}\"\nunit = \"\"\nwithin = 0.0\n");
    let record = "name = \"long\"\nchapter = \"one\"\ncommand = \"\"\ninput-digest = \"\"\nmachine = \"\"\ndate = \"\"\n[inputs]\n";
    book.write("exhibits/records/long.toml", &format!("{record}{value}"));
    book
}

#[test]
fn a_record_that_says_another_number_than_it_has_is_named() {
    assert!(with_record("3.1").run(&["check"]).status.success());
    says(&with_record("2.1").faults(), &["long.most: the text says 2.1, and the value is 3.1"]);
}

#[test]
fn a_record_that_cannot_be_read_is_accepted_anew() {
    let (kept, proposed) = ("exhibits/records/long.toml", "target/press/records/long.toml");
    let book = with_record("3.1");
    book.write(proposed, &book.read(kept));
    book.write(kept, "values = 1");
    let shown = book.run(&["accept", "--show"]);
    let said = String::from_utf8_lossy(&shown.stdout).into_owned();
    assert!(shown.status.success() && said.contains("most = 3.1"), "{said}");
    assert!(said.contains("equations cannot be compared"), "{said}");
    assert_eq!(book.read(kept), "values = 1");
    assert!(book.run(&["accept"]).status.success());
    assert!(book.run(&["check"]).status.success());
}

#[test]
fn a_record_that_no_program_makes_is_named() {
    let exhibits = "target/press/exhibits/one/exhibits.json";
    let book = with_record("3.1").with(exhibits, "\"name\":\"long\"", "\"name\":\"other\"");
    let report = book.faults();
    assert!(
        report.contains("exhibits/records/long.toml: long: no program makes this record"),
        "{report}"
    );
}

#[test]
fn a_value_that_its_record_does_not_have_is_named_with_the_command() {
    let records = "\"records\":[{\"name\":\"long\",\"inputs\":{},\"file\":\"exhibits/src/one.rs\",\"line\":3}]";
    let book = SmallBook::sound()
        .with("target/press/exhibits/one/exhibits.json", "\"records\":[]", records)
        .with("src/one.md", "{{value one.sum}}", "{{value one.sum}} and {{value long.most}}");
    let report = book.faults();
    assert!(report.contains("long.most: the record `long` was never accepted"), "{report}");
    assert!(report.contains("run `cargo book record long`, then `cargo book accept`"), "{report}");
    let record = "name = \"long\"\nchapter = \"one\"\ncommand = \"\"\ninput-digest = \"\"\nmachine = \"\"\ndate = \"\"\n[inputs]\n[values]\n";
    book.write("exhibits/records/long.toml", record);
    says(&book.faults(), &["long.most: the accepted record `long` has no value `most`"]);
    book.write("exhibits/records/long.toml", "values = 1");
    let report = book.faults();
    assert!(report.contains("long.toml is not the record `long`"), "{report}");
    assert!(report.contains("run `cargo book record long`"), "{report}");
}
