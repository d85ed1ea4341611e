#pragma once

namespace mocurate {

/// Reads the cards of the annotation page and writes spans.csv.
inline constexpr const char* kAnnotateFilesScript = R"js(
'use strict';
const annotateFiles = {
  // Of the script element of that class in a card.
  bytes(root, name) {
    const text = root.querySelector('script.' + name).textContent;
    return Uint8Array.from(atob(text.split(',')[1]), c => c.charCodeAt(0));
  },
  // Rows of x, y, z in mm (report/packed_frames.h): the root as three int16, each other joint as three int8 from it.
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

}  // namespace mocurate
