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
  15:  !  blend of the joint moves ;
  16:  !  (0.461 mm to either side, at ;
  17:  !  most) turns back 0.2305 mm ;
  18:  !  short (r/2, a parabolic blend ;
  19:  !  over half of each joint move, ;
  20:  !  how far the controller blends ;
  21:  !  is not in the program): the ;
  22:  !  hole comes out 0.2305 mm less ;
  23:  !  deep, deepen_corner places the ;
  24:  !  corner that much deeper ;
  25:  ! info: the twist changes the ;
  26:  !  speed of a right-hand drill by ;
  27:  !  +7.79 rev/min at most (0.26% ;
  28:  !  of 3000), in the retract of ;
  29:  !  hole position 2 ;
  30:  ! info: the moves of all axes ;
  31:  !  from hole to hole are checked ;
  32:  !  against the surface of the ;
  33:  !  part alone, not for fixtures, ;
  34:  !  the cell or the arm's own ;
  35:  !  links, the first one, from ;
  36:  !  wherever the robot is, is not ;
  37:  !  checked at all ;
  38:  ! info: a feed of 20 mm/s over ;
  39:  !  0.922 mm is written as 46msec, ;
  40:  !  which is 20.04 mm/s, of 2 such ;
  41:  !  changes at the corner the ;
  42:  !  greatest ;
  43:  ! ;
  44:  ! - Run the program in T1 first, ;
  45:  !  the spindle off and no part in ;
  46:  !  place. ;
  47:  ! - UTOOL 3 is selected, not set. ;
  48:  !  It must hold X 100.000, Y ;
  49:  !  0.000, Z 65.000, W 180.000, P ;
  50:  !  -90.000, R 0.000 (flange to ;
  51:  !  tip, Z along the plunge). ;
  52:  ! - UFRAME 0: points are given in ;
  53:  !  the world frame, which counts ;
  54:  !  Z from the height of axis 2. ;
  55:  ! - J3 is printed as the pendant ;
  56:  !  shows it: its angle against ;
  57:  !  the ground. ;
  58:  ! - Spindle, coolant and PAYLOAD ;
  59:  !  are not set here. The spindle ;
  60:  !  must run before the drill ;
  61:  !  enters. ;
  62:  ! - J moves at 20 % are checked ;
  63:  !  against the surface of the ;
  64:  !  part alone, and the first one ;
  65:  !  not at all: not for fixtures, ;
  66:  !  the cell or the arm's own ;
  67:  !  links. ;
  68:  ! - Start at line 1: the numbers ;
  69:  !  of the frames are set there. ;
  70:  ! - After a stop in a hole pull ;
  71:  !  the drill out along the drill ;
  72:  !  axis (tool Z) before a new ;
  73:  !  start: a J comes first. ;
  74:  ! - The last of the plunge and ;
  75:  !  the first of the retract are J ;
  76:  !  moves by time (msec), blended ;
  77:  !  with CNT100. How far CNT ;
  78:  !  reaches depends on speed, ;
  79:  !  acceleration and override and ;
  80:  !  is not known: 0 to 1 mm of ;
  81:  !  depth are lost there, at every ;
  82:  !  override. Measure at the ;
  83:  !  override with which you drill. ;
  84:  ! - Open, not tried on a ;
  85:  !  controller: CNT100 from L to J ;
  86:  !  and back, moves of a few ms, ;
  87:  !  the letters of CONFIG. If an L ;
  88:  !  stops with a position or ;
  89:  !  configuration alarm, stop ;
  90:  !  there. ;
  91:  ! ------------------------------- ;
  92:  UFRAME_NUM=0 ;
  93:  UTOOL_NUM=3 ;
  94:  ! Hole 1 of 1: position 2 ;
  95:  ! stroke 20.000 mm, lead-in 5.000 ;
  96:  ! mm, reversals of J1 to J6: 0 0 ;
  97:  ! 0 0 0 0 ;
  98:  ! stand-off [mm] 25.000 20.000 ;
  99:  ! 0.922 0.000 0.922 20.000 ;
 100:  ! psi [deg] -175.7861 -176.3780 ;
 101:  ! -178.6365 -178.7457 -180.9005 ;
 102:  ! -225.4873 ;
 103:  ! P[1] start, P[2] start of the ;
 104:  ! stroke, P[3] begin of the joint ;
 105:  ! moves, P[4] target, P[5] end of ;
 106:  ! the joint moves, P[6] end of ;
 107:  ! the stroke ;
 108:J P[1] 20% FINE    ;
 109:L P[2] 5mm/sec CNT100    ;
 110:L P[3] 5mm/sec CNT100    ;
 111:J P[4] 184msec CNT100    ;
 112:J P[5] 46msec CNT100    ;
 113:L P[6] 20mm/sec FINE    ;
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
