'use strict';
// The motions of a page: an index (JSON) and parts (base64) that hold the frames of many clips. Inline parts are
// <script type="text/plain" id="mocurate-part-N">; others are scripts beside the page that call mocurateParts.take,
// because pages of file:// cannot fetch. `schema` is that of the page and of its data.
const mocurateParts = (() => {
  const SCHEMA = 2;
  const MOST = 8;  // parts kept decoded
  const decoded = new Map(), waiting = new Map();
  const sentence = {
    schema: found => 'This page reads data of schema ' + SCHEMA + ', but the data have ' + found +
      ': page and data were written by different versions of mocurate. Write the page again with `mocurate view`.',
    missing: file => file + ' is missing, damaged or of another page: keep the folder beside its page, or write the page again.',
  };

  const bytesOf = text => {
    const binary = atob(text.trim()), bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
    return bytes.buffer;
  };
  const keep = (key, buffer) => {
    decoded.delete(key);
    decoded.set(key, buffer);
    if (decoded.size > MOST) decoded.delete(decoded.keys().next().value);
    return buffer;
  };

  /// Called by a part beside the page.
  const take = (schema, set, part, text) => {
    const asked = waiting.get(set + '/' + part);
    if (!asked) return;  // a part of another page was not asked for: its loading ends with a sentence
    waiting.delete(set + '/' + part);
    if (schema !== SCHEMA) { asked.reject(new Error(sentence.schema(schema))); return; }
    try { asked.resolve(bytesOf(text)); } catch (e) { asked.reject(new Error(sentence.missing('part ' + part))); }
  };

  /// A promise of the bytes of a part.
  const read = (index, part) => {
    const key = (index.beside ? index.beside.set : '') + '/' + part;
    if (decoded.has(key)) return Promise.resolve(keep(key, decoded.get(key)));
    if (!index.beside) {
      const earlier = waiting.get(key);
      if (earlier) return earlier.promise;
      const inline = () => document.getElementById('mocurate-part-' + part);
      const loaded = document.readyState !== 'loading' || inline() && inline().nextElementSibling ? Promise.resolve() :
        new Promise(resolve => document.addEventListener('DOMContentLoaded', resolve));
      const promise = loaded.then(() => keep(key, bytesOf(inline().textContent))).catch(() => {
        throw new Error('part ' + part + ' of this page is missing or damaged: write the page again.');
      });
      waiting.set(key, {promise, reject: () => {}});
      const over = () => waiting.delete(key);
      promise.then(over, over);
      return promise;
    }
    const file = index.beside.folder + '/part_' + String(part).padStart(4, '0') + '.js';
    const earlier = waiting.get(key);
    if (earlier) return earlier.promise;
    const asked = {};
    asked.promise = new Promise((resolve, reject) => { asked.resolve = resolve; asked.reject = reject; })
      .then(buffer => keep(key, buffer));
    waiting.set(key, asked);
    const script = document.createElement('script');
    script.src = file.split('/').map(encodeURIComponent).join('/');
    const over = () => {
      script.remove();
      if (waiting.delete(key)) asked.reject(new Error(sentence.missing(file)));
    };
    script.onerror = over;
    script.onload = over;  // a part that called take is no longer waited for
    document.head.appendChild(script);
    return asked.promise;
  };
  return {SCHEMA, take, read, sentence, bytes: bytesOf};
})();

// A clip of the index with its frames: F frames, J joints, K tracked points.
const mocurateClip = (() => {
  const STEP = 1e-4;  // metres of a unit
  const MISSING = -32768;

  /// World rotations (9 numbers a joint, by rows) of a frame's rotation vectors.
  const turns = (skeleton, vectors, frame, out) => {
    const J = skeleton.parents.length, unit = Math.PI / 32767, at = 3 * J * frame;
    for (let j = 0; j < J; ++j) {
      const x = vectors[at + 3 * j] * unit, y = vectors[at + 3 * j + 1] * unit, z = vectors[at + 3 * j + 2] * unit;
      const angle = Math.hypot(x, y, z), c = Math.cos(angle);
      const s = angle > 1e-9 ? Math.sin(angle) / angle : 1, k = angle > 1e-9 ? (1 - c) / (angle * angle) : 0.5;
      const own = [c + k * x * x, k * x * y - s * z, k * x * z + s * y, k * x * y + s * z, c + k * y * y, k * y * z - s * x,
        k * x * z - s * y, k * y * z + s * x, c + k * z * z];
      const p = 9 * skeleton.parents[j], o = 9 * j;
      for (let r = 0; r < 3; ++r)
        for (let i = 0; i < 3; ++i)
          out[o + 3 * r + i] = p < 0 ? own[3 * r + i] :
            out[p + 3 * r] * own[i] + out[p + 3 * r + 1] * own[3 + i] + out[p + 3 * r + 2] * own[6 + i];
    }
    return out;
  };

  /// Reads the block of a clip. Blocks begin at multiples of four bytes, in this order.
  const make = (clip, skeleton, buffer) => {
    const F = clip.frames, J = skeleton.parents.length, K = clip.points ? clip.points.names.length : 0;
    let at = clip.place[1];
    const next = (type, count) => {
      const array = new type(buffer, at, count);
      at += 4 * Math.ceil(array.byteLength / 4);
      return array;
    };
    const has = name => clip.has.includes(name);
    const unit = STEP * clip.unit;
    const root = next(Float32Array, 3 * F), joints = next(Int16Array, 3 * F * J);
    const rotations = has('rotations') ? next(Int16Array, 3 * F * J) : null;
    const points = K > 0 ? next(Int16Array, 3 * F * K) : null;
    const state = has('state') ? next(Uint8Array, F * J) : null;
    const sigma = has('sigma') ? next(Uint8Array, F * J) : null;
    const contact = has('contact') ? next(Uint8Array, F) : null;
    const sizes = has('clouds') ? next(Uint16Array, F) : null, starts = [0];
    if (sizes) sizes.forEach(size => starts.push(starts[starts.length - 1] + size));
    const clouds = sizes ? next(Int16Array, 3 * starts[F]) : null;
    const placed = (values, count, row, out, frame = row) => {
      for (let i = 0; i < count; ++i) {
        const v = 3 * (row * count + i), gap = values[v] === MISSING;
        for (let k = 0; k < 3; ++k) out[3 * i + k] = gap ? NaN : root[3 * frame + k] + unit * values[v + k];
      }
      return out;
    };
    const sigmaOf = code => code === 255 ? NaN : 1e-4 * (Math.pow(2, code / 16) - 1);  // metres
    const cloud = frame => placed(clouds.subarray(3 * starts[frame]), sizes[frame], 0, new Float32Array(3 * sizes[frame]), frame);
    return {clip, skeleton, root, cloud, hasClouds: clouds !== null, state, contact, hasRotations: rotations !== null, hasPoints: points !== null,
      hasSigma: sigma !== null,
      joints: (frame, out) => placed(joints, J, frame, out || new Float32Array(3 * J)),
      points: (frame, out) => placed(points, K, frame, out || new Float32Array(3 * K)),
      turns: (frame, out) => turns(skeleton, rotations, frame, out || new Float32Array(9 * J)),
      sigma: (frame, joint) => sigmaOf(sigma[frame * J + joint]),
      frameAt: seconds => Math.max(0, Math.min(F - 1, Math.round(seconds * clip.hz)))};
  };
  return make;
})();
