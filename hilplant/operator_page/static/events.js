// The event log: commands with their outcome, modes, faults of the bus, logs; the newest on top.
import { element } from "/shared/dom.js";

const MOST = 1000;

export function events(session) {
  const list = element("ol", { class: "events", id: "events", "aria-live": "off" });
  const mark = element("input", { id: "mark", placeholder: "mark in the recording", maxlength: 80, "aria-label": "mark" });
  const put = element("button", { id: "put-mark", onclick: () => session.command("mark", { text: mark.value }, "marked").then(() => { mark.value = ""; }) }, "Mark");
  let newest = 0;
  session.addEventListener("events", (event) => {
    for (const each of event.detail) {
      if (each.number <= newest) continue;
      newest = each.number;
      const bad = ["refused", "count"].includes(each.kind);
      const at = element("button", { class: "figure", title: "show this moment", onclick: () => dispatchEvent(new CustomEvent("momentset", { detail: each.time_s })) });
      const time = session.recorded ? at : element("span", { class: "figure dim" });
      time.append(`${each.time_s.toFixed(3)} s `);
      list.prepend(element("li", { class: bad ? "wrong" : "" }, time, each.words));
    }
    while (list.children.length > MOST) list.lastChild.remove();
  });
  session.addEventListener("state", () => { put.disabled = !session.acts; });
  return element("div", {}, element("div", { class: "row" }, mark, put), list);
}
