/** The numbers below the slider of moulds, with a bar for the distance of every number that was solved. */

/** One column per number. */
export class Stops {
  /** @param {HTMLElement} room */
  constructor(room) {
    this.columns = Array.from({ length: Number(room.dataset.count) }, (_, k) => {
      const [column, bar, number] = ['span', 'i', 'b'].map((tag) => document.createElement(tag));
      number.textContent = String(k + 1);
      column.append(bar, number);
      room.append(column);
      return { column, bar };
    });
  }

  /**
   * Show the distances that are known.
   * @param {Map<number, number>} distances by number of moulds
   */
  show(distances) {
    const most = Math.max(...distances.values());
    this.columns.forEach(({ bar }, k) => {
      const own = distances.get(k + 1);
      bar.hidden = own === undefined;
      bar.style.height = `${Math.max(6, (100 * (own ?? 0)) / most)}%`;
    });
  }

  /** @param {number} number of moulds that is shown */
  choose(number) {
    this.columns.forEach(({ column }, k) => column.classList.toggle('now', k + 1 === number));
  }
}
