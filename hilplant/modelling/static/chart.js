// A chart over uPlot: columns in, lines out; drawn again when the page gets wider or darker.
import { element } from "/shared/dom.js";
import { colour } from "/shared/theme.js";

export function chart(title, x, series, options = {}) {
  const box = element("div", { class: "chart", dataset: { title } });
  let plot = null;
  let data = [[], ...series.map(() => [])];
  const axis = (label) => ({ label, labelSize: 18, size: label === x ? 34 : 54, stroke: colour("dim"), grid: { stroke: colour("edge"), width: 0.5 }, ticks: { stroke: colour("edge"), width: 0.5 } });
  const made = () => {
    const width = Math.max(220, box.clientWidth || 460);
    return {
      title, width, height: options.height || 170, scales: { x: { time: false } }, legend: { show: series.length > 1, live: false },
      cursor: { drag: { x: true, y: false } },
      series: [{}, ...series.map((each, index) => ({ label: each.label, stroke: colour(each.colour || `s${(index % 8) + 1}`), width: each.width || 1.5, dash: each.dash, points: { show: Boolean(each.points) } }))],
      axes: [axis(x), axis(options.y || "")],
      hooks: options.marks ? { draw: [(drawn) => marks(drawn, options.marks())] } : {},
    };
  };
  const draw = () => {
    if (!box.isConnected) return;
    if (plot) plot.destroy();
    plot = new window.uPlot(made(), data, box);
  };
  box.show = (columns) => {
    data = columns;
    if (plot) plot.setData(data);
    else requestAnimationFrame(draw);
  };
  addEventListener("themechange", draw);
  new ResizeObserver(() => plot && plot.setSize({ width: Math.max(220, box.clientWidth), height: options.height || 170 })).observe(box);
  return box;
}

// Lines first, so that none of them goes through a text.
function marks(plot, places) {
  const { ctx, bbox } = plot;
  const shown = places.map(([x, text], index) => ({ at: plot.valToPos(x, "x", true), text, down: bbox.top + (10 + 13 * index) * devicePixelRatio }))
    .filter(({ at }) => at >= bbox.left && at <= bbox.left + bbox.width);
  ctx.save();
  ctx.strokeStyle = colour("dim");
  ctx.setLineDash([4, 4]);
  for (const { at } of shown) {
    ctx.beginPath();
    ctx.moveTo(at, bbox.top);
    ctx.lineTo(at, bbox.top + bbox.height);
    ctx.stroke();
  }
  for (const { at, text, down } of shown) {
    const before = at > bbox.left + bbox.width / 2;
    const [left, wide] = [at + (before ? -3 : 3), ctx.measureText(text).width];
    ctx.textAlign = before ? "right" : "left";
    ctx.fillStyle = colour("panel");
    ctx.fillRect(before ? left - wide - 2 : left - 2, down - 9 * devicePixelRatio, wide + 4, 12 * devicePixelRatio);
    ctx.fillStyle = colour("dim");
    ctx.fillText(text, left, down);
  }
  ctx.restore();
}
