// Solve system: position, velocity and acceleration of every body over time, and the force in each joint.
import { api } from "/shared/access.js";
import { choice, element } from "/shared/dom.js";
import { chart } from "./chart.js";
import { download } from "./download.js";
import { store } from "./store.js";
import { read } from "./units.js";

const ORDERS = [["", "position"], ["_s", "velocity"], ["_s2", "acceleration"]];

export function solvePanel() {
  const entry = (label, value) => element("input", { value, inputmode: "decimal", "aria-label": label });
  const [seconds, step, speed] = [entry("Duration (s)", "1"), entry("TimeStep (s)", "0.01"), entry("Angular Velocity (rad/s)", "6.28")];
  const body = choice([], { "aria-label": "body" });
  const joint = choice([], { "aria-label": "joint" });
  const place = element("div", { class: "columns", id: "solved" });
  let found = null;
  const asked = (all) => ({ seconds: read(seconds.value), step_s: read(step.value), crank_speed_rad_s: read(speed.value), all });
  const draw = () => {
    if (!found) return;
    const charts = ORDERS.map(([per, word]) => drawn(found, body.value, per, word)).filter(Boolean);
    const force = chart(`force: ${joint.value}`, "time (s)", [{ label: joint.value }], { y: joint.value === "crank torque" ? "N m" : "N" });
    place.replaceChildren(...charts, force);
    force.show([found.columns.time_s, found.forces[joint.value]]);
  };
  const solve = element("button", { id: "solve" }, "Solve System");
  solve.addEventListener("click", async () => {
    try {
      found = await api("solve", asked(false));
      fill(body, found.bodies);
      fill(joint, Object.keys(found.forces));
      draw();
      store.say("");
    } catch (error) {
      store.say(error.message, true);
    }
  });
  const all = element("button", { onclick: async () => {
    const whole = await api("solve", asked(true)).catch((error) => store.say(error.message, true));
    if (whole) download("motion.csv", table({ ...whole.columns, ...Object.fromEntries(Object.entries(whole.forces).map(([name, values]) => [`${name.replaceAll(" ", "_")}`, values])) }));
  } }, "Export as CSV");
  body.addEventListener("change", draw);
  joint.addEventListener("change", draw);
  const labelled = (text, input) => element("label", {}, text, input);
  return element("div", {}, element("div", { class: "row" }, labelled("Duration (s)", seconds), labelled("TimeStep (s)", step), labelled("Angular Velocity (rad/s)", speed), solve, all),
    element("div", { class: "row" }, labelled("body", body), labelled("joint", joint), element("span", { class: "dim" }, "joint forces of masses and gravity, without friction")), place);
}

function drawn(found, body, per, word) {
  const units = { "": ["m", "rad"], _s: ["m_s", "rad_s"], _s2: ["m_s2", "rad_s2"] }[per];
  const names = [[`${body}_x_${units[0]}`, "x"], [`${body}_y_${units[0]}`, "y"], [`${body}_angle_${units[1]}`, "angle"]].filter(([name]) => found.columns[name]);
  if (!names.length) return null;
  const made = chart(`${word} of ${body}`, "time (s)", names.map(([name, label]) => ({ label: `${label} (${(name.includes("rad") ? units[1] : units[0]).replace("_", "/")})` })), { height: 190 });
  made.show([found.columns.time_s, ...names.map(([name]) => found.columns[name])]);
  return made;
}

function fill(select, names) {
  const before = select.value;
  select.replaceChildren(...names.map((name) => element("option", { value: name }, name)));
  if (names.includes(before)) select.value = before;
}

export function table(columns) {
  const names = Object.keys(columns);
  const rows = columns[names[0]].map((_, index) => names.map((name) => columns[name][index]).join(","));
  return `${names.join(",")}\n${rows.join("\n")}\n`;
}
