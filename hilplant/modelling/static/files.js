// Open, save, undo: what stands at the head of the page.
import { element } from "/shared/dom.js";
import { toggleTheme } from "/shared/theme.js";
import { fetched } from "./download.js";
import { shipped } from "./library.js";
import { store } from "./store.js";

export function head(node) {
  const name = element("span", { class: "dim", id: "where" });
  const said = element("span", { class: "message", role: "alert", id: "said" });
  const undo = element("button", { id: "undo", onclick: () => store.change("undo") }, "Undo");
  const redo = element("button", { id: "redo", onclick: () => store.change("redo") }, "Redo");
  const refresh = () => {
    const { state } = store;
    name.textContent = `${store.get(["name"]) || "?"}: ${state.folder ? `${state.folder}${state.saved ? "" : ", changed"}` : "not saved yet"}`;
    undo.disabled = state.undo === 0;
    redo.disabled = state.redo === 0;
  };
  store.addEventListener("changed", refresh);
  store.addEventListener("said", ({ detail }) => { said.textContent = detail.text; said.classList.toggle("wrong", detail.wrong); });
  refresh();
  node.append(element("h1", {}, "Windscreen Wiper System Modelling Tool"), name, element("button", { id: "open", onclick: openDialog }, "Open"), element("button", { id: "save", onclick: saveDialog }, "Save"),
    element("button", { id: "zip", onclick: () => fetched("zip", "wiper.zip") }, "Zip"), undo, redo, element("button", { onclick: toggleTheme }, "Dark / light"), said);
  addEventListener("beforeunload", (event) => { if (!store.state.saved && store.state.undo > 0) event.preventDefault(); });
}

function dialogOf(title, ...children) {
  const dialog = element("dialog", {}, element("h2", {}, title), ...children);
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}

async function openDialog() {
  const path = element("input", { placeholder: "path of a bench file", size: 50, "aria-label": "bench to open" });
  const rows = (await shipped()).benches.map((each) => element("tr", {}, element("td", {}, element("button", { onclick: () => open(each.name) }, each.name)), element("td", {}, each.about)));
  const dialog = dialogOf("Open a bench", element("div", { class: "row" }, path, element("button", { onclick: () => open(path.value) }, "Open"), element("button", { onclick: () => dialog.close() }, "Cancel")),
    element("p", { class: "dim" }, "A shipped bench is opened as a new one over it, with its parts to be changed."), element("div", { class: "scroll" }, element("table", {}, ...rows)));
  const open = async (bench) => { if (await store.change("open", { bench })) dialog.close(); };
}

export function saveDialog() {
  const folder = element("input", { value: store.state.folder || "", placeholder: "folder, such as my_wiper", size: 50, "aria-label": "folder" });
  const overwrite = element("input", { type: "checkbox", "aria-label": "overwrite" });
  const said = element("p", { class: "message wrong" });
  const save = async () => {
    const heard = ({ detail }) => { said.textContent = detail.text; };
    store.addEventListener("said", heard);
    if (await store.change("save", { folder: folder.value, overwrite: overwrite.checked })) dialog.close();
    store.removeEventListener("said", heard);
  };
  const dialog = dialogOf("Save all files in a folder", element("div", { class: "row" }, folder, element("button", { id: "save-now", onclick: save }, "Save"), element("button", { onclick: () => dialog.close() }, "Cancel")),
    element("label", {}, overwrite, "overwrite what others have changed there"), said, element("ul", {}, ...[...Object.keys(store.state.files), ...store.state.others].map((file) => element("li", {}, file))));
}
