// One panel with several pages, of which one is seen.
import { element } from "/shared/dom.js";

export class Tabs {
  constructor(pages) {
    this.pages = pages.map(([name, title, node]) => ({ name, title, node }));
    this.buttons = this.pages.map(({ name, title }) => element("button", { role: "tab", id: `tab-${name}`, onclick: () => this.show(name) }, title));
    this.node = element("section", { class: "panel tabs", "aria-label": "More" },
      element("div", { class: "row", role: "tablist" }, ...this.buttons),
      ...this.pages.map(({ node, name }) => { node.setAttribute("role", "tabpanel"); node.id ||= `page-${name}`; return node; }));
    this.show(this.pages[0].name);
  }

  show(name) {
    this.shown = this.pages.some((page) => page.name === name) ? name : this.pages[0].name;
    this.pages.forEach((page, i) => {
      page.node.hidden = page.name !== this.shown;
      this.buttons[i].setAttribute("aria-selected", String(page.name === this.shown));
      this.buttons[i].classList.toggle("chosen", page.name === this.shown);
    });
  }
}
