! SPDX-License-Identifier: MIT
!> Root mean square error of a filter against the true drift (from a simulation or a reference
!> sensor).
!>
!>     call take_truth(truth, channel, job)
!>     call compute_rmse(job, x, mean, .true., result, figures)
!>
!> A filter estimates the drift of the series that it is given. The mean and the trend that were
!> removed from that series are part of the drift; they are subtracted from the true drift d before
!> the comparison:
!> $$ \mathrm{RMSE} = \sqrt{\frac1n \sum_k (\hat x_k - (d_k - p_k - \mu))^2} $$
module gyroakf_pipeline_truth
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_record, only : record_type, unit_of
   use gyroakf_units, only : quantity, unit_type
   use gyroakf_stats_trend, only : subtract_trend
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_result, only : channel_result_type, filter_figures_type
   implicit none (type, external)
   private
   public :: check_truth, take_truth, compute_rmse

   !> Relative difference of two rates that are the same
   real(dp), parameter :: same_rate = 1.0e-6_dp

contains

   !> Whether a truth fits a record: samples, channels, rate, kinds of units.
   subroutine check_truth(truth, record, error)
      !> The true drift, as a record
      type(record_type), intent(in) :: truth
      !> What is filtered
      type(record_type), intent(in) :: record
      !> invalid_argument, with what differs
      type(error_type), allocatable, intent(out) :: error
      character(160) :: text
      integer :: c

      if (.not. allocated(truth%value)) then
         call fatal_error(error, status%invalid_argument, "the true drift is empty")
         return
      end if
      text = ""
      if (any(shape(truth%value, int64) /= shape(record%value, int64))) then
         if (size(truth%value, 1, kind=int64) /= size(record%value, 1, kind=int64)) then
            write (text, '("the true drift has ", i0, " samples, the record ", i0, a)') &
               size(truth%value, 1, kind=int64), size(record%value, 1, kind=int64), &
               ": they must be on one grid"
         else
            write (text, '("the true drift has ", i0, " channels, the record ", i0)') &
               size(truth%value, 2), size(record%value, 2)
         end if
      else if (truth%rate_known .and. record%rate_known .and. &
               abs(truth%sample_interval - record%sample_interval) > &
               same_rate*record%sample_interval) then
         write (text, '("the true drift has ", g0.7, " samples a second, the record ", g0.7)') &
            1.0_dp/truth%sample_interval, 1.0_dp/record%sample_interval
      end if
      if (text /= "") then
         call fatal_error(error, status%invalid_argument, trim(text))
         return
      end if
      do c = 1, size(record%value, 2)
         call check_units(unit_of(truth, c), unit_of(record, c), error)
         if (allocated(error)) return
      end do
   end subroutine check_truth

   !> Refuses units of different quantities; an unknown unit is that of the other.
   subroutine check_units(truth, record, error)
      type(unit_type), intent(in) :: truth, record
      type(error_type), allocatable, intent(out) :: error

      if (truth%quantity == quantity%unknown .or. record%quantity == truth%quantity) return
      if (record%quantity == quantity%unknown) then
         call fatal_error(error, status%invalid_argument, "the true drift is in "//truth%name// &
                          ", and the unit of the record is not known: give it")
      else
         call fatal_error(error, status%invalid_argument, "the true drift is in "//truth%name// &
            ", the record in "//record%name)
      end if
   end subroutine check_units

   !> The true drift of one channel.
   subroutine take_truth(truth, channel, job)
      !> Checked; as long as the job
      type(record_type), intent(in), target :: truth
      !> Number of the channel
      integer, intent(in) :: channel
      !> Has the unit of the samples; its true drift is set
      type(job_type), intent(inout) :: job
      type(unit_type) :: unit

      job%true_drift => truth%value(:, channel)
      if (allocated(truth%present)) job%truth_known => truth%present(:, channel)
      unit = unit_of(truth, channel)
      job%truth_factor = 1.0_dp
      if (unit%quantity /= quantity%unknown) job%truth_factor = unit%to_si/job%unit%to_si
   end subroutine take_truth

   !> RMSE of an estimate of the drift.
   pure subroutine compute_rmse(job, x, mean, detrended, channel, figures)
      !> With the true drift
      type(job_type), intent(in) :: job
      !> The estimate: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from the series before it was filtered
      real(dp), intent(in) :: mean
      !> The series is the cleaned one: its trend was removed too
      logical, intent(in) :: detrended
      !> The trend is taken from it
      type(channel_result_type), intent(in) :: channel
      !> Its `rmse` and `rmse_samples` are set where a true drift was given
      type(filter_figures_type), intent(inout) :: figures
      integer(int64), parameter :: block = 1024
      real(dp) :: drift(block), squares
      integer(int64) :: first, last, k

      squares = 0.0_dp
      if (.not. associated(job%true_drift)) return
      do first = 1, size(x, kind=int64), block
         last = min(first + block - 1, size(x, kind=int64))
         drift(:last - first + 1) = job%truth_factor*job%true_drift(first:last)
         if (detrended .and. channel%available%preprocess) then
            call subtract_trend(channel%clean%trend, first - 1, drift(:last - first + 1))
         end if
         do k = first, last
            if (associated(job%valid)) then
               if (job%valid(k) == 0_int8) cycle
            end if
            if (associated(job%truth_known)) then
               if (job%truth_known(k) == 0_int8) cycle
            end if
            figures%rmse_samples = figures%rmse_samples + 1
            squares = squares + (x(k) - (drift(k - first + 1) - mean))**2
         end do
      end do
      associate (samples => figures%rmse_samples)
         if (samples > 0) figures%rmse = sqrt(squares/real(samples, dp))
      end associate
   end subroutine compute_rmse

end module gyroakf_pipeline_truth
