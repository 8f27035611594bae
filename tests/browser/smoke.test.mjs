// What must hold at every change. BOOK_DIR names the built book, CHROMIUM the browser.

import assert from "node:assert/strict";
import fs from "node:fs";
import { after, before, test } from "node:test";
import { gzipSync } from "node:zlib";
import { terms } from "./terms.mjs";
import { axe, bookDir, each, launch, libraryPages, open, overhang, pages, pageWith, read, serve } from "./helper.mjs";

let browser, server;

before(async () => {
    server = await serve("/some/where/");
    browser = await launch();
});

after(async () => {
    await browser.close();
    server.close();
});

const predicted = () => pageWith(/class="predict"/);

/** The longest word of a page's first heading of a section: what a reader might search. */
async function headingWord(page) {
    const words = (await page.locator("main h2").first().innerText()).split(/\W+/);
    return words.reduce((a, b) => (b.length > a.length ? b : a));
}

/** Opens a page of the book in a context of its own, and closes it when the body has run with all that it asked for. */
async function at(file, options, body) {
    const page = await browser.page(options);
    const answers = [];
    page.on("response", answer => answers.push(answer));
    try {
        await open(page, server.url + file);
        await body(page, answers);
        assert.deepEqual(page.complaints, [], file);
    } finally {
        await page.context().close();
    }
}

/** The kilobytes of answers as a server sends them that compresses, by file, the heaviest first. */
async function weights(answers) {
    const weight = async answer => {
        const bytes = await answer.body();
        return [new URL(answer.url()).pathname.split("/").pop(), Math.min(bytes.length, gzipSync(bytes).length) / 1000];
    };
    const loaded = new Map(await Promise.all(answers.map(weight)));
    return [...loaded].sort((a, b) => b[1] - a[1]);
}

test("every page loads under a sub-path with an empty console, no failed or foreign request, and no more than 500 kB for its first view", async () => {
    const heavy = [];
    await each(pages(), file => at(file, {}, async (page, answers) => {
        assert.ok((await page.locator("main").innerText()).length > 100, `${file} is empty`);
        assert.ok(await page.evaluate(() => document.title && document.documentElement.lang), `${file} has no title or language`);
        await page.evaluate(() => document.fonts.ready);
        const faces = await page.evaluate(() => [...document.fonts].filter(face => face.status === "error").length);
        assert.equal(faces, 0, `${file}: fonts that did not load`);
        await page.waitForLoadState("networkidle");
        const loaded = await weights(answers);
        const total = loaded.reduce((sum, [, weight]) => sum + weight, 0);
        assert.ok(total > 20, `${file} weighs nothing: ${total}`);
        const most = loaded.slice(0, 4).map(([name, weight]) => `${name} ${weight.toFixed(0)}`).join(", ");
        if (total > 500) heavy.push(`${file} weighs ${total.toFixed(0)} kB: ${most}`);
    }));
    assert.deepEqual(heavy, [], "divide the page, or show less of a figure");
});

test("a page of the library asks no other host, shows its equation, and leads to the chapter and back", async () => {
    const item = libraryPages().find(file => /class="book-equation"/.test(read(file)) && /#eq:/.test(read(file)));
    for (const options of [{}, { dark: true, width: 360 }, { javaScriptEnabled: false }]) {
        await at(item, options, async page => {
            const formula = page.locator(".book-equation .katex-html").first();
            assert.match(await formula.evaluate(shown => getComputedStyle(shown.firstElementChild).fontFamily), /KaTeX/);
            assert.ok((await formula.boundingBox()).height > 10, "the formula is not to be seen");
            assert.equal(await page.locator(".book-equation .katex-mathml").first().evaluate(hidden => getComputedStyle(hidden).position), "absolute");
            const bar = await page.locator(".book-bar").boundingBox();
            assert.ok(bar.y === 0 && bar.height < 60 && bar.width >= (options.width ?? 1280) - 20, JSON.stringify(bar));
            assert.equal(await overhang(page), null, item);
            await page.locator(".docblock a[href*='#eq:']").first().click();
            await page.waitForURL(/\/some\/where\/\w+\.html#eq:/);
            await page.locator(".equation:target").waitFor();
            await page.getByRole("link", { name: "The library" }).click();
            await page.waitForURL("**/api/vislam/index.html");
            await page.locator(".book-bar a").click();
            await page.waitForURL("**/some/where/index.html");
        });
    }
});

test("pages of the library of each kind load without a failed or foreign request, and its search finds an item", async () => {
    const page = await browser.page();
    const kinds = new Map(libraryPages().map(file => [file.split("/").pop().split(".")[0], file]));
    assert.ok(kinds.size >= 4, [...kinds.keys()].join());
    for (const file of kinds.values()) {
        await page.goto(server.url + file, { waitUntil: "load" });
        assert.ok(await page.locator(".book-bar").isVisible(), file);
    }
    await page.goto(`${server.url}api/vislam/index.html?search=project_cam`);
    await page.locator(".search-results a[href*='method.project_cam']").first().waitFor();
    assert.deepEqual(page.complaints, []);
    await page.context().close();
});

test("the book works at the root of a site, and a page that is not there looks like the book", async () => {
    const base = new URL(read("404.html").match(/<base href="([^"]*)"/)?.[1] ?? "/", "http://host/").pathname;
    for (const [mount, file] of [["/", "index.html"], ["/", predicted()], [base, "no/such/page.html"]]) {
        const root = await serve(mount);
        const page = await browser.page();
        await open(page, root.url + file);
        const expected = file.startsWith("no/") ? 2 : 0; // the answer 404 and what the console says about it
        assert.equal(page.complaints.length, expected, page.complaints.join("\n"));
        assert.ok(await page.locator(".chapter a").count() > 1, `${mount}${file}: no contents`);
        assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector(".menu-bar")).position), "sticky");
        await page.context().close();
        root.close();
    }
});

test("search finds a word of a heading and shows no TeX", async () => {
    const file = predicted();
    await at(file, {}, async page => {
        const word = await headingWord(page);
        await page.keyboard.press("/");
        await page.locator("#mdbook-searchbar").pressSequentially(word);
        const results = page.locator("#mdbook-searchresults li");
        await results.first().waitFor();
        assert.ok(await page.locator(`#mdbook-searchresults a[href*="${file}"]`).count() > 0, `“${word}” is not found in ${file}`);
        assert.doesNotMatch((await results.allInnerTexts()).join("\n"), /\\[a-zA-Z]|\$\$/);
        assert.ok((await results.first().innerText()).toLowerCase().includes(word.toLowerCase()));
        await page.keyboard.press("Escape");
        assert.ok(await page.locator("#mdbook-search-wrapper").isHidden());
    });
    const index = fs.readdirSync(bookDir).find(name => /^searchindex.*\.js$/.test(name));
    assert.doesNotMatch(read(index), /\\(frac|begin|mathbf|htmlClass|tilde)\b/, "raw TeX in the search index");
});

test("what a practitioner types finds its section among the first three", async () => {
    await at("index.html", {}, async page => {
        await page.keyboard.press("/");
        const bar = page.locator("#mdbook-searchbar");
        const header = page.locator("#mdbook-searchresults-header");
        const astray = [];
        for (const [term, section] of Object.entries(terms)) {
            await bar.fill(term);
            await bar.press("End");
            await header.getByText(`'${term}'`).waitFor();
            const found = await page.locator("#mdbook-searchresults li a")
                .evaluateAll(links => links.slice(0, 3).map(link => link.getAttribute("href").replace(/\?[^#]*/, "")));
            if (!found.includes(section)) astray.push(`${term}: ${found.join(", ") || "nothing"}, not ${section}`);
        }
        assert.deepEqual(astray, []);
    });
});

test("search keeps the place of the reader", async () => {
    await at(predicted(), {}, async page => {
        await page.evaluate(() => scrollTo(0, 600));
        await page.keyboard.press("s");
        await page.locator("#mdbook-searchbar:focus").waitFor();
        assert.equal(await page.evaluate(() => Math.round(scrollY)), 600);
    });
});

test("a theme that is chosen stays, and Auto follows the system while the page is open", async () => {
    await at("index.html", {}, async page => {
        const ground = () => page.evaluate(() => {
            const [r, g, b] = getComputedStyle(document.documentElement).backgroundColor.match(/[\d.]+/g).map(Number);
            return r + g + b > 384 ? "light" : "dark";
        });
        const choose = async name => {
            await page.locator("#mdbook-theme-toggle").click();
            await page.getByRole("menuitemradio", { name }).click();
            assert.equal(await page.getByRole("menuitemradio", { name }).getAttribute("aria-checked"), "true");
            await page.keyboard.press("Escape");
        };
        assert.equal(await ground(), "light");
        await choose("Dark");
        assert.equal(await ground(), "dark");
        await page.getByRole("link", { name: "The library" }).click();
        await page.waitForURL("**/api/vislam/index.html");
        assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark", "the library is light");
        await page.goBack();
        await page.reload();
        assert.equal(await ground(), "dark", "forgotten by a reload");
        await choose("Light");
        await page.emulateMedia({ colorScheme: "dark" });
        assert.equal(await ground(), "light", "the system overrules the choice");
        await choose("Auto");
        assert.equal(await ground(), "dark");
        await page.emulateMedia({ colorScheme: "light" });
        await page.waitForFunction(() => document.documentElement.classList.contains("light"));
        assert.equal(await ground(), "light");
        await page.locator("#mdbook-theme-toggle").click();
        assert.deepEqual(await page.getByRole("menuitemradio").allInnerTexts(), ["Auto", "Light", "Dark"]);
    });
});

/** Every page is looked at in one of four ways, and in all of them where EVERY is set. */
const ways = [1280, 360].flatMap(width => [false, true].map(dark => ({ width, dark })));

for (const [number, { width, dark }] of ways.entries()) {
    test(`at ${width} px in ${dark ? "dark" : "light"}, axe finds nothing serious and no page scrolls sideways`, async () => {
        const turn = pages().filter((_, index) => process.env.EVERY || index % ways.length === number);
        assert.notEqual(turn.length, 0);
        await each(turn, file => at(file, { width, dark }, async page => {
            assert.equal(await overhang(page), null, file);
            await page.evaluate(() => document.querySelectorAll("main details").forEach(fold => { fold.open = true; }));
            assert.equal(await overhang(page), null, `${file}, folds open`);
            assert.deepEqual(await axe(page), [], file);
        }));
    });
}

test("the colours of code, of terms and of figures are legible on their grounds", async () => {
    for (const dark of [false, true]) {
        await at("index.html", { dark }, async page => {
            const faint = await page.evaluate(() => {
                const names = [...document.styleSheets].filter(sheet => /css\/variables/.test(sheet.href))
                    .flatMap(sheet => [...sheet.cssRules]).filter(rule => rule.selectorText === ":root")
                    .flatMap(rule => [...rule.style]).filter(name => /^--(code|series|measured|estimated|prior|muted|links)(-\w+)?$/.test(name));
                const probe = document.body.appendChild(document.createElement("i"));
                const light = color => {
                    probe.style.color = color;
                    const parts = getComputedStyle(probe).color.match(/[\d.]+/g).slice(0, 3).map(part => part / 255);
                    const [r, g, b] = parts.map(part => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
                    return 0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05;
                };
                const contrast = (a, b) => Math.max(a, b) / Math.min(a, b);
                const found = names.flatMap(name => ["--bg", "--panel"]
                    .map(ground => ({ name, ground, ratio: contrast(light(`var(${name})`), light(`var(${ground})`)) })))
                    .filter(({ name, ratio }) => ratio < (name.startsWith("--series") ? 3 : 4.5) && name !== "--links-line");
                return names.length < 15 ? [`only ${names}`] : found;
            });
            assert.deepEqual(faint, []);
        });
    }
});

test("search results, contents and theme menu give axe no reason to complain either", async () => {
    for (const width of [1280, 360]) {
        for (const dark of [false, true]) {
            await at(predicted(), { width, dark }, async page => {
                if (width === 360) await page.locator("#mdbook-sidebar-toggle").click();
                await page.keyboard.press("/");
                await page.locator("#mdbook-searchbar").pressSequentially(await headingWord(page));
                await page.locator("#mdbook-searchresults li").first().waitFor();
                assert.deepEqual(await axe(page, { exclude: "main" }), []);
                await page.keyboard.press("Escape");
                await page.locator("#mdbook-theme-toggle").click();
                assert.deepEqual(await axe(page, { exclude: "main" }), []);
            });
        }
    }
});

test("a prediction asks for a choice, keeps it over a reload, and can be made again", async () => {
    await at(predicted(), {}, async page => {
        const box = page.locator(".predict").first();
        const reveal = box.locator(".reveal");
        const status = box.getByRole("status");
        const opened = () => reveal.evaluate(fold => fold.open);

        await reveal.locator("summary").click();
        assert.equal(await opened(), false, "revealed without a choice");
        assert.match(await status.innerText(), /choose/i);

        const choice = box.getByRole("radio").first();
        await choice.focus();
        await page.keyboard.press("Space");
        await page.keyboard.press("ArrowDown");
        await page.keyboard.press("ArrowUp");
        assert.ok(await choice.isChecked());
        await box.getByRole("button", { name: "Commit" }).press("Enter");
        assert.equal(await opened(), true);
        assert.match(await status.innerText(), /You predicted A/);

        await page.reload();
        assert.equal(await opened(), true, "the reveal closed");
        assert.ok(await choice.isChecked(), "the choice is lost");
        assert.match(await status.innerText(), /You predicted A/);

        await box.getByRole("button", { name: "Predict again" }).click();
        assert.equal(await opened(), false);
        assert.ok(!await choice.isChecked());
        await page.reload();
        assert.equal(await opened(), false, "not forgotten");
    });
});

test("sections in depth fold to a sentence; a button, an address and the choice of everything open them", async () => {
    const file = pageWith(/<div class="depth"/);
    const shown = part => part.evaluate(node => node.checkVisibility({ contentVisibilityAuto: true }) && node.lastElementChild.checkVisibility({ contentVisibilityAuto: true }));
    for (const options of [{}, { width: 360, dark: true }]) {
        await at(file, { folded: true, ...options }, async page => {
            const part = page.locator(".depth").first();
            const button = page.locator(".depth-fold").first();
            const radio = name => page.getByRole("radiogroup", { name: "How much to read" }).getByRole("radio", { name });
            assert.ok(await radio(/^Main road, \d+ minutes$/).isChecked());
            assert.equal(await page.locator(".depth:not([hidden])").count(), 0);
            assert.equal(await shown(part), false);
            assert.ok((await page.locator(".establishes").first().innerText()).length > 40);
            assert.deepEqual([await overhang(page), await axe(page)], [null, []]);

            await button.click();
            assert.deepEqual([await shown(part), await button.getAttribute("aria-expanded")], [true, "true"]);
            await button.press("Enter");
            assert.equal(await shown(part), false);

            const label = await page.evaluate(() => document.querySelector(".depth [id]").id);
            await page.evaluate(label => { location.hash = label; }, label);
            await page.waitForFunction(label => !document.getElementById(label).closest(".depth").hasAttribute("hidden"), label);
            assert.ok(await page.evaluate(label => document.getElementById(label).getBoundingClientRect().top < innerHeight, label));

            await radio(/Everything/).check();
            assert.equal(await page.locator(".depth[hidden]").count(), 0);
            await page.reload();
            assert.equal(await page.locator(".depth[hidden]").count(), 0, "the choice is forgotten");
            await radio(/Main road/).check();
            await page.emulateMedia({ media: "print" });
            assert.equal(await shown(part), true, "paper lacks what is folded");
        });
    }
    await at(file, { javaScriptEnabled: false }, async page => {
        assert.equal(await shown(page.locator(".depth").first()), true);
    });
});

test("a prediction works where the browser keeps nothing", async () => {
    const page = await browser.page();
    await page.addInitScript(() => Object.defineProperty(window, "localStorage", {
        get() { throw new DOMException("no", "SecurityError"); },
    }));
    await open(page, server.url + predicted());
    const box = page.locator(".predict").first();
    await box.getByRole("radio").last().check();
    await box.getByRole("button", { name: "Commit" }).click();
    assert.ok(await box.locator(".reveal").evaluate(fold => fold.open));
    assert.deepEqual(page.complaints, []);
    await page.context().close();
});

test("without script everything is there to read, a prediction is a fold, and the contents are a link away", async () => {
    for (const dark of [false, true]) {
        await at(predicted(), { javaScriptEnabled: false, dark }, async page => {
            assert.ok((await page.locator("main").innerText()).length > 1000);
            assert.equal(await page.getByRole("radio").count(), 0);
            const reveal = page.locator(".predict .reveal").first();
            const answer = reveal.locator("> :not(summary)").first();
            assert.ok(await answer.isHidden());
            await reveal.locator("summary").click();
            assert.ok(await answer.isVisible());
            for (const id of ["search-toggle", "theme-toggle", "sidebar-toggle", "sidebar", "search-wrapper", "help-container"]) {
                assert.ok(await page.locator(`#mdbook-${id}`).isHidden(), `${id} is of no use without a script`);
            }
            await page.getByRole("link", { name: "Contents" }).click();
            assert.match(page.url(), /toc\.html$/);
            await page.locator(".chapter a").nth(1).click();
            assert.doesNotMatch(page.url(), /toc\.html$/);
        });
    }
});

test("arrow keys turn no page, and no help promises it", async () => {
    const file = pages().find(name => /rel="next"/.test(read(name)) && /rel="prev"/.test(read(name)));
    assert.ok(file, "no page has a page before and after it");
    await at(file, {}, async page => {
        for (const key of ["ArrowRight", "ArrowLeft"]) {
            await page.keyboard.press(key);
            await page.waitForTimeout(150);
            assert.ok(page.url().endsWith(file), `${key} left the page`);
        }
        await page.keyboard.press("?");
        const help = await page.locator("#mdbook-help-popup").innerText();
        assert.match(help, /search/);
        assert.doesNotMatch(help, /←|→|arrow/i);
        await page.keyboard.press("Escape");
        for (const rel of ["prev", "next"]) {
            assert.ok((await page.locator(`.turn a[rel=${rel}]`).innerText()).split("\n")[1]?.length > 2, "no title at the foot");
        }
        await page.locator(".turn a[rel=next]").click();
        assert.ok(!page.url().endsWith(file));
    });
});

test("the skip link comes first, and whatever has focus shows it", async () => {
    await at(predicted(), {}, async page => {
        await page.keyboard.press("Tab");
        assert.equal(await page.evaluate(() => document.activeElement.className), "skip-link");
        assert.ok(await page.locator(".skip-link").evaluate(link => link.getBoundingClientRect().top >= 0), "out of sight");
        for (let stop = 0; stop < 40; stop += 1) {
            const shown = await page.evaluate(() => {
                const { outlineStyle, outlineWidth } = getComputedStyle(document.activeElement);
                return document.activeElement === document.body || (outlineStyle !== "none" && parseFloat(outlineWidth) >= 2)
                    || document.activeElement.outerHTML.slice(0, 120);
            });
            assert.equal(shown, true);
            await page.keyboard.press("Tab");
        }
        await page.locator(".skip-link").focus();
        await page.keyboard.press("Enter");
        assert.equal(await page.evaluate(() => document.activeElement.tagName), "MAIN");
        await page.keyboard.press("Tab");
        assert.ok(await page.evaluate(() => !!document.activeElement.closest("main, .turn")));
    });
});

test("a wide equation is reached and scrolled with the keyboard, a short one is no stop", async () => {
    const file = pageWith(/class="equation-body"/);
    await at(file, { width: 360 }, async page => {
        const bodies = await page.locator(".equation-body").evaluateAll(all => all.map(body => ({
            scrolls: body.scrollWidth > body.clientWidth + 1, stop: body.tabIndex === 0,
        })));
        for (const { scrolls, stop } of bodies) assert.equal(stop, scrolls);
        // Whether a chapter happens to have a wide equation or not, one is made here.
        const body = page.locator(".equation-body").first();
        await body.evaluate(box => {
            const base = box.querySelector(".katex-html .base");
            for (let copy = 0; copy < 8; copy += 1) base.after(base.cloneNode(true));
        });
        await page.setViewportSize({ width: 350, height: 900 });
        await page.waitForFunction(() => document.querySelector(".equation-body").tabIndex === 0);
        assert.equal(await overhang(page), null);
        await body.focus();
        await page.keyboard.press("ArrowRight");
        await page.waitForFunction(() => document.querySelector(".equation-body").scrollLeft > 0);
        const number = await page.locator(".equation-number").first().boundingBox();
        assert.ok(number.x + number.width <= 350, "the number scrolls away");
    });
});

test("the contents open and close with the keyboard, over the page on a phone", async () => {
    await at(predicted(), { width: 360 }, async page => {
        const toggle = page.locator("#mdbook-sidebar-toggle");
        const link = page.locator("#mdbook-sidebar a.active");
        assert.ok(await link.isHidden());
        await toggle.press("Enter");
        assert.ok(await link.isVisible());
        assert.equal(await toggle.getAttribute("aria-expanded"), "true");
        assert.equal(await link.getAttribute("aria-current"), "page");
        await page.keyboard.press("Escape");
        assert.equal(await toggle.getAttribute("aria-expanded"), "false");
        await page.waitForFunction(() => getComputedStyle(document.getElementById("mdbook-sidebar")).visibility === "hidden");
    });
});

test("the formula sheet has two pages on paper, and nothing of it is cut", async () => {
    await at("formulas.html", {}, async page => {
        const bytes = await page.pdf({ preferCSSPageSize: true });
        assert.equal(bytes.toString("latin1").match(/\/Type\s*\/Page\b(?!s)/g)?.length, 2);
        // The paper between the margins of the sheet, in pixels.
        await page.setViewportSize({ width: 710, height: 1000 });
        await page.emulateMedia({ media: "print" });
        const cut = await page.evaluate(() => [...document.querySelectorAll(".sheet .equation")].filter(equation => {
            const end = equation.querySelector(".equation-number").getBoundingClientRect().left;
            return [...equation.querySelectorAll(".katex-html .base")].some(base => base.getBoundingClientRect().right > end + 1);
        }).map(equation => equation.textContent.trim()));
        assert.deepEqual(cut, []);
    });
});
