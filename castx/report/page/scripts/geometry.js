// Surfaces, edges and plane cuts of a body. Everything that is drawn is a list of vertices, each of which lies on an
// edge between the nodes a and b of the mesh at the share t of its way (a node: a = b): so one list serves all moments
// and fields, displaced or not. Triangles have three vertices and remember their cell, segments have two. Where metal
// has sunk, the places at which its surface passes edges count as nodes.
"use strict";

castx.geometry = (() => {
  const FACES = {
    triangle: [], quad: [],
    tetra: [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    hexahedron: [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
  };
  const TETRAHEDRA = {
    tetra: [[0, 1, 2, 3]],
    hexahedron: [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]],
  };
  const CORNERS = { triangle: 3, quad: 4, tetra: 4, hexahedron: 8 };
  const SHARP = Math.cos((40 * Math.PI) / 180);

  class Vertices {
    constructor() { this.a = []; this.b = []; this.t = []; this.cell = []; }
    add(vertex, cell) {
      this.a.push(vertex[0]); this.b.push(vertex[1]); this.t.push(vertex[2]); this.cell.push(cell);
    }
    get length() { return this.a.length; }
  }

  const node = (i) => [i, i, 0];

  // The nodes of a mesh, and behind them points on edges between earlier ones.
  class Nodes {
    constructor(count) { this.count = count; this.added = new Vertices(); }

    // The number of a vertex as a node; carried: lists of a value for each node, which get that of a new one.
    number(vertex, ...carried) {
      const [i, j, t] = vertex;
      if (t === 0) return i;
      for (const values of carried) values.push(values[i] + t * (values[j] - values[i]));
      this.added.add(vertex, 0);
      return this.count + this.added.length - 1;
    }

    // Values of the nodes of the mesh, width each, with those of the points on edges.
    values(known, width) {
      const { a, b, t, length } = this.added;
      if (length === 0) return known;
      const found = new known.constructor(known.length + width * length);
      found.set(known);
      for (let i = 0, at = known.length; i < length; i++) {
        for (let k = 0; k < width; k++, at++) {
          const first = found[width * a[i] + k];
          found[at] = t[i] === 0 ? first : first + t[i] * (found[width * b[i] + k] - first);
        }
      }
      return found;
    }
  }

  // Polygons of the surface in space, of all cells in the plane: [nodes, cell].
  const polygons = (body) => {
    const corners = CORNERS[body.kind], faces = FACES[body.kind], cells = body.cells;
    const count = cells.length / corners, found = [];
    if (faces.length === 0) {
      for (let c = 0; c < count; c++) found.push([Array.from(cells.slice(c * corners, (c + 1) * corners)), c]);
      return found;
    }
    const nodes = body.points.length / 3, once = new Map();
    for (let c = 0; c < count; c++) {
      for (const face of faces) {
        const own = face.map((i) => cells[c * corners + i]);
        const sorted = [...own].sort((x, y) => x - y); // three of them are the key
        const key = (sorted[0] * nodes + sorted[1]) * nodes + sorted[2];
        if (once.has(key)) once.delete(key); else once.set(key, [own, c]);
      }
    }
    return [...once.values()];
  };

  const subtract = (p, i, j) => [p[3 * i] - p[3 * j], p[3 * i + 1] - p[3 * j + 1], p[3 * i + 2] - p[3 * j + 2]];
  const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];

  const normal = (points, face) => {
    const n = cross(subtract(points, face[1], face[0]), subtract(points, face[2], face[0]));
    const length = Math.hypot(...n) || 1;
    return n.map((x) => x / length);
  };

  // Edges that bound polygons, or at which they meet at more than 40 degrees: [node, node].
  const edges = (body, found) => {
    const nodes = body.points.length / 3, sides = new Map();
    for (const [face] of found) {
      const n = normal(body.points, face);
      face.forEach((first, i) => {
        const second = face[(i + 1) % face.length];
        const key = Math.min(first, second) * nodes + Math.max(first, second);
        const side = sides.get(key);
        if (side === undefined) sides.set(key, { ends: [first, second], n, sharp: true });
        else side.sharp = dot(side.n, n) < SHARP;
      });
    }
    return [...sides.values()].filter((side) => side.sharp).map((side) => side.ends);
  };

  // Shape of a body that does not depend on cuts.
  const shape = (body) => {
    const found = polygons(body);
    return { polygons: found, edges: edges(body, found), flat: FACES[body.kind].length === 0 };
  };

  const between = (i, j, distance) => [i, j, distance[i] / (distance[i] - distance[j])];

  // The part of a polygon of nodes at distances <= 0, and the points where its edges pass the plane.
  const clipped = (face, distance) => {
    const kept = [], passed = [];
    face.forEach((first, k) => {
      const second = face[(k + 1) % face.length];
      const inside = distance[first] <= 0;
      if (inside) kept.push(node(first));
      if (inside !== distance[second] <= 0) {
        const at = between(first, second, distance);
        kept.push(at);
        passed.push(at);
      }
    });
    return { kept, passed };
  };

  const fan = (triangles, polygon, cell) => {
    for (let k = 2; k < polygon.length; k++) {
      for (const vertex of [polygon[0], polygon[k - 1], polygon[k]]) triangles.add(vertex, cell);
    }
  };

  // The section of a tetrahedron: three or four points on its edges, in order.
  const section = (corners, distance) => {
    const low = corners.filter((i) => distance[i] <= 0), high = corners.filter((i) => distance[i] > 0);
    if (low.length === 0 || high.length === 0) return [];
    const at = (i, j) => between(i, j, distance);
    if (low.length === 2) {
      const [p, q] = low, [r, s] = high;
      return [at(p, r), at(p, s), at(q, s), at(q, r)];
    }
    const [one] = low.length === 1 ? low : high, three = low.length === 1 ? high : low;
    return three.map((other) => at(one, other));
  };

  // The cells whose sections have faces, and the number of the first of them.
  const inside = (body) => {
    if (body.inner) return { cells: body.inner, kind: "tetra", first: body.cells.length / CORNERS[body.kind] };
    return body.shape.flat ? null : { cells: body.cells, kind: body.kind, first: 0 };
  };

  // Call use(polygon of vertices, cell) for the sections of all cells where distances change their sign.
  const sections = ({ cells, kind, first }, distance, use) => {
    const corners = CORNERS[kind];
    for (let c = first, at = 0; at < cells.length; c++, at += corners) {
      let low = false, high = false;
      for (let k = at; k < at + corners; k++) if (distance[cells[k]] <= 0) low = true; else high = true;
      if (!low || !high) continue;
      for (const piece of TETRAHEDRA[kind]) {
        const found = section(piece.map((k) => cells[at + k]), distance);
        if (found.length > 0) use(found, c);
      }
    }
  };

  // What is left of lines between two nodes at distances <= 0, as vertices.
  const shortened = ([i, j], distance) => {
    const kept = [i, j].filter((n) => distance[n] <= 0).map(node);
    if (kept.length === 1) kept.push(between(i, j, distance));
    return kept.length === 2 ? kept : null;
  };

  // Surface and lines of a body whose metal has sunk to where its values are at most a level, with the wall of the pipe.
  const sunken = (body, nodes, depth) => {
    const faces = [], lines = [], number = (vertex) => nodes.number(vertex, depth);
    for (const [face, cell] of body.shape.polygons) {
      const { kept, passed } = clipped(face, depth);
      if (kept.length > 2) faces.push([kept.map(number), cell]);
      if (passed.length === 2) lines.push(passed.map(number));
    }
    for (const line of body.shape.edges) {
      const kept = shortened(line, depth);
      if (kept !== null) lines.push(kept.map(number));
    }
    const within = inside(body);
    if (within !== null) sections(within, depth, (wall, cell) => faces.push([wall.map(number), cell]));
    return { faces, lines };
  };

  // Distances of nodes from a plane.
  const distances = (points, { normal: [x, y, z], offset }) => {
    const found = new Float64Array(points.length / 3);
    for (let i = 0; i < found.length; i++) {
      found[i] = x * points[3 * i] + y * points[3 * i + 1] + z * points[3 * i + 2] - offset;
    }
    return found;
  };

  // Triangles and segments of a body, behind a plane if there is one: {normal, offset}, normal·x <= offset is kept; and
  // where metal has sunk without what has flowed out: {values of nodes, level}, values <= level are kept. The vertices
  // lie between `nodes`.
  const drawn = (body, plane, sunk = null) => {
    const triangles = new Vertices(), segments = new Vertices(), nodes = new Nodes(body.points.length / 3);
    const depth = sunk === null ? null : Array.from(sunk.values, (value) => value - sunk.level);
    const { faces, lines } = sunk === null ? { faces: body.shape.polygons, lines: body.shape.edges }
      : sunken(body, nodes, depth);
    if (plane === null) {
      for (const [face, cell] of faces) fan(triangles, face.map(node), cell);
      for (const [i, j] of lines) { segments.add(node(i), 0); segments.add(node(j), 0); }
      return { triangles, segments, nodes };
    }
    const distance = distances(nodes.values(body.points, 3), plane);
    for (const [face, cell] of faces) {
      const { kept, passed } = clipped(face, distance);
      fan(triangles, kept, cell);
      if (passed.length === 2) for (const vertex of passed) segments.add(vertex, cell);
    }
    for (const line of lines) for (const vertex of shortened(line, distance) ?? []) segments.add(vertex, 0);
    if (!body.inner && !body.shape.flat) {
      sections(inside(body), distance, (polygon, cell) => {
        const seen = depth === null ? polygon : clipped(polygon.map((vertex) => nodes.number(vertex, depth)), depth).kept;
        fan(triangles, seen, cell);
      });
    }
    return { triangles, segments, nodes };
  };

  return { shape, drawn, cross, dot };
})();
