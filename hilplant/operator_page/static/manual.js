// Manual control: the stalk as the driver moves it, and the relays directly.
import { element, say } from "/shared/dom.js";
import { Control } from "./control.js";

const POSITIONS = [["off", "Off", "O"], ["slow", "Slow", "S"], ["fast", "Fast", "F"], ["flick", "Flick", "X"], ["wash", "Wash", "W"]];

export function manual(session) {
  const { inputs, ecu } = session.description;
  const chosen = element("span", { class: "tag", id: "stalk-state", title: "what the ECU says it is doing" }, "ECU: -");
  const buttons = POSITIONS.map(([move, text, key]) => button(move, text, `${text} (${key})`));
  if (ecu.automatic) buttons.push(button("automatic", "Auto", "the rain sensor chooses; intermittent while it is silent (A)"));
  const pauses = [1, 2, 3, 4, 5, 6].map((number) => button(`intermittent${number}`, String(number), `intermittent, pause ${number} (${number})`));
  const relays = inputs.filter((signal) => signal.name.startsWith("relay_")).map((signal) => new Control(session, signal, signal.name.replace("relay_", "relay ")));
  const note = element("div", { class: "message dim" });

  function button(move, text, title) {
    return element("button", { id: `stalk-${move}`, title, onclick: () => session.stalk(move) }, text);
  }

  session.addEventListener("frames", (event) => {
    const state = ecu.states[event.detail.ecu.ecu_state];
    say(chosen, `ECU: ${state || "not heard"}`);
  });
  session.addEventListener("row", () => {
    const off = !session.acts || session.state.stalk === false;
    for (const node of [...buttons, ...pauses]) {
      node.disabled = off;
      node.setAttribute("aria-pressed", String(session.moved === node.id.replace("stalk-", "")));
    }
    const held = session.samples.value("owner.relay_on") === 3;
    const safe = held ? "Commands of the bus are missing: the safe state holds the relays open, also against the hand. " : "";
    say(note, safe + (session.recorded ? "A recording: nothing can be changed." : session.state.stalk === false ? "No stalk: the interface virtual reaches no ECU." : ""));
  });
  const modes = ["override", "set"].map((manner) => element("button", {
    title: manner === "override" ? "a change holds the input until it is released, or this page goes" : "a change stays until a frame says otherwise",
    onclick: () => { session.manner = manner; showManner(); },
  }, manner === "override" ? "hold" : "set"));
  function showManner() {
    modes.forEach((node, i) => node.setAttribute("aria-pressed", String(session.manner === ["override", "set"][i])));
  }
  showManner();
  return element("section", { class: "panel", "aria-label": "Manual control" }, element("h2", {}, "Manual control", chosen),
    element("div", { class: "row", role: "group", "aria-label": "stalk" }, ...buttons),
    element("div", { class: "row" }, element("span", { class: "dim" }, "intermittent"), ...pauses),
    ...relays.map((control) => control.node), note,
    element("div", { class: "row small-text" }, element("span", { class: "dim" }, "a change of an input is"), ...modes));
}
