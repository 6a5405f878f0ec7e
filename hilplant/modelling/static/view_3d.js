// The wiper in space: the plane of the screen turned by gamma about the x axis, seen from where the pointer turns it.
import { svg } from "/shared/dom.js";

export class View3d {
  constructor() {
    this.node = svg("svg", { class: "drawing", role: "img", "aria-label": "the wiper in space" });
    [this.turn, this.tilt] = [-0.5, 0.35];
    this.lines = [];
    this.node.addEventListener("pointerdown", (down) => {
      this.node.setPointerCapture(down.pointerId);
      let last = [down.clientX, down.clientY];
      const move = (event) => {
        this.turn += (event.clientX - last[0]) / 200;
        this.tilt = Math.max(-1.5, Math.min(1.5, this.tilt + (event.clientY - last[1]) / 200));
        last = [event.clientX, event.clientY];
        this.draw();
      };
      this.node.addEventListener("pointermove", move);
      this.node.addEventListener("pointerup", () => this.node.removeEventListener("pointermove", move), { once: true });
    });
  }

  // Lines in the plane of the screen [m], and gamma: 0 is an upright screen.
  show(lines, gamma) {
    this.lines = lines;
    this.gamma = gamma;
    this.draw();
  }

  // A point of the plane in the vehicle's axes: x to the right, y up, z towards the viewer.
  space([x, y]) {
    return [x, y * Math.cos(this.gamma), y * Math.sin(this.gamma)];
  }

  seen(point) {
    const [x, y, z] = point;
    const across = x * Math.cos(this.turn) + z * Math.sin(this.turn);
    const deep = -x * Math.sin(this.turn) + z * Math.cos(this.turn);
    return [across, -(y * Math.cos(this.tilt) - deep * Math.sin(this.tilt))];
  }

  draw() {
    const all = this.lines.flatMap((line) => line.points);
    if (!all.length) return;
    const [xs, ys] = [all.map(([x]) => x), all.map(([, y]) => y)];
    const corners = [[Math.min(...xs), Math.min(...ys)], [Math.max(...xs), Math.min(...ys)], [Math.max(...xs), Math.max(...ys)], [Math.min(...xs), Math.max(...ys)]];
    const path = (points) => `M${points.map((point) => this.seen(point).join(",")).join(" L")}`;
    const screen = svg("path", { class: "way", d: `${path(corners.map((corner) => this.space(corner)))} Z` });
    const axes = [["x", [0.25, 0, 0]], ["y", [0, 0.25, 0]], ["z", [0, 0, 0.25]]].flatMap(([name, end]) => {
      const [x, y] = this.seen(end);
      return [svg("path", { class: "wire", d: path([[0, 0, 0], end]) }), svg("text", { x, y, "font-size": 0.04 }, name)];
    });
    const lines = this.lines.map((line) => {
      const side = line.name.startsWith("left_") ? "left" : line.name.startsWith("right_") ? "right" : "";
      return svg("path", { class: `${line.part} ${side}`, d: path(line.points.map((point) => this.space(point))) });
    });
    const reach = 1.1 * Math.max(...all.map(([x, y]) => Math.hypot(x, y)), 0.3);
    this.node.setAttribute("viewBox", `${-reach} ${-reach} ${2 * reach} ${1.6 * reach}`);
    this.node.replaceChildren(screen, ...axes, ...lines);
  }
}
