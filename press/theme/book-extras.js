// What the pages do beyond mdBook's own scripts. Without this file everything can still be read.
(function () {
    "use strict";

    const page = document.documentElement;
    const text = document.getElementById("text");
    const all = (selector, root = document) => Array.from(root.querySelectorAll(selector));

    function element(name, properties, ...children) {
        const made = Object.assign(document.createElement(name), properties);
        made.append(...children);
        return made;
    }

    // What an address says, or as it stands where its percent signs mean nothing.
    function decoded(text) {
        try {
            return decodeURIComponent(text);
        } catch {
            return text;
        }
    }

    // ---- Keys. book.js turns pages with Left and Right, and hears them on the document. A reader presses them to move
    // through a wide equation or a slider, so they go no further than the body; what has focus has already had them.
    document.body.addEventListener("keydown", event => {
        if (event.key === "ArrowLeft" || event.key === "ArrowRight") {
            event.stopPropagation();
        }
    });

    // ---- The first Tab. The contents scroll to their chapter, and a browser goes on from what was scrolled into view:
    // without an address within the page, it begins at the top again.
    if (!location.hash && document.activeElement === document.body) {
        document.body.tabIndex = -1;
        document.body.focus({ preventScroll: true });
        document.body.removeAttribute("tabindex");
    }

    // ---- Skip link. A page with a <base> would leave itself on "#text".
    document.querySelector(".skip-link").addEventListener("click", event => {
        event.preventDefault();
        text.focus();
        text.scrollIntoView();
    });

    // ---- Contents. The class on <html> says whether they are shown; book.js listens to a checkbox.
    (function contents() {
        const toggle = document.getElementById("mdbook-sidebar-toggle");
        const checkbox = document.getElementById("mdbook-sidebar-toggle-anchor");
        const sidebar = document.getElementById("mdbook-sidebar");
        const narrow = matchMedia("(max-width: 1079px)");
        const visible = () => page.classList.contains("sidebar-visible");

        function show(yes) {
            checkbox.checked = yes;
            checkbox.dispatchEvent(new Event("change"));
        }
        toggle.addEventListener("click", () => show(!visible()));
        document.querySelector(".scrim").addEventListener("click", () => show(false));
        document.addEventListener("keydown", event => {
            if (event.key === "Escape" && narrow.matches && visible()) {
                show(false);
                toggle.focus();
            }
        });
        sidebar.addEventListener("click", event => {
            if (narrow.matches && event.target.closest("a[href]")) {
                show(false);
            }
        });
        new MutationObserver(() => {
            checkbox.checked = visible();
        }).observe(page, { attributeFilter: ["class"] });

        all("a.active", sidebar).forEach(link => link.setAttribute("aria-current", "page"));
    })();

    // ---- Theme menu. book.js marks the chosen theme with a class; say it aloud too.
    (function themeMenu() {
        const themes = all("#mdbook-theme-list .theme");
        const tell = () => themes.forEach(theme =>
            theme.setAttribute("aria-checked", theme.classList.contains("theme-selected")));
        tell();
        themes.forEach(theme => new MutationObserver(tell).observe(theme, { attributeFilter: ["class"] }));
    })();

    // ---- Search opens under the bar; searcher.js also scrolls to the top, and the reader loses the place.
    (function searchKeepsPlace() {
        const panel = document.getElementById("mdbook-search-wrapper");
        if (!panel) {
            return;
        }
        let place = 0;
        const remember = () => {
            place = scrollY;
        };
        document.addEventListener("keydown", remember, true);
        document.addEventListener("click", remember, true);
        new MutationObserver(() => {
            if (!panel.classList.contains("hidden") && scrollY === 0) {
                scrollTo(0, place);
            }
        }).observe(panel, { attributeFilter: ["class"] });
    })();

    // ---- What is wider than the page scrolls inside itself, and only then can be reached with the keyboard.
    (function scrollers() {
        const boxes = all(".equation-body, .katex-display, .plot, .table-wrapper, pre > code", text);
        const names = { "equation-body": "Equation", "katex-display": "Formula", "table-wrapper": "Table" };

        function look(box) {
            const scrolls = box.scrollWidth > box.clientWidth + 1 || box.scrollHeight > box.clientHeight + 1;
            const reachable = scrolls && getComputedStyle(box).overflowX !== "visible";
            if (reachable === box.hasAttribute("tabindex")) {
                return;
            }
            const kind = Object.keys(names).find(name => box.classList.contains(name));
            if (reachable) {
                box.tabIndex = 0;
            } else {
                box.removeAttribute("tabindex");
            }
            if (kind && reachable) {
                box.setAttribute("role", "group");
                box.setAttribute("aria-label", names[kind] + ", scrolls sideways");
            } else if (kind) {
                box.removeAttribute("role");
                box.removeAttribute("aria-label");
            }
        }

        // The width of a formula in its own letters: print.css sets wide ones smaller by it.
        function measure(body) {
            if (body.scrollWidth > body.clientWidth) {
                body.style.setProperty("--ems", (body.scrollWidth / parseFloat(getComputedStyle(body).fontSize)).toFixed(2));
            }
        }

        const lookAtAll = () => {
            boxes.forEach(look);
            all(".equation-body", text).forEach(measure);
        };
        const sizes = new ResizeObserver(entries => entries.forEach(entry => look(entry.target)));
        boxes.forEach(box => sizes.observe(box));
        document.fonts.ready.then(lookAtAll);
        addEventListener("load", lookAtAll);
    })();

    // ---- A margin note stands beside the text that it follows. CSS alone lets it begin where that text ends, so it is
    // moved up by the height of the text, as far as the note or check before it leaves room.
    (function marginNotes() {
        const notes = all(".margin", text);
        if (!notes.some(note => note.classList.contains("note"))) {
            return;
        }
        function place() {
            let free = -Infinity;
            notes.forEach(note => {
                note.style.removeProperty("--rise");
                const floats = getComputedStyle(note).float !== "none";
                const before = note.previousElementSibling;
                if (floats && before && note.classList.contains("note")) {
                    const wanted = Math.max(before.getBoundingClientRect().top + 4, free + 12);
                    const rise = note.getBoundingClientRect().top - wanted;
                    if (rise > 0) {
                        note.style.setProperty("--rise", rise + "px");
                    }
                }
                if (floats) {
                    free = note.getBoundingClientRect().bottom;
                }
            });
        }
        new ResizeObserver(place).observe(text);
        text.addEventListener("toggle", place, true);
        document.fonts.ready.then(place);
    })();

    // ---- Predictions: choose, commit, and only then look. The choice stays in this browser.
    const printed = page.classList.contains("print-page");

    const memory = {
        get(key) { try { return localStorage.getItem(key); } catch { return null; } },
        set(key, value) { try { localStorage.setItem(key, value); } catch { /* kept until the page is left */ } },
        remove(key) { try { localStorage.removeItem(key); } catch { /* nothing was kept */ } },
    };

    function prediction(box, number) {
        const list = box.querySelector(".choices");
        const reveal = box.querySelector(".reveal");
        const items = list ? Array.from(list.children) : [];
        if (!reveal || items.length === 0) {
            return;
        }
        const key = "predict:" + (box.dataset.key || box.id);
        const letter = item => String.fromCharCode(65 + items.indexOf(item));
        let committed = null;

        const inputs = items.map((item, index) => {
            if (item.children.length === 1 && item.firstElementChild.tagName === "P") {
                item.firstElementChild.replaceWith(...item.firstElementChild.childNodes);
            }
            const input = element("input", { type: "radio", name: "prediction-" + number, id: "prediction-" + number + "-" + index });
            const label = element("label", { htmlFor: input.id }, ...item.childNodes);
            item.append(input, label);
            return input;
        });
        list.classList.add("asked");

        const button = element("button", { type: "button" });
        const verdict = element("p", { className: "verdict" });
        verdict.setAttribute("role", "status");
        reveal.before(element("div", { className: "act" }, button, verdict));

        function show() {
            const right = items.filter(item => item.hasAttribute("data-right"));
            items.forEach(item => item.classList.toggle("chosen", item === committed));
            inputs.forEach((input, index) => {
                input.disabled = committed !== null;
                if (committed !== null) {
                    input.checked = items[index] === committed;
                }
            });
            list.classList.toggle("committed", committed !== null);
            button.textContent = committed ? "Predict again" : "Commit";
            button.classList.toggle("again", committed !== null);
            verdict.className = "verdict";
            verdict.textContent = "";
            if (committed && right.length > 0) {
                const hit = right.includes(committed);
                verdict.classList.add(hit ? "right" : "wrong");
                verdict.textContent = "You predicted " + letter(committed) + (hit
                    ? ", and that is right."
                    : ". The answer is " + right.map(letter).join(" or ") + ".");
            } else if (committed) {
                verdict.textContent = "You predicted " + letter(committed) + ".";
            }
        }

        function commit(item) {
            committed = item;
            memory.set(key, String(items.indexOf(item)));
            show();
            reveal.open = true;
        }

        function again() {
            committed = null;
            memory.remove(key);
            inputs.forEach(input => {
                input.checked = false;
            });
            reveal.open = false;
            show();
            inputs[0].focus();
        }

        button.addEventListener("click", () => {
            const chosen = inputs.findIndex(input => input.checked);
            if (committed) {
                again();
            } else if (chosen >= 0) {
                commit(items[chosen]);
            } else {
                verdict.textContent = "Choose an answer first.";
            }
        });
        reveal.querySelector("summary").addEventListener("click", event => {
            if (!committed && !reveal.open) {
                event.preventDefault();
                verdict.textContent = "Choose an answer and commit to it first.";
            }
        });

        const kept = memory.get(key);
        if (kept !== null && items[Number(kept)]) {
            committed = items[Number(kept)];
        }
        show();
        reveal.open = committed !== null;
    }

    if (!printed) {
        all(".predict", text).forEach(prediction);
    }

    // ---- Two depths: on the main road, sections in depth fold to the sentence that says what they establish. Folded
    // content stays where the browser's own find can reach it, and paper has it by print.css.
    (function depths() {
        if (printed) {
            return;
        }
        const parts = all(".depth", text).map(part => ({ part, sentence: part.previousElementSibling }));
        const opening = text.querySelector(".opening");
        const fold = ({ part, button }, folded) => {
            if (folded) {
                part.setAttribute("hidden", "until-found");
            } else {
                part.removeAttribute("hidden");
            }
            button.setAttribute("aria-expanded", String(!folded));
            button.textContent = folded ? "Read it" : "Fold it";
        };
        const foldAll = choice => parts.forEach(each => fold(each, choice === "main"));
        const chosen = memory.get("depth") === "all" ? "all" : "main";

        parts.forEach((each, number) => {
            each.part.id = "depth-" + (number + 1);
            each.button = element("button", { type: "button", className: "depth-fold" });
            each.button.setAttribute("aria-controls", each.part.id);
            each.button.addEventListener("click", () => fold(each, !each.part.hasAttribute("hidden")));
            each.part.addEventListener("beforematch", () => fold(each, false));
            each.sentence.append(" ", each.button);
        });
        foldAll(chosen);

        // The choice, for this chapter and those to come.
        function choice(value, name) {
            const input = element("input", { type: "radio", name: "depth", value, checked: chosen === value });
            input.addEventListener("change", () => {
                memory.set("depth", value);
                foldAll(value);
            });
            return element("label", {}, input, " " + name + ", " + opening.dataset[value] + " minutes");
        }
        if (opening && parts.length > 0) {
            const box = element("div", { className: "depth-choice" }, choice("main", "Main road"), choice("all", "Everything"));
            box.setAttribute("role", "radiogroup");
            box.setAttribute("aria-label", "How much to read");
            opening.querySelector("dl").after(box);
        }

        // An address inside of a fold, or of the heading that leads into it, opens it.
        function arrive() {
            const label = decoded(location.hash.slice(1));
            const target = label && document.getElementById(label);
            const each = target && parts.find(({ part }) => part.contains(target) || part.dataset.of === label);
            if (each && each.part.hasAttribute("hidden")) {
                fold(each, false);
                target.scrollIntoView();
            }
        }
        addEventListener("hashchange", arrive);
        arrive();
    })();

    // ---- The script that a figure needs, and its style beside it, once for all figures that need them.
    const scripts = new Map();
    function loaded(figure) {
        const address = figure.dataset.script;
        if (!scripts.has(address)) {
            scripts.set(address, new Promise((resolve, reject) => {
                const sheet = element("link", { rel: "stylesheet", href: address.replace(/js$/, "css") });
                const made = element("script", { src: address });
                made.addEventListener("load", resolve);
                made.addEventListener("error", reject);
                document.head.append(sheet, made);
            }));
        }
        return scripts.get(address);
    }

    // ---- Pictures to take hold of: their script and their module are loaded when they come near, or when they are asked
    // for if the module is large.
    (function widgets() {
        const figures = all("figure[data-widget]", text);
        if (printed || figures.length === 0 || typeof WebAssembly === "undefined") {
            return;
        }
        const start = figure => loaded(figure).then(() => window.vislamWidgets.start(figure)).catch(() => {
            figure.querySelector(".widget-note").textContent = "The program of this picture could not be loaded. It stands still.";
        });
        const near = new IntersectionObserver(entries => entries.filter(entry => entry.isIntersecting).forEach(({ target }) => {
            near.unobserve(target);
            start(target);
        }), { rootMargin: "400px" });
        figures.forEach(figure => {
            const [offer, note] = [".widget-open", ".widget-note"].map(part => figure.querySelector(part));
            if (!offer) {
                near.observe(figure);
                return;
            }
            [offer.hidden, note.hidden] = [false, true];
            offer.querySelector("button").addEventListener("click", () => {
                [offer.hidden, note.hidden] = [true, false];
                // Whoever pressed the button goes on in what it has opened.
                start(figure).then(() => figure.querySelector(".widget")?.focus({ preventScroll: true }));
            });
        });
    })();

    // ---- Scenes in three dimensions: the viewer is large, and loaded when it is asked for.
    (function recordings() {
        if (printed || typeof WebAssembly === "undefined") {
            return;
        }
        all("figure[data-recording] .recording-open", text).forEach(offer => {
            const figure = offer.closest("figure");
            offer.hidden = false;
            offer.querySelector("button").addEventListener("click", () => {
                loaded(figure).then(() => window.vislamRecordings.open(figure)).catch(() => {
                    offer.textContent = "The viewer could not be loaded; the command below opens the scene.";
                });
            });
        });
    })();

    // ---- Paper has every answer.
    const folds = all(".reveal", text);
    let shut = [];
    const open = () => {
        shut = folds.filter(fold => !fold.open);
        shut.forEach(fold => {
            fold.open = true;
        });
    };
    if (printed) {
        open();
    } else {
        addEventListener("beforeprint", open);
        addEventListener("afterprint", () => shut.forEach(fold => {
            fold.open = false;
        }));
    }
})();
