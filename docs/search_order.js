// Results of a search: pages for users first, then evidence and changes, then the insides of the code
var Scorer = {
  score: ([page, , , , score]) =>
    score - (page.startsWith("api/") ? 60 : /^(evidence\/|changelog|contributing)/.test(page) ? 30 : 0),
  // Sphinx's own numbers, which this object replaces
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
