#pragma once

namespace mocurate {

/// The players of the page: play and pause, a slider for the frame, turning by drag or arrow keys. Reads the JSON in
/// #player-data; sets data-ready on <html> to the number of players when all stand.
inline constexpr const char* kPlayerScript = R"js(
'use strict';
(() => {
  const clips = JSON.parse(document.getElementById('player-data').textContent);
  const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const redraws = [];

  const extent = clip => {
    let low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const rows of [clip.joints, clip.points]) for (const row of rows) row.forEach((v, i) => {
      if (v === null) return;
      low[i % 3] = Math.min(low[i % 3], v);
      high[i % 3] = Math.max(high[i % 3], v);
    });
    if (!isFinite(low[0])) return {centre: [0, 0, 0], radius: 1000, floor: 0};
    const centre = low.map((v, i) => (v + high[i]) / 2);
    return {centre, radius: Math.max(300, Math.hypot(...low.map((v, i) => (high[i] - v) / 2))), floor: low[1]};
  };

  const build = (root, clip) => {
    const canvas = root.querySelector('canvas');
    const button = root.querySelector('button');
    const slider = root.querySelector('input[type=range]');
    const seen = root.querySelector('input[type=checkbox]');
    const time = root.querySelector('output');
    const frames = Math.max(clip.joints.length, clip.points.length);
    const {centre, radius, floor} = extent(clip);
    const view = {yaw: clip.yaw, pitch: clip.pitch, frame: clip.start || 0, playing: false, last: 0};
    slider.max = String(Math.max(0, frames - 1));

    const draw = () => {
      const ratio = window.devicePixelRatio || 1;
      const width = canvas.clientWidth || 280, height = canvas.clientHeight || 240;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      const pen = canvas.getContext('2d');
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.clearRect(0, 0, width, height);
      const scale = 0.47 * Math.min(width, height) / radius;
      const cy = Math.cos(view.yaw), sy = Math.sin(view.yaw), cp = Math.cos(view.pitch), sp = Math.sin(view.pitch);
      const place = (px, py, pz) => {
        const x = px - centre[0], y = py - centre[1], z = pz - centre[2];
        const zt = sy * x + cy * z;
        return [width / 2 + scale * (cy * x - sy * z), height / 2 - scale * (cp * y - sp * zt)];
      };
      const at = (row, i) => row[3 * i] === null ? null : place(row[3 * i], row[3 * i + 1], row[3 * i + 2]);
      const stroke = (a, b) => {
        if (!a || !b) return;
        pen.beginPath();
        pen.moveTo(a[0], a[1]);
        pen.lineTo(b[0], b[1]);
        pen.stroke();
      };
      pen.lineCap = 'round';
      pen.strokeStyle = style('--grid');
      pen.lineWidth = 1;
      const reach = Math.ceil(radius / 500) * 500;
      for (let g = -reach; g <= reach; g += 500) {
        stroke(place(centre[0] + g, floor, centre[2] - reach), place(centre[0] + g, floor, centre[2] + reach));
        stroke(place(centre[0] - reach, floor, centre[2] + g), place(centre[0] + reach, floor, centre[2] + g));
      }
      const frame = Math.round(view.frame);
      const points = clip.points[frame];
      if (points && seen.checked) {
        pen.strokeStyle = style('--before');
        pen.lineWidth = 1.5;
        for (const [a, b] of clip.lines) stroke(at(points, a), at(points, b));
      }
      const joints = clip.joints[frame];
      if (joints) {
        pen.lineWidth = 3;
        for (const [a, b, side] of clip.bones) {
          pen.strokeStyle = style(side > 0 ? '--left' : side < 0 ? '--right' : '--after');
          stroke(at(joints, a), at(joints, b));
        }
      }
      if (points && seen.checked) {
        pen.lineWidth = 1;
        pen.fillStyle = style('--page');
        pen.strokeStyle = style('--ink');
        for (let i = 0; 3 * i < points.length; ++i) {
          const p = at(points, i);
          if (!p) continue;
          pen.beginPath();
          pen.arc(p[0], p[1], 2.8, 0, 2 * Math.PI);
          pen.fill();
          pen.stroke();
        }
      }
      slider.value = String(frame);
      time.textContent = (frame * clip.step / clip.hz).toFixed(2) + ' s';
    };

    const tick = now => {
      if (!view.playing) return;
      view.frame += (now - view.last) / 1000 * clip.hz / clip.step;
      view.last = now;
      if (view.frame > frames - 1) view.frame = 0;
      draw();
      requestAnimationFrame(tick);
    };
    button.addEventListener('click', () => {
      view.playing = !view.playing;
      button.textContent = view.playing ? 'Pause' : 'Play';
      view.last = performance.now();
      if (view.playing) requestAnimationFrame(tick);
    });
    slider.addEventListener('input', () => { view.frame = Number(slider.value); draw(); });
    seen.addEventListener('change', draw);
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
  };

  const roots = document.querySelectorAll('.player');
  roots.forEach((root, i) => build(root, clips[i]));
  const again = () => redraws.forEach(draw => draw());
  window.addEventListener('resize', again);
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', again);
  document.documentElement.dataset.ready = String(roots.length);
})();
)js";

}  // namespace mocurate
