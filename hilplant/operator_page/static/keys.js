// Keys for what an operator does often; none while a field is being filled in.
import { toggleTheme } from "/shared/theme.js";

const STALK = { o: "off", s: "slow", f: "fast", x: "flick", w: "wash", a: "automatic" };
export const HELP = "Keys: O off, S slow, F fast, X flick, W wash, A automatic, 1 to 6 intermittent, 0 main power off, P pause, C cursors, L log, T dark or light";

export function keys(session, plots) {
  addEventListener("keydown", (event) => {
    const { target, key } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || target.closest?.("input, select, textarea")) return;
    const wanted = key.toLowerCase();
    if (STALK[wanted]) session.stalk(STALK[wanted]);
    else if (/^[1-6]$/.test(wanted)) session.stalk(`intermittent${wanted}`);
    else if (wanted === "0") press("power-off");
    else if (wanted === "p") plots.togglePause();
    else if (wanted === "c") plots.toggleCursors();
    else if (wanted === "t") toggleTheme();
    else if (wanted === "l") press(document.getElementById("log-stop").disabled ? "log-start" : "log-stop");
    else return;
    event.preventDefault();
  });
}

function press(id) {
  const button = document.getElementById(id);
  if (button && !button.disabled) button.click();
}
