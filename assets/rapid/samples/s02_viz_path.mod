MODULE SampleVizPath
  !===========================================================================
  ! The path of a Viz project: the vision system plans, the program follows it
  ! waypoint by waypoint. Commands 201, 205.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (1.8) and cell.mod.
  !===========================================================================

  PROC main()
    VAR jointtarget jWay{30};
    VAR num nWay;
    VAR num nVis;
    VAR num nLabel;
    VAR num nSpeed{30};
    VAR bool bTimeout;

    BeginSample;
    MM_Start_Viz 2,jHome;
    ! 1: joints, so that the arm stands exactly as it was planned.
    MM_Get_VizData 1,nWay,nVis,nStatus;
    IF nStatus<>2100 Refused "no path, status ";
    IF nVis=0 OR nWay>30 Refused "unusable path, waypoints ";
    FOR i FROM 1 TO nWay DO
      MM_Get_Jps i,jWay{i},nLabel,nSpeed{i};
    ENDFOR
    FOR i FROM 1 TO nWay DO
      IF i=nVis OR i=nWay THEN
        MoveAbsJ jWay{i}\NoEOffs,Percent(nSpeed{i}),fine,tGripper\WObj:=wobj0;
      ELSE
        MoveAbsJ jWay{i}\NoEOffs,Percent(nSpeed{i}),z50,tGripper\WObj:=wobj0;
      ENDIF
      IF i=nVis THEN
        SetGO goVacuum,15;
        WaitDI diVacuumOk,1\MaxTime:=1.5\TimeFlag:=bTimeout;
        IF bTimeout Refused "no vacuum, last status ";
      ENDIF
    ENDFOR
    SetGO goVacuum,0;
    WaitDI diVacuumOk,0\MaxTime:=2;
    TPWrite "Waypoints: "\Num:=nWay;
    TPWrite "Vision Move at: "\Num:=nVis;
    EndSample "Viz path";
  ENDPROC

  ! Speed data of a percentage of 2 m/s.
  FUNC speeddata Percent(num nPercent)
    VAR speeddata vScaled;

    IF nPercent<1 nPercent:=1;
    vScaled:=v2000;
    vScaled.v_tcp:=20*nPercent;
    RETURN vScaled;
  ENDFUNC
ENDMODULE
