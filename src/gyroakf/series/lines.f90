! SPDX-License-Identifier: MIT
!> Spectral lines: sinusoids that stand out of the noise around them, the strongest first, each removed before the next is sought.
!>
!> The ordinates of the periodogram, and those half way between them, are compared with the level of the noise in their
!> neighbourhood ([[gyroakf_series_noise_floor]]). In noise their ratio r has an F distribution, the level being the mean of w
!> ordinates; that one of M ordinates is as large has the probability
!> $$p = 1 - \left(1 - (1 + r/w)^{-w}\right)^M.$$
!> The least probable is a line where p is small. A sinusoid is fitted to the series, its frequency included
!> ([[gyroakf_series_sinusoid]]), and subtracted; what is then left around it belongs to a line that is not steady.
module gyroakf_series_lines
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_fft, only : real_fft_plan_type, new_real_fft_plan, real_fft_forward
   use gyroakf_series_fisher, only : fisher_type, fisher_of_spectrum, centre_and_scale
   use gyroakf_series_line_search, only : search_type, begin_search, look_at, find_largest, find_extent, forbid
   use gyroakf_series_sinusoid, only : sinusoid_type, fit_sinusoid, remove_sinusoid
   implicit none (type, external)
   private
   public :: line_options, line_type, find_lines, name_harmonics, fewest_samples

   !> A shorter series is refused
   integer(int64), parameter :: fewest_samples = 32_int64
   !> Harmonics are named up to this number
   integer, parameter :: most_harmonics = 20
   !> A line is steady where what a sinusoid leaves of it is less than this part of its power
   real(dp), parameter :: steady_below = 0.1_dp
   !> Shapes that no sinusoid explains before the search is given up
   integer, parameter :: most_refusals = 10
   real(dp), parameter :: turn = 6.28318530717958647693_dp

   !> What is looked for
   type :: line_options
      !> Most lines; 0: none is sought
      integer :: most = 10
      !> A line is one where p, over all frequencies, is below this
      real(dp) :: false_alarm = 1.0e-3_dp
   end type line_options

   !> One line of a series in the unit u
   type :: line_type
      !> Frequency and its standard error, 1/(unit of dt): Hz where dt is in s
      real(dp) :: frequency = 0.0_dp, frequency_error = 0.0_dp
      !> Amplitude and its standard error, u; of a line that is not steady sqrt(2) times its root mean square
      real(dp) :: amplitude = 0.0_dp, amplitude_error = 0.0_dp
      !> Share of its power, amplitude^2/2, in the variance of the series; 0 where that was not given
      real(dp) :: share = 0.0_dp
      !> Probability that noise alone shows as large an ordinate at any frequency, and its logarithm, which does not underflow
      real(dp) :: p_value = 1.0_dp, log_p_value = 0.0_dp
      !> Ordinate over the level of the noise
      real(dp) :: ratio = 0.0_dp
      !> A sinusoid describes it; else its frequency or amplitude wander
      logical :: steady = .true.
      !> Width: that of the transform, 1/(n dt), or more where it is not steady
      real(dp) :: width = 0.0_dp
      !> The sinusoid $$c \cos 2\pi f t + s \sin 2\pi f t$$ in the series, t = 0 at the first sample given: c and s, u
      real(dp) :: cosine = 0.0_dp, sine = 0.0_dp
      !> 2, 3, ...: its frequency is so many times that of the line numbered `fundamental`; 0: of none
      integer :: harmonic = 0, fundamental = 0
   end type line_type

contains

   !> The strongest lines of a white series, or of one that an AR model whitened.
   !>
   !> With `phi`, the coefficients of the AR model whose residuals x is, amplitudes are those of the series before, divided
   !> by the gain of the whitening filter, $$|1 - \sum_j \phi_j e^{-2\pi i fj}|:$$ generalised least squares.
   !> Lines with fewer than 5 periods in the series, or as near to half the sample rate, are not sought. With missing samples the
   !> probabilities are approximate. Standard errors are the Cramer-Rao bounds: D. C. Rife & R. R. Boorstyn, Single-tone parameter
   !> estimation from discrete-time observations, IEEE Trans. Inf. Theory 20 (1974) 591-598.
   subroutine find_lines(x, dt, options, lines, error, valid, phi, variance, fisher, progress)
      !> Series: [n], n >= 32; finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Sample interval > 0; 1: frequencies in cycles per sample
      real(dp), intent(in) :: dt
      !> How many, and how sure
      type(line_options), intent(in) :: options
      !> In the order of their frequencies; of length 0 where there is none
      type(line_type), allocatable, intent(out) :: lines(:)
      !> invalid_argument, too_few_samples, constant_input, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> AR coefficients
      real(dp), intent(in), optional :: phi(:)
      !> Variance of the series before whitening, > 0; absent: no shares
      real(dp), intent(in), optional :: variance
      !> Fisher's test of x, on the way
      type(fisher_type), intent(out), optional :: fisher
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(real_fft_plan_type) :: plan
      type(search_type) :: search
      real(dp), allocatable :: rest(:)
      type(line_type), allocatable :: found(:)
      integer :: number, power, stat

      call check_input(size(x, kind=int64), dt, options, error)
      if (.not. allocated(error)) call centre_and_scale(x, rest, error, valid, power, progress)
      if (.not. allocated(error)) call new_real_fft_plan(plan, size(x, kind=int64), error, progress)
      if (.not. allocated(error)) call begin_search(search, size(x, kind=int64), error)
      if (allocated(error)) return
      allocate (found(min(int(options%most, int64), size(x, kind=int64)/2)), stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for the lines")
      if (.not. allocated(error)) call find_all(search, plan, options, rest, found, number, error, valid, fisher, progress)
      if (allocated(error)) return
      allocate (lines(number))
      call put_in_order(found(:number), scale(1.0_dp, power), dt, lines, phi, variance)
      call name_harmonics(lines, 1.0_dp/(real(size(x, kind=int64), dp)*dt))
   end subroutine find_lines

   !> What cannot be looked at.
   subroutine check_input(n, dt, options, error)
      integer(int64), intent(in) :: n
      real(dp), intent(in) :: dt
      type(line_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      character(100) :: text

      if (.not. dt > 0.0_dp) then
         call fatal_error(error, status%invalid_argument, "the sample interval must be larger than 0")
      else if (options%most < 0 .or. .not. (options%false_alarm > 0.0_dp .and. options%false_alarm < 1.0_dp)) then
         call fatal_error(error, status%invalid_argument, &
                          "the number of lines must not be negative, and their false alarms lie between 0 and 1")
      else if (n < fewest_samples) then
         write (text, '("to look for lines takes at least ", i0, " samples, there are ", i0)') fewest_samples, n
         call fatal_error(error, status%too_few_samples, trim(text))
      end if
   end subroutine check_input

   !> Transform, largest ordinate, sinusoid, and so on with what is left.
   subroutine find_all(search, plan, options, rest, found, number, error, valid, fisher, progress)
      type(search_type), intent(inout) :: search
      type(real_fft_plan_type), intent(in) :: plan
      type(line_options), intent(in) :: options
      !> The series; without its lines afterwards
      real(dp), intent(inout), contiguous :: rest(:)
      type(line_type), intent(inout) :: found(:)
      integer, intent(out) :: number
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      type(fisher_type), intent(out), optional :: fisher
      class(progress_type), intent(inout), optional :: progress
      complex(dp), allocatable :: spectrum(:)
      type(sinusoid_type) :: sinusoid
      logical :: more
      integer :: stat

      number = 0
      allocate (spectrum(0:search%samples/2), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the spectrum of the series")
         return
      end if
      do
         call tell_progress("looking for lines", int(number, int64), int(max(options%most, 1), int64), error, progress)
         if (.not. allocated(error)) call real_fft_forward(plan, rest, spectrum, error, progress)
         if (.not. allocated(error) .and. number == 0 .and. present(fisher)) then
            call fisher_of_spectrum(spectrum, search%samples, fisher, error)
         end if
         if (allocated(error) .or. options%most == 0) return
         call look_at(search, spectrum, error, progress)
         if (allocated(error)) return
         if (number > 0) call measure(search, sinusoid, found(number))
         if (number == size(found)) return
         call find_next(search, spectrum, options%false_alarm, rest, found(number + 1), sinusoid, more, error, valid, progress)
         if (allocated(error) .or. .not. more) return
         number = number + 1
         call remove_sinusoid(rest, sinusoid, valid)
      end do
   end subroutine find_all

   !> The next line and its sinusoid.
   subroutine find_next(search, spectrum, false_alarm, rest, line, sinusoid, more, error, valid, progress)
      type(search_type), intent(inout) :: search
      complex(dp), intent(in), contiguous :: spectrum(0:)
      real(dp), intent(in) :: false_alarm
      !> What earlier lines left
      real(dp), intent(in), contiguous :: rest(:)
      type(line_type), intent(out) :: line
      type(sinusoid_type), intent(out) :: sinusoid
      !> There is one
      logical, intent(out) :: more
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: place
      logical :: fitted
      integer :: i

      more = .false.
      do i = 1, most_refusals
         call find_largest(search, spectrum, place, line%ratio, line%log_p_value, error, progress)
         if (allocated(error)) return
         more = place > 0.0_dp .and. line%log_p_value < log(false_alarm)
         if (.not. more) return
         call fit_sinusoid(rest, place/real(search%samples, dp), sinusoid, fitted, error, valid, progress)
         if (fitted .or. allocated(error)) return
         call forbid(search, place)
      end do
      more = .false.
   end subroutine find_next

   !> Size of a line and its errors, per sample and in the unit of what was searched; its neighbourhood is not looked at again.
   subroutine measure(search, sinusoid, line)
      type(search_type), intent(inout) :: search
      type(sinusoid_type), intent(in) :: sinusoid
      type(line_type), intent(inout) :: line
      real(dp) :: noise, excess, n

      n = real(search%samples, dp)
      line%frequency = sinusoid%frequency
      line%cosine = sinusoid%cosine
      line%sine = sinusoid%sine
      line%amplitude = hypot(sinusoid%cosine, sinusoid%sine)
      call find_extent(search, sinusoid%frequency*n, noise, excess, line%width, line%steady)
      noise = noise/sinusoid%samples                                  ! variance of a sample, were all noise like this
      line%width = line%width/n
      line%amplitude_error = sqrt(2.0_dp*noise/sinusoid%samples)
      line%frequency_error = sqrt(24.0_dp*noise/sinusoid%samples)/(turn*n*max(line%amplitude, tiny(n)))
      excess = 2.0_dp*excess/sinusoid%samples**2
      line%steady = line%steady .or. excess < 0.5_dp*steady_below*line%amplitude**2
      if (line%steady) then
         line%width = 1.0_dp/n
      else
         line%amplitude = sqrt(line%amplitude**2 + 2.0_dp*excess)
         line%frequency_error = max(line%frequency_error, 0.25_dp*line%width)
      end if
      line%p_value = 0.0_dp
      if (line%log_p_value > -700.0_dp) line%p_value = exp(line%log_p_value)
   end subroutine measure

   !> The lines in the unit of the series before whitening, sorted.
   pure subroutine put_in_order(found, unit, dt, lines, phi, variance)
      !> In the order of their detection, per sample
      type(line_type), intent(in) :: found(:)
      !> What one is in the unit of the series; sample interval
      real(dp), intent(in) :: unit, dt
      type(line_type), intent(inout) :: lines(:)
      real(dp), intent(in), optional :: phi(:), variance
      complex(dp) :: factor, turned
      integer :: i, j, k

      do i = 1, size(found)
         j = 1
         do k = 1, size(found)
            if (found(k)%frequency < found(i)%frequency .or. (k < i .and. found(k)%frequency <= found(i)%frequency)) j = j + 1
         end do
         factor = unit
         if (present(phi)) factor = unit/whitening(phi, found(i)%frequency)
         lines(j) = found(i)
         lines(j)%amplitude = found(i)%amplitude*abs(factor)
         lines(j)%amplitude_error = found(i)%amplitude_error*abs(factor)
         turned = cmplx(found(i)%cosine, -found(i)%sine, dp)*factor
         lines(j)%cosine = real(turned, dp)
         lines(j)%sine = -aimag(turned)
         if (present(variance)) lines(j)%share = 0.5_dp*lines(j)%amplitude**2/variance
         lines(j)%frequency = found(i)%frequency/dt
         lines(j)%frequency_error = found(i)%frequency_error/dt
         lines(j)%width = found(i)%width/dt
      end do
   end subroutine put_in_order

   !> 1 - sum phi_j exp(-2 pi i f j).
   pure complex(dp) function whitening(phi, frequency) result(total)
      real(dp), intent(in) :: phi(:)
      !> Cycles per sample
      real(dp), intent(in) :: frequency
      integer :: j

      total = (1.0_dp, 0.0_dp)
      do j = 1, size(phi)
         total = total - phi(j)*exp(cmplx(0.0_dp, -turn*frequency*real(j, dp), dp))
      end do
      if (abs(total) <= tiny(turn)) total = tiny(turn)
   end function whitening

   !> Names the lines whose frequency is a multiple of another's, of the lowest such line.
   pure subroutine name_harmonics(lines, resolution)
      !> In the order of their frequencies; `harmonic` and `fundamental` are set
      type(line_type), intent(inout) :: lines(:)
      !> Distance of two ordinates, in the unit of the frequencies
      real(dp), intent(in) :: resolution
      real(dp) :: gap, allowed
      integer :: i, j, h

      do i = 1, size(lines)
         lines(i)%harmonic = 0
         lines(i)%fundamental = 0
         do j = 1, i - 1
            if (lines(j)%harmonic > 0) cycle
            h = nint(min(lines(i)%frequency/max(lines(j)%frequency, tiny(gap)), 1.0e6_dp))
            if (h < 2 .or. h > most_harmonics) cycle
            gap = abs(lines(i)%frequency - real(h, dp)*lines(j)%frequency)
            allowed = hypot(lines(i)%frequency_error, real(h, dp)*lines(j)%frequency_error)
            if (gap > max(5.0_dp*allowed, 0.5_dp*resolution)) cycle
            lines(i)%harmonic = h
            lines(i)%fundamental = j
            exit
         end do
      end do
   end subroutine name_harmonics

end module gyroakf_series_lines
