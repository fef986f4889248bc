! SPDX-License-Identifier: MIT
!> Columns that are put together of chunks, whose memory is given back on the way.
module test_store
   use expectations, only : unmet, test, error, check
   use gyroakf_io_store, only : add_chunk, count_rows, store_type, take_columns
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: suite_store

contains

   subroutine suite_store()
      call test("many-pages", test_pages)
      call test("single-chunk", test_single)
   end subroutine suite_store

   !> Appends a chunk of three columns, k, -k and k + 0.5 in row k of the store; it has room for some rows more.
   subroutine fill_chunk(store, rows)
      type(store_type), intent(inout) :: store
      integer(int64), intent(in) :: rows
      integer(int64) :: before, i
      integer :: failed

      before = count_rows(store)
      call add_chunk(store, rows + 3, 3, failed)
      if (failed /= 0) return
      associate (chunk => store%chunk(store%count))
         do i = 1, rows
            chunk%value(i, :) = real(before + i, dp)*[1.0_dp, -1.0_dp, 1.0_dp] + [0.0_dp, 0.0_dp, 0.5_dp]
         end do
         chunk%rows = rows
      end associate
   end subroutine fill_chunk

   !> Chunks of several large pages, and smaller ones; a column that is wanted twice, and one that is the time, too.
   subroutine test_pages()
      type(store_type) :: store
      real(dp), allocatable :: value(:, :), stamps(:)
      integer(int64) :: i, n
      integer :: failed

      call fill_chunk(store, 700001_int64)
      call fill_chunk(store, 5_int64)
      call fill_chunk(store, 262144_int64)
      n = count_rows(store)
      call take_columns(store, 2, [3, 1, 2, 3], value, stamps, failed)
      call check(error, failed == 0 .and. count_rows(store) == 0 .and. n == 962150)
      if (unmet(all(shape(value, int64) == [n, 4_int64]) .and. size(stamps, kind=int64) == n)) return
      do i = 1, n
         if (all(abs(value(i, :) - real(i, dp)*[1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp] - [0.5_dp, 0.0_dp, 0.0_dp, 0.5_dp]) <= 0.0_dp) &
             .and. abs(stamps(i) + real(i, dp)) <= 0.0_dp) cycle
         call check(error, .false., "a row is not what it was")
         return
      end do
   end subroutine test_pages

   !> A chunk that is not full is copied, too.
   subroutine test_single()
      type(store_type) :: store
      real(dp), allocatable :: value(:, :), stamps(:)
      integer :: failed

      call fill_chunk(store, 4_int64)
      call take_columns(store, 0, [2], value, stamps, failed)
      if (unmet(failed == 0 .and. size(value) == 4 .and. size(stamps) == 0)) return
      call check(error, all(abs(value(:, 1) + [1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp]) <= 0.0_dp))
   end subroutine test_single

end module test_store
