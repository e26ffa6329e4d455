// The charts of the page. Each takes its numbers from the island that its element names.
'use strict';

(() => {
  const { color, symbol, island, layout, heading } = plots;
  const { plain, VIRIDIS } = canonform;

  const panelOf = (element, list) => list[Number(element.dataset.panel)];
  const distinct = (list) => [...new Set(list)];
  const axisName = ({ name, unit }) => plain(unit ? `${name} (${unit})` : name);
  const translucent = (hex, alpha) =>
    `rgba(${[1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)).join(',')},${alpha})`;

  // Medians with the range of the runs around them.
  plots.kind('curves', (element) => {
    const { panels } = island(element.dataset.source);
    const panel = panelOf(element, panels);
    // A method looks alike in all panels.
    const names = distinct(panels.flatMap(({ series }) => series.map(({ name }) => name)));
    const data = panel.series.flatMap(({ name, points }) => {
      const at = names.indexOf(name);
      const x = points.map((point) => point.x);
      const band = { x, mode: 'lines', line: { width: 0 }, hoverinfo: 'skip', showlegend: false, legendgroup: name };
      return [
        { ...band, y: points.map(({ low }) => low) },
        { ...band, y: points.map(({ high }) => high), fill: 'tonexty', fillcolor: translucent(color(at), 0.18) },
        {
          x, y: points.map(({ median }) => median), name: plain(name), legendgroup: name, mode: 'lines+markers',
          line: { color: color(at), width: 2 }, marker: { color: color(at), symbol: symbol(at), size: 6 },
          customdata: points.map(({ low, high, runs }) => [low, high, runs]),
          hovertemplate: `<b>${plain(name)}</b><br>${plain(panel.x.name)}: %{x:.4~g}<br>median %{y:.4~g}` +
            '<br>%{customdata[0]:.4~g} to %{customdata[1]:.4~g} in %{customdata[2]} runs<extra></extra>',
        },
      ];
    });
    const ink = canonform.theme().pale;
    const onAxis = (x) => (panel.x.scale === 'log' ? Math.log10(x) : x);
    return {
      data,
      layout: layout({
        title: heading(panel.title),
        xaxis: { title: { text: axisName(panel.x) }, type: panel.x.scale },
        yaxis: { title: { text: axisName(panel.y) }, type: panel.y.scale },
        shapes: panel.marks.map(({ x }) => ({
          type: 'line', x0: x, x1: x, yref: 'paper', y0: 0, y1: 1, line: { color: ink, width: 1, dash: 'dot' },
        })),
        annotations: panel.marks.map(({ x, name }, i) => ({
          x: onAxis(x), yref: 'paper', y: 1 - 0.08 * i, text: plain(name), showarrow: false, xanchor: 'left', yanchor: 'top',
          font: { size: 11, color: ink },
        })),
      }),
    };
  });

  // Marks side by side over categories: one series each, with ranges, and hollow ones for the paper's numbers.
  function marks(series, categories, title, unit, paperName = (name) => `${name}, paper`) {
    const data = series.flatMap(({ name, points, paper }, i) => {
      const base = { name: plain(name), mode: 'markers', offsetgroup: String(i), legendgroup: String(i) };
      const values = points.map(({ y }) => y);
      const list = [{
        ...base, x: points.map(({ x }) => plain(x)), y: values,
        marker: { color: color(i), symbol: symbol(i), size: 9 },
        error_y: {
          type: 'data', symmetric: false, thickness: 1.5, width: 3, color: color(i),
          array: points.map(({ y, high }) => (high ?? y) - y), arrayminus: points.map(({ y, low }) => y - (low ?? y)),
        },
        customdata: points.map(({ note }) => plain(note)),
        hovertemplate: `<b>${plain(name)}</b>, %{x}<br>%{y:.4~g} ${plain(unit)}<br>%{customdata}<extra></extra>`,
      }];
      if (paper?.length > 0) {
        list.push({
          ...base, name: plain(paperName(name)), x: paper.map(({ x }) => plain(x)), y: paper.map(({ y }) => y),
          marker: { color: color(i), symbol: `${symbol(i)}-open`, size: 11, line: { width: 2 } },
          hovertemplate: `<b>${plain(paperName(name))}</b>, %{x}<br>%{y:.4~g} ${plain(unit)}<extra></extra>`,
        });
      }
      return list;
    });
    return {
      data,
      layout: layout({
        title: heading(title), scattermode: 'group', scattergap: 0.3,
        xaxis: { type: 'category', categoryorder: 'array', categoryarray: categories.map(plain) },
        yaxis: { type: 'log', title: { text: plain(unit) } },
      }),
    };
  }

  // Stress of the methods on one shape, for each way of measuring distances.
  plots.kind('stress', (element) => {
    const { stresses } = island(element.dataset.source);
    const shape = panelOf(element, distinct(stresses.map((s) => s.shape)));
    const own = stresses.filter((s) => s.shape === shape);
    const series = distinct(own.map(({ distances }) => distances)).map((distances, i) => {
      const rows = own.filter((s) => s.distances === distances);
      return {
        name: `${distances} distances`,
        points: rows.map(({ method, median, low, high, runs }) => ({
          x: method, y: median, low, high, note: `${low.toPrecision(4)} to ${high.toPrecision(4)} in ${runs} runs`,
        })),
        // The paper has one number for all of them: it is drawn once.
        paper: i > 0 ? [] : rows.filter(({ paper }) => paper !== null).map(({ method, paper }) => ({ x: method, y: paper })),
      };
    });
    return marks(series, distinct(own.map(({ method }) => method)), shape, 'stress (squared mesh units)', () => 'the paper');
  });

  // Times of whole embeddings.
  plots.kind('times', (element) => {
    const { rows } = island(element.dataset.source);
    const place = ({ shape, n_vertices: n }) => `${shape}, ${n.toLocaleString('en')} vertices`;
    const series = distinct(rows.map(({ method }) => method)).map((method) => {
      const own = rows.filter((row) => row.method === method);
      return {
        name: method,
        points: own.filter(({ measured }) => measured).map((row) => ({
          x: place(row), y: row.measured.geodesics + row.measured.embedding,
          note: `${row.measured.geodesics.toPrecision(3)} s distances, ${row.measured.embedding.toPrecision(3)} s algebra, ` +
            `${(row.measured.peak_bytes / 2 ** 20).toPrecision(3)} MiB`,
        })),
        paper: own.filter((row) => row.paper_seconds !== null).map((row) => ({ x: place(row), y: row.paper_seconds })),
      };
    });
    return marks(series.filter(({ points, paper }) => points.length + paper.length > 0), distinct(rows.map(place)),
      'Seconds from the repaired mesh to coordinates', 'seconds');
  });

  // Precision over recall of every way to compare, at one scale.
  plots.kind('precision', (element) => {
    const { rows } = island(element.dataset.source);
    const scale = panelOf(element, distinct(rows.map((row) => row.scale)));
    const names = distinct(rows.map(({ method }) => method));
    const data = rows.filter((row) => row.scale === scale).map(({ method, precision, map }) => {
      const at = names.indexOf(method);
      return {
        x: precision.map((_, i) => i / Math.max(precision.length - 1, 1)), y: precision, name: plain(method),
        mode: 'lines+markers', line: { color: color(at), width: 2, dash: at < 8 ? 'solid' : 'dash' },
        marker: { color: color(at), symbol: symbol(at), size: 5 },
        hovertemplate: `<b>${plain(method)}</b><br>recall %{x:.2f}, precision %{y:.3f}<br>mAP ${map.toFixed(3)}<extra></extra>`,
      };
    });
    const lowest = Math.min(...data.flatMap(({ y }) => y));
    return {
      data,
      layout: layout({
        title: heading(scale === 'raw' ? 'Size counts' : 'Size ignored'),
        xaxis: { title: { text: 'recall' }, range: [-0.02, 1.02] },
        yaxis: { title: { text: 'precision' }, range: [Math.min(lowest - 0.05, 0.8), 1.03] },
      }),
    };
  });

  // True classes down, predicted classes across, counts in the cells.
  plots.kind('confusion', (element) => {
    const { classes, confusion } = island(element.dataset.source).classification;
    const across = [...classes, 'unknown'];
    const shares = confusion.map((row) => {
      const all = row.reduce((sum, count) => sum + count, 0);
      return row.map((count) => (all > 0 ? count / all : 0));
    });
    const { pale } = canonform.theme();
    return {
      data: [{
        type: 'heatmap', z: shares, x: across.map((_, i) => i), y: classes.map((_, i) => i), zmin: 0, zmax: 1,
        colorscale: VIRIDIS, xgap: 1, ygap: 1, text: confusion, texttemplate: '%{text}',
        customdata: classes.map((own) => across.map((other) => `${plain(own)} taken for ${plain(other)}`)),
        hovertemplate: '%{customdata}<br>%{text} shapes, %{z:.0%} of the class<extra></extra>',
        colorbar: { title: { text: 'share of the class', side: 'right' }, tickformat: '.0%', thickness: 12, outlinewidth: 0, tickcolor: pale },
      }],
      layout: layout({
        title: heading('What shapes are taken for'),
        xaxis: { title: { text: 'predicted class' }, tickvals: across.map((_, i) => i), ticktext: across.map(plain), showgrid: false },
        yaxis: { title: { text: 'true class' }, tickvals: classes.map((_, i) => i), ticktext: classes.map(plain), showgrid: false, autorange: 'reversed' },
      }),
    };
  });
})();
