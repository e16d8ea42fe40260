// Faults of the page's own making are written where they can be seen: in the root's data-faults.
(() => {
  'use strict';
  const root = document.documentElement;
  const note = (what) => {
    root.dataset.faults = [root.dataset.faults, what].filter(Boolean).join('\n');
  };
  addEventListener('error', (event) => {
    // Errors of scripts bubble; those of images are only seen on the way down.
    note(event.message || `cannot show ${event.target.alt || event.target.nodeName}`);
  }, true);
  addEventListener('unhandledrejection', (event) => note(String(event.reason)));
  addEventListener('securitypolicyviolation', (event) => note(`refused: ${event.blockedURI}`));
})();
