! SPDX-License-Identifier: MIT
!> Are the samples of a converter normal? Tests, sizes of the effect, and the step.
program example_normality
   use gyroakf, only : dp, error_type, record_type, simulate_options, simulate_record, moments_type, compute_moments, &
      jarque_bera_type, test_jarque_bera, anderson_darling_options, anderson_darling_type, test_anderson_darling, judge_normality, &
      quantization_type, find_quantization
   implicit none (type, external)
   call show
contains
   subroutine show()
      type(error_type), allocatable :: error
      type(simulate_options) :: options
      type(record_type) :: record
      type(moments_type) :: moments
      type(jarque_bera_type) :: jb
      type(anderson_darling_type) :: ad
      type(quantization_type) :: grid

      options%samples = 20000
      options%coefficient(2) = 0.02_dp
      options%lsb = 0.02_dp
      call simulate_record(options, record, error)
      if (allocated(error)) error stop error%message
      associate (x => record%value(:, 1))
         call compute_moments(x, moments)
         call test_jarque_bera(moments, jb, error)
         if (.not. allocated(error)) call test_anderson_darling(x, anderson_darling_options(), ad, error)
         if (.not. allocated(error)) call find_quantization(x, moments%std, grid, error)
      end associate
      if (allocated(error)) error stop error%message
      print "(a, f0.2, 2a)", "Jarque-Bera ", jb%statistic, ": ", &
         trim(judge_normality(moments%skewness, moments%kurtosis, jb%p_value))
      print "(a, f0.2)", "Anderson-Darling ", ad%modified
      print "(a, f0.3, a, i0, a)", "step ", grid%step, " on ", grid%levels, " levels"
   end subroutine show
end program example_normality
