! SPDX-License-Identifier: MIT
!> How much memory this process can have.
module gyroakf_io_machine_memory
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: free_memory, least_limit, memory_of

   !> A limit from here on is none
   real(dp), parameter :: no_limit = 1.0e18_dp

contains

   !> Bytes that can be had without taking them from somebody: the least of what the machine has available and of the
   !> limits of the container, of its control groups and of the shell. 0 where nobody says (not on Linux).
   !>
   !> Limits are taken whole: what other processes of the container use is not subtracted, for much of it is cache that gives way.
   integer(int64) function free_memory() result(bytes)
      real(dp) :: least

      least = no_limit
      call lower(least, memory_of("/proc/meminfo", "MemAvailable:"))
      call lower(least, address_space())
      call lower(least, group_limit())
      bytes = 0
      if (least < no_limit) bytes = int(least, int64)
   end function free_memory

   !> Takes a limit in; what is negative is unknown.
   pure subroutine lower(least, limit)
      real(dp), intent(inout) :: least
      real(dp), intent(in) :: limit

      if (limit >= 0.0_dp) least = min(least, limit)
   end subroutine lower

   !> Bytes that a line `key NUMBER kB` of a file tells, -1 where there is none.
   real(dp) function memory_of(path, key) result(bytes)
      !> Of the form of /proc/meminfo
      character(*), intent(in) :: path
      !> With its colon
      character(*), intent(in) :: key
      character(256) :: line
      integer :: unit, failed

      bytes = -1.0_dp
      open (newunit=unit, file=path, status="old", action="read", iostat=failed)
      if (failed /= 0) return
      do
         read (unit, "(a)", iostat=failed) line
         if (failed /= 0) exit
         if (index(line, key) /= 1) cycle
         bytes = number_in(line(len(key) + 1:))
         if (bytes >= 0.0_dp) bytes = 1024.0_dp*bytes
         exit
      end do
      close (unit)
   end function memory_of

   !> What `ulimit -v` leaves of the address space, -1 where it is unlimited.
   real(dp) function address_space() result(bytes)
      real(dp) :: used
      character(256) :: line
      character(*), parameter :: key = "Max address space"
      integer :: unit, failed

      bytes = -1.0_dp
      open (newunit=unit, file="/proc/self/limits", status="old", action="read", iostat=failed)
      if (failed /= 0) return
      do
         read (unit, "(a)", iostat=failed) line
         if (failed /= 0) exit
         if (index(line, key) /= 1) cycle
         bytes = number_in(line(len(key) + 1:))
         exit
      end do
      close (unit)
      if (bytes < 0.0_dp) return
      used = memory_of("/proc/self/status", "VmSize:")
      bytes = max(0.0_dp, bytes - max(0.0_dp, used))
   end function address_space

   !> The least limit of the control groups of this process, of both versions, -1 where there is none.
   real(dp) function group_limit() result(bytes)
      real(dp) :: least
      character(1024) :: line
      integer :: unit, failed, colon

      least = no_limit
      call lower(least, least_limit("/sys/fs/cgroup", "/", "memory.max"))
      call lower(least, least_limit("/sys/fs/cgroup/memory", "/", "memory.limit_in_bytes"))
      open (newunit=unit, file="/proc/self/cgroup", status="old", action="read", iostat=failed)
      if (failed == 0) then
         do
            read (unit, "(a)", iostat=failed) line
            if (failed /= 0) exit
            colon = index(line, ":", back=.true.)
            if (line(:3) == "0::") call lower(least, least_limit("/sys/fs/cgroup", trim(line(4:)), "memory.max"))
            if (index(line(:colon), ":memory:") > 0) then
               call lower(least, least_limit("/sys/fs/cgroup/memory", trim(line(colon + 1:)), "memory.limit_in_bytes"))
            end if
         end do
         close (unit)
      end if
      bytes = -1.0_dp
      if (least < no_limit) bytes = least
   end function group_limit

   !> The least number that the files of a name hold in a directory below a root and in those above it, -1 where none does.
   real(dp) function least_limit(root, directory, name) result(bytes)
      !> Not ending with a slash
      character(*), intent(in) :: root
      !> Beginning with a slash
      character(*), intent(in) :: directory
      !> Of the files
      character(*), intent(in) :: name
      real(dp) :: least, limit
      integer :: last

      least = no_limit
      last = len(directory)
      do while (last > 0)
         if (directory(last:last) == "/") last = last - 1
         limit = first_number(root//directory(:last)//"/"//name)
         call lower(least, limit)
         last = index(directory(:last), "/", back=.true.)
      end do
      bytes = -1.0_dp
      if (least < no_limit) bytes = least
   end function least_limit

   !> The number that a file begins with, -1 where there is none.
   real(dp) function first_number(path) result(value)
      character(*), intent(in) :: path
      character(64) :: line
      integer :: unit, failed

      value = -1.0_dp
      open (newunit=unit, file=path, status="old", action="read", iostat=failed)
      if (failed /= 0) return
      read (unit, "(a)", iostat=failed) line
      if (failed == 0) value = number_in(line)
      close (unit)
   end function first_number

   !> The number that a text begins with, -1 where it begins with something else ("max", "unlimited").
   pure real(dp) function number_in(text) result(value)
      character(*), intent(in) :: text
      integer :: first, last, failed

      value = -1.0_dp
      first = verify(text, " "//achar(9))
      if (first == 0) return
      last = verify(text(first:), "0123456789")
      last = merge(len(text), first + last - 2, last == 0)
      if (last < first) return
      read (text(first:last), *, iostat=failed) value
      if (failed /= 0) value = -1.0_dp
   end function number_in

end module gyroakf_io_machine_memory
