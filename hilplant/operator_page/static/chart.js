// One chart: uPlot over the session's samples, a scale for each unit, two cursors with values and differences.
import { element, figure, say } from "/shared/dom.js";
import { colour } from "/shared/theme.js";

const COLOURS = ["s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8"];
// Width of an axis at a side and of its label [px]: equal in all charts, so that their times stand under each other.
const [SIDE, LABEL] = [68, 16];

export class Chart {
  // `plots` has the common time axis: range(), zoom(from, to), live(), cursors, changed().
  constructor(plots, session, names) {
    this.plots = plots;
    this.session = session;
    this.names = names;
    this.data = [new Float64Array(0)];
    this.legend = element("div", { class: "legend row" });
    this.canvas = element("div", { class: "canvas" });
    this.node = element("section", { class: "chart", "aria-label": "chart" }, this.legend, this.canvas);
    this.build();
    new ResizeObserver(() => this.fit()).observe(this.canvas);
  }

  unit(name) {
    const signal = this.plots.signal(name);
    return signal.kind === "flag" || signal.kind === "choice" ? signal.kind : signal.unit || "1";
  }

  build() {
    this.plot?.destroy();
    const units = [...new Set(this.names.map((name) => this.unit(name)))];
    const scales = { x: { time: false, auto: false } };
    for (const unit of units) scales[unit] = unit === "flag" ? { range: [-0.1, 1.1] } : { range: padded };
    const axis = { stroke: colour("dim"), grid: { stroke: colour("edge"), width: 0.5 }, ticks: { stroke: colour("edge") }, font: "11px system-ui" };
    const sides = units.slice(0, 2).map((unit, i) => {
      const label = unit === "flag" || unit === "choice" || unit === "1" ? undefined : unit;
      return { ...axis, scale: unit, side: i ? 1 : 3, size: label ? SIDE - LABEL : SIDE, grid: { ...axis.grid, show: i === 0 }, label, labelSize: LABEL, labelFont: "11px system-ui" };
    });
    this.right = sides.length > 1;
    this.plot = new uPlot({
      width: Math.max(100, this.canvas.clientWidth),
      height: Math.max(80, this.canvas.clientHeight),
      legend: { show: false },
      cursor: { sync: { key: "hilplant", setSeries: false }, drag: { x: true, y: false, setScale: false }, points: { show: false } },
      scales,
      padding: [null, () => (this.plots.charts.some((each) => each.right) ? (this.right ? 0 : SIDE) : 12), null, null],
      axes: [{ ...axis, size: 28, values: (_, ticks) => ticks.map((tick) => `${+tick.toFixed(3)}`) }, ...sides],
      series: [{}, ...this.names.map((name, i) => this.series(name, i))],
      hooks: {
        setSelect: [(plot) => this.selected(plot)],
        draw: [(plot) => this.drawCursors(plot)],
      },
    }, this.data.length === this.names.length + 1 ? this.data : [[], ...this.names.map(() => [])], this.canvas);
    this.plot.over.addEventListener("dblclick", () => this.plots.live());
    this.plot.over.addEventListener("click", (event) => this.clicked(event));
    this.write();
  }

  // Whole pixels of the screen: without a graphics card a line of 1.5 pixels costs four times as much as one of 1.
  series(name, i) {
    const steps = this.unit(name) === "flag" || this.unit(name) === "choice";
    return {
      stroke: colour(COLOURS[i % COLOURS.length]), width: Math.floor(devicePixelRatio) / devicePixelRatio || 1, scale: this.unit(name), points: { show: false },
      dash: i >= COLOURS.length ? [6, 3] : undefined, paths: steps ? uPlot.paths.stepped({ align: 1 }) : undefined,
    };
  }

  fit() {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth > 50 && clientHeight > 50) this.plot.setSize({ width: clientWidth, height: clientHeight });
  }

  draw(data, [from, to]) {
    this.data = data;
    this.plot.batch(() => {
      this.plot.setData(data, false);
      this.plot.setScale("x", { min: from, max: to });
    });
  }

  selected(plot) {
    const { left, width } = plot.select;
    if (width < 5) return;
    this.plots.zoom(plot.posToVal(left, "x"), plot.posToVal(left + width, "x"));
    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
  }

  clicked(event) {
    if (!this.plots.cursorsOn) return;
    const at = this.plot.posToVal(event.offsetX, "x");
    this.plots.setCursor(event.shiftKey ? "B" : "A", at);
  }

  drawCursors(plot) {
    for (const [name, at] of Object.entries(this.plots.cursors)) {
      if (at === null) continue;
      const x = plot.valToPos(at, "x", true);
      const { left, top, width, height } = plot.bbox;
      if (x < left || x > left + width) continue;
      const { ctx } = plot;
      ctx.save();
      ctx.strokeStyle = ctx.fillStyle = colour(name === "A" ? "good" : "warn");
      ctx.setLineDash([5, 3]);
      ctx.beginPath();
      ctx.moveTo(x, top);
      ctx.lineTo(x, top + height);
      ctx.stroke();
      ctx.font = "bold 12px system-ui";
      ctx.fillText(name, x + 3, top + 12);
      ctx.restore();
    }
  }

  // The value of a signal at a time, as it is drawn: that of the last sample before it.
  at(name, timeS) {
    const times = this.data[0];
    const values = this.data[this.names.indexOf(name) + 1];
    let low = 0;
    let high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] <= timeS) low = middle + 1;
      else high = middle;
    }
    return low && values ? values[low - 1] : NaN;
  }

  // The legend: each signal with its newest value, or those at the cursors and their difference.
  write() {
    const items = this.names.map((name, i) => {
      const value = element("span", { class: "figure" });
      const mark = element("span", { class: "mark", style: undefined });
      mark.style.background = colour(COLOURS[i % COLOURS.length]);
      const remove = element("button", { class: "small", title: `remove ${name}`, "aria-label": `remove ${name}`, onclick: () => this.plots.remove(this, name) }, "×");
      return { name, value, node: element("span", { class: "entry", title: this.plots.signal(name).meaning }, mark, name, value, remove) };
    });
    this.entries = items;
    this.legend.replaceChildren(...items.map((item) => item.node), this.plots.picker(this));
  }

  tell() {
    const { A, B } = this.plots.cursors;
    for (const { name, value } of this.entries) {
      const signal = this.plots.signal(name);
      if (A === null) {
        say(value, this.plots.words(signal, this.plots.newest(name)));
        continue;
      }
      const atA = this.at(name, A);
      const atB = B === null ? NaN : this.at(name, B);
      const difference = B === null ? "" : `  B ${figure(atB)}  Δ ${figure(atB - atA, signal.unit)}`;
      say(value, `A ${figure(atA, B === null ? signal.unit : "")}${difference}`);
    }
  }
}

function padded(plot, least, greatest) {
  if (least === null || !Number.isFinite(least)) return [0, 1];
  const span = greatest - least;
  const pad = span > 1e-9 ? span * 0.08 : Math.max(Math.abs(greatest) * 0.1, 0.5);
  return [least - pad, greatest + pad];
}
