// The results: repairs, mesh and form, class, nearest shapes, the overlay of two meshes or forms, and corresponding points.
import { commonFolder, folderOf, mark, tile } from './shapes.js';
import { USUAL_K, searched } from './state.js';

const byId = (id) => document.getElementById(id);
const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}.`;
const number = (value) => Number(value.toPrecision(3)).toString();
const percent = (share) => `${Math.round(100 * share)} %`;

// The largest extent of a surface.
function extent({ positions }) {
  const all = canonform.decode(positions, Float32Array);
  const ends = [0, 1, 2].map(() => [Infinity, -Infinity]);
  all.forEach((x, i) => { ends[i % 3] = [Math.min(ends[i % 3][0], x), Math.max(ends[i % 3][1], x)]; });
  return Math.max(...ends.map(([low, high]) => high - low));
}

// Results whose files are read to say how they are related; the others keep what the index tells.
const MOST_EXPLAINED = 24;

// Gaps below this share of the extent are rounding, and have the colour of zero.
const ROUNDING = 1e-3;

// Views are created once and then updated: browsers limit the number of WebGL scenes.
const views = {};
function view(id, geometries, options) {
  if (views[id]) return views[id].update(geometries, options);
  views[id] = canonform.view(byId(id), geometries, options);
  return undefined;
}

async function ask(address) {
  try {
    return await (await fetch(address)).json();
  } catch {
    return { error: 'The server did not respond', remedy: 'check that it is running' };
  }
}

export class Answer {
  // Calls `picked` with a result to overlay, and `closed` without one.
  constructor({ picked, closed }) {
    this.picked = picked;
    this.root = byId('answer');
    this.root.dataset.state = 'empty';
    this.comparison = 0;
    byId('overlay-shown').addEventListener('change', () => this.drawOverlay());
    byId('match-hit').addEventListener('click', () => this.match());
    byId('close-hit').addEventListener('click', () => {
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
    this.comparison += 1;
    this.found = null;
    byId('page').dataset.at = 'start';
    byId('pick').hidden = false;
    this.root.removeAttribute('aria-busy');
    byId('found').hidden = true;
    byId('start').hidden = false;
    byId('start').classList.remove('busy');
  }

  // How the address says to search.
  controls({ k, exact, rank }) {
    const select = byId('k');
    const isListed = (value) => [...select.options].some((option) => Number(option.value) === value);
    // A number that someone typed into the address.
    if (!isListed(k)) select.add(new Option(k, k));
    select.value = String(k ?? USUAL_K);
    byId('exact').checked = exact;
    byId('rank').value = rank;
  }

  show(found, state) {
    this.found = found;
    this.comparison += 1;
    byId('start').hidden = true;
    byId('found').hidden = false;
    byId('found').classList.remove('busy');
    byId('overlay').hidden = true;
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

  // A result: its name and folder, its class, and how it is related to the query.
  card(result, common) {
    const { rank, id, label, distance, relation } = result;
    const folder = folderOf(id).slice(common.length).replace(/^\//, '');
    const lines = [];
    if (folder && folder !== label) lines.push(['more', folder]);
    if (label) lines.push(['more', label]);
    if (result.part_share !== undefined) lines.push(['more', `the query is ${percent(result.part_share)} of it`]);
    lines.push(['kind', relation.brief]);
    const item = tile(id, label, lines, '', this.picked);
    Object.assign(item.firstChild.dataset, { distance, rank });
    this.tell(item.firstChild, result);
    return item;
  }

  // Says on a card how a shape is related; all about it is shown on hover.
  tell(card, { id, relation, distance, ...order }) {
    card.dataset.kind = relation.kind;
    card.querySelector('.kind').textContent = relation.brief;
    const lines = [id, `${relation.text} (${percent(relation.confidence)} certain)`, `distance ${number(distance)}`];
    // What another order follows.
    if (order.rank_distance !== undefined) lines.push(`rank distance ${number(order.rank_distance)}`);
    if (order.part_distance !== undefined) lines.push(`part distance ${number(order.part_distance)}`);
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
    this.comparison += 1;
    byId('overlay').hidden = true;
    mark(byId('results'), null);
  }

  async compare(id) {
    const overlay = byId('overlay');
    const comparison = ++this.comparison;
    const { query, query_id: queryId } = this.found;
    mark(byId('results'), id);
    const isNew = overlay.hidden;
    overlay.hidden = false;
    overlay.dataset.state = 'busy';
    overlay.dataset.id = id;
    byId('overlay-title').textContent = `${query} over ${id}`;
    byId('overlay-kind').textContent = 'Aligning…';
    byId('overlay-kind').dataset.kind = '';
    byId('overlay-facts').textContent = '';
    if (isNew) byId('overlay-title').focus({ preventScroll: true });
    overlay.scrollIntoView({ block: 'nearest' });
    byId('match').hidden = true;
    this.pair = new URLSearchParams({ ...(queryId ? { query: queryId } : { a: query }), b: id });
    const answer = await ask(`/api/compare?${this.pair}`);
    if (comparison !== this.comparison) return;
    if (answer.error) {
      overlay.dataset.state = 'failed';
      byId('overlay-kind').textContent = answer.remedy ? `${answer.error}; ${answer.remedy}` : answer.error;
      return;
    }
    const { relation, meshes, gap, residual } = answer;
    const inSpace = Boolean(meshes);
    overlay.dataset.shown = inSpace ? 'meshes' : 'forms';
    byId('shown-both').textContent = inSpace ? 'both meshes' : 'both forms';
    const most = inSpace ? gap.max : Math.max(residual[0].max, residual[1].max);
    const isRounding = inSpace && most < ROUNDING * extent(meshes[0]) * ROUNDING;
    const shown = inSpace
      ? 'The picture shows the meshes, aligned in space at the size of the first. Colour is the gap between them: '
      : 'The picture shows the canonical forms, aligned, since the meshes are not one rigid body. Colour is the distance between them: ';
    // Names keep their letters.
    byId('overlay-kind').textContent = `${relation.text} (${Math.round(100 * relation.confidence)} % certain).`;
    byId('overlay-kind').dataset.kind = relation.kind;
    byId('overlay-facts').textContent = `${sentence(relation.because.text)} ${shown}${isRounding ? 'there is none' : `at most ${number(most)}`}.`;
    byId('shown-first').textContent = answer.a;
    byId('shown-second').textContent = answer.b;
    this.overlaid = answer;
    await this.drawOverlay();
    overlay.dataset.state = 'ready';
  }

  // Maps the query to the shape of the overlay, and shows both in corresponding colours.
  async match() {
    const { comparison } = this;
    const [part, facts] = [byId('match'), byId('match-facts')];
    part.hidden = false;
    part.dataset.state = 'busy';
    byId('match-title').textContent = `Corresponding points of ${this.found.query} and ${byId('overlay').dataset.id}`;
    part.scrollIntoView({ block: 'start' });
    facts.textContent = 'Matching, which takes some seconds…';
    const answer = await ask(`/api/match?${this.pair}`);
    if (comparison !== this.comparison) return;
    if (answer.error) {
      part.dataset.state = 'failed';
      facts.textContent = answer.remedy ? `${answer.error}; ${answer.remedy}` : answer.error;
      return;
    }
    const words = { direct: 'the map that keeps left and right', mirrored: 'the mirrored map', unoriented: 'the map' };
    const doubt = ({ alternative }) => (alternative ? ' (uncertain: front and back may be exchanged)' : '');
    const change = (map) => `${words[map.kind]} changes distances by ${number(100 * map.distortion)} % of the square root of the area${doubt(map)}`;
    facts.textContent = `${sentence(answer.maps.map(change).join(', '))} Points that the first map joins have the same colour.`;
    await Promise.all(['match-first', 'match-second'].map(
      (id, i) => view(id, answer.meshes[i], { title: [answer.a, answer.b][i] })));
    part.scrollIntoView({ block: 'start' });
    part.dataset.state = 'ready';
  }

  // Coloured by the gap or the residual; with both shown, the second is a pale shell around the first.
  drawOverlay() {
    if (!this.overlaid) return undefined;
    const { meshes, gap, forms, residual, a, b } = this.overlaid;
    const [first, second] = meshes ?? forms;
    const shown = document.querySelector('input[name=shown]:checked').value;
    const most = meshes ? Math.max(gap.max, ROUNDING * extent(first)) : Math.max(residual[0].max, residual[1].max);
    const range = [0, most];
    const shell = { ...second, values: undefined, color: '#8fa3b8' };
    const [surfaces, opacity] = {
      both: [[first, shell], [1, 0.35]],
      first: [[first], [1]],
      second: [[second], [1]],
    }[shown];
    const kind = meshes ? 'Meshes' : 'Canonical forms';
    const title = { both: `${kind}: ${a} inside ${b}`, first: `${kind}: ${a}`, second: `${kind}: ${b}` }[shown];
    return view('overlay-view', surfaces, { title, opacity, range });
  }
}
