! SPDX-License-Identifier: MIT
!> Noise coefficients read off an Allan curve by eye's rule, as data sheets and most tutorials do.
!>
!> Each term is a straight line in the log-log plot of the deviation, and is read where that line
!> says the coefficient itself:
!>
!> | term | slope | line | read at |
!> |---|---|---|---|
!> | Q | -1 | $$\sqrt 3 Q/\tau$$ | tau = sqrt 3 |
!> | N | -1/2 | $$N/\sqrt\tau$$ | tau = 1 |
!> | B | 0 | $$\sqrt{2 \ln 2/\pi} B = 0.6643 B$$ | anywhere, divided by 0.6643 |
!> | K | +1/2 | $$K \sqrt{\tau/3}$$ | tau = 3 |
!> | R | +1 | $$R \tau/\sqrt 2$$ | tau = sqrt 2 |
!>
!> The rule. Points with at least `least_edf` degrees of freedom count. The local slope at a point
!> is that of the straight line through the points within a quarter of a decade on both sides of it
!> (and at least its two neighbors), weighted with their degrees of freedom; the first and the last
!> point take that of their neighbor. The segment of a term is the longest row of at least two
!> neighboring points whose slopes lie within `tolerance` of the term's; a row shorter than
!> `least_width` decades (each point reaches half way to its neighbors) is a bend that passes by,
!> and the term is then not there. The line of the term's slope is laid through the segment,
!> weighted with the degrees of freedom, and extended to where it is read.
!>
!> Terms that overlap raise each other's lines: what is read is never below the truth but for
!> scatter, and has no standard error. [[fit_noise]] separates them.
!> Source: IEEE Std 952, annex C.
module gyroakf_allan_read_off
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_allan_noise_model, only : term_count, term_shape
   implicit none (type, external)
   private
   public :: read_off_type, read_off, least_edf

   !> What is read, in units of the curve and seconds (Q: u s, N: u sqrt(s), B: u, K: u/sqrt(s), R:
   !> u/s)
   type :: read_off_type
      !> Q N B K R, 0 where there is no segment
      real(dp) :: value(term_count) = 0.0_dp
      !> There is a segment
      logical :: found(term_count) = .false.
      !> Averaging times between which it lies, s
      real(dp) :: from_tau(term_count) = 0.0_dp, to_tau(term_count) = 0.0_dp
      !> The lowest deviation, not divided by anything (the in-run bias stability of many data
      !> sheets), and where it is, s, or 0
      real(dp) :: minimum = 0.0_dp, minimum_tau = 0.0_dp
      !> The lowest deviation is the last one: the curve still falls, a longer record would show a
      !> lower one
      logical :: falling = .false.
   end type read_off_type

   !> Largest distance of a local slope from that of a term; shortest segment, and half the width of
   !> the window of a local slope, in decades of the averaging time; degrees of freedom of a point
   real(dp), parameter :: tolerance = 0.1_dp, least_width = 1.0_dp/3, half_window = 0.25_dp, &
      & least_edf = 20.0_dp
   !> Slopes of Q N B K R
   real(dp), parameter :: term_slope(term_count) = [-1.0_dp, -0.5_dp, 0.0_dp, 0.5_dp, 1.0_dp]

contains

   !> Reads the coefficients and the minimum off a curve.
   subroutine read_off(curve, result, error)
      !> Of kind adev, oadev or totdev; its degrees of freedom say which points count
      type(allan_curve_type), intent(in) :: curve
      !> What is read; a term without a segment is not found, and that is no error
      type(read_off_type), intent(out) :: result
      !> `invalid_argument`: another kind, an empty curve
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: x(:), y(:), weight(:), slope(:)
      integer, allocatable :: place(:)
      integer :: i, term, first, last

      if (all(curve%kind /= ["adev  ", "oadev ", "totdev"])) then
         call fatal_error(error, status%invalid_argument, &
            & "coefficients are read off an Allan deviation (adev, oadev, totdev); " &
            & //"this curve is a "//trim(curve%kind))
      else if (.not. (allocated(curve%tau) .and. allocated(curve%deviation) &
         & .and. allocated(curve%edf))) then
         call fatal_error(error, status%invalid_argument, "the Allan curve is empty")
      end if
      if (allocated(error)) return
      place = pack([(i, i=1, size(curve%tau))], curve%edf >= least_edf &
         & .and. curve%deviation > tiny(1.0_dp))
      if (size(place) == 0) return
      i = minloc(curve%deviation(place), dim=1)
      result%minimum = curve%deviation(place(i))
      result%minimum_tau = curve%tau(place(i))
      result%falling = i == size(place)
      if (size(place) < 3) return
      x = log10(curve%tau(place))
      y = log10(curve%deviation(place))
      weight = curve%edf(place)
      slope = local_slopes(x, y, weight)
      do term = 1, term_count
         call longest_row(x, abs(slope - term_slope(term)) <= tolerance, first, last)
         result%found(term) = first > 0
         if (first == 0) cycle
         result%from_tau(term) = curve%tau(place(first))
         result%to_tau(term) = curve%tau(place(last))
         result%value(term) = &
            & 10**(sum(weight(first:last)*(y(first:last) &
            & - term_slope(term)*x(first:last))) /sum(weight(first:last)))/sqrt(term_shape(term, &
            & 1.0_dp))
      end do
   end subroutine read_off

   !> Slope of the weighted line through each of three or more points and those around it.
   pure function local_slopes(x, y, weight) result(slope)
      real(dp), intent(in) :: x(:), y(:), weight(:)
      real(dp) :: slope(size(x)), middle
      integer :: i, first, last

      do i = 2, size(x) - 1
         first = min(i - 1, 1 + count(x < x(i) - half_window))
         last = max(i + 1, count(x <= x(i) + half_window))
         associate (x => x(first:last), y => y(first:last), w => weight(first:last))
            middle = sum(w*x)/sum(w)
            slope(i) = sum(w*(x - middle)*y)/sum(w*(x - middle)**2)
         end associate
      end do
      slope(1) = slope(2)
      slope(size(x)) = slope(size(x) - 1)
   end function local_slopes

   !> Ends of the longest row of two or more neighbors that belong together and reach over
   !> `least_width`, 0 if there is none.
   pure subroutine longest_row(x, belongs, first, last)
      real(dp), intent(in) :: x(:)
      logical, intent(in) :: belongs(:)
      integer, intent(out) :: first, last
      real(dp) :: width, widest
      integer :: i, j

      first = 0
      last = 0
      widest = least_width*(1 - 1e-9_dp)
      i = 0
      do j = 1, size(x)
         if (.not. belongs(j)) i = j                        ! i: the last one that does not belong
         ! from half way to the point before to half way to the one after
         if (j - i < 2) cycle
         width = (x(j) + x(min(j + 1, size(x))))/2 - (x(i + 1) + x(max(i, 1)))/2
         if (width < widest &
            & .or. (first > 0 .and. first /= i + 1 .and. width <= widest*(1 + 1e-9_dp))) cycle
         first = i + 1
         last = j
         widest = width
      end do
   end subroutine longest_row

end module gyroakf_allan_read_off
