! SPDX-License-Identifier: MIT
!> Roots of the characteristic polynomial of an AR model: stationarity, resonance, memory.
module gyroakf_ar_roots
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_lapack, only : dgebal, dhseqr
   implicit none (type, external)
   private
   public :: ar_root_type, find_ar_roots, largest_modulus

   !> One root z of $$z^p - \phi_1 z^{p-1} - \dots - \phi_p = 0;$$ of a stationary model all lie
   !> within the unit circle
   type :: ar_root_type
      !> z
      real(dp) :: real_part = 0.0_dp, imaginary_part = 0.0_dp
      !> |z|
      real(dp) :: modulus = 0.0_dp
      !> |arg z|/(2 pi), cycles a sample, 0 .. 0.5; a real negative root alternates, 0.5
      real(dp) :: frequency = 0.0_dp
      !> -1/ln |z|, samples: the envelope falls to 1/e within it; negative outside the unit circle,
      !> where it grows, infinite on the circle: `huge`
      real(dp) :: time_constant = 0.0_dp
      !> -ln |z|/|ln z|: 1 for a positive real root, near 0 for a line; negative where it grows
      real(dp) :: damping = 1.0_dp
   end type ar_root_type

   real(dp), parameter :: two_pi = 6.283185307179586476925286766559_dp

contains

   !> Finds the roots as the eigenvalues of the balanced companion matrix.
   !>
   !> Each is exact for coefficients that differ from `phi` by rounding errors of its largest; one
   !> that p others nearly share is uncertain by the p-th root. Source: Golub & Van Loan, Matrix
   !> Computations (2013), 7.4.6.
   subroutine find_ar_roots(phi, root, error)
      !> Coefficients: [p], p >= 0, finite
      real(dp), intent(in) :: phi(:)
      !> The roots, largest modulus first, in a pair the positive imaginary part first: [p]
      type(ar_root_type), allocatable, intent(out) :: root(:)
      !> non_finite, no_memory, singular (the iteration for the eigenvalues failed)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: h(:, :), scale(:), re(:), im(:), work(:)
      real(dp) :: unused(1, 1)
      integer :: i, p, low, high, info, stat

      p = size(phi)
      if (.not. all(ieee_is_finite(phi))) call fatal_error(error, status%non_finite, &
         & "an AR coefficient is not finite")
      if (allocated(error)) return
      allocate (h(p, p), stat=stat)
      if (stat == 0) allocate (root(p), stat=stat)
      call check_memory(stat, "the roots of the AR model", error)
      if (allocated(error)) return
      if (p == 0) return
      allocate (scale(p), re(p), im(p), work(11*p))
      h = 0.0_dp
      h(1, :) = phi
      do i = 2, p
         h(i, i - 1) = 1.0_dp
      end do
      call dgebal("S", p, h, p, low, high, scale, info)
      call dhseqr("E", "N", p, 1, p, h, p, re, im, unused, 1, work, size(work), info)
      if (info /= 0) call fatal_error(error, status%singular, &
         & "the roots of the AR model were not found")
      if (allocated(error)) return
      call sort(re, im)
      root = root_of(re, im)
   end subroutine find_ar_roots

   !> Descending modulus; of equal ones (a pair) the positive imaginary part first.
   pure subroutine sort(re, im)
      real(dp), intent(inout) :: re(:), im(:)
      real(dp) :: a, b
      integer :: i, j

      do i = 2, size(re)
         a = re(i)
         b = im(i)
         do j = i - 1, 1, -1
            if (hypot(re(j), im(j)) > hypot(a, b)) exit
            if (hypot(re(j), im(j)) >= hypot(a, b) .and. im(j) >= b) exit
            re(j + 1) = re(j)
            im(j + 1) = im(j)
         end do
         re(j + 1) = a
         im(j + 1) = b
      end do
   end subroutine sort

   !> A root and what it means.
   elemental type(ar_root_type) function root_of(re, im) result(root)
      real(dp), intent(in) :: re, im
      real(dp) :: growth, angle

      root%real_part = re
      root%imaginary_part = im
      root%modulus = hypot(re, im)
      if (.not. root%modulus > 0.0_dp) return
      angle = abs(atan2(im, re))
      growth = log(root%modulus)
      root%frequency = angle/two_pi
      root%time_constant = huge(growth)
      if (abs(growth) > tiny(growth)) root%time_constant = -1.0_dp/growth
      if (hypot(growth, angle) > 0.0_dp) root%damping = -growth/hypot(growth, angle)
   end function root_of

   !> The largest modulus, 0 without a root: the model is stationary where it is below 1.
   pure real(dp) function largest_modulus(root)
      !> Of [[find_ar_roots]]
      type(ar_root_type), intent(in) :: root(:)

      largest_modulus = 0.0_dp
      if (size(root) > 0) largest_modulus = root(1)%modulus
   end function largest_modulus

end module gyroakf_ar_roots
