#pragma once

namespace mocurate {

/// Skinned bodies for the player (page_scripts.h). mocurateSkin(body) gives {clipOf(motion)}, a clip of mocuratePlayer,
/// or null without WebGL. All bodies are drawn by one WebGL context into a canvas off the page and copied from there,
/// because browsers allow 8 to 16 contexts. `body`: {"parents": (J), "joints": (3J), "vertices": int16 (V,3), both
/// tenths of a millimetre, "faces": uint16 (F,3), "weights": uint8 (V,8), four weights of sum 255 and their joints};
/// `motion`: {"hz", "yaw", "pitch", "frames": int16 (3 + 4J) each, the root in millimetres, then w x y z of each
/// joint's rotation times 32767}; arrays are little-endian, in base64. Linear blend skinning; pose corrections of SMPL
/// are left out.
inline constexpr const char* kSkinScript = R"js(
'use strict';
const mocurateSkin = body => {
  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const vertices = new Int16Array(bytes(body.vertices).buffer), faces = new Uint16Array(bytes(body.faces).buffer);
  const weights = bytes(body.weights), rest = body.joints.map(v => v / 10), count = body.parents.length;
  const normals = new Float32Array(vertices.length);  // a vertex has the sum of its faces' normals
  for (let f = 0; f < faces.length; f += 3) {
    const at = k => [0, 1, 2].map(i => vertices[3 * faces[f + k] + i]);
    const [a, b, c] = [at(0), at(1), at(2)], u = b.map((v, i) => v - a[i]), w = c.map((v, i) => v - a[i]);
    for (let i = 0; i < 3; ++i) {
      const j = (i + 1) % 3, k = (i + 2) % 3, part = u[j] * w[k] - u[k] * w[j];
      for (let corner = 0; corner < 3; ++corner) normals[3 * faces[f + corner] + i] += part * 1e-4;
    }
  }
  // The floor is as far below the lowest joint as in the rest pose.
  const lowest = list => list.reduce((low, v, i) => i % 3 === 1 ? Math.min(low, v) : low, 1e9);
  const sole = lowest(rest) - lowest(vertices) / 10;

  const canvas = document.createElement('canvas');
  const gl = canvas.getContext('webgl');
  if (!gl) return null;
  const row = k => ['x', 'y', 'z', 'w'].map(c => `weight.${c} * bones[3 * int(joint.${c}) + ${k}]`).join(' + ');
  const sources = [[gl.VERTEX_SHADER, `
    attribute vec3 position, normal;
    attribute vec4 weight, joint;
    uniform vec4 bones[${3 * count}];
    uniform mat3 view;
    uniform vec3 centre, scale;
    varying vec3 direction;
    void main() {
      vec4 at = vec4(0.1 * position, 1.0);
      vec4 x = ${row(0)}, y = ${row(1)}, z = ${row(2)};
      gl_Position = vec4(scale * (view * (vec3(dot(x, at), dot(y, at), dot(z, at)) - centre)), 1.0);
      direction = view * vec3(dot(x.xyz, normal), dot(y.xyz, normal), dot(z.xyz, normal));
    }`], [gl.FRAGMENT_SHADER, `
    precision mediump float;
    varying vec3 direction;
    void main() {
      float light = max(0.0, dot(normalize(direction), normalize(vec3(0.3, 0.5, 0.8))));
      gl_FragColor = vec4(vec3(0.32 + 0.43 * light), 1.0);
    }`]];
  let place = null;
  const setUp = () => {
    const program = gl.createProgram();
    for (const [type, text] of sources) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    place = name => gl.getUniformLocation(program, name);
    const attribute = (name, data, size, type, normalised, stride, offset) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      const index = gl.getAttribLocation(program, name);
      gl.enableVertexAttribArray(index);
      gl.vertexAttribPointer(index, size, type, normalised, stride, offset);
    };
    attribute('position', vertices, 3, gl.SHORT, false, 0, 0);
    attribute('normal', normals, 3, gl.FLOAT, false, 0, 0);
    attribute('weight', weights, 4, gl.UNSIGNED_BYTE, true, 8, 0);
    attribute('joint', weights, 4, gl.UNSIGNED_BYTE, false, 8, 4);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
    gl.enable(gl.DEPTH_TEST);
    return gl.getProgramParameter(program, gl.LINK_STATUS);
  };
  if (!setUp()) return null;
  canvas.addEventListener('webglcontextlost', e => e.preventDefault());
  canvas.addEventListener('webglcontextrestored', setUp);

  // Three rows [rotation | translation] of each joint, which take rest positions into the world, and the joints.
  const pose = frame => {
    const bones = new Float32Array(12 * count), joints = [];
    for (let j = 0; j < count; ++j) {
      const [w, x, y, z] = frame.subarray(3 + 4 * j), s = 2 / (w * w + x * x + y * y + z * z), p = body.parents[j];
      const own = [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),
        s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x),
        s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)];
      for (let i = 0; i < 3; ++i) {
        const of = (at, k) => bones[12 * at + 4 * i + k];
        for (let k = 0; k < 3; ++k)
          bones[12 * j + 4 * i + k] = p < 0 ? own[3 * i + k] : of(p, 0) * own[k] + of(p, 1) * own[3 + k] + of(p, 2) * own[6 + k];
        const move = (at, k) => of(at, 0) * rest[3 * k] + of(at, 1) * rest[3 * k + 1] + of(at, 2) * rest[3 * k + 2];
        joints.push(p < 0 ? frame[i] : move(p, j) + of(p, 3));
        bones[12 * j + 4 * i + 3] = joints[3 * j + i] - move(j, j);
      }
    }
    return {bones, joints};
  };

  const clipOf = motion => {
    const numbers = new Int16Array(bytes(motion.frames).buffer), size = 3 + 4 * count, frames = [];
    for (let at = 0; at < numbers.length; at += size) frames.push(numbers.subarray(at, at + size));
    const paint = (pen, frame, seen) => {
      const {width, height, ratio, scale, view, centre} = seen;
      if (gl.isContextLost()) return;
      const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
      if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
      gl.viewport(0, 0, w, h);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      const cy = Math.cos(view.yaw), sy = Math.sin(view.yaw), cp = Math.cos(view.pitch), sp = Math.sin(view.pitch);
      gl.uniformMatrix3fv(place('view'), false, [cy, -sp * sy, cp * sy, 0, cp, sp, -sy, -sp * cy, cp * cy]);
      gl.uniform3fv(place('centre'), centre);
      gl.uniform3fv(place('scale'), [2 * scale / width, 2 * scale / height, -1e-4]);
      gl.uniform4fv(place('bones'), pose(frames[frame]).bones);
      gl.drawElements(gl.TRIANGLES, faces.length, gl.UNSIGNED_SHORT, 0);
      pen.drawImage(canvas, 0, 0, width, height);
    };
    return {hz: motion.hz, step: 1, yaw: motion.yaw, pitch: motion.pitch, bones: [], lines: [], points: [],
      joints: frames.map(frame => pose(frame).joints), sole, margin: 120, paint};
  };
  return {clipOf};
};
)js";

}  // namespace mocurate
