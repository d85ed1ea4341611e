#pragma once

namespace mocurate {

/// One question at a time, after the styles of all pages and of the review.
inline constexpr const char* kSurveyStyle = R"css(
[hidden] { display: none !important; }
header, main, footer, .bar > div { max-width: 1300px; }
.bar { position: sticky; top: 0; z-index: 2; background: var(--card); border-bottom: 1px solid var(--rule);
  padding: 8px 0; }
.bar > div { margin: 0 auto; padding: 0 24px; display: flex; flex-wrap: wrap; gap: 6px 10px; align-items: center;
  font-size: 14px; }
.bar progress { width: 120px; } #message { font-weight: 600; } button { min-height: 44px; }
#participant { font: inherit; color: inherit; background: var(--page); border: 1px solid var(--rule);
  border-radius: 6px; padding: 2px 6px; width: 150px; height: 44px; } #participant:invalid { border-color: var(--bad); }
.question, #end { scroll-margin-top: 110px; } .question:focus, #end:focus { outline: none; } h3 { margin: 0 0 4px; }
.clips { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(300px, 44%), 1fr)); gap: 18px 12px; }
.shown { position: relative; border: 2px solid transparent; border-radius: 10px; padding: 6px; min-width: 0; }
.shown.here { border-color: var(--after); }
.shown .player canvas { height: 260px; touch-action: pan-y; }
.shown[data-rank]::after { content: attr(data-rank); position: absolute; top: 36px; left: 14px; min-width: 36px;
  border-radius: 18px; background: var(--after); color: var(--card); font: 600 20px/36px system-ui, sans-serif;
  text-align: center; }
.choices { display: flex; flex-wrap: wrap; gap: 6px; margin-top: 6px; } .answer { flex: 1 1 40%; min-width: max-content; padding: 2px 6px; }
.answer[aria-pressed=true] { border-color: var(--after); box-shadow: 0 0 0 1px var(--after) inset; font-weight: 600; }
@media (max-width: 760px) { section { padding: 12px 8px; } .bar > div { padding: 0 14px; } .bar progress, .bar kbd { display: none; }
  .shown { padding: 4px; } .shown .player canvas { height: 190px; } .controls output { display: none; } }
)css";

/// What kSurveyScript fills in. A template with the id "player" must follow.
inline constexpr const char* kSurveyBody = R"html(<header>
<h1></h1><p class="lead"></p><p class="soft" id="keys"></p>
</header>
<div class="bar"><div><progress id="progress" value="0" aria-label="Questions answered"></progress>
<span id="count"></span><button type="button" id="back">Back <kbd>b</kbd></button>
<button type="button" id="next">Next <kbd>n</kbd></button>
<button type="button" id="save">Save <kbd>s</kbd></button>
<span id="message" aria-live="polite"></span></div></div>
<main id="main">
<section id="no-webgl" hidden><h2>This browser cannot draw the bodies</h2>
<p>WebGL is switched off or missing. Open the page in another browser, or switch on hardware acceleration in the
settings of this one, then load the page again.</p></section>
<div id="questions"></div>
<section id="end" tabindex="-1" hidden><h2>That was the last question</h2>
<p id="finished"></p><p class="soft">Save the answers and send the file to whoever asked you.</p></section>
<section id="saving"><p><label>Participant: letters, digits, _ and - <input type="text" id="participant" maxlength="40"
pattern="[A-Za-z0-9_\-]+" autocomplete="off"></label></p>
<details id="text"><summary>The answers as text</summary>
<textarea id="answers" readonly rows="12" aria-label="Answers as JSON"></textarea></details>
<p><button type="button" id="forget">Begin again for another person</button>
<button type="button" id="sure" hidden>Yes, forget these answers</button></p></section>
</main>
)html";

/// Needs kPageToolsScript and kPlayerScript, and kSkinScript where there is a body. Reads #survey-data: {"survey",
/// "kind", "body" or null, "questions": [{"id", "label", "motions"}]}. Answers, also half-filled ones, are in the
/// browser's store under the survey's id until another person begins. "Save" writes answers_PARTICIPANT.json, which is
/// also in #answers: {"survey", "participant", "answers": [{"question", "answer"}], "missing": [questions]}; `answer`
/// has a rank, or "real" or "generated", of each motion in the order of the page. Half-filled ones are missing. Sets
/// data-survey on <html> to the number of questions.
inline constexpr const char* kSurveyScript = R"js(
'use strict';
(() => {
  const page = JSON.parse(document.getElementById('survey-data').textContent);
  const find = id => document.getElementById(id);
  const ranking = page.kind === 'ranking', total = page.questions.length;
  const choices = ranking ? [['', '']] : [['real', 'Real'], ['generated', 'Generated']];
  document.querySelector('h1').textContent = ranking ? 'Rank the motions' : 'Real or generated?';
  document.querySelector('.lead').textContent = ranking ?
      'Each question shows motions that a program made or that were recorded from people. Rank them by their quality ' +
          'and by how well they fit the label: rank 1 is the best. Please answer every question.' :
      'Each motion was recorded from a person, or generated by a program. Decide which by how it looks. Judge each ' +
          'motion by itself: do not compare them with one another. Please answer every question.';
  find('keys').textContent = (ranking ?
      'Tap the button of a motion, or press its number, to give it the next free rank, the best first. Once more takes ' +
          'the rank away, and later ones move up. Enter continues when all are ranked.' :
      'Tap Real or Generated, or press r or g for the framed motion; its number selects a motion. Enter continues when ' +
          'all are judged.') +
      ' Space plays and pauses, b goes back, n continues, s saves. Drag a figure to rotate it. Answers stay in this ' +
      'browser until you save them as a file.';

  const skin = page.body && mocurateSkin(page.body);
  if (page.body && !skin) {
    find('no-webgl').hidden = false;
    find('saving').hidden = document.querySelector('.bar').hidden = true;
    return;
  }
  const store = 'mocurate survey\n' + page.survey;
  const tell = text => { find('message').textContent = text; };
  const anybody = () => 'p' + [...crypto.getRandomValues(new Uint8Array(4))].map(
      byte => byte.toString(16).padStart(2, '0')).join('');
  const kept = pageTools.read(store) || {};
  // Of each question: motions in the order of their ranks, or the judgement of each motion or null.
  const empty = question => ranking ? [] : question.motions.map(() => null);
  const isSound = (list, count) => Array.isArray(list) && (ranking ?
      new Set(list).size === list.length && list.every(i => Number.isInteger(i) && i >= 0 && i < count) :
      list.length === count && list.every(one => [null, 'real', 'generated'].includes(one)));
  const given = new Map(page.questions.map(q => {
    const own = (kept.given || {})[q.id];
    return [q.id, isSound(own, q.motions.length) ? own : empty(q)];
  }));
  const answerOf = question => {
    const own = given.get(question.id);
    if (own.length < question.motions.length || own.includes(null)) return null;
    return ranking ? own.map((_, i) => own.indexOf(i) + 1) : own;
  };
  let participant = kept.participant || anybody();
  let here = -1, asked = false, selected = 0;

  const element = (tag, name, text, parent) => {
    const made = document.createElement(tag);
    made.className = name;
    made.textContent = text;
    if (parent) parent.append(made);
    return made;
  };
  // Each question that was looked at: its section, motions and players.
  const built = new Map();
  const build = index => {
    const question = page.questions[index];
    const section = element('section', 'question', '', find('questions'));
    section.tabIndex = -1;
    section.setAttribute('aria-label', 'Question ' + (index + 1) + ' of ' + total);
    element('p', 'soft', 'Question ' + (index + 1) + ' of ' + total, section);
    element('h2', '', (ranking ? 'Rank these motions: ' : 'Real or generated: ') + question.label.replaceAll('_', ' '), section);
    element('p', 'soft', ranking ? 'Which has the best quality and fits the label best? The best is first.' :
        'Judge each motion by itself. Do not compare them with one another.', section);
    const clips = element('div', 'clips', '', section);
    const drawn = question.motions.map(motion => skin ? skin.clipOf(motion) : {...motion});
    const radius = Math.max(...drawn.map(clip => mocuratePlayer.extent({...clip, follow: true}).radius));  // one scale
    const shown = question.motions.map((motion, i) => {
      const root = element('div', 'shown', '', clips), name = 'Motion ' + (i + 1);
      const title = element('h3', '', name + ' ', root);
      element('kbd', '', String(i + 1), title);
      root.append(find('player').content.cloneNode(true));
      for (const part of root.querySelectorAll('[id]')) part.removeAttribute('id');
      for (const part of root.querySelectorAll('[aria-label]'))
        part.setAttribute('aria-label', part.getAttribute('aria-label').replace('this motion', name));
      const row = element('div', 'choices', '', root);
      for (const [choice, text] of choices) {
        const button = element('button', 'answer', text, row);
        button.type = 'button';
        button.dataset.choice = choice;
        button.addEventListener('click', () => answer(i, choice));
      }
      const clip = {...drawn[i], follow: true, radius};
      const one = {root, name, clip, player: mocuratePlayer(root.querySelector('.player'), clip), plays: false};
      // The players' own buttons act on one motion: what the key does next follows the first.
      root.querySelector('.controls button').addEventListener('click', () => { one.plays = !one.plays; }, true);
      return one;
    });
    built.set(index, {section, shown});
  };
  const play = (index, plays) => {
    for (const one of built.get(index).shown) {
      one.clip.away = !plays && index !== here;
      if (one.plays !== plays) one.player[plays ? 'toggle' : 'pause']();
      one.plays = plays;
    }
  };

  const missing = () => page.questions.filter(q => !answerOf(q)).map(q => q.id);
  const json = () => JSON.stringify({survey: page.survey, participant,
    answers: page.questions.filter(answerOf).map(q => ({question: q.id, answer: answerOf(q)})),
    missing: missing()}, null, 1) + '\n';
  const show = () => {
    const open = missing();
    find('progress').max = total;
    find('progress').value = total - open.length;
    find('count').textContent = total - open.length + ' of ' + total + ' answered';
    find('back').disabled = here === 0;
    find('next').disabled = here === total;
    find('participant').value = participant;
    find('finished').textContent = open.length === 0 ? 'All questions are answered.' :
        open.length + (open.length === 1 ? ' question is' : ' questions are') + ' not answered: ' + open.join(', ');
    if (here < total) built.get(here).shown.forEach((one, i) => {
      const own = given.get(page.questions[here].id), rank = own.indexOf(i) + 1;
      one.root.classList.toggle('here', !ranking && i === selected);
      if (ranking && rank > 0) one.root.dataset.rank = rank; else delete one.root.dataset.rank;
      for (const button of one.root.querySelectorAll('.answer')) {
        const state = ranking ? rank > 0 ? 'rank ' + rank : 'not ranked' : button.dataset.choice;
        if (ranking) button.textContent = rank > 0 ? 'Rank ' + rank : 'Not ranked';
        button.setAttribute('aria-label', one.name + ': ' + state);
        button.setAttribute('aria-pressed', String(ranking ? rank > 0 : own[i] === button.dataset.choice));
      }
    });
    if (find('text').open) find('answers').value = json();
  };
  const keep = () => {
    if (!pageTools.keep(store, {participant, given: Object.fromEntries(given)}))
      tell('This browser keeps nothing: save the answers before you leave the page.');
  };
  const visit = index => {
    const to = Math.min(total, Math.max(0, index));
    if (to === here) return;
    const before = here;
    here = to;
    selected = 0;
    if (before >= 0 && before < total) {
      play(before, false);
      built.get(before).section.hidden = true;
    }
    if (here < total && !built.has(here)) build(here);
    const section = here < total ? built.get(here).section : find('end');
    find('end').hidden = here < total;
    section.hidden = false;
    if (here < total) play(here, true);
    section.focus({preventScroll: true});
    if (before >= 0) section.scrollIntoView();
    show();
  };
  const go = step => { asked = false; tell(''); visit(here + step); };
  const answer = (i, choice) => {
    if (here >= total || i >= page.questions[here].motions.length) return;
    const own = given.get(page.questions[here].id);
    tell('');
    if (ranking && own.includes(i)) own.splice(own.indexOf(i), 1);
    else if (ranking) own.push(i);
    else {
      own[i] = choice;
      const open = own.findIndex((one, k) => one === null && k > i);
      selected = open >= 0 ? open : Math.max(0, own.indexOf(null));
    }
    show();
    if (answerOf(page.questions[here])) {
      tell((ranking ? 'All are ranked.' : 'All are judged.') + ' Enter or Next continues.');
      find('next').focus({preventScroll: true});
    }
    keep();
  };
  const digit = i => {
    if (ranking) return answer(i, '');
    if (here < total && i < page.questions[here].motions.length) { selected = i; show(); }
  };
  const enter = () => {
    if (here >= total || answerOf(page.questions[here])) return go(1);
    tell((ranking ? 'Not all are ranked.' : 'Not all are judged.') + ' n continues all the same.');
  };
  const toggle = () => { if (here < total) play(here, !built.get(here).shown[0].plays); };
  // A file with questions left open is saved when "Save" is pressed once more.
  const save = () => {
    const open = missing();
    if (!find('participant').checkValidity() || participant === '')
      return tell('Not saved: the participant may have letters, digits, _ and - only.');
    if (open.length > 0 && !asked) {
      visit(page.questions.findIndex(q => q.id === open[0]));
      asked = true;
      return tell('Not saved: ' + open.length + (open.length === 1 ? ' question is' : ' questions are') +
          ' not answered. Save once more to save without.');
    }
    asked = false;
    find('answers').value = find('answers').textContent = json();
    pageTools.save(json(), 'application/json', 'answers_' + participant + '.json');
    tell('answers_' + participant + '.json: ' + (total - open.length) + ' answers' +
        (open.length > 0 ? '; not answered: ' + open.join(', ') : ''));
  };
  const forget = () => {
    pageTools.forget(store);
    for (const question of page.questions) given.set(question.id, empty(question));
    participant = anybody();
    go(-total);
    show();
    tell('The page is as it was made.');
  };

  find('back').addEventListener('click', () => go(-1));
  find('next').addEventListener('click', () => go(1));
  find('save').addEventListener('click', save);
  find('text').addEventListener('toggle', show);
  find('participant').addEventListener('input', e => { participant = e.target.value.trim(); keep(); });
  find('forget').addEventListener('click', () => { find('sure').hidden = false; });
  find('sure').addEventListener('click', () => { find('sure').hidden = true; forget(); });
  const keys = {b: () => go(-1), n: () => go(1), Backspace: () => go(-1), s: save, ' ': toggle, Enter: enter};
  if (!ranking) for (const [choice] of choices) keys[choice[0]] = () => answer(selected, choice);
  for (let i = 0; i < 9; ++i) keys[i + 1] = () => digit(i);
  document.addEventListener('keydown', e => {
    if (pageTools.hasCommand(e) || pageTools.isTyping(e) || e.repeat) return;
    if ((e.key === ' ' || e.key === 'Enter') && /^(BUTTON|SUMMARY)$/.test(e.target.tagName)) return;  // presses it
    if (!keys[e.key]) return;
    e.preventDefault();
    keys[e.key]();
  });

  const first = page.questions.findIndex(q => !answerOf(q));
  visit(first < 0 ? total : first);
  document.documentElement.dataset.survey = String(total);
})();
)js";

}  // namespace mocurate
