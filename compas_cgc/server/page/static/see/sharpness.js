/** How many pixels are drawn: without a graphics card smoothed edges take half of the time of a frame, and more pixels at rest smooth them as well. */

const COARSE = 0.5; // of the page's pixels, while something moves
const FINER = 1.5; // of them, at rest and without a graphics card
const PICTURE = 2; // of them, in pictures
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i; // what renders where there is no card

/** Ratios of the pixels that are drawn to those of the page. */
export class Sharpness {
  constructor() {
    /** Whether the graphics card smooths edges by itself. */
    this.smoothed = hasCard();
  }

  get ratio() {
    return Math.min(2, window.devicePixelRatio);
  }

  /** At rest. */
  get fine() {
    return this.smoothed ? this.ratio : Math.min(2, FINER * this.ratio);
  }

  /** While something moves. */
  get coarse() {
    return COARSE * this.ratio;
  }

  /** Of what becomes a picture. */
  get ofPictures() {
    return this.smoothed ? PICTURE : 2 * PICTURE;
  }

  /**
   * Return what a canvas shows now as a picture.
   * @param {HTMLCanvasElement} canvas
   * @returns {Promise<Blob>}
   */
  picture(canvas) {
    const part = PICTURE / this.ofPictures;
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [Math.round(part * canvas.width), Math.round(part * canvas.height)];
    const pen = copy.getContext('2d');
    pen.imageSmoothingQuality = 'high';
    pen.drawImage(canvas, 0, 0, copy.width, copy.height);
    return new Promise((resolve) => copy.toBlob(resolve));
  }
}

/** Tell whether there is a graphics card, and not a processor that stands in for it. */
function hasCard() {
  const probe = document.createElement('canvas').getContext('webgl2', { failIfMajorPerformanceCaveat: true });
  if (!probe) return false;
  let name = probe.getParameter(probe.RENDERER);
  // Chromium tells no more than this by the name; Firefox complains of who asks in this way.
  if (name === 'WebKit WebGL') name = probe.getParameter(probe.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? probe.RENDERER);
  probe.getExtension('WEBGL_lose_context')?.loseContext();
  return !SOFTWARE.test(name);
}
