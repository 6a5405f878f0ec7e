// 1 Wiper motor: type, parameters, diagram, and the motor alone at a torque and a voltage.
import { api } from "/shared/access.js";
import { choice, element, figure } from "/shared/dom.js";
import { chart } from "./chart.js";
import { upload } from "./download.js";
import { field, listen } from "./field.js";
import { form, group, optionalGroup } from "./form.js";
import { libraryChoice } from "./library.js";
import { parkDrawing } from "./park_drawing.js";
import { store } from "./store.js";
import { read } from "./units.js";

const MOTOR = ["plant", "motor"];
const SWITCH = ["plant", "park_switch"];
const TYPES = [["digital", "Digital Park Switch"], ["mechanical", "Mechanical Park Switch"], ["depressed", "Depressed Mechanical Park Switch"]];

export function motorPanel() {
  return element("div", { class: "columns" },
    element("section", { class: "panel" }, element("h2", {}, "Motor"), libraryChoice("motor", "motors"), readings(), parameters()),
    element("section", { class: "panel" }, element("h2", {}, "Park switch"), motorType(), diagram(), reverse(), ...form(SWITCH, { skip: ["circuit", "reverse_angle_deg"] })),
    simulation(),
    element("section", { class: "panel" }, element("h2", {}, "Supply, wires, relays, heat"),
      optionalGroup(["plant", "supply"], { resistance_ohm: 0.05 }, "supply"),
      optionalGroup(["plant", "wires"], { terminal_53_ohm: 0.05 }, "wires"),
      optionalGroup(["plant", "relays"], { relay_on: { operate_ms: 5, release_ms: 5 }, relay_fast: { operate_ms: 5, release_ms: 5 } }, "relays"),
      optionalGroup(["plant", "heat"], heatStart(), "heat")));
}

function heatStart() {
  const wanted = store.schemaAt(["plant", "heat"]);
  const usual = { winding_j_k: 50, case_j_k: 400, winding_to_case_w_k: 0.5, case_to_ambient_w_k: 0.4 };
  return Object.fromEntries((wanted.required || []).map((key) => [key, usual[key] ?? 1]));
}

// 5.4: readings on a bench, a data sheet or windings make the motor; files that they name are given with them.
function readings() {
  const files = element("input", { type: "file", multiple: true, accept: ".yaml,.yml,.csv", hidden: true, "aria-label": "readings or data sheet" });
  const button = element("button", { id: "readings", title: "a YAML file as for hilplant motor, and the CSV files that it names (section 5.4)", onclick: () => files.click() }, "Motor from readings ...");
  files.addEventListener("change", async () => {
    try {
      for (const file of files.files) await upload(file);
      const name = [...files.files].map((each) => each.name).find((each) => /\.ya?ml$/i.test(each));
      if (name) await store.change("readings", { name });
      else store.say("readings are a YAML file, as for hilplant motor", true);
    } catch (error) {
      store.say(error.message, true);
    }
    files.value = "";
  });
  const errors = element("p", { class: "dim", id: "standard-errors" });
  const refresh = () => {
    const found = Object.entries(store.get([...MOTOR, "identified"])?.standard_errors || {});
    errors.textContent = found.length ? `standard errors: ${found.map(([name, value]) => `${name} ${value.toPrecision(2)}`).join(", ")}` : "";
  };
  listen(errors, refresh);
  refresh();
  return element("div", {}, button, files, errors);
}

function parameters() {
  const ratio = element("p", { class: "dim" });
  const refresh = () => {
    const found = store.state.ratios;
    if (!found) return;
    const said = found.constant_v_s_in_order && found.resistance_ohm_in_order && found.inductance_henry_in_order;
    ratio.textContent = `K fast / K slow ${figure(found.constant_v_s_ratio)}, R ${figure(found.resistance_ohm_ratio)}, L ${figure(found.inductance_henry_ratio)}: `
      + (said ? "(3.32) holds, the fast brush has fewer turns" : "against (3.32): R, L and K of the fast brush must be below those of the slow one");
    ratio.classList.toggle("bad", !said);
  };
  const brush = (key, title) => group([...MOTOR, key], { legend: title, fields: { constant_v_s: { label: "K", prefer: "V/rpm" }, resistance_ohm: { label: "R" }, inductance_henry: { label: "L" } } });
  const box = element("div", {}, brush("fast", "Fast"), brush("slow", "Slow"), ratio,
    ...form(MOTOR, { skip: ["slow", "fast", "source"], fields: { inertia_kg_m2: { label: "J" }, damping_n_m_s: { label: "b_m" } } }));
  listen(ratio, refresh);
  refresh();
  return box;
}

function motorType() {
  const select = choice(TYPES, { "aria-label": "motor type" });
  const refresh = () => { select.value = store.get([...SWITCH, "circuit"]) || "digital"; };
  select.addEventListener("change", () => {
    const circuit = select.value;
    store.amend(SWITCH, ({ reverse_angle_deg: back, ...rest }) => ({ ...rest, circuit, ...(circuit === "depressed" ? { reverse_angle_deg: back ?? 11.46 } : {}) }));
  });
  listen(select, refresh);
  refresh();
  return element("div", { class: "stacked" }, element("span", {}, "Select motor type"), select);
}

function diagram() {
  const place = element("div", { hidden: true });
  let circuit = "";
  const refresh = () => {
    const now = store.get([...SWITCH, "circuit"]) || "digital";
    if (place.hidden || now === circuit) return;
    circuit = now;
    place.replaceChildren(parkDrawing(now));
  };
  const button = element("button", { onclick: () => { place.hidden = !place.hidden; circuit = ""; refresh(); } }, "Display motor diagram");
  listen(place, refresh);
  return element("div", {}, button, place);
}

function reverse() {
  const place = element("div");
  const refresh = () => {
    const there = store.get([...SWITCH, "circuit"]) === "depressed";
    if (there === (place.dataset.there === "1")) return;
    place.dataset.there = there ? "1" : "0";
    place.replaceChildren(...(there ? [field([...SWITCH, "reverse_angle_deg"], { label: "Reverse", prefer: "rad" })] : []));
  };
  listen(place, refresh);
  refresh();
  return place;
}

function simulation() {
  const entry = (key, label, value) => [key, element("input", { value, inputmode: "decimal", "aria-label": label, dataset: { key } }), label];
  const entries = [entry("torque_n_m", "Torque (N m), at the gear's output", "0.05"), entry("voltage_v", "Voltage (V)", "13.5"), entry("on_s", "slow at (s)", "1"), entry("fast_s", "fast at (s)", "2"), entry("off_s", "off at (s)", "3"), entry("end_s", "end (s)", "4")];
  const switching = element("input", { type: "checkbox", "aria-label": "include switching system" });
  const current = chart("Current Plot", "time (s)", [{ label: "current" }], { y: "Current (A)" });
  const velocity = chart("Velocity Plot", "time (s)", [{ label: "velocity", colour: "s2" }], { y: "Velocity (rad/s)" });
  const table = element("table", { id: "motor-settled" });
  const button = element("button", { id: "simulate-motor" }, "Simulate");
  button.addEventListener("click", async () => {
    button.disabled = true;
    store.say("simulating; the first time the step is compiled, up to a minute");
    try {
      const asked = Object.fromEntries(entries.map(([key, input]) => [key, read(input.value)]));
      const found = await api("motor", { ...asked, switching: switching.checked });
      current.show([found.time_s, found.current_a]);
      velocity.show([found.time_s, found.output_speed_rad_s]);
      table.replaceChildren(...settled(found));
      store.say("");
    } catch (error) {
      store.say(error.message, true);
    }
    button.disabled = false;
  });
  return element("section", { class: "panel" }, element("h2", {}, "Motor simulation"),
    ...entries.map(([, input, label]) => element("div", { class: "field" }, element("span", {}, label), input)),
    element("label", {}, switching, "Include switching system? (park switch, supply, wires, relays of this bench)"),
    element("div", { class: "row" }, button, element("span", { class: "dim" }, "the torque is a brake: it holds at rest")), table, current, velocity);
}

function settled(found) {
  const head = element("tr", {}, ...["", "current (A)", "motor (rad/s)", "output (rad/s)"].map((text) => element("th", {}, text)));
  const row = (name, point, mode, kind) => element("tr", { dataset: { mode, kind } }, element("th", {}, name),
    ...["current_a", "motor_speed_rad_s", "output_speed_rad_s"].map((key) => element("td", { class: "figure", dataset: { key, value: point[key] } }, point[key].toPrecision(6))));
  return [head, ...["slow", "fast"].flatMap((mode) => [row(`${mode}, simulated`, found.settled[mode], mode, "settled"), row(`${mode}, closed form (3.33)`, found.closed_form[mode], mode, "closed_form")])];
}
