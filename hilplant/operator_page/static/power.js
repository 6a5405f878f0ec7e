// Main power: on, or off as an open circuit; the voltage by hand, as a waveform, or after a supply profile.
import { choice, element, figure, say } from "/shared/dom.js";
import { Control } from "./control.js";

export function power(session) {
  const { description, samples } = session;
  const signal = description.inputs.find((each) => each.name === "supply_v");
  const control = new Control(session, signal, "voltage");
  const on = element("button", { id: "power-on", onclick: () => turn(true) }, "On");
  const off = element("button", { id: "power-off", title: "open circuit: the motor coasts, it does not brake (0)", onclick: () => turn(false) }, "Off (open)");
  const state = element("span", { class: "tag", id: "power-state" });
  const kind = choice([["sine", "sine"], ["repeat", "repeating sequence"], ["profile", "supply profile"]], { id: "wave-kind", "aria-label": "waveform" });
  const fields = element("span", { class: "row" });
  const start = element("button", { id: "wave-start", onclick: play }, "Start");
  const stop = element("button", { id: "wave-stop", onclick: () => wave(null) }, "Stop");
  const playing = element("div", { class: "message", id: "wave-state" });
  const about = element("div", { class: "dim small-text" });
  const number = (label, value, step = "any") => {
    const input = element("input", { type: "number", value, step, "aria-label": label });
    return { input, node: element("label", {}, label, input) };
  };
  const sine = { mean: number("mean V", 13.5), amplitude: number("amplitude V", 1), hz: number("Hz", 0.5) };
  const points = element("input", { value: "0:13.5, 2:13.5, 2.1:9, 4:9", size: 24, "aria-label": "points, seconds:volts" });
  const every = number("every s", 5);
  const profile = choice(description.profiles.map((each) => [each.name, each.title]), { id: "profile", "aria-label": "supply profile" });

  function shape() {
    if (kind.value === "sine") fields.replaceChildren(...Object.values(sine).map((each) => each.node));
    else if (kind.value === "repeat") fields.replaceChildren(element("label", {}, "s:V", points), every.node);
    else fields.replaceChildren(profile);
    const chosen = description.profiles.find((each) => each.name === profile.value);
    say(about, kind.value === "profile" ? chosen.cannot_show : "a new value every 10 ms; for shapes to the millisecond: a scenario");
  }

  function written() {
    if (kind.value === "profile") return { profile: profile.value };
    if (kind.value === "sine") return { sine: Object.fromEntries(Object.entries(sine).map(([name, each]) => [name, each.input.valueAsNumber])) };
    const pairs = points.value.split(",").map((pair) => pair.split(":").map(Number));
    return { repeat: { points: pairs, every: every.input.valueAsNumber } };
  }

  function play() {
    wave(written());
  }

  function wave(what) {
    return session.command("waveform", { input: "supply_v", written: what }, what ? "waveform started" : "waveform stopped");
  }

  async function turn(wanted) {
    if (wanted) await session.command("clear", { names: ["supply_open"] }, "main power on");
    else await session.command("fault", { fault: "supply_open", keys: {} }, "main power off: open circuit");
  }

  function row() {
    const open = session.faults.has("supply_open");
    say(state, open ? `off: open circuit` : `on, terminal 30 at ${figure(samples.value("out.supply_v"), "V")}`);
    state.className = `tag ${open ? "warn" : "good"}`;
    on.setAttribute("aria-pressed", String(!open));
    off.setAttribute("aria-pressed", String(open));
    for (const node of [on, off, start]) node.disabled = !session.acts;
    const told = session.state.waveform || {};
    stop.disabled = !session.acts || !told.written;
    say(playing, told.written ? `playing ${Object.keys(told.written)[0]}${told.seconds ? `, ${told.seconds.toFixed(0)} s in all` : ""}` : "");
  }

  kind.addEventListener("change", shape);
  profile.addEventListener("change", shape);
  session.addEventListener("row", row);
  shape();
  return element("section", { class: "panel", "aria-label": "Main power" }, element("h2", {}, "Main power", state),
    element("div", { class: "row" }, on, off), control.node,
    element("div", { class: "row" }, kind, fields, start, stop), about, playing);
}
