'use strict';
// Tables of a page: their heads sort; long ones are folded and have a filter.
(() => {
  const FOLDED = 12;  // rows of a folded table

  const numberOf = cell => {
    const found = cell.textContent.replace(/[\u2009\u00a0\u202f ]/g, '').match(/^[<~]?(-?\d+(?:\.\d+)?)/);
    return found ? parseFloat(found[1]) : NaN;
  };
  const make = (name, text, attributes) => Object.assign(document.createElement(name), {textContent: text}, attributes);

  document.querySelectorAll('table:not(.heat)').forEach(table => {
    const body = table.tBodies[0], heads = table.tHead ? [...table.tHead.rows[0].cells] : [];
    if (!body || body.rows.length < 3) return;
    const all = [...body.rows], filter = make('input', '', {type: 'search', placeholder: 'Filter'});
    const more = make('button', '', {type: 'button', className: 'more'});
    const long = all.length > FOLDED;
    let order = all, folded = long;
    filter.setAttribute('aria-label', 'Filter ' + (table.caption ? table.caption.textContent : 'the table'));

    const draw = () => {
      const words = filter.value.toLowerCase().split(/\s+/).filter(word => word);
      const matching = order.filter(row => words.every(word => row.textContent.toLowerCase().includes(word)));
      const shown = folded && words.length === 0 ? matching.slice(0, FOLDED) : matching;
      body.replaceChildren(...shown);
      more.hidden = words.length > 0;
      more.textContent = folded ? 'Show all ' + all.length + ' rows' : 'Show ' + FOLDED + ' rows';
    };
    heads.forEach((head, column) => {
      const sort = make('button', head.textContent, {type: 'button', className: 'sort', title: 'Sort'});
      head.replaceChildren(sort);
      sort.addEventListener('click', () => {
        const down = head.getAttribute('aria-sort') === 'ascending', sign = down ? -1 : 1;
        heads.forEach(other => other.removeAttribute('aria-sort'));
        head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
        order = all.map((row, i) => ({row, i, cell: row.cells[column]})).sort((a, b) => {
          const [x, y] = [numberOf(a.cell), numberOf(b.cell)];
          if (x === x && y === y) return sign * (x - y) || a.i - b.i;
          if (x === x || y === y) return x === x ? -1 : 1;  // cells without a number stand last
          return sign * a.cell.textContent.localeCompare(b.cell.textContent) || a.i - b.i;
        }).map(entry => entry.row);
        draw();
      });
    });
    if (!long) return;
    const place = table.closest('.scroll') || table;
    filter.addEventListener('input', draw);
    more.addEventListener('click', () => { folded = !folded; draw(); });
    place.before(filter);
    place.after(more);
    window.addEventListener('beforeprint', () => { folded = false; draw(); });
    draw();
  });
})();
