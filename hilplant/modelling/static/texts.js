// The files as text, always in sight: changed there or by the form, with all that is wrong at its line.
import { element } from "/shared/dom.js";
import { store } from "./store.js";

export function texts(node) {
  const tabs = element("div", { class: "row", role: "tablist" });
  const area = element("textarea", { spellcheck: "false", wrap: "off", "aria-label": "text of the file" });
  const lines = element("pre", { "aria-hidden": "true" });
  const problems = element("div", { class: "problems panel" });
  const box = element("div", { class: "yaml" }, lines, area);
  let file = "bench.yaml";
  let timer = null;

  const number = () => {
    const wrong = new Map(store.state.problems.filter((each) => each.file === file).map((each) => [each.line, each.severity === "error" ? "bad" : "warn"]));
    const count = area.value.split("\n").length;
    lines.replaceChildren(...Array.from({ length: count }, (_, index) => element("span", { class: wrong.get(index + 1) || "" }, `${index + 1}\n`)));
    area.style.height = `${count * 1.45 * 12 + 18}px`;
    area.style.width = `${Math.max(10, ...area.value.split("\n").map((line) => line.length)) * 7.4 + 24}px`;
  };

  const send = async () => {
    timer = null;
    if (area.value !== store.state.files[file]) await store.change("text", { file, text: area.value });
  };

  const open = async (name, line = 0) => {
    if (timer) { clearTimeout(timer); await send(); }
    file = name;
    refresh();
    if (line) {
      const begin = area.value.split("\n").slice(0, line - 1).join("\n").length;
      area.focus();
      area.setSelectionRange(begin + (line > 1 ? 1 : 0), begin + area.value.split("\n")[line - 1].length + 1);
      box.scrollTop = Math.max(0, (line - 4) * 1.45 * 12);
    }
  };

  const refresh = () => {
    const { files } = store.state;
    if (!(file in files)) file = store.state.bench;
    tabs.replaceChildren(...Object.keys(files).map((name) => {
      const count = store.state.problems.filter((each) => each.file === name).length;
      return element("button", { role: "tab", "aria-selected": String(name === file), class: name === file ? "chosen" : "", onclick: () => open(name) }, name + (count ? ` (${count})` : ""));
    }));
    if (timer === null && area.value !== files[file]) area.value = files[file];
    number();
    const found = store.state.problems.map((each) => element("li", { class: each.severity === "error" ? "" : "dim", dataset: { at: each.location.join(".") } },
      element("button", { onclick: () => (each.file in files ? open(each.file, each.line) : null) }, `${each.file}:${each.line}: ${each.severity === "warning" ? "warning: " : ""}${each.text}`)));
    const errors = store.state.problems.filter((each) => each.severity === "error").length;
    problems.replaceChildren(element("h2", {}, errors ? `${errors} problem${errors > 1 ? "s" : ""}` : "nothing is wrong", element("span", { class: `tag ${errors ? "bad" : "good"}`, id: "verdict" }, errors ? "does not run" : "can run")), element("ul", {}, ...found));
  };

  area.addEventListener("input", () => { clearTimeout(timer); timer = setTimeout(send, 600); number(); });
  area.addEventListener("blur", () => { if (timer) { clearTimeout(timer); send(); } });
  store.addEventListener("changed", refresh);
  store.addEventListener("show-file", ({ detail }) => open(detail.file));
  node.append(element("div", { class: "row" }, tabs), box, problems);
  refresh();
}
