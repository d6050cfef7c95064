// The numbers that are set by hand: fields, and sliders that go in small steps with the shift key.
const TENTH = 0.1;
const DIGITS = 5; // that are shown, after the point of what is below 1
const fields = new Map(); // by name: what shows a value, and the ends of a slider
const GROUPS = { move: "dials-move", shape: "dials-shape", limits: "dials-limits" };

// A slider tells each value; with the shift key it goes a tenth as far as the pointer, until the button is released.
const slider = (parent, { label, least, most, step }, onSet) => {
  const range = Object.assign(element(parent, "input"), { type: "range", min: least, max: most, step });
  range.setAttribute("aria-label", label);
  let fine = null;
  let last = null;
  let shift = false;
  const note = (event) => { shift = event.shiftKey; };
  range.addEventListener("pointerdown", note);
  range.addEventListener("pointermove", note);
  range.addEventListener("pointerup", () => { fine = last = null; });
  range.addEventListener("pointerdown", () => { last = Number(range.dataset.value); });
  range.addEventListener("input", () => {
    const here = Number(range.value);
    if (last !== null && (shift || fine !== null)) {
      fine = Math.min(Math.max((fine ?? Number(range.dataset.value)) + TENTH * (here - last), range.min), range.max);
      last = here;
      range.value = fine;
      onSet(fine);
      return;
    }
    if (last !== null) last = here;
    onSet(here);
  });
  return range;
};
const rounded = (value) => Number(value.toPrecision(10));
const addDial = (dial, onChange) => {
  const parent = byId(GROUPS[dial.group]);
  const row = element(parent, "label", "", "dial");
  element(row, "span", dial.label);
  const number = Object.assign(document.createElement("input"), { type: "number", step: dial.group === "limits" ? "any" : dial.step, placeholder: "none" });
  const field = { dial, number, range: null };
  const set = (value) => {
    show(field, value);
    onChange(dial.name, value);
  };
  if (dial.group !== "limits") field.range = slider(row, dial, (value) => set(rounded(value)));
  row.append(number);
  number.addEventListener("change", () => {
    const value = number.value.trim() === "" ? null : Number(number.value);
    if (value === null && dial.group !== "limits") return show(field, field.value);
    set(value);
  });
  number.setAttribute("aria-label", dial.label);
  fields.set(dial.name, field);
};
const show = (field, value) => {
  const { number, range } = field;
  field.value = value;
  number.value = value === null ? "" : Number(Math.abs(value) < 1 && Math.abs(value) > 1e-3 ? value.toFixed(DIGITS) : value.toPrecision(DIGITS));
  if (!range || value === null) return;
  range.dataset.value = value;
  range.value = value;
};
// Fields of these dials; sliders that are there already only grow, else they would go under the pointer.
const placeDials = (dials, grows, onChange) => {
  const names = dials.map(({ name, label }) => `${name} ${label}`).join();
  const same = names === [...fields.values()].map(({ dial }) => `${dial.name} ${dial.label}`).join();
  if (!same) {
    fields.clear();
    for (const id of Object.values(GROUPS)) byId(id).replaceChildren();
    for (const dial of dials) addDial(dial, onChange);
    return;
  }
  for (const dial of dials) {
    const { range } = fields.get(dial.name);
    if (!range) continue;
    range.min = grows ? Math.min(range.min, dial.least) : dial.least;
    range.max = grows ? Math.max(range.max, dial.most) : dial.most;
    range.step = dial.step;
  }
};
