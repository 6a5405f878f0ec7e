// The model as the server has it: read, changed value by value, undone. Every widget listens to its "changed".
import { api } from "/shared/access.js";

const key = (location) => location.join(".");

class Store extends EventTarget {
  constructor() {
    super();
    this.done = Promise.resolve(true);
  }

  async load() {
    this.schema = await api("schema", {});
    this.take(await api("model"));
  }

  take(state) {
    this.state = state;
    this.dispatchEvent(new Event("changed"));
  }

  // Ask for a change after those that are under way: each is made to the version that the one before gave.
  change(path, body = {}) {
    return this.after(path, () => body);
  }

  after(path, body) {
    this.done = this.done.then(() => this.send(path, body));
    return this.done;
  }

  // What the server refuses is said, and the widgets show what holds.
  async send(path, body) {
    try {
      this.take(await api(path, { version: this.state.version, ...body() }));
      this.say("");
      return true;
    } catch (error) {
      this.say(error.message, true);
      this.dispatchEvent(new Event("changed"));
      return false;
    }
  }

  edit(location, value) {
    return this.change("edit", { location, value });
  }

  // Edit a part of a value: `made` is given the value as the changes under way have left it, and returns the new one.
  amend(location, made) {
    return this.after("edit", () => ({ location, value: made(this.get(location)) }));
  }

  say(text, wrong = false) {
    this.dispatchEvent(new CustomEvent("said", { detail: { text, wrong } }));
  }

  get(location) {
    return location.reduce((data, step) => (data === null || data === undefined ? undefined : data[step]), this.state.values);
  }

  // The text of what is wrong with exactly this value, or with a group of which it is one of the points that matter.
  wrongAt(location) {
    const found = this.state.problems.filter((each) => each.severity === "error" && key(each.location) === key(location));
    return found.map((each) => each.text).join("; ");
  }

  wrongWithin(location) {
    return this.state.problems.filter((each) => key(each.location.slice(0, location.length)) === key(location));
  }

  isInherited(location) {
    return this.state.inherited[key(location.slice(0, 2))];
  }

  // What the schema says of a value: groups are walked, and of several kinds the one is taken that the value has.
  schemaAt(location) {
    let node = this.schema.bench;
    let value = this.state.values;
    for (const step of location) {
      node = this.option(node, value);
      node = (node && node.properties && node.properties[step]) || (node && node.additionalProperties) || null;
      value = value === null || value === undefined ? undefined : value[step];
      if (!node || node === true) return {};
    }
    return this.option(node, value) || {};
  }

  option(node, value) {
    const options = node && (node.anyOf || node.oneOf);
    if (!options) return node;
    const described = node.description ? { description: node.description, default: node.default, "x-unit": node["x-unit"] } : {};
    const groups = options.filter((each) => each.properties);
    const fits = (each) => !each.properties.model || !value || each.properties.model.const === value.model;
    const chosen = groups.find(fits) || groups[0] || options.find((each) => each.type !== "null" && each.type !== "string") || options[0];
    return { ...chosen, ...described };
  }
}

export const store = new Store();
