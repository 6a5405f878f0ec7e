// The plots: charts under each other on one time axis; window, pause, zoom, cursors, signals by choice.
import { choice, element, figure, say } from "/shared/dom.js";
import { Chart } from "./chart.js";
import { stretchOf } from "./samples.js";

const WINDOWS_S = [1, 2, 5, 10, 20, 30, 60];
// 32: some come two to a frame, at least 29 are drawn. 60 is what most screens show.
const RATES_HZ = [32, 60];
const FIRST = [["current_a"], ["park_contact", "out.relay_on"], ["crank_angle_rad", "crank_speed_rad_s"]];

export class Plots {
  constructor(session) {
    this.session = session;
    const { inputs, outputs, status } = session.description;
    this.signals = new Map();
    for (const [prefix, group] of [["in.", inputs], ["status.", status], ["out.", outputs]]) {
      for (const signal of group) {
        this.signals.set(prefix + signal.name, signal);
        if (prefix === "out." || !outputs.some((each) => each.name === signal.name)) this.signals.set(signal.name, signal);
      }
    }
    this.cursors = { A: null, B: null };
    this.cursorsOn = false;
    this.frozen = null;
    this.asked = false;
    this.drawnAt = 0;
    this.cost = 0;
    this.stats = { draws: 0, latencyMs: [] };
    this.charts = [];
    this.body = element("div", { class: "charts" });
    this.window = choice(WINDOWS_S.map((s) => [s, `${s} s`]), { id: "window", title: "length of the time axis", onchange: () => this.setWindow(+this.window.value) });
    this.rate = choice(RATES_HZ.map((hz) => [hz, `${hz} /s`]), { id: "rate", title: "how often the charts are drawn; 60 costs twice as much", onchange: () => this.setRate(+this.rate.value) });
    this.pauseButton = element("button", { id: "pause", title: "stop the picture, not the run (P)", onclick: () => this.togglePause() }, "Pause");
    this.cursorButton = element("button", { id: "cursors", title: "click sets A, Shift and click sets B (C)", onclick: () => this.toggleCursors() }, "Cursors");
    this.note = element("span", { class: "figure dim", id: "cursor-note" });
    this.node = element("section", { class: "panel plots", "aria-label": "Plots" },
      element("h2", {}, "Plots", element("span", { class: "row" }, this.note,
        element("label", {}, "window", this.window), this.rate, this.pauseButton, this.cursorButton,
        element("button", { id: "add-chart", title: "another chart", onclick: () => this.add([]) }, "+ chart"))),
      this.body);
    session.addEventListener("sample", () => this.refresh());
    session.addEventListener("row", () => this.charts.forEach((chart) => chart.tell()));
    session.addEventListener("wrong", (event) => say(this.note, event.detail));
    addEventListener("themechange", () => this.charts.forEach((chart) => chart.build()));
    this.set({ charts: FIRST, windowS: 10, rateHz: RATES_HZ[0] });
  }

  signal(name) {
    return this.signals.get(name) || { name, unit: "", meaning: name, kind: "real", choices: [] };
  }

  newest(name) {
    return this.session.samples.value(name);
  }

  words(signal, value) {
    if (signal.kind === "choice") return signal.choices[value] || "-";
    return signal.kind === "flag" || signal.kind === "count" ? String(value) : figure(value, signal.unit);
  }

  // Layouts are saved and restored by these.
  get() {
    return { charts: this.charts.map((chart) => chart.names), windowS: this.session.windowS, rateHz: this.session.rateHz };
  }

  set({ charts, windowS, rateHz }) {
    this.charts = [];
    this.body.replaceChildren();
    charts.slice(0, 6).forEach((names) => this.add(names.filter((name) => this.signals.has(name)), false));
    this.session.rateHz = this.rate.value = RATES_HZ.includes(rateHz) ? rateHz : RATES_HZ[0];
    this.setWindow(WINDOWS_S.includes(windowS) ? windowS : 10);
  }

  add(names, choose = true) {
    const chart = new Chart(this, this.session, names);
    this.charts.push(chart);
    this.body.append(chart.node);
    if (choose) this.choose();
  }

  remove(chart, name) {
    chart.names = chart.names.filter((each) => each !== name);
    if (!chart.names.length && this.charts.length > 1) {
      this.charts = this.charts.filter((each) => each !== chart);
      chart.node.remove();
      chart.plot.destroy();
    } else chart.build();
    this.choose();
  }

  picker(chart) {
    const names = [...this.signals.keys()].filter((name) => !chart.names.includes(name));
    const select = choice([["", "+ signal"], ...names.map((name) => [name, name])], { class: "small", "aria-label": "add a signal" });
    select.addEventListener("change", () => {
      chart.names = [...chart.names, select.value];
      chart.build();
      this.choose();
    });
    return select;
  }

  choose() {
    this.session.chosen = [...new Set(this.charts.flatMap((chart) => chart.names))];
    if (this.session.recorded) {
      this.freeze(...this.range());
      return;
    }
    this.frozen = null;
    this.showPause();
    this.session.choose([...new Set(this.charts.flatMap((chart) => chart.names))]);
  }

  setWindow(seconds) {
    this.session.windowS = seconds;
    this.window.value = seconds;
    this.choose();
  }

  setRate(hz) {
    this.session.rateHz = hz;
    this.session.choose(this.session.chosen);
  }

  // Paused or zoomed in, a stretch of the past is shown as finely as the screen allows.
  async freeze(from, to) {
    this.frozen = { range: [from, to], data: null };
    this.showPause();
    const names = this.session.chosen;
    try {
      const margin = (to - from) * 0.02;
      const data = stretchOf(await this.session.stretch(names, from - margin, to + margin, 4000));
      if (this.frozen?.range[0] === from) this.frozen.data = { names, data };
    } catch (error) {
      say(this.note, error.message);
    }
    this.refresh();
  }

  zoom(from, to) {
    this.freeze(from, to);
  }

  live() {
    if (this.session.recorded) {
      this.freeze(this.session.recorded.from_s, this.session.recorded.to_s);
      return;
    }
    this.frozen = null;
    this.showPause();
  }

  togglePause() {
    if (this.frozen) this.live();
    else this.freeze(...this.range());
  }

  showPause() {
    this.pauseButton.setAttribute("aria-pressed", String(this.frozen !== null));
    say(this.pauseButton, this.frozen ? "Live" : "Pause");
  }

  toggleCursors() {
    this.cursorsOn = !this.cursorsOn;
    this.cursorButton.setAttribute("aria-pressed", String(this.cursorsOn));
    if (!this.cursorsOn) this.cursors = { A: null, B: null };
    else if (!this.frozen) this.togglePause();
    this.refresh();
  }

  setCursor(name, at) {
    this.cursors[name] = at;
    this.refresh();
  }

  range() {
    if (this.frozen) return this.frozen.range;
    const { recorded } = this.session;
    if (recorded) return [recorded.from_s, recorded.to_s];
    const now = this.session.samples.timeS;
    return [now - this.session.windowS, now];
  }

  // A frame is asked for only when there is something new: each costs the browser a look at the whole page.
  refresh() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => this.frame());
  }

  frame() {
    // A machine that is slow at drawing keeps half of its time for everything else.
    const began = performance.now();
    this.asked = false;
    if (began - this.drawnAt < this.cost) {
      this.refresh();
      return;
    }
    this.draw();
    this.drawnAt = performance.now();
    this.cost = this.drawnAt - began;
  }

  draw() {
    const range = this.range();
    for (const chart of this.charts) {
      chart.draw(this.dataOf(chart.names), range);
      if (this.frozen) chart.tell();
    }
    const { A, B } = this.cursors;
    if (A !== null && B !== null) say(this.note, `A ${A.toFixed(4)} s  B ${B.toFixed(4)} s  Δt ${(B - A).toFixed(4)} s`);
    else say(this.note, A === null ? "" : `A ${A.toFixed(4)} s`);
    this.stats.draws += 1;
    if (!this.frozen && this.stats.latencyMs.length < 10000) {
      this.stats.latencyMs.push(this.session.samples.latencyMs + performance.now() - this.session.heardAt);
    }
  }

  dataOf(names) {
    const frozen = this.frozen?.data;
    if (!frozen) return this.session.samples.shown(names);
    return [frozen.data[0], ...names.map((name) => frozen.data[frozen.names.indexOf(name) + 1])];
  }
}
