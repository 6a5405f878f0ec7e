// 2 Wiper linkages: design, points, masses, validity, drawing, space, and the motion of every body over time.
import { api } from "/shared/access.js";
import { choice, element, figure } from "/shared/dom.js";
import { field, listen } from "./field.js";
import { form } from "./form.js";
import { libraryChoice, shipped } from "./library.js";
import { pointsTable } from "./points.js";
import { solvePanel } from "./solve.js";
import { store } from "./store.js";
import { View3d } from "./view_3d.js";
import { WiperDrawing } from "./wiper_drawing.js";

const LINKAGE = ["plant", "linkage"];
const DESIGNS = [["rhd_slave_driven", "RHD Slave Driven System"], ["rhd_master_driven", "RHD Master Driven System"], ["rhd_centre_driven", "RHD Centre Driven System"],
  ["lhd_slave_driven", "LHD Slave Driven System"], ["lhd_master_driven", "LHD Master Driven System"], ["lhd_centre_driven", "LHD Centre Driven System"]];

export function linkagePanel() {
  return element("div", { class: "columns" },
    element("section", { class: "panel wide" }, element("h2", {}, "Linkage diagram"), pictures()),
    element("section", { class: "panel" }, element("h2", {}, "Design and points"), design(), pointsTable([...LINKAGE, "points_m"], true),
      field(["plant", "screen", "angle_rad"], { label: "Gamma, to the vertical" }), ...form(LINKAGE, { only: ["least_transmission_deg", "least_clearance_m", "pivot_damping_n_m_s"] })),
    element("section", { class: "panel" }, element("h2", {}, "Masses, lengths, inertias"), bodies()),
    element("section", { class: "panel wide" }, element("h2", {}, "Check linkage validity"), validity()),
    element("section", { class: "panel wide" }, element("h2", {}, "Solve system"), solvePanel()));
}

function design() {
  const select = choice([["", "choose ..."], ...DESIGNS], { "aria-label": "linkage design" });
  select.addEventListener("change", async () => {
    if (select.value) await store.change("part", { part: "linkage", name: select.value });
  });
  const kind = element("p", { class: "dim" });
  const refresh = () => {
    const now = store.get(LINKAGE) || {};
    shipped().then((found) => {
      const same = found.linkages.find((each) => each.about === now.name && DESIGNS.some(([name]) => name === each.name));
      select.value = same ? same.name : "";
    });
    kind.textContent = `kind ${now.kind || "?"}${now.kind === "assembly" ? ": bodies and joints are written in the text" : ""}`;
  };
  listen(kind, refresh);
  refresh();
  return element("div", {}, element("div", { class: "stacked" }, element("span", {}, "Select linkage design"), select), libraryChoice("linkage", "linkages"), kind);
}

function pictures() {
  const plane = new WiperDrawing(false);
  const whole = new WiperDrawing(true);
  const space = new View3d();
  const angle = element("input", { type: "range", min: 0, max: 179, value: 0, "aria-label": "crank angle" });
  const told = element("span", { class: "figure", id: "crank-angle" });
  const show = () => {
    const frame = Number(angle.value);
    plane.draw(frame);
    whole.draw(frame);
    told.textContent = `crank ${frame * 2} deg`;
    if (plane.made) space.show(plane.placed(frame), plane.made.screen_angle_rad);
  };
  let asked = 0;
  const refresh = async () => {
    asked += 1;
    const mine = asked;
    const made = store.state.sound ? await api("drawing", {}).catch(() => null) : null;
    if (mine !== asked) return;
    plane.show(made);
    whole.show(made);
    whole.node.toggleAttribute("hidden", !made);
    show();
  };
  angle.addEventListener("input", show);
  listen(angle, refresh);
  refresh();
  const large = () => { const other = new WiperDrawing(true); other.show(plane.made); other.draw(Number(angle.value)); return other.node; };
  return element("div", {},
    element("div", { class: "row" }, angle, told, playButton(angle, show),
      element("button", { onclick: () => popOut(large()) }, "Pop out linkage diagram"), element("button", { onclick: () => popOut(space.node) }, "3D linkage plot"), element("span", { class: "dim" }, "at crank angle 0 a pivot can be dragged")),
    plane.node, element("div", { class: "columns" }, element("div", {}, whole.node), element("div", {}, space.node)));
}

export function playButton(angle, show) {
  const button = element("button", { "aria-pressed": "false" }, "play");
  const step = () => {
    if (button.getAttribute("aria-pressed") !== "true" || !button.isConnected || document.hidden) return;
    angle.value = (Number(angle.value) + 1) % 180;
    show();
    requestAnimationFrame(step);
  };
  button.addEventListener("click", () => {
    button.setAttribute("aria-pressed", button.getAttribute("aria-pressed") !== "true");
    step();
  });
  return button;
}

export function popOut(node) {
  const home = node.parentElement;
  const dialog = element("dialog", {}, node, element("form", { method: "dialog" }, element("button", { onclick: () => dialog.close() }, "close")));
  dialog.addEventListener("close", () => { if (home) home.append(node); dialog.remove(); });
  document.body.append(dialog);
  dialog.showModal();
}

function bodies() {
  const box = element("div");
  let names = "";
  const rows = element("table", {});
  const refresh = () => {
    const masses = store.get([...LINKAGE, "masses_kg"]) || {};
    if (Object.keys(masses).join() !== names) {
      names = Object.keys(masses).join();
      box.replaceChildren(...Object.keys(masses).map((name, index) => field([...LINKAGE, "masses_kg", name], { label: `Body ${index + 2}: ${name.replaceAll("_", " ")}`, unit: "kg" })), element("p", { class: "dim" }, "Body 1 is the ground. Each is a slender rod (4.43)."), rows);
    }
    const head = element("tr", {}, ...["body", "length (m)", "mass (kg)", "inertia (kg m2)"].map((text) => element("th", {}, text)));
    rows.replaceChildren(head, ...(store.state.bodies || []).map((each) => element("tr", {}, element("td", {}, each.body.replaceAll("_", " ")),
      ...[each.length_m, each.mass_kg].map((value) => element("td", { class: "figure" }, value.toFixed(4))), element("td", { class: "figure" }, each.inertia_kg_m2.toExponential(3)))));
  };
  listen(box, refresh);
  refresh();
  return box;
}

function validity() {
  const box = element("div", { id: "validity" });
  const refresh = () => {
    const rules = store.state.rules || [];
    const read = store.state.readings;
    const own = store.wrongWithin(LINKAGE).filter((each) => each.severity === "error").map((each) => each.text);
    const broken = rules.filter((rule) => !rule.keeps);
    const verdict = own.length || broken.length ? element("p", { class: "bad", role: "status" }, broken.length ? `Not possible: ${broken.map((rule) => `${rule.name} (${rule.loop})`).join(", ")}.` : `Not possible: ${own.join("; ")}`)
      : element("p", { class: "good", role: "status" }, read ? "The configuration is possible." : "No rule is broken.");
    const head = element("tr", {}, ...["loop", "rule", "must be less", "than", "margin (mm)", "remedy"].map((text) => element("th", {}, text)));
    const lines = rules.map((rule) => element("tr", { class: rule.keeps ? "" : "bad", dataset: { keeps: String(rule.keeps) } }, element("td", {}, rule.loop), element("td", {}, rule.name),
      element("td", {}, `${rule.smaller} = ${rule.smaller_m.toFixed(5)} m`), element("td", {}, `${rule.greater} = ${rule.greater_m.toFixed(5)} m`), element("td", { class: "figure" }, (1000 * rule.margin_m).toFixed(2)), element("td", {}, rule.remedy)));
    box.replaceChildren(verdict, element("table", {}, head, ...lines), ...(read ? readOuts(read) : []));
  };
  listen(box, refresh);
  refresh();
  return box;
}

function readOuts(read) {
  const transmission = read.dead_points.map((each) => `${figure(each.transmission_deg)} deg at ${each.where}, crank ${figure(each.crank_deg)} deg`);
  return [element("p", {}, `Sweep: left ${read.left_sweep_deg.toFixed(3)} deg, right ${read.right_sweep_deg.toFixed(3)} deg. Blades at least ${(1000 * read.blade_clearance_m).toFixed(0)} mm apart. ${read.moving_mass_kg.toFixed(3)} kg move.`),
    element("p", {}, `Transmission angle off the line, at least ${read.least_transmission_deg} deg: ${transmission.join("; ")}.`)];
}
