'use strict';
// Needs page_tools.js and the viewer. Reads #review-data: {"dataset", "decisions": [...] made earlier}. One decision per
// clip, finding and pair. The decisions are in #yaml as YAML, and in the browser's store under the page's name until they
// are saved. Sets data-review on <html> to the number of clips to decide. `theViewer` shows the clips of a card.
const theViewer = (() => {
  const index = JSON.parse(document.getElementById('viewer-index').textContent), root = document.getElementById('viewer');
  return index.clips.length > 0 ? mocurateViewer(root, index) : null;
})();
(() => {
  const review = JSON.parse(document.getElementById('review-data').textContent), find = id => document.getElementById(id);
  const make = (name, attributes, ...inside) => {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.append(...inside);
    return element;
  };
  const number = (name, value, most) => make('label', {}, name + ' ',
    make('input', {type: 'number', class: name, min: 0, max: most, value}));
  const verdict = (name, key) => make('button', {type: 'button', 'data-verdict': name}, name + ' ', make('kbd', {}, key));
  const plural = (count, noun) => count + ' ' + noun + (count === 1 ? '' : 's');
  const clips = [], about = new Map();  // elements, and what they show: {clip, card, other}
  const clipElement = (clip, card) => {
    const choice = make('select', {'aria-label': 'New class'}, make('option', {value: ''}, 'choose a class'),
      ...review.labels.map(label => make('option', {}, label)));
    choice.value = [card.suggested, clip.label].find(label => review.labels.includes(label)) || '';
    const strip = make('div', {});
    strip.innerHTML = clip.strip;
    const element = make('div', {class: 'decided', 'data-clip': clip.id}, make('h3', {}, clip.id), make('p', {class: 'soft'},
      (clip.label ? 'labelled ' + clip.label : 'without a label') + ', ' + plural(clip.frames, 'frame') + ' at ' + Math.round(1000 * clip.hz) / 1000 + ' Hz' +
      (clip.shown_hz ? ', shown at ' + Math.round(10 * clip.shown_hz) / 10 + ' Hz' : '') + (clip.person ? ', person ' + clip.person : '')), strip, make('div', {class: 'verdicts'}, verdict('keep', 'k'),
      verdict('drop', 'd'), verdict('relabel', 'r'), choice, verdict('cut', 'c'), number('begin', 0, clip.frames),
      number('end', clip.frames, clip.frames), make('span', {class: 'said', 'aria-live': 'polite'})));
    const other = card.clips.find(one => one.id !== clip.id);
    about.set(element, {clip, card, other: other ? other.id : ''});
    clips.push(element);
    return element;
  };
  find('cards').append(...(review.about_set.length === 0 ? [] : [make('section', {}, make('h2', {}, 'About the set'),
    make('ul', {}, ...review.about_set.map(message => make('li', {}, message))))]), ...review.cards.map((card, i) =>
    make('section', {class: 'card'}, make('h2', {}, make('span', {class: 'code ' + card.severity}, card.code), ' ' + (i + 1) + ' of ' +
      review.cards.length), make('p', {}, card.message), ...card.clips.map(clip => clipElement(clip, card)))));
  if (review.cards.length + review.about_set.length === 0) find('cards').append(make('section', {}, 'Nothing was found.'));
  document.querySelector('h1').textContent = 'Review of ' + review.dataset;
  document.querySelector('.lead').textContent = plural(review.cards.length, 'finding') +
    (review.not_shown > 0 ? ', ' + review.not_shown + ' more are not shown' : '');
  const keyOf = d => [d.clip, d.finding, d.other || ''].join('\n');
  const store = ['mocurate review', review.dataset, JSON.stringify(review.decisions),
    clips.map(c => about.get(c).clip.content).join('')].join('\n');
  const decisions = new Map();
  const past = [];
  let here = 0;

  const yaml = () => {
    const text = value => JSON.stringify(value).replaceAll('${', '$${');
    let lines = 'dataset: ' + text(review.dataset) + '\ndecisions:' + (decisions.size === 0 ? ' []' : '') + '\n';
    for (const d of decisions.values()) {
      lines += '  - clip: ' + text(d.clip) + '\n    content: ' + text(d.content) + '\n    finding: ' + text(d.finding) +
          (d.other ? '\n    other: ' + text(d.other) : '') + '\n    decision: ' + d.decision + '\n';
      if (d.decision === 'relabel') lines += '    label: ' + text(d.label) + '\n';
      if (d.decision === 'cut') lines += '    begin: ' + d.begin + '\n    end: ' + d.end + '\n';
      if (d.note) lines += '    note: ' + text(d.note) + '\n';
    }
    return lines;
  };
  const words = d => !d ? '' : d.decision === 'relabel' ? 'relabel: ' + d.label :
      d.decision === 'cut' ? 'cut: ' + d.begin + ' to ' + d.end : d.decision;
  const show = () => {
    clips.forEach((clip, i) => {
      const {card, other} = about.get(clip), d = decisions.get(keyOf({clip: clip.dataset.clip, finding: card.code, other}));
      clip.querySelector('.said').textContent = words(d);
      clip.classList.toggle('here', i === here);
    });
    document.getElementById('yaml').value = yaml();
    document.getElementById('yaml').textContent = yaml();
    document.getElementById('count').textContent = decisions.size === 1 ? '1 decision' : decisions.size + ' decisions';
    pageTools.keep(store, [...decisions.values()]);
  };
  const remember = () => past.push(JSON.stringify([...decisions.values()]));
  const take = list => { decisions.clear(); for (const d of list) decisions.set(keyOf(d), d); };
  const say = (clip, message) => { clip.querySelector('.said').textContent = message; };
  const decide = (clip, decision) => {
    const {clip: {id, content, frames}, card, other} = about.get(clip);
    const d = {clip: id, content, finding: card.code, other, decision};
    if (decision === 'relabel') d.label = clip.querySelector('select').value;
    if (d.label === '') return say(clip, 'choose a class first');
    if (decision === 'cut') {
      d.begin = Number(clip.querySelector('.begin').value);
      d.end = Number(clip.querySelector('.end').value);
      const whole = d.begin === 0 && d.end === frames;
      if (!(d.begin >= 0 && d.begin < d.end && d.end <= frames)) return say(clip, 'no such frames');
      if (whole) return say(clip, 'move a boundary first');
    }
    const others = [...decisions.values()].filter(
        o => o.clip === d.clip && (!o.content || o.content === d.content) && keyOf(o) !== keyOf(d) && o.decision !== 'keep');
    const clash = decision === 'keep' ? null : others.find(
        o => (o.decision === 'drop') !== (decision === 'drop') || o.decision === decision && words(o) !== words(d));
    if (clash) return say(clip, 'decided otherwise under ' + clash.finding + ': ' + words(clash));
    remember();
    // What was decided about another motion under this id no longer holds.
    for (const [key, o] of [...decisions]) if (o.clip === d.clip && o.content && o.content !== d.content) decisions.delete(key);
    decisions.set(keyOf(d), d);
    show();
  };
  const root = find('viewer'), narrow = () => window.innerWidth <= 1000;
  let seen = null;  // the card in the viewer
  const look = () => {
    const {card} = about.get(clips[here]);
    if (card !== seen) theViewer.open(card.group, card.at);
    seen = card;
  };
  const go = to => {
    if (clips.length === 0) return;
    here = Math.min(clips.length - 1, Math.max(0, to));
    show();
    look();
    clips[here].scrollIntoView({block: narrow() ? 'start' : 'center'});
  };
  // Where the reader has scrolled away, the first clip in sight is the one that keys decide about.
  let settled = 0;
  window.addEventListener('scroll', () => {
    clearTimeout(settled);
    settled = setTimeout(() => {
      const top = narrow() ? root.getBoundingClientRect().bottom : 0;
      const inSight = clip => { const box = clip.getBoundingClientRect(); return box.bottom > top + 60 && box.top < window.innerHeight - 60; };
      if (clips.length === 0 || inSight(clips[here])) return;
      const first = clips.findIndex(inSight);
      if (first < 0) return;
      here = first;
      show();
      look();
    }, 120);
  }, {passive: true});
  const boundary = which => {
    if (clips.length === 0) return;
    const {frames, hz} = about.get(clips[here]).clip;
    const frame = Math.min(frames - 1, Math.round(theViewer.state.time * hz));
    clips[here].querySelector(which).value = String(which === '.end' ? frame + 1 : frame);
  };
  const save = () => {
    pageTools.save(yaml(), 'text/yaml', 'decisions.yaml');
    pageTools.forget(store);
  };
  clips.forEach((clip, i) => {
    for (const type of ['pointerdown', 'focusin']) clip.addEventListener(type, () => {
      here = i;
      clips.forEach((c, k) => c.classList.toggle('here', k === i));
      look();
    });
    clip.querySelectorAll('button[data-verdict]').forEach(button => button.addEventListener('click', () => {
      here = i;
      decide(clip, button.dataset.verdict);
    }));
  });
  document.getElementById('save').addEventListener('click', save);
  document.addEventListener('keydown', e => {
    if (pageTools.hasCommand(e) || pageTools.isTyping(e)) return;
    const keys = {j: () => go(here + 1), p: () => go(here - 1), '[': () => boundary('.begin'), ']': () => boundary('.end'),
      u: () => { if (past.length > 0) { take(JSON.parse(past.pop())); show(); } }, s: save};
    const verdict = {k: 'keep', d: 'drop', r: 'relabel', c: 'cut'}[e.key];
    if (verdict && clips.length > 0) decide(clips[here], verdict);
    else if (keys[e.key]) keys[e.key]();
    else return;
    e.preventDefault();
  });
  take(pageTools.read(store) || review.decisions);
  show();
  if (clips.length > 0) look();
  document.documentElement.dataset.review = String(clips.length);
})();
