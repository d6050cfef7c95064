// The structure in motion, in a plane or in space, the plain cycloid as a ghost behind it, the tips' trails, and how far they swing.
const scene = {};
const swing = {};
const drawScene = () => {
  const svg = byId("scene");
  const { structure } = state.move;
  svg.classList.toggle("space", structure.in_space);
  svg.toggleAttribute("tabindex", false);
  if (structure.in_space) svg.setAttribute("tabindex", "0");
  if (structure.in_space) drawSpace(svg);
  else drawPlane(svg);
  const view = byId("view");
  view.textContent = "The motion ";
  element(view, "span", structure.scale, "unit");
  const turns = structure.in_space ? "; arrow keys turn it" : "";
  svg.setAttribute("aria-label", `The structure in motion: the chosen motion, the plain cycloid in grey, dashed where it shall stand${turns}`);
  drawLines(structure);
};
// What the lines of the picture are.
const drawLines = ({ in_space: inSpace, room, on_support: onSupport }) => {
  const key = byId("lines");
  key.replaceChildren();
  const line = (label, look) => keyEntry(key, label, (picture) => draw(picture, "path", { d: "M0 7H22", ...look }));
  if (inSpace) line("robot", { stroke: "var(--metal)", "stroke-width": 7 });
  if (onSupport) line("support", { stroke: "var(--edge)", "stroke-width": 5 });
  line(inSpace ? "what gives, this motion" : "this motion", { stroke: "var(--this)", "stroke-width": 5 });
  line("plain cycloid", { stroke: "var(--cycloid)", "stroke-width": 5, "stroke-opacity": 0.6 });
  line("at the end", { stroke: "var(--soft)", "stroke-width": 1.2, "stroke-dasharray": "5 3" });
  line("way of the tip", { d: "M0 7H22M11 7H22", stroke: "var(--this)", "stroke-width": 1.8 });
  draw(key.lastChild.firstChild, "path", { d: "M11 7H22", stroke: "var(--this)", "stroke-width": 5, "stroke-opacity": AFTER });
  if (!inSpace) return;
  keyEntry(key, room.square_words, (picture) => draw(picture, "path", { d: "M4 2H18V12H4Z", fill: "var(--after)", stroke: "var(--edge)" }));
  element(key, "span", coarse.matches ? "swipe to turn it" : "drag to turn it");
};
const drawPlane = (svg) => {
  const { structure } = state.move;
  const { width, height } = begin(svg);
  const [[left, bottom], [right, top]] = structure.corners;
  const margin = { x: 30, top: 20, bottom: 36 }; // above the bar of a length
  const scale = Math.min((width - 2 * margin.x) / (right - left || 1), (height - margin.top - margin.bottom) / (top - bottom || 1));
  const x0 = (width - scale * (right - left)) / 2;
  const y0 = margin.top + (height - margin.top - margin.bottom + scale * (top - bottom)) / 2;
  scene.at = (x, y) => [x0 + scale * (x - left), y0 - scale * (y - bottom)];
  const thick = Math.max(0.7, Math.min(1.3, Math.min(width, height) / 320));
  structure.parts.forEach((part, k) => draw(svg, "path", { ...ROUND, d: pathOf(structure.target[k].map(([x, y]) => scene.at(x, y))), stroke: "var(--soft)", "stroke-width": part.points === 1 ? 0 : 1.2, "stroke-dasharray": "5 5", "stroke-opacity": 0.75 }));
  const grey = "var(--cycloid)";
  // the ghost's trail is wide and pale, so that both are seen where one lies on the other
  scene.ghostTrails = trailsIn(svg, grey, [[5, 0.35], [10, 0.35]]);
  const ghost = bodiesIn(svg, { rigid: grey, link: grey }, thick, 0.55);
  scene.trails = trailsIn(svg, "var(--this)", [[1.8, 1], [4.5, AFTER]]);
  const bodies = bodiesIn(svg, { rigid: "var(--metal)", link: "var(--this)" }, thick, 1);
  drawLength(svg, scale, width, height);
  scene.show = (now, before) => {
    placeBodies(bodies, now);
    placeBodies(ghost, before);
    placeTrails(scene.trails, trails, now);
    placeTrails(scene.ghostTrails, ghostTrails, before);
  };
};
const trailsIn = (svg, colour, looks) => Array.from({ length: state.move.structure.trails }, () => looks.map(([wide, seen]) => draw(svg, "path", { ...ROUND, "stroke-linecap": "butt", stroke: colour, "stroke-width": wide, "stroke-opacity": seen })));
const bodiesIn = (svg, colours, thick, seen) => state.move.structure.parts.map(({ look, width: wide }) => draw(svg, "path", {
  ...ROUND,
  stroke: colours[look],
  "stroke-width": thick * wide * 1.15,
  "stroke-opacity": seen,
}));
const drawLength = (svg, scale, width, height) => {
  const metres = niceStep((0.12 * width) / scale);
  const bar = metres * scale;
  const words = metres < 1 ? `${fixed(100 * metres, metres < 0.01 ? 1 : 0)} cm` : `${metres} m`;
  draw(svg, "path", { d: `M${width - 4 - bar} ${height - 8}v4h${bar}v-4`, fill: "none", stroke: "var(--soft)" });
  draw(svg, "text", { x: width - 4 - bar / 2, y: height - 11, "text-anchor": "middle", class: "halo" }, words);
};
const placeBodies = (paths, coordinates) => {
  let next = 0;
  state.move.structure.parts.forEach(({ points }, k) => {
    const line = Array.from({ length: points }, () => scene.at(coordinates[next++], coordinates[next++]));
    paths[k].setAttribute("d", pathOf(line));
  });
};
const placeTrails = (paths, trails, coordinates) => {
  const { times, duration, arrival } = state.move;
  const now = lastBefore(times, state.time);
  trails.forEach((trail, tip) => {
    const end = coordinates.length - dimensions() * (trails.length - tip);
    const here = [...coordinates.slice(end, end + dimensions())];
    const onScreen = (points) => pathOf(points.map((point) => scene.at(...point)));
    const moving = trail.slice(0, Math.min(now, arrival) + 1);
    const after = state.time > duration ? [...trail.slice(arrival, now + 1), here] : [];
    paths[tip][0].setAttribute("d", onScreen(after.length ? moving : [...moving, here]));
    paths[tip][1].setAttribute("d", onScreen(after));
  });
};

const drawSwing = () => {
  const svg = byId("swing");
  const { width } = begin(svg);
  const { panels, cycloid, factor, swings_about_rest: band, unit } = state.move;
  const all = panels.deflection.rows.flat();
  const low = Math.min(0, ...all.map((row) => Math.min(...row)));
  const high = Math.max(...all.map((row) => Math.max(...row)), low + 1e-12);
  const axis = axisOf(low, high, width < 420 ? 5 : 8);
  const [left, right, y] = [14, width - 14, 27];
  swing.x = (value) => left + ((value - axis.low) / (axis.high - axis.low)) * (right - left);
  const shown = axis.unit(unit);
  const { title } = panels.deflection;
  const heading = `${title[0].toLowerCase()}${title.slice(1)} [${shown}]`;
  const words = band && width > 400 ? `${heading}; bands: its range after arrival` : `${heading}${band ? "; bands: after arrival" : ""}`;
  draw(svg, "text", { x: 0, y: 11 }, words);
  draw(svg, "line", { x1: left, x2: right, y1: y, y2: y, stroke: "var(--grid)", "stroke-width": 2 });
  for (const [value, word] of axis.ticks) {
    draw(svg, "line", { x1: swing.x(value), x2: swing.x(value), y1: y + 7, y2: y + 11, stroke: "var(--soft)", "stroke-opacity": 0.6 });
    draw(svg, "text", { x: swing.x(value), y: y + 23, "text-anchor": "middle" }, word);
  }
  swing.ends = (residual) => [Math.max(low, -factor * residual), factor * residual];
  const bandOf = (fill, high) => draw(svg, "rect", { y: y - high / 2, height: high, rx: high / 2, fill, visibility: band ? "visible" : "hidden" });
  placeBand(bandOf("var(--band)", 15), cycloid.residual);
  swing.band = setAll(bandOf("var(--this)", 9), { "fill-opacity": 0.3 });
  swing.ghost = ofCycloid(panels.deflection.rows).map(() => draw(svg, "circle", { cy: y, r: 5, fill: "var(--cycloid)" }));
  swing.dots = ofChosen(panels.deflection.rows).map(() => draw(svg, "circle", { cy: y, r: 5.5, fill: "var(--this)", stroke: "var(--card)", "stroke-width": 1.5 }));
  svg.setAttribute("aria-label", `${title} at this time, and its range after arrival`);
};
const placeBand = (rect, residual) => {
  const [from, to] = swing.ends(residual).map(swing.x);
  setAll(rect, { x: from - 1, width: to - from + 2 });
};
