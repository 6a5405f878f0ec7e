// A coefficient of the air: a number, or a table of pairs of arm angle [deg] and number, with a change between the two.
import { element } from "/shared/dom.js";
import { field, listen } from "./field.js";
import { store } from "./store.js";
import { read, shown } from "./units.js";

export function coefficient(location, label) {
  const box = element("div", { class: "coefficient", dataset: { at: location.join(".") } });
  let rows = -1;
  const refresh = () => {
    const value = store.get(location);
    const now = Array.isArray(value) ? value.length : 0;
    if (now !== rows) {
      rows = now;
      box.replaceChildren(...(now ? table(location, label, now) : single(location, label)));
    }
    box.querySelectorAll("td input").forEach((input) => {
      const { row, column } = input.dataset;
      if (document.activeElement !== input) input.value = shown(value[row][column]);
      input.classList.toggle("wrong", Boolean(store.wrongAt(location)));
      input.title = store.wrongAt(location);
    });
  };
  listen(box, refresh);
  refresh();
  return box;
}

function single(location, label) {
  const over = () => store.amend(location, (now) => [0, 90, 180].map((angle) => [angle, now ?? 0]));
  return [field(location, { label }), element("button", { onclick: over }, "over the arm's angle")];
}

function table(location, label, count) {
  const line = (row) => element("tr", {}, ...[0, 1].map((column) => element("td", {}, cell(location, row, column))),
    element("td", {}, element("button", { "aria-label": `${label}: take row ${row + 1} out`, disabled: count < 3, onclick: () => store.amend(location, (now) => now.filter((_, index) => index !== row)) }, "×")));
  const more = () => store.amend(location, (now) => [...now, [now.at(-1)[0] + 10, now.at(-1)[1]]]);
  const one = () => store.amend(location, (now) => now.reduce((sum, [, each]) => sum + each, 0) / now.length);
  return [element("table", {}, element("thead", {}, element("tr", {}, element("th", {}, "angle (deg)"), element("th", {}, label), element("th", {}, ""))),
    element("tbody", {}, ...Array.from({ length: count }, (_, row) => line(row)))),
  element("div", { class: "row" }, element("button", { onclick: more }, "+ row"), element("button", { onclick: one }, "one number, their mean"))];
}

function cell(location, row, column) {
  const input = element("input", { inputmode: "decimal", "aria-label": `${location.join(".")} ${row + 1} ${column ? "coefficient" : "angle"}`, dataset: { row, column } });
  input.addEventListener("change", () => {
    const value = read(input.value);
    if (Number.isNaN(value)) {
      store.say(`'${input.value}' is no number`, true);
      return;
    }
    input.blur();
    store.amend(location, (now) => now.map((pair, index) => (index === row ? Object.assign([...pair], { [column]: value }) : pair)));
  });
  return input;
}
