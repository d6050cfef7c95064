// The trade-off: energy against residual vibration, what lies beside it, and the handle on it.
const MARK_PATHS = {
  o: "M-3.4 0a3.4 3.4 0 1 0 6.8 0a3.4 3.4 0 1 0 -6.8 0Z",
  s: "M-3.4 -3.4H3.4V3.4H-3.4Z",
  D: "M0 -4.8L4.4 0L0 4.8L-4.4 0Z",
  "^": "M0 -4.4L4.2 3.4H-4.2Z",
  v: "M0 4.4L4.2 -3.4H-4.2Z",
  "<": "M-4.4 0L3.4 4.2V-4.2Z",
  ">": "M4.4 0L-3.4 4.2V-4.2Z",
  P: "M-1.5 -4.5H1.5V-1.5H4.5V1.5H1.5V4.5H-1.5V1.5H-4.5V-1.5H-1.5Z",
  X: "M-4.2 -2.4L-2.4 -4.2L0 -1.8L2.4 -4.2L4.2 -2.4L1.8 0L4.2 2.4L2.4 4.2L0 1.8L-2.4 4.2L-4.2 2.4L-1.8 0Z",
  "*": "M0 -7L1.7 -2.2L6.7 -2.2L2.7 0.9L4.1 5.7L0 2.8L-4.1 5.7L-2.7 0.9L-6.7 -2.2L-1.7 -2.2Z",
};
const KEPT_DASHES = "6 4";
const CYCLOID = { mark: "s", colour: "cycloid", filled: true };
const APART = 13; // pixels between two points of a search that are drawn
const KNOB = 14; // pixels from the handle's middle to its edge
const front = { touched: false, box: null, obstacles: [], cycloid: null, cycloidIsOutside: false };

const FAR = 3; // times as far as the front: what lies beyond stands at the edge
const limitsOfFront = (about) => {
  const { points, beside, cycloid, factor, rest } = frontMove();
  const others = beside.flatMap(({ points: places }) => places).filter(([residual]) => residual !== null);
  const residuals = [...points.map((point) => point.residual), ...others.map(([residual]) => residual)];
  const energies = [...points.map((point) => point.energy), ...others.map(([, energy]) => energy)];
  if (isByHand()) {
    residuals.push(Math.min(chosen().residual, FAR * Math.max(...residuals)));
    energies.push(Math.min(chosen().energy, FAR * Math.max(...energies)));
  }
  const [rightmost, highest] = [Math.max(...residuals), Math.max(...energies)];
  const lowest = Math.min(...energies, cycloid.energy);
  // a cycloid that is far away stands at the edge: else a front would be a dot
  const far = points.length > 1 && rightmost > rest ? FAR : Infinity;
  const right = Math.min(Math.max(rightmost, cycloid.residual), far * rightmost || Infinity) || 1 / factor;
  const high = Math.min(Math.max(highest, cycloid.energy), far * highest || Infinity) || 1;
  // where all take nearly the same energy the axis does not begin at zero
  const flat = points.length + others.length > 1 && lowest > 0.6 * high && high - lowest > 1e-6 * high;
  const low = flat ? Math.max(0, lowest - 0.35 * (high - lowest)) : 0;
  return [axisOf(0, factor * right, about[0]), axisOf(low, high + 0.03 * (high - low), about[1])];
};
const place = (residual, energy) => [front.box.x(state.move.factor * residual), front.box.y(energy)];
const placeOf = (point) => place(point.residual, point.energy);
const within = ([x, y], box) => [Math.min(x, box.right), Math.max(Math.min(y, box.bottom), box.top)];

const drawFront = () => {
  const { points, beside, joined, residual, unit, mark: sign, this: own } = frontMove();
  const plot = byId("plot");
  const narrow = byId("front").clientWidth < 420;
  const [across, along] = limitsOfFront([narrow ? 4 : 6, 5]);
  const widest = Math.max(...along.ticks.map(([, word]) => word.length));
  // beside the axis there is room for the handle of a motion at rest
  const box = axes(byId("front"), plot, across, along, { left: 30 + 7.2 * widest, right: 14, top: 26, bottom: 38, gap: KNOB + 4 });
  front.box = box;
  draw(plot, "text", { x: 0, y: 10 }, `energy [${along.unit("J")}]`);
  draw(plot, "text", { x: (box.left + box.right) / 2, y: box.bottom + 34, "text-anchor": "middle" }, `${residual} [${across.unit(unit)}]`);
  const places = points.map(placeOf);
  front.obstacles = [];
  const isLine = joined && points.length > 1;
  if (isLine) draw(plot, "path", { ...ROUND, d: pathOf(places), stroke: "var(--this)", "stroke-width": 2.6 });
  else for (const place of places) mark(plot, { mark: sign, colour: own, filled: points[0].name !== "" }, place);
  front.obstacles.push(...alongLine(places, isLine).map((place) => boxAround(place, isLine ? 3 : 5)));
  for (const others of beside) drawBeside(plot, others, box);
  if (state.kept) drawKept(plot, box);
  front.guides = draw(plot, "path", { fill: "none", stroke: "var(--this)", "stroke-opacity": 0.45 });
  drawCycloid(plot, box);
  setAll(byId("handle"), { "aria-valuemax": points.length });
  placeHandle();
};
// Places on a line, so close that words cannot pass between them.
const alongLine = (places, isLine) => {
  if (!isLine) return places;
  const close = 6;
  return places.flatMap(([x, y], k) => {
    const [toX, toY] = places[Math.min(k + 1, places.length - 1)];
    const count = Math.max(1, Math.ceil(Math.hypot(toX - x, toY - y) / close));
    return Array.from({ length: count }, (_, n) => [x + ((toX - x) * n) / count, y + ((toY - y) * n) / count]);
  });
};
const drawCycloid = (plot, box) => {
  const { cycloid, factor } = state.move;
  const there = [box.x(factor * cycloid.residual), box.y(cycloid.energy)];
  const [x, y] = within(there, box);
  const outside = Math.hypot(there[0] - x, there[1] - y) > 1;
  front.cycloidIsOutside = outside;
  const words = outside ? `plain cycloid, further out: ${cycloid.spot}` : "plain cycloid";
  mark(plot, { ...CYCLOID, filled: !outside }, [x, y], 1.5);
  front.obstacles.push(boxAround([x, y], 8));
  front.cycloid = { at: [x, y], words: draw(plot, "text", { "text-anchor": "middle", class: "halo" }, unbroken(words)) };
};
const WORDS_FROM = 14; // pixels below the top of the picture, where the unit of the energy stands
const placeCycloidsWords = (handle) => {
  const { at, words } = front.cycloid;
  const { middle, base, box } = placeWords(words, at, 9, [...front.obstacles, ...handle], { ...front.box, top: WORDS_FROM });
  setAll(words, { x: middle, y: base });
  return box;
};
const mark = (plot, { mark: sign, colour, filled }, [x, y], size = 1) => {
  const look = filled ? { fill: `var(--${colour})`, stroke: "var(--card)", "stroke-width": 1 / size } : { fill: "var(--card)", stroke: `var(--${colour})`, "stroke-width": 1.5 / size };
  return draw(plot, "path", { d: MARK_PATHS[sign], transform: `translate(${x} ${y}) scale(${size})`, ...look });
};
const isFilled = ({ kind }) => kind === "plan" || kind === "known";
const drawBeside = (plot, { kind, label, mark: sign, colour, points: places }, box) => {
  let last = [-Infinity, 0];
  for (const [residual, energy] of places) {
    if (residual === null) {
      drawLevel(plot, label, energy, box);
      continue;
    }
    const here = place(residual, energy);
    if (Math.hypot(here[0] - last[0], here[1] - last[1]) < APART) continue;
    last = here;
    mark(plot, { mark: sign, colour, filled: isFilled({ kind }) }, here);
    front.obstacles.push(boxAround(here, 6));
  }
};
const drawLevel = (plot, label, energy, box) => {
  const y = box.y(energy);
  draw(draw(plot, "line", { x1: box.left, x2: box.right, y1: y, y2: y, stroke: "var(--paper)", "stroke-dasharray": "7 3 1.6 3" }), "title", {}, label);
};
const drawKept = (plot, box) => {
  const here = within(place(state.kept.residual, state.kept.energy), box);
  mark(plot, alive.kept, here);
  front.obstacles.push(boxAround(here, 6));
};
const keyEntry = (key, label, drawSign) => {
  const span = element(key, "span");
  const picture = draw(span, "svg", { "aria-hidden": "true", viewBox: "0 0 22 14" });
  drawSign(picture);
  element(span, "span", unbroken(label), label.length > 24 ? "long" : "");
};
const drawKey = () => {
  const { points, beside, joined, method, mark: sign, this: own } = frontMove();
  const key = byId("key");
  key.replaceChildren();
  const entry = (label, drawSign) => keyEntry(key, label, drawSign);
  const markOf = (look, size) => (picture) => mark(picture, look, [11, 7], size);
  entry(method, joined && points.length > 1 ? (picture) => draw(picture, "path", { d: "M0 7H22", stroke: "var(--this)", "stroke-width": 2.6 }) : markOf({ mark: sign, colour: own, filled: points[0].name !== "" }));
  for (const others of beside) entry(others.label, markOf({ ...others, filled: isFilled(others) }));
  if (state.kept) entry("the curve that was kept", (picture) => {
    draw(picture, "path", { d: "M0 7H22", stroke: `var(--${alive.kept.colour})`, "stroke-width": 1.7, "stroke-dasharray": KEPT_DASHES });
    mark(picture, alive.kept, [11, 7]);
  });
  entry("plain cycloid (not optimised)", markOf({ ...CYCLOID, filled: !front.cycloidIsOutside }, 1.5));
};

const coarse = matchMedia("(pointer: coarse)");
const placeHandle = () => {
  const point = chosen();
  const [x, y] = within(placeOf(point), front.box);
  const { left, bottom } = front.box;
  const number = isByHand() ? nearestPoint(placeOf(point)) : state.point;
  setAll(byId("handle"), { transform: `translate(${x} ${y})`, "aria-valuenow": number + 1, "aria-valuetext": [point.name, point.spot].filter(Boolean).join(": ") });
  front.guides.setAttribute("d", `M${left} ${y}H${x}V${bottom}`);
  const several = lastPoint() > 0 && !isByHand();
  const invitation = coarse.matches ? "drag me" : "drag, or use the arrow keys";
  const spot = byId("spot");
  spot.textContent = front.touched || !several ? unbroken(point.spot) : invitation;
  const guides = [{ left, right: x, top: y - 1, bottom: y + 1 }, { left: x - 1, right: x + 1, top: y, bottom }];
  const ofCycloid = placeCycloidsWords([boxAround([x, y], KNOB), ...guides]);
  const { middle, base } = placeWords(spot, [x, y], KNOB + 1, [...front.obstacles, ...guides, ofCycloid], { ...front.box, top: WORDS_FROM });
  setAll(spot, { x: middle - x, y: base - y });
};
const choose = (number) => {
  const next = Math.min(Math.max(number, 0), lastPoint());
  if (!front.touched) {
    front.touched = true;
    byId("handle").classList.remove("fresh");
    placeHandle();
  }
  if (next === state.point && !isByHand()) return;
  state.point = next;
  if (isByHand()) enter(state.front);
  else {
    placeHandle();
    showMotion();
  }
  onChoice(next);
};
let onChoice = () => {}; // what else happens when a motion of a front is chosen
const nearestPoint = ([x, y]) => {
  const distances = frontMove().points.map((point) => {
    const [atX, atY] = placeOf(point);
    return Math.hypot(atX - x, atY - y);
  });
  return distances.indexOf(Math.min(...distances));
};
const nearestTo = (event) => {
  const { left, top } = byId("front").getBoundingClientRect();
  return nearestPoint([event.clientX - left, event.clientY - top]);
};
draggable(byId("front"), {
  onBegin: (event) => {
    event.preventDefault();
    byId("handle").classList.remove("keyed");
    byId("handle").focus({ preventScroll: true });
  },
  onMove: (event) => { if (lastPoint() > 0) choose(nearestTo(event)); },
});

// Keys: left and right wherever nothing else needs them; in a frame up and down go on to scroll the page around it.
const SIDEWAYS = { ArrowRight: 1, ArrowLeft: -1 };
const UPRIGHT = { ArrowDown: 1, ArrowUp: -1, PageDown: 5, PageUp: -5 };
const ENDS = { Home: -Infinity, End: Infinity };
const chooseBy = (key) => {
  byId("handle").classList.add("keyed");
  if (lastPoint() === 0) return;
  const from = isByHand() ? nearestPoint(placeOf(chosen())) : state.point;
  choose(from + { ...SIDEWAYS, ...UPRIGHT, ...ENDS }[key]);
};
const beginKeys = () => {
  byId("handle").classList.add("keyed");
  byId("handle").focus({ preventScroll: true });
};
addEventListener("keydown", (event) => {
  const { key, target } = event;
  const atHandle = byId("handle").contains(target);
  const taken = { ...SIDEWAYS, ...(atHandle ? ENDS : {}), ...(atHandle && !framed ? UPRIGHT : {}) };
  if (!(key in taken) || event.ctrlKey || event.metaKey || event.altKey || target.closest("input, select")) return;
  event.preventDefault();
  chooseBy(key);
});
