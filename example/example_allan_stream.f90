! SPDX-License-Identifier: MIT
!> The Allan deviation of a record that comes in blocks and is never in memory as a whole.
program example_allan_stream
   use gyroakf, only : dp, int64, error_type, random_type, seed_random, fill_normal, allan_options, allan_curve_type, &
      allan_stream_type, begin_allan_stream, feed_allan_stream, finish_allan_stream
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(allan_stream_type) :: stream
   type(allan_curve_type) :: curve
   type(random_type) :: random
   real(dp) :: block(10000)
   integer :: i

   call seed_random(random, 1_int64)
   call begin_allan_stream(stream, 0.01_dp, allan_options(taus="decade"), error)
   do i = 1, 100                                                 ! white noise, N = 0.1, at 100 Hz
      call fill_normal(random, block)
      if (.not. allocated(error)) call feed_allan_stream(stream, block, error)
   end do
   if (.not. allocated(error)) call finish_allan_stream(stream, curve, error)
   if (allocated(error)) error stop error%message
   print "(f9.2, es12.4, f12.1)", (curve%tau(i), curve%deviation(i), curve%edf(i), i=1, size(curve%tau))
end program example_allan_stream
