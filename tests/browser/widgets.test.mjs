// Pictures to take hold of: that they load, answer to keyboard, pointer and finger, show what the native library shows,
// and stand still with a sentence where they cannot run. EVERY=1 tries all sizes and themes, speed and memory.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";
import { axe, bookDir, launch, open, overhang, pages, read, serve } from "./helper.mjs";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const every = Boolean(process.env.EVERY);
/** The filter of a whole flight has more to load than a picture. The assembled system is loaded when it is asked for. */
const LARGEST = { msckf: 250, odometry: 250 };
/** A flight begins anew with every move of a slider, and its start in motion is looked for in one go. */
const SLOWEST = { odometry: 20 };
const SLOW = 8;
/** A flight of half a minute at ten times real time, drawn all the while. */
const LONGEST = { msckf: 3000, odometry: 3000 };

/** How near two machines come to each other. A start in motion is looked for by iterations that end before rounding does. */
const NEAR = { odometry: 1e-6 };

/** Updates until which memory must not grow; a start in motion takes its time. */
const UPDATES = { odometry: 500 };

/** Every widget and the page that shows it. */
const widgets = pages().flatMap(file =>
    [...read(file).matchAll(/data-widget="(\w+)"/g)].map(([, name]) => ({ name, file })));

let browser, server;

before(async () => {
    assert.ok(widgets.length > 0, "no page has a picture to take hold of: is there a compiler for WebAssembly?");
    server = await serve("/some/where/");
    browser = await launch();
});

after(async () => {
    await browser?.close();
    server?.close();
});

/** Brings a widget to the screen; a large one is asked for. */
async function bring(figure) {
    await figure.scrollIntoViewIfNeeded();
    const button = figure.locator(".widget-open button");
    if (await button.isVisible()) await button.click();
}

/** Opens the page of a widget, brings it to the screen and waits until it lives. */
async function alive({ name, file }, options, body, { search = "", quiet = true } = {}) {
    const page = await browser.page(options);
    try {
        await open(page, server.url + file + search);
        const figure = page.locator(`figure[data-widget="${name}"]`);
        await bring(figure);
        await page.waitForFunction(name => document.querySelector(`figure[data-widget="${name}"]`).widget, name);
        await body(page, figure);
        if (quiet) assert.deepEqual(page.complaints, [], file);
    } finally {
        await page.context().close();
    }
}

/** What the page shows when all is computed, with which controls, and what it tells of the steps on the way. */
const shown = figure => figure.evaluate(async ({ widget }) => {
    while (widget.more || widget.wanted) await new Promise(requestAnimationFrame);
    const { controls } = widget.session.face;
    return {
        controls: Object.fromEntries(controls.map((control, k) => [control.name, widget.session.controls[k]])),
        readings: Object.fromEntries(widget.readings.map(({ face, value }) => [face.label, Number(value.dataset.value)])),
        steps: [...widget.session.steps],
    };
});

/** What the native library shows with these controls. */
function native(name, { controls }) {
    const said = execFileSync("cargo", ["run", "--quiet", "--bin", "widgets", "--", name,
        ...Object.entries(controls).map(([control, value]) => `${control}=${value}`)], { cwd: root });
    return JSON.parse(said);
}

function same(page, library, told, near) {
    assert.deepEqual(Object.keys(page), Object.keys(library), told);
    for (const [label, value] of Object.entries(page)) {
        const expected = library[label] ?? NaN;
        const isNear = Math.abs(value - expected) <= near * Math.max(1, Math.abs(expected));
        assert.ok(isNear || (Number.isNaN(value) && Number.isNaN(expected)) || value === expected, `${told}: ${label}: ${value} and ${expected}`);
    }
}

/**
 * The same in each step and at the end; or until the first step in which rounding has changed a decision, or from which
 * on it grows without bound. Says which, and gives whether there was none.
 */
function sameUntilDecided(page, { readings, told: { decisions, numbers, lost }, steps }, told, near = 1e-9) {
    const width = decisions.length + numbers.length;
    const step = k => page.steps.slice(k * width, (k + 1) * width);
    const decided = row => row.slice(0, decisions.length).join();
    const isLost = row => lost !== null && row[decisions.indexOf(lost)] === 1;
    const named = row => Object.fromEntries(numbers.map((label, k) => [label, row[decisions.length + k]]));
    for (const [k, row] of steps.entries()) {
        const why = decided(step(k)) !== decided(row) ? `decided otherwise: ${step(k)} and ${row}` : isLost(row) && lost;
        if (why) {
            assert.ok(k > 0, `${told}: the first step is ${why}`);
            console.log(`${told}: the same until step ${k} of ${steps.length}, which is ${why}`);
            return false;
        }
        same(named(step(k)), named(row), `${told}, step ${k}`, near);
    }
    assert.equal(page.steps.length, steps.length * width, told);
    same(page.readings, readings, told, near);
    return true;
}

for (const widget of widgets) {
    test(`${widget.name} shows the numbers that the native library shows`, async () => {
        await alive(widget, {}, async (page, figure) => {
            const states = every ? 12 : 3;
            let whole = 0;
            for (let state = 0; state < states; state += 1) {
                await figure.evaluate(({ widget }, state) => {
                    widget.session.face.controls.forEach((control, number) => {
                        // Golden ratios, so that the states are spread and always the same.
                        const part = ((state * 0.618 + number * 0.382 + 0.1) % 1);
                        const value = state === 0 ? control.start : control.least + part * (control.most - control.least);
                        const whole = control.kind === "slider" || control.kind === "sweep" ? value : Math.round(value);
                        // After many steps of an iteration the last digits of two machines part.
                        const few = control.kind === "count" ? Math.min(whole, 5) : whole;
                        widget.session.controls[number] = control.kind === "logarithmic" ? value : few;
                    });
                    widget.render();
                }, state);
                const told = await shown(figure);
                whole += sameUntilDecided(told, native(widget.name, told), `${widget.name} ${JSON.stringify(told.controls)}`, NEAR[widget.name]);
            }
            assert.ok(whole > 0, "one of the pictures is the same in all of its steps");
        });
    });

    test(`${widget.name} answers to the keyboard, is announced and can be linked to`, async () => {
        await alive(widget, {}, async (page, figure) => {
            const before = await shown(figure);
            const slider = figure.locator('input[type="range"]');
            if (await slider.count() > 0) {
                await slider.first().focus();
                const atItsEnd = await slider.first().evaluate(({ value, max }) => value === max);
                for (let k = 0; k < 5; k += 1) await page.keyboard.press(atItsEnd ? "ArrowLeft" : "ArrowRight");
                assert.ok(await slider.first().getAttribute("aria-valuetext"));
            } else {
                await figure.locator(".control select").first().focus();
                await page.keyboard.press("ArrowDown");
            }
            await page.waitForFunction(() => document.querySelector(".spoken").textContent.length > 0);
            const after = await shown(figure);
            assert.notDeepEqual(after.controls, before.controls);
            await page.waitForFunction(() => location.search.length > 1);
            const search = await page.evaluate(() => location.search);
            await alive(widget, {}, async (page, figure) => {
                assert.deepEqual((await shown(figure)).controls, after.controls, search);
            }, { search });
            await figure.locator(".reset").click();
            assert.deepEqual((await shown(figure)).controls, before.controls);
            await page.waitForFunction(() => location.search === "");
        });
    });

    test(`${widget.name} stands still with a sentence without script, without its module, and on paper`, async () => {
        const figure = page => page.locator(`figure[data-widget="${widget.name}"]`);
        const still = async page => {
            await figure(page).scrollIntoViewIfNeeded();
            await figure(page).locator(".plot").waitFor({ state: "visible" });
            assert.equal(await figure(page).locator(".widget").count(), 0);
            assert.match(await figure(page).locator(".widget-note").innerText(), /stands still/);
        };
        const plain = await browser.page({ javaScriptEnabled: false });
        await open(plain, server.url + widget.file);
        await still(plain);
        await plain.context().close();
        const page = await browser.page({});
        await page.route(`**/widgets/${widget.name}.js`, route => route.abort());
        await open(page, server.url + widget.file);
        await bring(figure(page));
        await page.waitForFunction(name => /cannot be taken hold of/.test(document.querySelector(`[data-widget="${name}"] .widget-note`)?.textContent), widget.name);
        await still(page);
        await page.context().close();
        await alive(widget, {}, async (page, figure) => {
            await page.emulateMedia({ media: "print" });
            assert.ok(await figure.locator(".plot").isVisible());
            assert.ok(!await figure.locator(".widget").isVisible());
        });
    });

    const sizes = every ? [[1280, false], [1280, true], [360, false], [360, true]] : [[360, true]];
    for (const [width, dark] of sizes) {
        test(`${widget.name} at ${width} px, ${dark ? "dark" : "light"}, can be read, dragged by mouse and finger, and nothing serious is amiss`, async () => {
            await alive(widget, { width, dark, hasTouch: true }, async (page, figure) => {
                assert.equal(await overhang(page), null);
                assert.deepEqual(await axe(page, { include: `[data-widget="${widget.name}"]` }), []);
                const handle = figure.locator(".handle .hit").first();
                if (await figure.locator(".handle").count() === 0) return;
                const drag = async by => {
                    const before = (await shown(figure)).controls;
                    await handle.scrollIntoViewIfNeeded();
                    const box = await handle.boundingBox();
                    await by(box.x + box.width / 2, box.y + box.height / 2);
                    await page.waitForTimeout(100);
                    assert.notDeepEqual((await shown(figure)).controls, before);
                };
                await drag(async (x, y) => {
                    await page.mouse.move(x, y);
                    await page.mouse.down();
                    await page.mouse.move(x + 25, y + 6, { steps: 4 });
                    await page.mouse.up();
                });
                await figure.locator(".reset").click();
                const touch = await page.context().newCDPSession(page);
                await drag(async (x, y) => {
                    const at = (type, x, y) => touch.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x, y }] });
                    await at("touchStart", x, y);
                    await at("touchMove", x + 12, y + 3);
                    await at("touchMove", x + 25, y + 6);
                    await at("touchEnd");
                });
            });
        });
    }

    test(`${widget.name} is small enough to load`, () => {
        const packed = read(`generated/widgets/${widget.name}.js`);
        const size = Buffer.from(packed.split('"')[3], "base64").length / 1000;
        assert.ok(size <= (LARGEST[widget.name] ?? 100), `${widget.name} has ${size} kB`);
        assert.ok(gzipSync(packed).length / 1000 <= 1.05 * size, "the script around it costs no more than it packs");
    });

    test(`${widget.name} imports nothing`, async () => {
        await alive(widget, {}, async (page, figure) => {
            const imports = await figure.evaluate(async ({ dataset }) => {
                const packed = (await (await fetch(dataset.module)).text()).split('"')[3];
                const bytes = Uint8Array.from(atob(packed), letter => letter.charCodeAt(0));
                const code = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
                return WebAssembly.Module.imports(await WebAssembly.compile(code)).length;
            });
            assert.equal(imports, 0);
        });
    });

    const slowest = SLOWEST[widget.name] ?? SLOW;
    test(`${widget.name} is drawn within ${slowest} ms, and its memory does not grow`, { skip: !every }, async () => {
        await alive(widget, {}, async (page, figure) => {
            const { medians, grown } = await figure.evaluate(({ widget }, updates) => {
                const { session } = widget;
                const controls = session.face.controls.map((control, number) => ({ ...control, number }));
                const sliders = controls.filter(({ kind }) => ["sweep", "slider", "logarithmic"].includes(kind));
                const moved = sliders.length > 0 ? sliders : controls.filter(({ kind }) => kind === "count").slice(0, 1);
                const put = ({ number, least, most }, part) => { session.controls[number] = least + (most - least) * part; };
                const start = () => controls.forEach(({ number, start }) => { session.controls[number] = start; });
                const drag = control => {
                    const times = [];
                    for (let k = 0; k < 200; k += 1) {
                        put(control, Math.abs(((k / 100) % 2) - 1));
                        const begin = performance.now();
                        widget.render();
                        times.push(performance.now() - begin);
                    }
                    start();
                    return [control.name, times.sort((a, b) => a - b)[100]];
                };
                const medians = moved.map(drag);
                // A drag of one control, and now and then another setting.
                const update = k => {
                    put(moved[k % 50 === 0 ? (k / 50) % moved.length : 0], (k * 0.618) % 1);
                    session.advance(1);
                    session.show();
                };
                const size = () => session.exports.memory.buffer.byteLength;
                // What needs most room has been there whole, however many updates a slow machine takes to compute it.
                const whole = () => { while (session.advance(1000)); session.show(); };
                for (const control of moved) {
                    put(control, 1);
                    whole();
                    start();
                }
                moved.forEach(control => put(control, 1));
                whole();
                for (let k = 0; k < updates / 10; k += 1) update(k);
                const before = size();
                for (let k = 0; k < updates; k += 1) update(k);
                return { medians, grown: size() - before };
            }, UPDATES[widget.name] ?? 10000);
            console.log(`${widget.name}: ${medians.map(([name, median]) => `${name} ${median.toFixed(1)} ms`).join(", ")}`);
            for (const [name, median] of medians) assert.ok(median <= slowest, `${name}: ${median} ms`);
            assert.equal(grown, 0, "bytes");
        });
    });

    test(`${widget.name} is whole in time`, { skip: !every || !LONGEST[widget.name] }, async () => {
        await alive(widget, {}, async (page, figure) => {
            const took = await figure.evaluate(async ({ widget }) => {
                widget.session.face.controls.forEach(({ kind, most }, number) => {
                    if (["sweep", "slider"].includes(kind)) widget.session.controls[number] = most;
                });
                const begin = performance.now();
                widget.render();
                while (widget.more) await new Promise(requestAnimationFrame);
                return performance.now() - begin;
            });
            console.log(`${widget.name}: whole after ${took.toFixed(0)} ms`);
            assert.ok(took <= LONGEST[widget.name], `${took} ms`);
        });
    });
}

test("a page without a picture to take hold of loads no module and no script for it", async () => {
    const file = pages().find(file => file !== "index.html" && !read(file).includes("data-widget"));
    const page = await browser.page({});
    const asked = [];
    page.on("request", request => asked.push(request.url()));
    await open(page, server.url + file);
    await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
    await page.waitForLoadState("networkidle");
    assert.ok(asked.length > 0);
    assert.deepEqual(asked.filter(url => url.includes("/widgets/")), []);
    await page.context().close();
});

/** Whether the picture on a page is loaded only when it is asked for. */
const isAsked = ({ name, file }) => new RegExp(`data-widget="${name}"(?:(?!</figure>)[^])*widget-open`).test(read(file));

test("a large module is loaded when it is asked for, and not before, by the keyboard too", async () => {
    const widget = widgets.find(isAsked);
    if (!widget) return;
    const page = await browser.page({});
    const asked = [];
    page.on("request", request => asked.push(request.url()));
    await open(page, server.url + widget.file);
    const figure = page.locator(`figure[data-widget="${widget.name}"]`);
    await figure.scrollIntoViewIfNeeded();
    await page.waitForLoadState("networkidle");
    assert.deepEqual(asked.filter(url => url.endsWith(`/${widget.name}.js`)), []);
    await figure.locator(".widget-open button").focus();
    await page.keyboard.press("Enter");
    await page.waitForFunction(name => document.querySelector(`figure[data-widget="${name}"]`).widget, widget.name);
    await page.waitForFunction(() => document.activeElement.classList.contains("widget"));
    assert.ok(!await figure.locator(".widget-open").isVisible());
    assert.ok(!await figure.locator(".plot").isVisible());
    await page.context().close();
});

test("a module is loaded when its picture comes near, and not before", async () => {
    const { name, file } = widgets.findLast(widget => !isAsked(widget));
    const page = await browser.page({ height: 300 });
    const asked = [];
    page.on("request", request => asked.push(request.url()));
    await open(page, server.url + file);
    const far = await page.locator(`figure[data-widget="${name}"]`).evaluate(node => node.getBoundingClientRect().top > 900);
    if (far) assert.deepEqual(asked.filter(url => url.endsWith(`/${name}.js`)), []);
    await page.locator(`figure[data-widget="${name}"]`).scrollIntoViewIfNeeded();
    await page.waitForFunction(name => document.querySelector(`figure[data-widget="${name}"]`).widget, name);
    assert.equal(asked.filter(url => url.endsWith(`/${name}.js`)).length, 1);
    await page.context().close();
});

test("a page that is opened from a disk has its picture too", async () => {
    const { name, file } = widgets[0];
    assert.ok(fs.existsSync(path.join(bookDir, file)));
    const page = await browser.page({});
    await open(page, pathToFileURL(path.join(bookDir, file)).href);
    await bring(page.locator(`figure[data-widget="${name}"]`));
    await page.waitForFunction(name => document.querySelector(`figure[data-widget="${name}"]`).widget, name);
    await page.context().close();
});

test("who wants no motion plays by steps, and who does can pause", async () => {
    const { file, name } = widgets.find(({ name }) => name === "bearing") ?? widgets[0];
    await alive({ file, name }, {}, async (page, figure) => {
        const before = await shown(figure);
        await figure.getByRole("button", { name: "Next" }).click();
        assert.notDeepEqual((await shown(figure)).controls, before.controls);
    });
    await alive({ file, name }, { reducedMotion: "no-preference" }, async (page, figure) => {
        await figure.getByRole("button", { name: "Play" }).click();
        await page.waitForTimeout(300);
        await figure.getByRole("button", { name: "Pause" }).click();
        const paused = await shown(figure);
        await page.waitForTimeout(200);
        assert.deepEqual((await shown(figure)).controls, paused.controls);
    });
});

test("what is to go wrong begins where the flight is, goes on from there, and can be taken back", async () => {
    const widget = widgets.find(({ name }) => name === "odometry");
    if (!widget) return;
    const fault = "No pictures for a second";
    const control = ({ controls }) => controls.pictures;
    await alive(widget, {}, async (page, figure) => {
        const before = await shown(figure);
        await figure.getByRole("button", { name: fault, exact: true }).click();
        const pressed = await shown(figure);
        assert.equal(control(pressed), before.controls.time);
        assert.equal(pressed.controls.time, before.controls.time, "who wants no motion goes on by steps");
        assert.deepEqual(pressed.steps, before.steps, "what was flown stays");
        await figure.getByRole("button", { name: "Next" }).click();
        const after = await shown(figure);
        assert.ok(after.controls.time > pressed.controls.time);
        await figure.getByRole("button", { name: `Undo: ${fault}` }).click();
        const undone = await shown(figure);
        assert.equal(control(undone), -1);
        assert.notDeepEqual(undone.steps, after.steps, "without it the pictures are there");
    });
    await alive(widget, { reducedMotion: "no-preference" }, async (page, figure) => {
        await figure.getByRole("button", { name: fault, exact: true }).click();
        await figure.getByRole("button", { name: "Pause" }).click();
        assert.ok(control(await shown(figure)) > 0);
    });
});
