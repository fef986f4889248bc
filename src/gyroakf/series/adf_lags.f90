! SPDX-License-Identifier: MIT
!> Lags of the Dickey-Fuller test: how many are tried, and which is chosen.
module gyroakf_series_adf_lags
   use gyroakf_kinds, only : dp, int8, int64
   implicit none (type, external)
   private
   public :: default_max_lags, pick_lag

   real(dp), parameter :: pi = acos(-1.0_dp)
   !> Two-sided 10 % point of the normal distribution
   real(dp), parameter :: significant_t = 1.6448536269514722_dp

contains

   !> Most lags that are tried: as many as are asked for, or ceiling(12 (n/100)^(1/4)) (Schwert); at
   !> most n/2 - terms - 1, no more than leave more complete rows than there are regressors, and
   !> with gaps a tenth of the samples in complete rows.
   subroutine default_max_lags(n, terms, asked, most, wanted, valid)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Deterministic terms, 0 .. 3
      integer, intent(in) :: terms
      !> Asked for; -1: the rule
      integer, intent(in) :: asked
      !> Tried, and what it would be if the series were long enough
      integer, intent(out) :: most, wanted
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: found, i, run
      integer(int64), allocatable :: rows(:)

      wanted = asked
      if (asked < 0) wanted = ceiling(12.0_dp*(real(n, dp)/100.0_dp)**0.25_dp)
      most = max(0, int(min(int(wanted, int64), n/2 - terms - 1, (n - terms - 3)/2)))
      if (.not. present(valid)) return
      allocate (rows(0:most + 2))
      rows = 0
      run = 0
      do i = 1, n
         run = run + 1
         if (valid(i) == 0_int8) run = 0
         rows(min(run, int(most + 2, int64))) = rows(min(run, int(most + 2, int64))) + 1
      end do
      found = n - rows(0)
      run = rows(most + 2)
      do while (most > 0)
         if (10*run >= found .and. run > most + terms + 1) exit
         most = most - 1
         run = run + rows(most + 2)
      end do
   end subroutine default_max_lags

   !> The lag by a criterion: RSS of the first i regressors is the sum of l_j^2, j > i, of column l.
   pure subroutine pick_lag(r, terms, lags, rows, criterion, scale, lag, best)
      !> Factor of powers of the time, level, lags, difference, in its upper triangle
      real(dp), intent(in) :: r(:, :)
      !> Deterministic terms, lags
      integer, intent(in) :: terms, lags
      !> Rows of the regression
      integer(int64), intent(in) :: rows
      !> aic, bic, t
      character(*), intent(in) :: criterion
      !> Length of the difference, which has been divided by it
      real(dp), intent(in) :: scale
      !> The lag
      integer, intent(out) :: lag
      !> AIC or BIC there; |t| of the lag, at lag 0 of the level
      real(dp), intent(out) :: best
      real(dp) :: rss, value, n, penalty
      integer :: k, base, last

      lag = 0
      base = terms + 1
      last = size(r, 1)
      n = real(rows, dp)
      penalty = merge(log(n), 2.0_dp, criterion == "bic")
      best = huge(best)
      rss = r(last, last)**2
      do k = lags, 0, -1
         if (criterion == "t") then
            lag = k
            best = abs(r(base + k, last))/sqrt(rss/(n - real(base + k, dp)))
            if (best >= significant_t) return
         else
            value = n*(log(2.0_dp*pi) + log(rss/n) + 2.0_dp*log(scale) + 1.0_dp) &
               & + penalty*real(base + k, dp)
            if (value <= best) then
               best = value
               lag = k
            end if
         end if
         rss = rss + r(base + k, last)**2
      end do
   end subroutine pick_lag

end module gyroakf_series_adf_lags
