// Puts the operator's page together: the layout of Figure 8-9, and below it what goes beyond.
import { api } from "/shared/access.js";
import { element, say } from "/shared/dom.js";
import "/shared/theme.js";
import { circuit } from "./circuit.js";
import { ecu } from "./ecu.js";
import { events } from "./events.js";
import { faults } from "./faults.js";
import { frames } from "./frames.js";
import { health } from "./health.js";
import { inputs } from "./inputs.js";
import { HELP, keys } from "./keys.js";
import { layouts } from "./layouts.js";
import { logger } from "./logger.js";
import { manual } from "./manual.js";
import { numbers } from "./numbers.js";
import { Plots } from "./plots.js";
import { power } from "./power.js";
import { recorded } from "./recorded.js";
import { scenarios } from "./scenarios.js";
import { Session } from "./session.js";
import { Tabs } from "./tabs.js";
import { wiper } from "./wiper.js";

async function start() {
  const description = await api("description");
  const session = new Session(description);
  const top = health(session);
  const plots = new Plots(session);
  const tabs = new Tabs([
    ["inputs", "Weather, wear, load", inputs(session)],
    ["faults", "Faults", faults(session)],
    ["scenarios", "Scenarios", scenarios(session)],
    ["frames", "Frames", frames(session)],
    ["ecu", "ECU chart", ecu(session)],
    ["circuit", "Park circuit", circuit(session)],
    ["events", "Events", events(session)],
  ]);
  const note = element("div", { class: "message", id: "note", role: "status" });
  session.addEventListener("note", ({ detail }) => {
    say(note, detail.words);
    note.classList.toggle("wrong", detail.wrong);
  });
  plots.node.querySelector("h2 .row").prepend(layouts(plots, tabs));
  const bar = recorded(session, plots);
  keys(session, plots);
  document.title = `${description.bench} - hilplant`;
  document.body.replaceChildren(top.node, top.banner,
    element("main", {},
      element("div", { class: "column" }, logger(session, plots), power(session), manual(session)),
      element("div", { class: "column" }, wiper(session), numbers(session)),
      plots.node,
      element("div", { class: "wide" }, tabs.node)),
    bar,
    element("footer", {}, note, element("span", { class: "dim" }, HELP)));
  window.hilplant = { session, plots };
}

start().catch((error) => {
  document.body.replaceChildren(element("p", { class: "banner bad", role: "alert" }, `This page cannot be shown: ${error.message}`));
});
