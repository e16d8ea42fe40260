// One setting in two modes, side by side: the pictures are those of the modes' own sections.

class Pairs extends Magnified {
  constructor(box) {
    super();
    this.box = box;
    this.settings = JSON.parse(box.querySelector('script').textContent).map(({ label, pictures }) => ({
      label, pictures: pictures.map(found).filter(({ image }) => image),
    }));
    this.setting = 0;
    this.chosen = this.settings[0].pictures.slice(0, 2).map(({ mode }) => mode); // by the modes' titles
    this.build();
    this.show();
  }

  build() {
    this.images = [0, 1].map(() => element('img', { alt: '' }));
    this.captions = this.images.map(() => element('figcaption', { 'aria-live': 'polite' }));
    const panes = this.images.map((image, n) => {
      const stage = this.makeStage(this.settings[0].pictures[n].image, image);
      stage.classList.add('single');
      return element('figure', { class: 'pane' }, stage, this.captions[n]);
    });
    this.picks = [0, 1].map((side) => this.pickOfMode(side));
    const swap = button({ class: 'swap', title: 'Swap', 'aria-label': 'Swap the two modes' }, '⇄', () => {
      this.chosen.reverse();
      this.show();
    });
    const [left, right] = this.picks.map((pick, n) => element('label', { class: 'side' }, ['Left', 'Right'][n], pick));
    const controls = element('div', { class: 'controls' }, left, swap, right,
      element('div', { class: 'row' }, element('label', {}, 'Setting', this.pickOfSetting()), this.zoomControls()));
    this.box.append(controls, element('div', { class: 'panes both' }, ...panes));
  }

  pickOfSetting() {
    const options = this.settings.map(({ label }, n) => element('option', { value: n }, label));
    const select = element('select', { class: 'setting' }, ...options);
    select.addEventListener('change', () => {
      this.setting = Number(select.value);
      this.show();
    });
    return select;
  }

  /** All modes that have a setting in common with another; those without the present one cannot be chosen. */
  pickOfMode(side) {
    const modes = new Set(this.settings.flatMap(({ pictures }) => pictures.map(({ mode }) => mode)));
    const select = element('select', { class: side ? 'right' : 'left' }, ...[...modes].map((mode) => element('option', {}, mode)));
    select.addEventListener('change', () => {
      this.chosen[side] = select.value;
      this.show();
    });
    return select;
  }

  show() {
    const { label, pictures } = this.settings[this.setting];
    const of = (mode) => pictures.find((picture) => picture.mode === mode);
    // Of modes that do not have the setting, others take the place.
    const free = pictures.filter(({ mode }) => !this.chosen.includes(mode));
    this.chosen = this.chosen.map((mode) => (of(mode) ?? free.shift() ?? pictures[0]).mode);
    this.chosen.forEach((mode, n) => {
      setImage(this.images[n], of(mode).image);
      const caption = of(mode).caption ? ` ${of(mode).caption}` : '';
      this.captions[n].replaceChildren(element('p', {}, element('b', {}, `${mode}: ${label}`), caption));
      this.picks[n].value = mode;
      for (const option of this.picks[n].options) option.disabled = !of(option.value);
    });
    this.showZoom(this.box, this.images);
  }
}

/** A mode's picture where its section shows it. */
function found({ mode, section, label }) {
  const pictures = [...document.querySelectorAll(`#section-${section} .picture`)];
  const figure = pictures.find(({ dataset }) => dataset.label === label);
  return { mode, image: figure?.querySelector('img'), caption: figure?.dataset.caption };
}

for (const box of document.querySelectorAll('.pairs')) new Pairs(box);
