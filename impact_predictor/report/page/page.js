// Each figure stands on the page as JSON, after its place; `meta.pieces` are the parts of a record between long pauses
// that are cut out, as [begin, end, place] in seconds: their times are written anew when the reader magnifies.
function ticks(axis, pieces) {
  const wanted = (axis.range[1] - axis.range[0]) / 7, power = 10 ** Math.floor(Math.log10(wanted));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= wanted);
  const values = [], texts = [];
  for (const [begin, end, place] of pieces) {
    const first = place + (Math.ceil(begin / step) * step - begin) > place + end - begin ? begin : Math.ceil(begin / step) * step;
    for (let time = first; time <= end; time += step) {
      const at = place + time - begin;
      if (at < axis.range[0] || at > axis.range[1] || (values.length && at < values[values.length - 1] + wanted)) continue;
      values.push(at);
      texts.push(`${+time.toPrecision(7)} s`);
    }
  }
  return {"xaxis.tickvals": values, "xaxis.ticktext": texts};
}
for (const source of document.querySelectorAll("script[data-for]")) {
  const figure = JSON.parse(source.textContent), place = document.getElementById(source.dataset.for);
  const config = {responsive: true, displayModeBar: false};
  // On a narrow page the names stand below each other.
  if (place.clientWidth < 500) figure.layout.height += 100;
  Plotly.newPlot(place, figure.data, figure.layout, config).then(() => {
    const pieces = (figure.layout.meta || {}).pieces;
    if (!pieces) return;
    const write = () => Plotly.relayout(place, ticks(place._fullLayout.xaxis, pieces));
    place.on("plotly_relayout", (change) => { if (!("xaxis.tickvals" in change)) write(); });
    write();
  });
}
