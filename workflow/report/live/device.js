"use strict";
// Sliders of the switch: its voltages on the mean curves of the pad.
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
  let waiting = 0;
  document.getElementById("what-if").addEventListener("toggle", update); // folded, it computes nothing
  update();

  function update() {
    clearTimeout(waiting);
    if (!document.getElementById("what-if").open) return;
    const chosen = Object.fromEntries(sliders.map(({ read, name }) => [name, read()]));
    fill("…");
    // what takes longer than a frame waits until the sliders rest
    waiting = setTimeout(() => {
      const parts = switchOf(data.device, chosen);
      const law = PadLaw.read(data.curves, chosen.adhesion);
      const solve = () => (data.bends ? solveBeam(parts.beam, law) : solveOnPad(parts.plate, law, data.device.hold_voltage_V));
      status.textContent = "";
      fill(attempt(solve));
    }, 150);
  }

  function attempt(solve) {
    try {
      return solve();
    } catch (error) {
      if (!(error instanceof OutOfRange)) throw error;
      status.textContent = `No number: ${error.message}.`;
      return null;
    }
  }

  function fill(state) {
    const tell = (words) => (typeof state === "string" ? state : state && words(state));
    const rows = [
      ["pull-in", tell(({ pull_in_V }) => `${shown(pull_in_V)} V`)],
      ["release", tell(({ stuck, release_V }) => (stuck ? "sticks" : `${shown(release_V)} V`))],
      data.bends
        ? ["landed while held", tell(({ landed_share }) => `${shown(100 * landed_share)} %`)]
        : ["pressure while held", tell(({ hold_MPa }) => `${shown(hold_MPa)} MPa`)],
    ];
    body.replaceChildren(...rows.map(([head, cell]) => tableRow(head, [cell])));
  }
})();
