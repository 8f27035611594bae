// What the tests share: the built book behind a small server, and a browser that keeps a list of everything that goes wrong.

import fs from "node:fs";
import http from "node:http";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { createRequire } from "node:module";
import { chromium } from "playwright-core";

const here = path.dirname(fileURLToPath(import.meta.url));
export const bookDir = path.resolve(process.env.BOOK_DIR ?? path.join(here, "../../book"));
export const axeScript = createRequire(import.meta.url).resolve("axe-core/axe.min.js");

if (!fs.existsSync(path.join(bookDir, "index.html"))) {
    throw new Error(`${bookDir} holds no index.html: build the book first, or name its folder in BOOK_DIR`);
}

/** HTML files below a folder of the book, without those of the folders `others`. */
function html(folder, others = []) {
    return fs.readdirSync(path.join(bookDir, folder), { withFileTypes: true }).flatMap(entry => {
        const file = path.posix.join(folder, entry.name);
        if (entry.isDirectory()) return others.includes(file) ? [] : html(file, others);
        return file.endsWith(".html") ? [file] : [];
    }).sort();
}

/** Chapters and other pages of text, as paths in the book; not source pages, the library, the contents, the print page. */
export function pages() {
    const found = html("", ["generated", "api"]).filter(file => !["toc.html", "print.html", "404.html"].includes(file));
    if (found.length < 2) throw new Error(`${bookDir} holds ${found.length} pages`);
    return found;
}

/** The pages of the library. */
export function libraryPages() {
    const found = html("api/vislam");
    if (found.length < 20) throw new Error(`${bookDir} holds ${found.length} pages of the library`);
    return found;
}

/** The first page that holds `pattern`. A test of something that the book does not have is no test. */
export function pageWith(pattern) {
    const page = pages().find(file => file !== "index.html" && pattern.test(read(file)));
    if (!page) throw new Error(`no page of the book holds ${pattern}`);
    return page;
}

/** Does something with every file, with as many at a time as there are processors. */
export async function each(files, body) {
    const waiting = [...files];
    const worker = async () => {
        while (waiting.length > 0) await body(waiting.shift());
    };
    await Promise.all(Array.from({ length: os.availableParallelism() }, worker));
}

export const read = file => fs.readFileSync(path.join(bookDir, file), "utf8");

const types = {
    ".css": "text/css", ".csv": "text/csv", ".html": "text/html; charset=utf-8", ".js": "text/javascript",
    ".json": "application/json", ".png": "image/png", ".svg": "image/svg+xml", ".txt": "text/plain",
    ".wasm": "application/wasm", ".woff2": "font/woff2",
};

/** Serves the book under `mount`, such as "/some/where/", and nothing beside it. */
export async function serve(mount) {
    const server = http.createServer((request, response) => {
        const { pathname } = new URL(request.url, "http://localhost");
        let file = pathname.startsWith(mount) ? path.join(bookDir, decodeURIComponent(pathname.slice(mount.length))) : "";
        if (file.endsWith(path.sep) || file === bookDir) file = path.join(file, "index.html");
        if (!file.startsWith(bookDir) || !fs.existsSync(file) || !fs.statSync(file).isFile()) {
            response.writeHead(404, { "content-type": types[".html"] }).end(fs.readFileSync(path.join(bookDir, "404.html")));
            return;
        }
        response.writeHead(200, { "content-type": types[path.extname(file)] ?? "application/octet-stream" });
        fs.createReadStream(file).pipe(response);
    });
    await new Promise(resolve => server.listen(0, "127.0.0.1", resolve));
    return { url: `http://127.0.0.1:${server.address().port}${mount}`, close: () => server.close() };
}

/** A browser; one that draws in three dimensions, slowly and in software, when it is asked to. */
export async function launch({ graphics = false } = {}) {
    const drawing = graphics ? ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"] : ["--disable-gpu"];
    const profile = fs.mkdtempSync(path.join(os.tmpdir(), "book-browser-"));
    const context = await chromium.launchPersistentContext(profile, {
        executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
        args: [...drawing, "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
            "--disable-component-update", "--disable-sync"],
    });
    const browser = context.browser();
    return {
        /**
         * A page in a fresh context; `page.complaints` collects console output, errors, failed and foreign requests.
         * Sections in depth are open unless they are to be `folded`, as a reader finds them.
         */
        async page({ width = 1280, height = 900, dark = false, folded = false, ...options } = {}) {
            const context = await browser.newContext({
                viewport: { width, height },
                colorScheme: dark ? "dark" : "light",
                reducedMotion: "reduce",
                ...options,
            });
            // The page with the whole book takes ten seconds and more on a busy machine.
            context.setDefaultTimeout(60_000);
            const page = await context.newPage();
            // The page for printing asks for the printer as soon as it is there, and while it is asked nothing else prints.
            await page.addInitScript(() => { window.print = () => {}; });
            if (!folded) {
                await page.addInitScript(() => {
                    try { localStorage.depth ??= "all"; } catch { /* a test of just that */ }
                });
            }
            page.complaints = [];
            page.scripted = options.javaScriptEnabled !== false;
            const complain = text => page.complaints.push(text);
            // The pages of the library preload their fonts in a way that Chromium remarks upon.
            page.on("console", message => {
                if (!message.text().startsWith("A preload for")) complain(`${message.type()}: ${message.text()}`);
            });
            page.on("pageerror", error => complain(`error: ${error.message}`));
            page.on("requestfailed", request => {
                const why = request.failure()?.errorText;
                if (why !== "net::ERR_ABORTED") complain(`failed: ${request.url()} ${why}`); // aborted: the test went on
            });
            page.on("response", response => {
                if (response.status() >= 400) complain(`${response.status()}: ${response.url()}`);
            });
            page.on("request", request => {
                const { protocol, hostname } = new URL(request.url());
                if (protocol.startsWith("http") && hostname !== "127.0.0.1") complain(`foreign: ${request.url()}`);
            });
            return page;
        },
        async close() {
            await context.close();
            fs.rmSync(profile, { recursive: true, force: true });
        },
    };
}

/** Goes to a page and waits until its letters and scripts are there. */
export async function open(page, url) {
    await page.goto(url, { waitUntil: "load" });
    if (page.scripted) await page.evaluate(() => document.fonts.ready.then(() => new Promise(requestAnimationFrame)));
}

/** How far the page can be scrolled sideways, and what sticks out. */
export const overhang = page => page.evaluate(() => {
    const width = document.documentElement.clientWidth;
    const over = document.documentElement.scrollWidth - width;
    if (over <= 0) return null;
    const isClipped = node => node && node.tagName !== "MAIN"
        && (node.matches("details:not([open])") || getComputedStyle(node).overflowX !== "visible" || isClipped(node.parentElement));
    const names = [...document.querySelectorAll("main *")]
        .filter(node => node.getBoundingClientRect().right > width + 1 && !node.closest(".katex-mathml") && !isClipped(node.parentElement))
        .slice(0, 5).map(node => `${node.tagName.toLowerCase()}.${node.className} “${node.textContent.slice(0, 40)}”`);
    return `${over}px: ${names.join("; ")}`;
});

/**
 * Violations of serious or critical impact, one line each, in all of a page or in what a selector includes or leaves.
 * EVERY=1 looks at the page around what is included as well.
 */
export async function axe(page, { include = "html", exclude = [] } = {}) {
    await page.addScriptTag({ path: axeScript });
    const part = { include: process.env.EVERY ? "html" : include, exclude };
    const { violations } = await page.evaluate(part => window.axe.run(part, { resultTypes: ["violations"] }), part);
    return violations
        .filter(({ impact }) => impact === "serious" || impact === "critical")
        .flatMap(({ id, nodes }) => nodes.slice(0, 4).map(node => `${id}: ${node.target.join(" ")}: ${node.failureSummary}`));
}
