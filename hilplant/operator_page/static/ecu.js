// The ECU's chart with its live state: the table that runs, drawn; the ways out of the live state with their conditions.
import { element, say, svg } from "/shared/dom.js";

const PLACES = {
  off: [1, 0], flick: [0, 0], washing: [2, 0], wash_wipes: [3, 0],
  single_wipe: [0, 1.2], slow: [1.5, 1.2], fast: [3, 1.2],
  pause_1: [-0.35, 2.3], pause_2: [0.25, 2.3], pause_3: [0.85, 2.3], pause_4: [-0.35, 3], pause_5: [0.25, 3], pause_6: [0.85, 3],
  wait: [1.6, 2.3], slow_wait: [2.5, 2.3], fast_wait: [3.4, 2.3], int_wait: [1.6, 3],
  blind: [2.5, 3], brown_out: [3.4, 3], retry: [2.5, 3.7], lockout: [3.4, 3.7],
};
const [STEP_X, STEP_Y, WIDTH, HEIGHT] = [120, 62, 92, 26];

export function ecu(session) {
  const { states, faults, rows } = session.description.ecu;
  const nodes = new Map();
  const lines = [];
  const picture = svg("svg", { viewBox: "-105 -25 680 280", class: "chart-of-ecu", role: "img", "aria-label": "chart of the ECU" });
  for (const row of rows) {
    for (const source of row.from) {
      const key = `${source} ${row.to}`;
      if (lines.some((line) => line.key === key)) continue;
      const [a, b] = [at(source), at(row.to)];
      const node = svg("path", { d: `M${a.x},${a.y} Q${(a.x + b.x) / 2 + (b.y - a.y) * 0.12},${(a.y + b.y) / 2 + (a.x - b.x) * 0.12} ${b.x},${b.y}`, class: "way" });
      lines.push({ key, source, node });
      picture.append(node);
    }
  }
  for (const name of states) {
    const { x, y } = at(name);
    const node = svg("g", { class: "state", "data-state": name }, svg("rect", { x: x - WIDTH / 2, y: y - HEIGHT / 2, width: WIDTH, height: HEIGHT, rx: 8 }),
      svg("text", { x, y: y + 4, "text-anchor": "middle" }, name));
    if (name.startsWith("pause")) node.firstChild.setAttribute("width", 66), node.firstChild.setAttribute("x", x - 33);
    nodes.set(name, node);
    picture.append(node);
  }
  const live = element("strong", { id: "ecu-live" }, "not heard");
  const fault = element("span", { class: "tag", id: "ecu-fault" });
  const ways = element("ul", { class: "ways" });
  let shown = "";

  session.addEventListener("frames", (event) => {
    const told = event.detail.ecu;
    const name = states[told.ecu_state] || "";
    const trouble = faults[told.ecu_fault] || "none";
    say(fault, `fault: ${trouble}${told.ecu_tries ? `, ${told.ecu_tries} tries` : ""}`);
    fault.className = `tag ${trouble === "none" ? "good" : "bad"}`;
    if (name === shown) return;
    shown = name;
    say(live, name || "not heard");
    nodes.forEach((node, each) => node.classList.toggle("live", each === name));
    lines.forEach(({ source, node }) => node.classList.toggle("live", source === name));
    const out = rows.filter((row) => row.from.includes(name));
    ways.replaceChildren(...out.map((row) => element("li", {}, element("b", {}, row.to), ` when ${row.when}`, row.fault ? ` (fault ${row.fault})` : "")));
  });
  return element("div", { class: "split" }, picture, element("div", {}, element("p", {}, "now: ", live, " ", fault), element("h3", {}, "leads to"), ways));
}

function at(name) {
  const [column, row] = PLACES[name] || [4, 4];
  return { x: column * STEP_X, y: row * STEP_Y };
}
