// Layouts: charts, window and open tab under a name, kept in this browser; the last one is there after a reload.
import { choice, element } from "/shared/dom.js";

const KEY = "hilplant-layouts";
const LAST = "(last)";

export function layouts(plots, tabs) {
  const saved = read();
  const select = choice([], { id: "layout", "aria-label": "layout", title: "load a layout" });
  const save = element("button", { id: "layout-save", title: "save what is seen under a name", onclick: keep }, "Save layout");
  const remove = element("button", { class: "small", title: "forget this layout", "aria-label": "forget this layout", onclick: forget }, "×");

  function read() {
    try {
      return JSON.parse(localStorage.getItem(KEY)) || {};
    } catch {
      return {};
    }
  }

  function write() {
    localStorage.setItem(KEY, JSON.stringify(saved));
    const names = Object.keys(saved).filter((name) => name !== LAST);
    select.replaceChildren(...["layout", ...names].map((name, i) => element("option", { value: i ? name : "" }, name)));
  }

  function now() {
    return { plots: plots.get(), tab: tabs.shown };
  }

  function keep() {
    const name = prompt("name of the layout");
    if (!name) return;
    saved[name.slice(0, 60)] = now();
    write();
    select.value = name.slice(0, 60);
  }

  function forget() {
    delete saved[select.value];
    write();
  }

  function load(layout) {
    if (!layout) return;
    plots.set(layout.plots);
    tabs.show(layout.tab);
  }

  select.addEventListener("change", () => load(saved[select.value]));
  addEventListener("pagehide", () => {
    saved[LAST] = now();
    localStorage.setItem(KEY, JSON.stringify(saved));
  });
  write();
  load(saved[LAST]);
  return element("span", { class: "row" }, select, save, remove);
}
