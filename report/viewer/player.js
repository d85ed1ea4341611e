'use strict';
// A small player: play and pause, a slider for the frame, turned by drag or arrow keys. mocuratePlayer(root, clip) returns
// {frame(), show(frame), toggle(), pause(), draw()}. `clip`: {joints: rows of x, y, z in mm, bones: [[a, b, side]], hz, yaw,
// pitch}, and where it has them: thinned, the frames from one row to the next (poses between are interpolated), and count,
// the number of frames; zero_s, the time of the first; follow, the root stays in the middle; speed, 1 as recorded; away, not
// drawn; moved(frame), called after every draw; paint(pen, frame, seen), instead of bones; margin and sole, how far its body
// goes beyond the joints, around and below, mm; radius, mm of the view.
const mocuratePlayer = (() => {
  const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const redraws = [];

  const extent = clip => {
    let low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const row of clip.joints) row.forEach((v, i) => {
      const from = clip.follow && i % 3 !== 1 ? v - row[i % 3] : v;
      if (from < low[i % 3]) low[i % 3] = from;  // a missing joint has none
      if (from > high[i % 3]) high[i % 3] = from;
    });
    if (!isFinite(low[0])) return {centre: [0, 0, 0], radius: 1000, floor: 0};
    const centre = low.map((v, i) => (v + high[i]) / 2);
    const radius = Math.max(300, Math.hypot(...low.map((v, i) => (high[i] - v) / 2))) + (clip.margin || 0);
    return {centre, radius, floor: low[1] - (clip.sole || 0)};
  };

  const build = (root, clip) => {
    const canvas = root.querySelector('canvas');
    const button = root.querySelector('button');
    const slider = root.querySelector('input[type=range]');
    const time = root.querySelector('output');
    const frames = clip.count || clip.joints.length;
    const pose = frame => {
      if (!clip.thinned) return clip.joints[Math.round(frame)];
      const place = Math.min(frame / clip.thinned, clip.joints.length - 1), part = place % 1;
      const before = clip.joints[Math.floor(place)], after = clip.joints[Math.ceil(place)];
      return part > 0 ? before.map((v, i) => v + part * (after[i] - v)) : before;
    };
    let whole = null, measured = null;  // of the joints
    const view = {yaw: clip.yaw, pitch: clip.pitch, frame: clip.start || 0, playing: false, last: 0};
    slider.max = String(Math.max(0, frames - 1));

    const draw = () => {
      if (clip.away) return;
      if (measured !== clip.joints) [whole, measured] = [extent(clip), clip.joints];
      const radius = clip.radius || whole.radius, floor = whole.floor;
      const ratio = window.devicePixelRatio || 1;
      const width = canvas.clientWidth || 280, height = canvas.clientHeight || 240;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      const pen = canvas.getContext('2d');
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.clearRect(0, 0, width, height);
      const frame = Math.round(view.frame), joints = pose(view.frame);
      const centre = clip.follow && joints ? whole.centre.map((v, i) => i === 1 ? v : v + joints[i]) : whole.centre;
      const scale = 0.47 * Math.min(width, height) / radius;
      const cy = Math.cos(view.yaw), sy = Math.sin(view.yaw), cp = Math.cos(view.pitch), sp = Math.sin(view.pitch);
      const place = (px, py, pz) => {
        const x = px - centre[0], y = py - centre[1], z = pz - centre[2];
        const zt = sy * x + cy * z;
        return [width / 2 + scale * (cy * x - sy * z), height / 2 - scale * (cp * y - sp * zt)];
      };
      const at = (row, i) => place(row[3 * i], row[3 * i + 1], row[3 * i + 2]);
      const stroke = (a, b) => {
        const dot = Math.hypot(a[0] - b[0], a[1] - b[1]) < 0.5 ? 0.5 : 0;  // joints that coincide are seen
        pen.beginPath();
        pen.moveTo(a[0] - dot, a[1]);
        pen.lineTo(b[0] + dot, b[1]);
        pen.stroke();
      };
      pen.lineCap = 'round';
      pen.strokeStyle = style('--grid');
      pen.lineWidth = 1;
      const reach = Math.ceil(radius / 500) * 500;
      const [x, , z] = clip.follow ? centre.map(v => Math.round(v / 500) * 500) : centre;
      for (let g = -reach; g <= reach; g += 500) {
        stroke(place(x + g, floor, z - reach), place(x + g, floor, z + reach));
        stroke(place(x - reach, floor, z + g), place(x + reach, floor, z + g));
      }
      if (clip.paint) {
        clip.paint(pen, frame, {width, height, ratio, scale, view, centre});
      } else if (joints) {
        pen.lineWidth = 3;
        for (const [a, b, side] of clip.bones) {
          pen.strokeStyle = style(side > 0 ? '--left' : side < 0 ? '--right' : '--after');
          stroke(at(joints, a), at(joints, b));
        }
      }
      slider.value = String(frame);
      time.textContent = ((clip.zero_s || 0) + frame / clip.hz).toFixed(2) + ' s';
      if (clip.moved) clip.moved(view.frame);
    };

    const tick = now => {
      if (!view.playing) return;
      view.frame += Math.max(0, now - view.last) / 1000 * clip.hz * (clip.speed || 1);
      view.last = now;
      if (view.frame > frames - 1) view.frame = 0;
      draw();
      requestAnimationFrame(tick);
    };
    const play = playing => {
      if (view.playing === playing) return;
      view.playing = playing;
      button.textContent = playing ? 'Pause' : 'Play';
      view.last = performance.now();
      if (playing) requestAnimationFrame(tick);
    };
    button.addEventListener('click', () => play(!view.playing));
    slider.addEventListener('input', () => { view.frame = Number(slider.value); draw(); });
    let from = null;
    canvas.addEventListener('pointerdown', e => { from = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener('pointerup', () => { from = null; });
    canvas.addEventListener('pointercancel', () => { from = null; });
    const turn = (dx, dy) => {
      view.yaw -= dx;
      view.pitch = Math.min(1.5, Math.max(-1.5, view.pitch + dy));
      draw();
    };
    canvas.addEventListener('pointermove', e => {
      if (!from) return;
      turn((e.clientX - from[0]) * 0.01, (e.clientY - from[1]) * 0.01);
      from = [e.clientX, e.clientY];
    });
    canvas.addEventListener('keydown', e => {
      const move = {ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15]}[e.key];
      if (!move) return;
      e.preventDefault();
      turn(move[0], move[1]);
    });
    redraws.push(draw);
    draw();
    return {frame: () => view.frame, show: frame => { view.frame = frame; draw(); }, toggle: () => play(!view.playing),
      pause: () => play(false), draw};
  };

  const again = () => redraws.forEach(draw => draw());
  window.addEventListener('resize', again);
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', again);
  build.extent = extent;
  return build;
})();
