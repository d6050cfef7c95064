"use strict";
// Words around what was found, in every result: from PAGE_TEXTS, for no page can fetch another from a disk.

const wordsBefore = 80; // letters before the first hit
const wordsInAll = 240;

const textOf = (link) => {
  const [file, anchor] = link.getAttribute("href").split("#");
  const page = PAGE_TEXTS[file.replace(/\.html$/, "")] || {};
  return page[anchor] ? [page[anchor]] : Object.values(page);
};

const snippet = (texts, terms) => {
  for (const text of texts) {
    const lower = text.toLowerCase();
    const places = terms.map((term) => lower.indexOf(term)).filter((place) => place >= 0);
    if (places.length) {
      const first = Math.max(0, Math.min(...places) - wordsBefore);
      return (first ? "... " : "") + text.slice(first, first + wordsInAll) + " ...";
    }
  }
  return (texts[0] || "").slice(0, wordsInAll);
};

// As many letters of a term as its forms share: vibrates, vibration; tip, tips.
const stem = (term) => {
  if (term.length > 5) return term.slice(0, -2);
  return term.length > 3 ? term.replace(/s$/, "") : term;
};

const mark = (paragraph, words, terms) => {
  const escaped = terms.map((term) => term.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
  for (const piece of words.split(new RegExp(`((?:${escaped.join("|")})\\w*)`, "giu"))) {
    const hit = terms.some((term) => piece.toLowerCase().startsWith(term));
    const node = hit ? document.createElement("mark") : document.createTextNode(piece);
    if (hit) node.textContent = piece;
    paragraph.append(node);
  }
};

const query = new URLSearchParams(location.search).get("q") || "";
const terms = query.toLowerCase().split(/[^\p{Letter}\p{Number}_]+/u).filter(Boolean).map(stem);
const results = document.getElementById("search-results");

if (results && terms.length) {
  new MutationObserver(() => {
    for (const item of results.querySelectorAll("ul.search > li:not([data-told])")) {
      item.dataset.told = "";
      const words = snippet(textOf(item.querySelector("a")), terms);
      const paragraph = item.appendChild(document.createElement("p"));
      paragraph.className = "context";
      mark(paragraph, words, terms);
    }
  }).observe(results, { childList: true, subtree: true });
}
