'use strict';
// Opens the page's viewer; `theViewer` is it.
const theViewer = mocurateViewer(document.getElementById('viewer'), JSON.parse(document.getElementById('viewer-index').textContent));
