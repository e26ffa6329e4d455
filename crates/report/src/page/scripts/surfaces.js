// The shapes of Figure 4 and their canonical forms for 3D views. Defines `surfaces`.
'use strict';

const surfaces = (() => {
  const { decode } = canonform;
  const { island } = plots;

  const figure = () => island('figure4-data');
  const shapeOf = (i) => island(`figure4-shape-${i}`);
  const rank = (method) => Math.max(figure().methods.indexOf(method), 0);

  function clay(i) {
    const { labels, clay: colors } = figure();
    return colors[[...new Set(labels)].indexOf(labels[i])];
  }

  // The colours of a shape and its form.
  function painted(i, method, color) {
    const { surface, forms } = shapeOf(i);
    const { residual } = forms[rank(method)];
    if (color === 'distance') return { values: surface.values, values_name: surface.values_name };
    if (color === 'residual' && residual) return { values: residual, values_name: 'residual (mesh units)' };
    return { color: clay(i) };
  }

  // A shape and its form in the same colours.
  function pair(i, method, color) {
    const { surface: { positions, faces }, forms } = shapeOf(i);
    const paint = painted(i, method, color);
    return [{ positions, faces, ...paint }, { positions: forms[rank(method)].positions, faces, ...paint }];
  }

  // Positions of the form of shape `i` at a scale, moved onto the form of shape `j`.
  function formAt(i, j, { method, scale }) {
    const { positions, size } = shapeOf(i).forms[rank(method)];
    const by = scale === 'raw' ? 1 : 1 / size;
    const from = decode(positions, Float32Array);
    const to = new Float32Array(from.length);
    const move = motion(i, j, { method, scale });
    for (let v = 0; v < from.length; v += 3) {
      [to[v], to[v + 1], to[v + 2]] = move(from[v] * by, from[v + 1] * by, from[v + 2] * by);
    }
    return to;
  }

  // The record has motions from the earlier shape onto the later one; the others are their inverses.
  function motion(i, j, { method, scale }) {
    if (i === j) return (x, y, z) => [x, y, z];
    const { names: { length: n }, motions } = figure();
    const [a, b] = [Math.min(i, j), Math.max(i, j)];
    const all = decode(motions.find((m) => m.method === method && m.scale === scale).motions, Float32Array);
    const r = all.subarray(12 * (a * n - (a * (a + 1)) / 2 + b - a - 1));
    if (i < j) {
      return (x, y, z) => [0, 3, 6].map((row, c) => r[row] * x + r[row + 1] * y + r[row + 2] * z + r[9 + c]);
    }
    return (x, y, z) => {
      const [p, q, s] = [x - r[9], y - r[10], z - r[11]];
      return [0, 1, 2].map((column) => r[column] * p + r[3 + column] * q + r[6 + column] * s);
    };
  }

  // The distance from every point to the nearest of `others`, which are searched outwards from the same x until the
  // difference in x alone is larger.
  function nearest(points, others) {
    const order = Array.from({ length: others.length / 3 }, (_, v) => 3 * v).sort((a, b) => others[a] - others[b]);
    const along = Float32Array.from(order, (v) => others[v]);
    const found = new Float32Array(points.length / 3);
    for (let v = 0; v < found.length; v += 1) {
      const [x, y, z] = points.subarray(3 * v, 3 * v + 3);
      let [low, high] = [0, along.length];
      while (low < high) {
        const middle = (low + high) >> 1;
        if (along[middle] < x) low = middle + 1; else high = middle;
      }
      let best = Infinity;
      const look = (at) => {
        const dx = along[at] - x;
        if (dx * dx >= best) return false;
        const o = order[at];
        best = Math.min(best, dx * dx + (others[o + 1] - y) ** 2 + (others[o + 2] - z) ** 2);
        return true;
      };
      for (let at = low; at < along.length && look(at); at += 1);
      for (let at = low - 1; at >= 0 && look(at); at -= 1);
      found[v] = Math.sqrt(best);
    }
    return found;
  }

  // The form of shape `i` aligned with that of shape `j`, coloured by its distance from it.
  function overlay(i, j, panel) {
    const [own, other] = [formAt(i, j, panel), formAt(j, j, panel)];
    return [
      { positions: own, faces: shapeOf(i).surface.faces, values: nearest(own, other), values_name: `distance to form 2 (${panel.unit})` },
      { positions: other, faces: shapeOf(j).surface.faces, color: clay(j) },
    ];
  }

  const shown = (i) => decode(shapeOf(i).surface.positions, Float32Array).length / 3;

  return {
    pair, overlay,
    hasResidual: (i, method) => Boolean(shapeOf(i).forms[rank(method)].residual),
    // The numbers of vertices shown and computed.
    vertices: (i) => [shown(i), shapeOf(i).n_vertices],
  };
})();
