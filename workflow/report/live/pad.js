"use strict";
// The switch on the curves of a pad, as mesoscale/pad/memory.py and mesoscale/device/pad_switch.py compute it.
const VACUUM_PERMITTIVITY = 8.8541878128e-12; // F/m, CODATA 2018
const PAD_FLOOR_GPa = 1e-13; // repulsion of 0.1 Pa counts as none
const PAD_POINTS = 400;

function numbersOf(text) { // base64 of floats
  return new Float64Array(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
}

function placeOf(sorted, x) { // number of entries below x
  let low = 0;
  let high = sorted.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] < x) low = middle + 1; else high = middle;
  }
  return low;
}

function interpolated(x, xs, ys) { // linear; the ends are held
  const last = xs.length - 1;
  if (x <= xs[0]) return ys[0];
  if (x >= xs[last]) return ys[last];
  const k = Math.max(placeOf(xs, x), 1);
  return ys[k - 1] + ((ys[k] - ys[k - 1]) / (xs[k] - xs[k - 1])) * (x - xs[k - 1]);
}

function evenly(from, to, count) {
  return Float64Array.from({ length: count }, (_, i) => (i === count - 1 ? to : from + (i * (to - from)) / (count - 1)));
}

class OutOfRange extends Error {}

class PadLaw {
  // `values` in GPa: repulsion and attraction of the closing, then of the opening from each depth; near to far
  constructor(separation, depth, values, far, adhesion) {
    let place = 0;
    const branch = (from) => {
      const count = separation.length - from;
      const pushes = values.subarray(place, place + count);
      const pulls = values.slice(place + count, place + 2 * count).map((value) => adhesion * value);
      place += 2 * count;
      return { separation: separation.subarray(from), pushes, pulls };
    };
    const { pushes, pulls } = branch(0);
    Object.assign(this, { separation, depth, pushes, pulls, hamaker: adhesion * far.hamaker, offset: far.offset_nm });
    this.net = pushes.map((value, i) => value + pulls[i]);
    this.opening = Array.from(depth, (deep) => branch(placeOf(separation, deep - 1e-9)));
    this.near = separation[0];
    this.far = separation[separation.length - 1];
  }

  static read(data, adhesion) { // the mean pad
    const [separation, depth, mean] = [data.separation_nm, data.depth_nm, data.mean].map(numbersOf);
    return new PadLaw(separation, depth, mean, data.flats, adhesion);
  }

  flats(s) { return -this.hamaker / (6 * Math.PI * (Math.max(s, 1) + this.offset) ** 3); }

  closing(s) { // net pressure in GPa
    if (s < this.near) throw new OutOfRange("the switch presses the pad harder than its curves reach");
    if (s > this.far) return this.flats(s);
    return interpolated(s, this.separation, this.pushes) + interpolated(s, this.separation, this.pulls);
  }

  between(deepest) { // the computed depths on either side, and the share of the shallower one
    const last = this.depth.length - 1;
    if (!(deepest >= this.depth[0] && deepest <= this.depth[last])) {
      throw new OutOfRange("the switch is held at a depth from which the pad was not opened");
    }
    const upper = Math.min(Math.max(placeOf(this.depth, deepest), 1), last);
    return [upper, (deepest - this.depth[upper - 1]) / (this.depth[upper] - this.depth[upper - 1])];
  }

  rising(deepest) { // net pressure in GPa against separation, on opening from `deepest`
    const [upper, share] = this.between(deepest);
    const [shallow, deep] = [this.opening[upper], this.opening[upper - 1]];
    const [shallowest, deeper] = [this.depth[upper], this.depth[upper - 1]];
    const mixed = (key, sign, risen) => {
      const one = sign * interpolated(deeper + risen, deep.separation, deep[key]);
      const other = sign * interpolated(shallowest + risen, shallow.separation, shallow[key]);
      return Math.exp((1 - share) * Math.log(Math.max(one, PAD_FLOOR_GPa)) + share * Math.log(Math.max(other, PAD_FLOOR_GPa)));
    };
    return (s) => {
      const risen = Math.max(s, deepest) - deepest;
      if (deepest + risen > this.far) return this.flats(deepest + risen);
      const repulsion = mixed("pushes", 1, risen);
      return (repulsion > 2 * PAD_FLOOR_GPa ? repulsion : 0) - mixed("pulls", -1, risen);
    };
  }
}

class PlateSwitch { // spring_N_per_m, gap_nm, area_m2, dielectric_nm (thickness over permittivity)
  constructor(parts) { Object.assign(this, parts); }

  balance(s, pressure_GPa) { // square of the voltage that holds the plate at s
    const force = this.spring_N_per_m * (this.gap_nm - s) * 1e-9 + this.area_m2 * pressure_GPa * 1e9;
    return this.perNewton(s) * force;
  }

  perNewton(s) { return (2 * ((s + this.dielectric_nm) * 1e-9) ** 2) / (VACUUM_PERMITTIVITY * this.area_m2); }
}

function largest(values, from = 0, to = values.length) {
  let best = from;
  for (let i = from; i < to; i++) if (values[i] > values[best]) best = i;
  return best;
}

function solveOnPad(plate, law, hold_V) {
  if (law.far >= plate.gap_nm) throw new OutOfRange("the gap is smaller than the reach of the pad's curves");
  const [start, stop] = [Math.log10(law.far), Math.log10(plate.gap_nm)];
  const outside = evenly(start, stop, PAD_POINTS).map((power) => 10 ** power);
  outside[PAD_POINTS - 1] = plate.gap_nm;
  const grid = Float64Array.from([...law.separation, ...outside.slice(1)]);
  const down = grid.map((s) => plate.balance(s, law.closing(s)));
  const contact = law.separation.length;
  const peak = largest(down, contact);
  const around = evenly(grid[peak - 1], grid[Math.min(peak + 1, grid.length - 1)], PAD_POINTS);
  const pullIn = around.reduce((most, s) => Math.max(most, plate.balance(s, law.closing(s))), -Infinity);
  const hold = hold_V === null ? pullIn : hold_V ** 2;
  let inner = -1;
  for (let i = 0; i < contact; i++) if (down[i] >= hold) inner = i;
  if (inner < 0) throw new OutOfRange("the switch presses the pad harder than its curves reach");
  if (inner + 1 === contact) throw new OutOfRange("the hold voltage does not keep the switch on the pad");
  let [near, away] = [grid[inner], grid[inner + 1]];
  for (let k = 0; k < 80; k++) {
    const middle = (near + away) / 2;
    if (plate.balance(middle, law.closing(middle)) >= hold) near = middle; else away = middle;
  }
  const held = (near + away) / 2;
  const wayUp = [held, ...grid.filter((s) => s > held)];
  const pressure = law.rising(held);
  const net = wayUp.map(pressure);
  const up = wayUp.map((s, i) => plate.balance(s, net[i]));
  const barrier = largest(up, wayUp.findIndex((s) => s > law.far));
  const release = Math.min(...up.slice(0, barrier + 1));
  return {
    pull_in_V: Math.sqrt(pullIn),
    hold_nm: held,
    hold_MPa: law.closing(held) * 1e3,
    release_V: Math.sqrt(Math.max(release, 0)),
    stuck: release <= 0,
    deepest_net_kPa: -Math.min(...net) * 1e6,
  };
}
