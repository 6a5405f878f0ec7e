// The page: seven panels as in Figure 8-3, beside them the text of all files.
import { element } from "/shared/dom.js";
import "/shared/theme.js";
import { head } from "./files.js";
import { armsPanel, bladesPanel } from "./panel_arms.js";
import { environmentPanel } from "./panel_environment.js";
import { generatePanel } from "./panel_generate.js";
import { identifyPanel } from "./panel_identify.js";
import { linkagePanel } from "./panel_linkage.js";
import { motorPanel } from "./panel_motor.js";
import { store } from "./store.js";
import { texts } from "./texts.js";

const PANELS = [
  ["motor", "Wiper Motor", motorPanel, [["plant", "motor"], ["plant", "park_switch"]], "motor.yaml"],
  ["linkages", "Wiper Linkages", linkagePanel, [["plant", "linkage", "points_m"], ["plant", "linkage", "masses_kg"], ["plant", "linkage", "kind"]], "linkage.yaml"],
  ["arms", "Wiper Arms", armsPanel, [["plant", "linkage", "left_arm"], ["plant", "linkage", "right_arm"]], "linkage.yaml"],
  ["blades", "Wiper Blades", bladesPanel, [["plant", "linkage", "left_blade"], ["plant", "linkage", "right_blade"]], "linkage.yaml"],
  ["environment", "Environment", environmentPanel, [["plant", "screen"], ["plant", "blades"]], "screen.yaml"],
  ["identification", "Parameter Identification", identifyPanel, [], ""],
  ["generate", "Generate Simulation Model", generatePanel, [], "bench.yaml"],
];

const kept = new Map();

function show(name) {
  const [, , make, , file] = PANELS.find(([each]) => each === name);
  // What runs or was uploaded stays where it is while another panel is shown.
  if (!kept.has(name) || name !== "identification") kept.set(name, make());
  document.getElementById("panels").querySelector(".shown").replaceChildren(kept.get(name));
  for (const tab of document.querySelectorAll("nav button")) tab.setAttribute("aria-pressed", String(tab.dataset.panel === name));
  sessionStorage.setItem("panel", name);
  if (file in store.state.files) store.dispatchEvent(new CustomEvent("show-file", { detail: { file } }));
}

function counts() {
  for (const [name, , , locations] of PANELS) {
    const tab = document.querySelector(`nav button[data-panel="${name}"] .count`);
    const wrong = locations.reduce((sum, location) => sum + store.wrongWithin(location).filter((each) => each.severity === "error").length, 0);
    tab.textContent = wrong || "";
    tab.className = wrong ? "count tag bad" : "count";
  }
}

async function begin() {
  await store.load();
  const nav = element("nav", {}, ...PANELS.map(([name, title]) => element("button", { dataset: { panel: name }, "aria-pressed": "false", onclick: () => show(name) }, title, element("span", { class: "count" }))));
  document.getElementById("panels").append(nav, element("div", { class: "shown" }));
  head(document.getElementById("head"));
  texts(document.getElementById("texts"));
  store.addEventListener("changed", counts);
  counts();
  show(sessionStorage.getItem("panel") || "motor");
  document.body.dataset.ready = "1";
}

begin().catch((error) => { document.getElementById("panels").textContent = error.message; });
