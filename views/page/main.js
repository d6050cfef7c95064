// The clock, the words, the controls, and what happens when a move, a motion or a time changes.
const stillness = matchMedia("(prefers-reduced-motion: reduce)");
const PAUSE = 0.6; // seconds at the end, before the motion begins again
let ghostTrails = [];
let trails = [];

const showMotion = () => {
  const { move } = state;
  panels.forEach(placeCurve);
  trails = trailsOf(ofChosen(move.scores));
  placeBand(swing.band, chosen().residual);
  showWords();
  showTime();
};
const showWords = () => {
  const { figure_names: names, cycloid } = state.move;
  const point = chosen();
  byId("names").value = state.point;
  say(point);
  const rows = byId("figures");
  rows.replaceChildren();
  names.forEach((name, k) => {
    const row = element(rows, "tr");
    element(row, "th", name).scope = "row";
    for (const [motion, look] of [[point, "plan"], [cycloid, ""]]) {
      const cell = element(row, "td", motion.cells[k], look);
      if (motion.notes[k]) element(cell, "small", motion.notes[k]);
    }
  });
};
// What a motion trades, and the nearest ones of other methods.
const say = (point) => {
  const { beside, factor, unit, rest } = state.move;
  byId("sentence").textContent = unbroken(point.sentence);
  const others = beside.filter(({ kind, points }) => kind !== "plan" && points.length && points[0][0] !== null);
  const words = others.map(({ label, points }) => {
    const [residual, energy] = points.reduce((best, other) => (Math.abs(other[0] - point.residual) < Math.abs(best[0] - point.residual) ? other : best));
    const still = residual < rest ? "at rest" : `${(factor * residual).toPrecision(3)} ${unit}`;
    return `${label}${points.length > 1 ? ", nearest" : ""}: ${still}, ${energy.toPrecision(3)} J`;
  }).join("; ");
  byId("nearest").textContent = unbroken(words.charAt(0).toUpperCase() + words.slice(1));
};
// Room for the longest words of all motions, so that nothing below them jumps.
const LONGEST = 4; // of the sentences: the one with the most letters need not have the most lines
const holdRoom = () => {
  const room = byId("sentence").parentElement;
  room.style.minHeight = "";
  const byLength = [...state.move.points].sort((a, b) => b.sentence.length - a.sentence.length);
  const heights = byLength.slice(0, LONGEST).map((point) => {
    say(point);
    return Math.ceil(room.getBoundingClientRect().height); // a part of a pixel would move what is below
  });
  room.style.minHeight = `${Math.max(...heights)}px`;
};
const showTime = () => {
  const { move, time } = state;
  const now = coordinatesAt(ofChosen(move.scores), time);
  const ghost = coordinatesAt(ofCycloid(move.scores), time);
  scene.show(now, ghost);
  const { rows } = move.panels.deflection;
  ofChosen(rows).forEach((row, k) => swing.dots[k].setAttribute("cx", swing.x(valueAt(move.times, row, time))));
  ofCycloid(rows).forEach((row, k) => swing.ghost[k].setAttribute("cx", swing.x(valueAt(move.times, row, time))));
  panels.forEach(placePanel);
  byId("time").value = time;
  const words = time.toFixed(Math.max(2, placesFor(move.end)));
  byId("clock").textContent = `${words} s`;
  setAll(byId("time"), { "aria-valuetext": `${words} seconds` });
  byId("phase").textContent = time < move.duration ? "moving" : chosen().swing;
};
const alsoDrawn = []; // functions
const drawAll = () => {
  drawFront();
  drawKey();
  drawScene();
  drawSwing();
  drawPanels();
  for (const drawMore of alsoDrawn) drawMore();
  ghostTrails = trailsOf(ofCycloid(state.move.scores));
  holdRoom();
  showMotion();
};
const invitation = (move, several) => {
  if (!several) return unbroken(`${move.title}; the plain cycloid of the same move is drawn behind it.`);
  const ways = "Each point is a way to make this move.";
  return move.joined ? `${ways} Drag the ring: left is stiller, right takes less energy.` : unbroken(`${move.title}. ${ways} Drag the ring from one to the next.`);
};
// Motions with names, of which some may lie on each other.
const beginNames = (points) => {
  const names = byId("names");
  names.hidden = points.length < 2 || !points[0].name;
  names.replaceChildren();
  points.forEach(({ name }, k) => Object.assign(element(names, "option", name), { value: k }));
};
// Show a move, its point that is chosen, and this time of it or its end.
const enter = (move) => {
  const lasts = state.move.end;
  state.move = move;
  state.time = Math.min(state.time, move.end);
  byId("time").max = move.end;
  document.documentElement.style.setProperty("--this", `var(--${move.this})`);
  document.documentElement.style.setProperty("--this-ink", `var(--${move.this}-ink)`);
  beginPanels();
  if (move.end !== lasts || !byId("speeds").hasChildNodes()) beginSpeeds();
  byId("choosing").hidden = lastPoint() === 0;
  beginNames(move.points);
  byId("title").textContent = unbroken(`${move.title}.`);
  byId("note").textContent = move.note;
  drawAll();
};
const take = (move) => {
  const several = move.points.length > 1;
  state.point = Math.min(state.point, move.points.length - 1);
  if (!alive) {
    byId("heading").textContent = several ? "How still, for how much energy?" : "A motion, and the plain cycloid";
    byId("invitation").textContent = invitation(move, several);
  }
  for (const panel of panels) panel.names = null;
  enter(move);
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
  // After a click the arrow keys go on along the front; whoever chose by keys stays here.
  let clicked = false;
  label.addEventListener("pointerdown", () => { clicked = true; });
  input.addEventListener("change", () => {
    onChange(k);
    if (clicked) byId("handle").focus({ preventScroll: true });
    clicked = false;
  });
  label.append(word);
});
// So many seconds of the motion in a second on the screen, from fast to slow.
const SPEEDS = [200, 100, 50, 20, 10, 5, 2, 1, 1 / 2, 1 / 4, 1 / 8, 1 / 20, 1 / 50, 1 / 100, 1 / 200, 1 / 500, 1 / 1000];
const FRACTIONS = { 0.5: "\u00bd", 0.25: "\u00bc", 0.125: "\u215b" };
const speedWords = (speed) => (speed >= 1 ? `${speed}\u00d7` : FRACTIONS[speed] ?? `1/${Math.round(1 / speed)}`);
const USUAL = 4; // seconds on the screen that a motion takes at the speed with which it begins
const beginSpeeds = () => {
  const away = SPEEDS.map((speed) => Math.abs(Math.log(state.move.end / speed / USUAL)));
  const usual = Math.min(Math.max(away.indexOf(Math.min(...away)), 1), SPEEDS.length - 3);
  const offered = SPEEDS.slice(usual - 1, usual + 3);
  state.speed = SPEEDS[usual];
  byId("speeds").replaceChildren();
  choices(byId("speeds"), offered.map(speedWords), 1, (k) => { state.speed = offered[k]; });
};
choices(byId("moves"), moves.map(({ label }) => label), 0, (k) => take(moves[k]));
byId("moves").hidden = moves.length === 1;
byId("names").addEventListener("change", () => choose(Number(byId("names").value)));
byId("play").addEventListener("click", () => play(!state.playing));
byId("time").addEventListener("input", () => {
  play(false);
  seek(Number(byId("time").value));
});
addEventListener("keydown", (event) => {
  if (event.key !== " " || event.target.closest("button, input, select, summary")) return;
  event.preventDefault();
  play(!state.playing);
});
stillness.addEventListener("change", () => play(!stillness.matches));

// In a frame of another page: it says the colours by {quietarm: {theme: "dark"}}, keys by {quietarm: {key: "ArrowLeft"}} and that the ring has the keys from now on by {quietarm: {focus: true}}, and is told how high this page is.
document.documentElement.classList.toggle("framed", framed);
const tellHeight = () => {
  if (framed) window.parent.postMessage({ quietarm: { height: Math.ceil(document.querySelector("main").getBoundingClientRect().height) } }, "*");
};

// The first drawing waits for a size: in a frame that is hidden there is none.
let drawnSize = "";
addEventListener("message", ({ data }) => {
  if (Object.hasOwn(SIDEWAYS, data?.quietarm?.key ?? "")) chooseBy(data.quietarm.key);
  if (data?.quietarm?.focus === true) beginKeys();
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
