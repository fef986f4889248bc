! SPDX-License-Identifier: MIT
!> Style of the figures: colors of the series, light and dark, larger letters on narrow screens.
module gyroakf_report_svg_style
   use gyroakf_io_writer, only : writer_type, put_line
   implicit none (type, external)
   private
   public :: put_svg_style, put_own_style

   character(*), parameter :: own_style(*) = [character(128) :: &
      "svg { --text: #1b1d20; --soft: #565c64; --card: #fff; --line: #cfd3d8; background: var(--card) }", &
      "@media screen and (prefers-color-scheme: dark) { svg { --text: #e6e7e9; --soft: #a9b0b9; --card: #16181b;", &
      "  --line: #3d434b } }"]
   character(*), parameter :: style(*) = [character(128) :: &
      ".fig { color: var(--text) } .fig .soft { color: var(--soft) } .fig text { fill: var(--text);", &
      "  font: 13px system-ui, 'Segoe UI', Roboto, 'Noto Sans', 'DejaVu Sans', sans-serif } .fig .title { font-weight: 600 }", &
      ".fig .middle { text-anchor: middle } .fig .end { text-anchor: end }", &
      ".fig .c1 { color: #0072b2 } .fig .c2 { color: #d55e00 } .fig .c3 { color: #008a63 } .fig .c4 { color: #b0558a }", &
      ".fig .c5 { color: #b07d00 } .fig .c6 { color: #3c93c9 }", &
      "@media screen and (prefers-color-scheme: dark) { .fig .c1 { color: #58b1ec } .fig .c2 { color: #ff8a3d }", &
      "  .fig .c3 { color: #33c79a } .fig .c4 { color: #e59ac7 } .fig .c5 { color: #f0c24f } .fig .c6 { color: #a5d8f8 } }", &
      ".fig path { fill: none; stroke: currentColor; stroke-width: 1.6; stroke-linejoin: round }", &
      ".fig .grid { stroke: var(--line); stroke-width: 1 } .fig .minor { opacity: 0.45 } .fig .frame { stroke: var(--soft) }", &
      ".fig .soft path { stroke-width: 1; opacity: 0.75 } .fig .guide path { stroke-dasharray: 7 4 }", &
      ".fig .mark path { stroke-width: 2.4 }", &
      ".fig .both path, .fig .points path { stroke-width: 1.3 } .fig .dot { fill: currentColor }", &
      ".fig .hollow { fill: var(--card) }", &
      ".plot .key { cursor: pointer } .fig .off { opacity: 0.4 } .fig .series.off { display: none }", &
      "@media (max-width: 40rem) { .fig text { font-size: 20px } }", &
      "@media print { .fig text { font-size: 13px } }"]

contains

   !> The rules that a page needs for its figures; they take the variables --text, --soft, --card
   !> and --line of the page.
   subroutine put_svg_style(writer)
      !> Within a style element
      type(writer_type), intent(inout) :: writer
      integer :: i

      do i = 1, size(style)
         call put_line(writer, trim(style(i)))
      end do
   end subroutine put_svg_style

   !> The style of a document of its own.
   subroutine put_own_style(writer)
      type(writer_type), intent(inout) :: writer
      integer :: i

      call put_line(writer, "<style>")
      do i = 1, size(own_style)
         call put_line(writer, trim(own_style(i)))
      end do
      call put_svg_style(writer)
      call put_line(writer, "</style>")
   end subroutine put_own_style

end module gyroakf_report_svg_style
