// Long work: its progress, asked for while it runs; one at a time.
import { api } from "/shared/access.js";
import { element, figure } from "/shared/dom.js";
import { store } from "./store.js";

const count = (value) => (Number.isInteger(value) ? value : figure(value));

export class JobView {
  constructor(works, ended) {
    this.works = works;
    this.ended = ended;
    this.bar = element("progress", { max: 1, value: 0 });
    this.told = element("span", { class: "dim", role: "status" });
    this.stop = element("button", { onclick: () => this.ask("stop", {}) }, "Stop");
    this.node = element("div", { hidden: true }, this.bar, element("div", { class: "row" }, this.stop, this.told));
    this.seen = null;
    this.watch();
  }

  async ask(path, body) {
    try {
      this.show(await api(path, body));
      this.watch();
    } catch (error) {
      store.say(error.message, true);
    }
  }

  async watch() {
    clearTimeout(this.timer);
    const state = await api("job", {}).catch(() => null);
    if (!state) return;
    this.show(state);
    if (state.state === "running") this.timer = setTimeout(() => this.watch(), document.hidden ? 3000 : 500);
  }

  show(state) {
    if (!this.works.includes(state.work)) return;
    this.node.hidden = false;
    this.node.dataset.state = state.state;
    const { stage, done, total, note } = state.progress;
    this.bar.max = total || 1;
    if (state.state === "running" && done === undefined) this.bar.removeAttribute("value");
    else this.bar.value = state.state === "done" ? this.bar.max : done || 0;
    this.stop.disabled = state.state !== "running";
    this.told.textContent = `${state.work}: ${state.state}${stage && state.state === "running" ? `, ${stage} ${count(done)} of ${count(total)}` : ""}${note ? `, ${note}` : ""}${state.text ? `: ${state.text}` : ""}`;
    this.told.classList.toggle("bad", state.state === "failed");
    const mark = `${state.work} ${state.state}`;
    if (mark !== this.seen && state.state !== "running") this.ended(state);
    this.seen = mark;
  }
}
