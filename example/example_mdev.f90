! SPDX-License-Identifier: MIT
!> Modified Allan deviation: it tells quantization (slope -3/2) from other short-time noise, which the Allan deviation
!> (slope -1) does not.
program example_mdev
   use gyroakf, only : dp, error_type, record_type, simulate_options, simulate_record, allan_options, allan_curve_type, &
      compute_allan
   implicit none (type, external)
   character(5), parameter :: kind(2) = ["oadev", "mdev "]
   type(error_type), allocatable :: error
   type(simulate_options) :: noise
   type(record_type) :: record
   type(allan_curve_type) :: curve
   integer :: i

   noise%samples = 100000
   noise%coefficient(1) = 1.0e-3_dp                              ! Q, deg
   call simulate_record(noise, record, error)
   do i = 1, 2
      if (.not. allocated(error)) call compute_allan(record%value(:, 1), record%sample_interval, &
                                                     allan_options(kind=kind(i), taus="2,20"), curve, error)
      if (allocated(error)) error stop error%message
      print "(a, 2es10.2, a, f6.2)", kind(i), curve%deviation, "  slope", log10(curve%deviation(2)/curve%deviation(1))
   end do
end program example_mdev
