"use strict";
// Sliders move the law: responses in Legendre polynomials, as exported in uq/surrogate.json.
(() => {
  const data = JSON.parse(document.getElementById("surrogate").textContent);
  const form = document.getElementById("sliders");
  const chart = document.getElementById("chart");
  const status = document.getElementById("status");
  const body = document.querySelector("#parameters tbody");
  const outputs = Object.fromEntries(data.outputs.map((output) => [output.name, output]));
  const names = ["d_c_nm", "C_a_GPa_nm", "C_r_GPa", "rho_r_nm"];
  const branches = ["closing", "opening"];
  const BAND = 80;
  const normals = gaussians(BAND * 8);
  const range = axis();

  const sliders = data.inputs.map((input) => {
    const label = document.createElement("label");
    const text = document.createElement("span");
    text.textContent = input.label + (input.unit === "1" ? "" : ` (${input.unit})`);
    const value = document.createElement("output");
    const slider = document.createElement("input");
    Object.assign(slider, { type: "range", min: input.low, max: input.high, step: (input.high - input.low) / 200 || 1 });
    slider.defaultValue = (input.low + input.high) / 2;
    slider.name = input.name;
    label.append(text, value, slider);
    form.append(label);
    slider.addEventListener("input", update);
    return { slider, value, input };
  });
  const reset = document.createElement("button");
  reset.type = "reset";
  reset.textContent = "Back to the middle";
  form.append(reset);
  form.addEventListener("reset", () => setTimeout(update));
  update();

  function legendre(n, u) {
    let before = 1;
    let now = u;
    if (n === 0) return 1;
    for (let k = 1; k < n; k++) [before, now] = [now, ((2 * k + 1) * u * now - k * before) / (k + 1)];
    return now;
  }

  function predict(output, u, shift) {
    let sum = shift * output.residual_std;
    for (const term of output.terms) {
      let product = term.coefficient;
      term.degrees.forEach((n, i) => { if (n) product *= legendre(n, u[i]); });
      sum += product;
    }
    return output.transform === "log" ? Math.exp(sum) : sum;
  }

  function law(branch, u, shifts) {
    return names.map((name, i) => predict(outputs[`${branch}_${name}`], u, shifts ? shifts[i] : 0));
  }

  function pressure(s, [d_c, C_a, C_r, rho_r], hamaker) {
    const { rho_a_nm: onset, alpha_nm: shield } = data.law;
    const attraction = hamaker / (6 * Math.PI * (Math.max(s, 0) ** 3 + shield ** 3)) + C_a * Math.max(d_c + onset - s, 0);
    return (C_r * Math.expm1(Math.max(d_c - s, 0) / rho_r) - attraction) * 1e3; // MPa
  }

  function usable([, C_a, C_r, rho_r]) { return C_a >= 0 && C_r > 0 && rho_r > 0; }

  function update() {
    const u = sliders.map(({ slider, value, input }) => {
      const x = Number(slider.value);
      value.textContent = x.toPrecision(3);
      return input.high > input.low ? (2 * (x - input.low)) / (input.high - input.low) - 1 : 0;
    });
    const hamaker = Number((sliders.find(({ input }) => input.name === "hamaker") || { slider: { value: 0.215 } }).slider.value);
    const laws = Object.fromEntries(branches.map((branch) => [branch, law(branch, u)]));
    const broken = branches.filter((branch) => !usable(laws[branch]));
    status.textContent = broken.length
      ? `The response leaves its physical range here (${broken.join(" and ")}): no curve.` : "";
    draw(laws, u, hamaker);
    fill(laws);
  }

  function draw(laws, u, hamaker) {
    const { x, y, grid } = range;
    const curves = node("g", { "clip-path": "url(#inside)" });
    chart.replaceChildren(...frame(), curves);
    for (const branch of branches) {
      if (!usable(laws[branch])) continue;
      const many = [];
      for (let k = 0; k < BAND; k++) {
        const offset = k * 8 + (branch === "opening" ? 4 : 0);
        const one = law(branch, u, normals.slice(offset, offset + 4));
        if (usable(one)) many.push(one);
      }
      const low = [];
      const high = [];
      for (const s of grid) {
        const values = many.map((one) => pressure(s, one, hamaker)).sort((a, b) => a - b);
        low.push(values[Math.floor(0.16 * (values.length - 1))]);
        high.push(values[Math.ceil(0.84 * (values.length - 1))]);
      }
      const there = grid.map((s, i) => `${x(s)},${y(high[i])}`);
      const back = grid.map((s, i) => `${x(s)},${y(low[i])}`).reverse();
      if (many.length) curves.append(node("path", { class: `band ${branch}`, d: `M${there.concat(back).join("L")}Z` }));
      const line = grid.map((s) => `${x(s)},${y(pressure(s, laws[branch], hamaker))}`);
      curves.append(node("path", { class: branch, d: `M${line.join("L")}` }));
    }
  }

  function fill(laws) {
    const rows = [["d<sub>c</sub> (nm)", 1], ["C<sub>a</sub> (10⁻⁵ GPa/nm)", 1e5], ["C<sub>r</sub> (10⁻⁴ GPa)", 1e4], ["ρ<sub>r</sub> (nm)", 1]];
    body.replaceChildren(...rows.map(([label, factor], i) => {
      const row = document.createElement("tr");
      const head = document.createElement("th");
      head.scope = "row";
      head.innerHTML = label; // our own constant text
      row.append(head, ...branches.map((branch) => {
        const cell = document.createElement("td");
        cell.textContent = (laws[branch][i] * factor).toPrecision(3);
        return cell;
      }));
      return row;
    }));
  }

  function axis() {
    const [left, right, top, bottom] = [62, 628, 12, 336];
    const [from, to, lowest, highest] = [0, 80, -3, 12];
    const grid = Array.from({ length: 201 }, (_, i) => from + ((to - from) * i) / 200);
    const x = (s) => (left + ((right - left) * (s - from)) / (to - from)).toFixed(1);
    const y = (p) => (bottom - ((bottom - top) * (Math.min(Math.max(p, lowest - 30), highest + 30) - lowest)) / (highest - lowest)).toFixed(1);
    return { x, y, grid, left, right, top, bottom, lowest, highest, to };
  }

  function frame() {
    const { x, y, left, right, top, bottom, lowest, highest, to } = range;
    const inside = node("clipPath", { id: "inside" });
    inside.append(node("rect", { x: left, y: top, width: right - left, height: bottom - top }));
    const parts = [inside];
    for (let s = 0; s <= to; s += 10) {
      parts.push(node("line", { class: "grid", x1: x(s), x2: x(s), y1: top, y2: bottom }));
      parts.push(node("text", { x: x(s), y: bottom + 18, "text-anchor": "middle" }, s));
    }
    for (let p = lowest; p <= highest; p += 3) {
      parts.push(node("line", { class: p ? "grid" : "zero", x1: left, x2: right, y1: y(p), y2: y(p) }));
      parts.push(node("text", { x: left - 8, y: Number(y(p)) + 4, "text-anchor": "end" }, String(p).replace("-", "−")));
    }
    parts.push(node("text", { x: (left + right) / 2, y: bottom + 38, "text-anchor": "middle" }, "mean separation (nm)"));
    parts.push(node("text", { transform: `translate(16 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, "contact pressure (MPa)"));
    return parts;
  }

  function node(tag, attributes, text) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    if (text !== undefined) element.textContent = text;
    return element;
  }

  function gaussians(count) {
    // fixed sequence: the same band at the same inputs
    let state = 12345;
    const uniform = () => { state = (1103515245 * state + 12345) % 2147483648; return (state + 0.5) / 2147483648; };
    return Array.from({ length: count }, () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform()));
  }
})();
