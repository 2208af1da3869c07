MODULE MainModule
  !===========================================================================
  ! Empties the pallet with a camera on the flange: looks from above, stands
  ! still meanwhile, tells where it stands, and picks what was seen.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (profile 1.8).
  !===========================================================================

  ! Gripper: lip plane 300 mm in front of the flange, 50 kg.
  PERS tooldata tGripper:=[TRUE,[[0,0,300],[1,0,0,0]],[50,[0,0,150],[1,0,0,0],0,0,0]];
  ! Flange above the pallet, looking down, its Y away from the arm: the camera,
  ! 320 mm along that Y, is then above the middle of the stack.
  CONST robtarget pLook:=[[1380,0,2050],[0,0.70710678,0.70710678,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST num nMaxWay:=30;

  VAR jointtarget jWay{30};
  VAR num nMoveType{30};
  VAR num nSpeed{30};
  VAR num nWay:=0;
  VAR num nVis:=0;
  VAR num nStatus:=0;
  VAR num nMoved:=0;

  PROC main()
    VAR bool bMore:=TRUE;

    ! Poses from outside carry no arm configuration: the nearest one is taken.
    ConfJ\Off;
    ConfL\Off;
    SetGO goVacuum,0;
    MM_Init_Socket "127.0.0.1",50000,60;
    MM_Open_Socket;
    MM_Get_Status nStatus;
    IF nStatus<>1101 Refused "vision not ready, status ";

    WHILE bMore DO
      ! The fine point ends the move before the picture: 1 sends joints and flange
      ! as they are now, and the arm stands until the path is there.
      MoveJ pLook,v2000,fine,tool0\WObj:=wobj0;
      MM_Start_Viz 1,CJointT();
      MM_get_plandata 0,3,nWay,nVis,nStatus;
      TEST nStatus
      CASE 2100:
        IF nVis<2 OR nVis>=nWay OR nWay>nMaxWay Refused "unusable path, Vision Move at ";
        MM_Get_DoList 0;
        Transfer;
      CASE 1002,1003,2037,2038:
        bMore:=FALSE;
      DEFAULT:
        Refused "no path, status ";
      ENDTEST
    ENDWHILE
    TPWrite "Pallet empty, cartons moved: "\Num:=nMoved;
    MM_Close_Socket;
  ENDPROC

  ! One carton from the pallet to the conveyor, and up from it.
  PROC Transfer()
    VAR bool bTimeout;
    VAR num nTool;
    VAR robtarget pPlace;

    FOR i FROM 1 TO nWay DO
      MM_Get_PlanJps i,3,jWay{i},nMoveType{i},nTool,nSpeed{i};
    ENDFOR
    FOR i FROM 1 TO nVis DO
      Go i;
    ENDFOR
    MM_Set_DoList 1,goVacuum;
    WaitDI diVacuumOk,1\MaxTime:=1.5\TimeFlag:=bTimeout;
    IF bTimeout Refused "no vacuum, status ";
    FOR i FROM nVis+1 TO nWay DO
      Go i;
    ENDFOR
    SetGO goVacuum,0;
    WaitDI diVacuumOk,0;
    nMoved:=nMoved+1;
    pPlace:=CalcRobT(jWay{nWay},tGripper\WObj:=wobj0);
    MoveL Offs(pPlace,0,0,150),v500,z10,tGripper\WObj:=wobj0;
  ENDPROC

  PROC Go(num nIndex)
    IF nIndex=nVis OR nIndex=nWay THEN
      MoveTo nIndex,fine;
    ELSEIF Abs(nIndex-nVis)=1 OR nIndex=nWay-1 THEN
      MoveTo nIndex,z10;
    ELSE
      MoveTo nIndex,z50;
    ENDIF
  ENDPROC

  PROC MoveTo(num nIndex,zonedata zEnd)
    VAR speeddata vPath:=[5000,500,5000,1000];

    vPath.v_tcp:=vPath.v_tcp*nSpeed{nIndex}/100;
    vPath.v_ori:=vPath.v_ori*nSpeed{nIndex}/100;
    IF nMoveType{nIndex}=2 THEN
      MoveL CalcRobT(jWay{nIndex},tGripper\WObj:=wobj0),vPath,zEnd,tGripper\WObj:=wobj0;
    ELSE
      MoveAbsJ jWay{nIndex}\NoEOffs,vPath,zEnd,tGripper\WObj:=wobj0;
    ENDIF
  ENDPROC

  ! Says why, and stops. The vacuum stays as it is.
  PROC Refused(string sReason)
    TPWrite "Stopped: "+sReason\Num:=nStatus;
    MM_Close_Socket;
    Stop;
    EXIT;
  ENDPROC
ENDMODULE
