'use strict';
// Decodes texts of the annotation page and writes spans.csv.
const annotateFiles = {
  bytes: text => new Uint8Array(mocurateParts.bytes(text)),
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
