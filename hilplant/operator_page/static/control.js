// One input of the plant: what is requested, what the plant has (confirmed), and who commands it.
import { choice, element, figure, say } from "/shared/dom.js";

const OWNER_CLASS = { hand: "warn", safe: "bad", scenario: "good" };

export class Control {
  constructor(session, signal, label = signal.name) {
    this.session = session;
    this.signal = signal;
    this.requested = null;
    this.confirmed = element("span", { class: "figure confirmed", title: "what the plant has" }, "-");
    this.owner = element("span", { class: "tag owner", title: "who commands this input" });
    this.release = element("button", { class: "small release", title: "let go: back to scenario or bus", onclick: () => this.letGo() }, "release");
    this.pending = element("span", { class: "tag warn pending", hidden: true });
    this.field = this.makeField();
    this.node = element("div", { class: "control", dataset: { input: signal.name }, title: signal.meaning },
      element("span", { class: "label" }, label), this.field, this.confirmed, this.owner, this.release, this.pending);
    session.addEventListener("row", () => this.show());
  }

  makeField() {
    const { kind, names, choices, unit, minimum, maximum } = this.signal;
    if (kind === "flag") return this.buttons([[0, "off"], [1, "on"]]);
    if (kind === "choice") return this.chosen(choices.map((name, i) => [i, name]));
    if (names.length > 1) return this.chosen(names.map(([name, value]) => [value, name]));
    const number = element("input", { type: "number", step: "any", min: minimum, max: maximum, "aria-label": this.signal.name });
    number.addEventListener("change", () => this.request(number.valueAsNumber));
    number.addEventListener("keydown", (event) => { if (event.key === "Enter") this.request(number.valueAsNumber); });
    this.number = number;
    return element("span", { class: "row" }, number, element("span", { class: "dim" }, unit));
  }

  buttons(options) {
    this.options = options.map(([value, text]) => [value, element("button", { onclick: () => this.request(value) }, text)]);
    return element("span", { class: "row", role: "group", "aria-label": this.signal.name }, ...this.options.map(([, node]) => node));
  }

  chosen(options) {
    const select = choice(options, { "aria-label": this.signal.name });
    select.addEventListener("change", () => this.request(Number(select.value)));
    this.select = select;
    return select;
  }

  async request(value) {
    if (!Number.isFinite(value)) return;
    this.requested = value;
    const sent = this.signal.kind === "flag" ? value === 1 : value;
    const done = await this.session.command(this.session.manner, { values: { [this.signal.name]: sent } }, `${this.signal.name} = ${value}`);
    if (!done) this.requested = null;
  }

  async letGo() {
    this.requested = null;
    await this.session.command("release", { names: [this.signal.name] }, `${this.signal.name} released`);
  }

  words(value) {
    const { kind, names, choices, unit } = this.signal;
    if (kind === "flag") return value ? "on" : "off";
    if (kind === "choice") return choices[value] || "?";
    const named = names.find(([, number]) => number === value);
    return named ? named[0] : figure(value, unit);
  }

  show() {
    const { samples, description, acts } = this.session;
    const value = samples.value(`in.${this.signal.name}`);
    const owner = description.owners[samples.value(`owner.${this.signal.name}`)] || "?";
    say(this.confirmed, this.words(value));
    say(this.owner, owner);
    this.owner.className = `tag owner ${OWNER_CLASS[owner] || ""}`;
    const open = this.requested !== null && this.requested !== value;
    this.pending.hidden = !open;
    if (open) say(this.pending, `requested ${this.words(this.requested)}`);
    else this.requested = null;
    this.release.disabled = !acts || owner !== "hand";
    this.enable(acts, value);
  }

  enable(acts, value) {
    for (const [number, node] of this.options || []) {
      node.disabled = !acts;
      node.setAttribute("aria-pressed", String(number === value));
    }
    if (this.select) {
      this.select.disabled = !acts;
      if (this.requested === null && document.activeElement !== this.select) put(this.select, String(value));
    }
    if (this.number) {
      this.number.disabled = !acts;
      if (this.requested === null && document.activeElement !== this.number) put(this.number, String(Number(value.toPrecision(6))));
    }
  }
}

// A field that is written is laid out at once, even where its value stays.
function put(field, value) {
  if (field.value !== value) field.value = value;
}
