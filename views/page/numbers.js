// The page's numbers: what is stored, how it is read between samples, and how it is written.
const { moves, alive } = JSON.parse(document.getElementById("data").textContent);

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
const unpackMove = (move) => {
  move.scores = unpack(move.structure.scores);
  for (const panel of Object.values(move.panels)) panel.rows = unpack(panel.values);
  return move;
};
moves.forEach(unpackMove);

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
// The axis of a quantity: it ends on ticks, beyond all that is drawn; a power of ten stands beside its unit where numbers would be long.
const RAISED = { "-": "\u207b", 0: "\u2070", 1: "\u00b9", 2: "\u00b2", 3: "\u00b3", 4: "\u2074", 5: "\u2075", 6: "\u2076", 7: "\u2077", 8: "\u2078", 9: "\u2079" };
const axisOf = (least, most, about) => {
  const step = niceStep((most - least || 1) / about);
  const low = Math.floor(least / step + 1e-6) * step;
  const high = Math.ceil(most / step - 1e-6) * step;
  const largest = Math.max(Math.abs(low), Math.abs(high));
  const tens = largest >= 1e5 || largest < 0.005 ? 3 * Math.floor(Math.log10(largest) / 3) : 0;
  const factor = 10 ** tens;
  const places = Math.min(9, Math.max(0, tens - Math.floor(Math.log10(step) + 1e-9)));
  const write = (value) => fixed(value / factor, places);
  const power = [...String(tens)].map((sign) => RAISED[sign]).join("");
  const count = Math.round((high - low) / step);
  return {
    low,
    high,
    factor,
    ticks: Array.from({ length: count + 1 }, (_, k) => [low + k * step, write(low + k * step)]),
    unit: (unit) => (tens ? `10${power} ${unit}` : unit),
  };
};
// The same of time, which ends where the motion does.
const timeAxis = (end, about) => {
  const axis = axisOf(0, end, about);
  return { ...axis, high: end, ticks: axis.ticks.filter(([value]) => value <= end * (1 + 1e-9)) };
};
// Words in which no line ends between a number and its unit.
const unbroken = (text) => text.replace(/ = /g, "\u00a0=\u00a0").replace(/(\d) (?=(?:%|[nm\u00b5]?J|mm|[ms]|rad|deg|Hz|kg|k?N|W)(?![a-z]))/g, "$1\u00a0").replace(/(\d\u00a0N) m(?![a-z])/g, "$1\u00a0m");
