'use strict';
// mocurateSpanTrack(root, clip, on): spans of a clip over its speed curve, in the `.track` of `root`. Dragging on an
// empty area creates a span, dragging an edge moves it, a click moves the playhead. `clip`: {frames, hz, begin_s,
// fastest}: seconds of the first frame in the recording, m/s of the curve's top. `on`: spans() in order, bounds(span)
// -> [begin, end] in frames, selected(), hue(label), select(span or null), create(begin, end), adjust(span, edge,
// frame), seek(frame). Returns {wake(speeds), rest(), show(), playhead(frame), mark(frame or null), zoom(factor)};
// `speeds` are bytes, 255 times the square root of speed over the fastest.
const mocurateSpanTrack = (root, clip, on) => {
  const track = root.querySelector('.track');
  const [lanes, curve, head, mark, drawn] = ['.lanes', 'canvas', '.playhead', '.mark', '.drawn'].map(
      name => track.querySelector(name));
  const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
  let view = [0, clip.frames], speeds = null, at = 0, marked = null;
  const share = frame => 100 * (frame - view[0]) / (view[1] - view[0]);
  const frameAt = x => {
    const box = track.getBoundingClientRect();
    return clamp(view[0] + (x - box.left) / Math.max(1, box.width) * (view[1] - view[0]), 0, clip.frames);
  };
  const place = (element, begin, end) => {
    element.style.left = share(begin) + '%';
    element.style.width = share(end) - share(begin) + '%';
  };

  const show = () => {
    if (!speeds) return;
    const focused = lanes.contains(document.activeElement);
    const ends = [];
    lanes.replaceChildren();
    for (const span of on.spans()) {
      const [begin, end] = on.bounds(span);
      let lane = ends.findIndex(taken => taken <= begin);
      if (lane < 0) lane = ends.push(0) - 1;
      ends[lane] = end;
      const button = document.createElement('button');
      button.type = 'button';
      button.className = 'span' + (span.proposed ? ' proposed' : '') + (span.label ? '' : ' unnamed');
      button.textContent = (span.label || 'no label') + (span.fine_label ? ': ' + span.fine_label : '');
      button.setAttribute('aria-pressed', String(span === on.selected()));
      button.setAttribute('aria-label', button.textContent + ', ' + span.begin_s.toFixed(3) + ' s to ' +
          span.end_s.toFixed(3) + ' s' + (span.proposed ? ', proposed' : ''));
      button.style.setProperty('--hue', on.hue(span.label));
      button.style.top = 2 + 26 * lane + 'px';
      button.span = span;
      place(button, begin, end);
      button.addEventListener('click', () => on.select(span));
      lanes.append(button);
      if (focused && span === on.selected()) button.focus({preventScroll: true});
    }
    lanes.style.height = 2 + 26 * Math.max(1, ends.length) + 'px';
    head.style.left = share(at + 0.5) + '%';
    mark.hidden = marked === null;
    if (marked !== null) mark.style.left = share(marked + 0.5) + '%';
  };

  const drawCurve = () => {
    if (!speeds) return;
    const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const ratio = window.devicePixelRatio || 1, width = curve.clientWidth || 600, height = curve.clientHeight || 92;
    curve.width = Math.round(width * ratio);
    curve.height = Math.round(height * ratio);
    const pen = curve.getContext('2d');
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const floor = height - 16, bin = x => (view[0] + x / width * (view[1] - view[0])) / clip.frames * speeds.length;
    pen.fillStyle = style('--before');
    for (let x = 0; x < width; ++x) {
      const first = Math.floor(bin(x)), end = Math.max(first + 1, Math.floor(bin(x + 1)));
      const tall = (floor - 18) * Math.max(0, ...speeds.subarray(first, end)) / 255;
      pen.fillRect(x, floor - tall, 1, tall);
    }
    pen.fillStyle = pen.strokeStyle = style('--soft');
    pen.font = '11px system-ui, sans-serif';
    const seen_s = (view[1] - view[0]) / clip.hz, from_s = clip.begin_s + view[0] / clip.hz;
    const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600].find(s => s / seen_s * width >= 70) || 1200;
    for (let k = Math.ceil(from_s / step); k * step <= from_s + seen_s; ++k) {
      const x = (k * step - from_s) / seen_s * width;
      pen.fillRect(x, floor, 1, 4);
      pen.fillText((k * step).toFixed(step < 1 ? 1 : 0) + ' s', x + 3, height - 3);
    }
    pen.textAlign = 'right';
    pen.fillText('fastest joint, at most ' + clip.fastest.toFixed(1) + ' m/s', width - 4, 12);
    pen.textAlign = 'left';
  };

  const look = (begin, wide) => {
    begin = clamp(begin, 0, clip.frames - wide);
    view = [begin, begin + wide];
    drawCurve();
    show();
  };
  const zoom = factor => {
    const wide = clamp((view[1] - view[0]) * factor, Math.min(30, clip.frames), clip.frames);
    look(at + 0.5 - wide / 2, wide);
  };

  track.addEventListener('pointerdown', e => {
    if (e.button !== 0) return;
    const button = e.target.closest('.span');
    const span = button ? button.span : null;
    let edge = null;
    if (span) {
      const box = button.getBoundingClientRect(), grip = Math.min(8, box.width / 3);
      edge = e.clientX - box.left < grip ? 0 : box.right - e.clientX < grip ? 1 : null;
      on.select(span);
      if (edge === null) return;
    }
    const from = edge === null ? Math.round(frameAt(e.clientX)) : on.bounds(span)[1 - edge];
    let to = from, moved = false;
    const move = m => {
      if (!moved && Math.abs(m.clientX - e.clientX) < 4) return;
      moved = true;
      to = Math.round(clamp(frameAt(m.clientX), view[0], view[1]));
      on.seek(clamp(to, Math.ceil(view[0]), Math.floor(view[1]) - 1));
      drawn.hidden = false;
      place(drawn, Math.min(from, to), Math.max(from, to));
    };
    const up = u => {
      for (const [type, f] of [['pointermove', move], ['pointerup', up], ['pointercancel', up]])
        document.removeEventListener(type, f);
      drawn.hidden = true;
      if (u.type === 'pointercancel') return;
      if (moved && span) on.adjust(span, edge, to);
      else if (moved) on.create(from, to);
      else if (!span) {
        on.select(null);
        on.seek(Math.min(clip.frames - 1, Math.floor(frameAt(e.clientX))));
      }
    };
    for (const [type, f] of [['pointermove', move], ['pointerup', up], ['pointercancel', up]])
      document.addEventListener(type, f);
  });
  track.addEventListener('wheel', e => {
    if (!e.ctrlKey) return;
    e.preventDefault();
    zoom(e.deltaY > 0 ? 1.25 : 0.8);
  }, {passive: false});
  window.addEventListener('resize', drawCurve);
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawCurve);

  return {
    wake(bytes) { speeds = bytes; drawCurve(); show(); },
    rest() { speeds = null; curve.width = 0; lanes.replaceChildren(); },
    show,
    playhead(frame) {
      at = frame;
      const wide = view[1] - view[0];
      if (at < view[0] || at + 1 > view[1]) look(at < view[0] ? at - 0.9 * wide : at - 0.1 * wide, wide);
      head.style.left = share(at + 0.5) + '%';
    },
    mark(frame) { marked = frame; show(); },
    zoom,
  };
};
