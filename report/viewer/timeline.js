'use strict';
// Bands and curves of the shown motions over time, on a canvas. A click or drag calls seek(seconds).
const mocurateTimeline = (() => {
  const LEFT = 112, ROW = 15, CURVE = 46, TOP = 16, LANES = 3;
  const STATES = ['observed', 'repaired', 'interpolated', 'inferred'];

  /// Speed of the fastest joint, m/s, over 0.2 s; NaN where joints are missing.
  const speeds = motion => {
    const {frames, hz} = motion.clip, J = motion.skeleton.parents.length, half = Math.max(1, Math.round(0.1 * hz));
    const out = new Float32Array(frames), a = new Float32Array(3 * J), b = new Float32Array(3 * J);
    for (let f = 0; f < frames; ++f) {
      const from = Math.max(0, f - half), to = Math.min(frames - 1, f + half);
      motion.joints(from, a);
      motion.joints(to, b);
      let most = 0;
      for (let j = 0; j < J; ++j) {
        const far = Math.hypot(b[3 * j] - a[3 * j], b[3 * j + 1] - a[3 * j + 1], b[3 * j + 2] - a[3 * j + 2]);
        if (far > most) most = far;
      }
      out[f] = to > from ? most * hz / (to - from) : 0;
    }
    return out;
  };

  /// The places of the tracked points at their joints, as a motion.
  const tracked = motion => {
    const {points} = motion.clip, seen = new Float32Array(3 * points.names.length);
    return {...motion, joints: (frame, out) => {
      motion.points(frame, seen);
      out.fill(NaN);
      points.joints.forEach((j, k) => { if (j >= 0) for (let i = 0; i < 3; ++i) out[3 * j + i] = seen[3 * k + i]; });
    }};
  };

  /// Largest difference of a bone's length from its median over the clip, mm.
  const stretch = motion => {
    const F = motion.clip.frames, parents = motion.skeleton.parents, J = parents.length;
    const lengths = parents.map(() => new Float32Array(F)), place = new Float32Array(3 * J), out = new Float32Array(F);
    for (let f = 0; f < F; ++f) {
      motion.joints(f, place);
      parents.forEach((p, j) => {
        if (p >= 0) lengths[j][f] = Math.hypot(...[0, 1, 2].map(i => place[3 * j + i] - place[3 * p + i]));
      });
    }
    parents.forEach((p, j) => {
      if (p < 0) return;
      const sorted = Array.from(lengths[j]).filter(v => v === v).sort((a, b) => a - b);
      const median = sorted[Math.floor(sorted.length / 2)];
      lengths[j].forEach((v, f) => { out[f] = Math.max(out[f], 1000 * Math.abs(v - median) || 0); });
    });
    return out;
  };

  /// Root mean square distance of tracked points from their joints, mm; NaN where none was observed.
  const residuals = motion => {
    const {frames, points} = motion.clip, J = motion.skeleton.parents.length, out = new Float32Array(frames);
    const place = new Float32Array(3 * J), seen = new Float32Array(3 * points.names.length);
    for (let f = 0; f < frames; ++f) {
      motion.joints(f, place);
      motion.points(f, seen);
      let sum = 0, count = 0;
      points.joints.forEach((j, k) => {
        if (j < 0) return;
        const d = Math.hypot(...[0, 1, 2].map(i => place[3 * j + i] - seen[3 * k + i]));
        if (d === d) { sum += d * d; ++count; }
      });
      out[f] = count > 0 ? 1000 * Math.sqrt(sum / count) : NaN;
    }
    return out;
  };

  /// Runs of frames with a value: [{begin, end, value}] in seconds, where value(frame) is not null.
  const runs = (clip, value) => {
    const out = [];
    for (let f = 0; f < clip.frames; ++f) {
      const v = value(f), last = out[out.length - 1];
      if (v === null) continue;
      if (last && last.value === v && Math.abs(last.end - f / clip.hz) < 1e-6) last.end = (f + 1) / clip.hz;
      else out.push({begin: f / clip.hz, end: (f + 1) / clip.hz, value: v});
    }
    return out;
  };

  const build = (canvas, style, seek) => {
    const still = document.createElement('canvas');  // all but the line of the present
    let rows = [], curves = [], length = 1, now = 0, height = 0;
    const width = () => canvas.clientWidth || 600;
    const x = seconds => LEFT + (width() - LEFT - 8) * seconds / length;

    const line = () => {
      const ratio = window.devicePixelRatio || 1, pen = canvas.getContext('2d');
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.clearRect(0, 0, canvas.width, canvas.height);
      if (still.width > 0 && still.height > 0) pen.drawImage(still, 0, 0);
      pen.fillStyle = style('--ink');
      pen.fillRect((x(Math.min(now, length)) - 0.5) * ratio, (TOP - 4) * ratio, 1.5 * ratio, canvas.height);
    };
    const draw = () => {
      const ratio = window.devicePixelRatio || 1, w = width();
      canvas.width = still.width = Math.round(w * ratio);
      canvas.height = still.height = Math.round(height * ratio);
      canvas.style.height = height + 'px';
      const pen = still.getContext('2d');
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.clearRect(0, 0, w, height);
      pen.font = '11px system-ui, sans-serif';
      pen.textBaseline = 'middle';
      const label = (text, y) => {
        pen.fillStyle = style('--soft');
        pen.textAlign = 'right';
        pen.fillText(text, LEFT - 8, y, LEFT - 12);
        pen.textAlign = 'left';
      };
      pen.fillStyle = style('--soft');
      const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60, 120, 300, 600].find(s => x(s) - x(0) > 46) || 1200;
      for (let t = 0; t <= length + 1e-9; t += step) {
        if (x(t) < w - 30) pen.fillText((Math.round(t * 10) / 10) + ' s', x(t), 7);
        pen.fillStyle = style('--grid');
        pen.fillRect(x(t), TOP - 2, 1, height);
        pen.fillStyle = style('--soft');
      }
      let y = TOP;
      for (const row of rows) {
        label(row.name, y + ROW / 2);
        for (const span of row.spans) {
          pen.fillStyle = style(span.colour);
          pen.globalAlpha = span.opacity || 1;
          const from = x(span.begin), to = Math.max(from + 1.5, x(span.end));
          pen.fillRect(from, y + 1, to - from, ROW - 3);
          pen.globalAlpha = 1;
          if (span.text && to - from > 24) {
            pen.save();
            pen.beginPath();
            pen.rect(from, y, to - from - 2, ROW);
            pen.clip();
            pen.fillStyle = style('--card');
            pen.fillText(span.text, from + 4, y + ROW / 2);
            pen.restore();
          }
        }
        y += ROW;
      }
      for (const curve of curves) {
        label(curve.name, y + 10);
        label('max ' + (curve.most >= 10 ? Math.round(curve.most) : curve.most.toFixed(1)) + ' ' + curve.unit, y + 24);
        if (curve.note) label(curve.note, y + 38);
        for (const line of curve.lines) {
          pen.strokeStyle = line.colour;
          pen.lineWidth = 1.3;
          pen.beginPath();
          let open = false;
          for (let f = 0; f < line.values.length; ++f) {
            const v = line.values[f];
            if (v !== v) { open = false; continue; }
            const px = x(f / line.hz), py = y + CURVE - 4 - (CURVE - 8) * v / (curve.top || 1);
            if (open) pen.lineTo(px, py); else pen.moveTo(px, py);
            open = true;
          }
          pen.stroke();
        }
        y += CURVE;
      }
      line();
    };

    /// `motions`: [{motion, name, colour}], the shown ones.
    const show = motions => {
      rows = [];
      const curve = (name, unit, of, before, least) => {
        const line = (m, motion, colour) => ({colour, hz: m.motion.clip.hz, values: of(motion)});
        const lines = motions.flatMap(m => [...(before && m.motion.hasPoints ? [line(m, tracked(m.motion), style('--before'))] : []),
          line(m, m.motion, m.colour)]).filter(one => one.values);
        let most = 0;
        lines.forEach(line => line.values.forEach(v => { if (v > most) most = v; }));
        const grey = before && motions.some(m => m.motion.hasPoints);
        return lines.length > 0 ? [{name, unit, lines, most, top: Math.max(most, least || 0), note: grey ? 'grey: tracked' : ''}] : [];
      };
      length = Math.max(0.1, ...motions.map(m => m.motion.clip.frames / m.motion.clip.hz));
      for (const {motion, name} of motions) {
        const clip = motion.clip, of = motions.length > 1 ? ', ' + name : '';
        const add = (title, spans) => { if (spans.length > 0) rows.push({name: title + of, spans}); };
        const colours = ['--after', '--right', '--good', '--before'], labels = [...new Set(clip.segments.map(s => s[2]))];
        const lanes = (title, spans) => {  // spans may overlap
          let open = spans.sort((a, b) => a.begin - b.begin), lane = 0;
          while (open.length > 0) {
            const placed = [], left = [];
            for (const span of open) {
              if (placed.length === 0 || placed[placed.length - 1].end <= span.begin + 1e-9) placed.push(span);
              else left.push(span);
            }
            if (++lane === LANES) placed.push(...left);
            add(title, placed);
            open = lane === LANES ? [] : left;
          }
        };
        lanes('segments', clip.segments.map(([begin, end, text]) => ({begin, end, text: text || 'unlabelled',
          colour: colours[labels.indexOf(text) % colours.length]})));
        lanes('findings', clip.findings.map(f => ({begin: f.begin_s, end: f.end_s > f.begin_s ? f.end_s : clip.frames / clip.hz,
          text: f.code, colour: f.severity === 'error' ? '--bad' : f.severity === 'warning' ? '--suspect' : '--before'})));
        if (motion.contact) {
          ['left', 'right'].forEach((side, bit) => add(side + ' foot down',
            runs(clip, f => motion.contact[f] >> bit & 1 ? 1 : null).map(run => ({...run, colour: '--' + side}))));
        }
        if (motion.state) {
          const J = motion.skeleton.parents.length;
          ['', '--bad', '--suspect', '--soft'].forEach((colour, state) => {
            if (state === 0) return;
            add(STATES[state], runs(clip, f => {
              let count = 0;
              for (let j = 0; j < J; ++j) if (motion.state[f * J + j] === state) ++count;
              return count > 0 ? count : null;
            }).map(run => ({...run, colour, opacity: 0.25 + 0.75 * run.value / J})));
          });
        }
      }
      curves = [...curve('speed', 'm/s', speeds), ...curve('bone length', 'mm', stretch, true, 5),
        ...curve('residual', 'mm', motion => motion.hasPoints ? residuals(motion) : null)];
      height = TOP + ROW * rows.length + CURVE * curves.length + 4;
      draw();
      return {rows: rows.map(row => row.name), curves: curves.map(c => c.name), length};
    };
    const at = e => seek(Math.max(0, Math.min(length, (e.offsetX - LEFT) / (width() - LEFT - 8) * length)));
    canvas.addEventListener('pointerdown', e => { canvas.setPointerCapture(e.pointerId); at(e); });
    canvas.addEventListener('pointermove', e => { if (e.buttons & 1) at(e); });
    return {show, draw, move: seconds => { now = seconds; line(); }};
  };
  return {build};
})();
