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

      bytes = number_behind(path, key)
      if (bytes >= 0.0_dp) bytes = 1024.0_dp*bytes
   end function memory_of

   !> The number behind a word that begins a line of a file, -1 where there is none ("max", "unlimited").
   real(dp) function number_behind(path, word) result(value)
      character(*), intent(in) :: path, word
      character(1024) :: line
      integer :: unit, failed

      value = -1.0_dp
      open (newunit=unit, file=path, status="old", action="read", iostat=failed)
      if (failed /= 0) return
      do
         read (unit, "(a)", iostat=failed) line
         if (failed /= 0) exit
         if (index(line, word) /= 1) cycle
         read (line(len(word) + 1:), *, iostat=failed) value
         if (failed /= 0) value = -1.0_dp
         exit
      end do
      close (unit)
   end function number_behind

   !> What `ulimit -v` leaves of the address space, -1 where it is unlimited.
   real(dp) function address_space() result(bytes)

      bytes = number_behind("/proc/self/limits", "Max address space")
      if (bytes >= 0.0_dp) bytes = max(0.0_dp, bytes - max(0.0_dp, memory_of("/proc/self/status", "VmSize:")))
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
      real(dp) :: least
      integer :: last

      least = no_limit
      last = len(directory)
      do while (last > 0)
         if (directory(last:last) == "/") last = last - 1
         call lower(least, number_behind(root//directory(:last)//"/"//name, ""))
         last = index(directory(:last), "/", back=.true.)
      end do
      bytes = -1.0_dp
      if (least < no_limit) bytes = least
   end function least_limit

end module gyroakf_io_machine_memory
