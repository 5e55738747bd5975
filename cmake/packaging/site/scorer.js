// Sphinx gives a page 15 for a word of its title and 5 for one of its text, and sorts equals by the alphabet. What explains a word stands
// before pages that use it: the two pages of the manual that explain most, the manual, other pages, pages of single tasks and results.
// A title that is the query itself has 100 and stays first.
const WEIGHTS = [
  [/^examples\/manual\/(safety|concepts)$/, 22],
  [/^examples\/manual\/([^/]*|(tasks|algorithms)\/README)$/, 10],
  [/^examples\/(manual\/(tasks|algorithms)|results)\//, -4],
];
var Scorer = {
  score: ([page, , , , score]) => score + (WEIGHTS.find(([pages]) => pages.test(page)) || [0, 0])[1],
  objNameMatch: 11, objPartialMatch: 6, objPrio: { 0: 15, 1: 5, 2: -5 }, objPrioDefault: 0,
  title: 15, partialTitle: 7, term: 5, partialTerm: 2,
};
