// The page's numbers: what is stored, how it is read between samples, and how it is written.
const { moves } = JSON.parse(document.getElementById("data").textContent);

// Rows of 16-bit integers in base64, each line with its unit.
const unpack = ({ data, units, lines, samples }) => {
  const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const row = (motion, line) => {
    const begin = (motion * lines + line) * samples;
    return Float64Array.from({ length: samples }, (_, k) => units[line] * view.getInt16(2 * (begin + k), true));
  };
  const motions = lines ? bytes.length / (2 * lines * samples) : 0;
  return Array.from({ length: motions }, (_, motion) => Array.from({ length: lines }, (_, line) => row(motion, line)));
};
for (const move of moves) {
  move.scores = unpack(move.structure.scores);
  for (const panel of Object.values(move.panels)) panel.rows = unpack(panel.values);
}

const lastBefore = (times, time) => {
  let low = 0;
  let high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return low;
};
const valueAt = (times, values, time) => {
  const k = lastBefore(times, time);
  const share = Math.min(1, (time - times[k]) / (times[k + 1] - times[k]));
  return values[k] + share * (values[k + 1] - values[k]);
};
const largest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);

const fixed = (value, places) => {
  const text = value.toFixed(places);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
};
const placesFor = (size) => (size > 0 ? Math.min(9, Math.max(0, 2 - Math.floor(Math.log10(size)))) : 0);
const niceStep = (least) => {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((digit) => digit * power).find((step) => step >= least * 0.999);
};
const ticks = (low, high, about) => {
  const step = niceStep((high - low) / about);
  const places = Math.min(9, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
  const places_of_all = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) places_of_all.push([k * step, fixed(k * step, places)]);
  return places_of_all;
};
