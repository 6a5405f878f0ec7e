// 7 Generate simulation model: files, tables, networks, hybrid and network benches, and a run of them.
import { api } from "/shared/access.js";
import { choice, element } from "/shared/dom.js";
import { fetched } from "./download.js";
import { saveDialog } from "./files.js";
import { listen } from "./field.js";
import { JobView } from "./job.js";
import { store } from "./store.js";

const TRAININGS = {
  tables: ["Generate Kinematic Model", "6.2: tables of positions, velocities, accelerations", [["bound", "1e-8"]]],
  polynomial: ["Fit No-load Polynomial", "6.3", []],
  torque: ["Train Torque ANN", "6.4.2: of the whole wiper", [["neurons", "10"], ["starts", "10"], ["seed", "1"], ["scenarios", "200"]]],
  motor: ["Train Motor ANN", "6.4.3: NARX, a path for each brush", [["seed", "1"], ["scenarios", "2000"]]],
};

export function generatePanel() {
  const made = element("div", { id: "made" });
  const job = new JobView(Object.keys(TRAININGS), (state) => { if (state.state === "done") show(made, state); });
  const trainings = Object.entries(TRAININGS).map(([what, [text, title, settings]]) => {
    const inputs = settings.map(([key, value]) => [key, element("input", { value, size: 5, inputmode: "decimal", "aria-label": `${what} ${key}` })]);
    const data = ownData(what);
    const start = () => { made.replaceChildren(); job.seen = null; job.ask("train", { what, ...data.chosen(), ...Object.fromEntries(inputs.map(([key, input]) => [key, Number(input.value)])) }); };
    return element("div", { class: "row" }, element("button", { title, dataset: { what }, onclick: start }, text), ...inputs.map(([key, input]) => element("label", {}, key, input)), data.node);
  });
  return element("div", { class: "columns" },
    element("section", { class: "panel wide" }, element("h2", {}, "Bench and its files"), physical()),
    element("section", { class: "panel" }, element("h2", {}, "Kinematic model and networks"), ...trainings, element("p", { class: "dim" }, "Own data are recordings that were given in Parameter Identification."), job.node, made),
    element("section", { class: "panel" }, element("h2", {}, "Benches with networks"), networks()),
    element("section", { class: "panel" }, element("h2", {}, "Run"), run()));
}

// Own data in place of the bench's plant: recordings that were given to the page (panel Parameter Identification).
function ownData(what) {
  if (what === "torque") {
    const [data, validation] = ["data", "validation"].map((text) => choice([["", `own ${text} ...`]], { "aria-label": `${what} ${text}` }));
    for (const select of [data, validation]) offer(select);
    return { node: element("span", { class: "row" }, data, validation), chosen: () => ({ data: data.value || null, validation: validation.value || null }) };
  }
  if (what === "motor") {
    const [slow, fast] = ["slow", "fast"].map((mode) => choice([["", `own data, ${mode} ...`]], { "aria-label": `${what} ${mode}` }));
    for (const select of [slow, fast]) offer(select);
    const named = [[slow, "slow"], [fast, "fast"]];
    return { node: element("span", { class: "row" }, slow, fast), chosen: () => ({ data: named.filter(([select]) => select.value).map(([select, mode]) => ({ name: select.value, mode })) }) };
  }
  return { node: null, chosen: () => ({}) };
}

async function offer(select) {
  const known = new Set([...select.options].map((each) => each.value));
  for (const { name } of await api("recordings", {})) if (!known.has(name)) select.append(element("option", { value: name }, name));
}

function physical() {
  const lines = element("pre", { class: "lines", id: "summary" });
  const refresh = () => { lines.textContent = (store.state.lines || ["the model has problems"]).join("\n"); };
  listen(lines, refresh);
  refresh();
  return element("div", {}, element("div", { class: "row" },
    element("button", { title: "the physical model: bench, motor, linkage and screen in a new folder", onclick: saveDialog }, "Generate Physical Model (save)"),
    element("button", { title: "all files as a zip archive", onclick: () => fetched("zip", "wiper.zip") }, "Export Parameters (zip)")), lines);
}

function networks() {
  const kind = element("p", { class: "dim" });
  const refresh = () => { kind.textContent = `load: ${(store.get(["plant", "load"]) || {}).model || "?"}, motor: ${(store.get(["plant", "motor_model"]) || {}).model || "ode"}`; };
  listen(kind, refresh);
  refresh();
  const button = (text, asked, title) => element("button", { title, onclick: () => store.change("network", asked) }, text);
  return element("div", {}, element("div", { class: "row" }, button("Generate Hybrid Model", { torque: true }, "the torque network in place of the load, the physical motor"),
    button("Generate ANN Model", { torque: true, motor: true }, "both networks"), element("button", { onclick: physicalAgain }, "back to the physical model")), kind,
  element("p", { class: "dim" }, "With the networks that were trained above; the physical load stands by where they were not trained."));
}

async function physicalAgain() {
  if (store.get(["plant", "motor_model"])) await store.edit(["plant", "motor_model"], { model: "ode" });
  await store.edit(["plant", "load"], { model: "reduced", points: 1 });
}

function run() {
  const said = element("p", { class: "message", id: "run-said" });
  const channel = element("input", { placeholder: "channel, such as vcan0", "aria-label": "channel" });
  const start = async () => {
    try {
      said.textContent = "starting; the first time the step is compiled";
      const found = await api("run", { channel: channel.value });
      said.replaceChildren(`started: ${found.command} `, ...(found.page ? [element("a", { href: found.page, target: "_blank", rel: "noopener" }, "the operator's page")] : [found.said]));
    } catch (error) {
      said.textContent = error.message;
    }
  };
  return element("div", {}, element("div", { class: "row" }, element("button", { id: "run", onclick: start }, "Run it here"), channel), said);
}

function show(place, { work, answer }) {
  const files = answer.files.map((name) => element("button", { onclick: () => fetched(`product?work=${work}&name=${encodeURIComponent(name)}`, name) }, name));
  place.replaceChildren(element("p", { class: answer.kept ? "good" : "bad" }, answer.kept ? `${work}: done` : `${work}: beyond the bounds that its file states`), element("pre", { class: "lines" }, answer.lines.join("\n")), element("div", { class: "row" }, ...files));
}
