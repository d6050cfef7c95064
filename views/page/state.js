// What is chosen: a move, one of its motions, a time; and what is read of it. A motion by hand is the only one of its move, and lies beside the front of another: `front`. A motion that is kept is drawn in all panels.
const state = { move: moves[0], point: 0, time: 0, playing: false, speed: 0.5, front: null, kept: null };
const framed = window.parent !== window; // in another page
const AFTER = 0.45; // opacity of what is drawn after arrival
const chosen = () => state.move.points[state.point];
const frontMove = () => state.front ?? state.move;
const isByHand = () => frontMove() !== state.move;
const lastPoint = () => frontMove().points.length - 1;
const ofChosen = (rows) => rows[state.point];
const ofCycloid = (rows) => rows[state.move.points.length];

const dimensions = () => (state.move.structure.in_space ? 3 : 2);

// Coordinates of all parts of a motion, then of its tips [m], x, y and in space z in turn, from the scores of its shapes; or the last of them alone.
const coordinatesBy = (scoreOf, first = 0) => {
  const { mean, shapes } = state.move.structure;
  const sum = Float64Array.from(mean.slice(first));
  shapes.forEach((shape, k) => {
    const score = scoreOf(k);
    for (let i = 0; i < sum.length; i++) sum[i] += score * shape[first + i];
  });
  return sum;
};
const coordinatesAt = (scores, time) => coordinatesBy((k) => valueAt(state.move.times, scores[k], time));
const trailsOf = (scores) => {
  const { trails: count, mean } = state.move.structure;
  const everySample = state.move.times.map((_, sample) => coordinatesBy((k) => scores[k][sample], mean.length - dimensions() * count));
  return Array.from({ length: count }, (_, tip) => everySample.map((row) => [...row.slice(dimensions() * tip, dimensions() * (tip + 1))]));
};
