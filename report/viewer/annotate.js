'use strict';
// Reads #annotate-data (annotate_page.cpp) and the motions of #viewer-index, which are decoded while the card of their clip
// is near the window. Seconds of spans are from the first frame of the recording. Marked spans are stored in
// the browser under the clip's key. "Save" writes spans.csv, which is also in #csv. Sets data-annotate on <html> to
// the number of cards.
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

  const index = JSON.parse(find('viewer-index').textContent), clipOf = mocurateDrawn({...index, skins: []});
  const plural = (count, noun) => count + ' ' + noun + (count === 1 ? '' : 's');
  document.querySelector('h1').textContent = 'Annotate ' + page.dataset;
  document.querySelector('.lead').textContent = plural(page.clips.length, 'clip') + '; players show ' +
    Math.round(10 * Math.min(...page.clips.map(clip => clip.hz / clip.step))) / 10 +
    ' poses a second or more, times and the speed curve have every frame';
  find('progress').max = Math.max(1, page.clips.length);
  const cards = page.clips.map((clip, i) => {
    find('cards').append(find('card').content.cloneNode(true));
    const root = find('cards').lastElementChild, set = (name, text) => { root.querySelector(name).textContent = text; };
    root.setAttribute('aria-label', clip.clip);
    root.querySelector('.track').setAttribute('aria-label', 'Spans of ' + clip.clip);
    set('.name', clip.clip);
    set('.place', i + 1 + ' of ' + page.clips.length);
    set('.facts', (clip.frames / clip.hz).toFixed(1) + ' s' + (clip.begin_s > 0 ? ', from ' + clip.begin_s.toFixed(2) +
      ' s of its recording' : '') + ', ' + plural(clip.frames, 'frame') + ' at ' + Math.round(1000 * clip.hz) / 1000 + ' Hz' +
      (clip.person ? ', person ' + clip.person : '') + (clip.label ? ', labelled ' + clip.label : ''));
    root.querySelector('.player-place').append(find('player').content.cloneNode(true));
    for (const part of root.querySelectorAll('.player, .player [aria-label]'))
      part.setAttribute('aria-label', part.getAttribute('aria-label').replace('this clip', clip.clip));
    const card = {root, clip, number: i, mark: null, asked: '', player: null, awake: false, near: false};
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

  const posesOf = card => {
    const clip = index.clips[card.number];
    return mocurateParts.read(index, clip.place[0])
      .then(buffer => clipOf(mocurateClip(clip, index.skeletons[clip.skeleton], buffer)));
  };
  const wake = card => {
    if (card.awake) return;
    const clip = card.clip;
    card.awake = true;
    if (!card.player) {
      card.drawn = {joints: [], bones: [], hz: clip.hz, away: true, thinned: clip.step, count: clip.frames, zero_s: clip.begin_s,
        follow: true, speed, yaw: index.clips[card.number].yaw + 0.45, pitch: 0.12,
        moved: frame => card.timeline.playhead(Math.round(frame))};
      card.timeline = mocurateSpanTrack(card.root, clip, {
        spans: () => card.spans, selected: () => selected, hue, bounds: span => bounds(card, span),
        select: span => select(card, span), create: (first, last) => create(card, first, last),
        adjust: (span, edge, frame) =>
            adjust(card, span, [edge === 0 ? span.end_s : span.begin_s, timeOf(card, frame)]),
        seek: frame => { card.player.pause(); card.player.show(frame); }});
      card.player = mocuratePlayer(card.root.querySelector('.player'), card.drawn);
    }
    posesOf(card).then(({joints, bones}) => {
      if (!card.awake) return;
      Object.assign(card.drawn, {joints, bones, away: false});
      card.player.draw();
    }).catch(problem => tell(problem.message));
    card.timeline.wake(annotateFiles.bytes(card.clip.speeds));
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
