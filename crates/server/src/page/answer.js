// The results: repairs, mesh and form, class, nearest shapes.
import { Comparison, ask, byId, number, view, views } from './comparison.js';
import { commonFolder, folderOf, mark, nameOf, tile } from './shapes.js';
import { USUAL_K, searched } from './state.js';

const percent = (share) => `${Math.round(100 * share)} %`;

// Results whose files are read to say how they are related; the others keep what the index tells.
const MOST_EXPLAINED = 24;

export class Answer {
  // Calls `picked` with a result to overlay, and `closed` without one.
  constructor({ picked, closed }) {
    this.picked = picked;
    this.root = byId('answer');
    this.root.dataset.state = 'empty';
    byId('sort').addEventListener('change', () => this.sort());
    this.comparison = new Comparison(() => {
      const result = byId('results').querySelector('[aria-pressed=true]');
      closed();
      result?.focus();
    });
  }

  begin(name) {
    this.leaveStart();
    this.root.dataset.state = 'busy';
    this.root.dataset.query = name;
    this.root.setAttribute('aria-busy', 'true');
    byId('found').classList.add('busy');
    byId('start').classList.add('busy');
  }

  fail() {
    this.root.dataset.state = 'failed';
    this.hide();
  }

  // The start.
  clear() {
    this.root.dataset.state = 'empty';
    this.root.dataset.query = '';
    this.hide();
  }

  // The list of shapes moves beside the answer. Until there is one it is hidden, so that it is not seen to jump.
  leaveStart() {
    if (byId('page').dataset.at === 'answer') return;
    const had = byId('pick').contains(document.activeElement);
    byId('page').dataset.at = 'answer';
    byId('pick').hidden = true;
    if (had) this.root.focus({ preventScroll: true });
  }

  // Old results do not answer a new query.
  hide() {
    this.comparison.hide();
    this.found = null;
    byId('page').dataset.at = 'start';
    byId('pick').hidden = false;
    this.root.removeAttribute('aria-busy');
    byId('found').hidden = true;
    byId('start').hidden = false;
    byId('start').classList.remove('busy');
  }

  // How the address says to search.
  controls({ k, rank }) {
    const select = byId('k');
    const isListed = (value) => [...select.options].some((option) => Number(option.value) === value);
    // A number that someone typed into the address.
    if (!isListed(k)) select.add(new Option(k, k));
    select.value = String(k ?? USUAL_K);
    byId('rank').value = rank;
  }

  show(found, state) {
    this.found = found;
    this.comparison.hide();
    byId('start').hidden = true;
    byId('found').hidden = false;
    byId('found').classList.remove('busy');
    byId('query-name').textContent = found.query;
    this.showClass(found);
    for (const format of ['csv', 'json']) {
      const params = searched(state);
      params.set('format', format);
      params.set('geometry', 'false');
      byId(`as-${format}`).href = `/api/search?${params}`;
    }
    view('form-view', found.form, { title: found.mesh ? 'Canonical form' : 'Canonical form, points stored in the index' });
    byId('mesh-view').hidden = !found.mesh;
    if (found.mesh) view('mesh-view', found.mesh, { title: 'Shape', linkedWith: views['form-view'] });
    const folder = commonFolder(found.results.map(({ id }) => id));
    byId('results-folder').textContent = folder && `in ${folder}`;
    byId('results').replaceChildren(...found.results.map((result) => this.card(result, folder)));
    this.sort();
    byId('results').dataset.explained = 'false';
    byId('components').replaceChildren();
    byId('pick').hidden = false;
    this.explain(state);
    this.root.dataset.query = found.query;
    this.root.dataset.state = 'ready';
    this.root.removeAttribute('aria-busy');
    // On a narrow screen the results are below the query.
    if (this.root.getBoundingClientRect().top > 0.6 * innerHeight) this.root.scrollIntoView({ block: 'start' });
  }

  // Shapes that are equal in the chosen respect stay in the order of the answer.
  sort() {
    const by = byId('sort').value;
    const key = ({ firstChild: { dataset } }) => (by === 'name' ? nameOf(dataset.id) : dataset[by]);
    const items = [...byId('results').children].sort((a, b) => a.firstChild.dataset.rank - b.firstChild.dataset.rank);
    if (by !== 'rank') items.sort((a, b) => key(a).localeCompare(key(b), 'en', { numeric: true }));
    byId('results').append(...items);
  }

  // A result: its name and folder, its class, and how it is related to the query.
  card(result, common) {
    const { rank, id, label, path, distance } = result;
    const folder = folderOf(id).slice(common.length).replace(/^\//, '');
    const lines = [];
    if (folder && folder !== label) lines.push(['more', folder]);
    if (label) lines.push(['more', label]);
    lines.push(['more', path.slice(path.lastIndexOf('.'))]);
    if (result.part_share !== undefined) lines.push(['more', `the query is ${percent(result.part_share)} of it`]);
    lines.push(['kind', '']);
    const item = tile(id, label, lines, '', this.picked);
    Object.assign(item.firstChild.dataset, { distance, rank });
    this.tell(item.firstChild, result);
    return item;
  }

  // Says on a card how a shape is related; all about it is shown on hover.
  tell(card, { path, relation, distance, ...order }) {
    card.dataset.kind = relation.kind;
    // Without its mesh, a part is only known to differ from wholes.
    const isKnown = order.part_distance === undefined || relation.because.basis !== 'descriptions';
    card.querySelector('.kind').textContent = isKnown ? relation.brief : '';
    const lines = [path];
    if (isKnown) lines.push(`${relation.text} (${percent(relation.confidence)} certain)`, `distance ${number(distance)}`);
    // What another order follows.
    if (order.rank_distance !== undefined) lines.push(`rank distance ${number(order.rank_distance)}`);
    if (order.part_distance !== undefined) lines.push(`part distance ${number(order.part_distance)}`);
    if (order.surface_gap !== undefined) lines.push(`surface gap ${number(order.surface_gap)}`);
    if (order.form_distance !== undefined) lines.push(`form distance ${number(order.form_distance)}`);
    card.title = lines.join('\n');
  }

  // Compares the files and meshes of the results with the query, which takes longer than the search: cards then say what
  // is the same file or surface, and the components of the query are named.
  async explain(state) {
    const { found } = this;
    const params = searched(state);
    params.set('explain', 'true');
    params.set('k', Math.min(state.k ?? USUAL_K, MOST_EXPLAINED));
    params.set('geometry', 'false');
    const answer = await ask(`/api/search?${params}`);
    if (this.found !== found || answer.error) return;
    const cards = new Map([...byId('results').querySelectorAll('.tile')].map((card) => [card.dataset.id, card]));
    for (const result of answer.results) if (cards.has(result.id)) this.tell(cards.get(result.id), result);
    const parts = (answer.components ?? []).map(({ copies, n_vertices: n, nearest }) =>
      `${copies === 1 ? '1 component' : `${copies} components`} of ${n} vertices: ${nearest?.relation.text ?? 'nothing found'}.`);
    const wholes = (answer.wholes ?? []).map(({ relation }) => `${relation.text}.`);
    this.list('components', [...parts, ...wholes]);
    this.sort();
    byId('results').dataset.explained = 'true';
  }

  list(id, texts) {
    byId(id).replaceChildren(...texts.map((text) => {
      const item = document.createElement('li');
      item.textContent = text;
      return item;
    }));
  }

  showClass({ predicted, repair, repaired, mesh_missing: missing }) {
    const [label, line] = [predicted.label, byId('predicted')];
    line.dataset.label = label ?? '';
    const words = predicted.explanation;
    if (predicted.unknown === 'unlabelled') {
      // Without classes there is none to predict.
      line.textContent = predicted.warning ? `${predicted.warning}.` : '';
    } else if (label === null) {
      line.textContent = `Class: ${words}.`;
    } else {
      const strong = document.createElement('strong');
      strong.textContent = label;
      line.replaceChildren('Class: ', strong, `${words.slice(label.length)}.`);
    }
    byId('facts').textContent = repair ? `${repair.input_vertices} vertices, ${repair.input_faces} faces` : '';
    const lines = [...repaired];
    if (missing) lines.push(missing);
    else if (lines.length === 0) lines.push('No repairs needed.');
    this.list('repaired', lines);
  }

  uncompare() {
    this.comparison.hide();
    mark(byId('results'), null);
  }

  compare(id) {
    const { query, query_id: queryId } = this.found;
    mark(byId('results'), id);
    return this.comparison.show(query, id, new URLSearchParams({ ...(queryId ? { query: queryId } : { a: query }), b: id }));
  }
}
