// The wiper as SVG in metres: at any crank angle of the turn; its pivots can be dragged at the design position.
import { svg } from "/shared/dom.js";
import { brokenRules } from "./points.js";
import { store } from "./store.js";

const POINTS = ["plant", "linkage", "points_m"];
const LINES = {
  slave_driven: { crank: "OA", coupler: "AB", rocker: "BCD", link: "DE", other: "EF" },
  master_driven: { crank: "OA", coupler: "AB", rocker: "BC", link: "BD", other: "DE" },
  centre_driven: { crank: "OA", coupler: "AB", rocker: "BC", link: "AD", other: "DE" },
};

export class WiperDrawing {
  constructor(withArms = true) {
    this.withArms = withArms;
    this.lines = svg("g");
    this.pivots = svg("g");
    this.turned = svg("g", { transform: "scale(1,-1)" }, this.lines, this.pivots);
    this.node = svg("svg", { class: "drawing", role: "img", "aria-label": "the wiper" }, this.turned);
    this.frame = 0;
    this.made = null;
    this.box = null;
  }

  // What the server has drawn; null while the linkage is broken: then the design points alone are joined.
  show(made) {
    this.made = made;
    this.measure();
    this.draw(this.frame);
  }

  measure() {
    const points = Object.values(store.get(POINTS) || {}).filter(Array.isArray).map(([x, y]) => [x, y]);
    if (this.made && this.withArms) {
      for (let frame = 0; frame < this.made.crank_rad.length; frame += 6) {
        for (const line of this.placed(frame)) points.push(...line.points);
      }
    }
    const xs = points.map(([x]) => x);
    const ys = points.map(([, y]) => y);
    const margin = 0.05 * Math.max(Math.max(...xs) - Math.min(...xs), 0.2);
    this.box = [Math.min(...xs) - margin, -Math.max(...ys) - margin, Math.max(...xs) - Math.min(...xs) + 2 * margin, Math.max(...ys) - Math.min(...ys) + 2 * margin];
    this.node.setAttribute("viewBox", this.box.join(" "));
  }

  // Every body's line at a crank angle, in metres.
  placed(frame) {
    return this.made.bodies.map((body, index) => {
      const [x, y, angle] = this.made.coordinates[frame][index];
      const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
      const points = body.points.map(([, along, across]) => [x + cosine * along - sine * across, y + sine * along + cosine * across]);
      return { name: body.name, part: body.part, points, letters: body.points.map(([letter]) => letter) };
    });
  }

  draw(frame) {
    this.frame = frame;
    const lines = this.made ? this.placed(frame) : this.design();
    const shown = lines.filter((line) => this.withArms || !["arm", "blade"].includes(line.part));
    this.lines.replaceChildren(...shown.map((line) => this.line(line)));
    this.drawPivots(lines);
  }

  line({ name, part, points }) {
    const side = name.startsWith("left_") ? "left" : name.startsWith("right_") ? "right" : "";
    const shape = { class: `${part} ${side}`, "data-body": name };
    if (points.length === 2) {
      const [[x1, y1], [x2, y2]] = points;
      return svg("line", { ...shape, x1, y1, x2, y2 });
    }
    return svg("path", { ...shape, d: `M${points.map((point) => point.join(",")).join(" L")}` });
  }

  design() {
    const linkage = store.get(["plant", "linkage"]) || {};
    const bodies = linkage.bodies || LINES[linkage.kind] || {};
    return Object.entries(bodies).map(([name, letters]) => {
      const known = [...letters].filter((letter) => (linkage.points_m || {})[letter]);
      return { name, part: name === "crank" ? "crank" : "link", points: known.map((letter) => linkage.points_m[letter].slice(0, 2)), letters: known };
    }).filter((line) => line.points.length > 1);
  }

  drawPivots(lines) {
    const size = 0.012 * Math.max(this.box[2], this.box[3]);
    const places = new Map();
    for (const line of lines) {
      (line.letters || []).forEach((letter, index) => { if (letter) places.set(letter, line.points[index]); });
    }
    if (this.frame === 0) for (const [letter, point] of Object.entries(store.get(POINTS) || {})) places.set(letter, point.slice(0, 2));
    this.pivots.replaceChildren(...[...places].flatMap(([letter, [x, y]]) => {
      const wrong = brokenRules(letter);
      const circle = svg("circle", { class: `pivot ${wrong.length ? "wrong" : ""}`, cx: x, cy: y, r: size, "data-point": letter, "stroke-width": 2 });
      circle.append(svg("title", {}, [`${letter}: drag to move`, ...wrong].join("\n")));
      if (this.frame === 0) this.drag(circle, letter);
      const text = svg("text", { x: x + 1.3 * size, y: -(y + 1.3 * size), transform: "scale(1,-1)", "font-size": 2.6 * size }, letter);
      return [circle, text];
    }));
  }

  drag(circle, letter) {
    circle.addEventListener("pointerdown", (down) => {
      circle.setPointerCapture(down.pointerId);
      const move = (event) => {
        const [x, y] = this.at(event);
        circle.setAttribute("cx", x);
        circle.setAttribute("cy", y);
      };
      circle.addEventListener("pointermove", move);
      circle.addEventListener("pointerup", (event) => {
        circle.removeEventListener("pointermove", move);
        const [x, y] = this.at(event);
        const point = store.get([...POINTS, letter]);
        if (Math.hypot(point[0] - x, point[1] - y) < 1e-4) return;
        store.amend([...POINTS, letter], ([, , ...rest]) => [x, y, ...rest]);
      }, { once: true });
    });
  }

  // Where the pointer is, in metres, to a tenth of a millimetre.
  at(event) {
    const inside = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.turned.getScreenCTM().inverse());
    return [inside.x, inside.y].map((value) => Number(value.toFixed(4)));
  }
}
