// What the run has sent: its newest row, and for each chosen signal the samples of the last minutes.
// The buffers have twice the length that is shown; when full, the newer half moves to the front: nothing is allocated.
const HEAD = 8;

export class Samples {
  constructor(description) {
    this.columns = new Map(description.columns.map((column, index) => [column.name, index]));
    this.row = new Float64Array(description.columns.length);
    this.lost = 0;
    this.latencyMs = 0;
    this.choose([], 1, 1000);
  }

  // Empty buffers for these signals; `kept` points of each are shown at most.
  choose(names, number, kept) {
    this.names = names;
    this.number = number;
    this.kept = kept;
    this.times = new Float64Array(2 * kept);
    this.values = names.map(() => new Float64Array(2 * kept));
    this.end = 0;
  }

  // Take a block of newest rows; false where it belongs to a selection that is no longer wanted.
  take(block) {
    const [, number, wallMs, points, signals, lost, width] = block;
    this.row = block.subarray(HEAD, HEAD + width);
    this.lost += lost;
    this.latencyMs = performance.timeOrigin + performance.now() - wallMs;
    if (number !== this.number || signals !== this.names.length || points === 0) return points === 0;
    this.append(block, HEAD + width, points, signals);
    return true;
  }

  append(block, at, points, signals) {
    const most = Math.min(points, this.kept);
    if (this.end + most > this.times.length) this.moveDown();
    const skipped = points - most;
    this.times.set(block.subarray(at + skipped, at + points), this.end);
    for (let i = 0; i < signals; i += 1) {
      const from = at + points * (i + 1);
      this.values[i].set(block.subarray(from + skipped, from + points), this.end);
    }
    this.end += most;
  }

  moveDown() {
    const from = this.end - this.kept;
    for (const buffer of [this.times, ...this.values]) buffer.copyWithin(0, from, this.end);
    this.end = this.kept;
  }

  // Put older samples in front of those that have come; what overlaps is left out.
  prepend(block) {
    const points = block[3];
    const signals = block[4];
    if (signals !== this.names.length) return;
    const times = block.subarray(HEAD, HEAD + points);
    const first = this.end ? this.times[0] : Infinity;
    let count = points;
    while (count > 0 && times[count - 1] >= first) count -= 1;
    const room = Math.min(count, this.kept, this.times.length - this.end);
    const put = (buffer, from) => {
      buffer.copyWithin(room, 0, this.end);
      buffer.set(block.subarray(from + count - room, from + count), 0);
    };
    put(this.times, HEAD);
    this.values.forEach((buffer, i) => put(buffer, HEAD + points * (i + 1)));
    this.end += room;
  }

  get timeS() {
    return this.row[1] / 1e9;
  }

  // The newest value of a column, by its full name or that of an output, a count or an input.
  value(name) {
    return this.row[this.place(name)];
  }

  place(name) {
    for (const prefix of ["", "out.", "status.", "in."]) {
      const index = this.columns.get(prefix + name);
      if (index !== undefined) return index;
    }
    throw new Error(`there is no signal ${name}`);
  }

  // Times and values of these signals as views into the buffers, of the last `kept` points.
  shown(names) {
    const from = Math.max(0, this.end - this.kept);
    const places = names.map((name) => this.names.indexOf(name));
    const empty = new Float64Array(this.end - from);
    return [
      this.times.subarray(from, this.end),
      ...places.map((i) => (i < 0 ? empty : this.values[i].subarray(from, this.end))),
    ];
  }
}

// The times and values of a block that answers for a stretch of time.
export function stretchOf(block) {
  const [, , , points, signals] = block;
  const part = (i) => block.subarray(HEAD + points * i, HEAD + points * (i + 1));
  return Array.from({ length: signals + 1 }, (_, i) => part(i));
}
