// Appended to the report by its test: moves a slider and tells what happened in <pre id="probe">.
document.querySelectorAll("details").forEach((part) => { part.open = true; });
window.addEventListener("load", () => setTimeout(() => {
  const inside = (path, svg) => {
    const box = document.querySelector(`#inside-${svg} rect`);
    const [x, y, width, height] = ["x", "y", "width", "height"].map((name) => Number(box.getAttribute(name)));
    const points = document.querySelector(`#${svg} ${path}`).getAttribute("d").slice(1).split("L").map((pair) => pair.split(",").map(Number));
    const seen = points.filter((point) => point[1] > y && point[1] < y + height);
    return {
      share: seen.length / points.length,
      drop: (Math.max(...seen.map((point) => point[1])) - Math.min(...seen.map((point) => point[1]))) / height,
    };
  };
  const paths = () => [...document.querySelectorAll("#chart path")].map((path) => path.getAttribute("d")).join();
  const cells = () => document.querySelector("#parameters").textContent;
  const before = [paths(), cells()];
  const rms = document.querySelector('input[name="rms"]');
  rms.value = rms.max;
  rms.dispatchEvent(new Event("input", { bubbles: true }));
  const after = [paths(), cells()];
  const followed = [inside(".closing:not(.band)", "chart"), inside(".opening:not(.band)", "chart")];
  const figures = [...document.querySelectorAll("figure svg")].filter((svg) => !svg.closest(".whole, .panels") || svg.parentElement.getBoundingClientRect().height > 0);
  const text = document.createElement("pre");
  text.id = "probe";
  text.textContent = JSON.stringify({
    curve_moved: before[0] !== after[0],
    table_moved: before[1] !== after[1],
    followed,
    table: [...document.querySelectorAll("#parameters tbody tr")].map((row) => [...row.cells].map((cell) => cell.textContent)),
    curves: before[0].length,
    sliders: document.querySelectorAll("#sliders input").length,
    empty: figures.filter((svg) => !(svg.getBoundingClientRect().height > 50)).length,
    sticks_out: figures.filter((svg) => svg.getBoundingClientRect().right > innerWidth).length,
    smallest_text: Math.min(...figures.map((svg) => {
      const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
      const drawn = document.getElementById(svg.querySelector(":scope > use")?.getAttribute("href").slice(1)) || svg;
      return scale * Math.min(...[...drawn.querySelectorAll("text")].map((text) => parseFloat(getComputedStyle(text).fontSize)));
    })),
    width: innerWidth,
    overflow: document.documentElement.scrollWidth - innerWidth,
    load_ms: performance.getEntriesByType("navigation")[0].loadEventStart,
    errors: window.failures,
  });
  parent.document.body.append(text); // the page itself, or the host of the frame it is in
}, 50));
