// Plots of the page, drawn when they come near the window and again when the colour scheme changes.
//
// For programs that drive the page:
//   html.js                      scripts run
//   [data-plot=KIND]             a plot; data-state is `waiting`, `drawing` or `ready`; data-source names its island
//   script[type="application/json"][id=FIGURE-data]    the description of a figure
//   .chart > .toggle             the button that shows the static figure instead
//   #NAME                        the section of an experiment (figure1, ..., retrieval)
// gallery.js describes Figure 1, explorer.js Figure 4.
'use strict';

const plots = (() => {
  const NEAR = '400px';

  const { plain, theme } = canonform;
  const darkScheme = matchMedia('(prefers-color-scheme: dark)');
  const canHover = matchMedia('(hover: hover)');
  const kinds = new Map();
  const drawn = new Set();
  const islands = new Map();

  const colorOf = ({ color, dark }) => (darkScheme.matches ? dark : color);

  // The data of an island, parsed at first use.
  function island(id) {
    if (!islands.has(id)) islands.set(id, JSON.parse(document.getElementById(id).textContent));
    return islands.get(id);
  }

  // A layout in the colours of the page; `more` is merged over it, axes one level deep.
  function layout({ xaxis, yaxis, ...more } = {}) {
    const { page, ink, pale, line, font } = theme();
    const axis = {
      gridcolor: line, linecolor: pale, zeroline: false, showline: true, ticks: 'outside', tickcolor: pale,
      ticklen: 4, automargin: true, exponentformat: 'power',
    };
    return {
      margin: { l: 56, r: 12, t: 28, b: 44 },
      paper_bgcolor: 'rgba(0,0,0,0)', plot_bgcolor: 'rgba(0,0,0,0)',
      font: { color: ink, family: font, size: 12 },
      hoverlabel: { bgcolor: page, bordercolor: pale, font: { color: ink, family: font }, align: 'left' },
      modebar: { bgcolor: 'rgba(0,0,0,0)', color: pale, activecolor: ink },
      hovermode: 'closest', dragmode: canHover.matches ? 'zoom' : false,
      legend: { orientation: 'h', x: 0, yref: 'container', y: 0, yanchor: 'bottom', bgcolor: 'rgba(0,0,0,0)', traceorder: 'reversed' },
      xaxis: { ...axis, ...xaxis }, yaxis: { ...axis, ...yaxis },
      ...more,
    };
  }

  const heading = (text) => ({ text: plain(text), font: { size: 14 }, x: 0, xref: 'paper', xanchor: 'left', y: 0.99, yanchor: 'top' });

  async function draw(element) {
    const make = kinds.get(element.dataset.plot);
    element.dataset.state = 'drawing';
    const { data, layout: described } = make(element);
    const config = {
      displaylogo: false, responsive: false, displayModeBar: canHover.matches ? 'hover' : false, typesetMath: false,
      modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d'], scrollZoom: false,
      toImageButtonOptions: { filename: element.id || element.dataset.plot },
    };
    await Plotly.react(element, data, described, config);
    if (!drawn.has(element)) {
      drawn.add(element);
      resizing.observe(element);
      element.on('plotly_relayout', () => refineTicks(element));
      element.dispatchEvent(new CustomEvent('plotted'));
    }
    element.dataset.state = 'ready';
  }

  // The described ticks suit the described range. A reader who zooms in until fewer than two are left gets plotly's.
  function refineTicks(element) {
    const changes = {};
    for (const name of ['xaxis', 'yaxis']) {
      const { type, range, tickvals, tickmode } = element._fullLayout[name];
      if (!element.layout[name]?.tickvals) continue;
      const [low, high] = [Math.min(...range), Math.max(...range)];
      const place = (value) => (type === 'log' ? Math.log10(value) : value);
      const ticks = element.layout[name].tickvals.map(place).filter((at) => at >= low && at <= high);
      const wanted = ticks.length < 2 ? 'auto' : 'array';
      if (wanted !== (tickmode ?? (tickvals ? 'array' : 'auto'))) changes[`${name}.tickmode`] = wanted;
    }
    if (Object.keys(changes).length > 0) Plotly.relayout(element, changes);
  }

  const resizing = new ResizeObserver((entries) => {
    for (const { target } of entries) if (target.clientWidth > 0) Plotly.Plots.resize(target);
  });

  // Calls `act` once, when the element comes near the window.
  function whenNear(element, act) {
    const observer = new IntersectionObserver((entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      observer.disconnect();
      act(element);
    }, { rootMargin: NEAR });
    observer.observe(element);
  }

  function start() {
    for (const element of document.querySelectorAll('[data-plot]')) {
      element.dataset.state = 'waiting';
      whenNear(element, draw);
    }
    for (const toggle of document.querySelectorAll('.chart > .toggle')) {
      toggle.addEventListener('click', () => {
        const isStatic = toggle.parentElement.classList.toggle('shows-static');
        toggle.setAttribute('aria-pressed', isStatic);
      });
    }
  }

  const redraw = (element) => (drawn.has(element) ? draw(element) : undefined);
  darkScheme.addEventListener('change', () => drawn.forEach(redraw));

  return {
    colorOf, island, layout, heading, whenNear, redraw, start,
    // Registers what draws plots of a kind: a function from the element to { data, layout }.
    kind: (name, make) => kinds.set(name, make),
  };
})();
