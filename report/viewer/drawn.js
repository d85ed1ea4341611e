'use strict';
// Motions of an index (data.js) as clips of mocuratePlayer: mocurateDrawn(index) gives clipOf(motion), or null where the index
// has a skin and the browser no WebGL. Skinned bodies have the skin's own size. One stage off the page draws them all and is
// copied from, because browsers allow 8 to 16 WebGL contexts.
const mocurateDrawn = index => {
  const data = index.skins[0], canvas = document.createElement('canvas'), stage = data ? mocurateStages.make(canvas) : null;
  if (stage && stage.kind !== 'webgl') return null;
  const figure = data ? mocurateFigures.skin(null, data, {skin_scale: 1}) : null;
  const colours = data ? Float32Array.from({length: 3 * data.parents.length}, (x, i) => [0.42, 0.58, 0.80][i % 3]) : null;
  const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  return motion => {
    const {clip, skeleton} = motion, joints = [], parents = skeleton.parents;
    for (let frame = 0; frame < clip.frames; ++frame) joints.push(Array.from(motion.joints(frame), v => 1e3 * v));
    const drawn = {hz: clip.hz, yaw: clip.yaw + 0.45, pitch: 0.12, joints,
      bones: parents.flatMap((p, j) => p < 0 ? [] : [[p, j, skeleton.sides[j]]])};
    if (!figure) return drawn;
    let lowest = Infinity, ground = Infinity;  // of the joints, of the body
    joints.forEach((row, frame) => {
      for (let i = 1; i < row.length; i += 3) lowest = Math.min(lowest, 1e-3 * row[i]);
      if (frame % 8 !== 0) return;
      figure.pose(motion, frame);
      for (let i = 1; i < figure.positions.length; i += 3) ground = Math.min(ground, figure.positions[i]);
    });
    const paint = (pen, frame, {width, height, ratio, scale, view, centre}) => {
      figure.pose(motion, frame);
      const target = centre.map(v => 1e-3 * v), distance = 0.5 * height / Math.tan(mocurateStages.FIELD / 2) / (1e3 * scale);
      stage.draw({bodies: [{key: 'body', figure, colours, shift: [0, 0, 0], joints: joints[frame], parents, opacity: 1}],
        lines: [], floor: ground, centre: target, radius: 0.47e-3 * Math.min(width, height) / scale, grid: style('--grid'),
        background: style('--page')}, {yaw: view.yaw, pitch: view.pitch, distance, target, width, height, ratio});
      pen.drawImage(canvas, 0, 0, width, height);
    };
    return {...drawn, sole: Math.max(0, 1e3 * (lowest - ground)), margin: 120, paint};
  };
};
