// The state of the page is its address, so that it can be reloaded, kept and shared:
//
//   /                      the start
//   /?shape=ID             a search with a shape of the index
//   /?query=ADDRESS        a search with an upload, while the server keeps it
//   &hit=ID                one of the results, overlaid with the query
//   &k=N &rank=RANK       how to search; the list #rank has all ranks
//   &filter=TEXT           the shapes listed beside the results

export const USUAL_K = 12;

// The first is the usual one.
const RANKS = [...document.querySelectorAll('#rank option')].map(({ value }) => value);

export function read() {
  const given = new URLSearchParams(location.search);
  const k = Number.parseInt(given.get('k'), 10);
  return {
    shape: given.get('shape'),
    query: given.get('query'),
    hit: given.get('hit'),
    k: k >= 1 && k <= 100 ? k : USUAL_K,
    rank: RANKS.includes(given.get('rank')) ? given.get('rank') : RANKS[0],
    filter: given.get('filter') ?? '',
  };
}

export function address({ shape, query, hit, k, rank, filter }) {
  const params = new URLSearchParams();
  if (shape) params.set('shape', shape);
  else if (query) params.set('query', query);
  if (hit) params.set('hit', hit);
  if (k && k !== USUAL_K) params.set('k', k);
  if (rank && rank !== RANKS[0]) params.set('rank', rank);
  if (filter) params.set('filter', filter);
  const text = params.toString();
  return text ? `/?${text}` : '/';
}

// The parameters of a search in the JSON interface.
export function searched({ shape, query, k, rank }) {
  const params = new URLSearchParams(shape ? { shape } : { query });
  params.set('k', k);
  if (rank && rank !== RANKS[0]) params.set('rank', rank);
  return params;
}

// Whether two states have the same results.
export const sameSearch = (a, b) => Boolean(a && b) && (a.shape || a.query)
  ? searched(a).toString() === searched(b).toString() : Boolean(a && b) && !(b.shape || b.query);
