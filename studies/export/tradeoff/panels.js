// Torque, power and tip displacement over time, on the clock of the motion.
const panels = ["torque", "power", "deflection"].map((name) => {
  const box = element(byId("panels"), "div");
  const above = element(box, "div", "", "above");
  const panel = { name, heading: element(above, "h2"), values: element(above, "output"), svg: draw(box, "svg", { role: "img" }) };
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
const drawPanels = () => {
  for (const panel of panels) drawPanel(panel, state.move.panels[panel.name]);
};
const drawPanel = (panel, { title, unit, limits, rows }) => {
  const { duration, end, times } = state.move;
  const { svg } = panel;
  panel.heading.textContent = `${title} `;
  element(panel.heading, "span", `[${unit}]`, "unit");
  svg.setAttribute("aria-label", `${title} over time`);
  const lines = rows.flat();
  const low = Math.min(0, ...limits, ...lines.map((row) => Math.min(...row)));
  const high = Math.max(0, ...limits, ...lines.map((row) => Math.max(...row)), low + 1e-12);
  const room = 0.06 * (high - low);
  panel.places = placesFor(Math.max(high, -low));
  const box = axes(svg, svg, [0, end, low - room, high + room], { left: 44, right: 8, top: 18, bottom: 34 }, [svg.clientWidth < 260 ? 3 : 5, 4]);
  panel.box = box;
  draw(svg, "text", { x: (box.left + box.right) / 2, y: box.bottom + 31, "text-anchor": "middle" }, "time [s]");
  draw(svg, "rect", { x: box.x(duration), y: box.top, width: box.right - box.x(duration), height: box.bottom - box.top, fill: "var(--after)" });
  draw(svg, "line", { x1: box.x(duration), x2: box.x(duration), y1: box.top, y2: box.bottom, stroke: "var(--soft)", "stroke-dasharray": "4 3" });
  draw(svg, "text", { x: Math.min(box.x(duration), box.right - 42), y: box.top - 5, "font-size": 11 }, "arrival");
  draw(svg, "line", { x1: box.left, x2: box.right, y1: box.y(0), y2: box.y(0), stroke: "var(--soft)", "stroke-opacity": 0.5 });
  for (const level of limits) draw(svg, "line", { x1: box.left, x2: box.right, y1: box.y(level), y2: box.y(level), stroke: "var(--ink)", "stroke-width": 1.5, "stroke-dasharray": "1.6 4", "stroke-linecap": "round" });
  panel.pathOf = (row) => pathOf(Array.from(row, (value, k) => [box.x(times[k]), box.y(value)]));
  const thin = ofCycloid(rows).length > 2 ? 0.6 : 1;
  for (const row of ofCycloid(rows)) draw(svg, "path", { ...ROUND, d: panel.pathOf(row), stroke: "var(--cycloid)", "stroke-width": 1.7 * thin });
  panel.curves = ofChosen(rows).map(() => draw(svg, "path", { ...ROUND, stroke: "var(--plan)", "stroke-width": 2.2 * thin }));
  if (limits.length) draw(svg, "text", { x: box.right - 2, y: box.y(Math.max(...limits)) + 14, "text-anchor": "end", "font-size": 11, class: "halo" }, "limit");
  panel.cursor = draw(svg, "line", { y1: box.top, y2: box.bottom, stroke: "var(--ink)", "stroke-width": 1.2 });
  panel.ghostDots = ofCycloid(rows).map(() => draw(svg, "circle", { r: 3.5 * thin, fill: "var(--cycloid)" }));
  panel.dots = panel.curves.map(() => draw(svg, "circle", { r: 4.5 * thin, fill: "var(--plan)", stroke: "var(--card)", "stroke-width": 1.2 }));
};
const placePanel = (panel) => {
  const { rows } = state.move.panels[panel.name];
  const { time, move } = state;
  const x = panel.box.x(time);
  setAll(panel.cursor, { x1: x, x2: x });
  const now = (values) => values.map((row) => valueAt(move.times, row, time));
  const [values, ghosts] = [now(ofChosen(rows)), now(ofCycloid(rows))];
  values.forEach((value, k) => setAll(panel.dots[k], { cx: x, cy: panel.box.y(value) }));
  ghosts.forEach((value, k) => setAll(panel.ghostDots[k], { cx: x, cy: panel.box.y(value) }));
  panel.values.replaceChildren();
  if (values.length > 1) return;
  element(panel.values, "b", fixed(values[0], panel.places));
  element(panel.values, "i", fixed(ghosts[0], panel.places));
};
