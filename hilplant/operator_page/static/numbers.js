// Numeric outputs: the motor's by name, those that come first as on the thesis' screen.
import { element, figure, say } from "/shared/dom.js";

const SHOWN = ["current_a", "measured_current_a", "supply_v", "terminal_v", "motor_speed_rad_s", "crank_speed_rad_s", "crank_angle_rad",
  "load_torque_n_m", "winding_temperature_c", "park_contact", "relay_on", "relay_fast", "left_arm_rad", "right_arm_rad"];
const MORE = { crank_speed_rad_s: (w) => `${figure((w / (2 * Math.PI)) * 60)} /min`, crank_angle_rad: (a) => `${figure((a * 180) / Math.PI)}°` };

export function numbers(session) {
  const { outputs } = session.description;
  const names = [...SHOWN.filter((name) => outputs.some((each) => each.name === name)), ...outputs.map((each) => each.name).filter((name) => !SHOWN.includes(name))];
  const rows = names.map((name) => {
    const signal = outputs.find((each) => each.name === name);
    const value = element("td", { class: "figure", dataset: { output: name } });
    return { signal, value, node: element("tr", { title: signal.meaning }, element("td", {}, name), value) };
  });
  session.addEventListener("row", () => {
    for (const { signal, value } of rows) say(value, words(signal, session.samples.value(`out.${signal.name}`)));
  });
  const most = element("table", {}, ...rows.slice(0, 12).map((row) => row.node));
  const others = element("details", {}, element("summary", { class: "dim" }, "all outputs"), element("table", {}, ...rows.slice(12).map((row) => row.node)));
  return element("section", { class: "panel", "aria-label": "Numeric outputs" }, element("h2", {}, "Numeric outputs"), most, others);
}

function words(signal, value) {
  if (signal.kind === "choice") return signal.choices[value] || "-";
  if (signal.kind === "flag") return value ? "1" : "0";
  const more = MORE[signal.name];
  return figure(value, signal.unit) + (more ? `\n${more(value)}` : "");
}
