// Draws surfaces with plotly's mesh3d. Defines one global, `canonform`; uses `Plotly`.
//
//   handle = canonform.view(element, geometry | [geometry, ...], options)
//   handle.update(geometry | [geometry, ...], options)   shows other surfaces in the same scene; the camera stays
//   handle.link(handle | [handle, ...])                  lets the cameras move together from now on
//   handle.reset()                                       puts the camera back to its first position
//   handle.element
//
// geometry: { positions, faces, values?, values_name?, color? }; arrays are base64 of little-endian f32 / u32, or typed
//   arrays. Several geometries share one scene and keep their positions.
// options: { title, linkedWith, opacity: [one per geometry], names: [legend], range: [low, high] of the values }
//
// The element keeps its height (20rem if it has none). It contains p.canonform-title and div.canonform-scene (plotly's),
// or p.canonform-fallback instead of the scene if WebGL is missing. Its data-state is `drawing`, `ready` or `failed`.
'use strict';

const canonform = (() => {
  // The color map of the static images, whose equally spaced colors `viewer_js` inserts.
  const VIRIDIS = 'COLOR_STOPS'.split(' ').map((color, i, { length }) => [i / (length - 1), color]);
  const CLAY = '#b9b4aa';
  const NO_VALUE = '#9a9a9a';
  // From the right front and slightly above, z up: the view of the static images.
  const CAMERA = { eye: { x: 0.75, y: -1.3, z: 0.32 }, up: { x: 0, y: 0, z: 1 }, center: { x: 0, y: 0, z: 0 } };
  const CONFIG = { displaylogo: false, displayModeBar: false, responsive: false, typesetMath: false };
  const LIGHT = { ambient: 0.45, diffuse: 0.6, specular: 0.04, roughness: 0.9, fresnel: 0.02 };

  const darkScheme = matchMedia('(prefers-color-scheme: dark)');
  const handles = new Set();

  // plotly interprets some HTML in every text; names must appear as they are.
  const plain = (text) => String(text).replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');

  // Colors and font of the page.
  function theme() {
    const style = getComputedStyle(document.documentElement);
    const color = (name, light, dark) => style.getPropertyValue(name).trim() || (darkScheme.matches ? dark : light);
    return {
      page: color('--page', '#ffffff', '#14171a'),
      ink: color('--ink', '#1d2126', '#e4e7ea'),
      pale: color('--pale', '#59616b', '#a3abb5'),
      line: color('--line', '#d9dde2', '#353b42'),
      font: getComputedStyle(document.body).fontFamily,
    };
  }

  function decode(array, Type) {
    if (array instanceof Type) return array;
    const text = atob(array);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i += 1) bytes[i] = text.charCodeAt(i);
    return new Type(bytes.buffer);
  }

  // Every third number from `first` on.
  function strided(array, first) {
    const part = new array.constructor(array.length / 3);
    for (let i = 0; i < part.length; i += 1) part[i] = array[3 * i + first];
    return part;
  }

  // Faces whose normals differ by more than 40 degrees meet at a crease.
  const SMOOTH = Math.cos((40 * Math.PI) / 180);
  // Creases of larger surfaces, in numbers in three per face, would take seconds to find.
  const MOST_CORNERS = 900_000;

  // Unit normals of faces; zero for one without area.
  function normalsOf(positions, faces) {
    const normals = new Float32Array(faces.length);
    const side = (from, to) => [0, 1, 2].map((i) => positions[3 * to + i] - positions[3 * from + i]);
    for (let f = 0; f < faces.length; f += 3) {
      const [u, v] = [side(faces[f], faces[f + 1]), side(faces[f], faces[f + 2])];
      const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const length = Math.hypot(...normal);
      if (length > 0) normals.set(normal.map((x) => x / length), f);
    }
    return normals;
  }

  // The surface with the vertices at creases once for every smooth piece, so that flat faces look flat: plotly has one
  // normal per vertex. Corners of faces are joined across every edge that is not a crease.
  function creased({ positions, faces, values }) {
    const whole = { positions, faces, values };
    if (faces.length > MOST_CORNERS) return whole;
    const normals = normalsOf(positions, faces);
    const joined = Uint32Array.from(faces, (_, corner) => corner);
    const piece = (corner) => {
      let at = corner;
      while (joined[at] !== at) at = joined[at] = joined[joined[at]];
      return at;
    };
    const next = (corner) => (corner % 3 === 2 ? corner - 2 : corner + 1);
    const edges = new Map();
    const n = positions.length / 3;
    let isSharp = false;
    for (let corner = 0; corner < faces.length; corner += 1) {
      const [a, b] = [faces[corner], faces[next(corner)]];
      const edge = Math.min(a, b) * n + Math.max(a, b);
      const other = edges.get(edge);
      if (other === undefined) {
        edges.set(edge, corner);
        continue;
      }
      const [f, g] = [corner - (corner % 3), other - (other % 3)];
      const isReversed = faces[other] === a;
      const [x, y, z] = [0, 1, 2].map((i) => normals[f + i] * normals[g + i]);
      const cosine = isReversed ? -(x + y + z) : x + y + z;
      const hasArea = (face) => normals[face] !== 0 || normals[face + 1] !== 0 || normals[face + 2] !== 0;
      if (cosine < SMOOTH && hasArea(f) && hasArea(g)) {
        isSharp = true;
        continue;
      }
      joined[piece(corner)] = piece(isReversed ? other : next(other));
      joined[piece(next(corner))] = piece(isReversed ? next(other) : other);
    }
    if (!isSharp) return whole;
    const [numbers, sources] = [new Map(), []];
    const split = faces.map((vertex, corner) => {
      const at = piece(corner);
      if (!numbers.has(at)) numbers.set(at, sources.push(vertex) - 1);
      return numbers.get(at);
    });
    return {
      positions: Float32Array.from({ length: 3 * sources.length }, (_, i) => positions[3 * sources[Math.floor(i / 3)] + (i % 3)]),
      faces: split,
      values: values && Float32Array.from(sources, (vertex) => values[vertex]),
    };
  }

  function traces(geometry, { opacity = 1, name, range, colors }) {
    const { positions, faces, values } = creased({
      positions: decode(geometry.positions, Float32Array),
      faces: decode(geometry.faces, Uint32Array),
      values: geometry.values ? decode(geometry.values, Float32Array) : null,
    });
    const base = {
      type: 'mesh3d', x: strided(positions, 0), y: strided(positions, 1), z: strided(positions, 2),
      // With the default, plotly considers small triangles degenerate and leaves them black.
      facenormalsepsilon: 0, vertexnormalsepsilon: 0,
      lighting: LIGHT, lightposition: { x: 2000, y: -4000, z: 6000 }, opacity, hoverinfo: 'skip',
      name: name === undefined ? '' : plain(name), showlegend: name !== undefined,
    };
    const drawn = (indices, more) => ({
      ...base, i: strided(indices, 0), j: strided(indices, 1), k: strided(indices, 2), ...more,
    });
    if (!values) return [drawn(faces, { color: geometry.color || CLAY })];
    // A face is gray if one of its corners has no value.
    const [known, unknown] = [[], []];
    for (let f = 0; f < faces.length; f += 3) {
      const face = faces.subarray(f, f + 3);
      (face.every((v) => Number.isFinite(values[v])) ? known : unknown).push(...face);
    }
    const list = [];
    if (unknown.length > 0) list.push(drawn(Uint32Array.from(unknown), { color: NO_VALUE, showlegend: false }));
    if (known.length > 0) {
      const [low, high] = range || extent(values);
      list.push(drawn(Uint32Array.from(known), {
        intensity: values, colorscale: VIRIDIS, cmin: low, cmax: high > low ? high : low + 1,
        colorbar: {
          title: { text: plain(geometry.values_name || ''), side: 'right', font: { size: 12 } },
          thickness: 12, len: 0.85, x: 1, xanchor: 'right', outlinewidth: 0, nticks: 6,
          tickfont: { color: colors.ink, size: 11 },
        },
      }));
    }
    return list;
  }

  function extent(values) {
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) {
      if (Number.isFinite(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
    }
    return [low, high];
  }

  const AXES = ['x', 'y', 'z'];
  const dot = (a, b) => a.x * b[0] + a.y * b[1] + a.z * b[2];

  // To the viewer, to the right and upwards, seen from the first position of the camera.
  function directions() {
    const towards = unit(CAMERA.eye);
    const across = unit(cross(CAMERA.up, CAMERA.eye));
    return { towards, across, above: cross(towards, across) };
  }

  // Calls `use` on every vertex.
  function eachVertex(data, use) {
    for (const { x, y, z } of data) for (let v = 0; v < x.length; v += 1) use([x[v], y[v], z[v]]);
  }

  // Ranges of the axes, and their lengths as shares of the diagonal. Their middle is where the surfaces have equal room on
  // all sides, seen from the first position of the camera.
  function bounds(data) {
    const ranges = AXES.map((axis) => extent(data.flatMap((trace) => extent(trace[axis]))));
    const size = Math.hypot(...ranges.map(([low, high]) => high - low)) || 1;
    const { across, above } = directions();
    const middle = ranges.map(([low, high]) => (low + high) / 2);
    for (const side of [across, above]) {
      let [low, high] = [Infinity, -Infinity];
      eachVertex(data, (at) => {
        const place = dot(side, at) - dot(side, middle);
        [low, high] = [Math.min(low, place), Math.max(high, place)];
      });
      if (low < high) AXES.forEach((axis, i) => { middle[i] += (side[axis] * (low + high)) / 2; });
    }
    return ranges.map(([low, high], i) => {
      const half = Math.max(high - middle[i], middle[i] - low, 5e-4 * size);
      return { range: [middle[i] - half, middle[i] + half], share: (2 * half) / size };
    });
  }

  // The share of the scene that surfaces fill, seen from the first position of the camera.
  const FILLED = 0.94;
  // The tangent of half the vertical field of view of plotly's scenes, 45 degrees.
  const VIEW = Math.tan(Math.PI / 8);

  // The scale at which all vertices are just inside a scene of this aspect.
  function filling(data, sides, aspect) {
    const { towards, across, above } = directions();
    const distance = Math.hypot(...Object.values(CAMERA.eye));
    let zoom = 10;
    eachVertex(data, (values) => {
      // In shares of the diagonal around the middle of the scene.
      const at = sides.map(({ range: [low, high], share }, i) => (share * (values[i] - (low + high) / 2)) / (high - low));
      // A vertex at s times `at` is seen at s * side / (VIEW * (distance - s * depth)).
      for (const [side, room] of [[dot(above, at), VIEW * FILLED], [dot(across, at), VIEW * FILLED * aspect]]) {
        const size = Math.abs(side) + room * dot(towards, at);
        if (size * zoom > room * distance) zoom = (room * distance) / size;
      }
    });
    return zoom;
  }

  // Width of a color bar, in pixels, which the scene leaves free.
  const BAR = 64;

  function layout(data, [width, height], colors, hasLegend) {
    const sides = bounds(data);
    const share = data.some((trace) => trace.colorbar) ? Math.max(1 - BAR / width, 0.6) : 1;
    const zoom = filling(data, sides, (share * width) / height);
    // Without titles and ticks plotly sets no text in 3D.
    const axis = (i) => ({
      visible: false, showspikes: false, title: { text: '' }, tickmode: 'array', tickvals: [], showticklabels: false,
      range: sides[i].range,
    });
    return {
      margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: 'rgba(0,0,0,0)', uirevision: 'kept',
      font: { color: colors.ink, family: colors.font, size: 12 },
      showlegend: hasLegend,
      legend: { x: 0, y: 0, yanchor: 'bottom', bgcolor: 'rgba(0,0,0,0)', itemclick: 'toggle', itemdoubleclick: false },
      scene: {
        domain: { x: [0, share] },
        dragmode: 'orbit', hovermode: false, camera: structuredClone(CAMERA), uirevision: 'kept',
        aspectmode: 'manual', aspectratio: { x: zoom * sides[0].share, y: zoom * sides[1].share, z: zoom * sides[2].share },
        xaxis: axis(0), yaxis: axis(1), zaxis: axis(2),
      },
    };
  }

  function hasWebGL() {
    const canvas = document.createElement('canvas');
    const context = canvas.getContext('webgl2') || canvas.getContext('webgl');
    // Browsers allow only a few contexts: release this one.
    context?.getExtension('WEBGL_lose_context')?.loseContext();
    return context !== null;
  }

  class View {
    constructor(element, geometries, options) {
      this.element = element;
      this.linked = new Set();
      this.following = false;
      element.classList.add('canonform-view');
      if (element.clientHeight < 40) element.style.height = '20rem';
      element.replaceChildren();
      this.heading = element.appendChild(document.createElement('p'));
      this.heading.className = 'canonform-title';
      this.scene = element.appendChild(document.createElement('div'));
      this.scene.className = 'canonform-scene';
      handles.add(this);
      if (hasWebGL()) {
        this.listen();
        this.update(geometries, options);
      } else {
        this.fail('This view needs WebGL, which the browser does not offer.', geometries, options);
      }
    }

    update(geometries, options = {}) {
      this.shown = { geometries: [].concat(geometries), options };
      if (options.linkedWith) this.link(options.linkedWith);
      if (this.element.dataset.state === 'failed') return Promise.resolve();
      return this.draw();
    }

    async draw() {
      const { geometries, options } = this.shown;
      const { title = '', opacity = [], names = [], range } = options;
      const colors = theme();
      this.element.dataset.state = 'drawing';
      this.heading.textContent = title;
      this.heading.hidden = title === '';
      this.fit();
      const data = geometries.flatMap((geometry, i) =>
        traces(geometry, { opacity: opacity[i], name: names[i], range, colors }));
      await Plotly.react(this.scene, data, layout(data, [this.scene.clientWidth, this.scene.clientHeight], colors, names.length > 0), CONFIG);
      this.element.dataset.state = 'ready';
      if (!this.observer) this.watch();
    }

    // The scene takes the height that the title leaves.
    fit() {
      const height = this.element.clientHeight - this.heading.offsetHeight;
      this.scene.style.height = `${Math.max(height, 40)}px`;
    }

    // Starts after the first drawing.
    watch() {
      this.observer = new ResizeObserver(() => {
        if (this.scene.clientWidth === 0) return;
        this.fit();
        Plotly.Plots.resize(this.scene);
      });
      this.observer.observe(this.element);
      const moved = (event) => { if (event['scene.camera']) this.lead(event['scene.camera']); };
      this.scene.on('plotly_relayouting', moved);
      this.scene.on('plotly_relayout', moved);
      this.follow([...this.linked].find((other) => other.camera)?.camera);
    }

    get camera() {
      return this.scene.layout?.scene?.camera;
    }

    link(others) {
      for (const other of [].concat(others)) {
        if (other === this) continue;
        this.linked.add(other);
        other.linked.add(this);
      }
    }

    // Passes a movement on. A view that follows ignores the events this causes, or it would pass them back.
    lead(camera) {
      if (!this.following) for (const other of this.linked) other.follow(camera);
    }

    async follow(camera) {
      if (!camera || !this.observer) return;
      this.wanted = camera;
      if (this.following) return;
      this.following = true;
      while (this.wanted) {
        const next = this.wanted;
        this.wanted = null;
        await Plotly.relayout(this.scene, { 'scene.camera': next });
      }
      this.following = false;
    }

    move(camera) {
      return Plotly.relayout(this.scene, { 'scene.camera': camera });
    }

    reset() {
      return this.move(structuredClone(CAMERA));
    }

    listen() {
      // Until the scene is clicked, the wheel scrolls the page.
      this.scene.addEventListener('wheel', (event) => {
        if (!this.scene.contains(document.activeElement)) event.stopPropagation();
      }, { capture: true });
      this.scene.tabIndex = 0;
      this.scene.setAttribute('role', 'application');
      this.scene.setAttribute('aria-label', 'Surface in 3D. Arrow keys turn it, plus and minus zoom, Home resets.');
      // The outline of the focus is for keyboards.
      const outline = (style) => { this.scene.style.outline = style; };
      this.scene.addEventListener('pointerdown', () => {
        outline('none');
        this.scene.focus({ preventScroll: true });
      });
      this.scene.addEventListener('blur', () => outline(''));
      this.scene.addEventListener('keydown', (event) => {
        outline('');
        this.steer(event);
      });
    }

    steer(event) {
      const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
      const zooms = { '+': 0.85, '=': 0.85, '-': 1 / 0.85 };
      const camera = this.camera;
      if (!camera || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key in turns) this.move(turned(camera, ...turns[event.key].map((step) => (step * Math.PI) / 18)));
      else if (event.key in zooms) this.move({ ...camera, eye: scaled(camera.eye, zooms[event.key]) });
      else if (event.key === 'Home') this.reset();
      else return;
      event.preventDefault();
    }

    fail(reason, geometries, options = {}) {
      this.element.dataset.state = 'failed';
      this.heading.textContent = options.title || '';
      const count = (geometry) => decode(geometry.positions, Float32Array).length / 3;
      const vertices = [].concat(geometries).map(count).join(' and ');
      this.scene.className = 'canonform-fallback';
      this.scene.textContent = `${reason} The surface has ${vertices} vertices.`;
    }
  }

  const scaled = ({ x, y, z }, by) => ({ x: x * by, y: y * by, z: z * by });
  const sum = (a, b) => ({ x: a.x + b.x, y: a.y + b.y, z: a.z + b.z });
  const cross = (a, b) => ({ x: a.y * b.z - a.z * b.y, y: a.z * b.x - a.x * b.z, z: a.x * b.y - a.y * b.x });
  const unit = (a) => scaled(a, 1 / (Math.hypot(a.x, a.y, a.z) || 1));

  // The camera moved around its target by an angle to the right or upwards.
  function turned(camera, right, up) {
    const across = unit(cross(camera.up, camera.eye));
    const above = unit(cross(camera.eye, across));
    const distance = Math.hypot(camera.eye.x, camera.eye.y, camera.eye.z);
    const towards = unit(camera.eye);
    const angle = right || up;
    const aside = right ? across : above;
    const eye = scaled(sum(scaled(towards, Math.cos(angle)), scaled(aside, Math.sin(angle))), distance);
    return { ...camera, eye, up: up ? unit(cross(eye, across)) : camera.up };
  }

  darkScheme.addEventListener('change', () => {
    for (const handle of handles) {
      if (!handle.element.isConnected) handles.delete(handle);
      else if (handle.observer) handle.draw();
    }
  });

  return {
    view: (element, geometries, options) => new View(element, geometries, options),
    decode, plain, theme, VIRIDIS,
  };
})();
