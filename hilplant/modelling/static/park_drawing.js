// A park circuit: supply, ground, the motor's terminals, and what its switches and contacts connect in each state.
import { api } from "/shared/access.js";
import { choice, element, svg } from "/shared/dom.js";

const ROWS = [["slow", "53 slow brush"], ["fast", "53b fast brush"], ["common", "31 common brush"], ["park", "53e park contact"]];
const [LEFT, RIGHT, TOP, STEP] = [105, 350, 50, 42];

export function parkDrawing(circuit) {
  const command = choice(["off", "slow", "fast"].map((each) => [each, each]), { "aria-label": "stage" });
  const closed = element("input", { type: "checkbox", "aria-label": "cam at park" });
  const phase = choice([["wiping", "wiping"], ["turning_back", "turning back"], ["parked", "parked"]], { "aria-label": "park contacts A and B" });
  const drawing = svg("svg", { class: "drawing", viewBox: "0 0 600 260", role: "img", "aria-label": `${circuit} park switch` });
  const words = element("p", { class: "dim" });
  let states = [];
  const draw = () => {
    phase.parentElement.hidden = circuit !== "depressed";
    const wanted = { command: command.value, closed: closed.checked, phase: circuit === "depressed" ? phase.value : "wiping" };
    const state = states.find((each) => Object.keys(wanted).every((key) => each[key] === wanted[key]));
    if (!state) return;
    drawing.replaceChildren(...drawn(state));
    words.textContent = told(state);
  };
  for (const input of [command, closed, phase]) input.addEventListener("change", draw);
  api("circuit", { circuit }).then((found) => { states = found; draw(); });
  const play = element("button", { onclick: () => animate([command, closed, phase, draw, circuit]) }, "slow, fast, off");
  return element("div", {}, element("div", { class: "row" },
    element("label", {}, "stage", command), element("label", {}, closed, "cam at park"), element("label", {}, "contacts A, B", phase), play), drawing, words);
}

function drawn(state) {
  const rail = (y, name, text) => [svg("line", { class: `wire ${name}`, x1: LEFT, x2: RIGHT + 20, y1: y, y2: y }), svg("text", { x: 6, y: y + 6, "font-size": 19 }, text)];
  const bottom = TOP + 4 * STEP + 6;
  const contacts = ROWS.flatMap(([key, text], index) => {
    const [y, x, lead] = [TOP + (index + 0.6) * STEP, LEFT + 40 + 62 * index, state[key]];
    const end = lead === "supply" ? 20 : lead === "ground" ? bottom : y;
    const parts = [svg("circle", { cx: x, cy: y, r: 4, class: `wire ${lead}`, "data-lead": key, "data-to": lead }),
      svg("line", { x1: x, x2: 400, y1: y, y2: y, class: `wire ${lead}` }), svg("text", { x: 404, y: y + 6, "font-size": 19 }, text)];
    if (lead === "open") parts.push(svg("line", { x1: x - 14, y1: y - 14, x2: x, y2: y, class: "wire" }));
    else parts.push(svg("line", { x1: x, y1: end, x2: x, y2: y, class: `wire ${lead}` }), svg("circle", { cx: x, cy: end, r: 3, class: `wire ${lead}` }));
    return parts;
  });
  const joined = state.joined ? [svg("line", { x1: 385, x2: 385, y1: TOP + 0.6 * STEP, y2: TOP + 3.6 * STEP, class: "way" }), svg("text", { x: 240, y: TOP + 3.3 * STEP, "font-size": 17 }, "53 and 53e joined")] : [];
  return [...rail(20, "supply", "30 supply"), ...rail(bottom, "ground", "31 ground"), ...contacts, ...joined];
}

function told(state) {
  const to = { supply: "at the supply", ground: "at ground", open: "open" };
  return ROWS.map(([key, text]) => `${text} ${to[state[key]]}`).join(", ") + (state.joined ? "; 53 joined with 53e" : "");
}

// The three stages with what the cam does after switching off, a second each.
async function animate([command, closed, phase, draw, circuit]) {
  const last = circuit === "depressed" ? [["off", false, "wiping"], ["off", true, "turning_back"], ["off", false, "parked"]] : [["off", false, "wiping"], ["off", true, "wiping"]];
  for (const [stage, cam, held] of [["slow", false, "wiping"], ["fast", false, "wiping"], ...last]) {
    [command.value, closed.checked, phase.value] = [stage, cam, held];
    draw();
    await new Promise((resolve) => setTimeout(resolve, 900));
    if (!command.isConnected) return;
  }
}
