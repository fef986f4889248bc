! SPDX-License-Identifier: MIT
!> Kinds of every number in the library: `dp` for reals, `int64` for counts and sample indices.
module gyroakf_kinds
   use, intrinsic :: iso_fortran_env, only : dp => real64, int8, int16, int32, int64
   implicit none (type, external)
   private
   public :: dp, int8, int16, int32, int64
end module gyroakf_kinds
