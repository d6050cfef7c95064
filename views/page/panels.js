// Torque, power and tip displacement over time, on the clock of the motion; of several joints or tips one, which is chosen by its name.
const panels = Object.keys(moves[0].panels).map((name) => {
  const box = element(byId("panels"), "div");
  const above = element(box, "div", "", "above");
  const panel = { name, line: 0, heading: element(above, "h2"), values: element(above, "output"), svg: draw(box, "svg", { role: "img" }) };
  let wasPlaying = false;
  draggable(panel.svg, {
    onBegin: () => {
      wasPlaying = state.playing;
      play(false);
    },
    onMove: (event) => {
      const { left, right } = panel.box;
      seek(((event.clientX - panel.svg.getBoundingClientRect().left - left) / (right - left)) * state.move.end);
    },
    onEnd: () => {
      if (wasPlaying) play(true);
      wasPlaying = false;
    },
  });
  return panel;
});
const beginPanels = () => {
  for (const panel of panels) {
    const { first, names } = state.move.panels[panel.name];
    if (panel.names?.join() !== names.join()) Object.assign(panel, { names, line: first });
  }
};
const drawPanels = () => {
  for (const panel of panels) drawPanel(panel, state.move.panels[panel.name]);
};
const drawHeading = (panel, { title, names }, unit) => {
  panel.heading.replaceChildren(`${title} `);
  element(panel.heading, "span", `[${unit}]`, "unit");
  if (names.length < 2) return;
  const select = element(panel.heading, "select");
  select.setAttribute("aria-label", `${title} of`);
  names.forEach((name, k) => Object.assign(element(select, "option", name), { value: k, selected: k === panel.line }));
  select.addEventListener("change", () => {
    panel.line = Number(select.value);
    drawPanel(panel, state.move.panels[panel.name]);
    placeCurve(panel);
    placePanel(panel);
    panel.heading.querySelector("select").focus();
  });
};
const drawPanel = (panel, quantity) => {
  const { duration, end, times } = state.move;
  const { svg } = panel;
  const { title, rows } = quantity;
  const limits = quantity.limits[panel.line];
  const kept = state.kept?.rows[panel.name][panel.line];
  const lines = [...rows.map((motion) => motion[panel.line]), ...(kept ? [kept] : [])];
  const low = Math.min(0, ...limits, ...lines.map((row) => Math.min(...row)));
  const high = Math.max(0, ...limits, ...lines.map((row) => Math.max(...row)));
  const [across, along] = [timeAxis(end, svg.clientWidth < 260 ? 3 : 5), axisOf(low, high > low ? high : 1, 4)];
  drawHeading(panel, quantity, along.unit(quantity.unit));
  svg.setAttribute("aria-label", `${title} over time`);
  panel.write = (value) => fixed(value / along.factor, placesFor(Math.max(high, -low) / along.factor));
  const widest = Math.max(...along.ticks.map(([, word]) => word.length));
  const box = axes(svg, svg, across, along, { left: Math.max(30, 10 + 7.2 * widest), right: 8, top: 18, bottom: 34 });
  panel.box = box;
  draw(svg, "text", { x: (box.left + box.right) / 2, y: box.bottom + 31, "text-anchor": "middle" }, `time [${across.unit("s")}]`);
  draw(svg, "rect", { x: box.x(duration), y: box.top, width: box.right - box.x(duration), height: box.bottom - box.top, fill: "var(--after)" });
  draw(svg, "line", { x1: box.x(duration), x2: box.x(duration), y1: box.top, y2: box.bottom, stroke: "var(--arrival)", "stroke-dasharray": "4 3" });
  const arrival = draw(svg, "text", { x: Math.min(box.x(duration), box.right - 42), y: box.top - 5, "font-size": 11 }, "arrival");
  draw(svg, "line", { x1: box.left, x2: box.right, y1: box.y(0), y2: box.y(0), stroke: "var(--soft)", "stroke-opacity": 0.5 });
  // a limit holds on the way, not for what comes after it
  for (const level of limits) draw(svg, "line", { ...DOTTED, x1: box.left, x2: box.x(duration), y1: box.y(level), y2: box.y(level) });
  if (limits.length) nameLimit(svg, box, arrival);
  panel.placeOf = (value, k) => [box.x(times[k]), box.y(value)];
  const curve = (colour, wide) => [1, AFTER].map((seen) => draw(svg, "path", { ...ROUND, stroke: colour, "stroke-width": wide, "stroke-opacity": seen }));
  setCurve(panel, curve("var(--cycloid)", 1.7), ofCycloid(rows)[panel.line]);
  if (kept) drawKeptCurve(panel, kept, end);
  panel.curve = curve("var(--this)", 2.2);
  panel.cursor = draw(svg, "line", { y1: box.top, y2: box.bottom, stroke: "var(--ink)", "stroke-width": 1.2 });
  panel.ghostDot = draw(svg, "circle", { r: 3.5, fill: "var(--cycloid)" });
  panel.dot = draw(svg, "circle", { r: 4.5, fill: "var(--this)", stroke: "var(--card)", "stroke-width": 1.2 });
};
const drawKeptCurve = ({ svg, box }, row, end) => {
  const { times, arrival } = state.kept;
  const places = times.filter((time) => time <= end).map((time, k) => [box.x(time), box.y(row[k])]);
  const look = { ...ROUND, "stroke-linecap": "butt", stroke: `var(--${alive.kept.colour})`, "stroke-width": 1.7, "stroke-dasharray": KEPT_DASHES };
  draw(svg, "path", { ...look, d: pathOf(places.slice(0, arrival + 1)) });
  draw(svg, "path", { ...look, d: pathOf(places.slice(arrival)), "stroke-opacity": AFTER });
};
const DOTTED = { stroke: "var(--limit)", "stroke-width": 1.5, "stroke-dasharray": "1.6 4", "stroke-linecap": "round" };
// What the dotted lines are: above the picture, where no curve goes, on the side that the arrival leaves free.
const nameLimit = (svg, box, arrival) => {
  const text = draw(svg, "text", { y: box.top - 5, "font-size": 11 }, "limit");
  const dots = draw(svg, "line", { ...DOTTED, y1: box.top - 9, y2: box.top - 9 });
  const [sample, space] = [16, 5];
  const wide = sample + space + text.getComputedTextLength();
  const isFree = Number(arrival.getAttribute("x")) > box.left + wide + 2 * space;
  const left = isFree ? box.left : box.right - wide;
  setAll(dots, { x1: left + 1, x2: left + sample });
  setAll(text, { x: left + sample + space });
};
// A curve until the arrival, and lighter from there on.
const setCurve = (panel, [moving, after], row) => {
  const { arrival } = state.move;
  const places = Array.from(row, panel.placeOf);
  moving.setAttribute("d", pathOf(places.slice(0, arrival + 1)));
  after.setAttribute("d", pathOf(places.slice(arrival)));
};
const placeCurve = (panel) => setCurve(panel, panel.curve, ofChosen(state.move.panels[panel.name].rows)[panel.line]);
const placePanel = (panel) => {
  const { rows } = state.move.panels[panel.name];
  const { time, move } = state;
  const x = panel.box.x(time);
  setAll(panel.cursor, { x1: x, x2: x });
  const [value, ghost] = [ofChosen(rows), ofCycloid(rows)].map((lines) => valueAt(move.times, lines[panel.line], time));
  setAll(panel.dot, { cx: x, cy: panel.box.y(value) });
  setAll(panel.ghostDot, { cx: x, cy: panel.box.y(ghost) });
  panel.values.replaceChildren();
  element(panel.values, "b", panel.write(value)).title = "this motion";
  element(panel.values, "i", panel.write(ghost)).title = "plain cycloid";
};
