// Data of the page: JSON in script elements, arrays in it as compressed text. See castx/report/packing.py.
"use strict";

const castx = {};

castx.json = (id) => {
  const element = document.getElementById(id);
  return element === null ? null : JSON.parse(element.textContent);
};

castx.bytes = async (text) => {
  const coded = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([coded]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
};

// An array as it was; a field in levels becomes one Float32Array for each moment, NaN where nothing is.
castx.unpacked = async (packed) => {
  const buffer = await castx.bytes(packed.data);
  if (packed.type !== "levels") {
    const kinds = { float32: Float32Array, uint16: Uint16Array, uint32: Uint32Array };
    return new kinds[packed.type](buffer);
  }
  return castx.fromLevels(new Uint8Array(buffer), packed);
};

castx.fromLevels = (planes, { shape, low, high }) => {
  const [moments, size] = shape;
  const levels = new Uint16Array(size); // wraps round, as its writer does
  const step = (high - low) / 65534;
  const found = [];
  for (let moment = 0; moment < moments; moment++) {
    const values = new Float32Array(size);
    for (let i = 0, at = moment * size; i < size; i++, at++) {
      levels[i] += planes[at] + 256 * planes[moments * size + at];
      values[i] = levels[i] === 0 ? NaN : low + (levels[i] - 1) * step;
    }
    found.push(values);
  }
  return found;
};

// Four digits, without trailing zeros.
castx.text = (value) => {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3)) return value.toExponential(2).replace(/\.?0+e/, "e");
  return String(Number(value.toPrecision(4)));
};
