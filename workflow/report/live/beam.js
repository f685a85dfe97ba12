"use strict";
// A clamped beam on a pad, as mesoscale/device/beam.py, beam_switch.py and mesoscale/pad/local.py compute it.
const GAUSS_AT = [-0.8611363115940526, -0.33998104358485626, 0.33998104358485626, 0.8611363115940526];
const GAUSS_WEIGHT = [0.34785484513745385, 0.6521451548625461, 0.6521451548625461, 0.34785484513745385];
const BANDS = 3; // on either side of the diagonal
const WIDTH = 3 * BANDS + 1; // with room for row exchanges
const BEAM = {
  elements: 128, contact_GPa: 1e-6, steps: 60000, largestStep_nm: 100, closing_nm: 1, opening_nm: 0.25, shareOfWay: 0.25,
  patience: 10, settled_nm: 1e-3, settled_Pa: 1, releaseTolerance: 1e-3, depths: 96, rises: 1200, highestRise_nm: 60,
  freeShare: 0.5, little: 0.05, down: 81, fade_nm: 1,
};

class Beam {
  constructor(device) { // lengths in the units of the device settings; the rest in N and m
    const width = device.width_um * 1e-6;
    this.length = device.length_um * 1e-6;
    this.width = width;
    this.bending = device.bending_N_m2;
    this.tension = device.tension_N;
    this.stretching = device.stretching_N_m;
    this.size = this.length / BEAM.elements;
    this.weights = GAUSS_WEIGHT.map((weight) => 0.5 * this.size * weight);
    const h = this.size;
    this.shapes = GAUSS_AT.map((at) => { // Hermite's, at each integration point
      const x = 0.5 * (at + 1);
      return [1 - 3 * x ** 2 + 2 * x ** 3, h * (x - 2 * x ** 2 + x ** 3), 3 * x ** 2 - 2 * x ** 3, h * (x ** 3 - x ** 2)];
    });
    this.products = this.shapes.map((shape, p) =>
      shape.flatMap((one) => shape.map((other) => this.width * this.weights[p] * one * other)));
    this.bend = [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h ** 2, -6 * h, 2 * h ** 2], [-12, -6 * h, 12, -6 * h],
      [6 * h, 2 * h ** 2, -6 * h, 4 * h ** 2]].map((row) => row.map((value) => (this.bending / h ** 3) * value));
    this.drawn = [[36, 3 * h, -36, 3 * h], [3 * h, 4 * h ** 2, -3 * h, -(h ** 2)], [-36, -3 * h, 36, -3 * h],
      [3 * h, -(h ** 2), -3 * h, 4 * h ** 2]].map((row) => row.map((value) => value / (30 * h))); // by a tension of 1
    this.points = 4 * BEAM.elements;
    this.rest_nm = Float64Array.from({ length: this.points }, (_, i) => {
      const share = (Math.floor(i / 4) + 0.5 + 0.5 * GAUSS_AT[i % 4]) / BEAM.elements;
      const bow = device.bow_nm * 0.5 * (1 - Math.cos(2 * Math.PI * share));
      return device.gap_um * 1e3 + bow + device.tilt_nm * (share - 0.5);
    });
    this.unknowns = 2 * (BEAM.elements + 1);
    this.shape = Float64Array.from({ length: this.unknowns }, (_, i) => { // at rest: heights and slopes of the nodes
      const angle = (2 * Math.PI * (i >> 1)) / BEAM.elements;
      if (i % 2) return (1e-9 * (device.bow_nm * Math.PI * Math.sin(angle) + device.tilt_nm)) / this.length;
      return 1e-9 * (device.bow_nm * 0.5 * (1 - Math.cos(angle)) + device.tilt_nm * ((i >> 1) / BEAM.elements - 0.5));
    });
  }

  longer(nodal) { // than at rest
    let sum = 0;
    for (let e = 0; e < BEAM.elements; e++) {
      for (let i = 0; i < 4; i++) {
        for (let j = 0; j < 4; j++) {
          sum += this.drawn[i][j] * nodal[2 * e + j] * (0.5 * nodal[2 * e + i] + this.shape[2 * e + i]);
        }
      }
    }
    return sum;
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
    const right = [0, 1, 2].map(() => new Float64Array(this.unknowns));
    const more = this.stretching * this.longer(nodal);
    for (let e = 0; e < BEAM.elements; e++) {
      const first = 2 * e;
      for (let i = 0; i < 4; i++) {
        let force = 0;
        let answer = 0;
        let arms = 0;
        for (let j = 0; j < 4; j++) {
          const [moved, resting] = [nodal[first + j], this.shape[first + j]];
          let entry = this.bend[i][j] + (this.tension + more) * this.drawn[i][j];
          for (let p = 0; p < 4; p++) entry += (inertia - slope[4 * e + p]) * this.products[p][4 * i + j];
          band[(first + i) * WIDTH + j - i + BANDS] += entry;
          force -= this.bend[i][j] * moved + this.drawn[i][j] * (this.tension * moved + more * (moved + resting));
          arms += this.drawn[i][j] * (moved + resting);
        }
        for (let p = 0; p < 4; p++) {
          const arm = this.width * this.weights[p] * this.shapes[p][i];
          force += pressure[4 * e + p] * arm;
          if (other) answer += other[4 * e + p] * arm;
        }
        right[0][first + i] += force;
        right[1][first + i] += answer;
        right[2][first + i] += arms;
      }
    }
    const [unbalanced, , stretched] = right.map((side) => side.slice());
    solveBanded(band, right, 2, this.unknowns - 2);
    const product = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
    const [change, answer] = right.slice(0, 2).map((side) => { // stretching adds a product of one vector with itself
      const share = (this.stretching * product(stretched, side)) / (1 + this.stretching * product(stretched, right[2]));
      return side.map((value, i) => value - share * right[2][i]);
    });
    return [change, answer, product(unbalanced, change)];
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
      for (const side of right) side[k] -= factor * side[i];
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
      const alike = start > 0 && 0.5 * start < ended && ended < 2 * start;
      const scale = alike ? ended / start : 1;
      const fading = alike || risen >= BEAM.fade_nm ? 0 : ended - start;
      return [scale * (low + (rise - j) * (high - low)) + fading * (1 - risen / BEAM.fade_nm),
        (scale * (high - low)) / step - fading / BEAM.fade_nm];
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
    this.edge = device.fringe / (1e3 * device.width_um);
    this.nodal = new Float64Array(this.beam.unknowns);
    this.deepest = new Float64Array(this.beam.points).fill(Infinity);
    this.voltage = 0;
    const pushed = (least) => law.separation.filter((_, i) => law.pushes[i] > least).at(-1);
    this.touch = pushed(0);
    this.contact = pushed(BEAM.contact_GPa);
  }

  separation() { return this.beam.deflection(this.nodal).map((u, i) => this.beam.rest_nm[i] + u); }

  electric(s) { return Math.max(s + this.dielectric, 0.1 * this.dielectric + 0.1); }

  pull(s, squared) { // in GPa, and its fall per nm
    const gap = this.electric(s);
    const pull = (VACUUM_PERMITTIVITY * squared) / (2 * (gap * 1e-9) ** 2) / 1e9;
    return [pull * (1 + this.edge * gap), pull * (2 / gap + this.edge)];
  }

  load(squared) {
    return (separation) => {
      const pressure = new Float64Array(separation.length);
      const slope = new Float64Array(separation.length);
      separation.forEach((s, i) => {
        const [pushed, steep] = this.pad.at(s, this.deepest[i]);
        const [pull, falls] = this.pull(s, squared);
        pressure[i] = (pushed - pull) * 1e9;
        slope[i] = ((steep + falls) * 1e9) / 1e-9;
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

  pullIn() { // lowers the node that comes down farthest; the beam is left just beyond, from where it snaps
    if (Math.min(...this.separation()) <= this.touch) throw new OutOfRange("the beam rests within reach of its pad");
    const unit = () => this.separation().map((s) => -this.pull(s, 1)[0] * 1e9);
    const [, first] = this.beam.step(this.nodal, this.load(0), 0, unit());
    let node = 0;
    for (let i = 0; i < first.length; i += 2) if (first[i] < first[node]) node = i;
    const around = this.separation().slice(2 * node - 4, 2 * node);
    const way = around.reduce((sum, s) => sum + s / 4, 0) - this.touch;
    let squared = 0;
    const [kept, states] = [[0], [this.nodal]];
    for (const target of evenly(0, way, BEAM.down).slice(1)) {
      for (let k = 0; k < 30; k++) {
        const [change, perV2] = this.beam.step(this.nodal, this.load(squared), 0, unit());
        const wanted = -target * 1e-9 - this.nodal[node];
        const more = (wanted - change[node]) / perV2[node];
        this.nodal = this.nodal.map((value, i) => value + change[i] + more * perV2[i]);
        squared += more;
        if (Math.abs(more) < 1e-9 * Math.abs(squared) && Math.abs(wanted) < 1e-15) break;
      }
      kept.push(squared);
      states.push(this.nodal);
      if (Math.min(...this.separation()) < this.touch) break;
    }
    const top = largest(kept);
    if (top === kept.length - 1) {
      this.nodal = states[top - 1];
      return Math.sqrt(kept[top]);
    }
    this.nodal = states[top + 1];
    const [a, b, c] = kept.slice(top - 1, top + 2);
    return Math.sqrt(b + (a - c) ** 2 / (8 * (2 * b - a - c)));
  }

  creep(most_nm = BEAM.closing_nm) { // to the balance at its voltage, every place remembering how deep it came; whether it is then closed
    const free = BEAM.freeShare * Math.min(...this.beam.rest_nm);
    const off = Math.min(this.touch, free);
    let [inertia, least, turns, lowest] = [1e9, 0, 0, Infinity];
    let last = new Float64Array(this.beam.unknowns);
    for (let k = 0; k < BEAM.steps; k++) {
      const [change, , work] = this.beam.step(this.nodal, this.load(this.voltage ** 2), inertia, null);
      const moved = this.beam.deflection(change);
      const before = this.separation();
      let [excess, most] = [0, 0];
      moved.forEach((way, i) => {
        const allowed = Math.min(Math.max(BEAM.shareOfWay * (before[i] - this.contact), most_nm), BEAM.largestStep_nm);
        excess = Math.max(excess, Math.abs(way) / allowed);
        most = Math.max(most, Math.abs(way));
      });
      if (excess > 1 || work < 0) {
        inertia = Math.max(Math.min(Math.max(1.2 * excess, 1.5), 10) * inertia, 1e6);
        if (inertia < 1e25) continue;
      }
      this.nodal = this.nodal.map((value, i) => value + change[i]);
      const now = this.separation();
      this.deepest = this.deepest.map((deep, i) => Math.min(deep, now[i]));
      if (Math.min(...this.deepest) < this.law.near) throw new OutOfRange("the beam presses the pad harder than its curves reach");
      const lower = lowest;
      lowest = Math.min(...now);
      if (lowest > free && lowest > lower) return false;
      let turned = 0;
      for (let i = 0; i < change.length; i += 2) turned += change[i] * last[i];
      last = change;
      if (turned < 0) turns += 1;
      least = turned < 0 ? Math.max(10 * least, 1e9) : least * (1 - 0.3 * BEAM.patience / (BEAM.patience + turns));
      if (excess < 0.5 || turned < 0) inertia = Math.max(0.3 * inertia, least);
      if (most < BEAM.settled_nm && most * 1e-9 * inertia < BEAM.settled_Pa) return lowest < off;
    }
    throw new OutOfRange("the beam finds no balance");
  }

  open() { // lower the voltage until it lets go: release voltage (0: stuck) and the share landed before
    const hold = this.voltage;
    let [high, low, share] = [hold, null, this.landedShare()];
    let held = [this.nodal, this.deepest];
    while (low === null || high - low > BEAM.releaseTolerance * high) {
      if (low !== null) this.voltage = 0.5 * (low + high);
      else this.voltage = high > BEAM.little * hold ? 0.5 * high : 0;
      if (this.creep(BEAM.opening_nm)) {
        [high, share, held] = [this.voltage, this.landedShare(), [this.nodal, this.deepest]];
        if (high === 0) return [0, share];
      } else {
        low = this.voltage;
        [this.nodal, this.deepest] = held;
      }
    }
    return [high, share];
  }
}

function solveBeam(device, law) {
  const moving = new MovingBeam(device, law);
  const pull_in_V = moving.pullIn();
  moving.voltage = device.hold_voltage_V ?? pull_in_V;
  if (moving.voltage < 0.999 * pull_in_V) throw new OutOfRange("the hold voltage never closes the beam");
  const closed = moving.creep();
  const landed_share = moving.landedShare();
  if (!closed || landed_share === 0) throw new OutOfRange("the hold voltage does not land the beam");
  const [release_V, landed_at_release] = moving.open();
  return { pull_in_V, release_V, stuck: release_V === 0, landed_share, landed_at_release };
}

function switchOf(device, { gap_um, spring_N_per_m, area_um2, bow_nm }) { // the plate and the beam that the sliders describe
  const dielectric_nm = device.dielectric_nm / device.permittivity;
  const plate = new PlateSwitch({ spring_N_per_m, gap_nm: gap_um * 1e3, area_m2: area_um2 * 1e-12, dielectric_nm });
  const elastic = Object.entries(device.elastic).map(([name, value]) => [name, (value * spring_N_per_m) / device.stiffness_N_per_m]);
  return { plate, beam: { ...device, ...Object.fromEntries(elastic), gap_um, width_um: area_um2 / device.length_um, bow_nm } };
}
