! SPDX-License-Identifier: MIT
!> SHA-256 and the checksums of files.
module test_sha256
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_io_checksum, only : checksum_type, sum_file
   use gyroakf_kinds, only : int8, int64
   use gyroakf_sha256, only : sha256_type, add_bytes, finish_sha256
   use scratch_file, only : remove_file, scratch_path, write_bytes
   implicit none (type, external)
   private
   public :: collect_sha256

   !> FIPS 180-2, appendix B: the million of "a"
   character(64), parameter :: million = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"

contains

   !> Names the tests.
   subroutine collect_sha256(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("published", test_published), &
         new_unittest("lengths", test_lengths), &
         new_unittest("pieces", test_pieces), &
         new_unittest("file", test_file), &
         new_unittest("no-file", test_no_file)]
   end subroutine collect_sha256

   !> FIPS 180-2, appendix B; of nothing: NIST, CAVP, SHA256ShortMsg.
   subroutine test_published(error)
      type(error_type), allocatable, intent(out) :: error

      call check(error, digest_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855")
      if (allocated(error)) return
      call check(error, digest_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad")
      if (allocated(error)) return
      call check(error, digest_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"), &
                 "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1")
      if (allocated(error)) return
      call check(error, digest_of(repeat("a", 1000000)), million)
   end subroutine test_published

   !> Around the end of a block, where the length takes another one, and bytes above 127: what `sha256sum` says.
   subroutine test_lengths(error)
      type(error_type), allocatable, intent(out) :: error

      call check(error, digest_of(repeat("a", 55)), "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318")
      if (allocated(error)) return
      call check(error, digest_of(repeat("a", 56)), "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a")
      if (allocated(error)) return
      call check(error, digest_of(repeat("a", 63)), "7d3e74a05d7db15bce4ad9ec0658ea98e3f06eeecf16b4c6fff2da457ddc2f34")
      if (allocated(error)) return
      call check(error, digest_of(repeat("a", 64)), "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb")
      if (allocated(error)) return
      call check(error, digest_of(repeat(char(255), 119)), "b863f94597d433ef2280e3b4656f13ea265a79bb8047287321c218905b03c99b")
   end subroutine test_lengths

   !> The same bytes in pieces of any length.
   subroutine test_pieces(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: n = 700
      integer(int8) :: bytes(n)
      type(sha256_type) :: hash
      character(64) :: whole, digest
      integer :: i, piece, at

      do i = 1, n
         bytes(i) = int(mod(37*i + i/7, 256) - 128, int8)
      end do
      call add_bytes(hash, bytes)
      call finish_sha256(hash, whole)
      do piece = 1, 130
         hash = sha256_type()
         do at = 0, n - 1, piece
            call add_bytes(hash, bytes(at + 1:min(n, at + piece)))
            call add_bytes(hash, bytes(:0))
         end do
         call finish_sha256(hash, digest)
         call check(error, digest, whole)
         if (allocated(error)) return
      end do
   end subroutine test_pieces

   !> A file longer than what is read at a time.
   subroutine test_file(error)
      type(error_type), allocatable, intent(out) :: error
      type(checksum_type) :: checksum
      type(gyro_error), allocatable :: problem
      character(:), allocatable :: path

      path = scratch_path("sum.bin")
      call write_bytes(path, repeat("a", 1000000))
      call sum_file(path, checksum, problem)
      call check(error, .not. allocated(problem) .and. checksum%known)
      if (.not. allocated(error)) call check(error, checksum%bytes == 1000000_int64)
      if (.not. allocated(error)) call check(error, checksum%sha256, million)
      call remove_file(path)
   end subroutine test_file

   !> What is not there or can be read only once has no checksum, and is no error.
   subroutine test_no_file(error)
      type(error_type), allocatable, intent(out) :: error
      type(checksum_type) :: checksum
      type(gyro_error), allocatable :: problem

      call sum_file("-", checksum, problem)
      call check(error, .not. (allocated(problem) .or. checksum%known))
      if (allocated(error)) return
      call sum_file("no/such/file", checksum, problem)
      call check(error, .not. (allocated(problem) .or. checksum%known))
      if (allocated(error)) return
      call sum_file(".", checksum, problem)
      call check(error, .not. (allocated(problem) .or. checksum%known))
   end subroutine test_no_file

   !> The digest of a text.
   function digest_of(text) result(digest)
      character(*), intent(in) :: text
      character(64) :: digest
      type(sha256_type) :: hash
      integer(int8), allocatable :: bytes(:)

      allocate (bytes(len(text)))
      bytes = transfer(text, bytes, len(text))
      call add_bytes(hash, bytes)
      call finish_sha256(hash, digest)
   end function digest_of

end module test_sha256
