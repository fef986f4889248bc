! SPDX-License-Identifier: MIT
!> How a page looks: light and dark, wide and narrow, on paper; and what it does.
module gyroakf_report_html_style
   implicit none (type, external)
   private

   character(*), parameter, public :: page_style(*) = [character(96) :: &
      ":root { color-scheme: light dark; --text: #1b1d20; --soft: #565c64; --ground: #fcfcfb;", &
      "  --card: #f1f2f3; --line: #cfd3d8; --link: #0b5cad; --warn: #8a4b00;", &
      "  --warn-ground: #fff3dc }", &
      "@media (prefers-color-scheme: dark) { :root { --text: #e6e7e9; --soft: #a9b0b9;", &
      "  --ground: #16181b; --card: #22262b; --line: #3d434b; --link: #86bdf5; --warn: #ffc56b;", &
      "  --warn-ground: #3a2c12 } }", &
      "* { box-sizing: border-box }", &
      "html { -webkit-text-size-adjust: 100% }", &
      "body { margin: 0 auto; padding: 1rem clamp(0.8rem, 3vw, 2rem) 3rem; max-width: 66rem;", &
      "  color: var(--text); background: var(--ground); font: 1rem/1.55 system-ui, 'Segoe UI',", &
      "  Roboto, 'Noto Sans', 'DejaVu Sans', sans-serif; overflow-wrap: anywhere }", &
      "h1, h2, h3, h4 { line-height: 1.25; margin: 1.6em 0 0.5em; text-wrap: balance }", &
      "h1 { font-size: 1.7rem; margin-top: 0.4em } h2 { font-size: 1.4rem;", &
      "  border-bottom: 2px solid var(--line) }", &
      "h3 { font-size: 1.2rem } h4 { font-size: 1rem }", &
      "a { color: var(--link) }", &
      ":focus-visible { outline: 3px solid var(--link); outline-offset: 2px }", &
      ".skip { position: absolute; left: -99rem }", &
      ".skip:focus { left: 1rem; top: 0.5rem; background: var(--ground); padding: 0.5rem }", &
      "header p, footer, figcaption, .reading { color: var(--soft) }", &
      "nav ul { display: flex; flex-wrap: wrap; gap: 0.3rem 1.2rem; list-style: none;", &
      "  padding: 0 }", &
      "dl { display: grid; grid-template-columns: minmax(7rem, max-content) 1fr;", &
      "  gap: 0.25rem 1.2rem; margin: 0.5rem 0 1rem }", &
      "dt { grid-column: 1; font-weight: 600; color: var(--soft) } dd { grid-column: 2;", &
      "  margin: 0 }", &
      "dt.warning, dt.warning + dd { color: var(--warn) }", &
      "dt.warning, dt.warning + dd { background: var(--warn-ground) }", &
      ".mark { fill: none; stroke: currentColor; stroke-width: 2.5px }", &
      ".scroll { overflow-x: auto; margin: 0.5rem 0 1rem; background: linear-gradient(to left,", &
      "  var(--ground) 40%, transparent) 100% 0/40px 100% no-repeat local,", &
      "  linear-gradient(to left, var(--line), transparent) 100% 0/12px 100% no-repeat }", &
      "table { border-collapse: collapse; font-size: 0.92rem;", &
      "  font-variant-numeric: tabular-nums; overflow-wrap: normal }", &
      "caption { position: absolute; width: 1px; height: 1px; overflow: hidden;", &
      "  clip-path: inset(50%); white-space: nowrap; left: 0 } .scroll { position: relative }", &
      "th, td { padding: 0.28rem 0.7rem; text-align: right; vertical-align: top;", &
      "  white-space: nowrap; border-bottom: 1px solid var(--line) }", &
      "th { font-weight: 600 } thead th { color: var(--soft); vertical-align: bottom }", &
      "  th[scope=row], .text { text-align: left }", &
      "figure { margin: 1rem 0 1.6rem; padding: 0.6rem; background: var(--card);", &
      "  border: 1px solid var(--line); border-radius: 6px }", &
      ".plot svg { display: block; width: 100%; max-width: 56rem; height: auto;", &
      "  margin: 0 auto }", &
      "figcaption, .reading { font-size: 0.92rem; margin: 0.5rem 0.2rem 0 }", &
      "  .reading { min-height: 1.55em; color: var(--text) }", &
      "details { margin: 1rem 0 } summary { cursor: pointer; font-weight: 600 }", &
      "code { font-family: ui-monospace, 'DejaVu Sans Mono', Consolas, monospace;", &
      "  font-size: 0.92em }", &
      "@media (max-width: 40rem) { dl { display: block } dd { margin: 0 0 0.4rem }", &
      "  h1 { font-size: 1.4rem } table { font-size: 0.8rem } th,", &
      "  td { padding: 0.25rem 0.3rem } }", &
      "@media print { :root { --text: #000; --soft: #333; --ground: #fff; --card: #fff;", &
      "  --line: #999; --link: #000; --warn: #000; --warn-ground: #fff }", &
      "  body { max-width: none; padding: 0; font-size: 10pt } .skip, nav,", &
      "  .reading { display: none } h1, h2, h3, h4 { break-after: avoid } figure,", &
      "  tr { break-inside: avoid } .scroll { overflow: visible } .scroll { background: none }", &
      "  .plot svg { max-height: 8.5cm } table { font-size: 8pt } th,", &
      "  td { padding: 0.1rem 0.3rem } }"]

   !> What a page does beyond showing: a click on a legend hides and shows a series; figures are
   !> read by pointing at them, their points with the arrow keys too. Without scripts nothing is
   !> lost: the numbers are in the tables.
   character(*), parameter, public :: page_script(*) = [character(96) :: &
      "'use strict';", &
      "document.querySelectorAll('.fig .key').forEach(function (key) {", &
      "  var series = '[data-series=""' + key.dataset.series + '""]';", &
      "  key.addEventListener('click', function () {", &
      "    key.parentNode.querySelectorAll(series).forEach(function (g) {", &
      "      g.classList.toggle('off');", &
      "    });", &
      "  });", &
      "});", &
      "document.querySelectorAll('figure').forEach(function (figure) {", &
      "  var svg = figure.querySelector('svg'), scale = svg.dataset;", &
      "  var labels = svg.querySelectorAll('.label'), at = -1;", &
      "  var points = Array.from(svg.querySelectorAll('.series [data-i]'));", &
      "  var reading = document.createElement('p');", &
      "  reading.className = 'reading';", &
      "  reading.setAttribute('role', 'status');", &
      "  reading.textContent = 'To read values, point at it, or use the arrow keys.';", &
      "  figure.insertBefore(reading, figure.querySelector('figcaption'));", &
      "  var mark = document.createElementNS(svg.namespaceURI, 'circle');", &
      "  mark.setAttribute('class', 'mark');", &
      "  mark.setAttribute('r', '8');", &
      "  function place(i) {", &
      "    var box = points[i].getBBox();", &
      "    return { x: box.x + box.width / 2, y: box.y + box.height / 2 };", &
      "  }", &
      "  function value(axis, p) {", &
      "    var a = [0, 1, 2, 3].map(function (i) { return Number(scale[axis + i]); });", &
      "    p = Math.min(1, Math.max(0, (p - a[0]) / (a[1] - a[0])));", &
      "    p = a[2] + p * (a[3] - a[2]);", &
      "    return Number((scale.log ? Math.pow(10, p) : p).toPrecision(4));", &
      "  }", &
      "  function show(p, name) {", &
      "    reading.textContent = name + labels[0].textContent + ': ' + value('x', p.x) + '; ' +", &
      "      labels[1].textContent + ': ' + value('y', p.y);", &
      "  }", &
      "  function choose(i) {", &
      "    var p = place(i), series = points[i].parentNode.dataset.series;", &
      "    at = i;", &
      "    mark.setAttribute('cx', p.x);", &
      "    mark.setAttribute('cy', p.y);", &
      "    svg.appendChild(mark);", &
      "    series = svg.querySelector('.key[data-series=""' + series + '""]');", &
      "    show(p, series.textContent.trim() + ': ');", &
      "  }", &
      "  svg.addEventListener('pointermove', function (event) {", &
      "    var p = new DOMPoint(event.clientX, event.clientY), best = -1, least = 12;", &
      "    p = p.matrixTransform(svg.getScreenCTM().inverse());", &
      "    points.forEach(function (point, i) {", &
      "      var d = Math.hypot(place(i).x - p.x, place(i).y - p.y);", &
      "      if (d >= least || point.getClientRects().length === 0) return;", &
      "      least = d;", &
      "      best = i;", &
      "    });", &
      "    if (best >= 0) return choose(best);", &
      "    mark.remove();", &
      "    show(p, '');", &
      "  });", &
      "  figure.querySelector('.plot').addEventListener('keydown', function (event) {", &
      "    var step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;", &
      "    if (step === 0 || points.length === 0) return;", &
      "    event.preventDefault();", &
      "    choose(Math.max(0, Math.min(points.length - 1, at + step)));", &
      "  });", &
      "});"]

end module gyroakf_report_html_style
