// Appended to the report by its test: tells what it found in <pre id="probe">.
document.querySelectorAll("details").forEach((part) => { part.open = true; });
window.addEventListener("load", () => setTimeout(() => {
  const figures = [...document.querySelectorAll("figure svg")].filter((svg) => !svg.closest(".whole, .panels") || svg.parentElement.getBoundingClientRect().height > 0);
  const text = document.createElement("pre");
  text.id = "probe";
  text.textContent = JSON.stringify({
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
