// What viewers share: pictures in stages that are moved and magnified together.

const MAX_ZOOM = 32;

class Magnified {
  zoom = 1;

  center = [0.5, 0.5]; // what is in the middle, as a part of the picture

  /** A place for pictures of the size of `image`. */
  makeStage({ width, height }, ...children) {
    const stage = element('div', {
      class: 'stage', tabindex: 0, role: 'group', style: `aspect-ratio:${width}/${height}`,
      'aria-label': 'Picture. Plus and minus magnify, arrows move what is magnified.',
    }, ...children);
    stage.addEventListener('pointerdown', (event) => this.drag(event, stage));
    stage.addEventListener('dblclick', (event) => this.magnifyThere(event, stage));
    stage.addEventListener('keydown', (event) => this.key(event));
    return stage;
  }

  /** Whether a pointer that goes down moves something else than what is magnified. */
  slides() { return false; }

  /** A press where nothing is magnified. */
  pressed() {}

  /** Whether the space bar did something. */
  spaceKey() { return false; }

  zoomControls() {
    const zoom = (text, label, to) => button({ 'aria-label': label }, text, () => this.magnify(to()));
    this.less = zoom('−', 'Smaller', () => this.zoom / 2);
    this.more = zoom('+', 'Larger', () => this.zoom * 2);
    this.factor = element('output', { 'aria-label': 'Magnification' });
    return element('div', { class: 'joined zoom', role: 'group', 'aria-label': 'Magnification' },
      this.less, this.factor, this.more);
  }

  magnify(zoom) {
    this.zoom = clamp(zoom, 1, MAX_ZOOM);
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
    if (this.zoom >= MAX_ZOOM) return this.magnify(1);
    this.center = this.center.map((c, axis) => c + ([x, y][axis] - 0.5) / this.zoom / 2);
    return this.magnify(2 * this.zoom);
  }

  /** Follows a pointer until it is let go: the slider, or what is magnified. */
  drag(event, stage) {
    if (event.button > 0) return;
    const slides = this.slides(event, stage);
    if (!slides && this.zoom === 1) {
      this.pressed(stage);
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

  key(event) {
    const step = 0.1 / this.zoom;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    const zooms = { '+': 2 * this.zoom, '=': 2 * this.zoom, '-': this.zoom / 2, 0: 1 };
    if (event.key in zooms) this.magnify(zooms[event.key]);
    else if (event.key in moves && this.zoom > 1) this.move(...moves[event.key]);
    else if (event.key !== ' ' || !this.spaceKey()) return;
    event.preventDefault();
  }

  /** Shows what is magnified in all `images`, which lie in `frame`. */
  showZoom(frame, images) {
    const [x, y] = this.center.map((c) => 100 * (0.5 - c * this.zoom));
    for (const image of images) {
      image.style.transform = this.zoom === 1 ? '' : `translate(${x}%,${y}%) scale(${this.zoom})`;
    }
    frame.classList.toggle('zoomed', this.zoom > 1);
    this.factor.textContent = this.zoom === 1 ? 'fit' : `${this.zoom}×`;
    this.less.disabled = this.zoom === 1;
    this.more.disabled = this.zoom === MAX_ZOOM;
  }
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
