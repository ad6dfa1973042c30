// What the search puts first: pages made to be looked up before pages that tell a story, long tables last.
var Scorer = {
  score: ([page, title, anchor, descr, score]) => {
    const first = { "how-to/": 12, "reference/": 6, "gallery/": 5, start: 5 };
    const last = { verification: -12, benchmarks: -12, changelog: -12, "devnotes/": -6, ARCHITECTURE: -6 };
    for (const [place, more] of Object.entries({ ...first, ...last })) if (page.startsWith(place)) return score + more;
    return score;
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
