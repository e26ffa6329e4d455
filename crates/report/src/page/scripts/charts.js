// From the description of a plot or matrix, which the static figures share, to plotly's data and layout. Defines `charts`.
'use strict';

const charts = (() => {
  const { colorOf, island, layout, heading } = plots;
  const { plain, theme, VIRIDIS, decode } = canonform;

  const translucent = (hex, alpha) =>
    `rgba(${[1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)).join(',')},${alpha})`;

  const axis = ({ name, scale, range, ticks }) => ({
    title: { text: plain(name) }, type: scale === 'log' ? 'log' : 'linear', range,
    tickmode: 'array', tickvals: ticks.map(([value]) => value), ticktext: ticks.map(([, label]) => plain(label)),
    ...(scale === 'category' && { showgrid: false }),
  });

  // An axis of a map. Its range grows with the window, so its ticks continue beyond those of the static figure.
  const mapAxis = (described) => {
    const { tickvals: [first, second], ticktext, ...rest } = axis(described);
    return second === undefined ? rest : { ...rest, tickmode: 'linear', tick0: first, dtick: second - first };
  };

  const digits = (value) => Number(value.toPrecision(4)).toString();

  // What a point says: its name, its place, its value with its range, its note.
  function hover({ x, y }, name, point) {
    const place = x.scale === 'category' ? x.ticks[Math.round(point.x)][1] : `${x.name}: ${digits(point.x)}`;
    const lines = [place, `${y.name}: ${digits(point.y)}`];
    if (point.low < point.high) lines.push(`${digits(point.low)} to ${digits(point.high)}`);
    if (point.note) lines.push(point.note);
    return `<b>${plain(name)}</b><br>${lines.map(plain).join('<br>')}<extra></extra>`;
  }

  function traces(panel, { name, style, shape, points }) {
    const color = colorOf(style);
    const column = (key) => points.map((point) => point[key]);
    const base = { x: column('x'), name: plain(name), legendgroup: name };
    const trace = { ...base, y: column('y'), hovertemplate: points.map((point) => hover(panel, name, point)) };
    if (shape === 'curve') {
      const band = { ...base, mode: 'lines', line: { width: 0 }, hoverinfo: 'skip', showlegend: false };
      return [
        { ...band, y: column('low') },
        { ...band, y: column('high'), fill: 'tonexty', fillcolor: translucent(color, 0.16) },
        { ...trace, mode: 'lines+markers', line: { color, width: 2 }, marker: { color, symbol: style.symbol, size: 6 } },
      ];
    }
    const hollow = shape === 'hollow';
    const ranges = points.some(({ low, high }) => low < high);
    return [{
      ...trace, mode: 'markers', legendgroup: `${name} ${shape}`,
      marker: {
        color, symbol: hollow ? `${style.symbol}-open` : style.symbol, size: hollow ? 11 : 9,
        line: { width: hollow ? 2 : 0.5, color: hollow ? color : theme().page },
      },
      ...(ranges && {
        error_y: {
          type: 'data', symmetric: false, thickness: 1.5, width: 3, color,
          array: points.map(({ y, high }) => high - y), arrayminus: points.map(({ y, low }) => y - low),
        },
      }),
    }];
  }

  // The first series covers the others.
  function plot(panel) {
    const { pale } = theme();
    const at = (x) => (panel.x.scale === 'log' ? Math.log10(x) : x);
    const isRight = (x) => at(x) > (panel.x.range[0] + panel.x.range[1]) / 2;
    const [xaxis, yaxis] = [panel.x, panel.y].map(panel.is_map ? mapAxis : axis);
    return {
      data: [...panel.series].reverse().flatMap((series) => traces(panel, series)),
      layout: layout({
        title: heading(panel.title),
        xaxis,
        yaxis: panel.is_map ? { ...yaxis, scaleanchor: 'x' } : yaxis,
        shapes: panel.marks.map(({ x }) => ({
          type: 'line', x0: x, x1: x, yref: 'paper', y0: 0, y1: 1, line: { color: pale, width: 1, dash: 'dot' },
        })),
        annotations: panel.marks.map(({ x, name }, i) => ({
          x: at(x), yref: 'paper', y: 1 - 0.08 * i, text: plain(name), showarrow: false, yanchor: 'top',
          xanchor: isRight(x) ? 'right' : 'left', font: { size: 11, color: pale },
        })),
      }),
    };
  }

  // The values of a matrix as rows.
  function rows({ values, columns }) {
    const flat = decode(values, Float32Array);
    return Array.from({ length: flat.length / columns.length }, (_, i) =>
      flat.subarray(i * columns.length, (i + 1) * columns.length));
  }

  function heat(panel) {
    const { page, line: gridcolor } = theme();
    const { tint, bar, borders, counts, hover: text } = panel;
    const [x, y] = [axis(panel.x), axis(panel.y)].map((one) => ({ ...one, showgrid: false, ticks: '', showline: false }));
    const formats = { value: '%{z:.4~g}', percent: '%{z:.0%}', count: '%{text}', row: '%{customdata[0]}', column: '%{customdata[1]}' };
    // Lines between groups, or between all cells with counts.
    const [width, height] = [panel.columns.length, panel.rows.length];
    const line = (x0, y0, x1, y1) => ({ type: 'line', x0, y0, x1, y1, line: { color: counts ? gridcolor : page, width: 1 } });
    const edges = (n) => (counts ? Array.from({ length: n + 1 }, (_, i) => i) : borders).map((at) => at - 0.5);
    return {
      data: [{
        type: 'heatmap', z: rows(panel), zmin: 0, zmax: panel.max || 1,
        colorscale: tint ? [[0, page], [1, `rgb(${tint})`]] : VIRIDIS,
        customdata: panel.rows.map((row) => panel.columns.map((column) => [plain(row), plain(column)])),
        hovertemplate: `${text.replaceAll('\n', '<br>').replace(/\{(\w+)\}/g, (_, name) => formats[name])}<extra></extra>`,
        showscale: bar !== null,
        ...(bar && {
          colorbar: {
            title: { text: plain(bar.name), side: 'right' }, thickness: 12, outlinewidth: 0,
            tickvals: bar.ticks.map(([value]) => value), ticktext: bar.ticks.map(([, label]) => plain(label)),
          },
        }),
        ...(counts && { text: counts.map((row) => row.map((count) => count || '')), texttemplate: '%{text}' }),
      }],
      layout: layout({
        title: heading(panel.title || panel.label),
        xaxis: { ...x, constrain: 'domain' },
        yaxis: { ...y, scaleanchor: 'x', constrain: 'domain' },
        shapes: [
          ...edges(width).map((at) => line(at, -0.5, at, height - 0.5)),
          ...edges(height).map((at) => line(-0.5, at, width - 0.5, at)),
        ],
      }),
    };
  }

  const panel = (element, list) => list[Number(element.dataset.panel)];
  plots.kind('plot', (element) => plot(panel(element, island(element.dataset.source).plots)));
  plots.kind('heat', (element) => heat(panel(element, island(element.dataset.source).heats)));

  return { plot, heat, rows };
})();
