! SPDX-License-Identifier: MIT
!> Monte Carlo of the outlier rule `auto`: outliers found, false rejections, and motion, in noise of many kinds.
!>
!> Sizes are in standard deviations of the noise without its random walk, uniform between two limits, with random signs.
program outliers
   use, intrinsic :: iso_fortran_env, only : output_unit
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_random, only : random_type, seed_random, next_laplace, next_normal, next_t5, next_uniform
   use gyroakf_preprocess_auto_outliers, only : auto_threshold, find_auto_outliers
   implicit none (type, external)

   !> A row of the table
   type :: case_type
      character(28) :: name = ""
      integer :: samples = 100000, records = 60
      !> white, laplace, t5, t3, ar
      character(7) :: noise = "white"
      !> Of ar; random walk a sample, quantization step
      real(dp) :: phi = 0.0_dp, walk = 0.0_dp, lsb = 0.0_dp
      !> Share of outliers, their least and largest size
      real(dp) :: share = 0.0_dp, least = 4.0_dp, largest = 50.0_dp
      !> "", box, sine, 17 Hz, noise (3 s at 100 Hz), steps, warm-up, cubic
      character(7) :: shape = ""
   end type case_type

   !> Counts of a row
   type :: count_type
      !> Samples, and outliers: all, beyond 6 standard deviations
      real(dp) :: samples = 0.0_dp, outliers(2) = 0.0_dp, found(2) = 0.0_dp
      !> False rejections, those within the motion; records with any of them, and with motion
      real(dp) :: false = 0.0_dp, within = 0.0_dp, records_false = 0.0_dp, records_within = 0.0_dp, records_motion = 0.0_dp
   end type count_type

   real(dp), parameter :: pi = 3.14159265358979324_dp
   !> Samples of the motion, and its size
   integer, parameter :: motion_length = 300
   real(dp), parameter :: motion_size = 20.0_dp
   character(12) :: word
   real(dp) :: percent
   integer(int64) :: seed

   percent = 100
   seed = 37000
   call get_command_argument(1, word)
   if (word /= "") read (word, *) percent
   call get_command_argument(2, word)
   if (word /= "") read (word, *) seed
   if (percent > 0) call print_table()
   call print_time()

contains

   subroutine print_table()
      character(*), parameter :: shapes(4) = [character(7) :: "box", "sine", "17 Hz", "noise"]
      real(dp), parameter :: lsbs(5) = [0.1_dp, 0.5_dp, 1.0_dp, 2.0_dp, 4.0_dp]
      integer, parameter :: white(3) = [1000, 200, 20]
      character(12) :: text
      integer :: i, j

      write (output_unit, "(a)") "| record | samples | records | found, % of all / beyond 6 sd | false, % (records) | motion, "// &
         & "% of records |", "|---|---|---|---|---|---|"
      do j = 1, 3
         do i = 1, 3
            call run_case(case_type(name=pick(["white  ", "Laplace", "t5     "], j), samples=10**(3 + i), &
               & records=merge(white(i), white(i)*3/10, j == 1), noise=pick(["white  ", "laplace", "t5     "], j)))
         end do
      end do
      call run_case(case_type(name="t3", noise="t3"))
      call run_case(case_type(name="AR(1) 0.4", noise="ar", phi=0.4_dp))
      call run_case(case_type(name="AR(1) 0.95", noise="ar", phi=0.95_dp))
      call run_case(case_type(name="RW 0.3", walk=0.3_dp))
      do i = 1, 5
         write (text, "(a, f3.1)") "LSB ", lsbs(i)
         call run_case(case_type(name=text, lsb=lsbs(i)))
      end do
      call run_case(case_type(name="LSB 2, RW 0.3", lsb=2.0_dp, walk=0.3_dp))
      call run_case(case_type(name="5.4 % at 4-50", samples=10000, records=200, share=0.054_dp))
      call run_case(case_type(name="5.4 % at 4-50", share=0.054_dp))
      call run_case(case_type(name="5.4 % at 4-50, AR(1) 0.95", records=30, noise="ar", phi=0.95_dp, share=0.054_dp))
      call run_case(case_type(name="5.4 % at 4-50, RW 0.3", records=30, walk=0.3_dp, share=0.054_dp))
      call run_case(case_type(name="10 % at 4-50", records=30, share=0.1_dp))
      call run_case(case_type(name="20 % at 4-50", records=10, share=0.2_dp))
      call run_case(case_type(name="50 at 8-20, RW 0.3", samples=10000, records=200, walk=0.3_dp, share=0.005_dp, least=8.0_dp, &
         & largest=20.0_dp))
      call run_case(case_type(name="50 at 8-20, RW 0.3", walk=0.3_dp, share=0.0005_dp, least=8.0_dp, largest=20.0_dp))
      call run_case(case_type(name="12 at 8-20", samples=1000000, records=10, share=12.0e-6_dp, least=8.0_dp, largest=20.0_dp))
      call run_case(case_type(name="1 % at 8-20, LSB 2", records=30, lsb=2.0_dp, share=0.01_dp, least=8.0_dp, largest=20.0_dp))
      call run_case(case_type(name="1 % at 8-20, Laplace", records=30, noise="laplace", share=0.01_dp, least=8.0_dp, &
         & largest=20.0_dp))
      do i = 1, size(shapes)
         call run_case(case_type(name="motion of 3 s, 20: "//shapes(i), records=100, shape=shapes(i)))
      end do
      call run_case(case_type(name="ten steps of 20", shape="steps"))
      call run_case(case_type(name="warm-up", shape="warm-up"))
      call run_case(case_type(name="12 at 6-10, AR(1), cubic", samples=12000, records=30, noise="ar", phi=0.409975_dp, &
         & share=0.001_dp, least=6.0_dp, largest=10.0_dp, shape="cubic"))
   end subroutine print_table

   pure function pick(words, i) result(word)
      character(*), intent(in) :: words(:)
      integer, intent(in) :: i
      character(7) :: word

      word = words(i)
   end function pick

   subroutine run_case(case)
      type(case_type), intent(in) :: case
      type(count_type) :: counts, one
      integer :: i, records

      records = max(1, nint(case%records*percent/100))
      !$omp parallel do default(shared) private(one) schedule(dynamic) if (case%samples <= 100000)
      do i = 1, records
         call run_record(case, seed + i, one)
         !$omp critical
         counts%samples = counts%samples + one%samples
         counts%outliers = counts%outliers + one%outliers
         counts%found = counts%found + one%found
         counts%false = counts%false + one%false
         counts%within = counts%within + one%within
         counts%records_false = counts%records_false + merge(1, 0, one%false > 0)
         counts%records_within = counts%records_within + merge(1, 0, one%within > 0)
         counts%records_motion = counts%records_motion + one%records_motion
         !$omp end critical
      end do
      !$omp end parallel do
      seed = seed + records
      call print_row(case, counts, records)
   end subroutine run_case

   subroutine run_record(case, number, one)
      type(case_type), intent(in) :: case
      integer(int64), intent(in) :: number
      type(count_type), intent(out) :: one
      real(dp), allocatable :: x(:), added(:)
      integer(int8), allocatable :: inlier(:)
      integer(int64), allocatable :: motion(:, :)
      type(error_type), allocatable :: error
      type(random_type) :: random
      real(dp) :: used
      integer :: first

      allocate (x(case%samples), added(case%samples), inlier(case%samples))
      call seed_random(random, number)
      call make_noise(case, random, x)
      call add_outliers(case, random, added)
      call add_shape(case%shape, random, x, first)
      x = x + added
      if (case%lsb > 0) x = case%lsb*anint(x/case%lsb)
      call find_auto_outliers(x, auto_threshold(size(x, kind=int64)), inlier, used, motion, error)
      if (allocated(error)) error stop "the rule failed"
      associate (marked => inlier == 0_int8, bad => abs(added) > 0)
         one%samples = size(x)
         one%outliers = [count(bad), count(abs(added) > 6)]
         one%found = [count(bad .and. marked), count(abs(added) > 6 .and. marked)]
         one%false = count(marked .and. .not. bad)
         if (first > 0) one%within = count(marked(first:first + motion_length - 1))
         one%records_motion = merge(1, 0, size(motion, 2) > 0)
      end associate
   end subroutine run_record

   !> Noise of the standard deviation 1, and the walk.
   subroutine make_noise(case, random, x)
      type(case_type), intent(in) :: case
      type(random_type), intent(inout) :: random
      real(dp), intent(out) :: x(:)
      real(dp) :: g(4), sum_of_steps
      integer :: i, j

      do i = 1, size(x)
         select case (case%noise)
         case ("laplace"); call next_laplace(random, x(i))
         case ("t5"); call next_t5(random, x(i))
         case ("t3")
            do j = 1, 4
               call next_normal(random, g(j))
            end do
            x(i) = g(1)/sqrt(sum(g(2:)**2))
         case default
            call next_normal(random, x(i))
            if (i > 1) x(i) = case%phi*x(i - 1) + sqrt(1 - case%phi**2)*x(i)
         end select
      end do
      sum_of_steps = 0
      do i = 1, merge(size(x), 0, case%walk > 0)
         call next_normal(random, g(1))
         sum_of_steps = sum_of_steps + case%walk*g(1)
         x(i) = x(i) + sum_of_steps
      end do
   end subroutine make_noise

   subroutine add_outliers(case, random, added)
      type(case_type), intent(in) :: case
      type(random_type), intent(inout) :: random
      real(dp), intent(out) :: added(:)
      real(dp) :: u
      integer :: i, wanted

      added = 0
      wanted = nint(case%share*size(added))
      do while (wanted > 0)
         call next_uniform(random, u)
         i = 1 + int(u*size(added))
         if (abs(added(i)) > 0) cycle
         call next_uniform(random, u)
         added(i) = sign(case%least + (case%largest - case%least)*abs(2*u - 1), u - 0.5_dp)
         wanted = wanted - 1
      end do
   end subroutine add_outliers

   !> Motion from the sample `first` on, or what is no motion (then first is 0).
   subroutine add_shape(shape, random, x, first)
      character(*), intent(in) :: shape
      type(random_type), intent(inout) :: random
      real(dp), intent(inout) :: x(:)
      integer, intent(out) :: first
      real(dp) :: u, g, t
      integer :: i

      call next_uniform(random, u)
      first = 1 + int(u*(size(x) - motion_length))
      do i = first, first + motion_length - 1
         t = (i - first + 0.5_dp)/motion_length
         select case (shape)
         case ("box"); x(i) = x(i) + motion_size
         case ("sine"); x(i) = x(i) + motion_size*sin(pi*t)
         case ("17 Hz"); x(i) = x(i) + motion_size*sin(2*pi*17*3*t)
         case ("noise")
            call next_normal(random, g)
            x(i) = x(i) + motion_size*g
         case default
            first = 0
            exit
         end select
      end do
      do i = 1, merge(10, 0, shape == "steps")
         call next_uniform(random, u)
         associate (at => 1 + int(u*size(x)))
            call next_uniform(random, u)
            x(at:) = x(at:) + sign(motion_size, u - 0.5_dp)
         end associate
      end do
      do i = 1, merge(size(x), 0, shape == "warm-up" .or. shape == "cubic")
         t = i/real(size(x), dp)
         if (shape == "cubic") then
            x(i) = x(i) + 2*t*(t - 0.4_dp)*(t - 0.9_dp)
         else
            x(i) = x(i) + 100*exp(-8*t)
         end if
      end do
   end subroutine add_shape

   subroutine print_row(case, counts, records)
      type(case_type), intent(in) :: case
      type(count_type), intent(in) :: counts
      integer, intent(in) :: records
      character(200) :: line
      character(40) :: found, within

      found = ""
      within = ""
      if (counts%outliers(1) > 0) write (found, "(f0.2, a, f0.2)") 100*counts%found(1)/counts%outliers(1), " / ", &
         & 100*counts%found(2)/counts%outliers(2)
      if (index(case%name, "motion") > 0) write (within, "(a, i0, a, i0, a)") "; within the motion: ", nint(counts%within), &
         & " in ", nint(counts%records_within), " records"
      write (line, "(3a, es7.1, a, i0, 3a, f0.5, a, f0.1, 3a, f0.1, a)") "| ", case%name, " | ", real(case%samples, dp), " | ", &
         & records, " | ", trim(found), " | ", 100*counts%false/counts%samples, " (", 100*counts%records_false/records, " %", &
         & trim(within), ") | ", 100*counts%records_motion/records, " |"
      write (output_unit, "(a)") trim(line)
      flush (output_unit)
   end subroutine print_row

   subroutine print_time()
      integer(int64), parameter :: n = 100000000_int64
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: inlier(:)
      integer(int64), allocatable :: motion(:, :)
      type(error_type), allocatable :: error
      type(random_type) :: random
      real(dp) :: used
      real(dp) :: before, after
      integer(int64) :: i, start, finish, rate

      allocate (x(n), inlier(n))
      call seed_random(random, seed)
      do i = 1, n
         call next_normal(random, x(i))
      end do
      call system_clock(start, rate)
      call cpu_time(before)
      call find_auto_outliers(x, auto_threshold(n), inlier, used, motion, error)
      call system_clock(finish)
      call cpu_time(after)
      if (allocated(error)) error stop "the rule failed"
      write (output_unit, "(2(a, f0.2), a, i0, a)") "1e8 samples of white noise: ", real(finish - start, dp)/rate, " s, ", &
         & after - before, " s of processor time, ", count(inlier == 0_int8), " rejected"
   end subroutine print_time

end program outliers
