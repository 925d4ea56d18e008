/PROG  P_FATJ2X
/ATTR
COMMENT		= "zerorev drilling";
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
   1:  ! ------------------------------- ;
   2:  ! Written by zerorev golden ;
   3:  ! Plan position_1 ;
   4:  ! Robot FANUC LR Mate 200iD ;
   5:  !  (fanuc_lrmate200id) ;
   6:  ! Tool thesis_drill ;
   7:  ! Feeds plunge 5 mm/s, retract 20 ;
   8:  !  mm/s ;
   9:  ! Spindle 3000 rev/min ;
  10:  ! Blend joint moves from 1 mm or ;
  11:  !  less at the target ;
  12:  ! Holes 1, with 0 joint reversals ;
  13:  !  in all ;
  14:  ! info: hole position 1: the ;
  15:  !  blend of radius 0.5 mm turns ;
  16:  !  back 0.25 mm short (r/2, a ;
  17:  !  parabolic blend over half of ;
  18:  !  each joint move, how far the ;
  19:  !  controller blends is not in ;
  20:  !  the program): the hole comes ;
  21:  !  out 0.25 mm less deep, ;
  22:  !  deepen_corner places the ;
  23:  !  corner that much deeper ;
  24:  ! info: the twist changes the ;
  25:  !  speed of a right-hand drill by ;
  26:  !  +1.68 rev/min at most (0.06% ;
  27:  !  of 3000), in the retract of ;
  28:  !  hole position 1 ;
  29:  ! info: the moves of all axes ;
  30:  !  from hole to hole are checked ;
  31:  !  against the surface of the ;
  32:  !  part alone, not for fixtures, ;
  33:  !  the cell or the arm's own ;
  34:  !  links, the first one, from ;
  35:  !  wherever the robot is, is not ;
  36:  !  checked at all ;
  37:  ! ;
  38:  ! - Run the program in T1 first, ;
  39:  !  the spindle off and no part in ;
  40:  !  place. ;
  41:  ! - UTOOL 3 is selected, not set. ;
  42:  !  It must hold X 100.000, Y ;
  43:  !  0.000, Z 65.000, W 180.000, P ;
  44:  !  -90.000, R 0.000 (flange to ;
  45:  !  tip, Z along the plunge). ;
  46:  ! - UFRAME 0: points are given in ;
  47:  !  the world frame, which counts ;
  48:  !  Z from the height of axis 2. ;
  49:  ! - J3 is printed as the pendant ;
  50:  !  shows it: its angle against ;
  51:  !  the ground. ;
  52:  ! - Spindle, coolant and PAYLOAD ;
  53:  !  are not set here. The spindle ;
  54:  !  must run before the drill ;
  55:  !  enters. ;
  56:  ! - J moves at 20 % are checked ;
  57:  !  against the surface of the ;
  58:  !  part alone, and the first one ;
  59:  !  not at all: not for fixtures, ;
  60:  !  the cell or the arm's own ;
  61:  !  links. ;
  62:  ! - Start at line 1: the numbers ;
  63:  !  of the frames are set there. ;
  64:  ! - After a stop in a hole pull ;
  65:  !  the drill out along the drill ;
  66:  !  axis (tool Z) before a new ;
  67:  !  start: a J comes first. ;
  68:  ! - The last of the plunge and ;
  69:  !  the first of the retract are J ;
  70:  !  moves by time (msec), blended ;
  71:  !  with CNT100. How far CNT ;
  72:  !  reaches depends on speed, ;
  73:  !  acceleration and override and ;
  74:  !  is not known: 0 to 1 mm of ;
  75:  !  depth are lost there, at every ;
  76:  !  override. Measure at the ;
  77:  !  override with which you drill. ;
  78:  ! - Open, not tried on a ;
  79:  !  controller: CNT100 from L to J ;
  80:  !  and back, moves of a few ms, ;
  81:  !  the letters of CONFIG. If an L ;
  82:  !  stops with a position or ;
  83:  !  configuration alarm, stop ;
  84:  !  there. ;
  85:  ! ------------------------------- ;
  86:  UFRAME_NUM=0 ;
  87:  UTOOL_NUM=3 ;
  88:  ! Hole 1 of 1: position 1 ;
  89:  ! stroke 50.000 mm, lead-in 5.000 ;
  90:  ! mm, reversals of J1 to J6: 0 0 ;
  91:  ! 0 0 0 0 ;
  92:  ! stand-off [mm] 55.000 50.000 ;
  93:  ! 1.000 0.000 1.000 50.000 ;
  94:  ! psi [deg] 11.3811 9.5194 ;
  95:  ! -8.7258 -9.0982 -9.6032 ;
  96:  ! -34.3509 ;
  97:  ! P[1] start, P[2] start of the ;
  98:  ! stroke, P[3] begin of the joint ;
  99:  ! moves, P[4] target, P[5] end of ;
 100:  ! the joint moves, P[6] end of ;
 101:  ! the stroke ;
 102:J P[1] 20% FINE    ;
 103:L P[2] 5mm/sec CNT100    ;
 104:L P[3] 5mm/sec CNT100    ;
 105:J P[4] 200msec CNT100    ;
 106:J P[5] 50msec CNT100    ;
 107:L P[6] 20mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 3,	
	J1=  -141.314 deg,	J2=   -22.158 deg,	J3=   176.864 deg,
	J4=   189.004 deg,	J5=    79.818 deg,	J6=  -142.362 deg
};
P[2]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U B, 1, 0, 0',
	X =   425.721  mm,	Y =   285.433  mm,	Z =   431.154  mm,
	W =    90.000 deg,	P =   -80.481 deg,	R =    90.000 deg
};
P[3]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U B, 0, 0, 0',
	X =   474.721  mm,	Y =   285.433  mm,	Z =   431.154  mm,
	W =   -90.000 deg,	P =   -81.274 deg,	R =   -90.000 deg
};
P[4]{
   GP1:
	UF : 0, UT : 3,	
	J1=  -140.624 deg,	J2=   -37.352 deg,	J3=   169.668 deg,
	J4=   172.957 deg,	J5=    85.503 deg,	J6=  -139.712 deg
};
P[5]{
   GP1:
	UF : 0, UT : 3,	
	J1=  -140.434 deg,	J2=   -37.362 deg,	J3=   169.626 deg,
	J4=   172.591 deg,	J5=    85.812 deg,	J6=  -139.492 deg
};
P[6]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U B, 0, 0, 0',
	X =   425.721  mm,	Y =   285.433  mm,	Z =   431.154  mm,
	W =   -90.000 deg,	P =   -55.649 deg,	R =   -90.000 deg
};
/END
