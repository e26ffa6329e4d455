// Two shapes beside or over each other, with how they are related, and their corresponding points.

export const byId = (id) => document.getElementById(id);
export const number = (value) => Number(value.toPrecision(3)).toString();
const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}.`;

// The largest extent of a surface.
function extent({ positions }) {
  const all = canonform.decode(positions, Float32Array);
  const ends = [0, 1, 2].map(() => [Infinity, -Infinity]);
  all.forEach((x, i) => { ends[i % 3] = [Math.min(ends[i % 3][0], x), Math.max(ends[i % 3][1], x)]; });
  return Math.max(...ends.map(([low, high]) => high - low));
}

// Gaps below this share of the extent come from rounded coordinates in files, and have the color of zero.
const ROUNDING = 1e-5;

// The largest gap between two meshes, and the end of the scale of colors; no gap if it is rounding.
export function gapOf([first], { max }) {
  const rounding = ROUNDING * extent(first);
  return max < rounding ? { largest: 0, scale: rounding } : { largest: max, scale: max };
}

// Views are created once and then updated: browsers limit the number of WebGL scenes.
export const views = {};
export function view(id, geometries, options) {
  if (views[id]) return views[id].update(geometries, options);
  views[id] = canonform.view(byId(id), geometries, options);
  return undefined;
}

export async function ask(address) {
  try {
    return await (await fetch(address)).json();
  } catch {
    return { error: 'The server did not respond', remedy: 'check that it is running' };
  }
}

export const fault = ({ error, remedy }) => (remedy ? `${error}; ${remedy}` : error);

export class Comparison {
  // Calls `closed` when it is closed.
  constructor(closed) {
    this.turn = 0;
    byId('overlay-shown').addEventListener('change', () => this.draw());
    byId('match-hit').addEventListener('click', () => this.match());
    byId('close-hit').addEventListener('click', closed);
  }

  // Answers that are still under way are dropped.
  hide() {
    this.turn += 1;
    byId('overlay').hidden = true;
  }

  // Compares a shape with `id`; `pair` names both in the JSON interface.
  async show(first, id, pair) {
    const overlay = byId('overlay');
    const turn = ++this.turn;
    const isNew = overlay.hidden;
    overlay.hidden = false;
    overlay.dataset.state = 'busy';
    overlay.dataset.id = id;
    byId('overlay-title').textContent = `${first} over ${id}`;
    byId('file-hit').href = `/api/shapes/${encodeURIComponent(id)}/file`;
    byId('overlay-kind').textContent = 'Aligning…';
    byId('overlay-kind').dataset.kind = '';
    byId('overlay-facts').textContent = '';
    if (isNew) byId('overlay-title').focus({ preventScroll: true });
    overlay.scrollIntoView({ block: 'nearest' });
    byId('match').hidden = true;
    Object.assign(this, { first, pair });
    const answer = await ask(`/api/compare?${pair}`);
    if (turn !== this.turn) return;
    if (answer.error) {
      overlay.dataset.state = 'failed';
      byId('overlay-kind').textContent = fault(answer);
      return;
    }
    const { relation, meshes, gap, residual } = answer;
    const inSpace = Boolean(meshes);
    overlay.dataset.shown = inSpace ? 'meshes' : 'forms';
    byId('shown-both').textContent = inSpace ? 'both meshes' : 'both forms';
    const most = inSpace ? gapOf(meshes, gap).largest : Math.max(residual[0].max, residual[1].max);
    const shown = inSpace
      ? 'The picture shows the meshes, aligned in space at the size of the first. Color is the gap between them: '
      : 'The picture shows the canonical forms, aligned, since the meshes are not one rigid body. Color is the distance between them: ';
    // Names keep their letters.
    byId('overlay-kind').textContent = `${relation.text} (${Math.round(100 * relation.confidence)} % certain).`;
    byId('overlay-kind').dataset.kind = relation.kind;
    byId('overlay-facts').textContent = `${sentence(relation.because.text)} ${shown}${inSpace && most === 0 ? 'there is none' : `at most ${number(most)}`}.`;
    byId('shown-first').textContent = answer.a;
    byId('shown-second').textContent = answer.b;
    this.answer = answer;
    await this.draw();
    overlay.dataset.state = 'ready';
  }

  // Colored by the gap or the residual; with both shown, the second is a pale shell around the first.
  draw() {
    if (!this.answer) return undefined;
    const { meshes, gap, forms, residual, a, b } = this.answer;
    const [first, second] = meshes ?? forms;
    const shown = document.querySelector('input[name=shown]:checked').value;
    const range = [0, meshes ? gapOf(meshes, gap).scale : Math.max(residual[0].max, residual[1].max)];
    const shell = { ...second, values: undefined, color: '#8fa3b8' };
    const [surfaces, opacity] = {
      both: [[first, shell], [1, 0.35]],
      beside: [[first], [1]],
      first: [[first], [1]],
      second: [[second], [1]],
    }[shown];
    const kind = meshes ? 'Meshes' : 'Canonical forms';
    const titles = { both: `${a} inside ${b}`, beside: a, first: a, second: b };
    byId('overlay-second').hidden = shown !== 'beside';
    const drawn = [view('overlay-view', surfaces, { title: `${kind}: ${titles[shown]}`, opacity, range })];
    if (shown === 'beside') {
      drawn.push(view('overlay-second', [second], { title: `${kind}: ${b}`, range, linkedWith: views['overlay-view'] }));
    }
    return Promise.all(drawn);
  }

  // Maps the first shape to the second, and shows both in corresponding colors.
  async match() {
    const { turn } = this;
    const [part, facts] = [byId('match'), byId('match-facts')];
    part.hidden = false;
    part.dataset.state = 'busy';
    byId('match-title').textContent = `Corresponding points of ${this.first} and ${byId('overlay').dataset.id}`;
    part.scrollIntoView({ block: 'start' });
    facts.textContent = 'Matching, which takes some seconds…';
    const answer = await ask(`/api/match?${this.pair}`);
    if (turn !== this.turn) return;
    if (answer.error) {
      part.dataset.state = 'failed';
      facts.textContent = fault(answer);
      return;
    }
    const words = { direct: 'the map that keeps left and right', mirrored: 'the mirrored map', unoriented: 'the map' };
    const doubt = ({ alternative }) => (alternative ? ' (uncertain: front and back may be exchanged)' : '');
    const change = (map) => `${words[map.kind]} changes distances by ${number(100 * map.distortion)} % of the square root of the area${doubt(map)}`;
    facts.textContent = `${sentence(answer.maps.map(change).join(', '))} Points that the first map joins have the same color.`;
    await Promise.all(['match-first', 'match-second'].map(
      (id, i) => view(id, answer.meshes[i], { title: [answer.a, answer.b][i] })));
    part.scrollIntoView({ block: 'start' });
    part.dataset.state = 'ready';
  }
}
