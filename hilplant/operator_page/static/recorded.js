// A recording instead of a run: a cursor in time, at which all widgets show what was; the plots show a stretch.
import { element, say } from "/shared/dom.js";

export function recorded(session, plots) {
  const slider = element("input", { type: "range", id: "moment", step: "any", "aria-label": "moment in the recording" });
  const told = element("span", { class: "figure", id: "moment-told" });
  const play = element("button", { id: "replay", title: "let the time run", onclick: toggle }, "Play");
  const bar = element("div", { class: "panel row recorded", hidden: true }, play, slider, told);
  let running = 0;
  let waiting = false;

  async function show() {
    const at = slider.valueAsNumber;
    say(told, `${at.toFixed(3)} s of ${session.recorded.name}`);
    plots.setCursor("A", at);
    if (waiting) return;
    waiting = true;
    try {
      session.rowAt = 0;
      await session.link.ask("at", { time_s: at });
    } catch (error) {
      say(told, error.message);
    }
    waiting = false;
    if (slider.valueAsNumber !== at) show();
  }

  function toggle() {
    running = running ? 0 : performance.now();
    say(play, running ? "Stop" : "Play");
    if (running) requestAnimationFrame(step);
  }

  function step(now) {
    if (!running) return;
    slider.value = slider.valueAsNumber + Math.max(0, now - running) / 1000;
    running = now;
    show();
    if (slider.valueAsNumber >= +slider.max) toggle();
    else requestAnimationFrame(step);
  }

  session.addEventListener("state", () => {
    if (!session.recorded || !bar.hidden) return;
    bar.hidden = false;
    slider.min = session.recorded.from_s;
    slider.max = session.recorded.to_s;
    slider.value = session.recorded.from_s;
    document.body.classList.add("of-recording");
    session.say("");
    plots.live();
    show();
  });
  slider.addEventListener("input", show);
  addEventListener("momentset", (event) => {
    slider.value = event.detail;
    show();
  });
  return bar;
}
