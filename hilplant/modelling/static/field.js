// One value of the model as a row: name, input by its schema, unit to choose, what is wrong with it.
import { choice, element, say } from "/shared/dom.js";
import { store } from "./store.js";
import { UNITS, read, shown } from "./units.js";

const chosenUnits = new Map();

export function words(name) {
  const plain = name.replace(/_(kg_m2|n_m_s|rad_s|mm_s|v_s|n_m|m_s|henry|ohm|deg|rad|m2|kg|ms|n|m|s|v|a|j_k|w_k|percent_k|c)$/, "");
  return plain.replaceAll("_", " ");
}

export function field(location, options = {}) {
  const name = String(location[location.length - 1]);
  const schema = store.schemaAt(location);
  const note = element("span", { class: "note", hidden: true });
  const control = schema.enum || options.choices ? selected(location, options.choices || schema.enum.map((each) => [each, each]))
    : schema.type === "boolean" ? ticked(location)
      : schema.type === "string" ? written(location) : number(location, schema, options);
  const label = element("span", { class: "name", title: schema.description || "" }, options.label || words(name));
  const row = element("div", { class: "field", dataset: { at: location.join(".") } }, label, control.node, note);
  const refresh = () => {
    if (!row.isConnected && row.dataset.seen) return;
    const wrong = store.wrongAt(location);
    control.refresh(store.get(location));
    control.input.classList.toggle("wrong", Boolean(wrong));
    row.classList.toggle("inherited", Boolean(store.isInherited(location)));
    row.title = store.isInherited(location) ? `from ${store.isInherited(location)}` : "";
    say(note, wrong);
    note.hidden = !wrong;
  };
  refresh();
  listen(row, refresh);
  return row;
}

// Follow the model as long as a node is in the page.
export function listen(node, refresh) {
  const heard = () => {
    if (node.isConnected) refresh();
    else if (node.dataset.left) store.removeEventListener("changed", heard);
    else node.dataset.left = "1";
  };
  store.addEventListener("changed", heard);
}

function number(location, schema, options) {
  const fileUnit = options.unit || schema["x-unit"] || "";
  const units = UNITS[fileUnit] || [[fileUnit, 1]];
  const key = location.join(".");
  const preferred = chosenUnits.get(key) || options.prefer || units[0][0];
  const unit = units.length > 1
    ? choice(units.map(([name]) => [name, name]), { class: "unit", "aria-label": "unit" })
    : element("span", { class: "unit" }, fileUnit);
  if (units.length > 1) unit.value = preferred;
  const factor = () => (units.find(([name]) => name === unit.value) || units[0])[1];
  const standard = schema.default;
  const input = element("input", { inputmode: "decimal", "aria-label": key, placeholder: typeof standard === "number" ? shown(standard, factor()) : "" });
  const refresh = (value) => {
    const text = shown(value, factor());
    if (document.activeElement !== input || input.dataset.sent) input.value = text;
    delete input.dataset.sent;
  };
  input.addEventListener("change", () => {
    const blank = input.value.trim() === "";
    const value = blank ? null : read(input.value, factor());
    if (Number.isNaN(value)) {
      input.classList.add("wrong");
      store.say(`${words(location[location.length - 1])}: '${input.value}' is no number`, true);
      return;
    }
    input.dataset.sent = "1";
    store.edit(location, value);
  });
  if (units.length > 1) {
    unit.addEventListener("change", () => {
      chosenUnits.set(key, unit.value);
      input.value = shown(store.get(location), factor());
    });
  }
  return { node: element("span", {}, input, " ", unit), input, refresh };
}

function selected(location, options) {
  const input = choice(options, { "aria-label": location.join(".") });
  input.addEventListener("change", () => store.edit(location, input.value));
  return { node: input, input, refresh: (value) => { input.value = value ?? ""; } };
}

function ticked(location) {
  const input = element("input", { type: "checkbox", "aria-label": location.join(".") });
  input.addEventListener("change", () => store.edit(location, input.checked));
  return { node: input, input, refresh: (value) => { input.checked = Boolean(value); } };
}

function written(location) {
  const input = element("input", { "aria-label": location.join(".") });
  input.addEventListener("change", () => store.edit(location, input.value));
  return { node: input, input, refresh: (value) => { if (document.activeElement !== input) input.value = value ?? ""; } };
}
