// 3 Wiper arms, 4 wiper blades: kind, mass, points, and a drawing of each side.
import { choice, element, svg } from "/shared/dom.js";
import { field, listen } from "./field.js";
import { pointsTable } from "./points.js";
import { store } from "./store.js";

const SIDES = [["left", "Left"], ["right", "Right"]];
const KINDS = [["straight", "Straight Arm", "OABC"], ["bent", "Curved Arm", "OAB"]];

export function armsPanel() {
  return element("div", { class: "columns" }, ...SIDES.map(([side, title]) => {
    const at = ["plant", "linkage", `${side}_arm`];
    return element("section", { class: "panel" }, element("h2", {}, `${title} arm`), kind(at, title), field([...at, "mass_kg"], { label: "Mass" }), pointsTable([...at, "points_m"]),
      element("h2", {}, `${title} Arm Diagram`), partDrawing([...at, "points_m"], side, "arm"), element("p", { class: "dim" }, "From the pivot O of its rocker; the last point carries the blade."));
  }));
}

export function bladesPanel() {
  return element("div", { class: "columns" }, ...SIDES.map(([side, title]) => {
    const at = ["plant", "linkage", `${side}_blade`];
    return element("section", { class: "panel" }, element("h2", {}, `${title} blade`), field([...at, "mass_kg"], { label: "Mass" }), pointsTable([...at, "points_m"]),
      element("h2", {}, `${title} Blade Diagram`), partDrawing([...at, "points_m"], side, "blade"), element("p", { class: "dim" }, "From the joint O that holds it to its tips A and B."));
  }));
}

function kind(at, title) {
  const select = choice(KINDS.map(([name, text]) => [name, text]), { "aria-label": `${title} arm type` });
  const refresh = () => { select.value = store.get([...at, "kind"]) || ""; };
  select.addEventListener("change", () => {
    const [chosen, , letters] = KINDS.find(([name]) => name === select.value);
    store.amend(at, (now) => {
      const last = Object.values(now.points_m).at(-1);
      const points = Object.fromEntries([...letters].map((letter, index) => [letter, now.points_m[letter] || between(now.points_m, last, index, letters.length)]));
      points[letters.at(-1)] = last;
      return { ...now, kind: chosen, points_m: points };
    });
  });
  listen(select, refresh);
  refresh();
  return element("div", { class: "field" }, element("span", {}, `Select ${title.toLowerCase()} arm type`), select);
}

// A point on the way from the last that is known to the arm's end, where the other kind has one more.
function between(points, last, index, count) {
  const before = Object.values(points).at(-2) || [0, 0, 0];
  const share = 1 / (count - index);
  return before.map((value, axis) => Number((value + (last[axis] - value) * share).toFixed(4)));
}

function partDrawing(at, side, part) {
  const drawing = svg("svg", { class: "drawing", role: "img", "aria-label": `${side} ${part}` });
  const refresh = () => {
    const points = Object.entries(store.get(at) || {}).filter(([, point]) => Array.isArray(point));
    if (points.length < 2) return;
    const order = part === "blade" ? ["A", "O", "B"].filter((letter) => points.some(([each]) => each === letter)).map((letter) => points.find(([each]) => each === letter)) : points;
    const [xs, ys] = [points.map(([, [x]]) => x), points.map(([, [, y]]) => y)];
    const size = Math.max(Math.max(...xs) - Math.min(...xs), 0.1);
    const tall = Math.max(Math.max(...ys) - Math.min(...ys), 0.16 * size);
    drawing.setAttribute("viewBox", [Math.min(...xs) - 0.08 * size, -(Math.max(...ys) + Math.min(...ys)) / 2 - tall * 0.9, 1.16 * size, tall * 1.8].join(" "));
    const line = svg("path", { class: `${part} ${side}`, d: `M${order.map(([, [x, y]]) => `${x},${-y}`).join(" L")}` });
    const joints = points.flatMap(([letter, [x, y]]) => [svg("circle", { cx: x, cy: -y, r: 0.012 * size, class: "pivot" }), svg("text", { x: x + 0.018 * size, y: -y - 0.018 * size, "font-size": 0.04 * size }, letter)]);
    drawing.replaceChildren(line, ...joints);
  };
  listen(drawing, refresh);
  refresh();
  return drawing;
}
