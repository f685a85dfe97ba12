"use strict";
// A clamped beam on a pad, as mesoscale/device/beam.py, beam_switch.py and mesoscale/pad/local.py compute it.
const GAUSS_AT = [-0.8611363115940526, -0.33998104358485626, 0.33998104358485626, 0.8611363115940526];
const GAUSS_WEIGHT = [0.34785484513745385, 0.6521451548625461, 0.6521451548625461, 0.34785484513745385];
const BANDS = 3; // on either side of the diagonal
const WIDTH = 3 * BANDS + 1; // with room for row exchanges
const BEAM = {
  elements: 128, contact_GPa: 1e-6, steps: 6000, largestStep_nm: 20, largestChange_nm: 1, shareOfWay: 0.25,
  patience: 10, settled_nm: 1e-3, settled_Pa: 1, releaseTolerance: 1e-3, depths: 96, rises: 1200, highestRise_nm: 60,
  freeShare: 0.5,
};

class Beam {
  constructor(device) { // lengths in the units of the device settings
    const { length_um, width_um, thickness_um, youngs_modulus_GPa, residual_stress_MPa, poisson_ratio } = device;
    const [width, thickness] = [width_um * 1e-6, thickness_um * 1e-6];
    this.length = length_um * 1e-6;
    this.width = width;
    this.bending = (youngs_modulus_GPa * 1e9 * width * thickness ** 3) / 12;
    this.tension = residual_stress_MPa * 1e6 * (1 - poisson_ratio) * width * thickness;
    this.size = this.length / BEAM.elements;
    this.weights = GAUSS_WEIGHT.map((weight) => 0.5 * this.size * weight);
    const h = this.size;
    this.shapes = GAUSS_AT.map((at) => { // Hermite's, at each integration point
      const x = 0.5 * (at + 1);
      return [1 - 3 * x ** 2 + 2 * x ** 3, h * (x - 2 * x ** 2 + x ** 3), 3 * x ** 2 - 2 * x ** 3, h * (x ** 3 - x ** 2)];
    });
    this.products = this.shapes.map((shape, p) =>
      shape.flatMap((one) => shape.map((other) => this.width * this.weights[p] * one * other)));
    const [bend, pull] = [this.bending / h ** 3, this.tension / (30 * h)];
    const row = (a, b) => a.map((value, i) => bend * value + pull * b[i]);
    this.stiffness = [
      row([12, 6 * h, -12, 6 * h], [36, 3 * h, -36, 3 * h]),
      row([6 * h, 4 * h ** 2, -6 * h, 2 * h ** 2], [3 * h, 4 * h ** 2, -3 * h, -(h ** 2)]),
      row([-12, -6 * h, 12, -6 * h], [-36, -3 * h, 36, -3 * h]),
      row([6 * h, 2 * h ** 2, -6 * h, 4 * h ** 2], [3 * h, -(h ** 2), -3 * h, 4 * h ** 2]),
    ];
    this.points = 4 * BEAM.elements;
    this.rest_nm = Float64Array.from({ length: this.points }, (_, i) => {
      const share = (Math.floor(i / 4) + 0.5 + 0.5 * GAUSS_AT[i % 4]) / BEAM.elements;
      const bow = device.bow_nm * 0.5 * (1 - Math.cos(2 * Math.PI * share));
      return device.gap_um * 1e3 + bow + device.tilt_nm * (share - 0.5);
    });
    this.unknowns = 2 * (BEAM.elements + 1);
  }

  deflection(nodal) { // nm at the integration points from nodal values in m
    const found = new Float64Array(this.points);
    for (let i = 0; i < this.points; i++) {
      const shape = this.shapes[i % 4];
      const first = 2 * (i >> 2);
      found[i] = 1e9 * (nodal[first] * shape[0] + nodal[first + 1] * shape[1] + nodal[first + 2] * shape[2] + nodal[first + 3] * shape[3]);
    }
    return found;
  }

  step(nodal, load, inertia, other) { // Newton's step towards balance, and the answer to a pressure `other` on top
    const { pressure, slope } = load(this.deflection(nodal).map((u, i) => this.rest_nm[i] + u));
    const band = new Float64Array(this.unknowns * WIDTH); // entry of column j in row i at i * WIDTH + j - i + BANDS
    const right = [new Float64Array(this.unknowns), new Float64Array(this.unknowns)];
    for (let e = 0; e < BEAM.elements; e++) {
      const first = 2 * e;
      for (let i = 0; i < 4; i++) {
        let force = 0;
        let answer = 0;
        for (let j = 0; j < 4; j++) {
          let entry = this.stiffness[i][j];
          for (let p = 0; p < 4; p++) entry += (inertia - slope[4 * e + p]) * this.products[p][4 * i + j];
          band[(first + i) * WIDTH + j - i + BANDS] += entry;
          force -= nodal[first + j] * this.stiffness[i][j];
        }
        for (let p = 0; p < 4; p++) {
          const arm = this.width * this.weights[p] * this.shapes[p][i];
          force += pressure[4 * e + p] * arm;
          if (other) answer += other[4 * e + p] * arm;
        }
        right[0][first + i] += force;
        right[1][first + i] += answer;
      }
    }
    solveBanded(band, right, 2, this.unknowns - 2);
    return right;
  }
}

function solveBanded(band, right, from, to) { // Gauss with row exchanges, in place; the clamped ends stay 0
  for (const side of right) { side.fill(0, 0, from); side.fill(0, to); }
  const at = (i, j) => i * WIDTH + j - i + BANDS;
  for (let i = from; i < to; i++) {
    const below = Math.min(i + BANDS, to - 1);
    const reach = Math.min(i + 2 * BANDS, to - 1);
    let best = i;
    for (let k = i + 1; k <= below; k++) if (Math.abs(band[at(k, i)]) > Math.abs(band[at(best, i)])) best = k;
    if (best !== i) {
      for (let j = i; j <= reach; j++) [band[at(i, j)], band[at(best, j)]] = [band[at(best, j)], band[at(i, j)]];
      for (const side of right) [side[i], side[best]] = [side[best], side[i]];
    }
    for (let k = i + 1; k <= below; k++) {
      const factor = band[at(k, i)] / band[at(i, i)];
      if (factor === 0) continue;
      for (let j = i; j <= reach; j++) band[at(k, j)] -= factor * band[at(i, j)];
      right[0][k] -= factor * right[0][i];
      right[1][k] -= factor * right[1][i];
    }
  }
  for (let i = to - 1; i >= from; i--) {
    const reach = Math.min(i + 2 * BANDS, to - 1);
    for (const side of right) {
      let value = side[i];
      for (let j = i + 1; j <= reach; j++) value -= band[at(i, j)] * side[j];
      side[i] = value / band[at(i, i)];
    }
  }
}

class LocalPad { // the pad at many places, each with a deepest closing of its own
  constructor(law) {
    const last = law.depth[law.depth.length - 1];
    this.law = law;
    this.depth = evenly(law.depth[0], last, BEAM.depths);
    this.rise = evenly(0, Math.min(law.far - last, BEAM.highestRise_nm), BEAM.rises);
    this.opening = Array.from(this.depth, (depth) => this.rise.map((risen) => depth + risen).map(law.rising(depth)));
  }

  at(s, deepest) { // net pressure (GPa) and its slope (GPa/nm)
    const risen = s - deepest;
    if (risen > 0 && deepest <= this.depth[BEAM.depths - 1] && risen < this.rise[BEAM.rises - 1]) {
      const step = this.rise[1];
      const deep = Math.min(Math.max((deepest - this.depth[0]) / (this.depth[1] - this.depth[0]), 0), BEAM.depths - 1 - 1e-9);
      const rise = Math.min(Math.max(risen / step, 0), BEAM.rises - 1 - 1e-9);
      const [i, j] = [Math.floor(deep), Math.floor(rise)];
      const share = deep - i;
      const low = (1 - share) * this.opening[i][j] + share * this.opening[i + 1][j];
      const high = (1 - share) * this.opening[i][j + 1] + share * this.opening[i + 1][j + 1];
      const start = (1 - share) * this.opening[i][0] + share * this.opening[i + 1][0];
      const { separation, net } = this.law;
      const k = Math.min(Math.max(placeOf(separation, deepest) - 1, 0), separation.length - 2);
      const ended = net[k] + ((deepest - separation[k]) / (separation[k + 1] - separation[k])) * (net[k + 1] - net[k]);
      // opening starts where closing ended, to the last digit
      const scale = start > 0 && 0.5 * start < ended && ended < 2 * start ? ended / start : 1;
      return [scale * (low + (rise - j) * (high - low)), (scale * (high - low)) / step];
    }
    const { separation, net, far } = this.law;
    if (s > far) {
      const flats = this.law.flats(s);
      return [flats, (-3 * flats) / (Math.max(s, 1) + this.law.offset)];
    }
    const k = Math.min(Math.max(placeOf(separation, s) - 1, 0), separation.length - 2);
    const slope = (net[k + 1] - net[k]) / (separation[k + 1] - separation[k]);
    return [net[k] + slope * (s - separation[k]), slope];
  }
}

class MovingBeam {
  constructor(device, law) {
    this.beam = new Beam(device);
    this.pad = new LocalPad(law);
    this.law = law;
    this.dielectric = device.dielectric_nm / device.permittivity;
    this.nodal = new Float64Array(this.beam.unknowns);
    this.deepest = new Float64Array(this.beam.points).fill(Infinity);
    this.voltage = 0;
    const pushed = (least) => law.separation.filter((_, i) => law.pushes[i] > least).at(-1);
    this.touch = pushed(0);
    this.contact = pushed(BEAM.contact_GPa);
  }

  separation() { return this.beam.deflection(this.nodal).map((u, i) => this.beam.rest_nm[i] + u); }

  electric(s) { return Math.max(s + this.dielectric, 0.1 * this.dielectric + 0.1); }

  pull(s, squared) { return (VACUUM_PERMITTIVITY * squared) / (2 * (this.electric(s) * 1e-9) ** 2) / 1e9; }

  load(squared) {
    return (separation) => {
      const pressure = new Float64Array(separation.length);
      const slope = new Float64Array(separation.length);
      separation.forEach((s, i) => {
        const [pushed, steep] = this.pad.at(s, this.deepest[i]);
        const pull = this.pull(s, squared);
        pressure[i] = (pushed - pull) * 1e9;
        slope[i] = ((steep + (2 * pull) / this.electric(s)) * 1e9) / 1e-9;
      });
      return { pressure, slope };
    };
  }

  landedShare() {
    const { weights, length } = this.beam;
    let landed = 0;
    this.separation().forEach((s, i) => { if (this.pad.at(s, this.deepest[i])[0] > BEAM.contact_GPa) landed += weights[i % 4]; });
    return landed / length;
  }

  pullIn() { // lowers mid-span; the beam is left just above contact
    const middle = BEAM.elements >> 1;
    const rest = this.separation().slice(4 * middle, 4 * middle + 4).reduce((sum, s) => sum + s / 4, 0);
    const steps = evenly(rest, 0.25 * rest, 61).slice(1);
    const near = evenly(Math.log10(steps[59]), Math.log10(this.touch + 5), 40).slice(1).map((power) => 10 ** power);
    const kept = [];
    let squared = 0;
    for (const target of [...steps, ...near]) {
      for (let k = 0; k < 30; k++) {
        const unit = this.separation().map((s) => -this.pull(s, 1) * 1e9);
        const [change, perV2] = this.beam.step(this.nodal, this.load(squared), 0, unit);
        const wanted = -(rest - target) * 1e-9 - this.nodal[2 * middle];
        const more = (wanted - change[2 * middle]) / perV2[2 * middle];
        this.nodal = this.nodal.map((value, i) => value + change[i] + more * perV2[i]);
        squared += more;
        if (Math.abs(more) < 1e-9 * Math.abs(squared) && Math.abs(wanted) < 1e-15) break;
      }
      kept.push(squared);
      if (Math.min(...this.separation()) < this.touch) break;
    }
    const top = largest(kept, 0, Math.min(kept.length, steps.length));
    if (!(top > 0 && top < steps.length - 1) || top + 1 >= kept.length) {
      throw new OutOfRange("the beam touches the dielectric before it pulls in");
    }
    const [a, b, c] = kept.slice(top - 1, top + 2);
    return Math.sqrt(b + (a - c) ** 2 / (8 * (2 * b - a - c)));
  }

  creep() { // to the balance at its voltage, every place remembering how deep it came; whether it is then closed
    const free = BEAM.freeShare * Math.min(...this.beam.rest_nm);
    let [inertia, least, turns] = [1e9, 0, 0];
    let last = new Float64Array(this.beam.unknowns);
    for (let k = 0; k < BEAM.steps; k++) {
      const [change] = this.beam.step(this.nodal, this.load(this.voltage ** 2), inertia, null);
      const moved = this.beam.deflection(change);
      const before = this.separation();
      let [excess, most] = [0, 0];
      moved.forEach((way, i) => {
        const allowed = Math.min(Math.max(BEAM.shareOfWay * (before[i] - this.contact), BEAM.largestChange_nm), BEAM.largestStep_nm);
        excess = Math.max(excess, Math.abs(way) / allowed);
        most = Math.max(most, Math.abs(way));
      });
      if (excess > 1) {
        inertia = Math.max(Math.min(Math.max(1.2 * excess, 1.5), 10) * inertia, 1e6);
        if (inertia < 1e25) continue;
      }
      this.nodal = this.nodal.map((value, i) => value + change[i]);
      const now = this.separation();
      this.deepest = this.deepest.map((deep, i) => Math.min(deep, now[i]));
      if (Math.min(...this.deepest) < this.law.near) throw new OutOfRange("the beam presses the pad harder than its curves reach");
      if (Math.min(...now) > free) return false;
      let turned = 0;
      for (let i = 0; i < change.length; i += 2) turned += change[i] * last[i];
      last = change;
      if (turned < 0) turns += 1;
      least = turned < 0 ? Math.max(10 * least, 1e9) : least * (1 - 0.3 * BEAM.patience / (BEAM.patience + turns));
      if (excess < 0.5 || turned < 0) inertia = Math.max(0.3 * inertia, least);
      if (most < BEAM.settled_nm && most * 1e-9 * inertia < BEAM.settled_Pa) return true;
    }
    throw new OutOfRange("the beam finds no balance");
  }

  open() { // lower the voltage until it lets go: release voltage (0: stuck) and the share landed before
    let [high, low, share] = [this.voltage, 0, this.landedShare()];
    let held = [this.nodal, this.deepest];
    this.voltage = 0;
    if (this.creep()) return [0, this.landedShare()];
    while (high - low > BEAM.releaseTolerance * high) {
      [this.nodal, this.deepest] = held;
      this.voltage = 0.5 * (low + high);
      if (this.creep()) [high, share, held] = [this.voltage, this.landedShare(), [this.nodal, this.deepest]];
      else low = this.voltage;
    }
    return [high, share];
  }
}

function solveBeam(device, law) {
  if (!(device.youngs_modulus_GPa > 0)) throw new OutOfRange("the residual stress alone makes the beam stiffer");
  const moving = new MovingBeam(device, law);
  const pull_in_V = moving.pullIn();
  moving.voltage = device.hold_voltage_V ?? pull_in_V;
  const closed = moving.creep();
  const landed_share = moving.landedShare();
  if (!closed || landed_share === 0) throw new OutOfRange("the hold voltage does not land the beam");
  const [release_V, landed_at_release] = moving.open();
  return { pull_in_V, release_V, stuck: release_V === 0, landed_share, landed_at_release };
}

function switchOf(device, { gap_um, spring_N_per_m, area_um2, bow_nm }) { // the plate and the beam that the sliders describe
  const dielectric_nm = device.dielectric_nm / device.permittivity;
  const plate = new PlateSwitch({ spring_N_per_m, gap_nm: gap_um * 1e3, area_m2: area_um2 * 1e-12, dielectric_nm });
  const { length_um, thickness_um, residual_stress_MPa, poisson_ratio } = device;
  const width_um = area_um2 / length_um;
  const slender = thickness_um / length_um;
  const tension = 8 * residual_stress_MPa * 1e6 * (1 - poisson_ratio) * width_um * 1e-6 * slender;
  const youngs_modulus_GPa = (spring_N_per_m - tension) / (32 * width_um * 1e-6 * slender ** 3) / 1e9;
  return { plate, beam: { ...device, gap_um, width_um, youngs_modulus_GPa, bow_nm } };
}
