! SPDX-License-Identifier: MIT
!> Explicit interfaces of the LAPACK and BLAS routines that the library calls; no code.
!>
!> Any implementation serves (reference, OpenBLAS, MKL): link with `-llapack -lblas`.
!> Source of the interfaces: LAPACK Users' Guide, 3rd edition (SIAM, 1999). Integers are of
!> the default kind, as in every LP64 build; callers check a size before they narrow it.
module gyroakf_lapack
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: dgemm, dpotrf, dpotrs, dpotri, dgels, dtrtrs, dsyev, dgesv, dgebal, dhseqr, dgeqrf

   abstract interface
      !> Works on a triangle of a symmetric matrix in place
      subroutine triangle_call(uplo, n, a, lda, info)
         import :: dp
         implicit none (type, external)
         character(1), intent(in) :: uplo
         integer, intent(in) :: n, lda
         real(dp), intent(inout) :: a(lda, *)
         integer, intent(out) :: info
      end subroutine triangle_call
   end interface

   interface

      !> C = alpha op(A) op(B) + beta C
      subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
         import :: dp
         implicit none (type, external)
         character(1), intent(in) :: transa, transb
         integer, intent(in) :: m, n, k, lda, ldb, ldc
         real(dp), intent(in) :: alpha, beta, a(lda, *), b(ldb, *)
         real(dp), intent(inout) :: c(ldc, *)
      end subroutine dgemm

      !> Solves A X = B with the factor of dpotrf
      subroutine dpotrs(uplo, n, nrhs, a, lda, b, ldb, info)
         import :: dp
         implicit none (type, external)
         character(1), intent(in) :: uplo
         integer, intent(in) :: n, nrhs, lda, ldb
         real(dp), intent(in) :: a(lda, *)
         real(dp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dpotrs

      !> Least squares by QR or LQ, A of full rank
      subroutine dgels(trans, m, n, nrhs, a, lda, b, ldb, work, lwork, info)
         import :: dp
         implicit none (type, external)
         character(1), intent(in) :: trans
         integer, intent(in) :: m, n, nrhs, lda, ldb, lwork
         real(dp), intent(inout) :: a(lda, *), b(ldb, *)
         real(dp), intent(out) :: work(*)
         integer, intent(out) :: info
      end subroutine dgels

      !> Solves a triangular system
      subroutine dtrtrs(uplo, trans, diag, n, nrhs, a, lda, b, ldb, info)
         import :: dp
         implicit none (type, external)
         character(1), intent(in) :: uplo, trans, diag
         integer, intent(in) :: n, nrhs, lda, ldb
         real(dp), intent(in) :: a(lda, *)
         real(dp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dtrtrs

      !> Eigenvalues and, where asked, eigenvectors of a symmetric matrix
      subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
         import :: dp
         implicit none (type, external)
         character(1), intent(in) :: jobz, uplo
         integer, intent(in) :: n, lda, lwork
         real(dp), intent(inout) :: a(lda, *)
         real(dp), intent(out) :: w(*), work(*)
         integer, intent(out) :: info
      end subroutine dsyev

      !> Solves A X = B by LU factors with partial pivoting
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: dp
         implicit none (type, external)
         integer, intent(in) :: n, nrhs, lda, ldb
         real(dp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv

      !> Balances a matrix
      subroutine dgebal(job, n, a, lda, ilo, ihi, scale, info)
         import :: dp
         implicit none (type, external)
         character(1), intent(in) :: job
         integer, intent(in) :: n, lda
         real(dp), intent(inout) :: a(lda, *)
         integer, intent(out) :: ilo, ihi, info
         real(dp), intent(out) :: scale(*)
      end subroutine dgebal

      !> Eigenvalues and, where asked, Schur form of an upper Hessenberg matrix
      subroutine dhseqr(job, compz, n, ilo, ihi, h, ldh, wr, wi, z, ldz, work, lwork, info)
         import :: dp
         implicit none (type, external)
         character(1), intent(in) :: job, compz
         integer, intent(in) :: n, ilo, ihi, ldh, ldz, lwork
         real(dp), intent(inout) :: h(ldh, *), z(ldz, *)
         real(dp), intent(out) :: wr(*), wi(*), work(*)
         integer, intent(out) :: info
      end subroutine dhseqr

      !> Orthogonal and triangular factor
      subroutine dgeqrf(m, n, a, lda, tau, work, lwork, info)
         import :: dp
         implicit none (type, external)
         integer, intent(in) :: m, n, lda, lwork
         real(dp), intent(inout) :: a(lda, *)
         real(dp), intent(out) :: tau(*), work(*)
         integer, intent(out) :: info
      end subroutine dgeqrf

   end interface

   !> Cholesky factor of a symmetric positive definite matrix
   procedure(triangle_call) :: dpotrf
   !> Inverse of a symmetric positive definite matrix from the factor of dpotrf
   procedure(triangle_call) :: dpotri

end module gyroakf_lapack
