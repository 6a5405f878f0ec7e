// A group of the description as a form, made from its schema; optional groups can be put in and taken out.
import { element } from "/shared/dom.js";
import { field, words } from "./field.js";
import { store } from "./store.js";

const LEFT_OUT = new Set(["assumed", "identified", "comment", "points_m"]);

export function form(location, options = {}) {
  const schema = store.schemaAt(location);
  const skip = new Set([...LEFT_OUT, ...(options.skip || [])]);
  const rows = Object.entries(schema.properties || {})
    .filter(([name]) => !skip.has(name) && (!options.only || options.only.includes(name)))
    .map(([name]) => part([...location, name], options));
  return rows.filter(Boolean);
}

function part(location, options) {
  const schema = store.schemaAt(location);
  if (schema.properties) return group(location, options);
  if (["number", "integer", "string", "boolean"].includes(schema.type) || schema.enum) return field(location, options.fields?.[location.at(-1)] || {});
  return null;
}

export function group(location, options = {}) {
  const schema = store.schemaAt(location);
  const legend = options.legend || words(String(location.at(-1)));
  const box = element("fieldset", { title: schema.description || "" }, element("legend", {}, legend));
  box.append(...form(location, { ...options, legend: undefined }));
  return box;
}

// A group that a bench may leave out: a button adds it with the values that it must have.
export function optionalGroup(location, start, title) {
  const box = element("div");
  let there = null;
  const refresh = () => {
    const now = Boolean(store.get(location));
    if (now === there) return;
    there = now;
    const button = now
      ? element("button", { onclick: () => store.edit(location, null) }, "take out")
      : element("button", { onclick: () => store.edit(location, start) }, "put in");
    box.replaceChildren(element("div", { class: "row" }, element("b", {}, title), button), ...(now ? [group(location, { legend: title })] : []));
  };
  refresh();
  store.addEventListener("changed", refresh);
  return box;
}
