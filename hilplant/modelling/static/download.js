// Files out of the page: made here, or asked for with the token.
import { token } from "/shared/access.js";
import { element } from "/shared/dom.js";
import { store } from "./store.js";

export function download(name, content) {
  const address = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type: "text/plain" }));
  const link = element("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

export async function fetched(path, name) {
  const answer = await fetch(`/api/${path}`, { headers: { authorization: `Bearer ${token()}` } });
  if (!answer.ok) {
    store.say(await answer.text(), true);
    return;
  }
  download(name, await answer.blob());
}

export async function upload(file) {
  const headers = { authorization: `Bearer ${token()}`, "content-type": "application/octet-stream" };
  const answer = await fetch(`/api/upload?name=${encodeURIComponent(file.name)}`, { method: "POST", headers, body: file });
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer.json();
}
