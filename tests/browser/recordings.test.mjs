// Scenes in three dimensions: a picture and a command on every page that has one; and where `cargo book viewer` has put
// the viewer beside the book, that it opens on a click, from this book alone, and not before. EVERY=1 wants it there.

import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { axe, bookDir, launch, open, overhang, pages, read, serve } from "./helper.mjs";

/** Every scene, the page that shows it, and the figure in that page. */
const scenes = pages().flatMap(file => [...read(file).matchAll(/<figure [^>]*id="([^"]+)"[^>]*>\s*<div class="plot"><a [^>]*><img [^>]*generated\/recordings\/(\w+)\.png/g)]
    .map(([, id, name]) => ({ file, id, name })));
const viewer = path.join(bookDir, "generated/recordings/viewer.js");
const opens = fs.existsSync(viewer);

let browser, server;

before(async () => {
    server = await serve("/some/where/");
    browser = await launch({ graphics: opens });
});

after(async () => {
    await browser?.close();
    server?.close();
});

test("five chapters show a scene", () => {
    assert.deepEqual(scenes.map(({ name }) => name).sort(), ["bundle_adjustment", "marginalization", "msckf", "preintegration", "two_views"]);
    if (process.env.EVERY) assert.ok(opens, "the viewer is not beside the book: run `cargo book viewer` and `cargo book build`");
});

for (const { file, id, name } of scenes) {
    test(`${name} has its picture and its command, and a button only where there is something to open`, async () => {
        for (const options of [{}, { width: 360, dark: true }, { javaScriptEnabled: false }]) {
            const page = await browser.page(options);
            const asked = [];
            page.on("request", request => asked.push(request.url()));
            await open(page, server.url + file);
            const figure = page.locator(`[id="${id}"]`);
            await figure.scrollIntoViewIfNeeded();
            const picture = figure.locator("img");
            await picture.evaluate(image => image.decode());
            assert.ok((await picture.getAttribute("alt")).length > 80);
            assert.match(await figure.locator(".recording-note code").innerText(), new RegExp(`cargo run -p recordings --release -- ${name}$`));
            const button = figure.getByRole("button", { name: "Open in three dimensions" });
            assert.equal(await button.count(), opens && page.scripted ? 1 : 0);
            if (page.scripted) {
                assert.equal(await overhang(page), null);
                assert.deepEqual(await axe(page, { include: `[id="${id}"]` }), []);
            }
            assert.deepEqual(asked.filter(url => /recordings\/.*\.js|\.wasm/.test(url)), [], "nothing of the viewer is loaded before the click");
            assert.deepEqual(page.complaints, []);
            await page.context().close();
        }
    });
}

test("the size that is stated is that of the files", { skip: !opens }, () => {
    for (const { file, name } of scenes) {
        const [, program, scene] = read(file).match(/loads a viewer of ([\d.]+) MB once, and ([\d.]+) MB for this scene/);
        const megabytes = file => (fs.statSync(file).size / 1e6).toFixed(1);
        assert.equal(program, megabytes(viewer));
        assert.equal(scene, megabytes(path.join(path.dirname(viewer), `${name}.js`)));
    }
});

/** How many colours a picture has, looked at coarsely. */
const colours = (page, picture) => page.evaluate(async address => {
    const image = await createImageBitmap(await (await fetch(address)).blob());
    const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
    canvas.drawImage(image, 0, 0);
    const { data } = canvas.getImageData(0, 0, image.width, image.height);
    const found = new Set();
    for (let k = 0; k < data.length; k += 4) found.add((data[k] >> 4 << 8) | (data[k + 1] >> 4 << 4) | data[k + 2] >> 4);
    return found.size;
}, `data:image/png;base64,${picture.toString("base64")}`);

for (const { file, id, name } of process.env.EVERY ? scenes : scenes.slice(0, 1)) {
    test(`${name} opens in three dimensions on a click, and closes`, { skip: !opens, timeout: 300_000 }, async () => {
        const page = await browser.page({ width: 1000, height: 700 });
        await open(page, server.url + file);
        const figure = page.locator(`[id="${id}"]`);
        await figure.getByRole("button", { name: "Open in three dimensions" }).click();
        const dialog = page.getByRole("dialog");
        await dialog.locator("p", { hasText: "Drag to turn it" }).waitFor({ timeout: 200_000 });
        const canvas = dialog.locator("canvas");
        let seen = 0;
        for (let tries = 0; tries < 40 && seen < 40; tries += 1) {
            await page.waitForTimeout(1500);
            seen = await colours(page, await canvas.screenshot({ timeout: 120_000 }));
        }
        assert.ok(seen >= 40, `the viewer shows ${seen} colours`);
        if (process.env.SHOTS) await page.screenshot({ path: path.join(process.env.SHOTS, `${name}-opened.png`) });
        assert.deepEqual(page.complaints.filter(said => /foreign|failed|^\d+:/.test(said)), []);
        await dialog.getByRole("button", { name: "Close" }).click();
        await dialog.waitFor({ state: "detached" });
        await page.context().close();
    });
}

test("without a file of the viewer the window says so and names the command", { skip: !opens }, async () => {
    const [{ file, id }] = scenes;
    const page = await browser.page({});
    await page.route("**/recordings/viewer.js", route => route.abort());
    await open(page, server.url + file);
    await page.locator(`[id="${id}"]`).getByRole("button", { name: "Open in three dimensions" }).click();
    await page.getByRole("dialog").locator("p", { hasText: "cannot be shown here" }).waitFor();
    await page.context().close();
});
