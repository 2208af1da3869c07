MODULE SampleVisionPoints
  !===========================================================================
  ! Vision points with moves of one's own: a vision project finds cartons, the
  ! program drives to them by itself. Commands 103, 501, 101, 102.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (1.8) and cell.mod.
  !===========================================================================

  ! Sections of the gripper to switch on for one carton: all four.
  CONST num nAllSections:=15;

  PROC main()
    VAR robtarget pBox;
    VAR num nPoints;
    VAR num nLabel;
    VAR num nSpeed;
    VAR num nMoved:=0;

    BeginSample;
    ! Recipe and size come before the start of the project.
    MM_Switch_Model nJob,1;
    MM_Set_BoxSize nJob,400,300,nHeight;
    MM_Start_Vis nJob,0,0,jHome;
    MM_Get_VisData nJob,nPoints,nStatus;
    IF nStatus<>1100 Refused "no vision points, status ";
    FOR i FROM 1 TO nPoints DO
      MM_Get_Pose i,pBox,nLabel,nSpeed;
      IF Pick(pBox,nAllSections) THEN
        Place;
        nMoved:=nMoved+1;
      ELSE
        TPWrite "No vacuum at point "\Num:=i;
        SetGO goVacuum,0;
      ENDIF
    ENDFOR
    TPWrite "Points: "\Num:=nPoints;
    TPWrite "Moved: "\Num:=nMoved;
    EndSample "vision points";
  ENDPROC
ENDMODULE
