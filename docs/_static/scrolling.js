"use strict";
// What is wider than its place scrolls, and says so: its edge fades, with an arrow, where more is hidden.

const scrolling = "article :is(.frame, .table-wrapper, .highlight pre, .equation, .cell_output .text_html, .sig)";

const tellWhatIsHidden = (element) => {
  const hidden = element.scrollWidth - element.clientWidth;
  const at = element.scrollLeft;
  const sides = [at > 1 && "left", at < hidden - 1 && "right"].filter(Boolean);
  element.parentElement.dataset.hidden = hidden > 1 ? sides.join(" ") : "";
  if (hidden > 1) element.tabIndex = 0; // for arrow keys
};

const makeSign = (element) => {
  const holder = document.createElement(element.tagName === "SPAN" ? "span" : "div");
  holder.className = "scrolls";
  element.replaceWith(holder);
  holder.append(element);
  for (const [side, arrow] of [["left", "\u2039"], ["right", "\u203a"]]) {
    const edge = document.createElement("span");
    edge.className = `more ${side}`;
    edge.setAttribute("aria-hidden", "true");
    edge.append(Object.assign(document.createElement("span"), { textContent: arrow }));
    holder.append(edge);
  }
  element.addEventListener("scroll", () => tellWhatIsHidden(element), { passive: true });
};

addEventListener("DOMContentLoaded", () => {
  const elements = [...document.querySelectorAll(scrolling)];
  elements.forEach(makeSign);
  const all = () => elements.forEach(tellWhatIsHidden);
  all();
  addEventListener("load", all); // pictures have their size
  new ResizeObserver(all).observe(document.body);
});
