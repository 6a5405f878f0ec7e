// Recordings: given to the page, their columns mapped, looked at, cut, and chosen for identification.
import { api } from "/shared/access.js";
import { choice, element, figure } from "/shared/dom.js";
import { chart } from "./chart.js";
import { upload } from "./download.js";
import { store } from "./store.js";
import { read } from "./units.js";

const FRAMES = /\.(blf|asc|log|trc|mf4|mdf)$/i;
const ROLES = ["time", "voltage", "current", "park", "fast", "on"];

export class Recordings {
  constructor() {
    this.rows = element("tbody");
    this.files = element("input", { type: "file", multiple: true, "aria-label": "recordings", accept: ".csv,.txt,.parquet,.mf4,.mdf,.hilrec,.blf,.asc,.log,.trc,.dbc,.arxml,.kcd,.sym,.cdd" });
    this.files.addEventListener("change", () => this.give());
    this.mapping = element("div", { class: "row" });
    this.looked = element("div");
    this.reader = choice([["", "choose ..."], ["bench", "the bus of this bench"]], { "aria-label": "what reads CAN frames" });
    this.channel = element("input", { "aria-label": "channel of the log", placeholder: "channel, if several", size: 16 });
    this.frames = element("div", { class: "row", hidden: true, id: "frames" }, element("label", {}, "CAN frames are read by", this.reader), this.channel, element("span", { class: "dim" }, "another database: give its file above"));
    this.columns = {};
    const head = element("tr", {}, ...["recording", "use", "screen", "mode", ""].map((text) => element("th", {}, text)));
    this.node = element("div", {}, element("div", { class: "row" }, this.files, element("span", { class: "dim" }, "CSV, Parquet, MF4, recordings, CAN logs with their database")), this.frames,
      element("table", { id: "recordings" }, element("thead", {}, head), this.rows), this.mapping, this.looked);
    this.list();
  }

  async give() {
    for (const file of this.files.files) {
      try {
        await upload(file);
      } catch (error) {
        store.say(error.message, true);
      }
    }
    this.files.value = "";
    await this.list();
  }

  async list() {
    const found = await api("recordings", {});
    const known = new Map([...this.rows.children].map((row) => [row.dataset.name, row]));
    this.rows.replaceChildren(...found.map(({ name }) => known.get(name) || this.row(name)));
    const databases = (await api("databases", {})).map(({ name }) => name);
    const fresh = databases.filter((name) => ![...this.reader.options].some((each) => each.value === name));
    this.reader.append(...fresh.map((name) => element("option", { value: name }, name)));
    if (fresh.length) this.reader.value = fresh.at(-1);
    this.frames.hidden = !databases.length && !found.some(({ name }) => FRAMES.test(name));
  }

  row(name) {
    const words = name.toLowerCase();
    const use = choice([["fit", "fit"], ["judge", "held out"], ["no", "leave out"]], { "aria-label": `use of ${name}` });
    const screen = choice([["dry", "dry"], ["tacky", "tacky"], ["wet", "wet"]], { "aria-label": `screen of ${name}` });
    const mode = choice([["", "as the column says"], ["slow", "slow"], ["fast", "fast"]], { "aria-label": `mode of ${name}` });
    if (words.includes("wet")) screen.value = "wet";
    const look = element("button", { onclick: () => this.look(name, mode.value) }, "look");
    return element("tr", { dataset: { name } }, element("td", {}, name), ...[use, screen, mode, look].map((each) => element("td", {}, each)));
  }

  // What is chosen, as the server wants it: names with screen and mode.
  chosen(use) {
    return [...this.rows.children].map((row) => ({ name: row.dataset.name, values: [...row.querySelectorAll("select")].map((each) => each.value) }))
      .filter(({ values }) => values[0] === use).map(({ name, values }) => ({ name, screen: values[1], mode: values[2] }));
  }

  // What reads the frames of CAN logs, and the channel that is taken; empty where there are none.
  source() {
    return this.reader.value && (this.channel.value.trim() ? `${this.reader.value}@${this.channel.value.trim()}` : this.reader.value);
  }

  // role=NAME[unit],... as the commands take it; empty where every column is found by its name.
  mapped() {
    return Object.entries(this.columns).filter(([, text]) => text).map(([role, text]) => `${role}=${text}`).join(",");
  }

  async look(name, mode) {
    try {
      this.map(name, mode, await api("columns", { name, frames: this.source() }));
      this.draw(name, mode, await api("look", { name, mode, columns: this.mapped(), frames: this.source() }));
      store.say("");
    } catch (error) {
      store.say(error.message, true);
      this.looked.replaceChildren(element("p", { class: "bad" }, error.message));
    }
  }

  map(name, mode, columns) {
    const options = [["", "by its name"], ...columns.map((each) => [each.name, `${each.name}${each.unit ? ` [${each.unit}]` : ""}`])];
    this.mapping.replaceChildren(...ROLES.map((role) => {
      const select = choice(options, { "aria-label": `column of ${role}` });
      const unit = element("input", { "aria-label": `unit of ${role}`, placeholder: "unit", size: 4 });
      const [, column, said] = (this.columns[role] || "").match(/^(.*?)(?:\[(.*)\])?$/) || [];
      select.value = column || "";
      unit.value = said || "";
      const changed = () => {
        this.columns[role] = select.value ? `${select.value}${unit.value ? `[${unit.value}]` : ""}` : "";
        this.look(name, mode);
      };
      select.addEventListener("change", changed);
      unit.addEventListener("change", changed);
      return element("label", {}, role, select, unit);
    }));
  }

  draw(name, mode, found) {
    const [from, to] = [0, found.seconds].map((value) => element("input", { value: figure(value), inputmode: "decimal", size: 7 }));
    const cut = element("button", { onclick: async () => {
      try {
        await api("cut", { name, mode, columns: this.mapped(), frames: this.source(), from_s: read(from.value), to_s: read(to.value) });
        await this.list();
      } catch (error) {
        store.say(error.message, true);
      }
    } }, "cut out as a recording of its own");
    const charts = [["voltage_v", "voltage (V)"], ["current_a", "current (A)"], ["park_steps", "park closings, the staircase"]].map(([key, title], index) => {
      const made = chart(`${name}: ${title}`, "time (s)", [{ label: title, colour: `s${index + 1}` }], { height: 140 });
      made.show([found.time_s, found[key]]);
      return made;
    });
    const said = [...found.findings.map((each) => element("p", { class: each.fatal ? "bad" : "warn" }, each.text)), ...found.notes.map((text) => element("p", { class: "dim" }, text))];
    this.looked.replaceChildren(element("div", { class: "row" }, `${found.samples} samples, ${figure(found.seconds)} s; keep from`, from, "to", to, "s", cut), ...charts, ...said);
  }
}
