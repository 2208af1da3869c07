/PROG  FANUC
/ATTR
COMMENT		= "empty a pallet";
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
   1:  !Empties a pallet onto a conveyor: ;
   2:  !the vision system plans, the robot ;
   3:  !asks. One round: waypoints and ;
   4:  !outputs are fetched, the arm goes to ;
   5:  !the Vision Move waypoint, grips, and ;
   6:  !carries on to the last one. ;
   7:  ! ;
   8:  !GO[1] the gripper's sections, a bit ;
   9:  !each; DI[1] vacuum holds. ;
  10:  !R[1] status R[2] waypoints R[3] the ;
  11:  !Vision Move R[4] cartons moved ;
  12:  !R[5] failures in a row R[6] waypoint ;
  13:  !R[101..130] kinds of move, ;
  14:  !R[131..160] speeds, PR[1..30] places ;
  15:  ! ;
  16:  !Lip plane 300 mm before the flange ;
  17:  UFRAME_NUM=0 ;
  18:  PR[90]=LPOS-LPOS ;
  19:  PR[90,3]=300 ;
  20:  UTOOL[1]=PR[90] ;
  21:  UTOOL_NUM=1 ;
  22:  R[4]=0 ;
  23:  R[5]=0 ;
  24:  R[11:acceleration]=100 ;
  25:  $WAITTMOUT=150 ;
  26:  GO[1:sections]=0 ;
  27:  PR[91:capture pose]=P[1] ;
  28:  CALL MM_INIT_SKT('1','127.0.0.1',50000,1) ;
  29:  CALL MM_GET_STAT(1) ;
  30:  IF R[1]<>1101,JMP LBL[90] ;
  31:  CALL MM_SET_BS(1,400,300,250) ;
  32:J P[1:capture pose] 50% FINE ;
  33:  CALL MM_START_VIZ(2,91) ;
  34:  ! ;
  35:  LBL[1:next round] ;
  36:  CALL MM_GET_PLNDT(0,3,2,3,1) ;
  37:  SELECT R[1]=2100,JMP LBL[2] ;
  38:         =1002,JMP LBL[80] ;
  39:         =1003,JMP LBL[80] ;
  40:         =2037,JMP LBL[80] ;
  41:         =2038,JMP LBL[80] ;
  42:         ELSE,JMP LBL[90] ;
  43:  LBL[2:a path is there] ;
  44:  IF R[3]<2 OR R[3]>=R[2] OR R[2]>30,JMP LBL[90] ;
  45:  CALL MM_GET_DL(0) ;
  46:  FOR R[6]=1 TO R[2] ;
  47:  R[7]=R[6]+100 ;
  48:  R[8]=R[6]+130 ;
  49:  CALL MM_GET_PLJOP(R[6],3,R[6],R[7],10,R[8],300,400) ;
  50:  ENDFOR ;
  51:  ! ;
  52:  !Pick ;
  53:  FOR R[6]=1 TO R[3] ;
  54:  CALL WAYPOINT ;
  55:  ENDFOR ;
  56:  CALL MM_SET_DL ;
  57:  WAIT DI[1:vacuum]=ON TIMEOUT,LBL[50] ;
  58:  ! ;
  59:  !Place; the next round is planned ;
  60:  !while the vacuum bleeds off ;
  61:  R[11:acceleration]=70 ;
  62:  R[10]=R[3]+1 ;
  63:  FOR R[6]=R[10] TO R[2] ;
  64:  CALL WAYPOINT ;
  65:  ENDFOR ;
  66:  R[9:held]=DI[1:vacuum] ;
  67:  R[11:acceleration]=100 ;
  68:  GO[1:sections]=0 ;
  69:  CALL MM_START_VIZ(2,91) ;
  70:  WAIT DI[1:vacuum]=OFF TIMEOUT,LBL[90] ;
  71:  PR[92]=LPOS ;
  72:  PR[92,3]=PR[92,3]+150 ;
  73:L PR[92] 1000mm/sec CNT10 ;
  74:J P[1:capture pose] 100% CNT25 ;
  75:  IF R[9:held]=0,JMP LBL[60] ;
  76:  R[5]=0 ;
  77:  R[4]=R[4]+1 ;
  78:  JMP LBL[1] ;
  79:  ! ;
  80:  LBL[50:no vacuum] ;
  81:  R[5]=R[5]+1 ;
  82:  IF R[5]>3,JMP LBL[90] ;
  83:  MESSAGE[No vacuum, back again] ;
  84:  GO[1:sections]=0 ;
  85:  WAIT    .30(sec) ;
  86:  R[10]=R[3]-1 ;
  87:  FOR R[6]=R[10] DOWNTO 1 ;
  88:  CALL WAYPOINT ;
  89:  ENDFOR ;
  90:J P[1:capture pose] 100% FINE ;
  91:  CALL MM_START_VIZ(2,91) ;
  92:  JMP LBL[1] ;
  93:  ! ;
  94:  LBL[60:carton lost on the way] ;
  95:  R[5]=R[5]+1 ;
  96:  IF R[5]>3,JMP LBL[90] ;
  97:  MESSAGE[Carton lost on the way] ;
  98:  JMP LBL[1] ;
  99:  ! ;
 100:  LBL[80:nothing left] ;
 101:  MESSAGE[Pallet empty] ;
 102:J P[1:capture pose] 50% FINE ;
 103:  END ;
 104:  ! ;
 105:  !The vacuum stays as it is: a carton ;
 106:  !may hang on the gripper ;
 107:  LBL[90:a case for a person] ;
 108:  MESSAGE[Stopped: see R 1, the status] ;
 109:  ABORT ;
/POS
P[1:"capture pose"]{
   GP1:
	UF : 0, UT : 1,
	J1=    90.000 deg,	J2=   -20.000 deg,	J3=     0.000 deg,
	J4=     0.000 deg,	J5=   -90.000 deg,	J6=     0.000 deg
};
/END
/PROG  WAYPOINT
/ATTR
COMMENT		= "one waypoint";
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
   1:  !One waypoint, the one of R[6]: stop ;
   2:  !points at the pick and at the place, ;
   3:  !corners elsewhere, small ones next ;
   4:  !to them ;
   5:  R[13]=R[6]+100 ;
   6:  R[14]=R[6]+130 ;
   7:  R[15:percent]=R[R[14]] ;
   8:  IF (R[15]<1),R[15]=1 ;
   9:  R[16:mm/sec]=R[15]*20 ;
  10:  R[17:corner]=25 ;
  11:  IF (R[6]=R[3]+1 OR R[6]=R[3]-1 OR R[6]=R[2]-1),R[17]=5 ;
  12:  IF R[6]=R[3] OR R[6]=R[2],JMP LBL[10] ;
  13:  IF R[R[13]]=2,JMP LBL[2] ;
  14:J PR[R[6]] R[15]% CNT R[17] ACC R[11] ;
  15:  END ;
  16:  LBL[2] ;
  17:L PR[R[6]] R[16]mm/sec CNT R[17] ACC R[11] ;
  18:  END ;
  19:  LBL[10] ;
  20:  IF R[R[13]]=2,JMP LBL[12] ;
  21:J PR[R[6]] R[15]% FINE ACC R[11] ;
  22:  END ;
  23:  LBL[12] ;
  24:L PR[R[6]] R[16]mm/sec FINE ACC R[11] ;
/POS
/END
