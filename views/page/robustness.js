// The residual vibration of the same motion, where the plant has another frequency than was thought.
const robustness = { now: null, kept: null, svg: null, heading: null };
const beginRobustness = () => {
  const box = element(byId("panels"), "div");
  const above = element(box, "div", "", "above");
  robustness.heading = element(above, "h2");
  robustness.svg = draw(box, "svg", { role: "img", id: "robustness" });
  robustness.svg.setAttribute("aria-label", "Residual vibration over the error of the frequency");
};
const drawRobustness = () => {
  const { svg, heading, now, kept } = robustness;
  heading.replaceChildren("Residual over frequency error ");
  begin(svg);
  if (!now) return;
  const curves = [now, ...(kept && state.kept ? [kept] : [])];
  const [least, most] = [now.errors[0], now.errors.at(-1)];
  const high = Math.max(now.tolerated, ...curves.flatMap(({ residuals }) => residuals));
  const [across, along] = [axisOf(least, most, 4), axisOf(0, high || 1, 4)];
  element(heading, "span", `[${along.unit(now.unit)}]`, "unit");
  const widest = Math.max(...along.ticks.map(([, word]) => word.length));
  const box = axes(svg, svg, across, along, { left: Math.max(30, 10 + 7.2 * widest), right: 8, top: 18, bottom: 34 });
  draw(svg, "text", { x: (box.left + box.right) / 2, y: box.bottom + 31, "text-anchor": "middle" }, "frequency error [%]");
  draw(svg, "line", { x1: box.x(0), x2: box.x(0), y1: box.top, y2: box.bottom, stroke: "var(--grid)" });
  draw(svg, "line", { ...DOTTED, x1: box.left, x2: box.right, y1: box.y(now.tolerated), y2: box.y(now.tolerated) });
  draw(svg, "line", { ...DOTTED, x1: box.left + 1, x2: box.left + 16, y1: box.top - 9, y2: box.top - 9 });
  draw(svg, "text", { x: box.left + 21, y: box.top - 5, "font-size": 11 }, "5 % of the cycloid\u2019s");
  const placed = ({ errors, residuals }) => pathOf(errors.map((error, k) => [box.x(error), box.y(residuals[k])]));
  if (curves[1]) draw(svg, "path", { ...ROUND, "stroke-linecap": "butt", d: placed(kept), stroke: `var(--${alive.kept.colour})`, "stroke-width": 1.7, "stroke-dasharray": KEPT_DASHES });
  draw(svg, "path", { ...ROUND, d: placed(now), stroke: "var(--this)", "stroke-width": 2.2 });
};
