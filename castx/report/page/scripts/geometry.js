// Surfaces, edges and plane cuts of a body. Everything that is drawn is a list of vertices, each of which lies on an
// edge between the nodes a and b of the mesh at the share t of its way (a node: a = b): so one list serves all moments
// and fields, displaced or not. Triangles have three vertices and remember their cell, segments have two.
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

  // Triangles and segments of a body, behind a plane if there is one: {normal, offset}, normal·x <= offset is kept.
  const drawn = (body, plane) => {
    const triangles = new Vertices(), segments = new Vertices();
    const { polygons: faces, edges: lines, flat } = body.shape;
    if (plane === null) {
      for (const [face, cell] of faces) fan(triangles, face.map(node), cell);
      for (const [i, j] of lines) { segments.add(node(i), 0); segments.add(node(j), 0); }
      return { triangles, segments };
    }
    const points = body.points, distance = new Float64Array(points.length / 3);
    const [x, y, z] = plane.normal;
    for (let i = 0; i < distance.length; i++) {
      distance[i] = x * points[3 * i] + y * points[3 * i + 1] + z * points[3 * i + 2] - plane.offset;
    }
    for (const [face, cell] of faces) {
      const { kept, passed } = clipped(face, distance);
      fan(triangles, kept, cell);
      if (passed.length === 2) for (const vertex of passed) segments.add(vertex, cell);
    }
    for (const [i, j] of lines) {
      const inside = [i, j].filter((n) => distance[n] <= 0).map(node);
      if (inside.length === 1) inside.push(between(i, j, distance));
      if (inside.length === 2) for (const vertex of inside) segments.add(vertex, 0);
    }
    if (!flat) addSections(triangles, body, distance);
    return { triangles, segments };
  };

  const addSections = (triangles, body, distance) => {
    const corners = CORNERS[body.kind], pieces = TETRAHEDRA[body.kind], cells = body.cells;
    for (let c = 0, first = 0; first < cells.length; c++, first += corners) {
      let low = false, high = false;
      for (let k = first; k < first + corners; k++) {
        if (distance[cells[k]] <= 0) low = true; else high = true;
      }
      if (!low || !high) continue;
      for (const piece of pieces) fan(triangles, section(piece.map((k) => cells[first + k]), distance), c);
    }
  };

  return { shape, drawn, cross, dot };
})();
