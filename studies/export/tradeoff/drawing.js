// Drawing in SVG: elements, paths, axes; and dragging, by which a finger that goes up still scrolls.
const byId = (id) => document.getElementById(id);
const setAll = (element, attributes) => {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
};
const draw = (parent, kind, attributes = {}, text = undefined) => {
  const element = setAll(document.createElementNS("http://www.w3.org/2000/svg", kind), attributes);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
};
const element = (parent, kind, text = "", className = "") => {
  const created = document.createElement(kind);
  created.textContent = text;
  if (className) created.className = className;
  parent.append(created);
  return created;
};
const pathOf = (points) => (points.length ? `M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}` : "");
const ROUND = { fill: "none", "stroke-linecap": "round", "stroke-linejoin": "round" };

// Begin a picture anew in its size on the screen.
const begin = (svg, content = svg) => {
  const width = svg.clientWidth;
  const height = svg.clientHeight;
  content.replaceChildren();
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  return { width, height };
};
const axes = (svg, content, [left, right, low, high], margins, about) => {
  const { width, height } = begin(svg, content);
  const box = { left: margins.left, right: width - margins.right, top: margins.top, bottom: height - margins.bottom };
  box.x = (value) => box.left + ((value - left) / (right - left)) * (box.right - box.left);
  box.y = (value) => box.bottom - ((value - low) / (high - low)) * (box.bottom - box.top);
  for (const [value, word] of ticks(low, high, about[1])) {
    draw(content, "line", { x1: box.left, x2: box.right, y1: box.y(value), y2: box.y(value), stroke: "var(--grid)" });
    draw(content, "text", { x: box.left - 6, y: box.y(value) + 4, "text-anchor": "end" }, word);
  }
  for (const [value, word] of ticks(left, right, about[0])) draw(content, "text", { x: box.x(value), y: box.bottom + 16, "text-anchor": "middle" }, word);
  draw(content, "line", { x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom, stroke: "var(--soft)", "stroke-opacity": 0.6 });
  return box;
};

const SLOP = 8; // pixels that a finger may go before it is clear in which direction
const draggable = (svg, { onBegin = () => {}, onMove, onEnd = () => {} }) => {
  let first = null;
  let dragging = false;
  svg.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    svg.setPointerCapture(event.pointerId);
    first = event;
    dragging = event.pointerType !== "touch";
    onBegin(event);
    if (dragging) onMove(event);
  });
  svg.addEventListener("pointermove", (event) => {
    if (!first) return;
    const across = Math.abs(event.clientX - first.clientX);
    const along = Math.abs(event.clientY - first.clientY);
    dragging ||= first.target.closest("[role=slider]") !== null || (across > SLOP && across > along);
    if (dragging) onMove(event);
  });
  svg.addEventListener("pointerup", (event) => {
    if (first) onMove(event);
    first = null;
    onEnd();
  });
  svg.addEventListener("pointercancel", () => {
    first = null;
    onEnd();
  });
};
