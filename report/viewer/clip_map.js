'use strict';
// A map of clips on a canvas: build(canvas, fields, open) with fields [[name, clip => text]] to colour by. A click, or an
// arrow key, calls open(clip). Returns {show(clips, matching), colour(field), mark(clip), draw}.
const mocurateClipMap = (() => {
  const EDGE = 12, NEAR = 14;  // pixels
  const MOST_NAMED = 12;

  const build = (canvas, legend, fields, style, open) => {
    let clips = [], places = [], matching = new Set(), field = fields[0], marked = null, hues = new Map();
    const size = () => [canvas.clientWidth || 270, canvas.clientHeight || 240];
    const layout = () => {
      const [width, height] = size(), all = clips.map(clip => clip.map);
      const ends = of => [0, 1].map(i => all.reduce((most, p) => of(most, p[i]), all[0][i])), low = ends(Math.min), high = ends(Math.max);
      const scale = [0, 1].map(i => ([width, height][i] - 2 * EDGE) / (high[i] - low[i] || 1));
      places = all.map(p => [EDGE + scale[0] * (p[0] - low[0]), height - EDGE - scale[1] * (p[1] - low[1])]);
    };
    const draw = () => {
      const ratio = window.devicePixelRatio || 1, [width, height] = size(), pen = canvas.getContext('2d');
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      if (clips.length === 0) return;
      layout();
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      const dot = (i, radius) => {
        pen.beginPath();
        pen.arc(places[i][0], places[i][1], radius, 0, 2 * Math.PI);
      };
      for (const bright of [false, true])
        clips.forEach((clip, i) => {
          if (matching.has(clip) !== bright) return;
          dot(i, 3.2);
          pen.fillStyle = bright ? hues.get(field[1](clip)) : style('--grid');
          pen.fill();
        });
      if (clips.includes(marked)) {
        dot(clips.indexOf(marked), 6);
        pen.strokeStyle = style('--ink');
        pen.lineWidth = 2;
        pen.stroke();
      }
    };
    const colour = name => {
      field = fields.find(f => f[0] === name) || fields[0];
      const values = [...new Set(clips.map(field[1]))].sort();
      hues = new Map(values.map((value, i) => [value, 'hsl(' + Math.round(i * 360 / values.length) + ', 62%, ' + (i % 2 ? 42 : 56) + '%)']));
      legend.replaceChildren(...(values.length > MOST_NAMED ? [values.length + ' values: rest the pointer on a dot'] :
        values.map(value => {
          const item = document.createElement('span'), swatch = document.createElement('span');
          swatch.className = 'swatch';
          swatch.style.background = hues.get(value);
          item.append(swatch, value || 'none');
          return item;
        })));
      draw();
    };
    const nearest = (x, y, most) => {
      let best = -1, least = most;
      places.forEach((p, i) => {
        if (!matching.has(clips[i])) return;
        const far = Math.hypot(p[0] - x, p[1] - y);
        if (far < least) { least = far; best = i; }
      });
      return best;
    };
    canvas.addEventListener('click', e => {
      const i = nearest(e.offsetX, e.offsetY, NEAR);
      if (i >= 0) open(clips[i]);
    });
    canvas.addEventListener('pointermove', e => {
      const i = nearest(e.offsetX, e.offsetY, NEAR);
      canvas.title = i < 0 ? '' : clips[i].id + (field[1](clips[i]) ? ' · ' + field[1](clips[i]) : '');
      canvas.style.cursor = i < 0 ? 'default' : 'pointer';
    });
    canvas.addEventListener('keydown', e => {
      const way = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[e.key];
      if (!way || e.shiftKey || clips.length === 0) return;
      e.preventDefault();
      e.stopPropagation();
      if (!clips.includes(marked)) { open(clips[0]); return; }
      const from = places[clips.indexOf(marked)];
      let best = -1, least = Infinity;
      places.forEach((p, i) => {  // the next one in a quarter of the plane
        if (!matching.has(clips[i])) return;
        const along = (p[0] - from[0]) * way[0] + (p[1] - from[1]) * way[1];
        const across = Math.abs((p[0] - from[0]) * way[1]) + Math.abs((p[1] - from[1]) * way[0]);
        if (along > 0.5 && across <= along && along + across < least) { least = along + across; best = i; }
      });
      if (best >= 0) open(clips[best]);
    });
    return {colour, draw, mark: clip => { marked = clip; draw(); },
      show: (all, some) => { clips = all; matching = new Set(some); colour(field[0]); }};
  };
  return {build};
})();
