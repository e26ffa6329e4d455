// The results: repairs, mesh and form, class, nearest shapes, the overlay of two forms, and corresponding points.
import { mark, tile } from './shapes.js';
import { USUAL_K, searched } from './state.js';

const byId = (id) => document.getElementById(id);
const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}.`;
const number = (value) => Number(value).toPrecision(3).replace(/\.?0+$/, '');

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

  // Old results do not answer a new query.
  hide() {
    this.comparison += 1;
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
    const tiles = found.results.map(({ rank, id, label, distance, ...order }) => {
      const lines = [['more', label], ['more', `${distance.toFixed(3)} away`]];
      // Distances ascend in the plain order only; what another order follows does as well.
      if (order.rank_distance !== undefined) lines.push(['more', `rank distance ${order.rank_distance.toFixed(3)}`]);
      if (order.part_distance !== undefined) {
        lines.push(['more', `part distance ${order.part_distance.toFixed(3)}`]);
        lines.push(['more', `${Math.round(100 * order.part_share)} % of it`]);
      }
      const item = tile(id, label, lines, this.picked);
      Object.assign(item.firstChild.dataset, { distance, rank });
      return item;
    });
    byId('results').replaceChildren(...tiles);
    this.root.dataset.query = found.query;
    this.root.dataset.state = 'ready';
    this.root.removeAttribute('aria-busy');
    // On a narrow screen the results are below the query.
    if (this.root.getBoundingClientRect().top > 0.6 * innerHeight) this.root.scrollIntoView({ block: 'start' });
  }

  showClass({ predicted, repair, repaired, mesh_missing: missing, n_shapes: known, seconds }) {
    const [label, line] = [predicted.label, byId('predicted')];
    line.dataset.label = label ?? '';
    const words = predicted.explanation;
    if (label === null) {
      line.textContent = `Class: ${words}.`;
    } else {
      const strong = document.createElement('strong');
      strong.textContent = label;
      line.replaceChildren('Class: ', strong, `${words.slice(label.length)}.`);
    }
    const size = repair ? `${repair.input_vertices} vertices, ${repair.input_faces} faces; ` : '';
    const time = (seconds.describe + seconds.search).toFixed(2);
    byId('facts').textContent = `${size}searched ${known} shapes in ${time} s`;
    const lines = [...repaired];
    if (missing) lines.push(missing);
    else if (lines.length === 0) lines.push('No repairs needed.');
    byId('repaired').replaceChildren(...lines.map((text) => {
      const item = document.createElement('li');
      item.textContent = text;
      return item;
    }));
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
    const { relation, distance, normalized_distance: normalized, residual } = answer;
    // Names keep their letters.
    byId('overlay-kind').textContent = `${relation.text} (${Math.round(100 * relation.confidence)} % certain).`;
    byId('overlay-kind').dataset.kind = relation.kind;
    byId('overlay-facts').textContent = `${sentence(relation.because.text)} ` +
      `Distance between the forms: ${number(distance)}, ${number(normalized)} at equal size. ` +
      `Points of the first form are ${number(residual[0].median)} from the second (median), ` +
      `${number(residual[0].max)} at most.`;
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
    facts.textContent = 'Matching, which takes some seconds…';
    const answer = await ask(`/api/match?${this.pair}`);
    if (comparison !== this.comparison) return;
    if (answer.error) {
      part.dataset.state = 'failed';
      facts.textContent = answer.remedy ? `${answer.error}; ${answer.remedy}` : answer.error;
      return;
    }
    const words = { direct: 'the map that keeps left and right', mirrored: 'the mirrored map', unoriented: 'the map' };
    const change = ({ kind, distortion }) => `${words[kind]} changes distances by ${number(100 * distortion)} % of the square root of the area`;
    facts.textContent = `${sentence(answer.maps.map(change).join(', '))} Points that the first map joins have the same colour.`;
    await Promise.all(['match-first', 'match-second'].map(
      (id, i) => view(id, answer.meshes[i], { title: [answer.a, answer.b][i] })));
    part.dataset.state = 'ready';
  }

  // Coloured by the residual; with both shown, the second is a pale shell around the first.
  drawOverlay() {
    if (!this.overlaid) return undefined;
    const { forms, residual, a, b } = this.overlaid;
    const shown = document.querySelector('input[name=shown]:checked').value;
    const range = [0, Math.max(residual[0].max, residual[1].max)];
    const shell = { ...forms[1], values: undefined, color: '#8fa3b8' };
    const [surfaces, opacity] = {
      both: [[forms[0], shell], [1, 0.35]],
      first: [[forms[0]], [1]],
      second: [[forms[1]], [1]],
    }[shown];
    const title = { both: `${a} inside ${b}`, first: a, second: b }[shown];
    return view('overlay-view', surfaces, { title, opacity, range });
  }
}
