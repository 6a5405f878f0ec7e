// Design points in a table, three cells each; a point that a broken rule is about is marked with it.
import { element } from "/shared/dom.js";
import { listen } from "./field.js";
import { store } from "./store.js";
import { read, shown } from "./units.js";

export function pointsTable(location, ruled = false) {
  const body = element("tbody");
  const head = element("tr", {}, ...["", "X (m)", "Y (m)", "Z (m)"].map((text) => element("th", {}, text)));
  const table = element("table", { class: "points", dataset: { at: location.join(".") } }, element("thead", {}, head), body);
  let letters = "";
  const refresh = () => {
    const points = store.get(location) || {};
    if (Object.keys(points).join() !== letters) {
      letters = Object.keys(points).join();
      body.replaceChildren(...Object.keys(points).map((letter) => row(location, letter)));
    }
    for (const line of body.children) fill(line, location, ruled);
  };
  refresh();
  listen(table, refresh);
  return table;
}

function row(location, letter) {
  const cells = [0, 1, 2].map((axis) => {
    const input = element("input", { inputmode: "decimal", "aria-label": `${letter} ${"xyz"[axis]}`, dataset: { point: letter, axis } });
    input.addEventListener("change", () => {
      const value = read(input.value);
      if (Number.isNaN(value)) {
        store.say(`${letter}: '${input.value}' is no number`, true);
        return;
      }
      input.blur();
      store.amend([...location, letter], (point) => Object.assign([...point], { [axis]: value }));
    });
    return element("td", {}, input);
  });
  return element("tr", { dataset: { point: letter } }, element("th", {}, letter), ...cells);
}

function fill(line, location, ruled) {
  const letter = line.dataset.point;
  const point = store.get([...location, letter]) || [];
  const broken = ruled ? brokenRules(letter) : [];
  const wrong = [store.wrongAt([...location, letter]), ...broken].filter(Boolean).join("; ");
  line.title = wrong;
  [...line.querySelectorAll("input")].forEach((input, axis) => {
    if (document.activeElement !== input) input.value = shown(point[axis]) || (axis === 2 ? "0" : "");
    input.classList.toggle("wrong", Boolean(wrong));
    input.setAttribute("aria-invalid", wrong ? "true" : "false");
    input.title = wrong;
  });
}

export function brokenRules(letter) {
  const broken = (store.state.rules || []).filter((rule) => !rule.keeps && rule.points.includes(letter));
  return broken.map((rule) => `${rule.name}: ${rule.smaller} = ${rule.smaller_m.toPrecision(4)} m must be less than ${rule.greater} = ${rule.greater_m.toPrecision(4)} m; ${rule.remedy}`);
}
