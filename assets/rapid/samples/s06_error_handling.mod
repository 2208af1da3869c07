MODULE SampleErrors
  !===========================================================================
  ! What can go wrong, and what to do about it: connections that break are opened
  ! again, a capture without result is repeated, an empty pallet ends the work,
  ! a carton that slips is left. Every wait has an end.
  ! Part of depal. Licence: MIT OR Apache-2.0. Needs MM_Module (1.8) and cell.mod.
  !===========================================================================

  CONST num nMaxCaptures:=3;
  CONST num nMaxReconnects:=3;

  VAR num nReconnects:=0;

  PROC main()
    VAR robtarget pBox;
    VAR num nPoints:=0;
    VAR num nCaptures:=0;
    VAR num nMoved:=0;
    VAR num nLabel;
    VAR num nSpeed;

    BeginSample;
    WHILE nCaptures<nMaxCaptures DO
      Capture nPoints;
      TEST nStatus
      CASE 1100:
        nCaptures:=0;
        MM_Get_Pose 1,pBox,nLabel,nSpeed;
        IF Reachable(pBox) THEN
          IF Pick(pBox,15) THEN
            Place;
            nMoved:=nMoved+1;
          ELSE
            SetGO goVacuum,0;
            TPWrite "No vacuum, left: label "\Num:=nLabel;
            nCaptures:=nCaptures+1;
          ENDIF
        ELSE
          TPWrite "Out of reach, left: label "\Num:=nLabel;
          nCaptures:=nCaptures+1;
        ENDIF
      CASE 1002,1003:
        ! Nothing found: look again, for the light may have been poor.
        nCaptures:=nCaptures+1;
        TPWrite "Nothing found, capture "\Num:=nCaptures;
      CASE 1019:
        nCaptures:=nCaptures+1;
        TPWrite "Vision took too long, capture "\Num:=nCaptures;
      DEFAULT:
        Refused "vision refuses, status ";
      ENDTEST
    ENDWHILE
    TPWrite "Moved: "\Num:=nMoved;
    EndSample "error handling";
  ENDPROC

  ! One capture; nStatus tells. A connection that breaks is opened again, and the
  ! capture repeated from its start: half of a dialogue is worth nothing.
  PROC Capture(INOUT num nPoints)
    nPoints:=0;
    MM_Start_Vis nJob,0,0,jHome;
    MM_Get_VisData nJob,nPoints,nStatus;
    IF nStatus>=3096 AND nStatus<=3099 RAISE MM_ERR_COMM;
  ERROR
    IF ERRNO=MM_ERR_COMM AND nReconnects<nMaxReconnects THEN
      nReconnects:=nReconnects+1;
      TPWrite "Connection lost, attempt "\Num:=nReconnects;
      WaitTime 1;
      MM_Open_Socket;
      RETRY;
    ELSEIF ERRNO=MM_ERR_STATUS THEN
      ! Refused: the caller decides by the status.
      nStatus:=MM_Last_Status;
      RETURN;
    ENDIF
    RAISE;
  ENDPROC

  ! Whether the arm reaches a pose and the place above it.
  FUNC bool Reachable(robtarget pTarget)
    VAR jointtarget jTarget;

    jTarget:=CalcJointT(pTarget,tGripper\WObj:=wobj0);
    jTarget:=CalcJointT(RelTool(pTarget,0,0,-nApproach),tGripper\WObj:=wobj0);
    RETURN TRUE;
  ERROR
    IF ERRNO=ERR_ROBLIMIT RETURN FALSE;
    RAISE;
  ENDFUNC
ENDMODULE
