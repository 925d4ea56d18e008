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
  19:  !  blend of the joint moves ;
  20:  !  (0.388 mm to either side, at ;
  21:  !  most) turns back 0.194 mm ;
  22:  !  short (r/2, a parabolic blend ;
  23:  !  over half of each joint move, ;
  24:  !  how far the controller blends ;
  25:  !  is not in the program): the ;
  26:  !  hole comes out 0.194 mm less ;
  27:  !  deep, deepen_corner places the ;
  28:  !  corner that much deeper ;
  29:  ! info: the twist changes the ;
  30:  !  speed of a right-hand drill by ;
  31:  !  -3.23 rev/min at most (0.11% ;
  32:  !  of 3000), in the retract of ;
  33:  !  hole position 3 ;
  34:  ! info: the moves of all axes ;
  35:  !  from hole to hole are checked ;
  36:  !  against the surface of the ;
  37:  !  part alone, not for fixtures, ;
  38:  !  the cell or the arm's own ;
  39:  !  links, the first one, from ;
  40:  !  wherever the robot is, is not ;
  41:  !  checked at all ;
  42:  ! info: a feed of 20 mm/s over ;
  43:  !  0.776 mm is written as 39msec, ;
  44:  !  which is 19.9 mm/s, of 2 such ;
  45:  !  changes at the corner the ;
  46:  !  greatest ;
  47:  ! ;
  48:  ! - Run the program in T1 first, ;
  49:  !  the spindle off and no part in ;
  50:  !  place. ;
  51:  ! - UTOOL 3 is selected, not set. ;
  52:  !  It must hold X 100.000, Y ;
  53:  !  0.000, Z 65.000, W 180.000, P ;
  54:  !  -90.000, R 0.000 (flange to ;
  55:  !  tip, Z along the plunge). ;
  56:  ! - UFRAME 0: points are given in ;
  57:  !  the world frame, which counts ;
  58:  !  Z from the height of axis 2. ;
  59:  ! - J3 is printed as the pendant ;
  60:  !  shows it: its angle against ;
  61:  !  the ground. ;
  62:  ! - Spindle, coolant and PAYLOAD ;
  63:  !  are not set here. The spindle ;
  64:  !  must run before the drill ;
  65:  !  enters. ;
  66:  ! - J moves at 20 % are checked ;
  67:  !  against the surface of the ;
  68:  !  part alone, and the first one ;
  69:  !  not at all: not for fixtures, ;
  70:  !  the cell or the arm's own ;
  71:  !  links. ;
  72:  ! - Start at line 1: the numbers ;
  73:  !  of the frames are set there. ;
  74:  ! - After a stop in a hole pull ;
  75:  !  the drill out along the drill ;
  76:  !  axis (tool Z) before a new ;
  77:  !  start: a J comes first. ;
  78:  ! - The last of the plunge and ;
  79:  !  the first of the retract are J ;
  80:  !  moves by time (msec), blended ;
  81:  !  with CNT100. How far CNT ;
  82:  !  reaches depends on speed, ;
  83:  !  acceleration and override and ;
  84:  !  is not known: 0 to 1 mm of ;
  85:  !  depth are lost there, at every ;
  86:  !  override. Measure at the ;
  87:  !  override with which you drill. ;
  88:  ! - Open, not tried on a ;
  89:  !  controller: CNT100 from L to J ;
  90:  !  and back, moves of a few ms, ;
  91:  !  the letters of CONFIG. If an L ;
  92:  !  stops with a position or ;
  93:  !  configuration alarm, stop ;
  94:  !  there. ;
  95:  ! ------------------------------- ;
  96:  UFRAME_NUM=0 ;
  97:  UTOOL_NUM=3 ;
  98:  ! Hole 1 of 1: position 3 ;
  99:  ! stroke 30.000 mm, lead-in 0.959 ;
 100:  ! mm, reversals of J1 to J6: 0 0 ;
 101:  ! 0 0 0 0 ;
 102:  ! stand-off [mm] 30.959 30.000 ;
 103:  ! 0.776 0.000 0.776 30.000 ;
 104:  ! psi [deg] -29.2810 -28.5561 ;
 105:  ! -6.4646 -5.8780 -5.1266 23.1707 ;
 106:  ! P[1] start, P[2] start of the ;
 107:  ! stroke, P[3] begin of the joint ;
 108:  ! moves, P[4] target, P[5] end of ;
 109:  ! the joint moves, P[6] end of ;
 110:  ! the stroke ;
 111:J P[1] 20% FINE    ;
 112:L P[2] 5mm/sec CNT100    ;
 113:L P[3] 5mm/sec CNT100    ;
 114:J P[4] 155msec CNT100    ;
 115:J P[5] 39msec CNT100    ;
 116:L P[6] 20mm/sec FINE    ;
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
