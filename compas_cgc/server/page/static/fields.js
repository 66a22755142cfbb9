/** Number fields: text fields that read numbers alike in every locale. */

const NUMBER = /^[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[+-]?\d+)?$/i;
const UNREAD = 'Type a number such as 12.5 or 12,5, without separators between groups of digits.';

/**
 * Return the number in a text. The decimal sign is a point or a comma; grouped digits are not read.
 * @param {string} text
 * @returns {number} NaN where there is none
 */
export function numberIn(text) {
  const clean = text.trim().replace('−', '-');
  return NUMBER.test(clean) ? Number(clean.replace(',', '.')) : NaN;
}

/**
 * Return the number in a field.
 * @param {HTMLElement} field
 * @returns {number} NaN in an empty field
 */
export function numberOf(field) {
  return numberIn(field.value);
}

/**
 * Show a number in a field.
 * @param {HTMLElement} field
 * @param {?number | string} [value]
 */
export function showNumber(field, value) {
  field.value = String(value ?? '');
  field.setCustomValidity('');
}

/**
 * Make a field for numbers.
 * @param {HTMLElement} field
 * @param {object} [more] further properties
 * @returns {HTMLElement}
 */
export function asNumberField(field, more = {}) {
  Object.assign(field, { type: 'text', inputMode: 'decimal', autocomplete: 'off', ...more });
  field.classList.add('number');
  return field;
}

/** Keep texts that are not numbers, or lie outside the bounds of their field, from everyone who listens for changes; say why. */
export function guardNumberFields() {
  /** @type {(event: any) => boolean} */
  const isNumber = ({ target }) => target instanceof HTMLInputElement && target.classList.contains('number');
  document.addEventListener('input', (/** @type {any} */ event) => isNumber(event) && event.target.setCustomValidity(''), true);
  document.addEventListener(
    'change',
    (/** @type {any} */ event) => {
      if (!isNumber(event)) return;
      event.target.setCustomValidity(faultOf(event.target));
      if (event.target.reportValidity()) return;
      event.stopImmediatePropagation();
    },
    true,
  );
}

function faultOf(field) {
  if (!field.value.trim()) return '';
  const value = numberOf(field);
  const { min, max, whole } = field.dataset;
  if (!Number.isFinite(value)) return UNREAD;
  if (whole && !Number.isInteger(value)) return 'Type a whole number.';
  if (value < Number(min ?? -Infinity)) return `Type a number of at least ${min}.`;
  return value > Number(max ?? Infinity) ? `Type a number of at most ${max}.` : '';
}
