"use strict";
// The load on the pictured surface: layers up to the chosen step are shown.
(() => {
  const picture = document.getElementById("spots");
  const layers = [...picture.querySelectorAll("[data-step]")];
  const told = picture.querySelector(".told");
  const slider = picture.querySelector("input");
  const update = () => {
    const chosen = Number(slider.value);
    layers.forEach((layer, k) => {
      layer.style.display = k <= chosen ? "" : "none";
      layer.classList.toggle("new", k === chosen);
    });
    told.textContent = layers[chosen].dataset.words;
    slider.setAttribute("aria-valuetext", told.textContent);
  };
  slider.parentElement.hidden = false;
  slider.addEventListener("input", update);
  update();
})();
