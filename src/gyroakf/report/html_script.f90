! SPDX-License-Identifier: MIT
!> What a page does beyond showing: a click on a legend hides and shows a series; figures are read
!> by pointing at them, their points with the arrow keys too. Without scripts nothing is lost: the
!> numbers are in the tables.
module gyroakf_report_html_script
   implicit none (type, external)
   private

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

end module gyroakf_report_html_script
