MODULE SampleBranchAndIndex
  !===========================================================================
  ! The program decides what the Viz project does: an exit of a Branch by Msg
  ! step, the place in a pallet pattern. Commands 202, 201, 204, 203, 205.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (1.8) and cell.mod.
  !===========================================================================

  ! Step numbers as shown in the Viz project.
  CONST num nBranchStep:=1;
  CONST num nPatternStep:=3;

  PROC main()
    VAR num nWay;
    VAR num nVis;

    BeginSample;
    ! A project that was left running is stopped; 2104 also when none runs.
    MM_Stop_Viz nStatus;
    IF nStatus<>2104 Refused "Viz does not stop, status ";
    FOR nPlace FROM 1 TO 3 DO
      MM_Start_Viz 2,jHome;
      ! N sets the current index to N-1; before the step runs.
      MM_Set_Index nPatternStep,nPlace;
      ! Odd places take exit 0, even ones exit 1: N takes exit N-1.
      MM_Set_Branch nBranchStep,2-(nPlace MOD 2);
      MM_Get_VizData 1,nWay,nVis,nStatus;
      IF nStatus<>2100 Refused "no path, status ";
      TPWrite "Place "+NumToStr(nPlace,0)+", waypoints: "\Num:=nWay;
    ENDFOR
    EndSample "branch and index";
  ENDPROC
ENDMODULE
