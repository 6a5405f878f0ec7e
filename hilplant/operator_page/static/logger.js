// Data logger: start and stop, file, signals; from a trigger by level, edge or condition on, with what was before it.
import { choice, element, say } from "/shared/dom.js";

const WAYS = [["now", "by hand"], ["above", "level above"], ["below", "level below"], ["rises", "edge rising"], ["falls", "edge falling"], ["equals", "condition equals"], ["changes", "condition changes"]];
const FIRST = ["supply_v", "current_a", "park_contact", "terminal_v", "relay_on", "relay_fast", "crank_angle_rad", "in.screen"];

export function logger(session, plots) {
  const state = element("span", { class: "tag", id: "log-state" }, "off");
  const file = element("input", { id: "log-file", value: name(), "aria-label": "file", title: ".hilrec: every tick and frame; .csv, .parquet, .mf4: chosen signals", size: 20 });
  const way = choice(WAYS, { id: "log-way", "aria-label": "trigger" });
  const names = [...plots.signals.keys()];
  const signal = choice(names.map((each) => [each, each]), { id: "log-signal", "aria-label": "trigger signal" });
  const level = element("input", { id: "log-level", type: "number", value: 1, step: "any", "aria-label": "trigger level" });
  const before = element("input", { id: "log-before", type: "number", value: 1, min: 0, max: 50, step: "any" });
  const seconds = element("input", { id: "log-seconds", type: "number", min: 0, step: "any", placeholder: "until stop" });
  const chosen = element("select", { id: "log-signals", multiple: true, size: 4, "aria-label": "signals", title: "Ctrl and click for several" },
    ...names.map((each) => element("option", { value: each, selected: FIRST.includes(each) }, each)));
  const start = element("button", { id: "log-start", title: "start (L)", onclick: begin }, "Start");
  const stop = element("button", { id: "log-stop", title: "stop (L)", onclick: () => session.command("log_stop", {}, "log stopped") }, "Stop");
  const told = element("div", { class: "message", id: "log-told" });
  signal.value = "current_a";
  const trigger = element("span", { class: "row" }, signal, level);
  const table = element("div", {},
    element("div", { class: "row" }, element("label", {}, "trigger", way), trigger),
    element("div", { class: "row" }, element("label", {}, "before s", before), element("label", {}, "length s", seconds)), chosen);

  function name() {
    const now = new Date();
    const two = (number) => String(number).padStart(2, "0");
    return `log-${two(now.getHours())}${two(now.getMinutes())}${two(now.getSeconds())}.hilrec`;
  }

  function shape() {
    table.hidden = file.value.endsWith(".hilrec");
    trigger.hidden = way.value === "now";
    level.hidden = way.value === "changes";
  }

  async function begin() {
    const order = { file: file.value, signals: [...chosen.selectedOptions].map((each) => each.value), before_s: before.valueAsNumber || 0 };
    if (way.value !== "now") order.trigger = { way: way.value, signal: signal.value, level: level.valueAsNumber || 0 };
    if (seconds.value) order.seconds = seconds.valueAsNumber;
    if (await session.command("log", order, `log to ${file.value}`)) session.logging = file.value;
  }

  function show(log) {
    const busy = ["armed", "logging", "recording"].includes(log.state);
    say(state, log.state === "armed" ? "waits for its trigger" : log.state);
    state.className = `tag ${busy ? "warn" : log.state === "whole" ? "good" : ["lossy", "failed"].includes(log.state) ? "bad" : ""}`;
    start.disabled = !session.acts || busy;
    stop.disabled = !session.acts || !busy;
    const where = log.file ? `${log.file}${log.rows ? `: ${log.rows} ticks` : ""}` : "";
    say(told, log.words || (where ? `${where} in ${session.state.logs}` : `folder ${session.state.logs || ""}`));
    if (!busy && session.logging === file.value && log.state !== "off") {
      file.value = name().replace(".hilrec", file.value.slice(file.value.lastIndexOf(".")));
      session.logging = "";
    }
  }

  file.addEventListener("input", shape);
  way.addEventListener("change", shape);
  session.addEventListener("state", () => show(session.state.log || { state: "off" }));
  session.addEventListener("frames", (event) => { if (event.detail.log && session.state.log?.state !== "recording") show(event.detail.log); });
  shape();
  return element("section", { class: "panel", "aria-label": "Data logger" }, element("h2", {}, "Data logger", state),
    element("div", { class: "row" }, file, start, stop), table, told);
}
