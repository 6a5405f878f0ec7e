// The park circuit with its contacts as they are now, and the potentials of the motor's terminals.
import { element, figure, say, svg } from "/shared/dom.js";

const SUPPLY = "30 supply";
const GROUND = "31 ground";
// Contacts of the circuits of 3.6 and 7.1.1: name, what is common, the throws, and which of them is closed now.
const CIRCUITS = {
  digital: [
    ["ON/OFF relay", "FAST/SLOW relay", [GROUND, SUPPLY], (now) => now.on],
    ["FAST/SLOW relay", "ON/OFF relay", ["53 slow brush", "53b fast brush"], (now) => now.fast],
    ["park contact", "53e, reports only", ["open", GROUND], (now) => now.park],
  ],
  mechanical: [
    ["switch 1", SUPPLY, ["nothing", "53 slow brush", "53b fast brush"], (now) => now.position],
    ["switch 2", "53 slow brush", ["53e park contact", "nothing"], (now) => Math.min(now.position, 1)],
    ["park contact", "53e", [SUPPLY, GROUND], (now) => now.park],
  ],
  depressed: [
    ["switches 1, 3", "53 and 31 brushes", ["contacts B and A", "switch 2 and supply"], (now) => Math.min(now.position, 1)],
    ["switch 2", GROUND, ["contact B", "53 slow brush", "53b fast brush"], (now) => now.position],
    ["park contact A", "31 common brush", [SUPPLY, GROUND, "open"], (now) => now.phase],
    ["park contact B", "53 slow brush", ["switch 2", SUPPLY, "open"], (now) => now.phase],
  ],
};
const TERMINALS = [["53", "terminal_53_v"], ["53b", "terminal_53b_v"], ["53e", "terminal_53e_v"], ["31", "terminal_31_v"]];

export function circuit(session) {
  const { description, samples } = session;
  const contacts = CIRCUITS[description.circuit].map((contact, i) => drawn(contact, i));
  const height = contacts.length * 78 + 6;
  const picture = svg("svg", { viewBox: `0 0 430 ${height}`, class: "circuit", role: "img", "aria-label": `park circuit, ${description.circuit}` }, ...contacts.map((each) => each.node));
  const cells = TERMINALS.map(([name, signal]) => ({ signal, cell: element("td", { class: "figure" }), name }));
  const table = element("table", {}, ...cells.map(({ name, cell }) => element("tr", {}, element("td", {}, `terminal ${name}`), cell)));
  const words = element("p", { class: "dim" });

  session.addEventListener("row", () => {
    if (!picture.isConnected || picture.closest("[hidden]")) return;
    const on = samples.value("out.relay_on") > 0.5 ? 1 : 0;
    const fast = samples.value("out.relay_fast") > 0.5 ? 1 : 0;
    const now = { on, fast, park: samples.value("out.park_contact") > 0.5 ? 1 : 0, position: on ? 1 + fast : 0, phase: samples.value("state.park_phase") };
    contacts.forEach((contact) => contact.show(now));
    for (const { cell, signal } of cells) say(cell, figure(samples.value(`out.${signal}`), "V"));
    say(words, `armature ${figure(samples.value("out.current_a"), "A")}, ${now.on ? (now.fast ? "fast" : "slow") : "off"}, crank ${figure((samples.value("out.crank_angle_rad") * 180) / Math.PI)}°`);
  });
  return element("div", { class: "split" }, picture, element("div", {}, element("h3", {}, `${description.circuit} park switch`), table, words));
}

function drawn([name, common, throws, which], i) {
  const top = i * 78 + 4;
  const ends = throws.map((_, j) => ({ x: 250, y: top + 14 + (j * 50) / Math.max(1, throws.length - 1) }));
  const pivot = { x: 175, y: top + 39 };
  const arm = svg("line", { x1: pivot.x, y1: pivot.y, class: "arm" });
  const labels = throws.map((text, j) => svg("text", { x: 262, y: ends[j].y + 4 }, text));
  const node = svg("g", { "data-contact": name }, svg("text", { x: 0, y: top + 24, class: "strong" }, name), svg("text", { x: 0, y: top + 43, class: "dim" }, common),
    svg("line", { x1: 130, y1: pivot.y, x2: pivot.x, y2: pivot.y, class: "lead" }), svg("circle", { cx: pivot.x, cy: pivot.y, r: 4 }),
    ...ends.map((end) => svg("circle", { cx: end.x, cy: end.y, r: 4, class: "end" })), arm, ...labels);
  return {
    node,
    show(now) {
      const at = which(now);
      const end = ends[at] || { x: 240, y: pivot.y };
      arm.setAttribute("x2", end.x);
      arm.setAttribute("y2", end.y);
      node.dataset.at = throws[at] || "between";
      labels.forEach((label, j) => label.classList.toggle("live", j === at));
    },
  };
}
