! SPDX-License-Identifier: MIT
!> Deviations of white noise under an offset of very many standard deviations, against the definitions in quadruple precision.
!>
!>     allan_stress [SAMPLES [OFFSET]]    default: 10000000 1e6; prints for each averaging time the relative differences
program allan_stress
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit, qp => real128
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, fill_normal, int64, random_type, seed_random
   implicit none (type, external)

   !> Octaves from one averaging time that is checked to the next
   integer, parameter :: step = 3
   !> What is allowed
   real(dp), parameter :: allowed = 1.0e-9_dp
   character(*), parameter :: kinds(3) = [character(5) :: "oadev", "ohdev", "mdev"]
   type(allan_options) :: options
   type(allan_curve_type) :: curve(size(kinds))
   type(error_type), allocatable :: error
   type(random_type) :: random
   real(dp), allocatable :: rate(:), difference(:, :)
   real(qp), allocatable :: phase(:)
   real(dp) :: offset
   integer(int64) :: samples
   integer :: i, j, points

   samples = 10000000
   offset = 1.0e6_dp
   call read_arguments(samples, offset)
   allocate (rate(samples), phase(0:samples))
   call seed_random(random, 1_int64)
   call fill_normal(random, rate)
   rate = rate + offset
   call integrate(rate, phase)
   options%taus = "octave"
   do j = 1, size(kinds)
      options%kind = kinds(j)
      call compute_allan(rate, 1.0_dp, options, curve(j), error)
      if (allocated(error)) then
         write (error_unit, "(a)") error%message
         stop 1, quiet=.true.
      end if
   end do
   points = minval([(size(curve(j)%m), j = 1, size(kinds))])
   allocate (difference(points, size(kinds)), source=0.0_dp)
   !$omp parallel do collapse(2) schedule(dynamic)
   do j = 1, size(kinds)
      do i = 1, points, step
         difference(i, j) = real(abs(curve(j)%deviation(i)/exact_deviation(kinds(j), phase, curve(j)%m(i)) - 1), dp)
      end do
   end do
   !$omp end parallel do
   write (output_unit, "(i0, a, es8.1, a)") samples, " samples, offset ", offset, " standard deviations; relative difference of"
   write (output_unit, "(a12, 3a12)") "m", kinds
   do i = 1, points, step
      write (output_unit, "(i12, 3es12.1)") curve(1)%m(i), difference(i, :)
   end do
   write (output_unit, "(a, es8.1, a, es8.1)") "largest ", maxval(difference), ", allowed ", allowed
   if (maxval(difference) > allowed) stop 1, quiet=.true.

contains

   !> Samples and offset from the command line.
   subroutine read_arguments(samples, offset)
      !> Left alone where nothing is given
      integer(int64), intent(inout) :: samples
      real(dp), intent(inout) :: offset

      character(40) :: text

      call get_command_argument(1, text)
      if (text /= "") read (text, *) samples
      call get_command_argument(2, text)
      if (text /= "") read (text, *) offset
   end subroutine read_arguments

   !> The integral of the rate less its mean.
   pure subroutine integrate(rate, phase)
      !> Rate: [n]
      real(dp), intent(in) :: rate(:)
      !> Phase: [0:n]
      real(qp), intent(out) :: phase(0:)

      integer(int64) :: k, n
      real(qp) :: mean

      n = size(rate, kind=int64)
      mean = 0
      do k = 1, n
         mean = mean + rate(k)
      end do
      mean = mean/n
      phase(0) = 0
      do k = 1, n
         phase(k) = phase(k - 1) + (rate(k) - mean)
      end do
   end subroutine integrate

   !> A deviation by its definition.
   pure real(qp) function exact_deviation(kind, x, m) result(deviation)
      !> oadev, ohdev or mdev
      character(*), intent(in) :: kind
      !> Phase: [0:n]
      real(qp), intent(in) :: x(0:)
      !> Averaging factor
      integer(int64), intent(in) :: m

      integer(int64) :: k, n
      real(qp) :: squares, z

      n = ubound(x, 1, kind=int64)
      squares = 0
      select case (kind)
      case ("oadev")
         do k = 0, n - 2*m
            squares = squares + (x(k + 2*m) - 2*x(k + m) + x(k))**2
         end do
         deviation = sqrt(squares/(2*(n - 2*m + 1)))/m
      case ("ohdev")
         do k = 0, n - 3*m
            squares = squares + (x(k + 3*m) - 3*x(k + 2*m) + 3*x(k + m) - x(k))**2
         end do
         deviation = sqrt(squares/(6*(n - 3*m + 1)))/m
      case default
         z = 0
         do k = 0, m - 1
            z = z + (x(k + 2*m) - 2*x(k + m) + x(k))
         end do
         squares = z**2
         do k = 0, n - 3*m
            z = z + (x(k + 3*m) - 3*x(k + 2*m) + 3*x(k + m) - x(k))
            squares = squares + z**2
         end do
         deviation = sqrt(squares/(2*(n - 3*m + 2)))/m**2
      end select
   end function exact_deviation

end program allan_stress
