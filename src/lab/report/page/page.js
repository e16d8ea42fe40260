// What is left: the command is copied by a press, and a test can see that all of the page is there.

function copyable(box) {
  const button = box.querySelector('.copy');
  const code = box.querySelector('code');
  // Words stay whole where the line ends, such as a flag with its hyphens.
  const words = code.textContent.split(' ').map((word) => element('span', {}, word));
  code.replaceChildren(...words.flatMap((word, n) => (n ? [' ', word] : [word])));
  const announce = (text) => {
    button.textContent = text;
    setTimeout(() => { button.textContent = 'Copy'; }, 2000);
  };
  // Where the clipboard is out of reach the text is at least selected.
  const select = () => {
    getSelection().selectAllChildren(code);
    announce('Selected');
  };
  button.addEventListener('click', () => {
    if (!navigator.clipboard) return select();
    return navigator.clipboard.writeText(code.textContent).then(() => announce('Copied'), select);
  });
  button.hidden = false;
}

function count() {
  const images = [...document.images];
  const loaded = images.filter((image) => image.complete && image.naturalWidth > 0);
  document.documentElement.dataset.imagesLoaded = `${loaded.length}/${images.length}`;
}

document.querySelectorAll('.command').forEach(copyable);
if (document.readyState === 'complete') count();
else addEventListener('load', count);
