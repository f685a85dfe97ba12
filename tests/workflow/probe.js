// Appended to the report by its test: moves a slider and tells what happened in <pre id="probe">.
window.addEventListener("load", () => setTimeout(() => {
  const paths = () => [...document.querySelectorAll("#chart path")].map((path) => path.getAttribute("d")).join();
  const cells = () => document.querySelector("#parameters").textContent;
  const before = [paths(), cells()];
  const rms = document.querySelector('input[name="rms"]');
  rms.value = rms.max;
  rms.dispatchEvent(new Event("input", { bubbles: true }));
  const after = [paths(), cells()];
  const figures = [...document.querySelectorAll("figure svg")];
  const text = document.createElement("pre");
  text.id = "probe";
  text.textContent = JSON.stringify({
    curve_moved: before[0] !== after[0],
    table_moved: before[1] !== after[1],
    curves: before[0].length,
    sliders: document.querySelectorAll("#sliders input").length,
    empty: figures.filter((svg) => !(svg.getBoundingClientRect().height > 50)).length,
    overflow: document.documentElement.scrollWidth - innerWidth,
    load_ms: performance.getEntriesByType("navigation")[0].loadEventStart,
    errors: window.failures,
  });
  document.body.append(text);
}, 50));
