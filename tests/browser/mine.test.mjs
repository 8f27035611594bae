// Answers of a student on the pages of their exercises, `cargo book serve --mine`: right and wrong ones, and those that
// never end, take all memory, trap or do not compile. Each leaves the page alive and says what happened.

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { axe, bookDir, launch, open, overhang, pages, read } from "./helper.mjs";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const every = Boolean(process.env.EVERY);
/** A book of the exercises alone, with answers of its own. It stays, so that its answers are compiled with what was compiled before. */
const copy = path.join(root, "target/mine/book");
const exercises = fs.readdirSync(path.join(root, "exercises/pictures/modules")).map(file => path.basename(file, ".rs")).sort();

const settings = `[book]
title = "Exercises"
language = "en"

[output.html]
theme = "press/theme"
default-theme = "light"
preferred-dark-theme = "navy"
additional-js = ["press/theme/book-extras.js"]
hash-files = true

[output.html.playground]
runnable = false

[preprocessor.press]
exhibits-package = ""
library-package = ""

[preprocessor.katex]
after = ["press", "links"]
no-css = true
output = "htmlAndMathml"
trust = true
macros = "press/theme/macros.txt"
`;

/** Everything that cargo wants of the workspace, the pages of the exercises, and the skeletons as answers. */
function copyBook() {
    const keep = new Set(["target"]);
    fs.mkdirSync(copy, { recursive: true });
    fs.readdirSync(copy).filter(name => !keep.has(name)).forEach(name => fs.rmSync(path.join(copy, name), { recursive: true }));
    const filter = file => !["node_modules", "records", ".progress"].includes(path.basename(file));
    const members = fs.readFileSync(path.join(root, "Cargo.toml"), "utf8").match(/^members = \[(.*)\]$/m)[1];
    const folders = new Set([...members.matchAll(/"([^"/]+)[^"]*"/g)].map(([, folder]) => folder));
    for (const name of [".cargo", ...folders, "Cargo.toml", "Cargo.lock", "src/exercises", "src/exercises.md"]) {
        fs.cpSync(path.join(root, name), path.join(copy, name), { recursive: true, preserveTimestamps: true, filter });
    }
    const lines = exercises.map(name => `    - [${name}](exercises/${name}.md)\n`);
    fs.writeFileSync(path.join(copy, "src/SUMMARY.md"), `# Summary\n\n- [Exercises](exercises.md)\n${lines.join("")}`);
    fs.writeFileSync(path.join(copy, "book.toml"), settings);
    exercises.forEach(name => fs.copyFileSync(skeleton(name), answer(name)));
}

const answer = name => path.join(copy, `exercises/src/${name}.rs`);
const solution = name => fs.readFileSync(path.join(root, `solutions/src/${name}.rs`), "utf8");

/** The newest skeleton. */
function skeleton(name) {
    const folder = path.join(root, "exercises/skeletons");
    const editions = fs.readdirSync(folder).sort((a, b) => Number(b) - Number(a));
    return editions.map(edition => path.join(folder, edition, `${name}.rs`)).find(file => fs.existsSync(file));
}

/** The reference answer whose derivative begins otherwise. */
function beginning(statements) {
    const head = "gravity: Vector3<f64>) -> Matrix9 {\n";
    const text = solution("residual_jacobian");
    assert.ok(text.includes(head));
    return text.replace(head, head + statements + "\n");
}

let browser, server, told = "", url;

/** Waits until a text is among what the server says. */
async function hears(pattern, patience) {
    for (const end = Date.now() + patience; Date.now() < end;) {
        const found = told.match(pattern);
        if (found) return found;
        await new Promise(resolve => setTimeout(resolve, 50));
    }
    throw new Error(`the server does not say ${pattern}:\n${told}`);
}

before(async () => {
    copyBook();
    const messages = execFileSync("cargo", ["build", "--quiet", "--bin", "press", "--message-format", "json"], { cwd: root, encoding: "utf8" });
    const program = messages.split("\n").filter(Boolean).map(line => JSON.parse(line)).find(({ executable }) => executable)?.executable;
    server = spawn(program, ["serve", "--mine", "--port", "0"], { cwd: copy, stdio: ["ignore", "ignore", "pipe"] });
    server.stderr.setEncoding("utf8").on("data", text => { told += text; });
    [, url] = await hears(/The book is at (http:\S+)/, 300_000);
    await hears(/✓ compiling your answers/, 900_000);
    browser = await launch();
});

after(async () => {
    await browser?.close();
    server?.kill();
});

/** Saves answers and waits until they are compiled. */
async function save(...answers) {
    const others = answers.filter(([name, text]) => fs.readFileSync(answer(name), "utf8") !== text);
    if (others.length === 0) return;
    told = "";
    others.forEach(([name, text]) => fs.writeFileSync(answer(name), text));
    await hears(/✓ compiling your answers/, 300_000);
}

/** Opens an exercise; the figure has a picture or says why it has none. */
async function exercise(name, options, body, { quiet = true, search = "" } = {}) {
    const page = await browser.page(options);
    try {
        // The server may load a page again at any time, so a test does not hear of it.
        await page.addInitScript(() => { window.EventSource = class { addEventListener() {} }; });
        await open(page, `${url}exercises/${name}.html${search}`);
        const figure = page.locator(`figure[data-answer="${name}"]`);
        await figure.scrollIntoViewIfNeeded();
        await page.waitForFunction(() => [...document.querySelectorAll("[data-answer] :is(.said, .trouble, .plot pre)")].some(({ textContent }) => textContent));
        await body(page, figure);
        if (quiet) assert.deepEqual(page.complaints, [], name);
    } finally {
        await page.context().close();
    }
}

const said = figure => figure.locator(".said").innerText();
const readings = figure => figure.evaluate(({ widget }) =>
    Object.fromEntries(widget.readings.map(({ face, value }) => [face.label, Number(value.dataset.value)])));

/** The page lives: a slider answers to the keyboard, and another question of the page can be answered. */
async function alive(page, figure) {
    const slider = figure.locator('input[type="range"]').first();
    await slider.focus();
    const before = await slider.getAttribute("aria-valuetext");
    await page.keyboard.press("ArrowRight");
    await page.waitForFunction(([slider, before]) => slider.getAttribute("aria-valuetext") !== before, [await slider.elementHandle(), before]);
    await page.locator(".predict input").first().check();
}

test("the book as it is published has no trace of answers", () => {
    for (const file of pages()) assert.doesNotMatch(read(file), /data-answer|\bmine[-\w]*\.(js|css)|\{\{mine/, file);
    assert.ok(!fs.existsSync(path.join(bookDir, "generated/mine")));
});

test("a right answer lies on the book's", async () => {
    await save(["residual_jacobian", solution("residual_jacobian")]);
    await exercise("residual_jacobian", {}, async (page, figure) => {
        assert.match(await said(figure), /as fast as the book's/);
        const { "Steps until it is there, yours": yours, "The same, the book's": books } = await readings(figure);
        assert.ok(yours > 0 && yours === books, `${yours} ${books}`);
        assert.deepEqual(await axe(page), []);
        await alive(page, figure);
        await page.waitForFunction(() => location.search.length > 1);
    });
});

test("a wrong sign is seen diverging", async () => {
    await save(["residual_jacobian", solution("residual_jacobian").replace("    jacobian\n}", "    -jacobian\n}")]);
    await exercise("residual_jacobian", {}, async (page, figure) => {
        assert.match(await said(figure), /has not fallen: look at signs/);
        assert.ok(Number.isNaN((await readings(figure))["Steps until it is there, yours"]));
        await alive(page, figure);
    });
});

const always = "first.position.x.is_finite()";
const hostile = {
    "is not written yet": ["todo!(\"nine blocks\");", /^Not written yet: nine blocks\.$/],
    "never ends": [`while ${always} { std::hint::black_box(&first); }`, /longer than 2 s and was ended\. Look for a loop/],
    "takes 4 GB": [`let mut all = Vec::new(); while ${always} && all.len() < 512 { all.push(vec![1.0_f64; 1 << 20]); } std::hint::black_box(&all);`, /more memory than the 64 MB/],
    "panics": [`let none: Vec<f64> = Vec::new(); if ${always} { std::hint::black_box(none[std::hint::black_box(7)]); }`, /panicked at exercises\/src\/residual_jacobian\.rs:\d+: index out of bounds/],
    "overflows the stack": ["fn deep(n: u64) -> u64 { if n == u64::MAX { 0 } else { 1 + std::hint::black_box(deep)(n + 1) } } if deep(0) == 7 { return Matrix9::zeros(); }", /overflowed the stack/],
    "aborts": [`if ${always} { std::process::abort() }`, /stopped without a word/],
};

for (const [what, [statements, sentence]] of Object.entries(hostile)) {
    test(`an answer that ${what} leaves the page alive, and what is expected stands there alone`, async () => {
        await save(["residual_jacobian", beginning(statements)]);
        await exercise("residual_jacobian", { width: 360, dark: true }, async (page, figure) => {
            const trouble = figure.locator(".trouble");
            await page.waitForFunction(() => document.querySelector(".trouble")?.textContent);
            assert.match(await trouble.innerText(), sentence);
            await page.waitForFunction(() => document.querySelectorAll(".mine .marks path").length > 2);
            assert.equal(await overhang(page), null);
            assert.deepEqual(await axe(page), []);
            await alive(page, figure);
            await page.waitForFunction(() => document.querySelector(".trouble").textContent);
            assert.match(await trouble.innerText(), sentence, "after a slider was moved");
        });
    });
}

test("an answer that fails in some places is shown again in the others", async () => {
    await save(["residual_jacobian", beginning("if deltas.duration > 1.05 { panic!(\"too long\") }")]);
    await exercise("residual_jacobian", {}, async (page, figure) => {
        assert.match(await said(figure), /as fast as the book's/);
        const slider = figure.getByRole("slider", { name: "Length of the intervals" });
        await slider.focus();
        await page.keyboard.press("ArrowRight");
        await page.waitForFunction(() => /too long/.test(document.querySelector(".trouble").textContent));
        await page.keyboard.press("ArrowLeft");
        await page.waitForFunction(() => document.querySelector(".trouble").textContent === "");
        assert.match(await said(figure), /as fast as the book's/);
    });
});

test("an answer that gives no numbers is drawn as far as it goes, with a sentence", async () => {
    await save(["residual_jacobian", beginning(`if ${always} { return Matrix9::repeat(f64::NAN); }`)]);
    await exercise("residual_jacobian", {}, async (page, figure) => {
        assert.match(await said(figure), /not finite/);
        await alive(page, figure);
    });
});

test("an answer that does not compile shows what the compiler says, and holds up no other", async () => {
    await save(["residual_jacobian", beginning("let x: u8 = \"a\";")]);
    await save(["left_perturbation", solution("left_perturbation")]);
    await exercise("residual_jacobian", { width: 360 }, async (page, figure) => {
        assert.match(await figure.locator(".widget-note").innerText(), /does not compile/);
        assert.match(await figure.locator("pre").innerText(), /mismatched types\s+--> exercises\/src\/residual_jacobian\.rs:\d+/);
        assert.equal(await overhang(page), null);
        assert.deepEqual(await axe(page), []);
        await page.locator(".predict input").first().check();
    });
    await exercise("left_perturbation", {}, async (page, figure) => {
        assert.match(await said(figure), /as fast as the book's/);
    });
    await save(["residual_jacobian", beginning("").replace("pub fn by_world_steps", "fn by_world_steps")]);
    await exercise("residual_jacobian", {}, async (page, figure) => {
        assert.match(await figure.locator(".widget-note").innerText(), /together with what calls it: a function is missing, is not `pub`/);
    });
});

test("a page that is open follows what is saved, and keeps its sliders", async () => {
    await save(["residual_jacobian", beginning("todo!(\"later\");")]);
    const page = await browser.page({});
    await open(page, `${url}exercises/residual_jacobian.html?residual_jacobian.problem=7`);
    await page.waitForFunction(() => /later/.test(document.querySelector(".trouble")?.textContent));
    fs.writeFileSync(answer("residual_jacobian"), solution("residual_jacobian"));
    await page.waitForFunction(() => /as fast as the book's/.test(document.querySelector(".said")?.textContent), null, { timeout: 120_000 });
    assert.equal(await page.locator("figure[data-answer]").evaluate(({ widget }) => widget.session.controls.at(-1)), 7);
    await page.context().close();
});

test("every skeleton says what is not written, and every reference answer agrees with what is expected", async () => {
    await save(...exercises.map(name => [name, fs.readFileSync(skeleton(name), "utf8")]));
    for (const name of every ? exercises : exercises.slice(0, 3)) {
        await exercise(name, {}, async (page, figure) => {
            await page.waitForFunction(() => document.querySelector(".trouble")?.textContent);
            assert.match(await figure.locator(".trouble").innerText(), /^Not written yet: /, name);
        });
    }
    const right = /agrees with what is expected|as fast as the book's|with more steps/;
    await save(...exercises.map(name => [name, solution(name)]));
    for (const name of exercises) {
        await exercise(name, every ? { width: 360, dark: true } : {}, async (page, figure) => {
            assert.match(await said(figure), right, name);
            if (!every) return;
            assert.equal(await overhang(page), null, name);
            assert.deepEqual(await axe(page), [], name);
            const tried = figure.locator("select").first();
            for (let check = 0; check < await tried.locator("option").count(); check += 1) {
                await tried.selectOption(String(check));
                await page.waitForFunction(() => !document.querySelector("figure[data-answer]").widget.session.busy);
                assert.equal(await figure.locator(".trouble").innerText(), "", `${name} ${check}`);
                assert.match(await said(figure), right, `${name} ${check}`);
            }
        });
    }
});

test("a module imports nothing, and may grow to 64 MB and no further", async () => {
    await exercise("left_perturbation", {}, async (page, figure) => {
        const { imports, bytes } = await figure.evaluate(({ widget }) => {
            const { module } = widget.session;
            const { memory } = new WebAssembly.Instance(module, {}).exports;
            let bytes = memory.buffer.byteLength;
            try {
                for (;;) {
                    memory.grow(16);
                    bytes = memory.buffer.byteLength;
                }
            } catch {
                return { imports: WebAssembly.Module.imports(module).length, bytes };
            }
        });
        assert.equal(imports, 0);
        assert.ok(bytes <= 64 << 20 && bytes > 60 << 20, String(bytes));
    });
});

test("the page for printing starts no answer", async () => {
    const page = await browser.page({});
    await open(page, `${url}print.html`);
    assert.ok(await page.locator("figure[data-answer]").count() > 1);
    assert.equal(await page.locator("figure[data-answer] .widget").count(), 0);
    await page.context().close();
});
