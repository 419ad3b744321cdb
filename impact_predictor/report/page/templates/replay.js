// Keeps in sight what a timeline shows when it is magnified: the mark nearest to its middle. The page is whole without.
for (const timeline of document.querySelectorAll(".timeline")) {
  const box = timeline.querySelector(".scroll");
  let middle = 0.5;
  box.addEventListener("scroll", () => { middle = (box.scrollLeft + box.clientWidth / 2) / box.scrollWidth; });
  timeline.addEventListener("change", () => {
    const wanted = middle * box.scrollWidth - box.scrollLeft + box.getBoundingClientRect().left;
    let best = null;
    for (const mark of timeline.querySelectorAll(".marks:not(.faint) .point")) {
      const { left, width } = mark.getBoundingClientRect();
      const away = left + width / 2 - wanted;
      if (best === null || Math.abs(away) < Math.abs(best)) best = away;
    }
    box.scrollLeft = middle * box.scrollWidth + (best ?? 0) - box.clientWidth / 2;
  });
}
