// Draws what a module says and tells it what a reader does. It computes nothing of what is shown: modules do, and they
// are the library of the book. Loaded when a picture to take hold of comes near the screen.
(function () {
    "use strict";

    const STYLES = ["ink", "faint", "measured", "estimated", "prior", "first", "second", "third"];
    const SHAPES = ["line", "dashed", "area", "discs", "rings", "crosses", "cells", "pale-cells"];
    const [VIEW, HANDLE, WORD] = [100, 101, 102];
    const QUIET = 700; // ms without a change before numbers are announced
    const TURN = 2; // ms that are computed before a picture of the screen, what is begun being ended
    const SVG = "http://www.w3.org/2000/svg";
    const still = matchMedia("(prefers-reduced-motion: reduce)");

    function element(name, properties, ...children) {
        const made = Object.assign(document.createElement(name), properties);
        made.append(...children);
        return made;
    }

    function drawn(name, attributes) {
        const made = document.createElementNS(SVG, name);
        Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
        return made;
    }

    // ---- Modules come as scripts that call this with their name and their bytes, compressed.
    const asked = new Map();

    function compiled(packed) {
        const bytes = Uint8Array.from(atob(packed), letter => letter.charCodeAt(0));
        const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
        return new Response(unpacked).arrayBuffer().then(code => WebAssembly.compile(code));
    }

    function module(name, packed) {
        asked.get(name).resolve(compiled(packed));
    }

    function load(name, address) {
        if (!asked.has(name)) {
            const promise = {};
            promise.module = new Promise((resolve, reject) => Object.assign(promise, { resolve, reject }));
            asked.set(name, promise);
            const script = element("script", { src: address });
            script.addEventListener("error", () => promise.reject(new Error("its file is not there")));
            document.head.append(script);
        }
        return asked.get(name).module;
    }

    // ---- What a module exports, in terms of arrays. Its memory may grow with every call, so views are made anew.
    class Session {
        constructor(instance) {
            this.exports = instance.exports;
            this.face = JSON.parse(this.text(this.exports.face()));
        }

        place(packed) {
            return [Number(packed >> 32n), Number(packed & 0xffffffffn)];
        }

        bytes(packed) {
            const [address, length] = this.place(packed);
            return new Uint8Array(this.exports.memory.buffer, address, length);
        }

        text(packed) {
            return new TextDecoder().decode(this.bytes(packed));
        }

        numbers(packed) {
            const [address, length] = this.place(packed);
            return new Float64Array(this.exports.memory.buffer, address, length);
        }

        get controls() {
            return this.numbers(this.exports.controls());
        }

        // Computes for so many milliseconds; whether more is left.
        advance(milliseconds) {
            const until = performance.now() + milliseconds;
            let more = this.exports.advance();
            while (more && performance.now() < until) {
                more = this.exports.advance();
            }
            return Boolean(more);
        }

        show() {
            return this.numbers(this.exports.show());
        }

        get steps() {
            return this.numbers(this.exports.steps());
        }

        get said() {
            return this.text(this.exports.said());
        }

        drag(handle, [x, y]) {
            this.exports.drag(handle, x, y);
        }
    }

    // ---- A panel: axes, and marks in its coordinates.
    class Panel {
        constructor(face, drag) {
            this.face = face;
            this.drag = drag;
            this.view = [...face.x.range, ...face.y.range];
            this.axes = drawn("g", { class: "axes" });
            this.marks = drawn("g", { class: "marks" });
            this.handles = drawn("g", { class: "handles" });
            this.clip = "clip-" + Panel.count++;
            this.window = drawn("rect", {});
            const clip = drawn("clipPath", { id: this.clip });
            clip.append(this.window);
            this.marks.setAttribute("clip-path", `url(#${this.clip})`);
            this.svg = drawn("svg", { "aria-hidden": "true" });
            this.svg.append(clip, this.axes, this.marks, this.handles);
            this.box = element("div", { className: "panel" },
                element("p", { className: "panel-title", textContent: face.title }), this.svg);
            this.box.style.setProperty("--span", face.span);
            this.paths = [];
            this.grips = [];
        }

        // Asked of all panels before one of them changes, since the browser would lay out the page anew for each.
        fit() {
            this.width = Math.max(160, this.box.clientWidth);
        }

        // Margins, and how the coordinates lie between them.
        measure() {
            const { face, width, view: [x0, x1, y0, y1] } = this;
            // A plot as wide as the page would be a strip on a telephone, and its legend would fill it.
            const strip = face.span === 6 && !face.equal && width < 480;
            const aspect = strip ? Math.max(face.aspect, 0.66) : face.aspect;
            const height = Math.round(width * aspect) + (face.x.label ? 34 : 0);
            const left = face.y.label ? 46 : 6;
            const bottom = face.x.label ? 38 : 6;
            const inside = { x: left, y: 6, width: width - left - 8, height: height - bottom - 6 };
            let [sx, sy] = [inside.width / (x1 - x0), inside.height / (y1 - y0)];
            if (face.equal) {
                sx = sy = Math.min(sx, sy);
            }
            const [mx, my] = [(x0 + x1) / 2, (y0 + y1) / 2];
            const [cx, cy] = [inside.x + inside.width / 2, inside.y + inside.height / 2];
            const turn = face.down ? 1 : -1;
            this.size = { width, height, inside };
            this.at = (x, y) => [cx + (x - mx) * sx, cy + turn * (y - my) * sy];
            this.back = (px, py) => [mx + (px - cx) / sx, my + turn * (py - cy) / sy];
            this.unit = [sx, sy];
        }

        // Lines at round numbers, with those numbers.
        drawAxes() {
            this.measure();
            const { width, height, inside } = this.size;
            const key = [width, height, ...this.view].join();
            if (key === this.drawnFor) {
                return;
            }
            this.drawnFor = key;
            this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
            Object.entries(inside).forEach(([name, value]) => this.window.setAttribute(name, value));
            const { face } = this;
            const [right, below] = [inside.x + inside.width, inside.y + inside.height];
            const corner = this.back(inside.x, below);
            const other = this.back(right, inside.y);
            let lines = "";
            const texts = [];
            const say = (text, x, y, anchor, turn) => {
                const said = drawn("text", { x, y, "text-anchor": anchor, ...(turn && { transform: `rotate(-90 ${x} ${y})` }) });
                said.textContent = text;
                texts.push(said);
            };
            if (face.x.label) {
                for (const value of round(corner[0], other[0], inside.width / 70)) {
                    const [x] = this.at(value.number, 0);
                    lines += `M${x} ${inside.y}V${below}`;
                    say(value.text, x, below + 15, "middle");
                }
                say(face.x.label, inside.x + inside.width / 2, height - 4, "middle");
            }
            if (face.y.label) {
                for (const value of round(corner[1], other[1], inside.height / 36)) {
                    const [, y] = this.at(0, value.number);
                    lines += `M${inside.x} ${y}H${right}`;
                    say(value.text, inside.x - 5, y + 4, "end");
                }
                say(face.y.label, 11, inside.y + inside.height / 2, "middle", true);
            }
            const frame = drawn("rect", { class: "frame", ...inside });
            this.axes.replaceChildren(drawn("path", { class: "grid", d: lines }), frame, ...texts);
        }

        begin() {
            this.used = 0;
            this.held = 0;
            this.pending = [];
        }

        add(mark) {
            if (mark.shape === VIEW) {
                this.view = [...mark.numbers];
            } else {
                this.pending.push(mark);
            }
        }

        end(words) {
            this.drawAxes();
            for (const mark of this.pending) {
                if (mark.shape === HANDLE) {
                    this.grip(mark);
                } else {
                    this.path(mark, words);
                }
            }
            this.paths.splice(this.used).forEach(path => path.remove());
            this.grips.splice(this.held).forEach(grip => grip.remove());
        }

        path({ shape, style, size, numbers }, words) {
            const name = shape === WORD ? "text" : "path";
            let path = this.paths[this.used];
            if (!path || path.nodeName !== name) {
                const made = drawn(name, {});
                if (path) {
                    path.replaceWith(made);
                } else {
                    this.marks.append(made);
                }
                path = this.paths[this.used] = made;
            }
            this.used += 1;
            if (shape === WORD) {
                const [x, y] = this.at(numbers[0], numbers[1]);
                path.setAttribute("x", x);
                path.setAttribute("y", y);
                path.setAttribute("class", STYLES[style]);
                path.textContent = words[size];
                return;
            }
            path.setAttribute("class", STYLES[style] + " " + SHAPES[shape]);
            path.style.setProperty("--size", size + "px");
            path.setAttribute("d", this.trace(SHAPES[shape], numbers, size));
        }

        trace(shape, numbers, size) {
            const parts = [];
            const joined = shape === "line" || shape === "dashed" || shape === "area";
            let next = "M";
            for (let k = 0; k + 1 < numbers.length; k += 2) {
                const [x, y] = this.at(numbers[k], numbers[k + 1]);
                if (!Number.isFinite(x) || !Number.isFinite(y)) {
                    next = "M";
                } else if (joined) {
                    parts.push(next, x.toFixed(1), " ", y.toFixed(1));
                    next = "L";
                } else if (shape === "cells" || shape === "pale-cells") {
                    const [w, h] = this.unit;
                    parts.push(`M${(x - w / 2).toFixed(2)} ${(y - h / 2).toFixed(2)}h${w.toFixed(2)}v${h.toFixed(2)}h${(-w).toFixed(2)}z`);
                } else if (shape === "crosses") {
                    parts.push(`M${x - size} ${y - size}l${2 * size} ${2 * size}m0 ${-2 * size}l${-2 * size} ${2 * size}`);
                } else {
                    parts.push(`M${(x - size).toFixed(1)} ${y.toFixed(1)}a${size} ${size} 0 1 0 ${2 * size} 0a${size} ${size} 0 1 0 ${-2 * size} 0`);
                }
            }
            return parts.join("") + (shape === "area" && parts.length > 0 ? "z" : "");
        }

        grip({ style, size: handle, numbers }) {
            let grip = this.grips[this.held];
            if (!grip) {
                grip = drawn("g", { class: "handle" });
                grip.append(drawn("circle", { class: "hit", r: 22 }), drawn("circle", { class: "ring", r: 8 }));
                this.handles.append(grip);
                this.grips[this.held] = grip;
                grip.addEventListener("pointerdown", event => {
                    event.preventDefault();
                    grip.setPointerCapture(event.pointerId);
                });
                grip.addEventListener("pointermove", event => {
                    if (grip.hasPointerCapture(event.pointerId)) {
                        const box = this.svg.getBoundingClientRect();
                        const scale = this.size.width / box.width;
                        this.drag(grip.handle, this.back((event.clientX - box.left) * scale, (event.clientY - box.top) * scale));
                    }
                });
            }
            this.held += 1;
            grip.handle = handle;
            grip.setAttribute("class", "handle " + STYLES[style]);
            grip.setAttribute("transform", `translate(${this.at(numbers[0], numbers[1]).join(" ")})`);
        }
    }
    Panel.count = 0;

    // Round numbers between two, about so many.
    function round(from, to, count) {
        const [least, most] = [Math.min(from, to), Math.max(from, to)];
        const rough = (most - least) / Math.max(2, Math.min(9, count));
        const ten = 10 ** Math.floor(Math.log10(rough));
        const step = ten * [1, 2, 5, 10].find(part => part * ten >= rough);
        const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
        const found = [];
        for (let k = Math.ceil(least / step); k * step <= most; k += 1) {
            const text = (k * step).toFixed(digits);
            found.push({ number: k * step, text: /^-0\.?0*$/.test(text) ? "0" : text.replace("-", "−") });
        }
        return found;
    }

    // ---- A control: its slider, switch, list or button.
    class Control {
        constructor(face, number, change) {
            Object.assign(this, { face, number });
            this.shown = element("span", { className: "value" });
            const label = element("span", { className: "name", textContent: face.label });
            if (face.kind === "count") {
                this.buttons("Back", () => change(this, this.value + 1), () => change(this, this.value - 1));
            } else if (face.kind === "moment") {
                this.buttons("Undo", () => change(this, this.now()), () => change(this, face.start));
            } else if (face.kind === "switch") {
                this.input = element("input", { type: "checkbox" });
                this.input.addEventListener("change", () => change(this, Number(this.input.checked)));
                this.box = element("label", { className: "control switch" }, this.input, label);
            } else if (face.kind.choice) {
                const options = face.kind.choice.map((text, value) => element("option", { value, textContent: text }));
                this.input = element("select", {}, ...options);
                this.input.addEventListener("change", () => change(this, Number(this.input.value)));
                this.box = element("label", { className: "control" }, label, this.input);
            } else {
                this.slider(label, change);
            }
        }

        buttons(back, forth, undo) {
            this.input = element("button", { type: "button", textContent: this.face.label });
            this.input.addEventListener("click", forth);
            this.back = element("button", { type: "button", textContent: back });
            this.back.setAttribute("aria-label", `${back}: ${this.face.label}`);
            this.back.addEventListener("click", undo);
            this.box = element("div", { className: `control count ${this.face.kind}` }, this.input, this.back, this.shown);
        }

        slider(label, change) {
            const { face } = this;
            const whole = face.kind === "logarithmic" ? 1 : face.most - face.least;
            const steps = Math.round(whole / face.step);
            this.input = element("input", { type: "range", min: 0, max: steps, step: 1 });
            this.input.setAttribute("aria-label", face.label);
            this.input.addEventListener("input", () => change(this, this.ofPlace(Number(this.input.value) / steps)));
            this.steps = steps;
            this.box = element("label", { className: "control" }, label, this.shown, this.input);
            if (face.kind === "sweep") {
                this.play = element("button", { type: "button", className: "play" });
                this.box = element("div", { className: "control sweep" }, this.box, this.play);
            }
        }

        // The value at a part of the slider's length, and back.
        ofPlace(part) {
            const { least, most, step, kind } = this.face;
            if (kind === "logarithmic") {
                return least * (most / least) ** part;
            }
            return Number((least + Math.round(part * (most - least) / step) * step).toPrecision(12));
        }

        place(value) {
            const { least, most, kind } = this.face;
            return kind === "logarithmic" ? Math.log(value / least) / Math.log(most / least) : (value - least) / (most - least);
        }

        show(value) {
            this.value = value;
            const { face, input } = this;
            if (face.kind === "switch") {
                input.checked = value !== 0;
            } else if (face.kind.choice) {
                input.value = String(value);
            } else if (face.kind === "count") {
                this.shown.textContent = String(value);
                this.input.setAttribute("aria-disabled", value >= face.most);
                this.back.setAttribute("aria-disabled", value <= face.least);
            } else if (face.kind === "moment") {
                this.shown.textContent = value < 0 ? "" : `after ${value.toFixed(1)} ${face.unit}`;
                this.back.setAttribute("aria-disabled", value < 0);
            } else {
                const digits = face.kind === "logarithmic" ? Math.max(0, 2 - Math.floor(Math.log10(value)))
                    : Math.max(0, -Math.floor(Math.log10(face.step) + 1e-9));
                const text = value.toFixed(digits).replace("-", "−") + (face.unit ? " " + face.unit : "");
                this.shown.textContent = text;
                input.value = String(Math.round(this.place(value) * this.steps));
                input.setAttribute("aria-valuetext", text);
            }
        }
    }

    // ---- A widget: its face built once, and shown again at every change.
    class Widget {
        constructor(figure, session) {
            Object.assign(this, { figure, session, name: figure.dataset.widget });
            const { face } = session;
            this.controls = face.controls.map((control, number) =>
                new Control(control, number, (...change) => this.change(...change)));
            this.panels = face.panels.map(panel => new Panel(panel, (handle, place) => this.drag(handle, place)));
            this.readings = face.readings.map(reading => this.reading(reading));
            this.said = element("p", { className: "said" });
            this.spoken = element("p", { className: "spoken" });
            this.spoken.setAttribute("role", "status");
            const reset = element("button", { type: "button", className: "reset", textContent: "Reset" });
            reset.addEventListener("click", () => this.reset());
            this.box = element("div", { className: "widget" },
                element("p", { className: "lead", textContent: face.lead }),
                element("div", { className: "panels" }, ...this.panels.map(panel => panel.box)),
                ...(face.question ? [this.question(face.question)] : []),
                element("dl", { className: "readings" }, ...this.readings.map(reading => reading.box)),
                this.said,
                element("div", { className: "controls" }, ...this.controls.map(control => control.box), reset),
                this.spoken);
            this.box.tabIndex = -1;
            this.box.setAttribute("role", "group");
            this.box.setAttribute("aria-label", "Picture to take hold of");
            this.controls.filter(control => control.play).forEach(control => this.playable(control));
            this.controls.filter(({ face }) => face.kind === "moment").forEach(control => {
                control.now = () => this.now(control.face.most);
            });
            figure.querySelector(".plot").after(this.box);
            figure.classList.add("alive");
            this.read();
            this.render();
            // What nobody has asked for is not read aloud.
            ["input", "change", "click", "keydown", "pointerdown"].forEach(kind =>
                this.box.addEventListener(kind, () => { this.touched = true; }, { capture: true }));
            new ResizeObserver(() => this.ask()).observe(this.box);
        }

        reading(face) {
            const value = element("dd", {});
            return { face, value, box: element("div", {}, element("dt", { textContent: face.label }), value) };
        }

        question({ ask, choices, right, why }) {
            this.veiled = true;
            const verdict = element("p", { className: "verdict" });
            verdict.setAttribute("role", "status");
            const answers = choices.map((text, number) => {
                const button = element("button", { type: "button", textContent: text });
                button.addEventListener("click", () => {
                    if (!this.veiled) {
                        return;
                    }
                    this.veiled = false;
                    verdict.textContent = `${number === right ? "That is right" : `No: ${choices[right]}`}. ${why}`;
                    verdict.classList.add(number === right ? "right" : "wrong");
                    // Not disabled, for that would take the focus away.
                    answers.forEach(other => other.setAttribute("aria-disabled", true));
                    this.render();
                });
                return button;
            });
            return element("div", { className: "question" },
                element("p", { textContent: ask }), element("div", { className: "answers" }, ...answers), verdict);
        }

        change(control, value) {
            this.session.controls[control.number] = value;
            this.ask();
        }

        // Where the slider that is played stands. From there it goes on, for who presses a button wants to see what follows.
        now(most) {
            const sweep = this.controls.find(control => control.play);
            const values = this.session.controls;
            const value = values[sweep.number] = Math.min(values[sweep.number], most);
            sweep.way = 1;
            if (!still.matches && !this.playing) {
                this.start(sweep);
            }
            return value;
        }

        set(name, value) {
            const control = this.controls.find(control => control.face.name === name);
            this.change(control, value);
            this.render();
        }

        drag(handle, place) {
            this.session.drag(handle, place);
            this.ask();
        }

        reset() {
            this.pause();
            const values = this.session.controls;
            this.session.face.controls.forEach((control, number) => {
                values[number] = control.start;
            });
            this.controls.forEach(control => { control.way = 1; });
            this.render();
        }

        // Once a picture of the screen, whatever happened since the last one.
        ask() {
            this.wanted ??= requestAnimationFrame(() => this.render());
        }

        render() {
            cancelAnimationFrame(this.wanted);
            this.wanted = null;
            try {
                this.more = this.session.advance(TURN);
                this.shown(this.session.show(), this.session.said);
            } catch (error) {
                this.pause();
                stand(this.figure, `its program has stopped: ${error.message}`);
            }
        }

        shown(numbers, said) {
            this.draw(numbers);
            this.said.textContent = said;
            const values = this.session.controls;
            this.controls.forEach((control, number) => control.show(values[number]));
            this.write();
            if (this.touched) {
                clearTimeout(this.later);
                this.later = setTimeout(() => this.announce(), QUIET);
            }
            if (this.more) {
                this.ask();
            }
        }

        draw(numbers) {
            this.panels.forEach(panel => panel.fit());
            this.readings.forEach((reading, number) => this.tell(reading, numbers[number]));
            this.panels.forEach(panel => panel.begin());
            for (let k = this.readings.length; k < numbers.length;) {
                const [shape, panel, style, size, count] = numbers.subarray(k, k + 5);
                this.panels[panel].add({ shape, style, size, numbers: numbers.subarray(k + 5, k + 5 + count) });
                k += 5 + count;
            }
            this.panels.forEach(panel => panel.end(this.session.face.words));
        }

        tell({ face, value, box }, number) {
            const veiled = this.veiled && face.veiled;
            const text = Number.isFinite(number)
                ? number.toFixed(face.digits).replace(/^-(0\.?0*)$/, "$1").replace("-", "−") + (face.unit ? " " + face.unit : "")
                : face.none;
            box.classList.toggle("veiled", Boolean(veiled));
            value.textContent = veiled ? "answer first" : text;
            value.dataset.value = String(number);
        }

        announce() {
            const told = this.readings.filter(reading => !reading.box.classList.contains("veiled"));
            const readings = told.map(({ face, value }) => `${face.label}: ${value.textContent}`).join("; ");
            this.spoken.textContent = [readings, this.said.textContent].filter(Boolean).join(". ");
        }

        // ---- Playing: up and down a slider. Who wants no motion goes on by steps.
        playable(control) {
            this.label(control);
            control.play.addEventListener("click", () => {
                if (still.matches) {
                    this.sweep(control, 0.05);
                } else if (this.playing) {
                    this.pause();
                } else {
                    this.start(control);
                }
            });
        }

        start(control) {
            this.playing = control;
            this.label(control);
            this.go(performance.now());
        }

        label(control) {
            control.play.textContent = still.matches ? "Next" : this.playing ? "Pause" : "Play";
        }

        go(before) {
            this.turn = requestAnimationFrame(now => {
                this.sweep(this.playing, Math.min(0.1, (now - before) / 8000));
                this.go(now);
            });
        }

        sweep(control, part) {
            const { least, most } = control.face;
            const values = this.session.controls;
            let value = values[control.number] + (control.way ?? 1) * part * (most - least);
            if (value >= most || value <= least) {
                control.way = value >= most ? -1 : 1;
                value = Math.min(most, Math.max(least, value));
            }
            values[control.number] = value;
            this.render();
        }

        pause() {
            cancelAnimationFrame(this.turn);
            const control = this.playing;
            this.playing = null;
            if (control) {
                this.label(control);
            }
        }

        // ---- The state in the address, so that it can be linked to. Only what is not as it was at first.
        read() {
            const query = new URLSearchParams(location.search);
            const values = this.session.controls;
            this.session.face.controls.forEach((control, number) => {
                const value = query.get(`${this.name}.${control.name}`);
                if (value !== null && Number.isFinite(Number(value))) {
                    values[number] = Number(value);
                }
            });
        }

        write() {
            clearTimeout(this.writing);
            this.writing = setTimeout(() => {
                const query = new URLSearchParams(location.search);
                const values = this.session.controls;
                this.session.face.controls.forEach((control, number) => {
                    const key = `${this.name}.${control.name}`;
                    if (values[number] === control.start) {
                        query.delete(key);
                    } else {
                        query.set(key, String(Number(values[number].toPrecision(6))));
                    }
                });
                const text = query.toString();
                const search = text ? "?" + text : "";
                if (search !== location.search) {
                    history.replaceState(history.state, "", location.pathname + search + location.hash);
                }
            }, 300);
        }
    }

    // The figure stands still, and says why.
    function stand(figure, why) {
        figure.classList.remove("alive");
        figure.querySelector(".widget")?.remove();
        figure.querySelector(".widget-note").textContent = `This picture cannot be taken hold of here: ${why}. It stands still.`;
    }

    async function start(figure) {
        const note = figure.querySelector(".widget-note");
        note.textContent = "This picture can be taken hold of in a moment.";
        try {
            const code = await load(figure.dataset.widget, figure.dataset.module);
            const instance = await WebAssembly.instantiate(code, {});
            figure.widget = new Widget(figure, new Session(instance));
        } catch (error) {
            stand(figure, error.message);
        }
    }

    window.vislamWidgets = { module, start, compiled, element, stand, Session, Widget };
})();
