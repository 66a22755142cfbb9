/** Resolution of frames: without a graphics card, antialiasing takes half of the time of a frame, so it is replaced by more pixels at rest. */

const COARSE = 0.5; // pixel ratio during motion, relative to the page
const FINER = 1.5; // pixel ratio at rest without a graphics card
const PICTURE = 2; // pixel ratio of saved pictures
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i; // names of software renderers

/** Pixel ratios relative to the page. */
export class Sharpness {
  constructor() {
    /** Whether antialiasing is enabled. */
    this.smoothed = hasCard();
  }

  get ratio() {
    return Math.min(2, window.devicePixelRatio);
  }

  /** Pixel ratio at rest. */
  get fine() {
    return this.smoothed ? this.ratio : Math.min(2, FINER * this.ratio);
  }

  /** Pixel ratio during motion. */
  get coarse() {
    return COARSE * this.ratio;
  }

  /** Pixel ratio of saved pictures. */
  get ofPictures() {
    return this.smoothed ? PICTURE : 2 * PICTURE;
  }

  /**
   * Return the content of a canvas as a picture.
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

/** Check whether rendering uses a graphics card. */
function hasCard() {
  const probe = document.createElement('canvas').getContext('webgl2', { failIfMajorPerformanceCaveat: true });
  if (!probe) return false;
  let name = probe.getParameter(probe.RENDERER);
  // Chromium hides the name behind an extension, whose use is deprecated in Firefox.
  if (name === 'WebKit WebGL') name = probe.getParameter(probe.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? probe.RENDERER);
  probe.getExtension('WEBGL_lose_context')?.loseContext();
  return !SOFTWARE.test(name);
}
