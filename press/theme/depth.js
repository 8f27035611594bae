// Two depths: on the main road, sections in depth fold to the sentence that says what they establish. Without this file,
// on paper and in the search everything is there.
(function () {
    "use strict";

    const text = document.getElementById("text");
    const all = (selector, root) => Array.from(root.querySelectorAll(selector));
    const parts = all(".depth", text);
    const opening = text.querySelector(".opening");
    if (parts.length === 0 || document.documentElement.classList.contains("print-page")) {
        return;
    }

    const KEY = "depth";
    function chosen() {
        try { return localStorage.getItem(KEY) === "all" ? "all" : "main"; } catch { return "main"; }
    }
    function keep(choice) {
        try { localStorage.setItem(KEY, choice); } catch { /* kept until the page is left */ }
    }

    // Folded content stays where the browser's own find can reach it.
    const buttons = new Map();
    function fold(part, folded) {
        if (folded) {
            part.setAttribute("hidden", "until-found");
        } else {
            part.removeAttribute("hidden");
        }
        const button = buttons.get(part);
        button.setAttribute("aria-expanded", String(!folded));
        button.textContent = folded ? "Read it" : "Fold it";
    }

    parts.forEach((part, number) => {
        part.id = part.id || "depth-" + (number + 1);
        const button = document.createElement("button");
        button.type = "button";
        button.className = "depth-fold";
        button.setAttribute("aria-controls", part.id);
        button.addEventListener("click", () => fold(part, !part.hasAttribute("hidden")));
        part.addEventListener("beforematch", () => fold(part, false));
        part.previousElementSibling.append(" ", button);
        buttons.set(part, button);
    });

    // ---- The choice, for this chapter and those to come.
    function choice(value, name, minutes) {
        const label = document.createElement("label");
        const input = document.createElement("input");
        input.type = "radio";
        input.name = "depth";
        input.value = value;
        input.checked = chosen() === value;
        input.addEventListener("change", () => {
            keep(value);
            parts.forEach(part => fold(part, value === "main"));
        });
        label.append(input, " " + name + ", " + minutes + " minutes");
        return label;
    }
    if (opening) {
        const box = document.createElement("div");
        box.className = "depth-choice";
        box.setAttribute("role", "radiogroup");
        box.setAttribute("aria-label", "How much to read");
        box.append(choice("main", "Main road", opening.dataset.main), choice("all", "Everything", opening.dataset.all));
        opening.querySelector("dl").after(box);
    }
    parts.forEach(part => fold(part, chosen() === "main"));

    // ---- An address inside of a fold opens it.
    function arrive() {
        const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
        if (!target) {
            return;
        }
        const heading = parts.find(part => part.contains(target) || headingOf(part) === target || headingOf(part)?.contains(target));
        if (heading && heading.hasAttribute("hidden")) {
            fold(heading, false);
            target.scrollIntoView();
        }
    }

    /** The heading that leads into a part. */
    function headingOf(part) {
        let before = part.previousElementSibling;
        while (before && !/^H[23]$/.test(before.tagName)) {
            before = before.previousElementSibling;
        }
        return before;
    }
    addEventListener("hashchange", arrive);
    arrive();

    // ---- Paper has everything.
    let shut = [];
    addEventListener("beforeprint", () => {
        shut = parts.filter(part => part.hasAttribute("hidden"));
        shut.forEach(part => fold(part, false));
    });
    addEventListener("afterprint", () => shut.forEach(part => fold(part, true)));
})();
