// node readme.mjs: the picture in the README, an equation with its check opened and a figure.

import path from "node:path";
import { fileURLToPath } from "node:url";
import { launch, open, serve } from "./helper.mjs";

const picture = path.join(path.dirname(fileURLToPath(import.meta.url)), "../../.github/page.png");
const server = await serve("/");
const browser = await launch();
const page = await browser.page({ width: 1240, height: 900, dark: false });
await open(page, `${server.url}observability.html#eq:false-scale`);
await page.locator("[id='eq:false-scale'] summary").first().click();
await page.screenshot({ path: picture });
await browser.close();
server.close();
