// Shows a student's answer, which may do anything: it runs in a Worker that is ended when it takes too long. What is
// drawn, and how, is the matter of widgets.js. Only pages that are served with `--mine` have this.
(function () {
    "use strict";

    const figures = [...document.querySelectorAll("figure[data-answer]")];
    if (figures.length === 0 || document.documentElement.classList.contains("print-page")) {
        return;
    }
    const PATIENCE = 2000; // ms for one picture
    const LOADING = 20000; // ms until a module runs

    // ---- In the Worker: the module, and what it answers. The class that reads its memory comes as text.
    function work(Session) {
        let session = null;
        const act = {
            load: module => {
                session = new Session(new WebAssembly.Instance(module, {}));
                return { face: session.face };
            },
            silence: () => {
                session.exports.silence();
                return {};
            },
            show: controls => {
                session.controls.set(controls);
                const numbers = session.show().slice();
                return { numbers, said: session.said, controls: session.controls.slice() };
            },
        };
        const panic = () => {
            try {
                return session.text(session.exports.panic_said());
            } catch {
                return "";
            }
        };
        self.onmessage = ({ data: [task, argument] }) => {
            try {
                postMessage(act[task](argument));
            } catch (error) {
                postMessage({ failed: `${error.name}: ${error.message}`, panic: panic() });
            }
        };
    }

    // ---- What happened, and what to look for.
    function told({ failed, panic }) {
        const file = text => text.replaceAll("exercises/pictures/modules/../../src/", "exercises/src/");
        if (panic.startsWith("not written yet")) {
            return `N${panic.slice(1)}.`;
        }
        if (panic) {
            return `${file(panic[0].toUpperCase() + panic.slice(1))}.`;
        }
        if (/LinkError|TypeError.*[Ii]mport/.test(failed)) {
            return "Your answer wants something from outside, and a module gets nothing from there. Leave out what reads files, clocks or randomness.";
        }
        if (/call stack|out of bounds/.test(failed)) {
            return "Your answer overflowed the stack. Look for a function that calls itself without an end, or for very large arrays.";
        }
        if (/unreachable/.test(failed)) {
            return "Your answer stopped without a word, as it does when it asks for more memory than the 64 MB it may have. Look for a list that grows in a loop, or for a size that is computed.";
        }
        return `Your answer stopped: ${failed}.`;
    }
    const ENDLESS = `Your answer took longer than ${PATIENCE / 1000} s and was ended. Look for a loop whose condition never changes.`;

    // ---- An answer in its Worker. A Worker that fails is ended, and the next picture begins with a new one.
    class Answer {
        constructor(module, source) {
            Object.assign(this, { module, source, worker: null, newest: null, busy: false });
        }

        async load() {
            this.worker = new Worker(this.source);
            const { face } = await this.ask("load", this.module, LOADING);
            this.face = face;
            this.controls ??= Float64Array.from(face.controls, control => control.start);
        }

        // Of several pictures that are wanted while one is made, the last is made.
        async show(shown, failed) {
            this.newest = { shown, failed };
            if (this.busy) {
                return;
            }
            this.busy = true;
            while (this.newest) {
                const { shown, failed } = this.newest;
                this.newest = null;
                try {
                    if (!this.worker) {
                        await this.load();
                    }
                    const picture = await this.ask("show", this.controls, PATIENCE);
                    if (!this.newest) {
                        this.controls.set(picture.controls);
                    }
                    shown(picture.numbers, picture.said);
                } catch (error) {
                    failed(error, await this.alone().catch(() => null));
                }
            }
            this.busy = false;
        }

        // What is expected, without the answer.
        async alone() {
            await this.load();
            await this.ask("silence", null, PATIENCE);
            const { numbers } = await this.ask("show", this.controls, PATIENCE);
            this.end();
            return numbers;
        }

        end() {
            this.worker.terminate();
            this.worker = null;
        }

        ask(task, argument, patience) {
            return new Promise((resolve, reject) => {
                const fail = why => {
                    this.end();
                    reject(new Error(why));
                };
                const late = setTimeout(() => fail(ENDLESS), patience);
                this.worker.onmessage = ({ data }) => {
                    clearTimeout(late);
                    if (data.failed) {
                        fail(told(data));
                    } else {
                        resolve(data);
                    }
                };
                this.worker.onerror = event => {
                    event.preventDefault();
                    clearTimeout(late);
                    fail(`Your answer stopped: ${event.message}.`);
                };
                this.worker.postMessage([task, argument]);
            });
        }

        drag() {}
    }

    // ---- A page loads what draws, and then the answer.
    function script(src) {
        return new Promise((resolve, reject) => {
            const made = Object.assign(document.createElement("script"), { src });
            made.addEventListener("load", resolve);
            made.addEventListener("error", () => reject(new Error("A part of this picture is missing: stop the server and start it again.")));
            document.head.append(made);
        });
    }

    function sheet(href) {
        document.head.append(Object.assign(document.createElement("link"), { rel: "stylesheet", href }));
    }

    function trouble(figure, sentence, text) {
        const note = figure.querySelector(".widget-note");
        note.textContent = sentence;
        note.classList.add("trouble");
        figure.prepend(note);
        figure.querySelector(".plot").replaceChildren(...(text ? [Object.assign(document.createElement("pre"), { textContent: text, tabIndex: 0 })] : []));
    }

    async function start(figure) {
        const { answer: name, scripts, answers } = figure.dataset;
        const written = new Promise(resolve => {
            window.vislamAnswer = resolve;
        });
        sheet(scripts + "widgets.css");
        sheet(answers + "mine.css");
        await script(scripts + "widgets.js");
        await script(`${answers}${name}.js`);
        const { module, sentence, text } = await written;
        if (!module) {
            trouble(figure, sentence, text);
            return;
        }
        const { compiled, element, Session, Widget } = window.vislamWidgets;
        const source = URL.createObjectURL(new Blob([`"use strict";\n(${work})(${Session});`], { type: "text/javascript" }));
        const asked = new Answer(await compiled(module), source);
        await asked.load();

        class Mine extends Widget {
            // The same picture is asked for once: when the page changes its width, what is known is drawn again.
            render() {
                cancelAnimationFrame(this.wanted);
                this.wanted = null;
                const state = this.session.controls.join();
                if (state === this.state) {
                    if (this.known) {
                        this.fare(...this.known);
                    }
                    return;
                }
                Object.assign(this, { state, known: null });
                const keep = (...known) => {
                    this.known = known;
                    this.fare(...known);
                };
                this.session.show((...picture) => keep("", picture), (error, alone) => keep(error.message, alone && [alone, ""]));
            }

            reset() {
                this.state = null;
                super.reset();
            }

            // A picture, or why there is none; then it is one without the answer.
            fare(sentence, picture) {
                this.trouble ??= this.troubleBox();
                this.trouble.textContent = sentence;
                this.box.classList.toggle("failed", Boolean(sentence));
                this.shown(...picture ?? [new Float64Array(this.readings.length).fill(NaN), ""]);
            }

            troubleBox() {
                const made = element("p", { className: "trouble" });
                made.setAttribute("role", "alert");
                this.box.querySelector(".lead").after(made);
                return made;
            }
        }
        // By this name the address keeps the sliders.
        figure.dataset.widget = name;
        figure.widget = new Mine(figure, asked);
    }

    figures.forEach(figure => start(figure).catch(error => trouble(figure, error.message)));
})();
