"use strict";
// Sliders of the switch: its voltages on the curves of the pad, flat and bending.
(() => {
  const holder = document.getElementById("switch_data");
  if (!holder) return;
  const data = JSON.parse(holder.textContent);
  const form = document.getElementById("switch-sliders");
  const status = document.getElementById("switch-status");
  const body = document.querySelector("#switch-results tbody");
  document.getElementById("switch-live").hidden = false;
  const sliders = data.sliders.map((slider) => labelled(form, slider, update));
  addReset(form, "Back to this scene", update);
  const PADS = 100; // a share is known to 5 % at worst
  let waiting = 0;
  update();

  function update() {
    const chosen = Object.fromEntries(sliders.map(({ read, name }) => [name, read()]));
    const parts = switchOf(data.device, chosen);
    const { mean, resampled } = PadLaw.read(data.curves, chosen.adhesion);
    const said = [];
    const hold = data.device.hold_voltage_V;
    const found = { flat: attempt(() => solveOnPad(parts.plate, mean, hold), said), stuck: "…", beam: "…" };
    const tell = () => {
      fill(found);
      status.textContent = [...new Set(said)].join(" ");
    };
    const later = (work, next) => { waiting = setTimeout(() => { work(); tell(); next?.(); }, 150); };
    tell();
    clearTimeout(waiting);
    // what takes longer than a frame waits until the sliders rest
    later(() => { found.stuck = found.flat && share(stickingShare(parts.plate, resampled(PADS), hold)); },
      data.bends && (() => later(() => { found.beam = attempt(() => solveBeam(parts.beam, mean), said); })));
  }

  function attempt(solve, said) {
    try {
      return solve();
    } catch (error) {
      if (!(error instanceof OutOfRange)) throw error;
      said.push(`No number: ${error.message}.`);
      return null;
    }
  }

  function fill({ flat, stuck, beam }) {
    const volts = (state) => (state.stuck ? "sticks" : `${shown(state.release_V)} V`);
    const bent = (tell) => (typeof beam === "string" ? beam : beam && tell(beam));
    const rows = [
      ["pull-in", flat && `${shown(flat.pull_in_V)} V`, bent((state) => `${shown(state.pull_in_V)} V`)],
      ["release", flat && volts(flat), bent(volts)],
      ["probability of sticking", stuck, "not computed"],
      ["pressure while held", flat && `${shown(flat.hold_MPa)} MPa`, "not computed"],
      ["largest net adhesion on opening", flat && `${shown(flat.deepest_net_kPa)} kPa`, "not computed"],
      ["landed while held", flat && "100 %", bent((state) => share(state.landed_share))],
    ];
    body.replaceChildren(...rows.map(([head, ...cells]) => tableRow(head, data.bends ? cells : cells.slice(0, 1))));
  }

  function share(value) { return value === null ? null : `${shown(100 * value)} %`; }
})();
