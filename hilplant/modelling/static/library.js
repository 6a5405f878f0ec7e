// A part of the library, with its source and status, in place of the one that the model has.
import { api } from "/shared/access.js";
import { choice, element } from "/shared/dom.js";
import { listen } from "./field.js";
import { store } from "./store.js";

let library = null;

export async function shipped() {
  library = library || await api("library", {});
  return library;
}

export function libraryChoice(part, kind) {
  const select = choice([["", "from the library ..."]], { "aria-label": `${part} from the library` });
  const about = element("p", { class: "dim" });
  const refresh = () => {
    const now = store.get(["plant", part]) || {};
    about.textContent = `${now.name || ""} (${now.status || "?"}): ${now.source || ""}`.slice(0, 220);
  };
  shipped().then((found) => {
    for (const each of found[kind]) select.append(element("option", { value: each.name, title: each.source }, `${each.name} (${each.status})`));
  });
  select.addEventListener("change", async () => {
    if (select.value) await store.change("part", { part, name: select.value });
    select.value = "";
  });
  listen(about, refresh);
  refresh();
  return element("div", {}, select, about);
}
