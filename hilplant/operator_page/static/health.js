// The loop's health, always in sight: mode, overruns, latency, ring, and who has the lead.
import { element, say } from "/shared/dom.js";
import { toggleTheme } from "/shared/theme.js";

const GOOD = { running: "good", waiting: "warn", degraded: "warn", safe: "bad", stopped: "bad", behind: "bad" };

export function health(session) {
  const { description, samples } = session;
  const modes = description.status.find((signal) => signal.name === "mode").choices;
  const recordings = description.status.find((signal) => signal.name === "recording").choices;
  const item = (id, title) => element("span", { class: "tag figure", id, title });
  const mode = item("mode", "what the loop is doing");
  const overruns = item("overruns", "periods lost because a tick came late");
  const latency = item("latency", "longest delay from a deadline to the start of its tick");
  const p99 = item("latency-p99", "99 of 100 ticks of the last ten seconds began no later than this");
  const lost = item("ring-lost", "rows the recorder was too slow for, and rows this page was too slow for");
  const recording = item("recording", "whether ticks and frames are recorded");
  const time = item("time", "time of the run");
  const lead = element("button", { id: "lead", onclick: () => take() });
  const asking = element("span", { class: "tag warn", id: "asking", hidden: true });
  const banner = element("div", { class: "banner bad", id: "banner", role: "alert", hidden: true });
  const theme = element("button", { title: "dark or light (T)", onclick: toggleTheme }, "◐");

  function take() {
    session.link.ask("lead", { want: !session.leads }).catch((error) => say(lead, error.message));
  }

  function row() {
    const value = (name) => session.samples.value(`status.${name}`);
    const name = modes[value("mode")] || "?";
    say(mode, name);
    mode.className = `tag figure ${GOOD[name] || "bad"}`;
    say(overruns, `overruns ${value("overruns")}`);
    overruns.classList.toggle("bad", value("overruns") > 0);
    say(latency, `worst ${value("worst_latency_us")} µs`);
    say(lost, `lost ${value("ring_lost")} + ${session.samples.lost}`);
    lost.classList.toggle("bad", value("ring_lost") > 0);
    say(recording, recordings[value("recording")] === "off" ? "not recorded" : `recording ${recordings[value("recording")]}`);
    recording.classList.toggle("bad", value("recording") === 2);
    say(time, `${session.samples.timeS.toFixed(1)} s`);
  }

  function state() {
    const { state: told, leads } = session;
    say(lead, leads ? "You have the lead: give it up" : told.lead === null ? "Take the lead" : told.asking.includes(session.page) ? "Asked for the lead" : "Watching: ask for the lead");
    lead.setAttribute("aria-pressed", String(leads));
    lead.hidden = told.recorded !== undefined;
    const others = told.asking.filter((page) => page !== session.page);
    asking.hidden = !(leads && others.length);
    say(asking, `${others.length} page${others.length > 1 ? "s" : ""} asking for the lead`);
    document.body.classList.toggle("off", !session.acts);
  }

  session.addEventListener("row", row);
  session.addEventListener("state", state);
  session.addEventListener("frames", (event) => say(p99, `p99 ${event.detail.late_p99_us ?? "-"} µs`));
  session.addEventListener("stale", (event) => {
    banner.hidden = event.detail === "";
    say(banner, `No new data since ${samples.timeS.toFixed(1)} s: ${event.detail}. What you see is old; controls are off.`);
  });
  return {
    node: element("header", { class: "health" }, element("h1", {}, description.bench),
      element("span", { class: "dim" }, description.interface), mode, overruns, latency, p99, lost, recording, time,
      element("span", { class: "grow" }), asking, lead, theme),
    banner,
  };
}
