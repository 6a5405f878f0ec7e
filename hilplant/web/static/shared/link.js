// The socket of a page: shows the token, sends requests and hears their answers, comes back when it was lost.
import { token } from "/shared/access.js";

const WORDS = {
  1008: "refused by the server: another origin, or too many pages",
  4401: "the token is wrong: open the address that the program has printed",
  4408: "this browser was too slow",
  4429: "this page has sent too much",
};

export class Link extends EventTarget {
  // Events: open; closed (detail: words); data (detail: Float64Array); told (detail: object without an id).
  constructor() {
    super();
    this.number = 0;
    this.waiting = new Map();
    this.pause = 250;
    this.connect();
  }

  connect() {
    this.socket = new WebSocket(`ws://${location.host}/socket`);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => {
      this.socket.send(JSON.stringify({ token: token() }));
      this.pause = 250;
      this.dispatchEvent(new Event("open"));
    };
    this.socket.onmessage = (event) => this.heard(event.data);
    this.socket.onclose = (event) => this.lost(event.code);
  }

  heard(data) {
    if (data instanceof ArrayBuffer) {
      this.dispatchEvent(new CustomEvent("data", { detail: new Float64Array(data) }));
      return;
    }
    const told = JSON.parse(data);
    const waiting = this.waiting.get(told.id);
    if (!waiting) {
      this.dispatchEvent(new CustomEvent("told", { detail: told }));
      return;
    }
    this.waiting.delete(told.id);
    if (told.error) waiting.reject(new Error(told.error));
    else waiting.resolve(told);
  }

  lost(code) {
    const words = WORDS[code] || "the server does not answer";
    for (const { reject } of this.waiting.values()) reject(new Error(words));
    this.waiting.clear();
    this.dispatchEvent(new CustomEvent("closed", { detail: words }));
    if (code === 4401) return;
    setTimeout(() => this.connect(), this.pause);
    this.pause = Math.min(5000, this.pause * 2);
  }

  get open() {
    return this.socket.readyState === WebSocket.OPEN;
  }

  // Ask and wait for the answer; an Error with the server's words where it refuses.
  ask(wanted, more = {}) {
    if (!this.open) return Promise.reject(new Error("not connected"));
    this.number += 1;
    const id = this.number;
    this.socket.send(JSON.stringify({ id, do: wanted, ...more }));
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  // Say something that has no answer.
  say(wanted, more = {}) {
    if (this.open) this.socket.send(JSON.stringify({ do: wanted, ...more }));
  }
}
