// Prepares the page that holds the whole book for paper: a title with its imprint, contents, and room for the page numbers
// of references, which `paper.number` fills in. Its value is the list of what is wider than the paper.
imprint => {
    "use strict";

    const text = document.querySelector("main");
    const all = (selector, root = text) => Array.from(root.querySelectorAll(selector));

    function element(name, className, ...children) {
        const made = document.createElement(name);
        made.className = className;
        made.append(...children);
        return made;
    }

    // What lies beside the pages does not come along.
    all("a[href]", document)
        .filter(link => !/^(#|https?:|mailto:)/.test(link.getAttribute("href")))
        .forEach(link => link.removeAttribute("href"));

    // A page below a chapter has a letter in its number. In the outline its headings stand below those of the chapter.
    let below = 0;
    all("h1, h2, h3, h4").forEach(heading => {
        if (heading.matches("h1")) below = Number(/^\d+\.[A-Z] /.test(heading.textContent));
        heading.ariaLevel = Number(heading.tagName.slice(1)) + below;
    });

    /** A line of the contents: what a heading says, without the places in it that are led to. */
    function line(heading) {
        const link = heading.querySelector("a.header").cloneNode(true);
        link.className = "";
        all("[id]", link).forEach(place => place.removeAttribute("id"));
        return element("li", `level-${heading.ariaLevel}`, link);
    }
    const lines = all("h1, h2").filter(heading => heading.querySelector("a.header")).map(line);
    const title = document.querySelector(".menu-title").textContent.trim();
    const version = text.querySelector(".version")?.textContent.match(/Version (\S*\d)/)?.[1];
    const released = imprint.releases[version];
    const day = released && new Date(released).toLocaleDateString("en-GB", { dateStyle: "long", timeZone: "UTC" });
    const edition = [version && `Version ${version}`, day].filter(Boolean).join(", ");
    const paragraphs = (className, lines) => lines.map(line => element("p", className, line));
    text.prepend(
        element(
            "div",
            "paper-title",
            element("p", "paper-name", title),
            element("p", "paper-subtitle", document.querySelector("meta[name=description]").content),
            ...paragraphs("paper-author", imprint.authors),
            ...paragraphs("paper-imprint", [edition, ...imprint.licences]),
        ),
        element("nav", "paper-contents", element("h1", "", "Contents"), element("ul", "", ...lines)),
    );

    // Not the number of an equation, which leads to itself; nor a work, which the alphabet finds; nor the ledger, whose
    // rows all lead to chapters.
    const unnumbered = ".header, .equation-number, .saying, .citation, svg a, .ledger a";
    const ledger = document.getElementById("sec:ledger");
    for (let part = ledger?.nextElementSibling; part && !part.matches("h1"); part = part.nextElementSibling) {
        part.classList.add("ledger");
    }
    const references = all('a[href^="#"]').filter(link => !link.matches(unnumbered));
    references.forEach(link => {
        link.dataset.page = "000";
    });

    window.paper = {
        /** Writes the number of the page behind each reference. */
        number(pages) {
            references.forEach(link => {
                const page = pages[link.hash.slice(1)];
                if (page === undefined) {
                    delete link.dataset.page;
                } else {
                    link.dataset.page = page;
                }
            });
        },
    };

    const cut = box => box.scrollWidth > box.clientWidth + 1
        || all(".katex-html .base", box).some(base => base.getBoundingClientRect().right > innerWidth + 1);
    return all(".equation-body, .katex-display, .table-wrapper, pre, pre > code, .plot")
        .filter(cut)
        .map(box => box.closest("[id]")?.id || box.textContent.trim().slice(0, 40));
}
