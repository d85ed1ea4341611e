#pragma once

namespace mocurate {

/// One question at a time, after the styles of all pages and of the review.
inline constexpr const char* kSurveyStyle = R"css(
[hidden] { display: none !important; }
.bar { position: sticky; top: 0; z-index: 2; background: var(--card); border-bottom: 1px solid var(--rule);
  padding: 8px 0; }
.bar > div { max-width: 1080px; margin: 0 auto; padding: 0 24px; display: flex; flex-wrap: wrap; gap: 6px 10px;
  align-items: center; font-size: 14px; }
.bar progress { width: 120px; } #message { font-weight: 600; }
.bar input { font: inherit; color: inherit; background: var(--page); border: 1px solid var(--rule); border-radius: 6px;
  padding: 2px 6px; width: 130px; } .bar input:invalid { border-color: var(--bad); }
.question:focus, #end:focus { outline: none; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 18px; }
.shown .player canvas { height: 360px; } .question > .shown { max-width: 560px; }
.answer { margin-top: 12px; padding: 8px 18px; } .pair .answer { width: 100%; }
.answer[aria-pressed=true] { border-color: var(--after); box-shadow: 0 0 0 1px var(--after) inset; font-weight: 600; }
)css";

/// Needs kPageToolsScript and kPlayerScript. Reads #survey-data: {"survey", "answers": [first, second], "questions":
/// [{"id", "motions"}]}. Answers are in the browser's store under the survey's id until another person begins. "Save"
/// writes answers_PARTICIPANT.json, which is also in #answers: {"survey", "participant", "answers": [{"question",
/// "answer"}], "missing": [questions]}. Sets data-survey on <html> to the number of questions.
inline constexpr const char* kSurveyScript = R"js(
'use strict';
(() => {
  const page = JSON.parse(document.getElementById('survey-data').textContent);
  const find = id => document.getElementById(id);
  const sections = [...document.querySelectorAll('.question')];
  const store = 'mocurate survey\n' + page.survey;
  const tell = text => { find('message').textContent = text; };
  const anybody = () => 'p' + [...crypto.getRandomValues(new Uint8Array(4))].map(
      byte => byte.toString(16).padStart(2, '0')).join('');
  const kept = pageTools.read(store) || {};
  const answers = new Map(Object.entries(kept.answers || {}).filter(
      ([id, answer]) => page.questions.some(q => q.id === id) && page.answers.includes(answer)));
  let participant = kept.participant || anybody();
  let here = -1, asked = false;

  const players = new Map();  // of each question that was looked at: [{player, clip, plays}]
  const playersOf = index => {
    if (!players.has(index)) {
      const roots = [...sections[index].querySelectorAll('.player')];
      players.set(index, page.questions[index].motions.map((motion, i) => {
        const clip = {...motion, follow: true};
        return {clip, player: mocuratePlayer(roots[i], clip), plays: false};
      }));
    }
    return players.get(index);
  };
  const play = (index, plays) => {
    for (const one of playersOf(index)) {
      one.clip.away = !plays && index !== here;
      if (one.plays !== plays) one.player[plays ? 'toggle' : 'pause']();
      one.plays = plays;
    }
  };

  const missing = () => page.questions.map(q => q.id).filter(id => !answers.has(id));
  const json = () => JSON.stringify({survey: page.survey, participant,
    answers: page.questions.filter(q => answers.has(q.id)).map(q => ({question: q.id, answer: answers.get(q.id)})),
    missing: missing()}, null, 1) + '\n';
  const show = () => {
    find('progress').value = answers.size;
    find('count').textContent = answers.size + ' of ' + sections.length + ' answered';
    find('back').disabled = here === 0;
    find('next').disabled = here === sections.length;
    find('participant').value = participant;
    const open = missing().length;
    find('finished').textContent = open === 0 ? 'All questions are answered.' :
        open + (open === 1 ? ' question is' : ' questions are') + ' not answered: ' + missing().join(', ');
    for (const button of here < sections.length ? sections[here].querySelectorAll('.answer') : [])
      button.setAttribute('aria-pressed', String(answers.get(page.questions[here].id) === button.dataset.answer));
    if (find('text').open) find('answers').value = json();
  };
  const keep = () => {
    if (!pageTools.keep(store, {participant, answers: Object.fromEntries(answers)}))
      tell('This browser keeps nothing: save the answers before you leave the page.');
  };
  const visit = index => {
    const to = Math.min(sections.length, Math.max(0, index));
    if (to === here) return;
    const before = here;
    here = to;
    if (before >= 0 && before < sections.length) {
      play(before, false);
      sections[before].hidden = true;
    }
    const section = here < sections.length ? sections[here] : find('end');
    find('end').hidden = here < sections.length;
    section.hidden = false;
    if (here < sections.length) play(here, true);
    section.focus({preventScroll: true});
    show();
  };
  const go = step => { asked = false; tell(''); visit(here + step); };
  const answer = choice => {
    if (here >= sections.length) return;
    answers.set(page.questions[here].id, choice);
    show();
    go(1);
    keep();
  };
  const toggle = () => { if (here < sections.length) play(here, !playersOf(here)[0].plays); };
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
    tell('answers_' + participant + '.json: ' + answers.size + ' answers' +
        (open.length > 0 ? '; not answered: ' + open.join(', ') : ''));
  };
  const forget = () => {
    pageTools.forget(store);
    answers.clear();
    participant = anybody();
    asked = false;
    go(-sections.length);
    show();
    tell('the page is as it was made');
  };

  for (const button of document.querySelectorAll('.answer'))
    button.addEventListener('click', () => answer(button.dataset.answer));
  // The players' own buttons act on one motion: what the key does next follows the first.
  sections.forEach((section, index) => section.querySelectorAll('.player').forEach((root, i) =>
      root.querySelector('button').addEventListener('click', () => {
        const one = playersOf(index)[i];
        one.plays = !one.plays;
      }, true)));
  find('back').addEventListener('click', () => go(-1));
  find('next').addEventListener('click', () => go(1));
  find('save').addEventListener('click', save);
  find('text').addEventListener('toggle', show);
  find('participant').addEventListener('input', e => { participant = e.target.value.trim(); keep(); });
  find('forget').addEventListener('click', () => { find('sure').hidden = false; });
  find('sure').addEventListener('click', () => { find('sure').hidden = true; forget(); });
  document.addEventListener('keydown', e => {
    if (pageTools.hasCommand(e) || pageTools.isTyping(e) || e.repeat) return;
    if (e.key === ' ' && e.target.tagName === 'BUTTON') return;  // presses it
    const act = {1: () => answer(page.answers[0]), 2: () => answer(page.answers[1]), b: () => go(-1), n: () => go(1),
      Backspace: () => go(-1), s: save, ' ': toggle}[e.key];
    if (!act) return;
    e.preventDefault();
    act();
  });

  const first = page.questions.findIndex(q => !answers.has(q.id));
  visit(first < 0 ? sections.length : first);
  document.documentElement.dataset.survey = String(sections.length);
})();
)js";

}  // namespace mocurate
