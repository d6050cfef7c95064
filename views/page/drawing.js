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
const TICK = 6; // pixels between an axis and its numbers
const axes = (svg, content, across, along, margins) => {
  const { width, height } = begin(svg, content);
  const gap = margins.gap ?? TICK;
  const box = { left: margins.left, right: width - margins.right, top: margins.top, bottom: height - margins.bottom };
  box.x = (value) => box.left + ((value - across.low) / (across.high - across.low)) * (box.right - box.left);
  box.y = (value) => box.bottom - ((value - along.low) / (along.high - along.low)) * (box.bottom - box.top);
  for (const [value, word] of along.ticks) {
    draw(content, "line", { x1: box.left - gap + TICK, x2: box.right, y1: box.y(value), y2: box.y(value), stroke: "var(--grid)" });
    draw(content, "text", { x: box.left - gap, y: box.y(value) + 4, "text-anchor": "end", class: "tick" }, word);
  }
  for (const [value, word] of across.ticks) draw(content, "text", { x: box.x(value), y: box.bottom + 16, "text-anchor": "middle", class: "tick" }, word);
  draw(content, "line", { x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom, stroke: "var(--soft)", "stroke-opacity": 0.6 });
  return box;
};

// Boxes on the screen: of words and of what they shall not cross.
const boxAround = ([x, y], half) => ({ left: x - half, right: x + half, top: y - half, bottom: y + half });
const common = (a, b) => Math.max(0, Math.min(a.right, b.right) - Math.max(a.left, b.left)) * Math.max(0, Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));
const beyond = (a, within) => Math.max(0, within.left - a.left) + Math.max(0, a.right - within.right) + Math.max(0, within.top - a.top) + Math.max(0, a.bottom - within.bottom);
const LINE = 12; // pixels of a line of words
// Put words beside a point where they cross nothing, or else where they cross least; `apart` is how far the mark of the point goes.
const placeWords = (text, [x, y], apart, obstacles, within) => {
  const wide = text.getComputedTextLength();
  const near = [[apart, -apart], [-apart, -apart], [apart, apart], [-apart, apart], [1.4 * apart, 0], [-1.4 * apart, 0], [0, -1.4 * apart], [0, 1.4 * apart]];
  const far = near.map(([across, up]) => [2.4 * across, 2.4 * up]);
  const slid = [-1, 1].flatMap((side) => [1.5, 2.5, 4].map((times) => [null, side * times * apart]));
  let best = null;
  for (const [across, up] of [...near, ...far, ...slid]) {
    const middle = across === null ? Math.min(Math.max(x, within.left + wide / 2), within.right - wide / 2) : x + across + (Math.sign(across) * wide) / 2;
    const base = y + up + (up > 0 ? LINE : up < 0 ? 0 : 0.35 * LINE);
    const box = { left: middle - wide / 2 - 2, right: middle + wide / 2 + 2, top: base - LINE, bottom: base + 3 };
    const crossed = 1e3 * beyond(box, within) + obstacles.reduce((sum, obstacle) => sum + common(box, obstacle), 0);
    if (!best || crossed < best.crossed - 1) best = { crossed, middle, base, box };
    if (best.crossed === 0) break;
  }
  return best;
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
