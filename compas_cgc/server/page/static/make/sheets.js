/** Flat patterns and drawings on their sheets. */

/**
 * Draw patterns or views into an SVG.
 * @param {SVGSVGElement} svg
 * @param {any} told result of an unroll or drawings job
 */
export function drawSheets(svg, told) {
  const points = told.lines.flatMap((line) => line.points);
  const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
  const [low, high] = [xs, ys].map((values) => [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)]);
  const margin = 0.03 * Math.max(low[1] - low[0], high[1] - high[0]);
  svg.setAttribute('viewBox', [low[0] - margin, -high[1] - margin, low[1] - low[0] + 2 * margin, high[1] - high[0] + 2 * margin].join(' '));
  const make = (tag, attributes, text = '') => {
    const made = document.createElementNS(svg.namespaceURI, tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
    made.textContent = text;
    return made;
  };
  const layers = new Map();
  for (const { layer, points: own, closed } of told.lines) {
    const path = `M${own.map(([x, y]) => `${x.toPrecision(6)} ${(-y).toPrecision(6)}`).join('L')}${closed ? 'Z' : ''}`;
    layers.set(layer, (layers.get(layer) ?? '') + path);
  }
  svg.replaceChildren(
    ...[...layers].map(([layer, d]) => make('path', { class: `sheet-line ${layer.toLowerCase()}`, stroke: told.layers[layer] ?? '#888888', d })),
    ...told.texts
      .filter(({ layer }) => layer !== 'NODE' && layer !== 'LEGEND')
      .map(({ text, at, height, angle = 0 }) => {
        const place = { x: at[0], y: -at[1], transform: `rotate(${-angle} ${at[0]} ${-at[1]})` };
        return make('text', { ...place, 'font-size': height, class: 'sheet-text' }, text);
      }),
  );
}
