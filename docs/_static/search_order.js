"use strict";
// The order of results: a page whose title has the words, a section, a page with such a heading, a public name, a page that mentions them, an option of a command.

// Of one rank the pages of docs come before the course.
const rank = { title: 500, section: 400, heading: 300, name: 200, mention: 100, option: 50 };
const lists = ["CHANGELOG", "docs/commands", "docs/reference", "docs/licences"]; // they mention everything

// As many letters of a word as its forms share: robust, robustness; limit, limits.
const beginnings = () => {
  const query = new URLSearchParams(location.search).get("q") || "";
  const words = query.toLowerCase().split(/[^\p{Letter}\p{Number}_]+/u).filter(Boolean);
  return words.map((word) => (word.length > 5 ? word.slice(0, -2) : word.replace(/(?<=...)s$/, "")));
};

const hasAll = (title, words) => {
  const inTitle = title.toLowerCase().split(/[^\p{Letter}\p{Number}_]+/u);
  return words.length > 0 && words.every((word) => inTitle.some((beginning) => beginning.startsWith(word)));
};

// Whether a heading of a page has the words.
const hasHeading = (page, words) => {
  const { alltitles: titles, docnames: pages } = Search._index;
  return Object.entries(titles).some(
    ([title, places]) => hasAll(title, words) && places.some(([file]) => pages[file] === page),
  );
};

var Scorer = {
  score: ([page, title, , , score, , kind]) => {
    const words = beginnings();
    const place = () => {
      if (kind === "object") return page.startsWith("docs/commands") ? rank.option : rank.name;
      if (kind === "title") return title.includes(" > ") ? rank.section : rank.title;
      if (hasAll(title, words)) return rank.title;
      return hasHeading(page, words) ? rank.heading : rank.mention;
    };
    const isList = kind !== "object" && lists.some((list) => page.startsWith(list));
    const isDocs = page.startsWith("docs/") && !isList;
    return place() + (isDocs ? 40 : 0) - (isList ? 40 : 0) + Math.min(score, 39) / 2;
  },
  // the weights of Sphinx, by which results of one rank are ordered
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
