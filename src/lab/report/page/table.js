// Tables sorted by a press on a column's title: up, then down. What has no figure stays last.

const value = (row, column) => {
  const cell = row.cells[column];
  return 'value' in cell.dataset ? cell.dataset.value : cell.textContent;
};

function compare(a, b) {
  const [x, y] = [Number(a), Number(b)];
  return Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b, 'en', { numeric: true }) : x - y;
}

function sort(table, column, direction) {
  const body = table.tBodies[0];
  const rows = [...body.rows];
  const empty = rows.filter((row) => value(row, column) === '');
  const full = rows.filter((row) => value(row, column) !== '');
  full.sort((a, b) => direction * compare(value(a, column), value(b, column)));
  body.append(...full, ...empty);
}

function press(table, head) {
  const ascending = head.getAttribute('aria-sort') !== 'ascending';
  for (const other of head.parentElement.cells) other.removeAttribute('aria-sort');
  head.setAttribute('aria-sort', ascending ? 'ascending' : 'descending');
  sort(table, head.cellIndex, ascending ? 1 : -1);
}

/** Says so where a table is wider than the window shows. */
function markWide() {
  for (const box of document.querySelectorAll('.table .scroll')) {
    box.parentElement.classList.toggle('wide', box.scrollWidth > box.clientWidth + 1);
  }
}

for (const table of document.querySelectorAll('table.sortable')) {
  for (const head of table.tHead.rows[0].cells) {
    head.replaceChildren(button({}, head.textContent, () => press(table, head)));
  }
}
markWide();
addEventListener('resize', markWide);
