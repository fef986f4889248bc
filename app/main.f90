! SPDX-License-Identifier: MIT
!> The program `gyroakf`. Everything is done in [[gyroakf_app_driver]]; this alone ends the program.
program gyroakf_main
   use gyroakf_app_driver, only : run_program
   implicit none (type, external)
   integer :: code

   call run_program(code)
   stop code, quiet=.true.
end program gyroakf_main
