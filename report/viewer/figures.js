'use strict';
// Shapes of a person that the stages draw: triangles whose vertices are posed on the processor. A figure has positions,
// normals (3 numbers a vertex), index, joints (the joint that colours a vertex) and pose(motion, frame, joints).
const mocurateFigures = (() => {
  const AROUND = 12, RINGS = 4;

  // Half a turn of rings around the y axis: [x, y, z, end] of a unit capsule whose ends are 0 and 1.
  const capsule = (() => {
    const vertices = [], index = [];
    for (let end = 0; end < 2; ++end)
      for (let ring = 0; ring < RINGS; ++ring) {
        const angle = (end === 0 ? -Math.PI / 2 + ring / (RINGS - 1) * Math.PI / 2 : ring / (RINGS - 1) * Math.PI / 2);
        for (let a = 0; a < AROUND; ++a) {
          const turn = 2 * Math.PI * a / AROUND;
          vertices.push([Math.cos(angle) * Math.cos(turn), Math.sin(angle), Math.cos(angle) * Math.sin(turn), end]);
        }
      }
    for (let ring = 0; ring + 1 < 2 * RINGS; ++ring)
      for (let a = 0; a < AROUND; ++a) {
        const b = (a + 1) % AROUND, low = ring * AROUND, high = low + AROUND;
        index.push(low + a, high + a, low + b, low + b, high + a, high + b);
      }
    return {vertices, index};
  })();

  /// `shapes`: [{a, b, radius, from, to}], joints at both ends, or with offsets in the frame of joint a.
  const ofCapsules = shapes => {
    const count = capsule.vertices.length, positions = new Float32Array(3 * count * shapes.length);
    const normals = new Float32Array(positions.length), joints = new Uint16Array(count * shapes.length);
    const index = new (positions.length / 3 > 65535 ? Uint32Array : Uint16Array)(capsule.index.length * shapes.length);
    shapes.forEach((shape, s) => {
      joints.fill(shape.b, s * count, (s + 1) * count);
      capsule.index.forEach((v, i) => { index[s * capsule.index.length + i] = s * count + v; });
    });
    let turns = null;
    const end = (places, joint, offset, frame) => [0, 1, 2].map(i => places[3 * joint + i] + (offset && turns ?
      turns[9 * frame + 3 * i] * offset[0] + turns[9 * frame + 3 * i + 1] * offset[1] + turns[9 * frame + 3 * i + 2] * offset[2] : 0));
    const pose = (motion, frame, places) => {
      const turned = motion.hasRotations && shapes.some(shape => shape.from);
      turns = turned ? motion.turns(frame, turns) : null;
      shapes.forEach((shape, s) => {
        const a = end(places, shape.a, shape.from, shape.a), b = end(places, shape.b, shape.to, shape.a);
        let axis = [0, 1, 2].map(i => b[i] - a[i]);
        const length = Math.hypot(...axis), seen = length === length;
        axis = length > 1e-9 ? axis.map(v => v / length) : [0, 1, 0];
        const side = Math.abs(axis[0]) < 0.8 ? [0, axis[2], -axis[1]] : [-axis[2], 0, axis[0]];
        const n = Math.hypot(...side), u = side.map(v => v / n);
        const w = [u[1] * axis[2] - u[2] * axis[1], u[2] * axis[0] - u[0] * axis[2], u[0] * axis[1] - u[1] * axis[0]];
        capsule.vertices.forEach((v, k) => {
          const at = 3 * (s * count + k), from = v[3] === 0 ? a : b;
          for (let i = 0; i < 3; ++i) {
            const normal = u[i] * v[0] + axis[i] * v[1] + w[i] * v[2];
            normals[at + i] = normal;
            positions[at + i] = seen ? from[i] + shape.radius * normal : 0;  // a missing joint has no surface
          }
        });
      });
    };
    return {positions, normals, index, joints, pose};
  };

  const bones = skeleton => {
    const shapes = [];
    skeleton.parents.forEach((p, j) => { if (p >= 0) shapes.push({a: p, b: j, radius: 0.012}); });
    return ofCapsules(shapes);
  };

  /// Capsules of the clip: fitted ones, or those of the skeleton at the person's size.
  const body = (skeleton, clip, fitted) => {
    if (fitted) {
      return ofCapsules(fitted.map(c => ({a: c[0], b: c[1], radius: 1e-4 * c[2],
        from: [3, 4, 5].map(i => 1e-4 * c[i]), to: [6, 7, 8].map(i => 1e-4 * c[i])})));
    }
    const shapes = [];
    skeleton.parents.forEach((p, j) => {
      if (p >= 0 && skeleton.radii[j] > 0) shapes.push({a: p, b: j, radius: 1e-4 * skeleton.radii[j] * clip.scale});
    });
    return shapes.length > 0 ? ofCapsules(shapes) : bones(skeleton);
  };

  const numbers = (type, text) => new type(mocurateParts.bytes(text));

  /// A skinned body (linear blend skinning, four weights a vertex) that moves by the rotations alone.
  const skin = (skeleton, data, clip) => {
    const rest = numbers(Int16Array, data.vertices), index = numbers(Uint16Array, data.faces);
    const weights = numbers(Uint8Array, data.weights), V = rest.length / 3, J = data.parents.length;
    const positions = new Float32Array(3 * V), normals = new Float32Array(3 * V), own = new Float32Array(3 * V);
    const joints = new Uint16Array(V), scale = clip.skin_scale, place = data.joints.map(v => scale * 1e-4 * v);
    for (let v = 0; v < V; ++v) joints[v] = weights[8 * v + 4];
    for (let f = 0; f < index.length; f += 3) {  // a vertex has the sum of its faces' normals
      const at = k => [0, 1, 2].map(i => rest[3 * index[f + k] + i]);
      const [a, b, c] = [at(0), at(1), at(2)], u = b.map((v, i) => v - a[i]), w = c.map((v, i) => v - a[i]);
      const normal = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
      for (let k = 0; k < 3; ++k) for (let i = 0; i < 3; ++i) own[3 * index[f + k] + i] += normal[i];
    }
    for (let v = 0; v < V; ++v) {
      const length = Math.hypot(own[3 * v], own[3 * v + 1], own[3 * v + 2]) || 1;
      for (let i = 0; i < 3; ++i) own[3 * v + i] /= length;
    }
    let turns = null;
    const moved = new Float32Array(12 * J);
    const pose = (motion, frame) => {
      turns = motion.turns(frame, turns);
      for (let j = 0; j < J; ++j) {
        const p = data.parents[j];
        for (let i = 0; i < 3; ++i) {
          const row = 12 * j + 4 * i;
          const move = (t, k) => turns[9 * t + 3 * i] * place[3 * k] + turns[9 * t + 3 * i + 1] * place[3 * k + 1] +
            turns[9 * t + 3 * i + 2] * place[3 * k + 2];
          const at = p < 0 ? motion.root[3 * frame + i] : moved[12 * p + 4 * i + 3] + move(p, j);
          for (let k = 0; k < 3; ++k) moved[row + k] = turns[9 * j + 3 * i + k];
          moved[row + 3] = at - move(j, j);
        }
      }
      for (let v = 0; v < V; ++v) {
        const out = [0, 0, 0, 0, 0, 0];
        for (let k = 0; k < 4; ++k) {
          const weight = weights[8 * v + k] / 255;
          if (weight === 0) continue;
          const m = 12 * weights[8 * v + 4 + k];
          for (let i = 0; i < 3; ++i) {
            const r = m + 4 * i;
            out[i] += weight * (moved[r + 3] + scale * 1e-4 *
              (moved[r] * rest[3 * v] + moved[r + 1] * rest[3 * v + 1] + moved[r + 2] * rest[3 * v + 2]));
            out[3 + i] += weight * (moved[r] * own[3 * v] + moved[r + 1] * own[3 * v + 1] + moved[r + 2] * own[3 * v + 2]);
          }
        }
        for (let i = 0; i < 3; ++i) { positions[3 * v + i] = out[i]; normals[3 * v + i] = out[3 + i]; }
      }
    };
    return {positions, normals, index, joints, pose};
  };
  return {bones, body, skin};
})();
