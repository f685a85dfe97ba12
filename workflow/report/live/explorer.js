"use strict";
// Sliders move the law: responses in Legendre polynomials and their scatter, as exported in uq/surrogate.json.
(() => {
  const holder = document.getElementById("surrogate");
  if (!holder) return;
  const data = JSON.parse(holder.textContent);
  const form = document.getElementById("sliders");
  const status = document.getElementById("status");
  const body = document.querySelector("#parameters tbody");
  const outputs = Object.fromEntries(data.outputs.map((output) => [output.name, output]));
  const names = ["d_c_nm", "C_a_GPa_nm", "C_r_GPa", "rho_r_nm"];
  const branches = ["closing", "opening"];
  const HIGHEST = 1e3 * data.law.most_GPa; // MPa, as far as the law was fitted
  const READ = Math.min(6, HIGHEST); // MPa, the pressure whose separation the table gives
  const draws = scatter(data.scatter, 300);

  document.getElementById("live").hidden = false;
  const sliders = data.inputs.map((input) => {
    const slider = labelled(form, { ...input, value: (input.low + input.high) / 2 }, update);
    return { ...slider, input };
  });
  addReset(form, "Back to the middle", update);
  addEventListener("resize", update);
  document.getElementById("explorer").addEventListener("toggle", update); // folded, it has no width
  update();

  function legendre(n, u) {
    let before = 1;
    let now = u;
    if (n === 0) return 1;
    for (let k = 1; k < n; k++) [before, now] = [now, ((2 * k + 1) * u * now - k * before) / (k + 1)];
    return now;
  }

  function predict(output, u) {
    let sum = 0;
    for (const term of output.terms) {
      let product = term.coefficient;
      term.degrees.forEach((n, i) => { if (n) product *= legendre(n, u[i]); });
      sum += product;
    }
    const value = output.transform === "log" ? Math.exp(sum) : sum;
    return output.below ? predict(outputs[output.below], u) - value : value;
  }

  function laws(branch, u) {
    const mean = names.map((name) => predict(outputs[`${branch}_${name}`], u));
    const cells = draws.map((draw) => names.map((name, i) => {
      const { z, transform } = draw[`${branch}_${name}`];
      return transform === "log" ? mean[i] * Math.exp(z) : mean[i] + z;
    })).filter(usable);
    return { branch, mean, cells: usable(mean) ? cells : [] };
  }

  function usable([, C_a, C_r, rho_r]) { return C_a >= 0 && C_r > 0 && rho_r > 0; }

  function pressure(s, [d_c, C_a, C_r, rho_r], hamaker) {
    const { rho_a_nm: onset, alpha_nm: shield } = data.law;
    const attraction = hamaker / (6 * Math.PI * (Math.max(s, 0) ** 3 + shield ** 3)) + C_a * Math.max(d_c + onset - s, 0);
    return (C_r * Math.expm1(Math.max(d_c - s, 0) / rho_r) - attraction) * 1e3; // MPa
  }

  function separation(p, law, hamaker) { // on the repulsive side, by bisection
    let near = law[0] - law[3];
    let far = law[0];
    while (pressure(near, law, hamaker) < p) near -= far - near;
    for (let k = 0; k < 50; k++) {
      const middle = (near + far) / 2;
      if (pressure(middle, law, hamaker) > p) near = middle; else far = middle;
    }
    return far;
  }

  function quantile(values, q) {
    const sorted = values.slice().sort((a, b) => a - b);
    const place = q * (sorted.length - 1);
    const below = Math.floor(place);
    return sorted[below] + (place - below) * ((sorted[below + 1] ?? sorted[below]) - sorted[below]);
  }

  function update() {
    const u = sliders.map(({ read, input }) =>
      (input.high > input.low ? (2 * (read() - input.low)) / (input.high - input.low) - 1 : 0));
    const hamaker = sliders.find(({ name }) => name === "hamaker").read();
    const both = branches.map((branch) => laws(branch, u));
    const broken = both.filter(({ mean }) => !usable(mean)).map(({ branch }) => branch);
    const shown = both.filter(({ mean }) => usable(mean));
    status.textContent = broken.length
      ? `The response leaves its physical range here (${broken.join(" and ")}): no curve.`
      : draws.length ? "" : "No band: fewer than 20 direct runs of this scene gave a law.";
    drawLaw(shown, hamaker);
    fill(both, hamaker);
  }

  function drawLaw(shown, hamaker) {
    const ends = shown.flatMap(({ mean, cells }) => {
      const each = cells.length ? cells : [mean];
      return [quantile(each.map((law) => separation(HIGHEST, law, hamaker)), 0.16), quantile(each.map((law) => law[0]), 0.84)];
    });
    const [from, to] = ends.length ? [Math.max(Math.min(...ends), 0), Math.max(...ends)] : [0, 1];
    const pad = 0.06 * (to - from);
    const panel = axes("chart", [Math.max(from - pad, 0), to + 2 * pad], [-0.05 * HIGHEST, HIGHEST],
      ["mean separation (nm)", "contact pressure (MPa)"]);
    for (const law of shown) curve(panel, law, (s, one) => pressure(s, one, hamaker));
  }

  function curve({ x, y, grid, group }, { branch, mean, cells }, value) {
    if (cells.length) {
      const edges = grid.map((at) => {
        const values = cells.map((law) => value(at, law));
        return [quantile(values, 0.16), quantile(values, 0.84)];
      });
      const there = grid.map((at, i) => `${x(at)},${y(edges[i][1])}`);
      const back = grid.map((at, i) => `${x(at)},${y(edges[i][0])}`).reverse();
      group.append(node("path", { class: `band ${branch}`, d: `M${there.concat(back).join("L")}Z` }));
    }
    group.append(node("path", { class: branch, d: `M${grid.map((at) => `${x(at)},${y(value(at, mean))}`).join("L")}` }));
  }

  function fill(both, hamaker) {
    const rows = [["d_c (nm)", (law) => law[0]], ["C_a (10⁻⁵ GPa/nm)", (law) => 1e5 * law[1]],
      ["C_r (10⁻⁴ GPa)", (law) => 1e4 * law[2]], ["ρ_r (nm)", (law) => law[3]],
      [`separation at ${READ} MPa (nm)`, (law) => (usable(law) ? separation(READ, law, hamaker) : NaN)]];
    const repels = data.faint.includes("C_r_GPa") || data.faint.includes("rho_r_nm");
    body.replaceChildren(...rows.map(([label, value], k) => {
      const row = tableRow(label, both.map(({ mean, cells }) => {
        const ends = cells.length ? [0.16, 0.84].map((q) => show(quantile(cells.map(value), q))) : [];
        return show(value(mean)) + (ends.length ? ` [${ends.join(", ")}]` : "");
      }));
      row.classList.toggle("faint", k < names.length ? data.faint.includes(names[k]) : repels);
      return row;
    }));
    document.getElementById("chart").classList.toggle("faint", repels);
  }

  function show(value) { return Number.isFinite(value) ? value.toPrecision(3).replace("-", "−") : "–"; }

  function ticks(low, high, most) {
    const rough = (high - low) / most;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= rough);
    const decimals = Math.max(0, -Math.floor(Math.log10(step)));
    const found = [];
    for (let k = Math.ceil(low / step); k * step <= high; k++) found.push([k * step, (k * step).toFixed(decimals).replace("-", "−")]);
    return found;
  }

  function axes(id, [from, to], [lowest, highest], [across, up]) {
    // drawn at the width it has, so that its text keeps its size
    const svg = document.getElementById(id);
    const width = Math.max(svg.clientWidth, 260);
    const height = Math.min(340, Math.max(220, 0.55 * width));
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const [left, right, top, bottom] = [72, width - 10, 10, height - 44];
    const limit = (p) => Math.min(Math.max(p, 2 * lowest - highest), 2 * highest - lowest);
    const x = (s) => (left + ((right - left) * (s - from)) / (to - from)).toFixed(1);
    const y = (p) => (bottom - ((bottom - top) * (limit(p) - lowest)) / (highest - lowest)).toFixed(1);
    const grid = Array.from({ length: 161 }, (_, i) => from + ((to - from) * i) / 160);
    const inside = node("clipPath", { id: `inside-${id}` });
    inside.append(node("rect", { x: left, y: top, width: right - left, height: bottom - top }));
    const parts = [inside];
    for (const [s, text] of ticks(from, to, width / 90)) {
      parts.push(node("line", { class: "grid", x1: x(s), x2: x(s), y1: top, y2: bottom }));
      parts.push(node("text", { x: x(s), y: bottom + 17, "text-anchor": "middle" }, text));
    }
    for (const [p, text] of ticks(lowest, highest, 6)) {
      parts.push(node("line", { class: Math.abs(p) > 1e-12 * highest ? "grid" : "zero", x1: left, x2: right, y1: y(p), y2: y(p) }));
      parts.push(node("text", { x: left - 7, y: Number(y(p)) + 4, "text-anchor": "end" }, text));
    }
    parts.push(node("text", { x: (left + right) / 2, y: bottom + 37, "text-anchor": "middle" }, across));
    parts.push(node("text", { transform: `translate(13 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, up));
    const group = node("g", { "clip-path": `url(#inside-${id})` });
    svg.replaceChildren(...parts, group);
    return { x, y, grid, group };
  }

  function node(tag, attributes, text) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    if (text === undefined) return element;
    const [before, letter = "", index = "", after = ""] = text.split(/([A-Za-zρ])_([a-z])(?![A-Za-z_])/);
    element.append(before + letter);
    if (index) element.append(node("tspan", { dy: 3, "font-size": "75%" }, index), node("tspan", { dy: -3 }, after));
    return element;
  }

  function scatter(joint, count) {
    // single surfaces about the mean response: jointly normal where the file says, correlated by the factor
    if (!joint) return [];
    let state = 12345; // fixed sequence (Park and Miller 1988): the same band at the same inputs
    const uniform = () => { state = (16807 * state) % 2147483647; return state / 2147483647; };
    const normal = () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
    return Array.from({ length: count }, () => {
      const free = joint.outputs.map(normal);
      return Object.fromEntries(joint.outputs.map((name, i) =>
        [name, { transform: joint.transforms[i], z: joint.factor[i].reduce((sum, f, k) => sum + f * free[k], joint.mean[i]) }]));
    });
  }
})();
