// Opens a scene in the viewer of rerun, which is a program for the browser. Loaded, as the viewer and the scene are, when a
// reader asks for it. All come as scripts that hand over what they hold, so that they also load where a page is opened
// from a disk.
(function () {
    "use strict";

    function element(name, properties, ...children) {
        const made = Object.assign(document.createElement(name), properties);
        made.append(...children);
        return made;
    }

    async function unpacked(text) {
        const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
        const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
        return new Uint8Array(await new Response(stream).arrayBuffer());
    }

    // ---- The viewer would tell its makers that it is used. A book asks nothing of other hosts, and sees to it that what it
    // opens does not either.
    function keepToThisHost() {
        const anywhere = window.fetch;
        window.fetch = (what, options) => {
            const address = new URL(what instanceof Request ? what.url : what, document.baseURI);
            const foreign = address.protocol.startsWith("http") && address.host !== location.host;
            return foreign ? Promise.reject(new TypeError(`${address.host} is not asked`)) : anywhere.call(window, what, options);
        };
    }

    // ---- What was asked for, by its name, and the scripts that hand it over.
    const asked = new Map();

    function load(name, address) {
        if (!asked.has(name)) {
            const promise = {};
            promise.content = new Promise((resolve, reject) => Object.assign(promise, { resolve, reject }));
            asked.set(name, promise);
            const script = element("script", { src: address });
            script.addEventListener("error", () => {
                asked.delete(name);
                promise.reject(new Error("a file of it is not there"));
            });
            document.head.append(script);
        }
        return asked.get(name).content;
    }

    function viewer(program, packed) {
        keepToThisHost();
        const started = unpacked(packed).then(code => program({ module_or_path: code })).then(() => program);
        asked.get("viewer").resolve(started);
    }

    function scene(name, packed) {
        asked.get(name).resolve(unpacked(packed));
    }

    // ---- The window in which a scene is shown, above the page.
    async function open(figure) {
        const { recording: name, viewer: program, scene: content } = figure.dataset;
        const canvas = element("canvas", { tabIndex: 0 });
        canvas.setAttribute("aria-label", figure.querySelector("img").alt);
        const close = element("button", { type: "button", textContent: "Close" });
        const told = element("p", { className: "recording-told", textContent: "Loading the viewer …" });
        told.setAttribute("role", "status");
        const dialog = element("dialog", { className: "recording-window" }, element("div", {}, told, close), canvas);
        dialog.setAttribute("aria-label", "The scene in three dimensions");
        close.addEventListener("click", () => dialog.close());
        figure.append(dialog);
        dialog.showModal();
        const closed = new Promise(resolve => dialog.addEventListener("close", resolve));
        let handle = null;
        closed.then(() => {
            handle?.destroy();
            handle?.free();
            dialog.remove();
        });
        try {
            const [{ WebHandle }, bytes] = await Promise.all([load("viewer", program), load(name, content)]);
            if (!dialog.open) return;
            handle = new WebHandle({ url: [], hide_welcome_screen: true, enable_history: false, persist: false, theme: "dark" });
            await handle.start(canvas);
            handle.open_channel(name, name);
            handle.send_rrd_to_channel(name, bytes);
            handle.close_channel(name);
            told.textContent = "Drag to turn it, scroll to come nearer, and play it at the bottom.";
        } catch (error) {
            told.textContent = `The viewer cannot be shown here: ${error?.message ?? error}. The command below the picture opens the scene in a viewer of its own.`;
        }
    }

    window.vislamRecordings = { open, scene, viewer };
})();
