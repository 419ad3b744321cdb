// Shows, for a wanted accuracy, what misses it and what meets it at the least time; the page is whole without.
const form = document.getElementById("wanted");

function show(accuracy, words) {
  const wanted = accuracy === "" ? Infinity : Number(accuracy);
  for (const one of document.querySelectorAll("[data-accuracy]")) {
    one.classList.toggle("wanted", one.dataset.accuracy.split(" ").includes(accuracy));
  }
  for (const figure of document.querySelectorAll("figure")) {
    let told = "";
    for (const drawing of figure.querySelectorAll("svg")) {
      let best = null;
      for (const point of drawing.querySelectorAll(".point")) {
        const meets = Number(point.dataset.error) <= wanted;
        point.classList.toggle("misses", "error" in point.dataset && !meets);
        point.classList.remove("cheapest");
        if (meets && (!best || Number(point.dataset.us) < Number(best.dataset.us))) best = point;
      }
      if (accuracy === "" || !drawing.querySelector("[data-accuracy]")) continue;
      if (best) best.classList.add("cheapest");
      const [name, time] = best ? best.querySelector("title").textContent.split("\n") : [];
      told = best ? `Cheapest within ${words}: ${name}, ${time.split(" per ")[0]}` : `No method is within ${words}`;
    }
    figure.querySelector("output").textContent = told;
  }
}

form.hidden = false;
const choose = (input) => show(input.value, input.nextElementSibling.textContent);
form.addEventListener("change", (event) => choose(event.target));
// A browser that comes back to the page keeps the choice.
choose(form.querySelector(":checked"));
