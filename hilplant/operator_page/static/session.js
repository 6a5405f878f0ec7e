// The page's connection with a run: newest rows, who has the lead, whether what is seen is still alive.
import { Link } from "/shared/link.js";
import { Samples } from "./samples.js";

const STALE_MS = 500;
// Texts and controls are written anew no more often than they can be read.
const ROW_MS = 90;
// The least and greatest of each stretch: about a pixel of a chart.
const KEPT_POINTS = 1200;

export class Session extends EventTarget {
  // Events: sample (a block has come), row (the same, ten times a second), state, events, stale (detail: words, "" when alive again), chosen.
  constructor(description) {
    super();
    this.description = description;
    this.samples = new Samples(description);
    this.state = { lead: null, asking: [], pages: 0, waveform: {} };
    this.page = 0;
    this.rateHz = 0; // the plots say how often
    this.windowS = 10;
    this.chosen = [];
    this.words = "connecting";
    this.tick = -1;
    this.tickSeen = performance.now();
    this.heardAt = performance.now();
    this.rowAt = 0;
    this.waiting = new Map();
    this.manner = "override";
    this.moved = "";
    this.faults = new Map();
    this.link = new Link();
    this.link.addEventListener("open", () => this.choose(this.chosen));
    this.link.addEventListener("closed", (event) => this.silent(event.detail));
    this.link.addEventListener("data", (event) => this.heard(event.detail));
    this.link.addEventListener("told", (event) => this.told(event.detail));
    document.addEventListener("visibilitychange", () => this.choose(this.chosen));
    setInterval(() => this.look(), 100);
    // A worker's clock goes on while the page is hidden, the page's own is slowed down.
    const clock = new Worker("alive.js");
    clock.onmessage = () => this.link.say("alive");
  }

  get leads() {
    return this.page !== 0 && this.state.lead === this.page;
  }

  // Controls act: this page has the lead, and what it shows is alive.
  get acts() {
    return this.leads && this.words === "";
  }

  // A recording: its name and times, undefined for a run.
  get recorded() {
    return this.state.recorded;
  }

  get every() {
    return Math.max(1, Math.floor((this.windowS / this.description.step_s) * 2 / KEPT_POINTS));
  }

  // Do something for which the page must have the lead; says in the note what came of it. True where it was done.
  async command(wanted, more, words) {
    try {
      const { tick } = await this.link.ask(wanted, more);
      this.note(`${words}${tick === undefined ? "" : `, applied at tick ${tick}`}`);
      return true;
    } catch (error) {
      this.note(`${words}: refused: ${error.message}`, true);
      return false;
    }
  }

  note(words, wrong = false) {
    this.dispatchEvent(new CustomEvent("note", { detail: { words, wrong } }));
  }

  async stalk(move) {
    if (!this.acts) return;
    if (await this.command("stalk", { move }, `stalk ${move}`) && !["flick", "wash"].includes(move)) this.moved = move;
  }

  heard(block) {
    if (block[0] === 2) {
      this.waiting.get(block[1])?.(block);
      this.waiting.delete(block[1]);
      return;
    }
    this.heardAt = performance.now();
    this.samples.take(block);
    const tick = this.samples.row[0];
    if (tick !== this.tick) {
      this.tick = tick;
      this.tickSeen = performance.now();
      this.say("");
    }
    this.dispatchEvent(new Event("sample"));
    if (this.heardAt - this.rowAt < ROW_MS) return;
    this.rowAt = this.heardAt;
    this.dispatchEvent(new Event("row"));
  }

  told(message) {
    if (message.told === "hello") {
      this.page = message.page;
      this.dispatchEvent(new CustomEvent("events", { detail: message.events }));
    } else if (message.told === "state") {
      this.state = message;
      this.dispatchEvent(new Event("state"));
    } else if (message.told === "events") {
      this.dispatchEvent(new CustomEvent("events", { detail: message.events }));
    } else if (message.told === "faults") {
      this.faults = new Map(message.faults.map((each) => [each.fault, each.words]));
      this.dispatchEvent(new Event("faults"));
    } else {
      this.dispatchEvent(new CustomEvent(message.told, { detail: message }));
    }
  }

  look() {
    if (document.hidden || this.recorded) {
      this.tickSeen = performance.now();
      return;
    }
    if (performance.now() - this.tickSeen > STALE_MS && this.words === "") this.silent("the loop stands still");
  }

  silent(words) {
    this.page = this.link.open ? this.page : 0;
    this.say(words);
  }

  say(words) {
    if (words === this.words) return;
    this.words = words;
    this.dispatchEvent(new CustomEvent("stale", { detail: words }));
    this.dispatchEvent(new Event("state"));
    if (this.samples.timeS) this.dispatchEvent(new Event("row")); // the controls go off with the last row: no other comes
  }

  // Choose the signals of all charts; nothing is sent while the page is hidden.
  async choose(names) {
    this.chosen = names;
    if (!this.link.open) return;
    const rate = document.hidden ? 0 : this.rateHz;
    try {
      const { selection } = await this.link.ask("view", { signals: names, every: this.every, rate });
      this.samples.choose(names, selection, KEPT_POINTS);
      this.tickSeen = performance.now();
      this.dispatchEvent(new Event("chosen"));
      if (!rate || !names.length) return;
      if (!this.samples.timeS) await new Promise((seen) => { this.addEventListener("row", seen, { once: true }); });
      const now = this.samples.timeS;
      const block = await this.stretch(names, now - this.windowS, 1e9, (KEPT_POINTS * 3) / 4);
      if (this.samples.number === selection) this.samples.prepend(block);
    } catch (error) {
      this.dispatchEvent(new CustomEvent("wrong", { detail: error.message }));
    }
  }

  // Ask for a stretch of the past, as finely as `points` allow.
  stretch(names, fromS, toS, points) {
    const request = { signals: names, from_s: fromS, to_s: toS, points: Math.round(points) };
    const asked = this.link.ask("stretch", request);
    const id = this.link.number;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, resolve);
      asked.catch((error) => {
        this.waiting.delete(id);
        reject(error);
      });
    });
  }
}
