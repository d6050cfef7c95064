// The clock, the words, the controls, and what happens when a move, a motion or a time changes.
const stillness = matchMedia("(prefers-reduced-motion: reduce)");
const PAUSE = 0.6; // seconds at the end, before the motion begins again
let ghostTrails = [];
let trails = [];

const showMotion = () => {
  const { move } = state;
  for (const panel of panels) ofChosen(move.panels[panel.name].rows).forEach((row, k) => panel.curves[k].setAttribute("d", panel.pathOf(row)));
  trails = trailsOf(ofChosen(move.scores));
  placeBand(swing.band, chosen().residual);
  showWords();
  showTime();
};
const showWords = () => {
  const { figure_names: names, cycloid, beside, factor, unit, rest } = state.move;
  const point = chosen();
  byId("sentence").textContent = point.sentence;
  const rows = byId("figures");
  rows.replaceChildren();
  names.forEach((name, k) => {
    const row = element(rows, "tr");
    element(row, "th", name).scope = "row";
    element(row, "td", point.cells[k], "plan");
    element(row, "td", cycloid.cells[k]);
  });
  const others = beside.filter(({ kind, points }) => kind !== "plan" && points.length && points[0][0] !== null);
  byId("nearest").textContent = others.map(({ label, points }) => {
    const [residual, energy] = points.reduce((best, other) => (Math.abs(other[0] - point.residual) < Math.abs(best[0] - point.residual) ? other : best));
    const words = residual < rest ? "at rest" : `${(factor * residual).toPrecision(3)} ${unit}`;
    return `${label}${points.length > 1 ? ", nearest" : ""}: ${words}, ${energy.toPrecision(3)} J`;
  }).join("; ");
};
const showTime = () => {
  const { move, time } = state;
  const now = coordinatesAt(ofChosen(move.scores), time);
  const ghost = coordinatesAt(ofCycloid(move.scores), time);
  placeBodies(scene.bodies, now);
  placeBodies(scene.ghost, ghost);
  placeTrails(scene.trails, trails, now);
  placeTrails(scene.ghostTrails, ghostTrails, ghost);
  const { rows } = move.panels.deflection;
  ofChosen(rows).forEach((row, k) => swing.dots[k].setAttribute("cx", swing.x(valueAt(move.times, row, time))));
  ofCycloid(rows).forEach((row, k) => swing.ghost[k].setAttribute("cx", swing.x(valueAt(move.times, row, time))));
  panels.forEach(placePanel);
  byId("time").value = time;
  byId("clock").textContent = `${time.toFixed(2)} s`;
  setAll(byId("time"), { "aria-valuetext": `${time.toFixed(2)} seconds` });
  byId("phase").textContent = time < move.duration ? "moving" : chosen().swing;
};
const drawAll = () => {
  drawFront();
  drawKey();
  drawScene();
  drawSwing();
  drawPanels();
  ghostTrails = trailsOf(ofCycloid(state.move.scores));
  showMotion();
};
const invitation = (move, several) => {
  if (!several) return "A motion of an arm that bends, beside the plain cycloid.";
  if (move.joined) return "Every point is a motion of an arm that bends, and the blue curve the best of them. Drag along it.";
  return "Every point is a motion of an arm that bends. Drag from one to the next.";
};
const take = (move) => {
  state.move = move;
  state.point = Math.min(state.point, lastPoint());
  state.time = Math.min(state.time, move.end);
  byId("time").max = move.end;
  const several = lastPoint() > 0;
  byId("heading").textContent = several ? "How still, for how much energy?" : "A motion, and the plain cycloid";
  byId("choosing").hidden = !several;
  byId("invitation").textContent = invitation(move, several);
  byId("title").textContent = `${move.title}.`;
  byId("note").textContent = move.note;
  drawAll();
};

// The clock.
let waited = 0;
let last = 0;
const seek = (time) => {
  state.time = Math.min(Math.max(time, 0), state.move.end);
  waited = 0;
  showTime();
};
const play = (on) => {
  if (on === state.playing) return;
  state.playing = on;
  byId("play").textContent = on ? "Pause" : "Play";
  if (!on) return;
  last = performance.now();
  requestAnimationFrame(step);
};
const step = (now) => {
  if (!state.playing) return;
  const passed = Math.min(Math.max(now - last, 0), 100) / 1000; // a page that was hidden goes on where it was
  last = now;
  if (state.time < state.move.end) seek(state.time + state.speed * passed);
  else if ((waited += passed) > PAUSE) seek(0);
  requestAnimationFrame(step);
};
// Where the cycloid swings most after arrival: there a change of the motion is seen.
const widestSwing = () => {
  const { times, duration, panels: { deflection } } = state.move;
  const row = ofCycloid(deflection.rows)[0];
  return times.reduce((best, time, k) => (time > duration && Math.abs(row[k]) > Math.abs(row[times.indexOf(best)]) ? time : best), duration);
};

// Controls.
const choices = (field, words, first, onChange) => words.forEach((word, k) => {
  const label = element(field, "label");
  const input = element(label, "input");
  Object.assign(input, { type: "radio", name: field.id, value: k, checked: k === first });
  input.addEventListener("change", () => onChange(k));
  label.append(word);
});
const SPEEDS = [["1\u00d7", 1], ["\u00bd", 0.5], ["\u00bc", 0.25], ["\u215b", 0.125]];
choices(byId("moves"), moves.map(({ label }) => label), 0, (k) => take(moves[k]));
byId("moves").hidden = moves.length === 1;
choices(byId("speeds"), SPEEDS.map(([word]) => word), 1, (k) => { state.speed = SPEEDS[k][1]; });
byId("play").addEventListener("click", () => play(!state.playing));
byId("time").addEventListener("input", () => {
  play(false);
  seek(Number(byId("time").value));
});
addEventListener("keydown", (event) => {
  if (event.key !== " " || event.target.closest("button, input")) return;
  event.preventDefault();
  play(!state.playing);
});
stillness.addEventListener("change", () => play(!stillness.matches));

// In a frame of another page: it says the colours by {quietarm: {theme: "dark"}}, and is told how high this page is.
const framed = window.parent !== window;
document.documentElement.classList.toggle("framed", framed);
const tellHeight = () => {
  if (framed) window.parent.postMessage({ quietarm: { height: Math.ceil(document.querySelector("main").getBoundingClientRect().height) } }, "*");
};

// The first drawing waits for a size: in a frame that is hidden there is none.
let drawnSize = "";
addEventListener("message", ({ data }) => {
  const theme = data?.quietarm?.theme;
  if (theme === "dark" || theme === "light") document.documentElement.dataset.theme = theme;
  if (theme === "auto") delete document.documentElement.dataset.theme;
  if (theme && drawnSize) tellHeight(); // whoever listened too late
});
const drawInSize = () => {
  const size = [byId("front").clientWidth, byId("scene").clientHeight].join();
  if (!byId("front").clientWidth || size === drawnSize) return;
  const begins = drawnSize === "";
  drawnSize = size;
  if (!begins) return drawAll();
  if (stillness.matches) state.time = widestSwing();
  take(moves[0]);
  if (!stillness.matches) play(true);
};
new ResizeObserver(() => {
  drawInSize();
  if (drawnSize) tellHeight();
}).observe(document.querySelector("main"));
