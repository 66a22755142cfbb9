/** Events of buttons, keys and the browser. */

/** @type {(id: string) => any} the elements are those of index.html */
const $ = (id) => document.getElementById(id);

/**
 * Listen to the page around the views.
 * @param {import('./studio.js').Studio} studio
 */
export function listen(studio) {
  const { board, hand, history, scene, solving } = studio;
  $('panel').addEventListener('submit', (event) => {
    event.preventDefault();
    solving.begin();
  });
  const clicks = {
    cancel: () => solving.solver.cancel(),
    reset: () => studio.reset(),
    fit: () => scene.fit(),
    'board-fit': () => board.fit(),
    another: () => studio.toggleWelcome(),
    undo: () => studio.step('undo'),
    redo: () => studio.step('redo'),
    limit: () => studio.limit.find(),
    redraw: () => studio.draw({ stage: 'draw' }),
  };
  for (const [id, act] of Object.entries(clicks)) $(id).addEventListener('click', act);
  $('colours').addEventListener('change', ({ target }) => studio.colour(target.value));
  $('more-colours').addEventListener('change', ({ target }) => studio.colour(target.value || 'regions'));
  $('hand').addEventListener('change', ({ target }) => hand.choose(target.value));
  $('downloads').addEventListener('click', ({ target }) => solving.download(target.dataset.format));
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    scene.dress();
    solving.charts.dress();
  });
  window.addEventListener('pagehide', ({ persisted }) => {
    studio.keep.hide();
    // A page in the back/forward cache keeps its result.
    if (persisted) solving.solver.stop();
    else solving.solver.reset();
  });
  window.addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && history.now && !$('welcome').hidden) studio.toggleWelcome();
    const way = wayOf(event);
    if (!way) return;
    event.preventDefault();
    studio.step(way);
  });
}

/** Return 'undo' or 'redo' for a key event, null while the user edits a field. */
function wayOf(event) {
  const typing = event.target.matches?.('input[type="text"], input[type="number"]') && event.target.value !== event.target.defaultValue;
  const key = event.key.toLowerCase();
  if (!(event.ctrlKey || event.metaKey) || typing || !['y', 'z'].includes(key)) return null;
  return key === 'z' && !event.shiftKey ? 'undo' : 'redo';
}
