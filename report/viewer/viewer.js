'use strict';
// The viewer: a list of clips, their bodies, one timeline. mocurateViewer(root, index) builds it inside `root` and returns
// {select, open, seek, state, camera}. `index` is written by report/viewer_data.cpp; with `page` the viewer has the window's
// address and keys; `embedded` it has no list, and keys where it has the focus ("inside") or those of the window but letters
// ("beside").
const mocurateViewer = (() => {
  const MOST_LISTED = 500;  // buttons of the list
  const VIEWS = [['Front', 0, 0.12], ['Side', Math.PI / 2, 0.12], ['Three-quarter', 0.6, 0.25], ['Back', Math.PI, 0.12],
    ['Top', 0, 1.5]];
  const HUES = [[0.15, 0.39, 0.79], [0.80, 0.36, 0.10], [0.17, 0.53, 0.33], [0.55, 0.29, 0.70], [0.62, 0.50, 0.05],
    [0.40, 0.44, 0.50]];
  const LEFT = [0.15, 0.42, 0.78], RIGHT = [0.86, 0.47, 0.14], MIDDLE = [0.55, 0.59, 0.64];
  const STATE = [[0.62, 0.66, 0.71], [0.72, 0.24, 0.20], [0.78, 0.58, 0.05], [0.33, 0.36, 0.42]];
  const STATES = ['observed', 'repaired', 'interpolated', 'inferred'];
  const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];

  const make = (name, attributes, ...inside) => {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes || {})) {
      if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
      else if (value !== false && value !== null) element.setAttribute(key, value === true ? '' : value);
    }
    element.append(...inside);
    return element;
  };
  const hex = rgb => '#' + rgb.map(v => ('0' + Math.round(255 * v).toString(16)).slice(-2)).join('');
  const keyOf = clip => clip.group || clip.id.split('/').slice(1).join('/') || clip.id;

  /// Clips that show the same in several sources stand together, the same recording or, where clips have a group, that:
  /// [{key, samples, clips}]. Of several clips of a source one is shown, clips(sample): [by source, or null].
  const groupsOf = index => {
    const groups = new Map(), each = index.sources.map((s, i) => index.clips.filter(clip => clip.source === i).length);
    const alone = index.sources.length > 1 && each.every(count => count === 1) && index.clips.every(clip => !clip.group);
    for (const clip of index.clips) {
      const key = alone ? 'all' : keyOf(clip);
      const taken = !clip.group && groups.has(key) && groups.get(key)[clip.source].length > 0;
      const own = taken ? clip.id + '~' + clip.source : key;  // of one file, from another identity's recording
      if (!groups.has(own)) groups.set(own, index.sources.map(() => []));
      groups.get(own)[clip.source].push(clip);
    }
    return [...groups].map(([key, of]) => ({key, all: of.flat(), first: of.flat()[0], findings: of.flat().flatMap(clip => clip.findings),
      residual: Math.max(...of.flat().map(clip => clip.residual)), samples: Math.max(...of.map(list => list.length)),
      clips: sample => of.map(list => list[sample] || null)}));
  };

  return (root, index) => {
    const style = name => getComputedStyle(root).getPropertyValue(name).trim();
    root.classList.add('viewer');
    let lasting = '';  // said where nothing else is
    const say = text => { status.textContent = text || lasting; };
    const status = make('p', {class: 'status', role: 'status'});
    if (index.schema !== mocurateParts.SCHEMA) {
      root.append(status);
      say(mocurateParts.sentence.schema(index.schema));
      return null;
    }
    const groups = groupsOf(index), several = index.sources.length > 1;
    const many = () => several && !(index.embedded && state.shown.length < 2);
    const state = {group: null, sample: 0, shown: [], time: 0, playing: false, speed: 1, loop: true, figure: 'body', colour: 'sides',
      layout: 'beside', align: 'world', path: true, points: true, cameras: true, clouds: true, follow: false, hidden: new Set()};
    const camera = {yaw: 0.6, pitch: 0.2, distance: 4, target: [0, 1, 0]};
    let scene = null, length = 0, last = 0, turned = 0;

    // Controls. Every one has a label; the keys are listed by the button "Keys".
    const option = (label, name, choices, changed) => make('label', {}, label + ' ', make('select', {
      'data-option': name, onchange: e => { state[name] = e.target.value; changed(); }},
    ...choices.map(([value, text]) => make('option', {value, selected: state[name] === value}, text))));
    const tick = (label, name, key, changed) => make('label', {}, make('input', {type: 'checkbox', 'data-option': name,
      checked: state[name], onchange: e => { state[name] = e.target.checked; changed(); }}), ' ' + label);
    const button = (text, action, attributes) => make('button', {type: 'button', onclick: action, ...attributes}, text);

    const canvas = make('canvas', {tabindex: 0, role: 'img', 'aria-label': 'The motion; drag or use shift and arrow keys to turn the view'});
    const playButton = button('Play', () => play(!state.playing), {'data-do': 'play', title: 'space'});
    const slider = make('input', {type: 'range', min: 0, max: 0, step: 1, value: 0, 'aria-label': 'Frame',
      oninput: e => { play(false); show(Number(e.target.value) / rate()); }});
    const clock = make('output', {class: 'clock', 'aria-live': 'off'});
    const speed = make('select', {'aria-label': 'Speed', 'data-option': 'speed', onchange: e => { state.speed = Number(e.target.value); }},
      ...SPEEDS.map(value => make('option', {value, selected: value === 1}, value + ' ×')));
    const bands = make('canvas', {class: 'bands', role: 'img', 'aria-label': 'Segments, findings, contacts, states and curves over time'});
    const timeline = mocurateTimeline.build(bands, style, seconds => { play(false); show(seconds); });
    const names = make('div', {class: 'names'});
    const samples = make('select', {'aria-label': 'Sample', 'data-option': 'sample', onchange: e =>
      select(state.group, state.time, '', Number(e.target.value))});
    const heading = make('h2', {}), facts = make('p', {class: 'facts'}), found = make('ul', {class: 'found'});
    const near = make('p', {class: 'near'});

    const refigure = () => { state.shown.forEach(entry => { entry.figure = figureOf(entry); }); show(state.time); };
    const relay = () => {
      const align = root.querySelector('select[data-option=align]');
      if (align) align.disabled = state.layout === 'beside';
      place();
      fit();
      show(state.time);
    };
    const hasSkin = index.skins.length > 0, has = name => index.clips.some(clip => clip.has.includes(name));
    const figures = [['body', 'Capsules'], ['bones', 'Bones'], ...(hasSkin ? [['skin', 'Skin']] : [])];
    if (hasSkin) state.figure = 'skin';
    const colours = [['sides', several ? 'by source' : 'left and right'], ...(has('state') ? [['state', 'by state']] : []),
      ...(has('sigma') ? [['sigma', 'by uncertainty']] : [])];
    const legend = make('span', {class: 'legend'});
    const swatch = (colour, text) => [make('span', {class: 'swatch', style: 'background:' + hex(colour)}), text + ' '];
    const explain = () => legend.replaceChildren(...(state.colour === 'state' ? STATE.flatMap((colour, i) => swatch(colour, STATES[i])) :
      state.colour === 'sigma' ? [...swatch([0.2, 0.55, 0.55], 'sure'), ...swatch([0.8, 0.2, 0.15], '5 cm and more'), ...swatch(STATE[3], 'not stated')] :
        many() ? ['right sides are pale'] : [...swatch(LEFT, 'left'), ...swatch(RIGHT, 'right')]));
    const layers = make('div', {class: 'layers', role: 'group', 'aria-label': 'What is shown'},
      option('Figure', 'figure', figures, refigure), option('Colours', 'colour', colours, () => { explain(); show(state.time); }),
      ...(several ? [option('Motions', 'layout', [['beside', 'side by side'], ['over', 'overlaid']], relay),
        option('Aligned', 'align', [['world', 'in the world'], ['root', 'at the root']], relay)] : []),
      tick('Path', 'path', 'p', () => show(state.time)),
      ...(index.clips.some(clip => clip.points) ? [tick('Tracked points', 'points', 't', () => show(state.time))] : []),
      ...(index.clips.some(clip => clip.cameras.length > 0) ? [tick('Cameras', 'cameras', 'v', () => show(state.time))] : []),
      ...(has('clouds') ? [tick('Clouds', 'clouds', 'd', () => show(state.time))] : []),
      tick('Follow', 'follow', 'f', () => show(state.time)), tick('Loop', 'loop', 'l', () => {}), legend);
    const views = make('div', {class: 'views', role: 'group', 'aria-label': 'Views'}, ...VIEWS.map(([name, yaw, pitch], i) =>
      button(name, () => lookFrom(yaw, pitch), {'data-view': name, title: 'key ' + (i + 1)})), button('Fit', () => { fit(); show(state.time); }, {title: 'key 0'}));
    const tools = make('div', {class: 'tools', role: 'group', 'aria-label': 'Tools'},
      button('Picture', () => save(), {'data-do': 'picture', title: 'save a PNG'}),
      ...(typeof MediaRecorder === 'undefined' || !canvas.captureStream || !MediaRecorder.isTypeSupported('video/webm') ? [] :
        [button('Video', () => record(), {'data-do': 'video', title: 'save the motion once as WebM'})]),
      button('Link', () => copyLink(), {'data-do': 'link', title: 'address of this clip and time'}),
      button('Keys', () => { keys.open = !keys.open; }, {'data-do': 'keys'}));
    const keys = make('details', {class: 'keys'}, make('summary', {}, 'Keys'), make('p', {}, 'space: play · ← →: a frame, with ' +
      'shift: turn · Home, End: first and last frame · 1 to 5: views, 0: whole motion · + −: speed' + (index.embedded === 'beside' ? '' :
      ' · g: figure · c: colours · o: side by side or overlaid · a: alignment · p: path · t: tracked points · v: cameras · d: clouds · ' +
      'f: follow · l: loop · i u: nearer, farther') + (index.page ? ' · n, b: next and previous clip · /: search' : '')));

    // The list.
    const search = make('input', {type: 'search', placeholder: 'Search clips', 'aria-label': 'Search clips', oninput: () => list()});
    const choice = (label, values) => make('select', {'aria-label': label, onchange: () => list()},
      make('option', {value: ''}, label + ': all'), ...values.map(([value, count]) => make('option', {value}, (value || 'none') + ' (' + count + ')')));
    const tally = of => {
      const counts = new Map();
      groups.forEach(group => new Set(of(group)).forEach(v => counts.set(v, (counts.get(v) || 0) + 1)));
      return [...counts].sort((a, b) => a[0] < b[0] ? -1 : 1);
    };
    const filters = [['Label', group => group.all.map(clip => clip.label)], ['Person', group => group.all.map(clip => clip.person)],
      ['Part', group => group.all.map(clip => clip.part)],
      ...(several ? [['Source', group => group.all.map(clip => index.sources[clip.source].name)]] : []),
      ['Finding', group => group.findings.length > 0 ? group.findings.map(f => f.code) : ['none']]]
      .map(([name, of]) => ({of, values: tally(of), name})).filter(f => f.values.length > 1)
      .map(f => ({...f, select: choice(f.name, f.values)}));
    const orders = [['order', 'file order', () => 0], ['label', 'label', group => group.first.label], ['person', 'person', group => group.first.person],
      ['length', 'longest first', group => -group.first.frames / group.first.hz],
      ...(index.clips.some(clip => clip.residual > 0) ? [['residual', 'largest residual first', group => -group.residual]] : []),
      ...(index.clips.some(clip => clip.findings.length > 0) ? [['findings', 'most findings first', group => -group.findings.length]] : [])];
    const order = make('select', {'aria-label': 'Sort by', onchange: () => list()}, ...orders.map(([value, text]) => make('option', {value}, text)));
    const mapped = index.clips.filter(clip => clip.map);
    const field = filters.filter(f => f.name !== 'Finding' && f.name !== 'Source').map(f => [f.name, clip => clip[f.name.toLowerCase()]]);
    field.push(['Finding', clip => clip.findings.length > 0 ? clip.findings[0].code : '']);
    const mapCanvas = make('canvas', {tabindex: 0, role: 'img', 'aria-label': 'Map of the clips: alike ones are near each other; arrow keys go to a neighbour'});
    const mapLegend = make('p', {class: 'legend'});
    const map = mapped.length > 2 ? mocurateClipMap.build(mapCanvas, mapLegend, field, style, clip => choose(clip)) : null;
    const mapColour = make('select', {'aria-label': 'Colours of the map', 'data-option': 'map', onchange: e => map.colour(e.target.value)},
      ...field.map(([name]) => make('option', {value: name}, 'Map by ' + name.toLowerCase())));
    const mapBox = map && make('details', {class: 'map', open: window.innerWidth > 820, ontoggle: () => map.draw()}, make('summary', {}, 'Map of clips'), mapCanvas, mapLegend, mapColour);
    // Places of different sources are not comparable: the map is that of the shown clip's.
    const remap = () => {
      const clip = state.group && state.group.clips(state.sample).find(other => other && other.map);
      const source = clip ? clip.source : mapped.length > 0 ? mapped[0].source : 0;
      if (map) map.show(mapped.filter(other => other.source === source), matching.flatMap(group => group.all));
    };
    const count = make('p', {class: 'count'}), entries = make('ul', {class: 'clips'});
    let matching = groups;
    const list = () => {
      const words = search.value.toLowerCase().split(/\s+/).filter(word => word);
      const of = orders.find(o => o[0] === order.value)[2];
      matching = groups.filter(group => {
        const text = group.all.map(clip => [clip.id, clip.label, clip.fine, several ? index.sources[clip.source].name : '',
          ...clip.segments.map(s => s[2]), ...clip.findings.map(f => f.code)].join(' ')).join(' ').toLowerCase();
        return words.every(word => text.includes(word)) && filters.every(f => f.select.value === '' && f.select.selectedIndex === 0 || f.of(group).includes(f.select.value));
      });
      matching = matching.map((group, i) => [of(group), i, group]).sort((a, b) => a[0] < b[0] ? -1 : a[0] > b[0] ? 1 : a[1] - b[1])
        .map(row => row[2]);
      entries.replaceChildren(...matching.slice(0, MOST_LISTED).map(group => {
        const clip = group.first, {findings} = group, worst = ['error', 'warning', 'info'].find(severity => findings.some(f => f.severity === severity));
        return make('li', {}, make('button', {type: 'button', 'data-clip': clip.id, 'aria-current': group === state.group ? 'true' : false,
          onclick: () => select(group, 0)}, make('span', {class: 'name'}, keyOf(clip)), make('span', {class: 'more'},
          [clip.label || (clip.segments.length > 0 ? clip.segments.length + ' segments' : ''), (clip.frames / clip.hz).toFixed(1) + ' s',
            group.residual > 0 ? group.residual.toFixed(0) + ' mm' : ''].filter(t => t).join(' · ') + ' ',
          ...(worst ? [make('span', {class: 'flag ' + worst}, findings.length + (findings.length === 1 ? ' finding' : ' findings'))] : []))));
      }));
      remap();
      count.textContent = matching.length === groups.length ? groups.length + (groups.length === 1 ? ' clip' : ' clips') :
        matching.length + ' of ' + groups.length + ' clips';
      if (matching.length > MOST_LISTED) count.textContent += '; the first ' + MOST_LISTED + ' are listed: search for others';
    };

    // What is shown.
    /// The entry that is the longest: the slider counts its frames.
    const lead = () => state.shown.reduce((a, b) => b.motion.clip.frames / b.motion.clip.hz > a.motion.clip.frames / a.motion.clip.hz ? b : a);
    const rate = () => state.shown.length > 0 ? lead().motion.clip.hz : 30;
    const figureOf = entry => {
      const {skeleton, clip} = entry.motion, skin = index.skins[clip.skin];
      if (state.figure === 'skin' && skin && entry.motion.hasRotations) return mocurateFigures.skin(skeleton, skin, clip);
      return state.figure === 'bones' ? mocurateFigures.bones(skeleton) : mocurateFigures.body(skeleton, clip, index.bodies[clip.body]);
    };
    const coloursOf = (entry, frame) => {
      const {motion} = entry, J = motion.skeleton.parents.length, hue = HUES[entry.source % HUES.length];
      for (let j = 0; j < J; ++j) {
        const side = motion.skeleton.sides[j];
        let colour = many() ? hue.map(v => v + (1 - v) * (side < 0 ? 0.35 : side > 0 ? 0 : 0.15)) : side > 0 ? LEFT : side < 0 ? RIGHT : MIDDLE;
        if (state.colour === 'state' && motion.state) colour = STATE[motion.state[frame * J + j]];
        if (state.colour === 'sigma' && motion.hasSigma) {
          const s = Math.min(1, motion.sigma(frame, j) / 0.05);  // 5 cm and more: all red
          colour = s === s ? [0.2 + 0.6 * s, 0.55 - 0.35 * s, 0.55 - 0.4 * s] : STATE[3];
        }
        for (let i = 0; i < 3; ++i) entry.colours[3 * j + i] = colour[i];
      }
    };

    /// Places of the sources: side by side they stand along x, as far apart as they are wide.
    const place = () => {
      const seen = state.shown.filter(entry => !state.hidden.has(entry.source));
      let low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      const beside = state.layout === 'beside' && seen.length > 1;
      let at = 0;
      for (const entry of seen) {
        const {box} = entry, wide = box.high[0] - box.low[0];
        entry.base = beside ? [at - box.low[0], seen[0].floor - entry.floor, -entry.motion.root[2]] : state.align === 'root' && entry !== seen[0] ?
          [0, 1, 2].map(i => i === 1 ? 0 : seen[0].motion.root[i] - entry.motion.root[i]) : [0, 0, 0];
        at += wide + 0.5;
        for (let i = 0; i < 3; ++i) {
          low[i] = Math.min(low[i], box.low[i] + entry.base[i]);
          high[i] = Math.max(high[i], box.high[i] + entry.base[i]);
        }
      }
      if (seen.length === 0) { low = [-1, 0, -1]; high = [1, 2, 1]; }
      scene = {low, high, centre: low.map((v, i) => (v + high[i]) / 2), radius: Math.max(0.6, 0.5 * Math.hypot(...low.map((v, i) => high[i] - v))),
        floor: seen.length > 0 ? Math.min(...seen.map(entry => entry.floor + entry.base[1])) : 0};
    };
    const fit = () => {
      camera.target = scene.centre.slice();
      const wide = Math.min(1, canvas.clientWidth / Math.max(1, canvas.clientHeight));
      camera.distance = 0.9 * scene.radius / Math.sin(mocurateStages.FIELD / 2) / wide;
    };
    const lookFrom = (yaw, pitch) => { camera.yaw = turned + yaw; camera.pitch = pitch; fit(); show(state.time); };

    const stage = mocurateStages.make(canvas);
    root.dataset.stage = stage.kind;

    const show = seconds => {
      state.time = Math.max(0, Math.min(length, seconds));
      if (!scene) return;
      const bodiesShown = [], lines = [], target = state.shown.find(entry => !state.hidden.has(entry.source));
      let followed = null;
      for (const entry of state.shown) {
        if (state.hidden.has(entry.source)) continue;
        const {motion} = entry, frame = motion.frameAt(state.time);
        motion.joints(frame, entry.joints);
        entry.figure.pose(motion, frame, entry.joints);
        coloursOf(entry, frame);
        const shift = entry.base.slice();
        if (many() && state.align === 'root' && state.layout === 'over' && entry !== target) {
          const other = target.motion, f = other.frameAt(state.time);
          for (const i of [0, 2]) shift[i] = other.root[3 * f + i] - motion.root[3 * frame + i];
        }
        if (entry === target) followed = [0, 1, 2].map(i => motion.root[3 * frame + i] + shift[i]);
        bodiesShown.push({key: entry.source + '', figure: entry.figure, colours: entry.colours, shift, joints: entry.joints,
          parents: motion.skeleton.parents, opacity: many() && state.layout === 'over' && entry !== target ? 0.75 : 1});
        if (state.path) lines.push({key: 'path' + entry.source, strip: true, places: entry.path, shift, colour: hex(HUES[entry.source % HUES.length])});
        if (state.cameras) entry.motion.clip.cameras.forEach((corners, i) => {
          const ends = [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]].flat();
          lines.push({key: 'camera' + entry.source + '/' + i, colour: style('--soft'), shift,
            places: ends.flatMap(end => corners.slice(3 * end, 3 * end + 3))});
        });
        if (state.clouds && motion.hasClouds) {
          lines.push({key: 'cloud' + entry.source, dots: 0.022, places: motion.cloud(frame), shift, colour: style('--suspect')});
        }
        if (state.points && motion.hasPoints) {
          motion.points(frame, entry.points);
          const seen = [];
          for (let k = 0; k < entry.points.length; k += 3) if (entry.points[k] === entry.points[k]) seen.push(...entry.points.slice(k, k + 3));
          if (seen.length > 0) lines.push({key: 'points' + entry.source, dots: 0.05, places: seen, shift, colour: style('--ink')});
        }
      }
      if (state.follow && followed) camera.target = [followed[0], camera.target[1], followed[2]];
      const width = canvas.clientWidth || 600, height = canvas.clientHeight || 400;
      stage.draw({...scene, bodies: bodiesShown, lines, grid: style('--grid'), background: style('--stage')},
        {...camera, width, height, ratio: window.devicePixelRatio || 1});
      const frame = state.shown.length > 0 ? lead().motion.frameAt(state.time) : 0;
      slider.value = String(frame);
      clock.textContent = state.time.toFixed(2) + ' s, frame ' + frame;
      slider.setAttribute('aria-valuetext', clock.textContent);
      timeline.move(state.time);
      root.dataset.time = state.time.toFixed(3);
    };

    const step = now => {
      if (!state.playing) return;
      let time = state.time + Math.max(0, now - last) / 1000 * state.speed;
      last = now;
      if (time > length) {
        if (state.loop && !state.recording) time = length > 0 ? time % length : 0;
        else { show(length); play(false); return; }
      }
      show(time);
      requestAnimationFrame(step);
    };
    const play = playing => {
      if (playing === state.playing || state.shown.length === 0) return;
      if (playing && state.time >= length - 1e-6) state.time = 0;
      state.playing = playing;
      playButton.textContent = playing ? 'Pause' : 'Play';
      root.dataset.playing = String(playing);
      last = performance.now();
      if (playing) requestAnimationFrame(step);
      if (!playing) remember();
      if (!playing && state.recording) state.recording.stop();
    };

    /// A motion with what drawing it needs: its extent, floor and path.
    const enter = (motion, source) => {
      const J = motion.skeleton.parents.length, F = motion.clip.frames, joints = new Float32Array(3 * J);
      const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      for (let f = 0; f < F; f += Math.max(1, Math.floor(F / 200))) {
        motion.joints(f, joints);
        joints.forEach((v, i) => {
          if (v < low[i % 3]) low[i % 3] = v;
          if (v > high[i % 3]) high[i % 3] = v;
        });
      }
      const floor = motion.clip.floor === null ? low[1] - 0.03 : motion.clip.floor, path = [];
      for (let f = 0; f < F; ++f) path.push(motion.root[3 * f], floor + 0.005, motion.root[3 * f + 2]);
      const entry = {motion, source, joints, colours: new Float32Array(3 * J), floor, path, base: [0, 0, 0],
        points: motion.hasPoints ? new Float32Array(3 * motion.clip.points.names.length) : null,
        box: {low: low.map((v, i) => Math.min(v - 0.15, i === 1 ? floor : v)), high: high.map(v => v + 0.15)}};
      entry.figure = figureOf(entry);
      return entry;
    };

    let asked = 0;
    const select = (group, seconds, said, sample) => {
      const now = ++asked;
      play(false);
      state.group = group;
      state.time = seconds;
      say(said || '');
      for (const item of entries.querySelectorAll('[aria-current]')) item.removeAttribute('aria-current');
      const item = entries.querySelector('[data-clip="' + CSS.escape(group.first.id) + '"]');
      if (item) {
        item.setAttribute('aria-current', 'true');
        const list = entries.getBoundingClientRect(), row = item.getBoundingClientRect();
        if (row.top < list.top || row.bottom > list.bottom) entries.scrollTop += row.top - list.top - list.height / 3;
      }
      state.sample = sample || 0;
      const clips = group.clips(state.sample).filter(clip => clip);
      return Promise.all(clips.map(clip => mocurateParts.read(index, clip.place[0])
        .then(buffer => enter(mocurateClip(clip, index.skeletons[clip.skeleton], buffer), clip.source)))).then(shown => {
        if (now !== asked) return;  // another clip was chosen meanwhile
        state.shown = shown;
        if (!many()) state.hidden.clear();
        length = Math.max(...shown.map(entry => (entry.motion.clip.frames - 1) / entry.motion.clip.hz));
        slider.max = String(lead().motion.clip.frames - 1);
        describe(group);
        explain();
        const drawn = timeline.show(shown.map(entry => ({motion: entry.motion, name: index.sources[entry.source].name,
          colour: many() ? hex(HUES[entry.source % HUES.length]) : style('--after')})));
        root.dataset.rows = drawn.rows.concat(drawn.curves).join('|');
        turned = shown[0].motion.clip.yaw;
        camera.yaw = turned + 0.6;
        camera.pitch = 0.25;
        place();
        fit();
        show(seconds);
        remember();
        if (!root.dataset.clip) performance.mark('first picture');
        root.dataset.clip = group.first.id;
      }).catch(problem => {
          if (now !== asked) return;
          state.shown = [];
          length = 0;
          slider.max = '0';
          timeline.show([]);
          describe(group);
          place();
          show(0);
          say(problem.message);
        });
    };
    const describe = group => {
      const clip = group.clips(state.sample).find(other => other);
      heading.textContent = [...new Set(group.clips(state.sample).filter(other => other).map(keyOf))].join(' · ');
      samples.hidden = group.samples < 2;
      samples.replaceChildren(...Array.from({length: group.samples}, (x, i) => make('option', {value: i, selected: i === state.sample},
        'sample ' + (i + 1) + ' of ' + group.samples)));
      facts.textContent = [clip.label, clip.fine, clip.person ? 'person ' + clip.person : '', clip.part,
        clip.frames + ' frames at ' + (Math.round(clip.hz * 1000) / 1000) + ' Hz', index.skeletons[clip.skeleton].name,
        clip.has.includes('rotations') ? 'rotations' : 'joints only', clip.residual > 0 ? 'residual ' + clip.residual.toFixed(1) + ' mm' : '']
        .filter(text => text).join(' · ');
      const findings = group.clips(state.sample).flatMap(other => other ? other.findings.map(f => [f, index.sources[other.source].name]) : []);
      found.replaceChildren(...findings.map(([f, source]) => make('li', {class: f.severity}, button(f.code, () => { play(false); show(f.begin_s); },
        {title: 'go to its first frame'}), ' ' + (many() ? source + ': ' : '') + f.text)));
      const nearest = (clip.nearest || []).map(id => index.clips.find(other => other.id === id && other.source === clip.source)).filter(other => other);
      near.hidden = nearest.length === 0;
      near.replaceChildren('Nearest: ', ...nearest.map(other => button(keyOf(other) + (other.label ? ' (' + other.label + ')' : ''),
        () => choose(other), {class: other.label === clip.label ? 'like' : 'unlike'})));
      remap();
      if (map) map.mark(group.clips(state.sample).find(other => other && other.map));
      names.replaceChildren(...(many() ? group.clips(state.sample).map((other, i) => other && make('label', {}, make('input', {type: 'checkbox',
        checked: !state.hidden.has(i), 'data-source': index.sources[i].name, onchange: e => {
          if (e.target.checked) state.hidden.delete(i); else state.hidden.add(i);
          relay();
        }}), make('span', {class: 'swatch', style: 'background:' + hex(HUES[i % HUES.length])}), index.sources[i].name)).filter(x => x) : []));
    };

    // Addresses, pictures, videos.
    const remember = () => {
      if (!index.page || !state.group) return;
      const text = '#clip=' + encodeURIComponent(state.group.clips(state.sample).find(clip => clip).id) + '&t=' + state.time.toFixed(3);
      try { history.replaceState(null, '', text); } catch (e) { /* some browsers forbid it for files */ }
    };
    const copyLink = () => {
      remember();
      if (navigator.clipboard) navigator.clipboard.writeText(location.href).catch(() => {});
      say('The address of this page is now that of this clip and time.');
    };
    const fileName = ending => keyOf(state.group.first).replace(/[^A-Za-z0-9_.-]+/g, '_') + '.' + ending;
    const download = (blob, name) => {
      const link = make('a', {href: URL.createObjectURL(blob), download: name});
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 5000);
    };
    const save = () => { show(state.time); canvas.toBlob(blob => download(blob, fileName('png')), 'image/png'); };
    const record = () => {
      if (state.recording || state.shown.length === 0) return;
      const pieces = [], stream = canvas.captureStream(30), name = fileName('webm'), before = state.speed;
      const recorder = new MediaRecorder(stream, {mimeType: 'video/webm'});
      recorder.ondataavailable = e => { if (e.data.size > 0) pieces.push(e.data); };
      recorder.onstop = () => {
        state.recording = null;
        state.speed = before;
        stream.getTracks().forEach(track => track.stop());
        root.dataset.recorded = String(pieces.reduce((sum, piece) => sum + piece.size, 0));
        download(new Blob(pieces, {type: 'video/webm'}), name);
        say('');
      };
      play(false);
      state.time = 0;
      state.speed = 1;
      state.recording = recorder;
      recorder.start();
      say('Recording the motion once …');
      play(true);
    };

    // Hands.
    const pointers = new Map();
    canvas.addEventListener('pointerdown', e => { canvas.focus(); canvas.setPointerCapture(e.pointerId); pointers.set(e.pointerId, [e.clientX, e.clientY]); });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, e => pointers.delete(e.pointerId));
    const pan = (dx, dy) => {
      const unit = 2 * camera.distance * Math.tan(mocurateStages.FIELD / 2) / Math.max(1, canvas.clientHeight);
      const c = Math.cos(camera.yaw), s = Math.sin(camera.yaw), tilt = Math.sin(camera.pitch);
      camera.target[0] -= unit * (dx * c + dy * tilt * s);
      camera.target[2] += unit * (dx * s - dy * tilt * c);
      camera.target[1] += unit * dy * Math.cos(camera.pitch);
    };
    const zoom = by => { camera.distance = Math.min(5 * scene.radius + 100, Math.max(0.3, camera.distance * by)); };
    const turn = (dx, dy) => {
      camera.yaw -= dx;
      camera.pitch = Math.min(1.55, Math.max(-1.55, camera.pitch + dy));
    };
    canvas.addEventListener('pointermove', e => {
      const from = pointers.get(e.pointerId);
      if (!from) return;
      const dx = e.clientX - from[0], dy = e.clientY - from[1];
      if (pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== e.pointerId)[1];
        zoom(Math.hypot(from[0] - other[0], from[1] - other[1]) / Math.max(1, Math.hypot(e.clientX - other[0], e.clientY - other[1])));
        pan(dx / 2, dy / 2);
      } else if (e.buttons & 2 || e.shiftKey) pan(dx, dy);
      else turn(0.01 * dx, 0.01 * dy);
      pointers.set(e.pointerId, [e.clientX, e.clientY]);
      root.dataset.yaw = camera.yaw.toFixed(3);
      show(state.time);
    });
    canvas.addEventListener('contextmenu', e => e.preventDefault());
    canvas.addEventListener('wheel', e => {
      e.preventDefault();
      zoom(Math.exp(0.001 * e.deltaY));
      show(state.time);
    }, {passive: false});
    const cycle = name => {
      const select = root.querySelector('select[data-option="' + name + '"]');
      if (!select) return;
      select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
      select.dispatchEvent(new Event('change'));
    };
    const flip = name => { const box = root.querySelector('input[data-option="' + name + '"]'); if (box) box.click(); };
    const neighbour = by => {
      const at = matching.indexOf(state.group), next = matching[at + by];
      if (next) select(next, 0);
    };
    const frames = by => { play(false); show((Math.round(state.time * rate()) + by) / rate()); remember(); };
    const actions = {' ': () => play(!state.playing), ArrowLeft: () => frames(-1), ArrowRight: () => frames(1), Home: () => frames(-1e9),
      End: () => frames(1e9), 0: () => { fit(); show(state.time); }, g: () => cycle('figure'), c: () => cycle('colour'),
      o: () => cycle('layout'), a: () => cycle('align'), p: () => flip('path'), t: () => flip('points'), f: () => flip('follow'), v: () => flip('cameras'), d: () => flip('clouds'),
      l: () => flip('loop'),
      '+': () => faster(1), '-': () => faster(-1), i: () => { zoom(0.9); show(state.time); }, u: () => { zoom(1.1); show(state.time); }, '?': () => { keys.open = !keys.open; }};
    if (index.page) Object.assign(actions, {n: () => neighbour(1), b: () => neighbour(-1), '/': () => search.focus()});
    VIEWS.forEach(([, yaw, pitch], i) => { actions[i + 1] = () => lookFrom(yaw, pitch); });
    const faster = by => {
      speed.selectedIndex = Math.max(0, Math.min(SPEEDS.length - 1, speed.selectedIndex + by));
      state.speed = SPEEDS[speed.selectedIndex];
    };
    (index.page || index.embedded === 'beside' ? document : root).addEventListener('keydown', e => {
      if (index.embedded === 'beside' && /^[a-z/?]$/i.test(e.key)) return;
      const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName) && e.target.type !== 'checkbox' && !(e.target.type === 'range' && e.key === ' ');
      const pressed = e.key === ' ' && (e.target.tagName === 'BUTTON' || e.target.type === 'checkbox');
      if (e.ctrlKey || e.metaKey || e.altKey || typing || pressed || e.repeat && e.key === ' ' || e.target.tagName === 'SUMMARY') return;
      const turning = e.shiftKey && {ArrowLeft: [0.15, 0], ArrowRight: [-0.15, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1]}[e.key];
      const action = turning ? () => { turn(...turning); root.dataset.yaw = camera.yaw.toFixed(3); show(state.time); } : actions[e.key];
      if (!action) return;
      e.preventDefault();
      action();
    });

    root.classList.toggle('embedded', Boolean(index.embedded));
    root.append(
      ...(index.embedded ? [] : [make('aside', {'aria-label': 'Clips'}, search, make('div', {class: 'filters'}, ...filters.map(f => f.select), order),
        count, entries, ...(map ? [mapBox] : []))]),
      make('div', {class: 'stage'}, make('div', {class: 'head'}, heading, facts, make('div', {}, samples, names), near, found), canvas, status,
        make('div', {class: 'controls'}, playButton, button('−1', () => frames(-1), {'aria-label': 'One frame back', title: 'key ←'}),
          button('+1', () => frames(1), {'aria-label': 'One frame on', title: 'key →'}), slider, clock, speed), bands, layers, make('div', {class: 'row'}, views, tools), keys));
    list();
    lasting = [...(index.notes || []).map(note => note + '.'), ...(stage.kind === 'canvas' ?
      ['This browser has no WebGL: motions are drawn as bones.'] : [])].join(' ');
    // After a click the keys are the viewer's; a control that was reached by keys keeps them.
    root.addEventListener('click', e => { if (e.detail > 0 && e.target.closest('button')) canvas.focus({preventScroll: true}); });
    if (map) new ResizeObserver(() => requestAnimationFrame(map.draw)).observe(mapCanvas);
    new ResizeObserver(() => requestAnimationFrame(() => { timeline.draw(); show(state.time); })).observe(canvas);
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { timeline.draw(); show(state.time); });

    const choose = clip => {
      const [group, sample] = holding(clip.id);
      select(group, 0, '', sample);
    };
    /// The group and sample of a clip.
    const holding = id => {
      const group = id && groups.find(g => g.all.some(clip => clip.id === id));
      if (!group) return [null, 0];
      for (let i = 0; i < group.samples; ++i) if (group.clips(i).some(clip => clip && clip.id === id)) return [group, i];
      return [group, 0];
    };
    const wanted = () => {
      const asks = new URLSearchParams(location.hash.slice(1)), id = asks.get('clip'), t = Number(asks.get('t')) || 0;
      const [group, sample] = holding(id);
      if (id && !group) return select(groups[0], 0, 'This page has no clip ' + id + '.');
      return group ? select(group, t, '', sample) : null;
    };
    if (index.page) window.addEventListener('hashchange', wanted);
    if (groups.length === 0) say('There is no motion to show: the files hold no clip with a motion.');
    else if (!(index.page && wanted())) select(matching[0], 0);
    return {open: (key, t) => { const group = groups.find(g => g.key === key); return group ? select(group, t || 0) : null; }, select: (id, t) => { const [group, sample] = holding(id); return group ? select(group, t || 0, '', sample) : null; },
      seek: show, state, camera};
  };
})();
