// Faults by catalogue: insert one, for a time or until it is removed, and see which are there.
import { element, say } from "/shared/dom.js";

export function faults(session) {
  const { faults: catalogue } = session.description;
  const search = element("input", { type: "search", placeholder: "search", id: "fault-search", "aria-label": "search faults" });
  const list = element("select", { id: "fault-list", size: 11, "aria-label": "faults" });
  const about = element("p", { class: "dim" });
  const fields = element("div", { class: "row" });
  const lasting = number("for s", "no end");
  const later = number("in s", "at once");
  const ramp = number("ramp s", "none");
  const insert = element("button", { id: "fault-insert", onclick: put }, "Insert");
  const there = element("ul", { id: "faults-there", class: "ways" });
  let quantities = [];

  function number(label, placeholder) {
    const input = element("input", { type: "number", min: 0, step: "any", placeholder, "aria-label": label });
    return { input, node: element("label", {}, label, input) };
  }

  function filter() {
    const wanted = search.value.toLowerCase();
    const kinds = new Map();
    for (const fault of catalogue) {
      if (!`${fault.name} ${fault.meaning} ${fault.kind}`.toLowerCase().includes(wanted)) continue;
      if (!kinds.has(fault.kind)) kinds.set(fault.kind, element("optgroup", { label: fault.kind }));
      kinds.get(fault.kind).append(element("option", { value: fault.name }, fault.name));
    }
    list.replaceChildren(...kinds.values());
    if (list.options.length) list.selectedIndex = 0;
    choose();
  }

  function choose() {
    const fault = catalogue.find((each) => each.name === list.value);
    if (!fault) return;
    say(about, `${fault.meaning}. Effect: ${fault.effect}`);
    quantities = fault.quantities.map((each) => {
      const input = element("input", { type: "number", step: "any", min: each.minimum, max: each.maximum, value: each.default ?? "", title: each.meaning, "aria-label": each.name });
      return { name: each.name, value: () => (input.value === "" ? undefined : input.valueAsNumber), node: element("label", {}, each.name, input) };
    });
    const texts = fault.on_frames ? (fault.about.length ? fault.about : ["message"]) : [];
    quantities.push(...texts.map((name) => {
      const input = element("input", { "aria-label": name, size: 14 });
      return { name, value: () => (input.value === "" ? undefined : Number.isFinite(+input.value) ? +input.value : input.value), node: element("label", {}, name, input) };
    }));
    fields.replaceChildren(...quantities.map((each) => each.node), later.node, lasting.node, ramp.node, insert);
  }

  function put() {
    const keys = Object.fromEntries(quantities.map((each) => [each.name, each.value()]).filter(([, value]) => value !== undefined));
    for (const [name, { input }] of [["at", later], ["for_", lasting], ["ramp", ramp]]) if (input.value !== "") keys[name] = input.valueAsNumber;
    session.command("fault", { fault: list.value, keys }, `fault ${list.value} inserted`);
  }

  let shown = "";
  session.addEventListener("faults", () => {
    const now = [...session.faults].join();
    if (now === shown) return;
    shown = now;
    const items = [...session.faults].map(([name, told]) => element("li", { dataset: { fault: name } }, element("b", {}, name), ` ${told} `,
      element("button", { class: "small", onclick: () => session.command("clear", { names: [name] }, `fault ${name} removed`) }, "remove")));
    there.replaceChildren(...(items.length ? items : [element("li", { class: "dim" }, "none")]));
  });
  session.addEventListener("state", () => { insert.disabled = !session.acts; });
  search.addEventListener("input", filter);
  list.addEventListener("change", choose);
  filter();
  there.append(element("li", { class: "dim" }, "none"));
  return element("div", { class: "split" }, element("div", {}, search, list),
    element("div", {}, about, fields, element("h3", {}, "faults that are there"), there));
}
