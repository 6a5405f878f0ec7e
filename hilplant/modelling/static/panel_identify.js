// 6 Parameter identification: recordings, the stages, progress, before and after, measured against simulated.
import { choice, element, figure } from "/shared/dom.js";
import { chart } from "./chart.js";
import { JobView } from "./job.js";
import { Recordings } from "./recordings.js";
import { store } from "./store.js";

const SETTINGS = [["generations", "generations", "200"], ["population", "population", "40"], ["seed", "seed", "0"]];
const STAGES = [["1", "Motor Parameter Identification", "5.3: the motor's transfer functions"], ["2", "Genetic Algorithm Identification", "5.5: global search"],
  ["3", "Local Optimizer Identification", "5.6: least squares from the model's own values"], ["1,2,3", "All three", "one after the other"]];

export function identifyPanel() {
  const recordings = new Recordings();
  const result = element("div", { id: "identified" });
  const job = new JobView(["identify"], (state) => { if (state.state === "done") show(result, state.answer); });
  const settings = SETTINGS.map(([key, label, value]) => [key, element("input", { value, inputmode: "numeric", "aria-label": label, size: 5 })]);
  const search = choice([["genetic", "genetic"], ["cma", "cma"], ["de", "differential evolution"]], { "aria-label": "global search" });
  const [hold, also] = ["hold, such as force_n=7.6", "also look for"].map((text) => element("input", { placeholder: text, "aria-label": text, size: 20 }));
  const list = (input) => input.value.split(/[,;\s]+/).filter(Boolean);
  const order = (stages, resume) => ({
    data: recordings.chosen("fit"), held_out: recordings.chosen("judge"), columns: recordings.mapped(), frames: recordings.source(), hold: list(hold), also: list(also), search: search.value, stages, resume,
    date: new Date().toISOString().slice(0, 10), ...Object.fromEntries(settings.map(([key, input]) => [key, Number(input.value)])),
  });
  const start = (stages, resume = false) => { result.replaceChildren(); job.seen = null; job.ask("identify", order(stages, resume)); };
  const buttons = STAGES.map(([stages, text, title]) => element("button", { title, dataset: { stages }, onclick: () => start(stages) }, text));
  const again = element("button", { id: "resume", title: "go on where a run that was stopped had come to", onclick: () => start("1,2,3", true) }, "Resume");
  return element("div", { class: "columns" },
    element("section", { class: "panel wide" }, element("h2", {}, "Recordings"), recordings.node),
    element("section", { class: "panel wide" }, element("h2", {}, "Identification"), element("div", { class: "row" }, ...settings.map(([key, input]) => element("label", {}, key, input)), search, hold, also),
      element("div", { class: "row" }, ...buttons, again), job.node, result));
}

function show(place, answer) {
  const rows = answer.parameters.map((each) => element("tr", { dataset: { name: each.name, found: each.found } }, element("td", {}, each.name),
    ...[each.before, each.found].map((value) => element("td", { class: "figure" }, value.toPrecision(5))), element("td", {}, interval(each)), element("td", { class: "dim" }, each.unit)));
  const head = element("tr", {}, ...["parameter", "before", "found", "95 % interval", ""].map((text) => element("th", {}, text)));
  const accept = element("button", { id: "accept", onclick: async () => { if (await store.change("accept")) place.replaceChildren(element("p", { class: "good" }, "Taken into the panels; undo takes it back.")); } }, "Accept into the panels");
  const discard = element("button", { onclick: () => place.replaceChildren() }, "Discard");
  const lines = [...answer.withheld_why.map((text) => element("p", { class: "bad" }, text)), ...answer.advice.map((text) => element("p", { class: "warn" }, text)), ...answer.notes.map((text) => element("p", { class: "dim" }, text))];
  const charts = [];
  if (answer.history.length > 1) {
    const cost = chart("Cost over the evaluations", "evaluations", [{ label: "best" }, { label: "mean", colour: "s7" }], { height: 150 });
    cost.show([answer.history.map((each) => each.evaluations), answer.history.map((each) => each.best), answer.history.map((each) => each.mean)]);
    charts.push(cost);
  }
  for (const each of answer.compared) {
    const both = chart(`${each.name} (${each.role}): ${figure(each.rms_current_a)} A rms, noise ${figure(each.noise_a)} A`, "time (s)", [{ label: "measured", colour: "s7" }, { label: "simulated", colour: "s2" }], { height: 160, y: "A" });
    const rest = chart(`${each.name}: residuals`, "time (s)", [{ label: "residual" }], { height: 110, y: "A" });
    both.show([each.time_s, each.measured_a, each.simulated_a]);
    rest.show([each.time_s, each.measured_a.map((value, index) => value - each.simulated_a[index])]);
    charts.push(both, rest);
  }
  place.replaceChildren(element("div", { class: "row" }, accept, discard), element("table", {}, head, ...rows), ...lines, element("div", { class: "columns" }, ...charts));
}

function interval(each) {
  if (each.identifiable === null) return "with stage 3";
  if (!each.identifiable) return `not identifiable${each.together.length ? `, not apart from ${each.together.join(", ")}` : ""}`;
  if (each.withheld) return "withheld";
  return [each.low, each.high].map((side) => (side === null ? "open" : side.toPrecision(5))).join(" to ");
}
