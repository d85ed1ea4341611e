'use strict';
// Two stages draw the same scene: with WebGL (three.js) or on a canvas. draw(scene, camera) takes
//   scene:  {bodies: [{key, figure, colours, shift, joints, parents, opacity}], lines: [{key, places, shift, colour, strip, dots}],
//           floor, centre, radius, grid, background}
//   camera: {yaw, pitch, distance, target, width, height, ratio}
// Metres, y up. The eye is at target + distance * direction(yaw, pitch).
const mocurateStages = (() => {
  const FIELD = 35 * Math.PI / 180;  // vertical field of view

  const eye = camera => {
    const c = Math.cos(camera.pitch), d = camera.distance;
    return [camera.target[0] + d * c * Math.sin(camera.yaw), camera.target[1] + d * Math.sin(camera.pitch),
      camera.target[2] + d * c * Math.cos(camera.yaw)];
  };

  /// A function from a place to [x, y, depth] in pixels; depth is negative behind the eye.
  const projection = camera => {
    const from = eye(camera), cy = Math.cos(camera.yaw), sy = Math.sin(camera.yaw);
    const cp = Math.cos(camera.pitch), sp = Math.sin(camera.pitch);
    const focal = 0.5 * camera.height / Math.tan(FIELD / 2);
    return p => {
      const x = p[0] - from[0], y = p[1] - from[1], z = p[2] - from[2];
      const right = cy * x - sy * z, near = sp * y + cp * (sy * x + cy * z), up = cp * y - sp * (sy * x + cy * z);
      const depth = -near;
      return [camera.width / 2 + focal * right / depth, camera.height / 2 - focal * up / depth, depth];
    };
  };

  const webgl = canvas => {
    const context = canvas.getContext('webgl2', {antialias: true}) ||
      canvas.getContext('webgl', {antialias: true});
    if (!context || typeof THREE === 'undefined') return null;
    const renderer = new THREE.WebGLRenderer({canvas, context, antialias: true});
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = THREE.PCFShadowMap;
    const world = new THREE.Scene(), view = new THREE.PerspectiveCamera(35, 1, 0.05, 200);
    world.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 0.75));
    const sun = new THREE.DirectionalLight(0xffffff, 0.55);
    sun.castShadow = true;
    sun.shadow.mapSize.set(1024, 1024);
    world.add(sun, sun.target);
    const ground = new THREE.Mesh(new THREE.PlaneBufferGeometry(1, 1), new THREE.ShadowMaterial({opacity: 0.25}));
    ground.rotation.x = -Math.PI / 2;
    ground.receiveShadow = true;
    world.add(ground);
    let grid = null, sized = [0, 0, 0];
    const meshes = new Map(), lines = new Map();

    const meshOf = body => {
      const known = meshes.get(body.key);
      if (known && known.figure === body.figure) return known;
      if (known) drop(meshes, body.key);
      const geometry = new THREE.BufferGeometry(), figure = body.figure;
      for (const [name, array] of [['position', figure.positions], ['normal', figure.normals],
        ['color', new Float32Array(figure.positions.length)]]) geometry.setAttribute(name, new THREE.BufferAttribute(array, 3));
      geometry.setIndex(new THREE.BufferAttribute(figure.index, 1));
      const material = new THREE.MeshLambertMaterial({vertexColors: THREE.VertexColors});
      const mesh = new THREE.Mesh(geometry, material);
      mesh.castShadow = true;
      mesh.frustumCulled = false;
      mesh.figure = figure;
      world.add(mesh);
      meshes.set(body.key, mesh);
      return mesh;
    };
    const drop = (map, key) => {
      const object = map.get(key);
      world.remove(object);
      object.geometry.dispose();
      object.material.dispose();
      map.delete(key);
    };
    const drawLines = (key, line) => {
      let object = lines.get(key);
      const room = object ? object.geometry.getAttribute('position').array.length : 0;
      if (object && (line.dots ? room < line.places.length : room !== line.places.length)) {
        drop(lines, key);
        object = null;
      }
      if (!object) {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(line.dots ? Math.max(900, line.places.length) : line.places.length), 3));
        object = line.dots ? new THREE.Points(geometry, new THREE.PointsMaterial({size: line.dots, sizeAttenuation: true, depthTest: false, transparent: true})) :
          new THREE[line.strip ? 'Line' : 'LineSegments'](geometry, new THREE.LineBasicMaterial());
        object.frustumCulled = false;
        world.add(object);
        lines.set(key, object);
      }
      if (object.places !== line.places) {
        const attribute = object.geometry.getAttribute('position');
        attribute.array.set(line.places);
        attribute.needsUpdate = true;
        object.geometry.setDrawRange(0, line.places.length / 3);
        object.places = line.places;
      }
      object.position.set(...line.shift);
      object.material.color.set(line.colour);
    };

    const draw = (scene, camera) => {
      if (sized.some((v, i) => v !== [camera.width, camera.height, camera.ratio][i])) {
        sized = [camera.width, camera.height, camera.ratio];
        renderer.setPixelRatio(camera.ratio);
        renderer.setSize(camera.width, camera.height, false);
      }
      renderer.setClearColor(scene.background, 1);
      view.aspect = camera.width / camera.height;
      view.position.set(...eye(camera));
      view.lookAt(...camera.target);
      view.near = Math.max(0.01, camera.distance / 200);
      view.far = camera.distance + 6 * scene.radius + 20;
      view.updateProjectionMatrix();
      const reach = Math.max(2, Math.ceil(2 * scene.radius)), [x, , z] = scene.centre.map(Math.round);
      if (!grid || grid.reach !== reach || grid.colour !== scene.grid) {
        if (grid) { world.remove(grid); grid.geometry.dispose(); grid.material.dispose(); }
        grid = new THREE.GridHelper(2 * reach, Math.min(200, 4 * reach), scene.grid, scene.grid);
        grid.reach = reach;
        grid.colour = scene.grid;
        world.add(grid);
      }
      grid.position.set(x, scene.floor, z);
      ground.position.set(x, scene.floor - 0.002, z);
      ground.scale.set(4 * reach, 4 * reach, 1);
      sun.target.position.set(scene.centre[0], scene.floor, scene.centre[2]);
      sun.position.set(scene.centre[0] + scene.radius, scene.floor + 2.5 * scene.radius + 2, scene.centre[2] + scene.radius);
      const shade = sun.shadow.camera, span = 1.2 * scene.radius + 0.5;
      Object.assign(shade, {left: -span, right: span, top: span, bottom: -span, near: 0.1, far: 6 * scene.radius + 8});
      shade.updateProjectionMatrix();
      const seen = new Set();
      for (const body of scene.bodies) {
        const mesh = meshOf(body), figure = body.figure;
        seen.add(body.key);
        mesh.position.set(...body.shift);
        const colours = mesh.geometry.getAttribute('color');
        for (let v = 0; v < figure.joints.length; ++v)
          for (let i = 0; i < 3; ++i) colours.array[3 * v + i] = body.colours[3 * figure.joints[v] + i];
        for (const name of ['position', 'normal', 'color']) mesh.geometry.getAttribute(name).needsUpdate = true;
        mesh.material.transparent = body.opacity < 1;
        mesh.material.opacity = body.opacity;
        mesh.castShadow = body.opacity === 1;
      }
      for (const key of [...meshes.keys()]) if (!seen.has(key)) drop(meshes, key);
      const drawn = new Set(scene.lines.map(line => line.key));
      for (const key of [...lines.keys()]) if (!drawn.has(key)) drop(lines, key);
      scene.lines.forEach(line => drawLines(line.key, line));
      renderer.render(world, view);
    };
    return {draw, kind: 'webgl'};
  };

  const flat = canvas => {
    const draw = (scene, camera) => {
      canvas.width = Math.round(camera.width * camera.ratio);
      canvas.height = Math.round(camera.height * camera.ratio);
      const pen = canvas.getContext('2d'), place = projection(camera);
      pen.setTransform(camera.ratio, 0, 0, camera.ratio, 0, 0);
      pen.fillStyle = scene.background;
      pen.fillRect(0, 0, camera.width, camera.height);
      const stroke = (a, b) => {
        const from = place(a), to = place(b);
        if (!(from[2] > 0.05 && to[2] > 0.05)) return;  // behind the eye, or missing
        pen.beginPath();
        pen.moveTo(from[0], from[1]);
        pen.lineTo(to[0], to[1]);
        pen.stroke();
      };
      pen.lineCap = 'round';
      pen.strokeStyle = scene.grid;
      pen.lineWidth = 1;
      const reach = Math.max(2, Math.ceil(scene.radius)), [x, , z] = scene.centre.map(Math.round);
      for (let g = -reach; g <= reach; g += Math.max(0.5, reach / 50)) {
        stroke([x + g, scene.floor, z - reach], [x + g, scene.floor, z + reach]);
        stroke([x - reach, scene.floor, z + g], [x + reach, scene.floor, z + g]);
      }
      for (const line of scene.lines) {
        const at = i => [0, 1, 2].map(k => line.places[3 * i + k] + line.shift[k]), count = line.places.length / 3;
        pen.strokeStyle = pen.fillStyle = line.colour;
        pen.lineWidth = 1.5;
        if (line.dots) {
          for (let i = 0; i < count; ++i) {
            const [px, py, depth] = place(at(i));
            if (depth > 0.05) pen.fillRect(px - 2, py - 2, 4, 4);
          }
        } else {
          for (let i = 0; i + 1 < count; i += line.strip ? 1 : 2) stroke(at(i), at(i + 1));
        }
      }
      for (const body of scene.bodies) {
        pen.globalAlpha = body.opacity;
        pen.lineWidth = 4;
        const at = j => [0, 1, 2].map(i => body.joints[3 * j + i] + body.shift[i]);
        body.parents.forEach((p, j) => {
          if (p < 0) return;
          pen.strokeStyle = 'rgb(' + [0, 1, 2].map(i => Math.round(255 * body.colours[3 * j + i])) + ')';
          stroke(at(p), at(j));
        });
        pen.globalAlpha = 1;
      }
    };
    return {draw, kind: 'canvas'};
  };

  return {FIELD, make: canvas => webgl(canvas) || flat(canvas)};
})();
