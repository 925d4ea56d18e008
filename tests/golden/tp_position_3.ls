/PROG  P_RSJW2B
/ATTR
COMMENT		= "zerorev drilling";
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
   1:  ! ------------------------------- ;
   2:  ! Written by zerorev golden ;
   3:  ! Plan position_3 ;
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
  14:  ! warning: hole position 3: ;
  15:  !  lead-in of 0.959 mm instead of ;
  16:  !  5 mm: further back J4 would ;
  17:  !  turn the other way ;
  18:  ! info: hole position 3: the ;
  19:  !  blend of radius 0.388 mm turns ;
  20:  !  back 0.194 mm short (r/2, a ;
  21:  !  parabolic blend over half of ;
  22:  !  each joint move, how far the ;
  23:  !  controller blends is not in ;
  24:  !  the program): the hole comes ;
  25:  !  out 0.194 mm less deep, ;
  26:  !  deepen_corner places the ;
  27:  !  corner that much deeper ;
  28:  ! info: the twist changes the ;
  29:  !  speed of a right-hand drill by ;
  30:  !  -3.23 rev/min at most (0.11% ;
  31:  !  of 3000), in the retract of ;
  32:  !  hole position 3 ;
  33:  ! info: the moves of all axes ;
  34:  !  from hole to hole are checked ;
  35:  !  against the surface of the ;
  36:  !  part alone, not for fixtures, ;
  37:  !  the cell or the arm's own ;
  38:  !  links, the first one, from ;
  39:  !  wherever the robot is, is not ;
  40:  !  checked at all ;
  41:  ! info: a feed of 20 mm/s over ;
  42:  !  0.776 mm is written as 39msec, ;
  43:  !  which is 19.9 mm/s, of 2 such ;
  44:  !  changes at the corner the ;
  45:  !  greatest ;
  46:  ! ;
  47:  ! - Run the program in T1 first, ;
  48:  !  the spindle off and no part in ;
  49:  !  place. ;
  50:  ! - UTOOL 3 is selected, not set. ;
  51:  !  It must hold X 100.000, Y ;
  52:  !  0.000, Z 65.000, W 180.000, P ;
  53:  !  -90.000, R 0.000 (flange to ;
  54:  !  tip, Z along the plunge). ;
  55:  ! - UFRAME 0: points are given in ;
  56:  !  the world frame, which counts ;
  57:  !  Z from the height of axis 2. ;
  58:  ! - J3 is printed as the pendant ;
  59:  !  shows it: its angle against ;
  60:  !  the ground. ;
  61:  ! - Spindle, coolant and PAYLOAD ;
  62:  !  are not set here. The spindle ;
  63:  !  must run before the drill ;
  64:  !  enters. ;
  65:  ! - J moves at 20 % are checked ;
  66:  !  against the surface of the ;
  67:  !  part alone, and the first one ;
  68:  !  not at all: not for fixtures, ;
  69:  !  the cell or the arm's own ;
  70:  !  links. ;
  71:  ! - Start at line 1: the numbers ;
  72:  !  of the frames are set there. ;
  73:  ! - After a stop in a hole pull ;
  74:  !  the drill out along the drill ;
  75:  !  axis (tool Z) before a new ;
  76:  !  start: a J comes first. ;
  77:  ! - The last of the plunge and ;
  78:  !  the first of the retract are J ;
  79:  !  moves by time (msec), blended ;
  80:  !  with CNT100. How far CNT ;
  81:  !  reaches depends on speed, ;
  82:  !  acceleration and override and ;
  83:  !  is not known: 0 to 1 mm of ;
  84:  !  depth are lost there, at every ;
  85:  !  override. Measure at the ;
  86:  !  override with which you drill. ;
  87:  ! - Open, not tried on a ;
  88:  !  controller: CNT100 from L to J ;
  89:  !  and back, moves of a few ms, ;
  90:  !  the letters of CONFIG. If an L ;
  91:  !  stops with a position or ;
  92:  !  configuration alarm, stop ;
  93:  !  there. ;
  94:  ! ------------------------------- ;
  95:  UFRAME_NUM=0 ;
  96:  UTOOL_NUM=3 ;
  97:  ! Hole 1 of 1: position 3 ;
  98:  ! stroke 30.000 mm, lead-in 0.959 ;
  99:  ! mm, reversals of J1 to J6: 0 0 ;
 100:  ! 0 0 0 0 ;
 101:  ! stand-off [mm] 30.959 30.000 ;
 102:  ! 0.776 0.000 0.776 30.000 ;
 103:  ! psi [deg] -29.2810 -28.5561 ;
 104:  ! -6.4646 -5.8780 -5.1266 23.1707 ;
 105:  ! P[1] start, P[2] start of the ;
 106:  ! stroke, P[3] begin of the joint ;
 107:  ! moves, P[4] target, P[5] end of ;
 108:  ! the joint moves, P[6] end of ;
 109:  ! the stroke ;
 110:J P[1] 20% FINE    ;
 111:L P[2] 5mm/sec CNT100    ;
 112:L P[3] 5mm/sec CNT100    ;
 113:J P[4] 155msec CNT100    ;
 114:J P[5] 39msec CNT100    ;
 115:L P[6] 20mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 3,	
	J1=  -102.797 deg,	J2=    -4.297 deg,	J3=   144.528 deg,
	J4=  -186.263 deg,	J5=    83.239 deg,	J6=  -100.466 deg
};
P[2]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U B, -1, 0, 0',
	X =   160.289  mm,	Y =   190.289  mm,	Z =   621.443  mm,
	W =   -90.000 deg,	P =   -61.444 deg,	R =   -90.000 deg
};
P[3]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U B, -1, 0, 0',
	X =   189.513  mm,	Y =   190.289  mm,	Z =   621.443  mm,
	W =   -90.000 deg,	P =   -83.535 deg,	R =   -90.000 deg
};
P[4]{
   GP1:
	UF : 0, UT : 3,	
	J1=  -113.756 deg,	J2=     4.908 deg,	J3=   147.891 deg,
	J4=  -182.647 deg,	J5=    63.299 deg,	J6=  -112.455 deg
};
P[5]{
   GP1:
	UF : 0, UT : 3,	
	J1=  -113.769 deg,	J2=     5.265 deg,	J3=   147.891 deg,
	J4=  -182.325 deg,	J5=    62.604 deg,	J6=  -112.615 deg
};
P[6]{
   GP1:
	UF : 0, UT : 3,		CONFIG : 'F U B, 0, 0, 0',
	X =   160.289  mm,	Y =   190.289  mm,	Z =   621.443  mm,
	W =    90.000 deg,	P =   -66.829 deg,	R =    90.000 deg
};
/END
