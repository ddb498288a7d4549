// The eye of a view: parallel projection, turned about the upright axis (z in space, y in the plane).
"use strict";

castx.Camera = class {
  constructor(low, high, space, direction) {
    this.low = low;
    this.high = high;
    this.space = space;
    this.start = direction;
    this.reset();
  }

  reset() {
    this.centre = this.high.map((x, i) => 0.5 * (x + this.low[i]));
    this.size = Math.hypot(...this.high.map((x, i) => x - this.low[i])) || 1;
    this.zoom = 1;
    this.shift = [0, 0];
    this.show(this.start, this.whole ?? this.space);
  }

  // Look from a direction; whole: let all be seen from anywhere, else from the front.
  show(direction, whole) {
    const [width, height] = this.high.map((x, i) => x - this.low[i] || 1);
    this.fit = whole ? [this.size, this.size] : [width, height];
    this.start = direction;
    this.whole = whole;
    this.look(direction);
  }

  look(direction) {
    const [x, y, z] = this.space ? direction : [direction[2], direction[0], direction[1]];
    this.yaw = Math.atan2(y, x);
    this.pitch = Math.asin(Math.max(-1, Math.min(1, z / Math.hypot(x, y, z))));
  }

  turn(dx, dy) {
    this.yaw -= 0.008 * dx;
    this.pitch = Math.max(-1.57, Math.min(1.57, this.pitch + 0.008 * dy));
  }

  // Right, up and towards the eye.
  axes() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const upright = (v) => (this.space ? v : [v[1], v[2], v[0]]);
    return [[-sy, cy, 0], [-sp * cy, -sp * sy, cp], [cp * cy, cp * sy, sp]].map(upright);
  }

  // Half of the height that is seen.
  reach(aspect) {
    return (0.55 * Math.max(this.fit[1], this.fit[0] / aspect)) / this.zoom;
  }

  matrices(aspect) {
    const axes = this.axes(), reach = this.reach(aspect);
    const scales = [1 / (reach * aspect), 1 / reach, -1 / (4 * this.size)];
    const offsets = [this.shift[0], this.shift[1], 0];
    const camera = new Float32Array(16), turn = new Float32Array(9);
    axes.forEach((axis, i) => {
      axis.forEach((x, j) => {
        camera[4 * j + i] = scales[i] * x;
        turn[3 * j + i] = x;
      });
      camera[12 + i] = -scales[i] * castx.geometry.dot(axis, this.centre) + offsets[i];
    });
    camera[15] = 1;
    return { camera, turn };
  }
};
