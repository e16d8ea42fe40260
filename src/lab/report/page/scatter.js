// Scatter plots over logarithmic axes with the Pareto front, drawn to the width that there is.

const SERIES = 8;
const SHAPES = [
  'M5.5 0A5.5 5.5 0 1 1-5.5 0 5.5 5.5 0 1 1 5.5 0Z', // circle
  'M-4.8-4.8H4.8V4.8H-4.8Z', // square
  'M0-6.4L6 4.4H-6Z', // triangle
  'M0-6.8L6.8 0 0 6.8-6.8 0Z', // diamond
  'M0 6.4L6-4.4H-6Z', // triangle on its tip
  'M-2-6H2V-2H6V2H2V6H-2V2H-6V-2H-2Z', // cross
  'M0-6.4L6.1-2 3.8 5.2H-3.8L-6.1-2Z', // pentagon
];

// The name of SVG's space, from the parser.
const SVG = Object.assign(document.createElement('div'), { innerHTML: '<svg></svg>' }).firstChild.namespaceURI;

function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

class Scatter {
  constructor(figure) {
    this.figure = figure;
    Object.assign(this, JSON.parse(figure.querySelector('script').textContent));
    const shown = ({ x, y }) => x > 0 && y !== null && y >= 0;
    this.leftOut = this.points.filter((point) => !shown(point)).length;
    this.points = this.points.filter(shown).sort((a, b) => a.x - b.x || b.y - a.y);
    this.groups = [...new Set(this.points.map(({ group }) => group))];
    this.tip = element('div', { class: 'tip', role: 'status' });
    this.tip.hidden = true;
    if (this.points.length) figure.append(...this.axisTitles());
    figure.append(...this.legend(), this.tip);
    if (!this.points.length) return;
    this.draw();
    this.listen();
  }

  /** Above and under the plot, where long ones can take two lines. */
  axisTitles() {
    const words = ({ label, unit }) => (unit ? `${label}, ${unit}` : label);
    return [element('p', { class: 'axis y' }, `↑ ${words(this.y)}`), element('p', { class: 'axis x' }, `${words(this.x)} →`)];
  }

  legend() {
    const items = this.groups.map((group) => element('li', {},
      svg('svg', { viewBox: '-8 -8 16 16', class: 'point best', 'aria-hidden': true }, this.shape(group)), group));
    if (this.points.some(({ onFront }) => onFront)) {
      items.push(element('li', {}, svg('svg', { viewBox: '0 0 16 16', 'aria-hidden': true },
        svg('path', { class: 'front', d: 'M1 3H8V12H15' })), 'Pareto front (filled): nothing more accurate is as fast, times within 10 % counting as equal'));
    }
    const legend = element('ul', { class: 'legend' }, ...items);
    if (!this.leftOut) return [legend];
    const text = `Not shown, for want of a figure on one of the axes: ${this.leftOut}.`;
    return [legend, element('p', { class: 'left-out' }, text)];
  }

  shape(group) {
    const n = this.groups.indexOf(group);
    const color = `var(--series-${n % SERIES})`;
    return svg('path', { class: 'shape', d: SHAPES[n % SHAPES.length], style: `fill:${color};stroke:${color}` });
  }

  draw() {
    const style = getComputedStyle(this.figure);
    const width = this.figure.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
    if (width === this.width || width <= 0) return;
    this.width = width;
    this.height = Math.round(clamp(0.62 * width, 320, 520));
    this.layOut();
    this.hideTip();
    const drawing = svg('svg', {
      viewBox: `0 0 ${width} ${this.height}`, height: this.height, role: 'group',
      'aria-label': `${this.title}: ${this.points.length} points. Arrow keys go from point to point.`,
    });
    this.figure.querySelector(':scope > svg')?.remove();
    this.figure.querySelector('.axis.x').before(drawing);
    drawing.append(...this.grid(), ...this.front());
    this.marks = this.points.map((point, n) => this.mark(point, n));
    drawing.append(...this.marks);
    this.nameFront(drawing);
  }

  /** Places of the axes; a shelf under the y axis holds what is exactly zero. */
  layOut() {
    const positive = this.points.filter(({ y }) => y > 0);
    this.shelf = positive.length < this.points.length ? 34 : 0;
    this.box = { left: 52, right: this.width - 10, top: 10, bottom: this.height - 26 };
    const { left, right, top, bottom } = this.box;
    this.floor = bottom - this.shelf;
    // A digit is 7.5 wide, a line of text 16 high.
    this.axes = [
      logAxis(this.points.map(({ x }) => x), right - left, (text) => 7.5 * text.length + 8),
      logAxis(positive.length ? positive.map(({ y }) => y) : [1], this.floor - top, () => 22),
    ];
  }

  placeX(x) {
    const { low, high } = this.axes[0];
    return this.box.left + (this.box.right - this.box.left) * (Math.log10(x) - low) / (high - low);
  }

  placeY(y) {
    const { low, high } = this.axes[1];
    if (y === 0) return this.box.bottom - this.shelf / 2;
    return this.floor - (this.floor - this.box.top) * (Math.log10(y) - low) / (high - low);
  }

  grid() {
    const { left, right, top, bottom } = this.box;
    const parts = [];
    const line = (x1, y1, x2, y2, minor) => parts.push(svg('line', { x1, y1, x2, y2, class: minor ? 'grid minor' : 'grid' }));
    const text = (x, y, anchor, kind, words) => {
      if (words) parts.push(svg('text', { x, y, 'text-anchor': anchor, class: kind }, words));
    };
    if (this.shelf) parts.push(svg('rect', { x: left, y: this.floor, width: right - left, height: this.shelf, class: 'shelf' }));
    for (const { at, text: words, minor } of this.axes[0].marks) {
      const x = this.placeX(10 ** at);
      line(x, top, x, bottom, minor);
      text(x, bottom + 18, 'middle', 'tick', words);
    }
    const marks = this.points.some(({ y }) => y > 0) ? this.axes[1].marks : [];
    for (const { at, text: words, minor } of marks) {
      const y = this.placeY(10 ** at);
      line(left, y, right, y, minor);
      text(left - 8, y + 4, 'end', 'tick', words);
    }
    if (this.shelf) text(left - 8, this.placeY(0) + 4, 'end', 'tick', 'exact');
    line(left, bottom, right, bottom);
    return parts;
  }

  /** The smallest error within each time: level until the next point of the front, then down. */
  front() {
    const best = this.points.filter(({ onFront }) => onFront);
    if (!best.length) return [];
    const steps = best.map(({ x, y }, n) => `${n ? `H${this.placeX(x)}` : `M${this.placeX(x)} ${this.box.top}`}V${this.placeY(y)}`);
    return [svg('path', { class: 'front', d: `${steps.join('')}H${this.box.right}` })];
  }

  mark(point, n) {
    const [x, y] = [this.placeX(point.x), this.placeY(point.y)];
    const made = svg('g', {
      class: point.onFront ? 'point best' : 'point', transform: `translate(${x} ${y})`,
      tabindex: n ? -1 : 0, role: 'img', 'aria-label': `${point.label}: ${this.rows(point).map((row) => row.join(' ')).join(', ')}`,
    }, svg('circle', { r: 12, class: 'hit' }), svg('circle', { r: 10, class: 'halo' }), this.shape(point.group));
    made.addEventListener('pointerenter', (event) => { if (event.pointerType === 'mouse' && !this.pinned) this.showTip(n); });
    made.addEventListener('pointerleave', () => { if (!this.pinned) this.hideTip(); });
    made.addEventListener('focus', () => this.showTip(n));
    made.addEventListener('click', () => { this.showTip(n); this.pinned = true; });
    made.addEventListener('keydown', (event) => this.key(event, n));
    return made;
  }

  rows(point) {
    const value = (axis, figure) => [axis.label, `${figure}${axis.unit ? ` ${axis.unit}` : ''}`];
    const rows = [value(this.x, point.xText), value(this.y, point.yText), ...point.details];
    return point.group === point.label ? rows : [['family', point.group], ...rows];
  }

  key(event, n) {
    const to = { ArrowRight: n + 1, ArrowLeft: n - 1, Home: 0, End: this.marks.length - 1 }[event.key];
    if (event.key === 'Escape') this.hideTip();
    const next = this.marks[to];
    if (!next) return;
    event.preventDefault();
    this.marks[n].setAttribute('tabindex', -1);
    next.setAttribute('tabindex', 0);
    next.focus();
  }

  listen() {
    addEventListener('resize', () => this.draw());
    document.addEventListener('pointerdown', (event) => {
      if (!event.target.closest('.point, .tip')) this.hideTip();
    });
    document.addEventListener('keydown', (event) => { if (event.key === 'Escape') this.hideTip(); });
    this.figure.addEventListener('focusout', (event) => {
      if (!this.pinned && !this.figure.contains(event.relatedTarget)) this.hideTip();
    });
  }

  showTip(n) {
    this.hideTip();
    const point = this.points[n];
    const rows = this.rows(point).flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]);
    this.tip.replaceChildren(element('b', {}, point.label), element('dl', {}, ...rows), ...this.leadToPicture(point));
    this.tip.hidden = false;
    this.marks[n].classList.add('shown');
    this.placeTip(this.marks[n].querySelector('.halo'));
  }

  leadToPicture({ label }) {
    const section = this.figure.closest('section');
    const pictures = [...section.querySelectorAll('.picture')];
    if (!pictures.some(({ dataset }) => dataset.label === label)) return [];
    const gallery = section.querySelector('.gallery');
    const lead = () => gallery.dispatchEvent(new CustomEvent('show-picture', { detail: label }));
    return [button({}, 'Show its picture', lead)];
  }

  /** Beside the point, on the side where there is room. */
  placeTip(halo) {
    const [box, at] = [this.figure.getBoundingClientRect(), halo.getBoundingClientRect()];
    const { offsetWidth: width, offsetHeight: height } = this.tip;
    let x = at.right - box.left + 6;
    if (x + width > box.width - 8) x = at.left - box.left - width - 6;
    const beside = x >= 8;
    const y = beside ? at.top - box.top - height / 2 + 10 : at.bottom - box.top + 6;
    this.tip.style.left = `${beside ? x : clamp(at.left - box.left - width / 2, 8, box.width - width - 8)}px`;
    this.tip.style.top = `${Math.max(8, y)}px`;
  }

  hideTip() {
    this.pinned = false;
    this.tip.hidden = true;
    this.figure.querySelector('.point.shown')?.classList.remove('shown');
  }

  /** Names the points of the front, each where it covers neither a point nor another name. */
  nameFront(drawing) {
    const taken = this.points.map(({ x, y }) => around(this.placeX(x), this.placeY(y), 8, 8));
    for (const point of this.points.filter(({ onFront }) => onFront)) {
      const name = svg('text', { class: 'name' }, point.label);
      drawing.append(name);
      const { width } = name.getBBox();
      const place = this.placesFor(point, width).find((box) => this.isFree(box, taken));
      if (place) {
        name.setAttribute('x', place.left);
        name.setAttribute('y', place.bottom - 4);
        taken.push(place);
      } else {
        name.remove();
      }
    }
  }

  placesFor({ x, y }, width) {
    const [cx, cy] = [this.placeX(x), this.placeY(y)];
    const box = (left, middle) => ({ left, right: left + width, top: middle - 8, bottom: middle + 8 });
    const sides = [cx + 11, cx - 11 - width];
    return [
      ...[-10, 0, 12, -20].flatMap((up) => sides.map((left) => box(left, cy + up))),
      box(cx - width / 2, cy - 18), box(cx - width / 2, cy + 19),
    ];
  }

  isFree(box, taken) {
    const { left, right, top, bottom } = this.box;
    const within = box.left >= left && box.right <= right && box.top >= top - 6 && box.bottom <= bottom;
    const apart = (other) => box.right < other.left || box.left > other.right || box.bottom < other.top || box.top > other.bottom;
    return within && taken.every(apart);
  }
}

function around(x, y, dx, dy) {
  return { left: x - dx, right: x + dx, top: y - dy, bottom: y + dy };
}

for (const figure of document.querySelectorAll('.scatter')) new Scatter(figure);
