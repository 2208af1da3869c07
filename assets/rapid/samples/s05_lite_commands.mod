MODULE SampleLite
  !===========================================================================
  ! Everything in one exchange: the Lite commands start a project and bring its
  ! result. Commands 100 and 200.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (1.8) and cell.mod.
  !===========================================================================

  PROC main()
    VAR robtarget pBox;
    VAR jointtarget jWay;
    VAR num nPoints;
    VAR num nVis;
    VAR num nLabel;
    VAR num nSpeed;

    BeginSample;
    ! Recipe 1, format 1: vision points. At most one reply's worth of them.
    MM_Lite_Vis nJob,1,1,nStatus,\Pos_Num:=nPoints;
    IF nStatus<>1100 Refused "no vision points, status ";
    TPWrite "Points: "\Num:=nPoints;
    MM_Get_Pose 1,pBox,nLabel,nSpeed;
    IF Pick(pBox,15) THEN
      Place;
    ELSE
      SetGO goVacuum,0;
      TPWrite "No vacuum";
    ENDIF
    ! No branch, path of joints.
    MM_Lite_Viz 0,0,1,nStatus,\Pos_Num:=nPoints,\VisPos_Num:=nVis;
    IF nStatus<>2100 Refused "no path, status ";
    TPWrite "Waypoints: "\Num:=nPoints;
    FOR i FROM 1 TO nPoints DO
      MM_Get_Jps i,jWay,nLabel,nSpeed;
      MoveAbsJ jWay\NoEOffs,v1000,z50,tGripper\WObj:=wobj0;
    ENDFOR
    EndSample "Lite commands";
  ENDPROC
ENDMODULE
