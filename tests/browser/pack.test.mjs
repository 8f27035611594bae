// What `cargo book pack` made, as somebody has it who took it along: the pages unpacked on a disk, and the book on paper.
// PACK_DIR names its folder.

import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { bookDir, launch, libraryPages, open, pages, read } from "./helper.mjs";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const packDir = path.resolve(process.env.PACK_DIR ?? path.join(root, "pack"));
const name = "visual-inertial-slam";
const made = end => path.join(packDir, `${name}.${end}`);
let browser, folder;

/** The address of a page where it was unpacked, in a folder whose name is no easy one. */
const address = file => pathToFileURL(path.join(folder, name, file)).href;

before(async () => {
    assert.ok(fs.existsSync(made("zip")), `${packDir} holds no ${name}.zip: run \`cargo book pack\` first`);
    folder = fs.mkdtempSync(path.join(os.tmpdir(), "taken along #1 "));
    execFileSync("python3", ["-m", "zipfile", "-e", made("zip"), folder]);
    browser = await launch();
});

after(async () => {
    await browser?.close();
    if (folder) fs.rmSync(folder, { recursive: true });
});

/** Why the letters of the PDF cannot be read. */
function noText() {
    return spawnSync("pdftotext", ["-v"]).error !== undefined && "there is no pdftotext";
}

/** Opens a page from the disk, and complains of all that a page on a server is complained of. */
async function at(file, options, body) {
    const page = await browser.page(options);
    try {
        await open(page, address(file));
        await body(page);
        assert.deepEqual(page.complaints, [], file);
    } finally {
        await page.context().close();
    }
}

// ---- Pages

test("every page opens from a disk with its letters and figures, and complains of nothing", async () => {
    for (const file of pages()) {
        await at(file, {}, async page => {
            assert.ok((await page.locator("main").innerText()).length > 100, `${file} is empty`);
            const broken = await page.evaluate(() => [
                ...[...document.fonts].filter(face => face.status === "error").map(face => face.family),
                ...[...document.images].filter(image => image.complete && image.naturalWidth === 0).map(image => image.src),
                ...[...document.querySelectorAll("figure:not([data-widget]) .plot svg")].filter(plot => plot.checkVisibility() && plot.getBoundingClientRect().height < 20).map(plot => plot.closest("figure").id),
            ]);
            assert.deepEqual(broken, [], file);
        });
    }
});

test("no link of a page leads to a folder, which a disk shows as a list of files", async () => {
    for (const file of pages()) {
        await at(file, {}, async page => {
            const folders = await page.evaluate(() => [...document.querySelectorAll("a[href]")]
                .filter(link => link.protocol === "file:" && link.pathname.endsWith("/")).map(link => link.href));
            assert.deepEqual(folders, [], file);
        });
    }
});

test("from a disk, the search finds a section and leads there", async () => {
    await at("index.html", {}, async page => {
        await page.keyboard.press("/");
        await page.locator("#mdbook-searchbar").pressSequentially("preintegration");
        const found = page.locator("#mdbook-searchresults a").first();
        await found.waitFor();
        await found.click();
        await page.waitForURL(/^file:.*\.html\?highlight=preintegration#/);
        assert.ok(await page.locator("main mark").count() > 0, "what was searched is not marked");
    });
});

test("from a disk, a picture to take hold of lives and answers", async () => {
    await at("bearing.html", {}, async page => {
        const figure = page.locator('figure[data-widget="bearing"]');
        await figure.scrollIntoViewIfNeeded();
        await page.waitForFunction(() => document.querySelector('figure[data-widget="bearing"]').widget);
        const values = () => figure.evaluate(({ widget }) => widget.readings.map(({ value }) => value.dataset.value));
        const before = await values();
        const slider = figure.locator('input[type="range"]').first();
        await slider.focus();
        for (let times = 0; times < 5; times += 1) await page.keyboard.press("ArrowRight");
        await page.waitForFunction(before => JSON.stringify(before) !== JSON.stringify(
            document.querySelector('figure[data-widget="bearing"]').widget.readings.map(({ value }) => value.dataset.value)), before);
    });
});

test("from a disk, the library opens, finds an item and leads back to the book", async () => {
    const page = await browser.page();
    await page.goto(`${address("api/vislam/index.html")}?search=project_cam`);
    await page.locator(".search-results a[href*='method.project_cam']").first().waitFor();
    const item = libraryPages().find(file => /class="book-equation"/.test(read(file)));
    await page.goto(address(item));
    await page.locator(".docblock a[href*='#eq:']").first().click();
    await page.waitForURL(/^file:.*\.html#eq:/);
    await page.context().close();
});

// ---- Paper

test("the PDF has tags, an outline and its letters, and its links lead into it or to other hosts", () => {
    const text = fs.readFileSync(made("pdf")).toString("latin1");
    assert.match(text, /\/MarkInfo\s*<<[^>]*\/Marked true/);
    assert.match(text, /\/StructTreeRoot \d+ 0 R/);
    assert.match(text, /\/Outlines \d+ 0 R/);
    assert.match(text, /\/Lang \(en/);
    // Fonts of variable weight come as drawings of their letters, the others as files.
    const drawn = text.match(/\/Subtype \/Type3\b/g) ?? [];
    const fonts = [...text.matchAll(/<<\/Type \/Font\n(?:\/FontDescriptor (\d+) 0 R\n)?\/BaseFont \/(\S+)\n\/Subtype \/(CIDFontType|TrueType|Type1)/g)];
    assert.ok(drawn.length > 5 && fonts.length > 5, `${drawn.length} and ${fonts.length} fonts`);
    const absent = fonts.filter(([, descriptor]) =>
        !new RegExp(`\n${descriptor} 0 obj\n<<[^>]*/FontFile[23]? \\d+ 0 R`).test(text));
    assert.deepEqual(absent.map(([, , name]) => name), []);
    assert.deepEqual([...new Set(text.match(/\/URI \((?!https?:|mailto:)[^)]*/g) ?? [])], []);
});

test("in the outline of the PDF an exercise stands below its chapter, and a title has its spaces", () => {
    const text = fs.readFileSync(made("pdf")).toString("latin1");
    const entries = new Map([...text.matchAll(/\n(\d+) 0 obj\n<<\/Title \((.*)\)\n\/Dest .*\n\/Parent (\d+) 0 R/g)]
        .map(([, number, title, parent]) => [number, { title, parent }]));
    const below = [...entries.values()].filter(({ title }) => /^\d+\.[A-Z] /.test(title));
    assert.ok(below.length > 10, `${below.length} pages below chapters`);
    for (const { title, parent } of below) {
        assert.equal(entries.get(parent)?.title.split(" ")[0], title.split(".")[0], title);
    }
    const shown = new Set([...read("print.html").matchAll(/<h1 id="[^"]*"><a[^>]*>(\d[^<]+)<\/a>/g)].map(([, title]) => title.trim()));
    const titles = new Set([...entries.values()].map(({ title }) => title));
    assert.deepEqual([...shown].filter(title => !titles.has(title)), []);
});

test("the first page says who wrote the book, which release it is and what may be done with it", { skip: noText() }, () => {
    const first = execFileSync("pdftotext", ["-l", "1", made("pdf"), "-"]).toString();
    const changelog = fs.readFileSync(path.join(root, "CHANGELOG.md"), "utf8");
    const [, version, year] = changelog.match(/^## \[(\d\S+)\] - (\d+)/m);
    for (const said of [/authors/, `Version ${version}, `, year, "CC BY 4.0", "MIT or Apache-2.0"]) {
        assert.match(first, new RegExp(said), `${said} is not on the first page`);
    }
});

test("a page number in the PDF is that of the page where its target stands", { skip: noText() }, () => {
    const all = execFileSync("pdftotext", ["-layout", made("pdf"), "-"], { maxBuffer: 1 << 28 }).toString().split("\f");
    const titles = [...read("print.html").matchAll(/<h1 id="[^"]*"><a[^>]*>(\d+ [^<]+)<\/a>/g)].map(([, title]) => title.trim());
    assert.ok(titles.length > 15, `${titles.length} chapters`);
    const squeeze = text => text.replace(/\s+/g, " ");
    // A line may end inside of a title behind a hyphen.
    const unbroken = text => text.replace(/\s+/g, "");
    const contents = all.slice(0, 20).map(squeeze).join(" ");
    for (const title of titles) {
        const escaped = title.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
        const number = Number(contents.match(new RegExp(`${escaped} (\\d+)`))?.[1]);
        assert.ok(unbroken(all[number - 1] ?? "").includes(unbroken(title)), `“${title}” is not on page ${number}`);
        assert.match(all[number - 1].trimEnd(), new RegExp(`\\s${number}$`), `page ${number} has another number`);
    }
});

test("packed twice, both files are the same to the byte", () => {
    const again = path.join(folder, "again");
    execFileSync("cargo", ["book", "pack", "--site", bookDir, "--into", again], { cwd: root, stdio: ["ignore", "ignore", "inherit"] });
    for (const end of ["zip", "pdf"]) {
        const [one, other] = [made(end), path.join(again, `${name}.${end}`)].map(file => fs.readFileSync(file));
        assert.ok(one.equals(other), `${name}.${end} comes out otherwise`);
    }
});
