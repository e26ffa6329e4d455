// Figure 4 to turn and to ask: a map, a matrix, and two shapes with their forms.
//
// For those who drive the page:
//   #figure4-method, #figure4-scale, #figure4-color, #figure4-first, #figure4-second      selects
//   #figure4-map, #figure4-matrix              plots; a click chooses a shape, or a pair
//   #figure4-card                              over the map, while the pointer is on a point; img.shape, img.form
//   #figure4-first-shape, -first-form, -second-shape, -second-form, -overlay     views in 3D (see viewer.js for data-state)
//   #figure4-facts                             what is shown, in words; data-first and data-second are places in the record
//   script#figure4-data, script#figure4-shape-I                                  islands
'use strict';

(() => {
  const root = document.getElementById('figure4-explorer');
  if (!root) return;

  const { island, layout, color, symbol, redraw } = plots;
  const { plain, decode, VIRIDIS } = canonform;
  const get = (name) => document.getElementById(`figure4-${name}`);
  const controls = { method: get('method'), scale: get('scale'), color: get('color'), first: get('first'), second: get('second') };
  const [map, matrix, card, facts] = ['map', 'matrix', 'card', 'facts'].map(get);
  const figure = island('figure4-data');
  const { names, labels, panels, methods } = figure;
  const classes = [...new Set(labels)];
  const n = names.length;
  const hasShapes = methods.length > 0;

  const chosen = (control) => Number(control?.value ?? 0);
  const panel = () => panels.find(({ method, scale }) => method === controls.method.value && scale === controls.scale.value) ?? panels[0];
  const distances = (of) => {
    const flat = decode(of.matrix, Float32Array);
    return Array.from({ length: n }, (_, i) => flat.subarray(i * n, (i + 1) * n));
  };

  // The map: one trace for each class, and rings around what is chosen.
  plots.kind('map', () => {
    const { map: points, unit } = panel();
    const data = classes.map((label, c) => {
      const members = labels.flatMap((own, i) => (own === label ? [i] : []));
      return {
        mode: 'markers', name: plain(label), x: members.map((i) => points[i][0]), y: members.map((i) => points[i][1]),
        customdata: members, marker: { color: color(c), symbol: symbol(c), size: 10, line: { width: 0.5, color: canonform.theme().page } },
        // Where there are pictures, a card says more than plotly's label.
        hovertemplate: hasShapes ? undefined : members.map((i) => `<b>${plain(names[i])}</b><br>${plain(label)}<extra></extra>`),
        hoverinfo: hasShapes ? 'none' : undefined,
      };
    });
    const { ink } = canonform.theme();
    const rings = [chosen(controls.first), chosen(controls.second)];
    data.push({
      mode: 'markers+text', x: rings.map((i) => points[i][0]), y: rings.map((i) => points[i][1]), text: ['1', '2'],
      textposition: ['top left', 'bottom right'], hoverinfo: 'skip', showlegend: false,
      marker: { size: 17, symbol: 'circle-open', color: ink, line: { width: 1.5 } },
    });
    return {
      data,
      layout: layout({
        margin: { l: 56, r: 12, t: 8, b: 44 },
        xaxis: { title: { text: `MDS axis 1 (${unit})` } },
        yaxis: { title: { text: `MDS axis 2 (${unit})` }, scaleanchor: 'x' },
      }),
    };
  });

  // The matrix, with a line between classes.
  plots.kind('matrix', () => {
    const { unit } = panel();
    const borders = labels.flatMap((label, i) => (i > 0 && labels[i - 1] !== label ? [i - 0.5] : []));
    const edges = [-0.5, ...borders, n - 0.5];
    const centers = edges.slice(1).map((end, i) => (edges[i] + end) / 2);
    const ticks = { tickvals: centers, ticktext: centers.map((at) => plain(labels[Math.round(at)])), showgrid: false, ticks: '', showline: false };
    const { page, ink } = canonform.theme();
    const line = (x0, y0, x1, y1) => ({ type: 'line', x0, y0, x1, y1, line: { color: page, width: 1 } });
    const [i, j] = [chosen(controls.first), chosen(controls.second)];
    return {
      data: [{
        type: 'heatmap', z: distances(panel()), colorscale: VIRIDIS,
        customdata: names.map((own) => names.map((other) => `${plain(own)} and ${plain(other)}`)),
        hovertemplate: `<b>%{customdata}</b><br>distance %{z:.4~g} ${plain(unit)}<extra></extra>`,
        colorbar: { title: { text: `distance (${unit})`, side: 'right' }, thickness: 12, outlinewidth: 0 },
      }],
      layout: layout({
        margin: { l: 56, r: 12, t: 8, b: 44 },
        xaxis: { ...ticks, constrain: 'domain' },
        yaxis: { ...ticks, autorange: 'reversed', scaleanchor: 'x', tickangle: -90, constrain: 'domain' },
        shapes: [
          ...borders.flatMap((at) => [line(at, -0.5, at, n - 0.5), line(-0.5, at, n - 0.5, at)]),
          { type: 'rect', x0: j - 0.6, x1: j + 0.6, y0: i - 0.6, y1: i + 0.6, line: { color: '#ffffff', width: 3 } },
          { type: 'rect', x0: j - 0.6, x1: j + 0.6, y0: i - 0.6, y1: i + 0.6, line: { color: '#000000', width: 1 } },
        ],
      }),
    };
  });

  map.addEventListener('plotted', () => {
    map.on('plotly_click', ({ points: [point] }) => choose(point.customdata));
    if (!hasShapes) return;
    map.on('plotly_hover', ({ points: [point], event }) => showCard(point.customdata, event));
    map.on('plotly_unhover', () => { card.hidden = true; });
  });
  matrix.addEventListener('plotted', () => {
    matrix.on('plotly_click', ({ points: [point] }) => choose(...point.pointIndex));
  });

  function choose(first, second) {
    if (!Number.isInteger(first)) return;
    controls.first.value = first;
    if (Number.isInteger(second)) controls.second.value = second;
    show();
  }

  function showCard(i, event) {
    const { shape, forms } = figure.thumbnails[i];
    card.querySelector('img.shape').src = shape;
    card.querySelector('img.form').src = forms[Math.max(methods.indexOf(panel().method), 0)];
    card.querySelector('.name').textContent = names[i];
    card.querySelector('.class').textContent = labels[i];
    card.hidden = false;
    // Beside the pointer, and within the map.
    const box = map.getBoundingClientRect();
    const place = (at, size, room) => Math.max(0, Math.min(at + 14 + size > room ? at - size - 14 : at + 14, room - size));
    card.style.left = `${place(event.clientX - box.left, card.offsetWidth, box.width)}px`;
    card.style.top = `${place(event.clientY - box.top, card.offsetHeight, box.height)}px`;
  }

  const views = new Map();

  function display(name, geometries, options) {
    const view = views.get(name);
    if (view) view.update(geometries, options);
    else views.set(name, canonform.view(get(name), geometries, { ...options, linkedWith: [...views.values()] }));
  }

  function showSurfaces() {
    const [i, j] = [chosen(controls.first), chosen(controls.second)];
    const { method } = panel();
    for (const [which, shape] of [['first', i], ['second', j]]) {
      const [surface, form] = surfaces.pair(shape, method, controls.color.value);
      display(`${which}-shape`, surface, { title: names[shape] });
      display(`${which}-form`, form, { title: `its form (${method})` });
    }
    display('overlay', surfaces.overlay(i, j, panel()), { title: 'Form 1 laid over form 2', opacity: [1, 0.35] });
  }

  function describe() {
    const [i, j] = [chosen(controls.first), chosen(controls.second)];
    const { method, unit } = panel();
    const distance = distances(panel())[i][j].toPrecision(4);
    const sentences = [`${names[i]} (${labels[i]}) and ${names[j]} (${labels[j]}): their forms by ${method} are ${distance} apart (${unit}).`];
    if (hasShapes) {
      const coarse = [...new Set([i, j])].map((s) => [names[s], ...surfaces.vertices(s)]).filter(([, shown, all]) => shown < all);
      if (coarse.length > 0) {
        const counts = coarse.map(([name, shown, all]) => `${name} with ${shown} of ${all} vertices`).join(', ');
        sentences.push(`Shown coarser than computed: ${counts}.`);
      }
      if (controls.color.value === 'residual' && !surfaces.hasResidual(i, method)) {
        sentences.push('Forms of a kernel have no unit of length, so there is no residual to show: classes are.');
      }
    }
    facts.textContent = sentences.join(' ');
    facts.dataset.first = i;
    facts.dataset.second = j;
  }

  function show() {
    describe();
    redraw(map);
    redraw(matrix);
    if (views.size > 0) showSurfaces();
  }

  for (const control of Object.values(controls)) {
    control?.addEventListener('change', () => {
      card.hidden = true;
      show();
    });
  }
  describe();
  const scenes = root.querySelector('.views');
  if (scenes) plots.whenNear(scenes, showSurfaces);
})();
