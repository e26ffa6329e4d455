// Plots of the page: drawn when they come near the window, drawn again when the scheme of colours changes.
//
// For those who drive the page:
//   html.js                      scripts run
//   [data-plot=KIND]             a plot; data-state is `waiting`, `drawing` or `ready`; data-source names its island
//   script[type="application/json"][id=NAME-data]      the numbers of an experiment
//   .chart > .toggle             the button that shows the static figure instead
//   #NAME                        the section of an experiment (figure1, ..., retrieval)
// Figure 1 is described in gallery.js, Figure 4 in explorer.js.
'use strict';

const plots = (() => {
  // Okabe and Ito: told apart with every common colour blindness. In the dark the darkest turns pale.
  const COLORS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#3c3c3c', '#f0e442'];
  // In the order of the static figures.
  const SYMBOLS = ['circle', 'triangle-up', 'square', 'diamond', 'cross', 'triangle-down', 'star', 'hexagon', 'x', 'triangle-left',
    'pentagon', 'triangle-right'];
  const NEAR = '400px';

  const { plain, theme } = canonform;
  const darkScheme = matchMedia('(prefers-color-scheme: dark)');
  const canHover = matchMedia('(hover: hover)');
  const kinds = new Map();
  const drawn = new Set();
  const islands = new Map();

  const color = (i) => {
    const found = COLORS[i % COLORS.length];
    return darkScheme.matches && found === '#3c3c3c' ? '#c9ccd1' : found;
  };
  const symbol = (i) => SYMBOLS[i % SYMBOLS.length];

  // The data of an island, parsed when first asked for.
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
      colorway: COLORS.map((_, i) => color(i)),
      hoverlabel: { bgcolor: page, bordercolor: pale, font: { color: ink, family: font }, align: 'left' },
      modebar: { bgcolor: 'rgba(0,0,0,0)', color: pale, activecolor: ink },
      hovermode: 'closest', dragmode: canHover.matches ? 'zoom' : false,
      legend: { orientation: 'h', x: 0, yref: 'container', y: 0, yanchor: 'bottom', bgcolor: 'rgba(0,0,0,0)' },
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
      element.dispatchEvent(new CustomEvent('plotted'));
    }
    element.dataset.state = 'ready';
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
    color, symbol, island, layout, heading, whenNear, redraw, start,
    // Registers what draws plots of a kind: a function from the element to { data, layout }.
    kind: (name, make) => kinds.set(name, make),
  };
})();
