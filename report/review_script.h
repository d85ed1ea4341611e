#pragma once

namespace mocurate {

inline constexpr const char* kReviewStyle = R"css(
.card { scroll-margin-top: 12px; } .decided { border: 2px solid transparent; border-radius: 8px; padding: 6px 10px; }
.decided.here { border-color: var(--after); } .decided h3 { margin-top: 4px; }
.verdicts { display: flex; flex-wrap: wrap; gap: 8px; align-items: center; margin-top: 8px; font-size: 14px; }
.verdicts input, .verdicts select { font: inherit; color: inherit; background: var(--page); border: 1px solid var(--rule);
  border-radius: 6px; padding: 2px 6px; max-width: 200px; } .verdicts input { width: 76px; }
.said { font-weight: 600; } .code { font-size: 14px; border-radius: 6px; padding: 2px 8px; color: #fff; background: #7a5600; }
.code.error { background: #b3392f; } .code.info { background: #5a6470; }
kbd { font: 12px ui-monospace, monospace; border: 1px solid var(--rule); border-radius: 4px; padding: 0 4px; }
textarea { width: 100%; font: 13px ui-monospace, monospace; color: inherit; background: var(--page); border: 1px solid var(--rule);
  border-radius: 8px; padding: 8px; }
)css";

/// Needs kPageToolsScript and kPlayerScript. Reads #review-data: {"dataset", "decisions": [...] made earlier}. One
/// decision per clip, finding and pair. The decisions are in #yaml as YAML, and in the browser's store under the page's
/// name until they are saved. Sets data-review on <html> to the number of clips to decide.
inline constexpr const char* kReviewScript = R"js(
'use strict';
(() => {
  const review = JSON.parse(document.getElementById('review-data').textContent);
  const clips = [...document.querySelectorAll('.decided')];
  const sliders = clips.map(clip => clip.querySelector('input[type=range]'));
  const players = JSON.parse(document.getElementById('player-data').textContent);
  const findingOf = clip => clip.closest('.card').dataset.finding;
  const otherOf = clip => JSON.parse(clip.closest('.card').dataset.pair).find(id => id !== clip.dataset.clip) || '';
  const keyOf = d => [d.clip, d.finding, d.other || ''].join('\n');
  const store = ['mocurate review', review.dataset, JSON.stringify(review.decisions),
    clips.map(c => c.dataset.content).join('')].join('\n');
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
      const d = decisions.get(keyOf({clip: clip.dataset.clip, finding: findingOf(clip), other: otherOf(clip)}));
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
    const d = {clip: clip.dataset.clip, content: clip.dataset.content, finding: findingOf(clip), other: otherOf(clip), decision};
    if (decision === 'relabel') d.label = clip.querySelector('select').value;
    if (decision === 'cut') {
      d.begin = Number(clip.querySelector('.begin').value);
      d.end = Number(clip.querySelector('.end').value);
      const whole = d.begin === 0 && d.end === Number(clip.dataset.frames);
      if (!(d.begin >= 0 && d.begin < d.end && d.end <= Number(clip.dataset.frames))) return say(clip, 'no such frames');
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
  const go = to => {
    if (clips.length === 0) return;
    here = Math.min(clips.length - 1, Math.max(0, to));
    show();
    clips[here].scrollIntoView({block: 'center'});
  };
  const boundary = which => {
    if (clips.length === 0) return;
    const frame = Number(sliders[here].value) * players[here].step;
    clips[here].querySelector(which).value = String(which === '.end' ? Math.min(frame + 1, Number(clips[here].dataset.frames)) : frame);
  };
  const save = () => {
    pageTools.save(yaml(), 'text/yaml', 'decisions.yaml');
    pageTools.forget(store);
  };
  clips.forEach((clip, i) => {
    clip.addEventListener('pointerdown', () => { here = i; clips.forEach((c, k) => c.classList.toggle('here', k === i)); });
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
  document.documentElement.dataset.review = String(clips.length);
})();
)js";

}  // namespace mocurate
