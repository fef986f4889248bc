C     SPDX-License-Identifier: MIT
C
C     A dead-reckoning mechanisation of one axis, in FORTRAN 77: heading
C     from a rate gyroscope, position from heading and speed. At rest
C     (the first NREST epochs) it finds the noise model; from there on
C     the filter is called once an epoch and its estimate of the
C     correlated error is taken out of the rate.
C
C     Usage:  nav RECORDING        (deg/s at 5 Hz, # begins a comment)
C
      PROGRAM NAV
      INTEGER NREST, MAXP, LWORK
      PARAMETER (NREST=2000, MAXP=3, LWORK=40+5*MAXP+MAXP*MAXP)
      DOUBLE PRECISION DT, SPEED, RADDEG
      PARAMETER (DT=0.2D0, SPEED=10.0D0)
      PARAMETER (RADDEG=3.14159265358979324D0/180.0D0)
      DOUBLE PRECISION REST(NREST), PHI(MAXP), WORK(LWORK), STATE(9)
      DOUBLE PRECISION VAR, BIAS, R, RATE, DRIFT, HRAW, HFIL
      DOUBLE PRECISION EAST, ENORTH
      INTEGER IADAPT(4), IP, INFO, I, K, IOS
      CHARACTER*256 FNAME
      DATA IADAPT /0, 0, 0, 1/
C
      CALL GETARG(1, FNAME)
      OPEN (UNIT=7, FILE=FNAME, STATUS='OLD', IOSTAT=IOS)
      IF (IOS .NE. 0) STOP 'nav: the recording cannot be opened'
C
C     At rest: mean, noise model, variance
C
      DO 10 I = 1, NREST
         CALL NEXT(7, REST(I), IOS)
         IF (IOS .NE. 0) STOP 'nav: the recording is too short'
   10 CONTINUE
      CALL GYARFT(NREST, REST, 1, MAXP, IP, PHI, VAR, BIAS, INFO)
      IF (INFO .NE. 0) STOP 'nav: no model'
      R = 0.0D0
      DO 20 I = 1, NREST
         R = R + (REST(I) - BIAS)**2/NREST
   20 CONTINUE
      CALL GYFINI(IP, PHI, VAR, R, IADAPT, 0.995D0, WORK, LWORK, INFO)
      IF (INFO .NE. 0) STOP 'nav: no filter'
      WRITE (*,'(A,I1,A,F8.4,A,F9.6)') ' AR(', IP, '): phi', PHI(1),
     &   ', bias', BIAS
      WRITE (*,'(A)') '   epoch  raw heading   compensated' //
     &   '        east       north'
C
C     Under way: one call of the filter an epoch
C
      HRAW = 0.0D0
      HFIL = 0.0D0
      EAST = 0.0D0
      ENORTH = 0.0D0
      DO 30 K = 1, 100000
         CALL NEXT(7, RATE, IOS)
         IF (IOS .NE. 0) GO TO 40
         CALL GYFSTP(WORK, RATE - BIAS, DRIFT, INFO)
         IF (INFO .NE. 0) STOP 'nav: the work array was overwritten'
         HRAW = HRAW + RATE*DT
         HFIL = HFIL + (RATE - BIAS - DRIFT)*DT
         EAST = EAST + SPEED*DT*SIN(HFIL*RADDEG)
         ENORTH = ENORTH + SPEED*DT*COS(HFIL*RADDEG)
         IF (MOD(K, 2000) .EQ. 0) WRITE (*,'(I8,2F13.4,2F12.2)')
     &      K, HRAW, HFIL, EAST, ENORTH
   30 CONTINUE
   40 CALL GYFGET(WORK, STATE, INFO)
      WRITE (*,'(A,F7.4,A,1PE10.3)') ' gain', STATE(3), ', R', STATE(9)
      END
C
C     The next number of a file; lines that begin with # are skipped
C
      SUBROUTINE NEXT(IUNIT, VALUE, IOS)
      INTEGER IUNIT, IOS
      DOUBLE PRECISION VALUE
      CHARACTER*80 LINE
   10 READ (IUNIT, '(A)', IOSTAT=IOS) LINE
      IF (IOS .NE. 0) RETURN
      IF (LINE(1:1) .EQ. '#') GO TO 10
      READ (LINE, *, IOSTAT=IOS) VALUE
      END
