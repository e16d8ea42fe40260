// The viewer: two pictures of a gallery over each other, parted by a slider or taking turns, and the
// error map of one of them beside them. All of them are moved and magnified together.

const still = matchMedia('(prefers-reduced-motion: reduce)');

class Viewer extends Magnified {
  constructor(gallery) {
    super();
    this.gallery = gallery;
    this.pictures = [...gallery.querySelectorAll('.picture')].map(pictureOf);
    this.left = 0;
    this.right = Number(gallery.dataset.opensOn ?? Math.min(1, this.pictures.length - 1));
    this.at = 50; // the slider's place, percent of the width
    this.mode = 'slider';
    this.turn = false; // flicker: that the right picture is shown
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
    const { image } = this.pictures[0];
    this.stage = this.makeStage(image, this.under, this.layer, ...this.tags, this.divider);
    this.caption = element('figcaption', { 'aria-live': 'polite' });
    this.map = element('img', { alt: '' });
    this.mapStage = this.makeStage(image, this.map);
    for (const stage of [this.stage, this.mapStage]) stage.classList.toggle('single', this.single);
    this.mapCaption = element('figcaption');
    this.panes = element('div', { class: 'panes' },
      element('figure', { class: 'pane' }, this.stage, this.caption));
    this.mapPane = element('figure', { class: 'pane' }, this.mapStage, this.mapCaption);
    this.viewer = element('div', { class: 'viewer' }, this.controls(), this.panes);
    this.gallery.prepend(this.viewer);
    this.gallery.classList.add('live');
    this.listen();
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

  listen() {
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

  /** That a pointer moves the slider, not what is magnified. */
  slides(event, stage) {
    return this.mode === 'slider' && !this.single && stage === this.stage
      && (this.zoom === 1 || event.target === this.divider);
  }

  pressed(stage) {
    if (this.mode === 'flicker' && stage === this.stage) this.flip();
  }

  spaceKey() {
    if (this.mode !== 'flicker') return false;
    this.flip();
    return true;
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

  show() {
    const [left, right] = [this.pictures[this.left], this.pictures[this.right]];
    setImage(this.under, left.image);
    setImage(this.over, right.image);
    this.tags.forEach((tag, n) => { tag.textContent = [left, right][n].label; });
    this.caption.replaceChildren(...[...new Set([left, right])].map(captionOf));
    this.showParting();
    this.showMap(right.map ? right : left);
    this.showZoom(this.viewer, [this.under, this.over, this.map]);
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

for (const gallery of document.querySelectorAll('.gallery')) new Viewer(gallery);
