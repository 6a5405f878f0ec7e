// Elements of a page, made in one call: element("button", { title: "..." , onclick: f }, "text", child).
const SVG = "http://www.w3.org/2000/svg";

export function element(tag, properties = {}, ...children) {
  return filled(document.createElement(tag), properties, children);
}

export function svg(tag, properties = {}, ...children) {
  return filled(document.createElementNS(SVG, tag), properties, children);
}

function filled(node, properties, children) {
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (name === "dataset") Object.assign(node.dataset, value);
    else if (typeof value === "boolean") node.toggleAttribute(name, value);
    else if (value !== undefined && value !== null) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== undefined && child !== null));
  return node;
}

// Write a text only where it changes: a page that changes nothing is drawn for nothing.
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

export function choice(options, properties = {}) {
  const made = options.map(([value, text]) => element("option", { value }, text));
  return element("select", properties, ...made);
}

// A number as it is read: four significant digits, no exponent where none is needed.
export function figure(value, unit = "") {
  if (!Number.isFinite(value)) return "-";
  const size = Math.abs(value);
  const digits = size >= 1000 || size === 0 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : 3;
  const text = size !== 0 && (size < 0.001 || size >= 1e6) ? value.toExponential(2) : value.toFixed(digits);
  return unit ? `${text} ${unit}` : text;
}
