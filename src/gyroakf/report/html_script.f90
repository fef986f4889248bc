! SPDX-License-Identifier: MIT
!> What a page does: entries of a legend show and hide their series; the Allan deviation is read by pointing at it or with
!> the arrow keys, from the table that holds its numbers; paper shows what is folded. Without scripts nothing is lost: the
!> table is there.
module gyroakf_report_html_script
   use gyroakf_io_writer, only : writer_type, put_line
   implicit none (type, external)
   private
   public :: put_script

   character(*), parameter :: lines(*) = [character(128) :: &
      "'use strict';", &
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
      "  var reading = document.createElement('p');", &
      "  reading.className = 'reading';", &
      "  reading.setAttribute('role', 'status');", &
      "  reading.textContent = 'To read the curve, point at it, or use the arrow keys.';", &
      "  figure.insertBefore(reading, figure.querySelector('figcaption'));", &
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
      "window.addEventListener('beforeprint', function () {", &
      "  document.querySelectorAll('details').forEach(function (d) { d.open = true; });", &
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
