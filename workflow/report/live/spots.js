"use strict";
// The load on the pictured surface: layers up to the chosen step are shown.
(() => {
  const picture = document.getElementById("spots");
  if (!picture) return;
  const layers = [...picture.querySelectorAll("[data-step]")];
  const told = picture.querySelector(".told");
  const last = layers.length - 1;
  const load = labelled(picture.querySelector("form"), { name: "load", label: "load, step", unit: "", low: 0, high: last, value: last, step: 1 }, update);
  update();

  function update() {
    const chosen = load.read();
    layers.forEach((layer, k) => { layer.style.display = k <= chosen ? "" : "none"; });
    layers.forEach((layer, k) => layer.classList.toggle("new", k === chosen));
    told.textContent = layers[chosen].dataset.words;
  }
})();
