// What is slow: every width, large letters, forced colours, paper. Run before a piece of work is called done.

import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { each, launch, open, overhang, pages, pageWith, serve } from "./helper.mjs";

let browser, server;

before(async () => {
    server = await serve("/some/where/");
    browser = await launch();
});

after(async () => {
    await browser.close();
    server.close();
});

async function everyPage({ media, ...options }, body, files = pages()) {
    await each(files, async file => {
        const page = await browser.page(options);
        if (media) await page.emulateMedia({ media });
        await open(page, server.url + file);
        await body(page, file);
        assert.deepEqual(page.complaints, [], file);
        await page.context().close();
    });
}

for (const width of [320, 360, 768, 1280, 1920]) {
    test(`at ${width} px nothing scrolls sideways but what may, and nothing lies over anything`, async () => {
        for (const dark of [false, true]) {
            await everyPage({ width, dark }, async (page, file) => {
                assert.equal(await overhang(page), null, file);
                assert.deepEqual(await overlaps(page), [], file);
                await page.evaluate(() => document.querySelectorAll("main details").forEach(fold => { fold.open = true; }));
                await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
                assert.equal(await overhang(page), null, `${file}, folds open`);
                assert.deepEqual(await overlaps(page), [], `${file}, folds open`);
            });
        }
    });
}

/** Pairs of blocks that share ground: what stands in the margin, and the blocks of the text. */
const overlaps = page => page.evaluate(() => {
    const shown = selector => [...document.querySelectorAll(selector)]
        .map(node => ({ node, box: node.getBoundingClientRect() }))
        .filter(({ box }) => box.width > 0 && box.height > 0);
    const margins = shown("main .margin");
    const blocks = shown("main > p, main > ul, main > ol, main > figure, main > .table-wrapper, .equation-body, .equation-number");
    const meet = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1
        && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
    const name = node => `${node.className || node.tagName} “${node.textContent.trim().slice(0, 40)}”`;
    return margins.flatMap((margin, index) => [...margins.slice(index + 1), ...blocks]
        .filter(other => !margin.node.contains(other.node) && !other.node.contains(margin.node) && meet(margin.box, other.box))
        .map(other => `${name(margin.node)} over ${name(other.node)}`));
});

test("on a wide screen, checks and notes stand in the margin, level with what they are about", async () => {
    await everyPage({ width: 1280 }, async (page, file) => {
        const strays = await page.evaluate(() => {
            const right = document.querySelector("main").getBoundingClientRect().right;
            return [...document.querySelectorAll(".equation > .margin")]
                .filter(margin => {
                    const box = margin.getBoundingClientRect();
                    return box.left < right || box.top > margin.parentElement.getBoundingClientRect().bottom + 200;
                })
                .map(margin => margin.parentElement.id)
                .concat([...document.querySelectorAll("main > .note")]
                    .filter(note => note.getBoundingClientRect().top < note.previousElementSibling.getBoundingClientRect().top)
                    .map(note => note.textContent.slice(0, 40)));
        });
        assert.deepEqual(strays, [], file);
    }, [pageWith(/class="check margin"/)]);
});

test("at 200 % zoom and with letters twice as large, every page still fits", async () => {
    await everyPage({ width: 640, height: 450, deviceScaleFactor: 2 }, async (page, file) => {
        assert.equal(await overhang(page), null, `${file} at 200 %`);
    });
    for (const width of [1280, 640]) {
        await everyPage({ width }, async (page, file) => {
            await page.addStyleTag({ content: "html { font-size: 200% }" });
            assert.equal(await overhang(page), null, `${file}, large letters at ${width} px`);
        });
    }
});

test("with more space between lines, words and letters, every page still fits", async () => {
    await everyPage({ width: 360 }, async (page, file) => {
        await page.addStyleTag({
            content: "main :not(.katex *) { line-height: 1.5 !important; letter-spacing: 0.12em !important; word-spacing: 0.16em !important }",
        });
        assert.equal(await overhang(page), null, file);
    });
});

test("in forced colours the text, the focus and the cues of the terms are there", async () => {
    await everyPage({ forcedColors: "active" }, async (page, file) => {
        assert.equal(await overhang(page), null, file);
        const cues = await page.locator("main .term").evaluateAll(terms => terms.map(term =>
            [term, ...term.children].some(node => getComputedStyle(node).borderBottomStyle !== "none")));
        assert.ok(cues.length > 0 && cues.every(Boolean), "a term without its line");
        const plates = await page.evaluate(() => [...document.querySelectorAll(".katex-html span")]
            .filter(span => getComputedStyle(span).forcedColorAdjust !== "none").length);
        assert.equal(plates, 0, "letters of formulas lie under plates");
        await page.keyboard.press("Tab");
        assert.notEqual(await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle), "none");
    }, [pageWith(/class="term /)]);
});

test("measured, estimated and prior differ by the line under them, in prose and in formulas", async () => {
    for (const [kind, line] of [["measured", "solid"], ["estimated", "dashed"], ["prior", "dotted"]]) {
        await everyPage({}, async page => {
            const lines = await page.locator(`main .term.${kind}`).evaluateAll(terms => terms.map(term =>
                getComputedStyle(term.closest(".katex") ? term.firstElementChild : term).borderBottomStyle));
            assert.deepEqual([...new Set(lines)], [line], kind);
        }, [pageWith(new RegExp(`class="(enclosing )?term ${kind}"`))]);
    }
});

// ---- Paper

const inner = 590; // CSS pixels between the margins of an A4 page: 210 mm less twice 27 mm

test("on paper no equation, table or listing is cut", async () => {
    await everyPage({ width: inner, dark: true, media: "print" }, async (page, file) => {
        const cut = await page.evaluate(() => [...document.querySelectorAll(".equation-body, .katex-display, .table-wrapper, pre, pre > code, .plot")]
            .filter(box => box.scrollWidth > box.clientWidth + 1
                || [...box.querySelectorAll(".katex-html .base")].some(base => base.getBoundingClientRect().right > innerWidth + 1))
            .map(box => `${box.className || box.tagName} ${box.closest("[id]")?.id}: ${box.scrollWidth} in ${box.clientWidth}`));
        assert.deepEqual(cut, [], file);
        assert.equal(await overhang(page), null, file);
    }, ["print.html"]);
});

test("on paper the ground is white, the chrome is gone and every answer is open", async () => {
    await everyPage({ width: inner, dark: true, media: "print" }, async page => {
        const paper = await page.evaluate(() => ({
            ground: getComputedStyle(document.documentElement).backgroundColor,
            ink: getComputedStyle(document.querySelector("main p")).color,
            chrome: [...document.querySelectorAll(".menu-bar, .sidebar, .turn, .buttons, .data")].filter(node => node.checkVisibility()).length,
            answers: [...document.querySelectorAll(".reveal")].map(fold => fold.open),
        }));
        assert.equal(paper.ground, "rgb(255, 255, 255)");
        assert.equal(paper.ink, "rgb(0, 0, 0)");
        assert.equal(paper.chrome, 0);
        assert.ok(paper.answers.length > 0 && paper.answers.every(Boolean));
    }, ["print.html"]);
});

test("the browser's PDF holds every chapter", async () => {
    const page = await browser.page({ dark: true });
    await open(page, `${server.url}print.html`);
    const titles = (await page.locator("main h1").allInnerTexts()).map(title => title.replace(/\s+/g, " ").trim());
    assert.ok(titles.length >= 2);
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "book-pdf-"));
    const file = path.join(folder, "book.pdf");
    const bytes = await page.pdf({ path: file, preferCSSPageSize: true, tagged: true, outline: true });
    assert.deepEqual(page.complaints, []);
    const count = bytes.toString("latin1").match(/\/Type\s*\/Page\b(?!s)/g)?.length ?? 0;
    assert.ok(count >= titles.length, `${count} pages for ${titles.length} chapters`);
    if (spawnSync("pdftotext", ["-v"]).error === undefined) {
        // A title's line may end behind a hyphen.
        const inOneLine = text => text.replace(/\s+/g, " ").replaceAll("- ", "-");
        const text = inOneLine(execFileSync("pdftotext", ["-layout", file, "-"], { maxBuffer: 1 << 28 }).toString());
        for (const title of titles) assert.ok(text.includes(inOneLine(title)), `“${title}” is not in the PDF`);
    }
    fs.rmSync(folder, { recursive: true });
    await page.context().close();
});

test("a single page prints with its answers, and folds them again", async () => {
    await everyPage({}, async page => {
        const open = () => page.locator(".reveal").first().evaluate(fold => fold.open);
        assert.equal(await open(), false);
        await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
        assert.equal(await open(), true);
        await page.evaluate(() => dispatchEvent(new Event("afterprint")));
        assert.equal(await open(), false);
    }, [pageWith(/class="predict"/)]);
});
