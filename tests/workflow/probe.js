// Appended to the report by its test: moves a slider and tells what happened in <pre id="probe">.
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
  const paths = () => [...document.querySelectorAll("#chart path, #well path")].map((path) => path.getAttribute("d")).join();
  const cells = () => document.querySelector("#parameters").textContent;
  const before = [paths(), cells()];
  const rms = document.querySelector('input[name="rms"]');
  rms.value = rms.max;
  rms.dispatchEvent(new Event("input", { bubbles: true }));
  const after = [paths(), cells()];
  const followed = [inside(".closing:not(.band)", "chart"), inside(".opening:not(.band)", "well")];
  const figures = [...document.querySelectorAll("figure svg")];
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
    overflow: document.documentElement.scrollWidth - innerWidth,
    load_ms: performance.getEntriesByType("navigation")[0].loadEventStart,
    errors: window.failures,
  });
  document.body.append(text);
}, 50));
