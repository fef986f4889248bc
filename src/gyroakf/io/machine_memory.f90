! SPDX-License-Identifier: MIT
!> How much memory this process can have.
module gyroakf_io_machine_memory
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: free_memory, least_limit, memory_of, no_limit

   !> Bytes; a limit from here on is none
   real(dp), parameter :: no_limit = 1.0e18_dp
   !> Of a file; gfortran's library reads empty lines for ever where a file turns unreadable
   integer, parameter :: most_lines = 1000

contains

   !> Bytes that can be had without taking them from another process: the least of what the machine
   !> has available and of the limits of the container, of its control groups and of the shell; 0
   !> where none is known (not on Linux).
   !>
   !> Limits are taken whole: much of what other processes use is cache that gives way.
   integer(int64) function free_memory() result(bytes)
      real(dp) :: least, space, used

      space = number_behind("/proc/self/limits", "Max address space")                ! ulimit -v
      used = memory_of("/proc/self/status", "VmSize:")
      if (space < no_limit .and. used < no_limit) space = max(0.0_dp, space - used)
      least = min(memory_of("/proc/meminfo", "MemAvailable:"), space, group_limit())
      bytes = 0
      if (least < no_limit) bytes = int(least, int64)
   end function free_memory

   !> Bytes from the line `key NUMBER kB` of a file; [[no_limit]] where there is no such line.
   real(dp) function memory_of(path, key) result(bytes)
      !> Of the form of /proc/meminfo
      character(*), intent(in) :: path
      character(*), intent(in) :: key

      bytes = 1024.0_dp*number_behind(path, key)
   end function memory_of

   !> The number behind a word in a file; no limit where there is none ("max", "unlimited").
   real(dp) function number_behind(path, word) result(value)
      character(*), intent(in) :: path, word
      character(1024) :: text
      integer :: failed

      text = text_behind(path, word)
      read (text, *, iostat=failed) value
      if (failed /= 0) value = no_limit
   end function number_behind

   !> What stands behind a word in the first line of a file that holds it; blank where none does.
   character(1024) function text_behind(path, word) result(text)
      character(*), intent(in) :: path, word
      integer :: unit, failed, i

      text = ""
      open (newunit=unit, file=path, status="old", action="read", iostat=failed)
      if (failed /= 0) return
      do i = 1, most_lines
         read (unit, "(a)", iostat=failed) text
         if (failed /= 0 .or. index(text, word) > 0) exit
      end do
      close (unit)
      text = text(index(text, word) + len(word):)
      if (failed /= 0 .or. i > most_lines) text = ""
   end function text_behind

   !> The least limit of the control groups of this process, of both versions.
   real(dp) function group_limit() result(bytes)
      character(*), parameter :: mine = "/proc/self/cgroup", root = "/sys/fs/cgroup"

      bytes = min(least_limit(root, "/", "memory.max"), least_limit(root//"/memory", "/", &
         "memory.limit_in_bytes"), least_limit(root, trim(text_behind(mine, "0::")), &
         "memory.max"), least_limit(root//"/memory", trim(text_behind(mine, ":memory:")), &
         "memory.limit_in_bytes"))
   end function group_limit

   !> The least number in the files of a name in a directory and those above it, up to a root.
   real(dp) function least_limit(root, directory, name) result(bytes)
      character(*), intent(in) :: root, directory, name
      integer :: last

      bytes = no_limit
      last = len(directory)
      do while (last > 0)
         if (directory(last:last) == "/") last = last - 1
         bytes = min(bytes, number_behind(root//directory(:last)//"/"//name, ""))
         last = index(directory(:last), "/", back=.true.)
      end do
   end function least_limit

end module gyroakf_io_machine_memory
