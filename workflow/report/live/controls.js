"use strict";
// What all live parts of the page share: sliders with their labels, and rows of a table.
function shown(value) { return Number.isFinite(value) ? String(Number(value.toPrecision(3))).replace("-", "−") : "–"; }

function named(text) { // names such as d_c with their index set low
  return text.split(/([A-Za-zρ])_(macro|[a-zA-Z])(?![A-Za-z_])/).map((part, k) => {
    if (k % 3 !== 2) return part;
    const low = document.createElement("sub");
    low.textContent = part;
    return low;
  });
}

function labelled(form, { name, label, unit, low, high, value, step = "any" }, changed) {
  const holder = document.createElement("label");
  const text = document.createElement("span");
  const output = document.createElement("output");
  const slider = document.createElement("input");
  text.append(...named(label + (unit ? ` (${unit})` : "")));
  Object.assign(slider, { type: "range", min: low, max: high, step, name });
  slider.defaultValue = value;
  holder.append(text, output, slider);
  form.append(holder);
  const tell = () => {
    output.textContent = shown(Number(slider.value));
    slider.setAttribute("aria-valuetext", `${output.textContent} ${unit}`.trim());
  };
  slider.addEventListener("input", () => { tell(); changed(); });
  form.addEventListener("reset", () => setTimeout(tell));
  tell();
  return { name, read: () => Number(slider.value) };
}

function addReset(form, words, changed) {
  const reset = document.createElement("button");
  Object.assign(reset, { type: "reset", textContent: words });
  form.append(reset);
  form.addEventListener("reset", () => setTimeout(changed));
}

function tableRow(head, cells) {
  const row = document.createElement("tr");
  const first = document.createElement("th");
  first.scope = "row";
  first.append(...named(head));
  row.append(first, ...cells.map((content) => {
    const cell = document.createElement("td");
    cell.append(content ?? "–");
    return cell;
  }));
  return row;
}

addEventListener("keydown", ({ key }) => { if (key === "Escape") document.activeElement.blur(); }); // puts an explanation away
