// node shots.mjs FOLDER: a picture of every page, wide and narrow, light and dark, and of some of the library's.

import fs from "node:fs";
import path from "node:path";
import { launch, libraryPages, open, pages, serve } from "./helper.mjs";

const folder = process.argv[2];
if (!folder) {
    console.error("usage: node shots.mjs FOLDER");
    process.exit(2);
}
fs.mkdirSync(folder, { recursive: true });

const server = await serve("/");
const browser = await launch();
for (const width of [1280, 360]) {
    for (const dark of [false, true]) {
        const page = await browser.page({ width, height: width > 400 ? 900 : 740, dark });
        const library = libraryPages().filter(file => /index|struct/.test(file));
        for (const file of [...pages(), ...library]) {
            await open(page, server.url + file);
            const name = `${file.replaceAll("/", "-").replace(".html", "")}-${width}-${dark ? "dark" : "light"}.png`;
            await page.screenshot({ path: path.join(folder, name), fullPage: true });
        }
        await page.context().close();
    }
}
await browser.close();
server.close();
