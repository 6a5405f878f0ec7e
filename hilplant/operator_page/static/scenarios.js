// Scenarios: start and stop, how far one is, and the verdicts on what it expects as they fall.
import { choice, element, say } from "/shared/dom.js";

const CLASS = { pass: "good", fail: "bad", open: "", later: "", blocked: "warn", inconclusive: "warn" };

export function scenarios(session) {
  const { description } = session;
  const list = choice(description.scenarios.map((name) => [name, name]), { id: "scenario", "aria-label": "scenario" });
  const start = element("button", { id: "scenario-start", onclick: () => session.command("scenario", { name: list.value }, `scenario ${list.value} started`) }, "Start");
  const stop = element("button", { id: "scenario-stop", onclick: () => session.command("scenario", { name: null }, "scenario stopped") }, "Stop");
  const progress = element("progress", { id: "scenario-progress", max: 1, value: 0 });
  const told = element("span", { id: "scenario-told", class: "figure" });
  const body = element("tbody", { id: "verdicts" });

  function show(play) {
    const running = play?.state === "running";
    start.disabled = !session.acts || running;
    stop.disabled = !session.acts || !running;
    if (!play?.name) return;
    progress.value = play.at_s / play.seconds;
    say(told, `${play.name}: ${play.at_s.toFixed(1)} of ${play.seconds} s, ${play.state}`);
    play.verdicts.forEach((each, i) => {
      const line = body.children[i] || body.appendChild(element("tr", {}, element("td"), element("td"), element("td", { class: "figure" })));
      const [ruling, text, margin] = line.children;
      if (!ruling.firstChild) ruling.append(element("span", { class: "tag" }));
      say(ruling.firstChild, each.ruling);
      ruling.firstChild.className = `tag ${CLASS[each.ruling] || ""}`;
      say(text, each.text + (each.reason ? ` (${each.reason})` : ""));
      say(margin, each.margin === null || each.margin === undefined ? "" : `${+each.margin.toPrecision(4)} ${each.unit}`);
    });
    while (body.children.length > play.verdicts.length) body.lastChild.remove();
  }

  session.addEventListener("state", () => show(session.state.scenario));
  session.addEventListener("frames", (event) => show(event.detail.scenario));
  return element("div", {}, element("div", { class: "row" }, list, start, stop, progress, told),
    element("table", {}, element("thead", {}, element("tr", {}, ...["verdict", "expected", "margin"].map((each) => element("th", {}, each)))), body),
    element("p", { class: "dim small-text" }, "Inputs change within 10 ms of their time and are held as by hand; what has to be exact to the tick: hilplant test."));
}
