/** The start page. The modules for drawing and solving are loaded with the first design. */

import { Api } from './api.js';
import { Keep } from './design/keep.js';
import { fromFragment, unpacked } from './design/packing.js';
import { emptyPlan } from './draw/plan.js';
import { edgeDialog } from './edgedialog.js';
import { guardNumberFields } from './fields.js';
import { keyDialog } from './keydialog.js';
import { rationaliseDoor } from './rationalise/door.js';
import { Welcome } from './welcome.js';

const MARK = '#design=';
const SHARED = '#shared=';

guardNumberFields();

/** @type {(id: string) => any} the elements are those of index.html */
const $ = (id) => document.getElementById(id);

const api = new Api(keyDialog($('key')));
const keep = new Keep();
const welcome = new Welcome($('welcome'), api, {
  open: async (data, again) => (await studio()).open(data, again),
  draw: (plan, name) => begin({ stage: 'draw', name, plan: plan ?? emptyPlan(), data: null }),
  state: begin,
  edge: edgeDialog($('edge')),
  design: (file, dropped) => door.offer(file, dropped),
});
const door = rationaliseDoor($('rationalise'), api, {
  open: async (data) => {
    const shown = await studio();
    shown.open(data);
    shown.solving.begin();
  },
  say: (text) => welcome.say(text),
});
$('rationalise-begin').addEventListener('click', door.show);
/** @type {?Promise<import('./studio.js').Studio>} */
let opened = null;

/** Return the studio, which is created once. */
async function studio() {
  opened ??= import('./studio.js').then(({ Studio }) => new Studio(api, keep, { offer, say: (text) => welcome.say(text) }));
  try {
    return await opened;
  } catch (error) {
    throw new Error(`The 3D view cannot start: ${error.message}. Use a browser with WebGL enabled.`);
  }
}

/**
 * Open a design.
 * @param {import('./types.js').State} state
 */
async function begin(state) {
  try {
    (await studio()).begin(state);
  } catch (error) {
    welcome.say(error.message);
  }
}

/** List the stored designs. */
async function offer() {
  welcome.offer(await keep.all(), {
    take: (design) => {
      keep.leave();
      keep.take(design.id, design.revision ?? 0);
      begin(design);
    },
    drop: ({ id }) => keep.drop(id),
  });
}

/** Open the design in the link or of this tab. */
async function restore() {
  if (location.hash === '#new') {
    history.replaceState(null, '', location.pathname);
    keep.leave();
  }
  try {
    if (location.hash.startsWith(MARK)) {
      const state = await fromFragment(location.hash.slice(MARK.length));
      history.replaceState(null, '', location.pathname);
      keep.leave();
      await begin(state);
      return;
    }
    if (location.hash.startsWith(SHARED)) {
      const { content, mode } = await api.shared(location.hash.slice(SHARED.length));
      keep.leave();
      await begin({ ...(await unpacked(content)), only: mode === 'view' });
      // A view stays where its link is, a copy becomes a design of this browser.
      if (mode !== 'view') history.replaceState(null, '', location.pathname);
      return;
    }
  } catch (error) {
    welcome.say(error.message);
  }
  const mine = await keep.mine();
  if (mine) await begin(mine);
  else await offer();
}

window.addEventListener('hashchange', restore);
// A link leaves what this tab has shown.
if (location.hash) door.leave();
else door.resume();
restore();
