// The trade-off: energy against residual vibration, what lies beside it, and the handle on it.
const MARKS = { search: "circle", gradient: "square", plan: "diamond", known: "star" };
const MARK_PATHS = {
  circle: "M-3 0a3 3 0 1 0 6 0a3 3 0 1 0 -6 0Z",
  square: "M-2.8 -2.8H2.8V2.8H-2.8Z",
  diamond: "M0 -5.5L5 0L0 5.5L-5 0Z",
  star: "M0 -7L1.7 -2.2L6.7 -2.2L2.7 0.9L4.1 5.7L0 2.8L-4.1 5.7L-2.7 0.9L-6.7 -2.2L-1.7 -2.2Z",
};
const lookOf = (kind) => ({
  search: { fill: "var(--card)", stroke: "var(--search)", "stroke-width": 1.5 },
  gradient: { fill: "var(--card)", stroke: "var(--plan)", "stroke-width": 1.5 },
  plan: { fill: "var(--plan)", stroke: "var(--card)", "stroke-width": 1 },
  known: { fill: "var(--ink)", stroke: "var(--card)", "stroke-width": 1 },
})[kind];
const APART = 13; // pixels between two points of a search that are drawn
const front = { touched: false, box: null };

const limitsOfFront = () => {
  const { points, beside, cycloid, factor, rest } = state.move;
  const others = beside.flatMap(({ points: places }) => places).filter(([residual]) => residual !== null);
  const residuals = [...points.map((point) => point.residual), ...others.map(([residual]) => residual)];
  const energies = [...points.map((point) => point.energy), ...others.map(([, energy]) => energy)];
  const [rightmost, highest] = [Math.max(...residuals), Math.max(...energies)];
  const lowest = Math.min(...energies, cycloid.energy);
  // a cycloid that is far away stands at the edge: else the front would be a dot
  const far = 3;
  const right = rightmost > rest ? Math.min(Math.max(rightmost, cycloid.residual), far * rightmost) : cycloid.residual || 1 / factor;
  const high = Math.min(Math.max(highest, cycloid.energy), far * highest) || 1;
  // where all take nearly the same energy the axis does not begin at zero
  const flat = lowest > 0.6 * high;
  const low = flat ? Math.max(0, lowest - 0.35 * (high - lowest)) : 0;
  return [0, 1.06 * factor * right, low, high + 0.1 * (high - low || high)];
};
const place = (residual, energy) => [front.box.x(state.move.factor * residual), front.box.y(energy)];
const placeOf = (point) => place(point.residual, point.energy);

const drawFront = () => {
  const { points, beside, cycloid, joined, residual, unit, factor } = state.move;
  const plot = byId("plot");
  const narrow = byId("front").clientWidth < 420;
  const box = axes(byId("front"), plot, limitsOfFront(), { left: 50, right: 10, top: 22, bottom: 36 }, [narrow ? 5 : 6, 5]);
  front.box = box;
  draw(plot, "text", { x: 0, y: 10 }, "energy F2 [J]");
  draw(plot, "text", { x: (box.left + box.right) / 2, y: box.bottom + 33, "text-anchor": "middle" }, `${residual} [${unit}]`);
  drawCycloid(plot, cycloid, box, factor);
  if (joined) draw(plot, "path", { ...ROUND, d: pathOf(points.map(placeOf)), stroke: "var(--plan)", "stroke-width": 2.6 });
  else for (const point of points) mark(plot, "gradient", placeOf(point));
  for (const { kind, label, points: places } of beside) drawBeside(plot, kind, label, places, box);
  front.guides = draw(plot, "path", { fill: "none", stroke: "var(--plan)", "stroke-dasharray": "1 4", "stroke-linecap": "round", "stroke-width": 1.5 });
  setAll(byId("handle"), { "aria-valuemax": points.length });
  placeHandle();
};
const drawCycloid = (plot, { residual, energy, spot }, box, factor) => {
  const [x, y] = [Math.min(box.x(factor * residual), box.right), Math.max(Math.min(box.y(energy), box.bottom), box.top)];
  const outside = box.x(factor * residual) > box.right + 1 || box.y(energy) < box.top - 1;
  draw(plot, "circle", { cx: x, cy: y, r: 6, fill: outside ? "var(--card)" : "var(--cycloid)", stroke: "var(--cycloid)", "stroke-width": 2 });
  const end = x > (box.left + box.right) / 2;
  const words = outside ? `plain cycloid, outside: ${spot}` : "plain cycloid";
  const above = y - 12 > box.top - 4;
  draw(plot, "text", { x: end ? Math.min(x + 6, box.right) : x - 6, y: above ? y - 11 : y + 21, "text-anchor": end ? "end" : "start", class: "halo" }, words);
};
const mark = (plot, kind, [x, y]) => draw(plot, "path", { d: MARK_PATHS[MARKS[kind]], transform: `translate(${x} ${y})`, ...lookOf(kind) });
const drawBeside = (plot, kind, label, places, box) => {
  let last = [-Infinity, 0];
  for (const [residual, energy] of places) {
    if (residual === null) {
      draw(plot, "line", { x1: box.left, x2: box.right, y1: box.y(energy), y2: box.y(energy), stroke: "var(--ink)", "stroke-dasharray": "1.6 4" });
      continue;
    }
    const [x, y] = place(residual, energy);
    if (x > box.right + 1 || y < box.top - 1 || Math.hypot(x - last[0], y - last[1]) < APART) continue;
    last = [x, y];
    draw(mark(plot, kind, last), "title", {}, label);
  }
};
const drawKey = () => {
  const { beside, joined, method } = state.move;
  const key = byId("key");
  key.replaceChildren();
  const entry = (label, drawSign) => {
    const span = element(key, "span");
    const sign = draw(span, "svg", { "aria-hidden": "true", viewBox: "0 0 22 12" });
    drawSign(sign);
    span.append(label);
  };
  const line = (colour) => (sign) => draw(sign, "path", { d: "M0 6H22", stroke: colour, "stroke-width": 2.6 });
  entry(method, joined ? line("var(--plan)") : (sign) => mark(sign, "gradient", [11, 6]));
  for (const { label, kind } of beside) entry(label, (sign) => mark(sign, kind, [11, 6]));
  entry("plain cycloid", line("var(--cycloid)"));
};

const placeHandle = () => {
  const point = chosen();
  const [x, y] = placeOf(point);
  const { left, right, bottom } = front.box;
  setAll(byId("handle"), { transform: `translate(${x} ${y})`, "aria-valuenow": state.point + 1, "aria-valuetext": [point.name, point.spot].filter(Boolean).join(": ") });
  front.guides.setAttribute("d", `M${left} ${y}H${x}V${bottom}`);
  const several = lastPoint() > 0;
  byId("spot").textContent = front.touched || !several ? point.spot : "drag me";
  const room = right - x > 150;
  setAll(byId("spot"), room ? { x: 18, y: -12, "text-anchor": "start" } : { x: 6, y: -20, "text-anchor": "end" });
};
const choose = (number) => {
  const next = Math.min(Math.max(number, 0), lastPoint());
  if (!front.touched) {
    front.touched = true;
    byId("handle").classList.remove("fresh");
    placeHandle();
  }
  if (next === state.point) return;
  state.point = next;
  placeHandle();
  showMotion();
};
const nearestTo = (event) => {
  const { left, top } = byId("front").getBoundingClientRect();
  const distances = state.move.points.map((point) => {
    const [x, y] = placeOf(point);
    return Math.hypot(x + left - event.clientX, y + top - event.clientY);
  });
  return distances.indexOf(Math.min(...distances));
};
draggable(byId("front"), {
  onBegin: (event) => {
    event.preventDefault();
    byId("handle").focus({ preventScroll: true });
  },
  onMove: (event) => choose(nearestTo(event)),
});
byId("handle").addEventListener("keydown", (event) => {
  const now = state.point;
  const page = 5;
  const steps = { ArrowRight: now + 1, ArrowDown: now + 1, ArrowLeft: now - 1, ArrowUp: now - 1, PageDown: now + page, PageUp: now - page, Home: 0, End: lastPoint() };
  if (!(event.key in steps) || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  choose(steps[event.key]);
});
