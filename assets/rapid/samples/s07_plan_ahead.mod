MODULE SamplePlanAhead
  !===========================================================================
  ! No waiting for the vision system: the next round is started while this carton
  ! is being put down. The arm is then out of the camera's view, and the joints it
  ! will start from are sent along (SendPos_Type 2). Commands 201, 210, 206.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (1.8) and cell.mod.
  !===========================================================================

  ! Rounds; more than there are cartons: the vision system says when all are gone.
  CONST num nMaxRounds:=3;

  VAR jointtarget jWay{30};
  VAR num nWay:=0;
  VAR num nVis:=0;

  PROC main()
    VAR num nRounds:=0;
    VAR bool bMore:=TRUE;
    VAR bool bTimeout;

    BeginSample;
    ! The first round has nothing to hide behind.
    MM_Start_Viz 2,jHome;
    WHILE bMore AND nRounds<nMaxRounds DO
      MM_get_plandata 0,1,nWay,nVis,nStatus;
      TEST nStatus
      CASE 2100:
        MM_Get_DoList 0;
        StorePathOfRound;
        FOR i FROM 1 TO nVis DO
          DriveTo i;
        ENDFOR
        MM_Set_DoList 1,goVacuum;
        WaitDI diVacuumOk,1\MaxTime:=1.5\TimeFlag:=bTimeout;
        IF bTimeout Refused "no vacuum, last status ";
        FOR i FROM nVis+1 TO nWay DO
          DriveTo i;
        ENDFOR
        SetGO goVacuum,0;
        nRounds:=nRounds+1;
        ! While the vacuum goes and the arm returns, the next round is planned. The
        ! corner at home lets the arm go on without a stop if the path is there in time.
        IF nRounds<nMaxRounds MM_Start_Viz 2,jHome;
        WaitDI diVacuumOk,0\MaxTime:=2;
        MoveL RelTool(CRobT(\Tool:=tGripper\WObj:=wobj0),0,0,-150),v1000,z10,tGripper\WObj:=wobj0;
        MoveAbsJ jHome\NoEOffs,v1000,z50,tGripper\WObj:=wobj0;
        TPWrite "Round "\Num:=nRounds;
      CASE 1002,1003,2037,2038:
        bMore:=FALSE;
      DEFAULT:
        Refused "no path, status ";
      ENDTEST
    ENDWHILE
    TPWrite "Rounds: "\Num:=nRounds;
    EndSample "plan ahead";
  ENDPROC

  PROC StorePathOfRound()
    VAR num nMove;
    VAR num nTool;
    VAR num nSpeed;

    IF nWay>30 OR nVis=0 Refused "unusable path, last status ";
    FOR i FROM 1 TO nWay DO
      MM_Get_PlanJps i,1,jWay{i},nMove,nTool,nSpeed;
    ENDFOR
  ENDPROC

  ! Stop points at the pick and at the place, corners elsewhere.
  PROC DriveTo(num nIndex)
    IF nIndex=nVis OR nIndex=nWay THEN
      MoveAbsJ jWay{nIndex}\NoEOffs,v1000,fine,tGripper\WObj:=wobj0;
    ELSE
      MoveAbsJ jWay{nIndex}\NoEOffs,v1000,z50,tGripper\WObj:=wobj0;
    ENDIF
  ENDPROC
ENDMODULE
