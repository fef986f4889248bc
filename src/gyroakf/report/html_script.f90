! SPDX-License-Identifier: MIT
!> What a page does: entries of a legend show and hide their series; figures are read by pointing at them, the Allan deviation
!> of a channel with the arrow keys too, from the table that holds its numbers. Without scripts nothing is lost: the table is there.
module gyroakf_report_html_script
   use gyroakf_io_writer, only : writer_type, put_line
   implicit none (type, external)
   private
   public :: put_script

   character(*), parameter :: lines(*) = [character(128) :: &
      "'use strict';", &
      "function add_reading(figure, how) {", &
      "  var reading = document.createElement('p');", &
      "  reading.className = 'reading';", &
      "  reading.setAttribute('role', 'status');", &
      "  reading.textContent = 'To read values, ' + how;", &
      "  return figure.insertBefore(reading, figure.querySelector('figcaption'));", &
      "}", &
      "document.querySelectorAll('.fig .key').forEach(function (key) {", &
      "  key.addEventListener('click', function () {", &
      "    key.parentNode.querySelectorAll('[data-series=""' + key.dataset.series + '""]').forEach(function (g) {", &
      "      g.classList.toggle('off');", &
      "    });", &
      "  });", &
      "});", &
      "document.querySelectorAll('figure[data-curve]').forEach(function (figure) {", &
      "  var channel = figure.closest('[data-channel]'), svg = figure.querySelector('svg'), at = -1;", &
      "  var points = Array.from(svg.querySelectorAll('.series.points [data-i]'));", &
      "  function column(name) {", &
      "    return channel.querySelectorAll('[data-key^=""allan.' + figure.dataset.curve + '.' + name + '.""]');", &
      "  }", &
      "  var tau = column('tau_s'), deviation = column('deviation'), lower = column('lower'), upper = column('upper');", &
      "  if (points.length === 0 || points.length !== deviation.length) return;", &
      "  var reading = add_reading(figure, 'point at it, or use the arrow keys.');", &
      "  var mark = document.createElementNS(svg.namespaceURI, 'circle');", &
      "  mark.setAttribute('r', '8'); mark.setAttribute('fill', 'none'); mark.setAttribute('stroke', 'currentColor');", &
      "  mark.setAttribute('stroke-width', '2.5');", &
      "  function show(i) {", &
      "    var box = points[i].getBBox();", &
      "    at = i;", &
      "    mark.setAttribute('cx', box.x + box.width / 2); mark.setAttribute('cy', box.y + box.height / 2);", &
      "    svg.appendChild(mark);", &
      "    reading.textContent = '\u03c4 = ' + tau[i].textContent + ' ' + figure.dataset.time + ': ' +", &
      "      deviation[i].textContent + ' ' + figure.dataset.unit + ', limits ' + lower[i].textContent + ' to ' +", &
      "      upper[i].textContent;", &
      "  }", &
      "  svg.addEventListener('pointermove', function (event) {", &
      "    var best = -1, least = 1e9;", &
      "    points.forEach(function (point, i) {", &
      "      var box = point.getBoundingClientRect(), d = Math.abs(box.left + box.width / 2 - event.clientX);", &
      "      if (d < least) { least = d; best = i; }", &
      "    });", &
      "    if (best >= 0 && best !== at) show(best);", &
      "  });", &
      "  var box = figure.querySelector('.plot');", &
      "  box.addEventListener('keydown', function (event) {", &
      "    var step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;", &
      "    if (step === 0) return;", &
      "    event.preventDefault();", &
      "    show(Math.max(0, Math.min(points.length - 1, at + step)));", &
      "  });", &
      "});", &
      "document.querySelectorAll('figure:not([data-curve])').forEach(function (figure) {", &
      "  var svg = figure.querySelector('svg'), scale = svg.dataset, labels = svg.querySelectorAll('.label');", &
      "  var points = Array.from(svg.querySelectorAll('.series [data-i]')), reading = add_reading(figure, 'point at it.');", &
      "  function value(axis, p) {", &
      "    var a = [0, 1, 2, 3].map(function (i) { return Number(scale[axis + i]); });", &
      "    p = Math.min(1, Math.max(0, (p - a[0]) / (a[1] - a[0])));", &
      "    p = a[2] + p * (a[3] - a[2]);", &
      "    return Number((scale.log ? Math.pow(10, p) : p).toPrecision(4));", &
      "  }", &
      "  svg.addEventListener('pointermove', function (event) {", &
      "    var at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());", &
      "    var name = '', least = 12;", &
      "    points.forEach(function (point) {", &
      "      var box = point.getBBox(), x = box.x + box.width / 2, y = box.y + box.height / 2;", &
      "      var d = Math.hypot(x - at.x, y - at.y), series = point.parentNode.dataset.series;", &
      "      if (d >= least || point.getClientRects().length === 0) return;", &
      "      least = d; at.near = [x, y];", &
      "      name = svg.querySelector('.key[data-series=""' + series + '""]').textContent.trim() + ': ';", &
      "    });", &
      "    at = at.near || [at.x, at.y];", &
      "    reading.textContent = name + labels[0].textContent + ': ' + value('x', at[0]) + '; ' +", &
      "      labels[1].textContent + ': ' + value('y', at[1]);", &
      "  });", &
      "});"]

contains

   !> The element.
   subroutine put_script(writer)
      !> The page
      type(writer_type), intent(inout) :: writer
      integer :: i

      call put_line(writer, "<script>")
      do i = 1, size(lines)
         call put_line(writer, trim(lines(i)))
      end do
      call put_line(writer, "</script>")
   end subroutine put_script

end module gyroakf_report_html_script
