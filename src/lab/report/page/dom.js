// What the other scripts share.

/** An element with its attributes and children; text is a child like any other. */
function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** A push button that does one thing. */
function button(attributes, text, press) {
  const made = element('button', { type: 'button', ...attributes }, text);
  made.addEventListener('click', press);
  return made;
}

const clamp = (value, min, max) => Math.min(Math.max(value, min), max);
