// The bus by message: period, jitter, counter, age, values, raw bytes; and the faults of the bus by their cause.
import { element, figure, say } from "/shared/dom.js";

const CAUSES = ["unknown_frame", "wrong_length", "remote_frame", "fd_frame", "error_frame", "non_finite", "out_of_range", "wrong_crc", "wrong_counter",
  "timeout", "queue_full", "missed_frame", "link_down", "saturated", "own_identifier", "alternating", "stale_frame", "e2e_not_valid"];

export function frames(session) {
  const body = element("tbody");
  const causes = element("div", { class: "row", id: "causes" });
  const raw = element("input", { type: "checkbox", id: "raw" });
  const known = session.description.status.filter((each) => CAUSES.includes(each.name));
  const tags = known.map((each) => ({ name: each.name, node: element("span", { class: "tag figure", title: each.meaning }) }));
  causes.append(...tags.map((tag) => tag.node));
  const node = element("div", {}, element("label", {}, raw, "raw bytes"), causes,
    element("table", { id: "frames" }, element("thead", {}, element("tr", {}, ...["id", "message", "from", "period ms", "jitter ms", "count", "age s", "values"].map((each) => element("th", {}, each)))), body));
  const rows = new Map();

  function rowOf(told) {
    const key = `${told.id} ${told.from}`;
    if (!rows.has(key)) {
      const cells = Array.from({ length: 8 }, (_, i) => element("td", { class: i >= 3 && i <= 6 ? "figure" : i === 7 ? "values" : "" }));
      const made = element("tr", { dataset: { message: told.name } }, ...cells);
      rows.set(key, { cells, node: made });
      body.append(made);
    }
    return rows.get(key);
  }

  session.addEventListener("frames", (event) => {
    if (!session.recorded && !node.offsetParent) return; // of a recording no other will come
    const there = new Set(event.detail.rows.map((told) => `${told.id} ${told.from}`));
    for (const [key, { node: line }] of rows) if (!there.has(key)) line.remove(), rows.delete(key);
    for (const told of event.detail.rows) {
      const { cells, node: line } = rowOf(told);
      const values = Object.entries(told.values).map(([name, value]) => `${name} ${typeof value === "number" ? +value.toPrecision(5) : value}`);
      const texts = [told.id, `${told.name || "unknown"}${told.kind ? ` (${told.kind})` : ""}`, told.from, told.period_ms === null ? "-" : figure(told.period_ms),
        told.jitter_ms === null ? "-" : figure(told.jitter_ms), String(told.count), told.age_s.toFixed(2), raw.checked ? told.raw : values.join("  ")];
      texts.forEach((text, i) => say(cells[i], text));
      line.classList.toggle("late", told.timeout_s > 0 && told.age_s > told.timeout_s);
    }
    for (const { name, node: tag } of tags) {
      const count = session.samples.value(`status.${name}`);
      say(tag, `${name} ${count}`);
      tag.classList.toggle("bad", count > 0);
    }
  });
  return node;
}
