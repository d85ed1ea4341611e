#pragma once

namespace mocurate {

/// Timelines, cards and the bar of labels, after the styles of all pages and of the review.
inline constexpr const char* kAnnotateStyle = R"css(
[hidden] { display: none !important; }
.track { position: relative; overflow: hidden; border-radius: 8px; background: var(--page); cursor: crosshair;
  user-select: none; touch-action: none; }
.track canvas { display: block; width: 100%; height: 92px; } .lanes { position: relative; min-height: 28px; }
.span { position: absolute; height: 24px; min-width: 4px; padding: 0 5px; overflow: hidden; white-space: nowrap;
  text-align: left; font-size: 13px; line-height: 20px; color: var(--ink); border: 2px solid hsl(var(--hue) 60% 45%);
  background: hsl(var(--hue) 60% 50% / .25); border-radius: 5px; }
.span[aria-pressed=true] { box-shadow: 0 0 0 2px var(--ink) inset; font-weight: 600; }
.span.proposed { border-style: dashed; background: none; }
.span.unnamed { border-color: var(--bad); font-style: italic; }
.playhead, .mark, .drawn { position: absolute; top: 0; bottom: 0; pointer-events: none; }
.playhead { width: 2px; margin-left: -1px; background: var(--ink); } .mark { width: 2px; background: var(--bad); }
.drawn { background: hsl(210 60% 50% / .3); }
.bar { position: sticky; top: 0; z-index: 2; background: var(--card); border-bottom: 1px solid var(--rule);
  padding: 8px 0; }
.bar > div { max-width: 1080px; margin: 0 auto; padding: 0 24px; display: flex; flex-wrap: wrap; gap: 6px 10px;
  align-items: center; font-size: 14px; }
.bar progress { width: 120px; } #message { font-weight: 600; }
#labels { max-height: 92px; overflow-y: auto; padding-top: 6px; }
#labels button { border-left: 8px solid hsl(var(--hue) 60% 45%); }
.annotated:focus { outline: none; } .annotated { content-visibility: auto; contain-intrinsic-size: auto 420px; }
.annotated.done h2::after { content: " done"; color: var(--good); }
.only-undone .annotated.done:not(.here) { display: none; }
.annotated .clip { align-items: start; } .verdicts input.label { width: 136px; }
.annotated .verdicts input[type=number] { width: 80px; } .done-button[aria-pressed=true] { border-color: var(--good); }
)css";

/// Reads the cards of the annotation page and writes spans.csv.
inline constexpr const char* kAnnotateFilesScript = R"js(
'use strict';
const annotateFiles = {
  // Of the script element of that class in a card.
  bytes(root, name) {
    const text = root.querySelector('script.' + name).textContent;
    return Uint8Array.from(atob(text.split(',')[1]), c => c.charCodeAt(0));
  },
  // Rows of x, y, z in mm (report/packed_frames.cpp): the root as three int16, each other joint as three int8 from it.
  poses(root, clip, joints) {
    const bytes = annotateFiles.bytes(root, 'poses'), view = new DataView(bytes.buffer);
    const wide = 6 + 3 * (joints - 1), rows = [];
    for (let from = 0; from + wide <= bytes.length; from += wide) {
      const row = new Float32Array(3 * joints);
      for (let i = 0; i < 3; ++i) row[i] = clip.root_mm * view.getInt16(from + 2 * i, true);
      for (let i = 3; i < row.length; ++i) row[i] = row[i % 3] + clip.joint_mm * view.getInt8(from + 3 + i);
      rows.push(row);
    }
    return rows;
  },
  // Of spans {clip, begin_s, end_s, label, fine_label or none}, in the order of clips and time.
  csv(spans) {
    const order = (a, b) => a < b ? -1 : a > b ? 1 : 0;
    const plain = text => /^'*[=+\-@\t\r]/.test(text) && isNaN(text) ? "'" + text : text;  // core/base/table_text.h
    const quoted = text => /[",\r\n]|^\s|\s$/.test(text) ? '"' + plain(text).replaceAll('"', '""') + '"' : plain(text);
    const hasFine = spans.some(span => span.fine_label);
    const line = span => [quoted(span.clip), span.begin_s.toFixed(3), span.end_s.toFixed(3), quoted(span.label)].concat(
        hasFine ? quoted(span.fine_label || '') : []).join(',') + '\n';
    const byTime = (a, b) => order(a.clip, b.clip) || a.begin_s - b.begin_s || a.end_s - b.end_s ||
        order(a.label, b.label);
    const header = 'clip,begin_s,end_s,label' + (hasFine ? ',fine_label\n' : '\n');
    return header + [...spans].sort(byTime).map(line).join('');
  },
};
)js";

/// mocurateTimeline(root, clip, on): spans of a clip over its speed curve, in the `.track` of `root`. Dragging on an
/// empty area creates a span, dragging an edge moves it, a click moves the playhead. `clip`: {frames, hz, begin_s,
/// fastest}: seconds of the first frame in the recording, m/s of the curve's top. `on`: spans() in order, bounds(span)
/// -> [begin, end] in frames, selected(), hue(label), select(span or null), create(begin, end), adjust(span, edge,
/// frame), seek(frame). Returns {wake(speeds), rest(), show(), playhead(frame), mark(frame or null), zoom(factor)};
/// `speeds` are bytes, 255 times the square root of speed over the fastest.
inline constexpr const char* kTimelineScript = R"js(
'use strict';
const mocurateTimeline = (root, clip, on) => {
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
)js";

/// Reads #annotate-data (annotate_page.cpp); each card contains poses and speeds of its clip, which are decoded while
/// the card is near the window. Seconds of spans are from the first frame of the recording. Marked spans are stored in
/// the browser under the clip's key. "Save" writes spans.csv, which is also in #csv. Sets data-annotate on <html> to
/// the number of cards.
inline constexpr const char* kAnnotateScript = R"js(
'use strict';
(() => {
  const page = JSON.parse(document.getElementById('annotate-data').textContent);
  const find = id => document.getElementById(id);
  const labels = [...page.labels];
  const past = [], future = [];
  let here = 0, selected = null, speed = 1, keeps = true;
  const rounded = seconds => Math.round(seconds * 1000) / 1000;
  const tell = text => { find('message').textContent = text; };
  const keyOf = card => 'mocurate annotate\n' + card.clip.key;
  const hue = label => (Math.max(0, labels.indexOf(label)) * 137.508 + 210) % 360;

  const cards = [...document.querySelectorAll('.annotated')].map((root, i) => {
    const clip = page.clips[i];
    const card = {root, clip, mark: null, asked: '', player: null, awake: false, near: false};
    const kept = pageTools.read(keyOf(card)) || {};
    card.spans = (Array.isArray(kept.spans) ? kept.spans : clip.spans).map(span => ({...span}));
    card.done = kept.done === undefined ? clip.done : kept.done;
    for (const span of card.spans) if (span.label && !labels.includes(span.label)) labels.push(span.label);
    return card;
  });
  const shown = card => !(card.done && find('undone').checked) || card === cards[here];
  const said = (card, text) => { card.root.querySelector('.said').textContent = text; };
  const isHere = span => cards.length > 0 && cards[here].spans.includes(span);
  const bounds = (card, span) => [span.begin_s, span.end_s].map(s => (s - card.clip.begin_s) * card.clip.hz);
  const timeOf = (card, frame) => rounded(card.clip.begin_s + frame / card.clip.hz);
  const frameOf = card => Math.min(card.clip.frames - 1, Math.round(card.player.frame()));

  const showLabels = () => {
    find('labels').replaceChildren(...labels.map((label, i) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.style.setProperty('--hue', hue(label));
      if (i < 10) button.append(Object.assign(document.createElement('kbd'), {textContent: String((i + 1) % 10)}), ' ');
      button.append(label);
      button.addEventListener('click', () => choose(label));
      return button;
    }));
    find('label-names').replaceChildren(
        ...labels.map(label => Object.assign(document.createElement('option'), {value: label})));
  };
  const showCard = card => {
    card.root.classList.toggle('here', card === cards[here]);
    card.root.classList.toggle('done', card.done);
    const marked = card.spans.filter(span => !span.proposed).length, proposed = card.spans.length - marked;
    card.root.querySelector('.marked').textContent = marked + (marked === 1 ? ' span' : ' spans') +
        (proposed > 0 ? ', ' + proposed + ' proposed' : '');
    card.root.querySelector('.done-button').setAttribute('aria-pressed', String(card.done));
    if (!card.awake) return;
    card.timeline.show();
    const span = card.spans.includes(selected) ? selected : null;
    const [label, begin, end] = ['.label', '.begin', '.end'].map(name => card.root.querySelector(name));
    for (const field of [label, begin, end, card.root.querySelector('.remove')]) field.disabled = span === null;
    label.value = card.asked || (span ? span.label : '');
    begin.value = span ? span.begin_s.toFixed(3) : '';
    end.value = span ? span.end_s.toFixed(3) : '';
    card.root.querySelector('.ask').hidden = card.asked === '';
    card.root.querySelector('.asked').textContent = '“' + card.asked + '” is not among the labels.';
  };
  const showProgress = () => {
    const done = cards.filter(card => card.done).length;
    find('progress').value = done;
    find('count').textContent = done + ' of ' + cards.length + (cards.length === 1 ? ' clip done, ' : ' clips done, ') +
        cards.reduce((sum, card) => sum + card.spans.filter(isSaved).length, page.rest.length) + ' spans to save';
    if (find('text').open) showCsv();
  };
  const select = (card, span) => {
    if (selected === span) return;
    selected = span;
    card.asked = '';
    said(card, '');
    cards.filter(c => c.awake).forEach(showCard);
  };

  // Every change of a card's spans goes through here: it can be undone and is kept.
  const stateOf = card => JSON.stringify({spans: card.spans, done: card.done});
  const settle = card => {
    card.spans.sort((a, b) => a.begin_s - b.begin_s || a.end_s - b.end_s);
    if (!pageTools.keep(keyOf(card), {spans: card.spans, done: card.done}) && keeps) {
      keeps = false;
      tell('This browser keeps nothing: save spans.csv before you leave the page.');
    }
    showCard(card);
    showProgress();
  };
  const change = (card, edit) => {
    past.push([card, stateOf(card)]);
    future.length = 0;
    said(card, '');
    edit();
    settle(card);
  };
  const goBack = (from, to) => {
    if (from.length === 0) return;
    const [card, state] = from.pop();
    to.push([card, stateOf(card)]);
    Object.assign(card, JSON.parse(state));
    selected = null;
    settle(card);
    visit(cards.indexOf(card));
  };

  const create = (card, first, last) => {
    const [begin, end] = [Math.min(first, last), Math.max(first, last)];
    if (end - begin < 2) return said(card, 'a span has two frames at least: move the playhead, or drag further');
    const span = {begin_s: timeOf(card, begin), end_s: timeOf(card, end), label: ''};
    change(card, () => { card.spans.push(span); selected = span; });
    said(card, 'choose its label: a digit, or l and type');
  };
  const adjust = (card, span, times) => {
    const [begin, end] = times.map(rounded).sort((a, b) => a - b);
    if (!((end - begin) * card.clip.hz > 1.5)) {
      showCard(card);
      return said(card, 'a span has two frames at least');
    }
    change(card, () => { Object.assign(span, {begin_s: begin, end_s: end}); delete span.proposed; });
  };
  const remove = card => {
    if (!isHere(selected)) return said(card, 'select a span first');
    change(card, () => { card.spans = card.spans.filter(span => span !== selected); selected = null; });
  };
  // The span that is selected, else the shortest one at the playhead.
  const meant = card => isHere(selected) ? selected : card.spans.filter(span => {
    const [begin, end] = bounds(card, span);
    return begin <= frameOf(card) + 0.5 && frameOf(card) + 0.5 < end;
  }).sort((a, b) => a.end_s - a.begin_s - b.end_s + b.begin_s)[0];
  const choose = label => {
    const card = cards[here], span = card && meant(card);
    if (!span) return card && said(card, 'mark or select a span first');
    change(card, () => {
      if (span.label !== label) delete span.fine_label;
      span.label = label;
      delete span.proposed;
      selected = span;
      card.asked = '';
    });
  };
  const accept = card => {
    const span = meant(card);
    if (span && span.label) choose(span.label);
  };
  const nameByTyping = card => {
    const span = meant(card);
    if (!span) return said(card, 'mark or select a span first');
    select(card, span);
    card.root.querySelector('.label').select();
  };
  // A name that is not in the list becomes a label when it is confirmed.
  const propose = (card, text) => {
    const label = text.trim().replace(/[\r\n]+/g, ' ');
    if (label === '' || label === selected.label) card.asked = '';
    else if (labels.includes(label)) return choose(label);
    else card.asked = label;
    said(card, '');
    showCard(card);
    if (card.asked) card.root.querySelector('.add').focus({preventScroll: true});
  };
  const add = card => {
    const label = card.asked;
    if (label === '' || !isHere(selected)) return;
    labels.push(label);
    showLabels();
    choose(label);
    card.root.focus({preventScroll: true});
  };
  const unnamed = card => card.spans.find(span => !span.label && !span.proposed);
  const finish = card => {
    const open = card.done ? null : unnamed(card);
    if (open) { select(card, open); return said(card, 'a span has no label: choose one, or remove it'); }
    change(card, () => {
      card.done = !card.done;
      if (card.done) for (const span of card.spans) if (span.label) delete span.proposed;
    });
    const next = card.done ? cards.findIndex((c, i) => i > here && !c.done) : -1;
    if (next >= 0) visit(next);
  };

  const posesOf = card => annotateFiles.poses(card.root, card.clip, page.joints);
  const wake = card => {
    if (card.awake) return;
    const clip = card.clip;
    card.awake = true;
    if (!card.player) {
      card.drawn = {joints: posesOf(card), points: [], lines: [], bones: page.bones, hz: clip.hz, step: 1,
        thinned: clip.step, count: clip.frames, zero_s: clip.begin_s, follow: true, yaw: clip.yaw, pitch: clip.pitch,
        speed, moved: frame => card.timeline.playhead(Math.round(frame))};
      card.timeline = mocurateTimeline(card.root, clip, {
        spans: () => card.spans, selected: () => selected, hue, bounds: span => bounds(card, span),
        select: span => select(card, span), create: (first, last) => create(card, first, last),
        adjust: (span, edge, frame) =>
            adjust(card, span, [edge === 0 ? span.end_s : span.begin_s, timeOf(card, frame)]),
        seek: frame => { card.player.pause(); card.player.show(frame); }});
      card.player = mocuratePlayer(card.root.querySelector('.player'), card.drawn);
    } else {
      Object.assign(card.drawn, {joints: posesOf(card), away: false});
      card.player.draw();
    }
    card.timeline.wake(annotateFiles.bytes(card.root, 'speeds'));
    showCard(card);
  };
  const rest = card => {
    if (!card.awake || card === cards[here]) return;
    card.awake = false;
    card.player.pause();
    Object.assign(card.drawn, {joints: [], away: true});
    card.root.querySelector('.player canvas').width = 0;
    card.timeline.rest();
  };
  const enter = index => {
    if (index === here) return;
    const before = cards[here];
    here = index;
    selected = null;
    if (before.player) before.player.pause();
    wake(cards[here]);
    if (!before.near) rest(before);
    showCard(before);
    showCard(cards[here]);
  };
  const visit = index => {
    if (index < 0 || index >= cards.length) return;
    enter(index);
    cards[here].root.scrollIntoView({block: 'center'});
    cards[here].root.focus({preventScroll: true});
  };
  const go = step => {
    let index = here + step;
    while (index >= 0 && index < cards.length && !shown(cards[index])) index += step;
    visit(index);
  };

  const seek = (card, frame) => {
    card.player.pause();
    card.player.show(Math.min(card.clip.frames - 1, Math.max(0, frame)));
  };
  // One boundary waits for the other, whichever comes first.
  const boundary = (card, isEnd) => {
    const frame = frameOf(card);
    if (card.mark === null || card.mark.isEnd === isEnd) card.mark = {frame, isEnd};
    else {
      const other = card.mark.frame;
      card.mark = null;
      if (frame === other) create(card, frame, frame);
      else create(card, Math.min(frame, other), Math.max(frame, other) + 1);
    }
    card.timeline.mark(card.mark ? card.mark.frame : null);
  };
  const move = (card, isEnd) => {
    if (!isHere(selected)) return said(card, 'select a span first');
    const time = timeOf(card, frameOf(card) + (isEnd ? 1 : 0));
    adjust(card, selected, isEnd ? [selected.begin_s, time] : [time, selected.end_s]);
  };
  const nextSpan = (card, step) => {
    if (card.spans.length === 0) return;
    const at = card.spans.indexOf(selected), last = card.spans.length - 1;
    const span = card.spans[at < 0 ? (step > 0 ? 0 : last) : Math.min(last, Math.max(0, at + step))];
    select(card, span);
    seek(card, Math.round(bounds(card, span)[0]));
  };
  const leave = card => {
    card.mark = null;
    card.timeline.mark(null);
    select(card, null);
  };
  const hasten = () => {
    speed = {1: 2, 2: 4, 4: 0.5, 0.5: 1}[speed];
    for (const card of cards) if (card.drawn) card.drawn.speed = speed;
    tell('players run at ' + speed + ' times their speed');
  };

  const isSaved = span => span.label !== '' && !span.proposed;
  const rows = () => page.rest.map(span => ({...span})).concat(...cards.map(
      card => card.spans.filter(isSaved).map(span => ({...span, clip: card.clip.recording}))));
  const csv = () => annotateFiles.csv(rows());
  const showCsv = () => { find('csv').value = find('csv').textContent = csv(); };
  const save = () => {
    const open = cards.findIndex(unnamed);
    if (open >= 0) {
      visit(open);
      select(cards[open], unnamed(cards[open]));
      return tell('Not saved: a span of this clip has no label. Choose one, or remove the span.');
    }
    showCsv();
    pageTools.save(csv(), 'text/csv', 'spans.csv');
    const proposed = cards.reduce((sum, card) => sum + card.spans.filter(span => span.proposed).length, 0);
    tell('spans.csv: ' + rows().length + ' spans' +
        (proposed > 0 ? '; ' + proposed + ' proposed ones are not in it' : ''));
  };
  const forget = () => {
    for (const card of cards) {
      pageTools.forget(keyOf(card));
      Object.assign(card, {spans: card.clip.spans.map(span => ({...span})), done: card.clip.done, asked: ''});
    }
    past.length = future.length = 0;
    selected = null;
    cards.forEach(showCard);
    showProgress();
    tell('the page is as it was made');
  };

  cards.forEach((card, i) => {
    const part = name => card.root.querySelector(name);
    for (const type of ['pointerdown', 'focusin']) card.root.addEventListener(type, () => enter(i), true);
    // What is typed is about the span that was selected then.
    for (const field of ['.label', '.begin', '.end'])
      part(field).addEventListener('input', e => { e.target.span = selected; });
    const isAbout = e => isHere(selected) && e.target.span === selected;
    part('.label').addEventListener('change', e => { if (isAbout(e)) propose(card, e.target.value); });
    part('.label').addEventListener('keydown', e => {
      if (e.key === 'Escape') { card.asked = ''; showCard(card); }
      if (e.key === 'Escape' || e.key === 'Enter') { e.preventDefault(); card.root.focus({preventScroll: true}); }
    });
    const setTime = (name, otherOf) => part(name).addEventListener('change', e => {
      if (!isAbout(e)) return;
      const low = card.clip.begin_s, high = low + card.clip.frames / card.clip.hz;
      const typed = e.target.value === '' ? NaN : Number(e.target.value);
      adjust(card, selected, [Math.min(high, Math.max(low, typed)), otherOf(selected)]);
    });
    setTime('.begin', span => span.end_s);
    setTime('.end', span => span.begin_s);
    part('.remove').addEventListener('click', () => remove(card));
    part('.done-button').addEventListener('click', () => finish(card));
    part('.add').addEventListener('click', () => add(card));
    part('.no').addEventListener('click', () => {
      card.asked = '';
      showCard(card);
      card.root.focus({preventScroll: true});
    });
  });
  find('save').addEventListener('click', save);
  find('text').addEventListener('toggle', showCsv);
  find('undone').addEventListener('change', e => document.body.classList.toggle('only-undone', e.target.checked));
  find('forget').addEventListener('click', () => { find('sure').hidden = false; find('sure').focus(); });
  find('sure').addEventListener('click', () => { find('sure').hidden = true; forget(); });

  document.addEventListener('keydown', e => {
    if (pageTools.isTyping(e) || e.defaultPrevented) return;
    const command = pageTools.hasCommand(e), key = command ? 'ctrl-' + e.key.toLowerCase() : e.key;
    const card = cards[here];
    const onButton = e.target.tagName === 'BUTTON' && !e.target.classList.contains('span');
    const undo = () => goBack(past, future), redo = () => goBack(future, past);
    const begin = () => boundary(card, false), end = () => boundary(card, true);
    const always = {'ctrl-z': e.shiftKey ? redo : undo, 'ctrl-y': redo, u: undo, 'ctrl-s': save, s: save, x: hasten,
      f: () => find('undone').click()};
    const ofCard = {j: () => go(1), p: () => go(-1), ArrowLeft: () => seek(card, frameOf(card) - (e.shiftKey ? 10 : 1)),
      ArrowRight: () => seek(card, frameOf(card) + (e.shiftKey ? 10 : 1)), Home: () => seek(card, 0),
      End: () => seek(card, card.clip.frames - 1), '[': begin, b: begin, ']': end, e: end,
      '{': () => move(card, false), B: () => move(card, false), '}': () => move(card, true), E: () => move(card, true),
      ',': () => nextSpan(card, -1), '.': () => nextSpan(card, 1), Delete: () => remove(card),
      Backspace: () => remove(card), Escape: () => leave(card), d: () => finish(card), l: () => nameByTyping(card),
      a: () => accept(card), '+': () => card.timeline.zoom(0.5), '=': () => card.timeline.zoom(0.5),
      '-': () => card.timeline.zoom(2)};
    if (!onButton) ofCard[' '] = () => card.player.toggle();
    for (let i = 0; i < Math.min(10, labels.length); ++i) ofCard[String((i + 1) % 10)] = () => choose(labels[i]);
    const action = always[key] || cards.length > 0 && ofCard[key];
    if (!action) return;
    e.preventDefault();
    action();
  });

  showLabels();
  const watch = new IntersectionObserver(entries => {
    for (const entry of entries) {
      const card = cards.find(one => one.root === entry.target);
      card.near = entry.isIntersecting;
      (card.near ? wake : rest)(card);
    }
  }, {rootMargin: '600px'});
  cards.forEach(card => watch.observe(card.root));
  if (cards.length > 0) wake(cards[0]);
  cards.forEach(showCard);
  showProgress();
  document.documentElement.dataset.annotate = String(cards.length);
})();
)js";

}  // namespace mocurate
