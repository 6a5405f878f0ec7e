// 5 Environment: friction of the blades dry, wet and tacky, air, force, speed of the vehicle; with their curves.
import { api } from "/shared/access.js";
import { element, figure } from "/shared/dom.js";
import { chart } from "./chart.js";
import { coefficient } from "./coefficient.js";
import { field, listen } from "./field.js";
import { form, group } from "./form.js";
import { libraryChoice } from "./library.js";
import { store } from "./store.js";

const SCREEN = ["plant", "screen"];
const AIR = { "without spoiler": { drag: 0.175, lift: 0.0517 }, "with spoiler": { drag: 0.219, lift: -0.0694 } };
const LINES = [["mu_dry", "dry", "s2"], ["mu_tacky", "tacky", "s5"], ["mu_wet", "wet", "s1"], ["mu_wet_5_n", "wet, 5 N", "s3"], ["mu_wet_10_n", "wet, 10 N", "s4"], ["mu_wet_15_n", "wet, 15 N", "s7"]];

export function environmentPanel() {
  const numbered = (name, count) => Object.fromEntries(Array.from({ length: count }, (_, index) => [`mu_${name}_${index + 1}`, { label: `u_${index + 1}` }]));
  return element("div", { class: "columns" },
    element("section", { class: "panel" }, element("h2", {}, "Friction, speeds in mm/s"), libraryChoice("screen", "screens"),
      ...["dry", "wet", "tacky"].map((name) => group([...SCREEN, name], { legend: name, fields: numbered(name, 7) })), ...form(SCREEN, { only: ["velocity_limit_mm_s"] })),
    element("section", { class: "panel" }, element("h2", {}, "Blades in the air"), air(), field(["inputs", "vehicle_speed_m_s"], { label: "Vehicle velocity", unit: "m/s" }),
      field(["inputs", "screen"], { label: "Screen at the start", choices: ["dry", "tacky", "wet"].map((each) => [each, each]) })),
    element("section", { class: "panel wide" }, element("h2", {}, "Coefficient of friction (Figures 4-22, 4-26)"), friction()),
    element("section", { class: "panel wide" }, element("h2", {}, "Drag and lift (Figure 4-30)"), forces()));
}

function air() {
  const buttons = Object.entries(AIR).map(([name, set]) => element("button", { onclick: () => {
    if (store.get(["plant", "blades"])) store.amend(["plant", "blades"], ({ left, right }) => ({ left: { ...left, ...set }, right: { ...right, ...set } }));
  } }, name));
  const sides = ["left", "right"].map((side) => {
    const at = ["plant", "blades", side];
    return element("fieldset", {}, element("legend", {}, side), field([...at, "force_n"], { label: "Blade force" }), field([...at, "area_m2"], { label: "Blade area" }),
      ...["drag", "lift"].map((key) => coefficient([...at, key], `${key} coefficient`)), field([...at, "wear"], { label: "wear" }));
  });
  return element("div", {}, element("div", { class: "row" }, "section 4.5:", ...buttons), ...sides);
}

function friction() {
  const marks = [];
  const lines = LINES.map(([, label, colour], index) => ({ label, colour, dash: index > 2 ? [2 + 2 * index, 4] : undefined, width: index > 2 ? 1 : 1.8 }));
  const low = chart("up to 100 mm/s", "speed (mm/s)", lines, { y: "mu", height: 220 });
  const whole = chart("the range in use", "speed (mm/s)", lines, { y: "mu", height: 220, marks: () => marks });
  const told = element("p", { class: "dim" });
  const refresh = async () => {
    if (!store.state.sound) return;
    const found = await api("friction", {}).catch(() => null);
    if (!found) return;
    const { columns } = found;
    marks.splice(0, marks.length, [found.velocity_limit_mm_s, "held from here"], ...Object.entries(found.speeds).flatMap(([turns, each]) => [[each.median_mm_s, `median, ${turns}/min`], [each.largest_mm_s, `largest, ${turns}/min`]]));
    const shown = columns.speed_mm_s.filter((value) => value <= 100).length;
    low.show([columns.speed_mm_s, ...LINES.map(([name]) => columns[name])].map((values) => values.slice(0, shown)));
    whole.show([columns.speed_mm_s, ...LINES.map(([name]) => columns[name])]);
    told.textContent = `At ${figure(found.force_n)} N on the left blade. Blades in use: ${Object.entries(found.speeds).map(([turns, each]) => `${turns} turns a minute: median ${figure(each.median_mm_s)}, largest ${figure(each.largest_mm_s)} mm/s`).join("; ")}. Tacky is assumed, not published.`;
  };
  listen(told, refresh);
  refresh();
  return element("div", {}, element("div", { class: "columns" }, low, whole), told);
}

// The sets of section 4.5 by their names, the blades of this bench over them.
function airLine(name) {
  const side = ["left", "right"].find((each) => name.endsWith(`_${each}`));
  return side ? { label: `${side} blade of this bench`, dash: side === "left" ? [8, 6] : [2, 5], width: 2.5 } : { label: name.replace("_4_5", ", 4.5").replaceAll("_", " ") };
}

function forces() {
  const place = element("div", { class: "columns" });
  const refresh = async () => {
    if (!store.state.sound) return;
    const found = await api("air", {}).catch(() => null);
    if (!found) return;
    place.replaceChildren(...["drag", "lift"].map((kind) => {
      const names = Object.keys(found).filter((name) => name.endsWith(`_${kind}_n`));
      const made = chart(`${kind} (N)`, "vehicle speed (m/s)", names.map((name) => airLine(name.replace(`_${kind}_n`, ""))), { y: "N", height: 200 });
      made.show([found.vehicle_speed_m_s, ...names.map((name) => found[name])]);
      return made;
    }));
  };
  listen(place, refresh);
  refresh();
  return place;
}
