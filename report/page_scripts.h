#pragma once

namespace mocurate {

/// Light and dark by the reader's preference; system fonts; no external resources.
inline constexpr const char* kPageStyle = R"css(
:root { color-scheme: light dark;
  --page: #f6f7f9; --card: #ffffff; --ink: #1c2127; --soft: #5a6470; --rule: #d9dee5; --grid: #e3e7ec;
  --before: #8b95a1; --after: #2563c9; --left: #2563c9; --right: #c2571a; --good: #2c7d4f; --suspect: #b07d00; --bad: #b3392f;
  --heat: 37, 99, 201; }
@media (prefers-color-scheme: dark) { :root {
  --page: #14171b; --card: #1c2127; --ink: #e6e9ed; --soft: #a0a9b4; --rule: #343b44; --grid: #2b323a;
  --before: #8b95a1; --after: #6ba0f5; --left: #6ba0f5; --right: #f0965a; --good: #5fbf8a; --suspect: #e0b040; --bad: #ee7d72;
  --heat: 70, 130, 235; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto,
  "Helvetica Neue", Arial, sans-serif; font-variant-numeric: tabular-nums; }
.skip { position: absolute; left: -999px; } .skip:focus { left: 8px; top: 8px; }
header, main, footer { max-width: 1080px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 36px; } footer { padding-bottom: 48px; color: var(--soft); font-size: 14px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 4px; } h2 { font-size: 20px; margin: 0 0 10px; line-height: 1.3; }
h3 { font-size: 16px; margin: 24px 0 6px; overflow-wrap: anywhere; }
p { margin: 0 0 10px; max-width: 78ch; } a { color: var(--after); }
.lead { font-size: 17px; color: var(--soft); } .verdict { font-size: 18px; margin-top: 16px; font-weight: 600; }
.soft { color: var(--soft); font-size: 14px; }
section { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 20px 24px; margin: 20px 0; }
nav { position: sticky; top: 0; z-index: 2; background: var(--page); border-bottom: 1px solid var(--rule); padding: 0 0 8px; }
section { scroll-margin-top: 72px; }
nav ol { max-width: 1080px; margin: 0 auto; padding: 0 24px;
  list-style: none; display: flex; flex-wrap: wrap; gap: 2px 18px; padding-top: 8px; font-size: 14px; }
dt { font-weight: 600; } dd { margin: 0 0 8px; max-width: 78ch; } #reading dl { margin: 0; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 12px; margin: 20px 0 4px; padding: 0; }
.tiles div { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 12px 16px; }
.tiles dt { color: var(--soft); font-size: 13px; font-weight: 400; } .tiles dd { margin: 0; font-size: 24px; font-weight: 600; }
.tiles small { display: block; font-size: 13px; font-weight: 400; color: var(--soft); }
.scroll { overflow-x: auto; margin: 8px 0 14px; }
table { border-collapse: collapse; font-size: 14px; min-width: min(420px, 100%); } caption { text-align: left; color: var(--soft); padding-bottom: 6px; }
th, td { padding: 5px 14px 5px 0; border-bottom: 1px solid var(--rule); text-align: left; vertical-align: top; }
thead th { color: var(--soft); font-weight: 600; white-space: nowrap; } tbody th { font-weight: 500; overflow-wrap: anywhere; }
button.sort { border: 0; background: none; padding: 0; min-width: 0; color: inherit; font-weight: inherit; text-align: inherit; }
th[aria-sort=ascending] button::after { content: " ▲"; } th[aria-sort=descending] button::after { content: " ▼"; }
button.more { margin: 0 0 14px; } input[type=search] { font: inherit; font-size: 14px; padding: 2px 8px; color: inherit;
  background: var(--card); border: 1px solid var(--rule); border-radius: 6px; }
.numeric td, .numeric thead th:not(:first-child) { text-align: right; white-space: nowrap; }
svg polyline { fill: none; stroke: var(--c); } svg polygon { fill: var(--c); stroke: var(--c); stroke-width: 0.4; } svg text { fill: var(--c); }
.c-ink { --c: var(--ink); } .c-soft { --c: var(--soft); } .c-grid { --c: var(--grid); } .c-page { --c: var(--page); }
.c-before { --c: var(--before); } .c-after { --c: var(--after); } .c-good { --c: var(--good); }
.c-suspect { --c: var(--suspect); } .c-bad { --c: var(--bad); } .c-left { --c: var(--left); } .c-right { --c: var(--right); }
svg { display: block; width: 100%; height: auto; } .clip svg { background: var(--page); border-radius: 8px; max-height: 240px; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(300px, 1fr)); gap: 14px 28px; margin: 12px 0; }
.charts.wide { grid-template-columns: repeat(auto-fit, minmax(440px, 1fr)); }
figure { margin: 0; } figcaption { font-size: 14px; color: var(--soft); margin-bottom: 4px; }
.clip { display: grid; grid-template-columns: minmax(0, 1fr) 300px; gap: 18px; align-items: center; }
code { white-space: nowrap; }
video { display: block; max-width: 100%; max-height: 560px; border-radius: 8px; margin: 0 0 14px; background: #181c22; }
.alone .player { max-width: 560px; margin-top: 14px; } .alone canvas { height: 340px; }
.s-observed { fill: var(--grid); background: var(--grid); } .s-repaired { fill: var(--bad); background: var(--bad); }
.s-interpolated { fill: var(--suspect); background: var(--suspect); } .s-inferred { fill: var(--soft); background: var(--soft); }
.player canvas { width: 100%; height: 230px; display: block; background: var(--page); border-radius: 8px; cursor: grab;
  touch-action: none; }
.player canvas:focus-visible, button:focus-visible, input:focus-visible, a:focus-visible { outline: 2px solid var(--after);
  outline-offset: 2px; }
.controls { display: flex; align-items: center; gap: 8px; margin-top: 6px; font-size: 13px; flex-wrap: wrap; }
.controls input[type=range] { flex: 1; min-width: 70px; } .controls output { min-width: 52px; text-align: right; }
button { font: inherit; padding: 2px 10px; min-width: 64px; border: 1px solid var(--rule); border-radius: 6px; background: var(--card);
  color: inherit; cursor: pointer; }
.overlays { display: flex; flex-wrap: wrap; gap: 14px; margin-top: 14px; }
.overlays img { max-width: 100%; height: 400px; object-fit: contain; display: block; border-radius: 8px; }
.overlays figcaption { margin: 4px 0 0; }
.heat td { text-align: center; padding: 3px 0; min-width: 30px; border: 1px solid var(--card); } .heat td:empty { background: var(--page); }
.heat th { padding: 3px 10px 3px 0; border: 0; } .heat thead th { text-align: center; padding: 3px 0; } .heat .hot { color: #fff; }
.key span { display: inline-block; width: 12px; height: 12px; border-radius: 3px; margin: 0 5px 0 12px; vertical-align: -1px; }
.key .k-before { background: var(--before); margin-left: 0; } .key .k-left { background: var(--left); } .key .k-right { background: var(--right); }
.key .k-good { background: var(--good); margin-left: 0; } .key .k-suspect { background: var(--suspect); } .key .k-bad { background: var(--bad); }
.key .k-after { background: var(--after); }
summary { cursor: pointer; font-size: 14px; color: var(--soft); }
@media (max-width: 760px) { .charts.wide { grid-template-columns: 1fr; } .clip { grid-template-columns: 1fr; } header, main, footer { padding-left: 14px; padding-right: 14px; } }
@media print { section { break-inside: avoid; } .player { display: none; } .clip { grid-template-columns: 1fr; } }
)css";

/// The players of the page: play and pause, a slider for the frame, rotation by drag or arrow keys. Reads the JSON in
/// #player-data, where the page has it; sets data-ready on <html> to the number of players when all are ready.
/// mocuratePlayer(root, clip) creates one and returns {frame(), show(frame), toggle(), pause(), draw()}. Beside the
/// fields of PlayerData, `clip` may have: thinned, the frames from one row of joints to the next (poses between are
/// interpolated), and count, the number of frames; zero_s, the time of the first; follow, the root stays in the middle;
/// speed, 1 as recorded; away, not drawn; moved(frame), called after every draw. A clip with paint(pen, frame, seen) is
/// painted by it instead of bones; margin and sole are how far its body goes beyond the joints, around and below, mm.
inline constexpr const char* kPlayerScript = R"js(
'use strict';
const mocuratePlayer = (() => {
  const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const redraws = [];

  const extent = clip => {
    let low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const rows of [clip.joints, clip.points]) for (const row of rows) row.forEach((v, i) => {
      if (v === null) return;
      const from = clip.follow && i % 3 !== 1 ? v - row[i % 3] : v;
      low[i % 3] = Math.min(low[i % 3], from);
      high[i % 3] = Math.max(high[i % 3], from);
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
    const seen = root.querySelector('input[type=checkbox]');
    const time = root.querySelector('output');
    const frames = clip.count || Math.max(clip.joints.length, clip.points.length);
    const pose = frame => {
      if (!clip.thinned) return clip.joints[Math.round(frame)];
      const place = Math.min(frame / clip.thinned, clip.joints.length - 1), part = place % 1;
      const before = clip.joints[Math.floor(place)], after = clip.joints[Math.ceil(place)];
      return part > 0 ? before.map((v, i) => v + part * (after[i] - v)) : before;
    };
    const whole = extent(clip), radius = clip.radius || whole.radius, floor = whole.floor;
    const view = {yaw: clip.yaw, pitch: clip.pitch, frame: clip.start || 0, playing: false, last: 0};
    slider.max = String(Math.max(0, frames - 1));

    const draw = () => {
      if (clip.away) return;
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
      const at = (row, i) => row[3 * i] === null ? null : place(row[3 * i], row[3 * i + 1], row[3 * i + 2]);
      const stroke = (a, b) => {
        if (!a || !b) return;
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
      const points = clip.points[frame];
      if (points && seen.checked) {
        pen.strokeStyle = style('--before');
        pen.lineWidth = 1.5;
        for (const [a, b] of clip.lines) stroke(at(points, a), at(points, b));
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
      time.textContent = ((clip.zero_s || 0) + frame * clip.step / clip.hz).toFixed(2) + ' s';
      if (clip.moved) clip.moved(view.frame);
    };

    const tick = now => {
      if (!view.playing) return;
      view.frame += Math.max(0, now - view.last) / 1000 * clip.hz / clip.step * (clip.speed || 1);
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
    return {frame: () => view.frame, show: frame => { view.frame = frame; draw(); }, toggle: () => play(!view.playing),
      pause: () => play(false), draw};
  };

  const again = () => redraws.forEach(draw => draw());
  window.addEventListener('resize', again);
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', again);
  build.extent = extent;
  return build;
})();
(() => {
  const data = document.getElementById('player-data');
  if (!data) return;
  const clips = JSON.parse(data.textContent), roots = document.querySelectorAll('.player');
  roots.forEach((root, i) => mocuratePlayer(root, clips[i]));
  document.documentElement.dataset.ready = String(roots.length);
})();
)js";

/// Shared by the interactive pages: the browser's store, saving a file, and the page's keys.
inline constexpr const char* kPageToolsScript = R"js(
'use strict';
const pageTools = {
  // The store is missing where the browser forbids it: reading gives null, keeping gives false.
  read(key) { try { return JSON.parse(localStorage.getItem(key)); } catch (e) { return null; } },
  keep(key, value) {
    try { localStorage.setItem(key, JSON.stringify(value)); } catch (e) { return false; }
    return true;
  },
  forget(key) { try { localStorage.removeItem(key); } catch (e) { /* nothing was kept */ } },
  save(text, type, name) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], {type}));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  },
  // With a command key or alt; AltGr types brackets on many keyboards.
  hasCommand(e) { return (e.ctrlKey || e.metaKey || e.altKey) && !e.getModifierState('AltGraph'); },
  isTyping(e) {
    return /^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName) && !/^(range|checkbox)$/.test(e.target.type);
  },
};
)js";

}  // namespace mocurate
