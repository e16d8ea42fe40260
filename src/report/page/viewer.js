// The viewer: two pictures of a gallery over each other, parted by a slider or taking turns, and the
// error map of one of them beside them. All of them are moved and magnified together.

const MOST_ZOOM = 32;
const still = matchMedia('(prefers-reduced-motion: reduce)');

class Viewer {
  constructor(gallery) {
    this.gallery = gallery;
    this.pictures = [...gallery.querySelectorAll('.picture')].map(pictureOf);
    this.left = 0;
    this.right = Math.min(1, this.pictures.length - 1);
    this.at = 50; // the slider's place, percent of the width
    this.mode = 'slider';
    this.turn = false; // flicker: that the right picture is shown
    this.zoom = 1;
    this.center = [0.5, 0.5]; // what is in the middle, as a part of the picture
    this.build();
    this.show();
  }

  get single() { return this.pictures.length < 2; }

  build() {
    this.under = element('img', { alt: '' });
    this.over = element('img', { alt: '' });
    this.layer = element('div', { class: 'layer' }, this.over);
    this.tags = ['left', 'right'].map((side) => element('span', { class: `tag ${side}` }));
    this.divider = element('div', {
      class: 'divider', role: 'slider', tabindex: 0, 'aria-orientation': 'horizontal',
      'aria-label': 'Where the left picture ends', 'aria-valuemin': 0, 'aria-valuemax': 100,
    });
    this.stage = this.makeStage(this.under, this.layer, ...this.tags, this.divider);
    this.caption = element('figcaption', { 'aria-live': 'polite' });
    this.map = element('img', { alt: '' });
    this.mapStage = this.makeStage(this.map);
    this.mapCaption = element('figcaption');
    this.panes = element('div', { class: 'panes' },
      element('figure', { class: 'pane' }, this.stage, this.caption));
    this.mapPane = element('figure', { class: 'pane' }, this.mapStage, this.mapCaption);
    this.viewer = element('div', { class: 'viewer' }, this.controls(), this.panes);
    this.gallery.prepend(this.viewer);
    this.gallery.classList.add('live');
    this.listen();
  }

  makeStage(...children) {
    const { width, height } = this.pictures[0].image;
    const stage = element('div', {
      class: 'stage', tabindex: 0, role: 'group', style: `aspect-ratio:${width}/${height}`,
      'aria-label': 'Picture. Plus and minus magnify, arrows move what is magnified.',
    }, ...children);
    stage.classList.toggle('single', this.single);
    return stage;
  }

  controls() {
    const zoom = this.zoomControls();
    if (this.single) return element('div', { class: 'controls' }, zoom);
    this.picks = ['Left', 'Right'].map((side) => this.pick(side));
    const [left, right] = this.picks.map((select, n) => element('label', {}, ['Left', 'Right'][n], select));
    const swap = button({ class: 'swap', title: 'Swap', 'aria-label': 'Swap the two pictures' }, '⇄',
      () => this.choose(this.right, this.left));
    return element('div', { class: 'controls' }, left, swap, right,
      element('div', { class: 'row' }, this.modeControls(), this.flickerControls(), zoom));
  }

  pick(side) {
    const options = this.pictures.map(({ label }, n) => element('option', { value: n }, label));
    const select = element('select', { class: side.toLowerCase() }, ...options);
    select.addEventListener('change', () => {
      this.choose(Number(this.picks[0].value), Number(this.picks[1].value));
    });
    return select;
  }

  modeControls() {
    const mode = (name, text) => button({ 'data-mode': name }, text, () => this.setMode(name));
    this.modes = [mode('slider', 'Slider'), mode('flicker', 'Flicker')];
    return element('div', { class: 'joined', role: 'group', 'aria-label': 'How the two are compared' },
      ...this.modes);
  }

  flickerControls() {
    this.play = button({ class: 'play' }, 'Start', () => this.setPlaying(!this.timer));
    this.pace = element('input', { type: 'range', min: 0.5, max: 3, step: 0.25, value: 1.5 });
    this.pace.addEventListener('input', () => { if (this.timer) this.setPlaying(true); });
    this.flicker = element('span', { class: 'flicker' }, this.play, element('label', {}, 'Pace', this.pace));
    return this.flicker;
  }

  zoomControls() {
    const zoom = (text, label, to) => button({ 'aria-label': label }, text, () => this.magnify(to()));
    this.less = zoom('−', 'Smaller', () => this.zoom / 2);
    this.more = zoom('+', 'Larger', () => this.zoom * 2);
    this.factor = element('output', { 'aria-label': 'Magnification' });
    return element('div', { class: 'joined zoom', role: 'group', 'aria-label': 'Magnification' },
      this.less, this.factor, this.more);
  }

  listen() {
    for (const stage of [this.stage, this.mapStage]) {
      stage.addEventListener('pointerdown', (event) => this.drag(event, stage));
      stage.addEventListener('dblclick', (event) => this.magnifyThere(event, stage));
      stage.addEventListener('keydown', (event) => this.key(event));
    }
    this.divider.addEventListener('keydown', (event) => this.dividerKey(event));
    this.pictures.forEach(({ figure, label }, n) => {
      if (this.single) return;
      const choose = () => this.choose(this.left, n);
      Object.assign(figure, { tabIndex: 0, role: 'button', ariaLabel: `Show ${label} on the right` });
      figure.addEventListener('click', choose);
      figure.addEventListener('keydown', (event) => {
        if (event.key !== 'Enter' && event.key !== ' ') return;
        event.preventDefault();
        choose();
      });
    });
    this.gallery.addEventListener('show-picture', (event) => {
      const n = this.pictures.findIndex(({ label }) => label === event.detail);
      if (n >= 0) this.choose(this.left, n);
      this.gallery.scrollIntoView({ block: 'nearest' });
    });
  }

  choose(left, right) {
    [this.left, this.right] = [left, right];
    this.show();
  }

  setMode(mode) {
    this.mode = mode;
    this.setPlaying(mode === 'flicker' && !still.matches);
  }

  setPlaying(playing) {
    clearInterval(this.timer);
    const takeTurns = () => { this.turn = !this.turn; this.show(); };
    this.timer = playing ? setInterval(takeTurns, 1000 / this.pace.value) : undefined;
    this.show();
  }

  magnify(zoom) {
    this.zoom = clamp(zoom, 1, MOST_ZOOM);
    this.move(0, 0);
  }

  /** Moves the middle by parts of the picture, as far as there is picture. */
  move(x, y) {
    const margin = 0.5 / this.zoom;
    this.center = [this.center[0] + x, this.center[1] + y].map((c) => clamp(c, margin, 1 - margin));
    this.show();
  }

  magnifyThere(event, stage) {
    const [x, y] = placeIn(stage, event);
    if (this.zoom >= MOST_ZOOM) return this.magnify(1);
    this.center = this.center.map((c, axis) => c + ([x, y][axis] - 0.5) / this.zoom / 2);
    return this.magnify(2 * this.zoom);
  }

  /** Follows a pointer until it is let go: the slider, or what is magnified. */
  drag(event, stage) {
    if (event.button > 0) return;
    const slides = this.mode === 'slider' && !this.single && stage === this.stage
      && (this.zoom === 1 || event.target === this.divider);
    if (!slides && this.zoom === 1) {
      if (this.mode === 'flicker' && stage === this.stage) this.flip();
      return;
    }
    let last = placeIn(stage, event);
    const follow = (moved) => {
      const place = placeIn(stage, moved);
      if (slides) this.slideTo(100 * place[0]);
      else this.move((last[0] - place[0]) / this.zoom, (last[1] - place[1]) / this.zoom);
      last = place;
    };
    const end = new AbortController();
    const until = { signal: end.signal };
    addEventListener('pointermove', follow, until);
    for (const name of ['pointerup', 'pointercancel']) addEventListener(name, () => end.abort(), until);
    if (slides) follow(event);
  }

  /** A press shows the other picture, while they do not take turns by themselves. */
  flip() {
    if (this.timer) return;
    this.turn = !this.turn;
    this.show();
  }

  slideTo(at) {
    this.at = clamp(at, 0, 100);
    this.show();
  }

  dividerKey(event) {
    const steps = { ArrowLeft: -2, ArrowDown: -2, ArrowRight: 2, ArrowUp: 2, PageUp: 10, PageDown: -10, Home: -100, End: 100 };
    if (!(event.key in steps)) return;
    event.preventDefault();
    event.stopPropagation();
    this.slideTo(this.at + steps[event.key]);
  }

  key(event) {
    const step = 0.1 / this.zoom;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    const zooms = { '+': 2 * this.zoom, '=': 2 * this.zoom, '-': this.zoom / 2, 0: 1 };
    if (event.key in zooms) this.magnify(zooms[event.key]);
    else if (event.key in moves && this.zoom > 1) this.move(...moves[event.key]);
    else if (event.key === ' ' && this.mode === 'flicker') this.flip();
    else return;
    event.preventDefault();
  }

  show() {
    const [left, right] = [this.pictures[this.left], this.pictures[this.right]];
    setImage(this.under, left.image);
    setImage(this.over, right.image);
    this.tags.forEach((tag, n) => { tag.textContent = [left, right][n].label; });
    this.caption.replaceChildren(...[...new Set([left, right])].map(captionOf));
    this.showParting();
    this.showMap(right.map ? right : left);
    this.showZoom();
    this.showControls();
    this.pictures.forEach(({ figure }, n) => figure.setAttribute('aria-current', !this.single && n === this.right));
  }

  showParting() {
    const slides = this.mode === 'slider';
    this.layer.style.clipPath = slides ? `inset(0 0 0 ${this.at}%)` : 'none';
    this.layer.hidden = this.single || !(slides || this.turn);
    this.divider.hidden = this.single || !slides;
    this.divider.style.left = `${this.at}%`;
    this.divider.setAttribute('aria-valuenow', Math.round(this.at));
    this.tags[0].hidden = this.single || (slides ? this.at < 12 : this.turn);
    this.tags[1].hidden = this.single || (slides ? this.at > 88 : !this.turn);
  }

  showMap(picture) {
    this.mapPane.remove();
    this.panes.classList.toggle('both', Boolean(picture.map));
    if (!picture.map) return;
    setImage(this.map, picture.map.querySelector('img'));
    const title = element('p', {}, element('b', {}, `Error of ${picture.label}`), ` against ${this.pictures[0].label}`);
    this.mapCaption.replaceChildren(title, picture.map.querySelector('.key').cloneNode(true));
    this.panes.append(this.mapPane);
  }

  showZoom() {
    const [x, y] = this.center.map((c) => 100 * (0.5 - c * this.zoom));
    for (const image of [this.under, this.over, this.map]) {
      image.style.transform = this.zoom === 1 ? '' : `translate(${x}%,${y}%) scale(${this.zoom})`;
    }
    this.viewer.classList.toggle('zoomed', this.zoom > 1);
    this.factor.textContent = this.zoom === 1 ? 'fit' : `${this.zoom}×`;
    this.less.disabled = this.zoom === 1;
    this.more.disabled = this.zoom === MOST_ZOOM;
  }

  showControls() {
    if (this.single) return;
    [this.picks[0].value, this.picks[1].value] = [this.left, this.right];
    for (const made of this.modes) made.setAttribute('aria-pressed', made.dataset.mode === this.mode);
    this.flicker.hidden = this.mode !== 'flicker';
    this.play.textContent = this.timer ? 'Stop' : 'Start';
  }
}

function pictureOf(figure) {
  const { label, caption } = figure.dataset;
  return { figure, label, caption, image: figure.querySelector('img'), map: figure.querySelector('.map') };
}

function captionOf({ label, caption }) {
  return element('p', {}, element('b', {}, label), ` ${caption}`);
}

function setImage(image, from) {
  if (image.shownFrom === from) return;
  Object.assign(image, { shownFrom: from, src: from.src, alt: from.alt });
}

/** Where a pointer is in an element, as parts of its width and height. */
function placeIn(stage, event) {
  const box = stage.getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
}

for (const gallery of document.querySelectorAll('.gallery')) new Viewer(gallery);
