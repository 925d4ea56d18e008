/PROG  P_XW7ZUU
/ATTR
COMMENT		= "zerorev drilling";
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
   1:  ! ------------------------------- ;
   2:  ! Written by zerorev golden ;
   3:  ! Plan position_2 ;
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
  14:  ! info: hole position 2: the ;
  15:  !  blend of radius 0.461 mm turns ;
  16:  !  back 0.2305 mm short (r/2, a ;
  17:  !  parabolic blend over half of ;
  18:  !  each joint move, how far the ;
  19:  !  controller blends is not in ;
  20:  !  the program): the hole comes ;
  21:  !  out 0.2305 mm less deep, ;
  22:  !  deepen_corner places the ;
  23:  !  corner that much deeper ;
  24:  ! info: the twist changes the ;
  25:  !  speed of a right-hand drill by ;
  26:  !  +7.79 rev/min at most (0.26% ;
  27:  !  of 3000), in the retract of ;
  28:  !  hole position 2 ;
  29:  ! info: the moves of all axes ;
  30:  !  from hole to hole are checked ;
  31:  !  against the surface of the ;
  32:  !  part alone, not for fixtures, ;
  33:  !  the cell or the arm's own ;
  34:  !  links, the first one, from ;
  35:  !  wherever the robot is, is not ;
  36:  !  checked at all ;
  37:  ! info: a feed of 20 mm/s over ;
  38:  !  0.922 mm is written as 46msec, ;
  39:  !  which is 20.04 mm/s, of 2 such ;
  40:  !  changes at the corner the ;
  41:  !  greatest ;
  42:  ! ;
  43:  ! - Run the program in T1 first, ;
  44:  !  the spindle off and no part in ;
  45:  !  place. ;
  46:  ! - UTOOL 3 is selected, not set. ;
  47:  !  It must hold X 100.000, Y ;
  48:  !  0.000, Z 65.000, W 180.000, P ;
  49:  !  -90.000, R 0.000 (flange to ;
  50:  !  tip, Z along the plunge). ;
  51:  ! - UFRAME 0: points are given in ;
  52:  !  the world frame, which counts ;
  53:  !  Z from the height of axis 2. ;
  54:  ! - J3 is printed as the pendant ;
  55:  !  shows it: its angle against ;
  56:  !  the ground. ;
  57:  ! - Spindle, coolant and PAYLOAD ;
  58:  !  are not set here. The spindle ;
  59:  !  must run before the drill ;
  60:  !  enters. ;
  61:  ! - J moves at 20 % are checked ;
  62:  !  against the surface of the ;
  63:  !  part alone, and the first one ;
  64:  !  not at all: not for fixtures, ;
  65:  !  the cell or the arm's own ;
  66:  !  links. ;
  67:  ! - Start at line 1: the numbers ;
  68:  !  of the frames are set there. ;
  69:  ! - After a stop in a hole pull ;
  70:  !  the drill out along the drill ;
  71:  !  axis (tool Z) before a new ;
  72:  !  start: a J comes first. ;
  73:  ! - The last of the plunge and ;
  74:  !  the first of the retract are J ;
  75:  !  moves by time (msec), blended ;
  76:  !  with CNT100. How far CNT ;
  77:  !  reaches depends on speed, ;
  78:  !  acceleration and override and ;
  79:  !  is not known: 0 to 1 mm of ;
  80:  !  depth are lost there, at every ;
  81:  !  override. Measure at the ;
  82:  !  override with which you drill. ;
  83:  ! - Open, not tried on a ;
  84:  !  controller: CNT100 from L to J ;
  85:  !  and back, moves of a few ms, ;
  86:  !  the letters of CONFIG. If an L ;
  87:  !  stops with a position or ;
  88:  !  configuration alarm, stop ;
  89:  !  there. ;
  90:  ! ------------------------------- ;
  91:  UFRAME_NUM=0 ;
  92:  UTOOL_NUM=3 ;
  93:  ! Hole 1 of 1: position 2 ;
  94:  ! stroke 20.000 mm, lead-in 5.000 ;
  95:  ! mm, reversals of J1 to J6: 0 0 ;
  96:  ! 0 0 0 0 ;
  97:  ! stand-off [mm] 25.000 20.000 ;
  98:  ! 0.922 0.000 0.922 20.000 ;
  99:  ! psi [deg] -175.7861 -176.3780 ;
 100:  ! -178.6365 -178.7457 -180.9005 ;
 101:  ! -225.4873 ;
 102:  ! P[1] start, P[2] start of the ;
 103:  ! stroke, P[3] begin of the joint ;
 104:  ! moves, P[4] target, P[5] end of ;
 105:  ! the joint moves, P[6] end of ;
 106:  ! the stroke ;
 107:J P[1] 20% FINE    ;
 108:L P[2] 5mm/sec CNT100    ;
 109:L P[3] 5mm/sec CNT100    ;
 110:J P[4] 184msec CNT100    ;
 111:J P[5] 46msec CNT100    ;
 112:L P[6] 20mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 3,	
	J1=    80.526 deg,	J2=     2.513 deg,	J3=     3.570 deg,
	J4=   180.699 deg,	J5=    97.726 deg,	J6=    99.543 deg
};
P[2]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   170.289  mm,	Y =   380.577  mm,	Z =   240.866  mm,
	W =   -90.000 deg,	P =    86.378 deg,	R =   -90.000 deg
};
P[3]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U T, 1, 0, 0',
	X =   189.367  mm,	Y =   380.577  mm,	Z =   240.866  mm,
	W =   -90.000 deg,	P =    88.637 deg,	R =   -90.000 deg
};
P[4]{
   GP1:
	UF : 0, UT : 3,	
	J1=    76.760 deg,	J2=     2.102 deg,	J3=     3.615 deg,
	J4=   180.288 deg,	J5=    94.836 deg,	J6=   103.261 deg
};
P[5]{
   GP1:
	UF : 0, UT : 3,	
	J1=    76.709 deg,	J2=     1.139 deg,	J3=     3.591 deg,
	J4=   179.793 deg,	J5=    92.714 deg,	J6=   103.280 deg
};
P[6]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U T, 0, 0, 0',
	X =   170.289  mm,	Y =   380.577  mm,	Z =   240.866  mm,
	W =    90.000 deg,	P =    44.513 deg,	R =    90.000 deg
};
/END
