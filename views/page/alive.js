// The page alive: what is set on it, what it asks its server, and what it shows of the answers.
const UNSET = { plant: "", profile: "", terms: null, values: {}, optimal: false, point: null };
let question = UNSET;
let settings = alive.fields; // values and ranges of the fields, as the server made them
const traced = { front: alive.front && unpackMove(alive.front), key: "" }; // the latest front, and what it is of

// Asking. Every line of an answer is JSON; those before the last say how far the server is.
const ENDED = "the server has ended; start quietarm explore again";
const REFUSED = { 503: "many questions wait; try again" };
const ask = async (what, about, onProgress = () => {}) => {
  const response = await fetch(`/${what}`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(about) }).catch(() => null);
  if (!response) return { error: ENDED };
  if (!response.ok) return { error: REFUSED[response.status] ?? `the server refuses this: ${response.status}` };
  return readLines(response.body, onProgress).catch(() => ({ error: ENDED }));
};
const readLines = async (body, onProgress) => {
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  let answer = { error: ENDED };
  for (;;) {
    const { done, value = "" } = await reader.read();
    text += value;
    const lines = text.split("\n");
    text = lines.pop();
    for (const line of lines) {
      answer = JSON.parse(line);
      if ("total" in answer) onProgress(answer);
    }
    if (done) return answer;
  }
};
const tell = (words, wrong = false) => {
  byId("said").textContent = words;
  byId("said").classList.toggle("wrong", wrong);
};

// What a front is of: all that was set but the coefficients, and what only the gradient reads.
const isOfShape = (name) => /^a[0-9]+$/.test(name) && settings.dials.some((dial) => dial.name === name && dial.group === "shape");
const keyOf = ({ plant, profile, terms, values }) => {
  const others = Object.entries(values).filter(([name]) => !isOfShape(name) && name !== "residual_limit");
  return JSON.stringify([plant, profile, terms, others.sort()]);
};
traced.key = keyOf(UNSET);
const frontOf = (about) => (traced.front && traced.key === keyOf(about) ? traced.front : null);

// Motions: while one is computed only the latest question waits.
let waiting = null;
let isAsking = false;
const SOON = 400; // milliseconds, after which a visitor wonders
const askMotion = async (next) => {
  question = next;
  waiting = next;
  if (isAsking) return;
  isAsking = true;
  while (waiting) {
    const about = waiting;
    waiting = null;
    const takesLong = setTimeout(() => tell("computing ..."), SOON);
    const answer = await ask("motion", about);
    clearTimeout(takesLong);
    if (answer.error) tell(answer.error, true);
    else showAnswer(answer, about);
  }
  isAsking = false;
  askAtRest();
};
const showAnswer = ({ move, fields: next, warning }, about) => {
  state.front = frontOf(about);
  state.point = 0;
  enter(unpackMove(move));
  settings = next;
  if (!waiting) showFields(about); // unless something else was set meanwhile
  noteStale(true);
  tell(warning);
};
let shownOf = "";
const showFields = ({ plant, profile, terms, values }) => {
  isShapeKnown = true;
  const { shown, dials } = settings;
  const same = JSON.stringify([plant, profile, terms, values.bound]);
  placeDials(dials, same === shownOf, setDial);
  shownOf = same;
  for (const { name } of dials) show(fields.get(name), shown[name]);
  byId("plant").value = shown.plant;
  byId("profile").value = shown.profile;
  byId("terms").value = shown.terms ?? "";
  showEnabled();
};
let isBusy = false;
const showEnabled = () => {
  for (const input of byId("hand").querySelectorAll("input, button, select")) input.disabled = isBusy;
  for (const name of ["plant", "profile", "terms"]) byId(name).disabled ||= alive.fixed;
  byId("terms").disabled ||= settings.shown.terms === null;
};

// Setting. A motion by hand has all of its coefficients, whoever found them; those of a sweep follow the move.
const coefficientsNow = () => Object.fromEntries([...fields].filter(([, { dial }]) => dial.group === "shape").map(([name, { value }]) => [name, value]));
const withoutShape = (values) => Object.fromEntries(Object.entries(values).filter(([name]) => !isOfShape(name)));
let isShapeKnown = true; // not while another profile is on its way
const setDial = (name, value) => {
  const { group } = fields.get(name).dial;
  const looksUp = !isShapeKnown || (alive.fixed && group === "move");
  const values = { ...withoutShape(question.values), ...(looksUp ? {} : coefficientsNow()), [name]: value };
  askMotion({ ...question, values, optimal: false, point: null });
};
const setPlain = () => {
  const plain = Object.fromEntries(settings.plain.map((value, k) => [`a${k + 1}`, value]));
  askMotion({ ...question, values: { ...question.values, ...plain }, optimal: false, point: null });
};
const choosePlant = (plant) => {
  if (state.kept) keep();
  askMotion({ ...question, plant, values: { ...question.values, ...coefficientsNow() }, optimal: false, point: null });
};
const chooseProfile = (profile, terms) => {
  isShapeKnown = false;
  askMotion({ ...question, profile, terms, values: withoutShape(question.values), optimal: false, point: null });
};

// What takes longer: meanwhile nothing can be set.
const work = async (words, task) => {
  isBusy = true;
  showEnabled();
  tell(words);
  await task();
  isBusy = false;
  showEnabled();
};
const solve = () => work("solving ...", async () => {
  const about = { ...question, optimal: true, point: null };
  const answer = await ask("motion", about);
  if (answer.error) return tell(answer.error, true);
  question = about;
  showAnswer(answer, about);
  askAtRest();
});
const trace = () => work("front ...", async () => {
  const about = { ...question, optimal: false, point: null };
  const answer = await ask("front", about, ({ done, total }) => tell(`front: ${done} of ${total} points`));
  if (answer.error) return tell(answer.error, true);
  Object.assign(traced, { front: unpackMove(answer.front), key: keyOf(about) });
  state.front = traced.front;
  enter(state.move);
  tell("drag the ring along the front");
});

// What takes longer, and is asked for when the hand rests: all figures, and the residual with errors.
const AT_REST = 150; // milliseconds
let restAfter = 0;
const askAtRest = () => {
  clearTimeout(restAfter);
  restAfter = setTimeout(async () => {
    const about = question;
    const isOld = () => isAsking || question !== about;
    if (isOld()) return;
    const { rows, error } = await ask("rows", about);
    if (isOld()) return;
    if (error) tell(error, true);
    else showRows(rows);
    const answer = await ask("robustness", about);
    if (isOld()) return;
    robustness.now = answer.robustness ?? null;
    noteStale(false);
    drawRobustness();
    if (alive.traces) traceAtFirst();
  }, AT_REST);
};
// The front of the move that the page begins with: nothing is empty before the first drag.
const traceAtFirst = async () => {
  alive.traces = false;
  const { front } = await ask("front", UNSET);
  if (!front || traced.front || keyOf(question) !== keyOf(UNSET)) return;
  traced.front = unpackMove(front);
  state.front = traced.front;
  enter(state.move);
};
const showRows = (rows) => {
  const list = byId("rows");
  list.replaceChildren();
  for (const [name, words] of rows) {
    const row = element(list, "div");
    element(row, "dt", name);
    element(row, "dd", unbroken(words));
  }
  byId("more").classList.remove("stale");
};
const noteStale = (is) => [byId("more"), robustness.svg].forEach(({ classList }) => classList.toggle("stale", is));
// A point of the front: its motion is here already.
onChoice = (point) => {
  question = { ...question, optimal: false, point };
  traced.front.coefficients[point].forEach((value, k) => show(fields.get(`a${k + 1}`), value));
  noteStale(true);
  tell("");
  askAtRest();
};

// A curve that is kept to be compared, until it is dropped.
const keep = () => {
  state.kept = state.kept ? null : keptNow();
  robustness.kept = state.kept && robustness.now;
  byId("keep").textContent = state.kept ? "Drop curve" : "Keep curve";
  byId("keep").setAttribute("aria-pressed", String(state.kept !== null));
  enter(state.move);
};
const keptNow = () => {
  const { times, arrival, panels: quantities } = state.move;
  const rows = Object.fromEntries(Object.entries(quantities).map(([name, panel]) => [name, ofChosen(panel.rows)]));
  return { times, arrival, rows, residual: chosen().residual, energy: chosen().energy };
};

// A file of the motion that is shown.
const save = (name) => work("writing ...", async () => {
  const answer = await ask(name, question);
  if (answer.error) return tell(answer.error, true);
  const link = Object.assign(document.createElement("a"), { download: name, href: URL.createObjectURL(new Blob([answer.text], { type: "text/plain" })) });
  link.click();
  URL.revokeObjectURL(link.href);
  tell("");
});

const fill = (select, words) => words.forEach((word) => Object.assign(element(select, "option", word), { value: word }));
fill(byId("plant"), alive.plants);
fill(byId("profile"), alive.profiles);
for (const name of alive.files) {
  const button = Object.assign(element(byId("files"), "button", name), { type: "button" });
  button.addEventListener("click", () => save(name));
}
byId("plant").addEventListener("change", () => choosePlant(byId("plant").value));
byId("profile").addEventListener("change", () => chooseProfile(byId("profile").value, null));
byId("terms").addEventListener("change", () => chooseProfile(byId("profile").value, Number(byId("terms").value) || null));
byId("solve").addEventListener("click", solve);
byId("trace").addEventListener("click", trace);
byId("plain").addEventListener("click", setPlain);
byId("keep").addEventListener("click", keep);
byId("more").open = !matchMedia("(max-width: 599px)").matches;
beginRobustness();
alsoDrawn.push(drawRobustness);
if (traced.front) {
  question = { ...UNSET, point: 0 };
  state.front = moves[0] = traced.front;
  state.move = traced.front;
}
showFields(question);
askAtRest();
