MODULE SampleDoList
  !===========================================================================
  ! A gripper with sections: the plan says which outputs to switch on, and what
  ! the carton under the gripper is. Commands 201, 210 (format 3), 206.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (1.8) and cell.mod.
  !===========================================================================

  PROC main()
    VAR jointtarget jWay;
    VAR num nWay;
    VAR num nVis;
    VAR num nMove;
    VAR num nTool;
    VAR num nSpeed;
    VAR bool bTimeout;

    BeginSample;
    MM_Start_Viz 2,jHome;
    MM_get_plandata 0,3,nWay,nVis,nStatus;
    IF nStatus<>2100 Refused "no path, status ";
    IF nVis=0 Refused "no Vision Move in the path, waypoints ";
    ! The list belongs to the path that was fetched last.
    MM_Get_DoList 0;
    FOR i FROM 1 TO nWay DO
      MM_Get_PlanJps i,3,jWay,nMove,nTool,nSpeed;
      MoveAbsJ jWay\NoEOffs,v1000,fine,tGripper\WObj:=wobj0;
      IF i=nVis THEN
        ! Results of the Vision Move: 12 picked now, 19 and 20 length and width.
        TPWrite "Picked at once: "\Num:=MM_Plan_Results{12};
        TPWrite "Length: "\Num:=MM_Plan_Results{19};
        TPWrite "Width: "\Num:=MM_Plan_Results{20};
        ! Group 1: DO 0 to 15.
        MM_Set_DoList 1,goVacuum;
        TPWrite "Outputs: "\Num:=GOutput(goVacuum);
        WaitDI diVacuumOk,1\MaxTime:=1.5\TimeFlag:=bTimeout;
        IF bTimeout Refused "no vacuum, last status ";
      ENDIF
    ENDFOR
    SetGO goVacuum,0;
    WaitDI diVacuumOk,0\MaxTime:=2;
    EndSample "DO list";
  ENDPROC
ENDMODULE
