// node readme.mjs: the picture in the README, an equation with its check opened and a figure.

import path from "node:path";
import { fileURLToPath } from "node:url";
import { launch, open, serve } from "./helper.mjs";

const picture = path.join(path.dirname(fileURLToPath(import.meta.url)), "../../.github/page.png");
const server = await serve("/");
const browser = await launch();
const page = await browser.page({ width: 1240, height: 900, dark: false });
await open(page, `${server.url}bearing.html#eq:inverse-depth-sigma`);
const check = page.locator("[id='eq:inverse-depth-sigma'] ~ * summary, [id='eq:inverse-depth-sigma'] summary").first();
await check.click();
await page.screenshot({ path: picture });
await browser.close();
server.close();
