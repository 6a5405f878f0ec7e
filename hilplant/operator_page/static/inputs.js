// All inputs of the plant, grouped by their names; an input that is new in signals.py appears by itself.
import { element } from "/shared/dom.js";
import { Control } from "./control.js";

const GROUPS = [
  ["Weather", /^(screen|(left|right)_screen|vehicle_|ambient_|rain|water|washer|spray|wind)/],
  ["Blades and wear", /^(left|right)_|wear|force/],
  ["Brake and obstacles", /brake|obstacle|snow|jam/],
  ["Others", /./],
];
const ELSEWHERE = /^(relay_|supply_v$)/;

export function inputs(session) {
  const left = session.description.inputs.filter((signal) => !ELSEWHERE.test(signal.name));
  const panels = [];
  let rest = left;
  for (const [title, pattern] of GROUPS) {
    const mine = rest.filter((signal) => pattern.test(signal.name));
    rest = rest.filter((signal) => !pattern.test(signal.name));
    if (!mine.length) continue;
    panels.push(element("section", { "aria-label": title }, element("h3", {}, title), ...mine.map((signal) => new Control(session, signal).node)));
  }
  return element("div", { class: "groups" }, ...panels);
}
