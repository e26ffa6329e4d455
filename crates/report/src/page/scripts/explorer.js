// Figure 4 for exploration: a map and a matrix for every method, and two shapes with their canonical forms.
//
// For programs that drive the page:
//   #figure4-method, #figure4-scale, #figure4-color, #figure4-first, #figure4-second      selects
//   #figure4-map-M, #figure4-matrix-M          plots of method M, from 0 on; a click chooses a shape, or a pair
//   #figure4-card                              over the maps while the pointer is on a point; img.shape, img.form
//   #figure4-first-shape, -first-form, -second-shape, -second-form, -overlay     3D views (see viewer.js for data-state)
//   #figure4-facts                             a description in words; data-first and data-second number the shapes
//   script#figure4-data, script#figure4-shape-I                                  islands
'use strict';

(() => {
  const root = document.getElementById('figure4-explorer');
  if (!root) return;

  const { island, redraw } = plots;
  const get = (name) => document.getElementById(`figure4-${name}`);
  const controls = { method: get('method'), scale: get('scale'), color: get('color'), first: get('first'), second: get('second') };
  const [card, facts] = ['card', 'facts'].map(get);
  const [maps, matrices] = ['map', 'matrix'].map((kind) => [...root.querySelectorAll(`[data-plot=${kind}]`)]);
  const figure = island('figure4-data');
  const { names, labels, panels, methods } = figure;
  const hasShapes = methods.length > 0;

  const chosen = (control) => Number(control?.value ?? 0);
  // At the chosen size: the panel of an element, and that of the method whose forms are shown.
  const panelOf = ({ dataset }) => panels.find(({ method, scale }) => method === dataset.method && scale === controls.scale.value) ?? panels[0];
  const panel = () => panelOf({ dataset: { method: controls.method?.value ?? panels[0].method } });

  // A map with rings around the chosen shapes. Every class is a series, with its shapes in order.
  plots.kind('map', (element) => {
    const { map: described } = panelOf(element);
    const { data, layout } = charts.plot(described);
    const places = names.map(() => [0, 0]);
    const classes = described.series.map(({ name }) => name).reverse();
    data.forEach((trace, c) => {
      trace.customdata = labels.flatMap((label, i) => (label === classes[c] ? [i] : []));
      trace.customdata.forEach((shape, i) => { places[shape] = [trace.x[i], trace.y[i]]; });
      trace.marker.size = 10;
      // If there are images, the card replaces plotly's label.
      if (hasShapes) Object.assign(trace, { hovertemplate: undefined, hoverinfo: 'none' });
    });
    const rings = [chosen(controls.first), chosen(controls.second)].map((shape) => places[shape]);
    const rim = { width: 1.5, color: canonform.theme().ink };
    data.push({
      mode: 'markers+text', x: rings.map(([x]) => x), y: rings.map(([, y]) => y), text: ['1', '2'],
      textposition: ['top left', 'bottom right'], hoverinfo: 'skip', showlegend: false,
      marker: { size: 17, symbol: 'circle-open', color: rim.color, line: rim },
    });
    return { data, layout };
  });

  // A matrix with a frame around the cell of the chosen pair.
  plots.kind('matrix', (element) => {
    const { matrix: described, order } = panelOf(element);
    const { data, layout } = charts.heat(described);
    const [i, j] = [controls.first, controls.second].map((control) => order.indexOf(chosen(control)));
    const frame = (color, width) => ({ type: 'rect', x0: j - 0.6, x1: j + 0.6, y0: i - 0.6, y1: i + 0.6, line: { color, width } });
    return {
      data,
      layout: {
        ...layout, yaxis: { ...layout.yaxis, tickangle: -90 },
        shapes: [...layout.shapes, frame('#ffffff', 3), frame('#000000', 1)],
      },
    };
  });

  for (const map of maps) {
    map.addEventListener('plotted', () => {
      map.on('plotly_click', ({ points: [point] }) => choose(map, point.customdata));
      if (!hasShapes) return;
      map.on('plotly_hover', ({ points: [point], event }) => showCard(map, point.customdata, event));
      map.on('plotly_unhover', () => { card.hidden = true; });
    });
  }
  for (const matrix of matrices) {
    matrix.addEventListener('plotted', () => {
      matrix.on('plotly_click', ({ points: [point] }) => choose(matrix, ...point.pointIndex.map((at) => panelOf(matrix).order[at])));
    });
  }

  // A click chooses the method of its plot, too.
  function choose({ dataset }, first, second) {
    if (!Number.isInteger(first)) return;
    if (controls.method) controls.method.value = dataset.method;
    controls.first.value = first;
    if (Number.isInteger(second)) controls.second.value = second;
    show();
  }

  function showCard(map, i, event) {
    const { shape, forms } = figure.thumbnails[i];
    card.querySelector('img.shape').src = shape;
    card.querySelector('img.form').src = forms[Math.max(methods.indexOf(map.dataset.method), 0)];
    card.querySelector('.name').textContent = names[i];
    card.querySelector('.class').textContent = labels[i];
    card.hidden = false;
    // Beside the pointer, within the maps.
    const box = card.parentElement.getBoundingClientRect();
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
    display('overlay', surfaces.overlay(i, j, panel()), { title: 'Form 1 aligned with form 2', opacity: [1, 0.35] });
  }

  function describe() {
    const [i, j] = [chosen(controls.first), chosen(controls.second)];
    const { method, unit } = panel();
    const distances = maps.map(panelOf).map(({ method: by, matrix: described, order }) =>
      `${charts.rows(described)[order.indexOf(i)][order.indexOf(j)].toPrecision(4)} by ${by}`);
    const sentences = [`${names[i]} (${labels[i]}) and ${names[j]} (${labels[j]}): the distance of their forms is ${distances.join(', ')} (${unit}).`];
    if (hasShapes) {
      const coarse = [...new Set([i, j])].map((s) => [names[s], ...surfaces.vertices(s)]).filter(([, shown, all]) => shown < all);
      if (coarse.length > 0) {
        const counts = coarse.map(([name, shown, all]) => `${name} with ${shown} of ${all} vertices`).join(', ');
        sentences.push(`Shown on coarser meshes than computed: ${counts}.`);
      }
      if (controls.color.value === 'residual' && !surfaces.hasResidual(i, method)) {
        sentences.push('Forms of a kernel have no unit of length, hence no residual; the colours are those of the classes.');
      }
    }
    facts.textContent = sentences.join(' ');
    facts.dataset.first = i;
    facts.dataset.second = j;
  }

  function show() {
    describe();
    for (const plot of [...maps, ...matrices]) redraw(plot);
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
