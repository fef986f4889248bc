! SPDX-License-Identifier: MIT
!> What a command line asks for: one type for every kind of command, filled by [[gyroakf_app_cli]].
module gyroakf_app_config
   implicit none (type, external)
   private
   public :: cli_config, text_config

   !> Common to all commands
   type, abstract :: cli_config
      !> Name of the command
      character(:), allocatable :: command
      !> Number of threads, 0: as many as there are
      integer :: threads = 0
      !> No report on standard output
      logical :: quiet = .false.
   end type cli_config

   !> `--help`, `--version`, `--citation`
   type, extends(cli_config) :: text_config
      !> What is printed
      character(:), allocatable :: text
   end type text_config

end module gyroakf_app_config
