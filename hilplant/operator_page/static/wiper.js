// The wiper as it stands: linkage, arms and blades from the bench's own geometry, on a screen that is dry or wet.
import { element, figure, say, svg } from "/shared/dom.js";

const COLOUR = { crank: "var(--s2)", link: "var(--dim)", arm: "var(--s1)", blade: "var(--text)" };
const WIDTH = { crank: 0.016, link: 0.01, arm: 0.014, blade: 0.02 };
const STATES = [[0.25, "dry"], [0.75, "tacky"], [Infinity, "wet"]];

export function wiper(session) {
  const { wiper: shape } = session.description;
  const box = bounds(shape);
  const glass = svg("path", { d: glassOf(shape), class: "glass" });
  const lines = shape.lines.map((line) => ({ ...line, node: svg("polyline", { fill: "none", stroke: COLOUR[line.part], "stroke-width": WIDTH[line.part], "stroke-linecap": "round", "stroke-linejoin": "round" }) }));
  const pivots = shape.pivots.map(([x, y]) => svg("circle", { cx: x, cy: -y, r: 0.014, fill: "var(--panel)", stroke: "var(--text)", "stroke-width": 0.006 }));
  const order = ["blade", "arm", "link", "crank"];
  const drawn = [...lines].sort((a, b) => order.indexOf(a.part) - order.indexOf(b.part)).map((line) => line.node);
  const picture = svg("svg", { viewBox: box.join(" "), class: "wiper", role: "img", "aria-label": "the wiper as it stands" }, glass, ...drawn, ...pivots);
  const told = element("span", { class: "figure dim", id: "wiper-told" });
  let shown = -1;

  function draw() {
    const angle = session.samples.value("out.crank_angle_rad");
    const at = Math.round((((angle / (2 * Math.PI)) % 1) + 1) % 1 * (shape.pictures - 1));
    if (at !== shown) {
      shown = at;
      for (const line of lines) {
        const from = at * line.points * 2;
        let text = "";
        for (let i = 0; i < line.points; i += 1) text += `${line.xy[from + 2 * i]},${-line.xy[from + 2 * i + 1]} `;
        line.node.setAttribute("points", text);
      }
    }
  }

  function tell() {
    const { samples } = session;
    const angle = samples.value("out.crank_angle_rad");
    const wet = samples.value("in.screen");
    const state = STATES.find(([limit]) => wet < limit)[1];
    glass.style.fill = `color-mix(in srgb, var(--wet) ${Math.round(wet * 100)}%, var(--dry))`;
    say(told, `screen ${state}  crank ${figure((angle * 180) / Math.PI)}°  ${samples.value("out.park_contact") ? "at park" : ""}`);
  }

  session.addEventListener("sample", draw);
  session.addEventListener("row", tell);
  return element("section", { class: "panel", "aria-label": "Wiper" }, element("h2", {}, "Wiper", told), picture);
}

function all(shape) {
  return shape.lines.flatMap((line) => {
    const places = [];
    for (let i = 0; i < line.xy.length; i += 2) places.push([line.xy[i], line.xy[i + 1]]);
    return places;
  });
}

function extent(places) {
  let [left, low, right, high] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of places) {
    left = Math.min(left, x);
    right = Math.max(right, x);
    low = Math.min(low, y);
    high = Math.max(high, y);
  }
  return { left, low, right, high };
}

function bounds(shape) {
  const { left, low, right, high } = extent(all(shape));
  const edge = 0.08;
  return [left - edge, -high - edge, right - left + 2 * edge, high - low + 2 * edge];
}

// The glass: a little wider than what the blades sweep.
function glassOf(shape) {
  const blades = { lines: shape.lines.filter((line) => line.part === "blade") };
  if (!blades.lines.length) return "";
  const { left, low, right, high } = extent(all(blades));
  const slant = 0.12 * (right - left);
  return `M${left - 0.05},${-low + 0.04} L${left + slant},${-high - 0.05} L${right - slant},${-high - 0.05} L${right + 0.05},${-low + 0.04} Z`;
}
