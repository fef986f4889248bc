C     SPDX-License-Identifier: MIT
C
C     A dead-reckoning mechanization of one axis, in FORTRAN 77: heading
C     from a rate gyroscope, position from heading and speed. The drift
C     of the gyroscope is estimated at rest only. In motion the filter
C     gets no measurement and predicts, so that no true rotation enters
C     the drift estimate:
C
C        compensated rate = rate - bias - drift
C
C     Do not subtract the output of a noise filter instead. The filters
C     of the paper (AR(p) Kalman filter with R = variance of the record,
C     Sage-Husa) have a DC gain of about 0.6, and up to 1 where R is
C     adapted. Used as the rate, the output attenuates a constant
C     rotation; subtracted from the rate, it removes the rotation.
C
C     Rest is detected from the gyroscope alone: the vehicle moves where
C     the mean of the last NW rates differs from bias + drift by more
C     than 4 N/sqrt(NW DT). The filter gets the rate that leaves the
C     window, and only after NW quiet epochs: no rate at the beginning
C     or end of a turn is used.
C
C     Limits: a rotation slower than the threshold cannot be told from
C     drift by the gyroscope alone, and up to three times the threshold
C     parts of a turn may be missed. A drift above the threshold is
C     taken for motion, and the filter stays frozen. A vehicle has better signals of rest: odometer,
C     wheel speed, parking brake, a zero-velocity detector on the
C     accelerometers. Where there is one, set MOVING from it.
C
C     Usage:  nav RECORDING        (deg/s at 5 Hz, # begins a comment)
C
C     The first NREST samples are at rest. For a test, a line may have a
C     second number: a known true rate that is part of the first. It is
C     not used for navigation; at the end nav prints how much of each
C     known turn survives in the compensated heading.
C
      PROGRAM NAV
      INTEGER NREST, NW, LWORK, MAXT
      PARAMETER (NREST=2000, NW=1000, LWORK=46, MAXT=20)
      DOUBLE PRECISION DT, SPEED, RADDEG, TC, NONE
      PARAMETER (DT=0.2D0, SPEED=10.0D0, TC=3600.0D0)
      PARAMETER (RADDEG=3.14159265358979324D0/180.0D0)
C     No measurement: NaN, or any number beyond 1D149
      PARAMETER (NONE=1.0D300)
      DOUBLE PRECISION REST(NREST), COEF(5), SE(5), UPPER(5), CHI2
      DOUBLE PRECISION WORK(LWORK), WTURN(LWORK)
      DOUBLE PRECISION WIN(NW), TRN(NW), TOTAL, OLD, OLDTRN, LIMIT
      DOUBLE PRECISION BIAS, P, PHI(1), Q, R, RATE, TURN, DRIFT
      DOUBLE PRECISION HRAW, HCOMP, EAST, ENORTH
      DOUBLE PRECISION LAST, LEAK, ANGLE(MAXT), KEPT(MAXT)
      INTEGER IDET(5), IADAPT(4), INFO, I, J, K, IOS, NQUIET, NT
      LOGICAL MOVING
      CHARACTER*256 FNAME
      CHARACTER*6 STATUS
      DATA IADAPT /4*0/, WIN /NW*0.0D0/, TRN /NW*0.0D0/
C
      CALL GETARG(1, FNAME)
      OPEN (UNIT=7, FILE=FNAME, STATUS='OLD', IOSTAT=IOS)
      IF (IOS .NE. 0) STOP 'nav: the recording cannot be opened'
C
C     At rest: the bias, and the angle random walk N = COEF(2)
C
      BIAS = 0.0D0
      DO 10 I = 1, NREST
         CALL NEXT(7, REST(I), TURN, IOS)
         IF (IOS .NE. 0) STOP 'nav: the recording is too short'
         BIAS = BIAS + REST(I)/NREST
   10 CONTINUE
      CALL GYNFIT(NREST, REST, DT, COEF, SE, UPPER, IDET, CHI2, INFO)
      IF (INFO .NE. 0 .OR. IDET(2) .NE. 1) STOP 'nav: N not detected'
      LIMIT = 4.0D0*COEF(2)/SQRT(NW*DT)
C
C     Drift: a Gauss-Markov process whose variance P is that of the
C     bias, N**2/(NREST*DT), with the correlation time TC; R is the
C     variance of white noise N. In steady state the filter averages
C     over sqrt(NREST*DT*TC/2) = 850 s, more than the rest record: a
C     shorter averaging time would add more noise than the bias has. A
C     sensor that drifts faster needs its own P and TC, from a record
C     of hours.
C
      P = COEF(2)**2/(NREST*DT)
      R = COEF(2)**2/DT
      PHI(1) = EXP(-DT/TC)
      Q = P*(1.0D0 - PHI(1)**2)
      CALL GYFINI(1, PHI, Q, R, IADAPT, 1.0D0, WORK, LWORK, INFO)
      IF (INFO .NE. 0) STOP 'nav: no filter'
C     Test only: the same filter for the known turn alone
      CALL GYFINI(1, PHI, Q, R, IADAPT, 1.0D0, WTURN, LWORK, INFO)
      WRITE (*,'(A,F7.4,A,F9.6,A,F7.4,A)') ' N', COEF(2),
     &   ' deg/sqrt(s), bias', BIAS, ' deg/s, moving above', LIMIT,
     &   ' deg/s'
      WRITE (*,'(A)') '   epoch  status  raw heading  compensated' //
     &   '        east       north'
C
C     Under way: one call of the filter an epoch
C
      TOTAL = 0.0D0
      NQUIET = 0
      DRIFT = 0.0D0
      HRAW = 0.0D0
      HCOMP = 0.0D0
      EAST = 0.0D0
      ENORTH = 0.0D0
      NT = 0
      LAST = 0.0D0
      DO 30 K = 1, 100000000
         CALL NEXT(7, RATE, TURN, IOS)
         IF (IOS .NE. 0) GO TO 40
C        Rest or motion: the newest rate enters the window at J, where
C        the oldest leaves it
         J = MOD(K - 1, NW) + 1
         OLD = WIN(J)
         WIN(J) = RATE - BIAS
         TOTAL = TOTAL + WIN(J) - OLD
         NQUIET = NQUIET + 1
         IF (.NOT. ABS(TOTAL/NW - DRIFT) .LE. LIMIT) NQUIET = 0
         MOVING = NQUIET .LT. NW
C        Drift: in motion it is predicted, without adaptation (should
C        IADAPT ask for any) and without measurement
         IF (MOVING) THEN
            STATUS = 'moving'
            CALL GYFFRZ(WORK, 1, INFO)
            CALL GYFSTP(WORK, NONE, DRIFT, INFO)
         ELSE
            STATUS = 'rest'
            CALL GYFFRZ(WORK, 0, INFO)
            CALL GYFSTP(WORK, OLD, DRIFT, INFO)
         END IF
         IF (INFO .NE. 0) STOP 'nav: the work array was overwritten'
         HRAW = HRAW + RATE*DT
         HCOMP = HCOMP + (RATE - BIAS - DRIFT)*DT
         EAST = EAST + SPEED*DT*SIN(HCOMP*RADDEG)
         ENORTH = ENORTH + SPEED*DT*COS(HCOMP*RADDEG)
         IF (MOD(K, 1000) .EQ. 0) WRITE (*,'(I8,2X,A6,2F13.4,2F12.2)')
     &      K, STATUS, HRAW, HCOMP, EAST, ENORTH
C        Test only: the filter is linear. Given the known turn alone at
C        the same epochs, it shows what of the turn is taken for drift
C        (LEAK).
         OLDTRN = TRN(J)
         TRN(J) = TURN
         IF (MOVING) OLDTRN = NONE
         CALL GYFSTP(WTURN, OLDTRN, LEAK, INFO)
         IF (TURN .NE. 0.0D0 .AND. LAST .EQ. 0.0D0 .AND. NT .LT. MAXT)
     &   THEN
            NT = NT + 1
            ANGLE(NT) = 0.0D0
            KEPT(NT) = 0.0D0
         END IF
         LAST = TURN
         IF (NT .GT. 0) THEN
            ANGLE(NT) = ANGLE(NT) + TURN*DT
            KEPT(NT) = KEPT(NT) + (TURN - LEAK)*DT
         END IF
   30 CONTINUE
   40 IF (IOS .GT. 0) STOP 'nav: a line is not a number'
      DO 50 I = 1, NT
         WRITE (*,'(A,F8.2,A,F8.2,A,F7.2,A)') ' true turn', ANGLE(I),
     &      ' deg: survives', KEPT(I), ' deg,', 100*KEPT(I)/ANGLE(I),
     &      ' %'
   50 CONTINUE
      END
C
C     The next rate of a file, and the known true rate beside it, else
C     0; lines that begin with # are skipped
C
      SUBROUTINE NEXT(IUNIT, RATE, TURN, IOS)
      INTEGER IUNIT, IOS
      DOUBLE PRECISION RATE, TURN
      CHARACTER*80 LINE
   10 READ (IUNIT, '(A)', IOSTAT=IOS) LINE
      IF (IOS .NE. 0) RETURN
      IF (LINE(1:1) .EQ. '#') GO TO 10
      READ (LINE, *, IOSTAT=IOS) RATE, TURN
      IF (IOS .EQ. 0) RETURN
      TURN = 0.0D0
      READ (LINE, *, IOSTAT=IOS) RATE
      IF (IOS .LT. 0) IOS = 1
      END
