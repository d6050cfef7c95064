// A structure in space, in perspective: capsules, the farthest first; a drag or the arrow keys turn it. The films have the same camera (`views/pictures/space.py`).
const HIGHEST = 1.5; // radians above the floor
const LOWEST = 0.03;
const TURN = 0.01; // radians a pixel
const TURN_BY_KEY = 0.12;
const camera = { azimuth: 0, elevation: 0, of: null };
const beginCamera = () => {
  const { room } = state.move.structure;
  const key = JSON.stringify(room.seen_from);
  if (camera.of !== key) Object.assign(camera, { azimuth: room.seen_from, elevation: room.elevation, of: key });
};
// Of a point [m]: its place on the screen, and the pixels of a metre there.
const viewOf = ({ width, height, margin }) => {
  const { middle, reach, half, away } = state.move.structure.room;
  const [c, s] = [Math.cos(camera.azimuth), Math.sin(camera.azimuth)];
  const [ce, se] = [Math.cos(camera.elevation), Math.sin(camera.elevation)];
  // from whatever side, all of the room is in the picture
  const above = (up, towards) => (away * (ce * up - se * towards)) / (away - ce * towards - se * up);
  const heights = [half, -half].flatMap((up) => [above(up, reach), above(up, -reach)]);
  const [top, bottom] = [Math.max(...heights), Math.min(...heights)];
  const wide = (away * reach) / Math.sqrt((away - se * half) ** 2 - (ce * reach) ** 2);
  const scale = Math.min((width / 2 - margin) / wide, (height - 2 * margin) / (top - bottom));
  const level = (height + scale * (top + bottom)) / 2;
  return ([px, py, pz]) => {
    const [x, y, z] = [px - middle[0], py - middle[1], pz - middle[2]];
    const ahead = c * x + s * y;
    const here = (scale * away) / (away - ce * ahead - se * z);
    return [width / 2 + here * (c * y - s * x), level - here * (ce * z - se * ahead), here];
  };
};

// The outline around two discs, always the same way round, so that outlines can lie on each other.
const disc = (x, y, r) => `M${x - r} ${y}a${r} ${r} 0 1 1 ${2 * r} 0a${r} ${r} 0 1 1 ${-2 * r} 0Z`;
const hull = (a, b) => {
  const distance = Math.hypot(b.x - a.x, b.y - a.y);
  if (distance <= Math.abs(a.r - b.r) + 1e-6) return a.r > b.r ? disc(a.x, a.y, a.r) : disc(b.x, b.y, b.r);
  const towards = Math.atan2(b.y - a.y, b.x - a.x);
  const apart = Math.acos((a.r - b.r) / distance);
  const at = ({ x, y, r }, turn) => `${(x + r * Math.cos(towards + turn)).toFixed(1)} ${(y + r * Math.sin(towards + turn)).toFixed(1)}`;
  const round = ({ r }, large) => `A${r.toFixed(1)} ${r.toFixed(1)} 0 ${large ? 1 : 0} 1 `;
  return `M${at(a, apart)}${round(a, 2 * apart < Math.PI)}${at(a, -apart)}L${at(b, -apart)}${round(b, 2 * apart > Math.PI)}${at(b, apart)}Z`;
};
const capsule = (seen, radius, { wider = 0, shift = 0 } = {}) => {
  const discs = seen.map(([x, y, scale]) => ({ x: x - shift * radius * scale, y: y - shift * radius * scale, r: radius * scale + wider }));
  if (discs.length === 1) return disc(discs[0].x, discs[0].y, discs[0].r);
  return discs.slice(1).map((next, k) => hull(discs[k], next)).join("");
};

const LIT = 0.35; // how far to the side light falls on a part, and how wide, in its radii
const FLAT = 0.45; // height of a shadow as a share of its width, about
const pointsOf = (coordinates) => {
  let next = 0;
  return state.move.structure.parts.map((part) => ({ ...part, line: Array.from({ length: part.points }, () => [coordinates[next++], coordinates[next++], coordinates[next++]]) }));
};
const drawSpace = (svg) => {
  beginCamera();
  const { width, height } = begin(svg);
  const { parts, target } = state.move.structure;
  const solid = parts.filter(({ look }) => look !== "ground");
  const floor = [draw(svg, "path", { fill: "var(--after)" }), draw(svg, "path", { stroke: "var(--edge)", fill: "none" })];
  const shadow = draw(svg, "path", { fill: "var(--shadow)" });
  const targets = target.map(() => draw(svg, "path", { ...ROUND, stroke: "var(--soft)", "stroke-width": 1.2, "stroke-dasharray": "5 5", "stroke-opacity": 0.75 }));
  scene.ghostTrails = trailsIn(svg, "var(--cycloid)", [[5, 0.35], [10, 0.35]]);
  const ghost = { rigid: draw(svg, "path", { fill: "var(--cycloid)", "fill-opacity": 0.4 }), link: draw(svg, "path", { fill: "var(--cycloid)", "fill-opacity": 0.75 }) };
  scene.trails = trailsIn(svg, "var(--this)", [[1.8, 1], [4.5, AFTER]]);
  const slots = parts.map(() => ["edge", "part", "lit"].map((name) => draw(svg, "path", { class: name })));
  scene.show = (now, before) => {
    const look = viewOf({ width, height, margin: 6 });
    scene.at = (...point) => look(point);
    placeFloor(floor, look);
    const placed = pointsOf(now).map((part) => ({ ...part, seen: part.line.map(look) }));
    const level = state.move.structure.room.floor;
    const casts = placed.filter(({ look: name }) => name !== "ground");
    shadow.setAttribute("d", casts.map(({ line, radius }) => capsule(line.map(([x, y]) => look([x, y, level])), FLAT * radius)).join(""));
    target.forEach((line, k) => targets[k].setAttribute("d", solid[k].points > 1 ? pathOf(line.map(look)) : ""));
    const ghosts = pointsOf(before);
    for (const [name, path] of Object.entries(ghost)) path.setAttribute("d", ghosts.filter((part) => part.look === name).map(({ line, radius }) => capsule(line.map(look), radius)).join(""));
    const nearness = ({ seen }) => seen.reduce((sum, [, , scale]) => sum + scale, 0) / seen.length;
    placed.sort((a, b) => nearness(a) - nearness(b)).forEach(({ seen, radius, look: name }, k) => {
      const [edge, part, lit] = slots[k];
      edge.setAttribute("d", capsule(seen, radius, { wider: 1 }));
      setAll(part, { d: capsule(seen, radius), fill: IN_SPACE[name] });
      lit.setAttribute("d", capsule(seen, LIT * radius, { shift: 1 }));
    });
    placeTrails(scene.ghostTrails, ghostTrails, before);
    placeTrails(scene.trails, trails, now);
  };
};
const IN_SPACE = { ground: "var(--edge)", rigid: "var(--metal)", link: "var(--this)" };
const ROUND_FLOOR = 48; // corners
const placeFloor = ([ground, squares], look) => {
  const { middle: [x, y], reach, floor, square } = state.move.structure.room;
  const turns = Array.from({ length: ROUND_FLOOR }, (_, k) => (2 * Math.PI * k) / ROUND_FLOOR);
  ground.setAttribute("d", `${pathOf(turns.map((turn) => look([x + reach * Math.cos(turn), y + reach * Math.sin(turn), floor])))}Z`);
  const count = Math.floor((reach * 0.999) / square);
  const lines = Array.from({ length: 2 * count + 1 }, (_, k) => (k - count) * square).flatMap((at) => {
    const half = Math.sqrt(reach ** 2 - at ** 2);
    return [[[x + at, y - half], [x + at, y + half]], [[x - half, y + at], [x + half, y + at]]];
  });
  squares.setAttribute("d", lines.map((line) => pathOf(line.map(([px, py]) => look([px, py, floor])))).join(""));
};

// Turning.
const turn = (across, up) => {
  camera.azimuth -= across;
  camera.elevation = Math.min(HIGHEST, Math.max(LOWEST, camera.elevation + up));
  showTime();
};
const turning = { x: 0, y: 0 };
draggable(byId("scene"), {
  onBegin: (event) => Object.assign(turning, { x: event.clientX, y: event.clientY }),
  onMove: (event) => {
    if (!state.move.structure.in_space) return;
    turn(TURN * (event.clientX - turning.x), TURN * (event.clientY - turning.y));
    Object.assign(turning, { x: event.clientX, y: event.clientY });
  },
});
byId("scene").addEventListener("dblclick", () => {
  if (!state.move.structure.in_space) return;
  camera.of = null;
  beginCamera();
  showTime();
});
const BY_KEY = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
byId("scene").addEventListener("keydown", (event) => {
  if (!(event.key in BY_KEY) || !state.move.structure.in_space) return;
  event.preventDefault();
  event.stopPropagation();
  turn(...BY_KEY[event.key].map((way) => TURN_BY_KEY * way));
});
