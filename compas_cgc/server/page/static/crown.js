/** A handle on the highest point, moved by pointer or keys, that sets the rise. */

/** The handle. */
export class Crown {
  /**
   * @param {HTMLElement} handle
   * @param {import('./scene.js').Scene} scene
   * @param {(rise: number) => void} change
   */
  constructor(handle, scene, change) {
    this.handle = handle;
    this.scene = scene;
    this.change = change;
    this.on = false;
    this.rise = 0;
    let from = null;
    handle.addEventListener('pointerdown', (event) => {
      handle.setPointerCapture(event.pointerId);
      from = { y: event.clientY, rise: this.rise, scale: this.scale };
    });
    handle.addEventListener('pointermove', (event) => {
      if (from) this.set(from.rise + (from.y - event.clientY) * from.scale);
    });
    for (const name of ['pointerup', 'pointercancel']) handle.addEventListener(name, () => (from = null));
    handle.addEventListener('keydown', (event) => {
      const steps = { ArrowUp: 1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
      if (!steps) return;
      event.preventDefault();
      this.set(this.rise + steps * 0.005 * this.reach);
    });
  }

  set(rise) {
    if (Number.isFinite(rise)) this.change(Number(rise.toPrecision(3)));
  }

  /**
   * Update the handle for a surface.
   * @param {import('./model.js').Model} model
   * @param {ArrayLike<number>} xyz
   * @param {number[]} held
   */
  show(model, xyz, held) {
    const level = held.reduce((sum, vertex) => sum + xyz[3 * vertex + 2], 0) / (held.length || 1);
    this.vertex = 0;
    for (let v = 0; v < xyz.length / 3; v++) if (xyz[3 * v + 2] > xyz[3 * this.vertex + 2]) this.vertex = v;
    this.rise = xyz[3 * this.vertex + 2] - level;
    this.model = model;
    this.reach = Math.max(model.span[0], model.span[1]);
    this.handle.ariaValueNow = this.rise.toPrecision(3);
    this.handle.ariaValueMax = this.reach.toPrecision(3);
  }

  /** Move the handle to the highest point. */
  place() {
    const { surface } = this.scene;
    this.handle.hidden = !(this.on && surface && this.model === surface.model);
    if (this.handle.hidden) return;
    const [x, y, pixels] = this.scene.onScreen(surface.xyz, this.vertex);
    this.scale = this.model.size / pixels;
    this.handle.style.translate = `${x.toFixed(1)}px ${y.toFixed(1)}px`;
  }
}
