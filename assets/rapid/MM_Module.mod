MODULE MM_Module
  !===========================================================================
  ! Robot side of the vision standard interface, profile 1.8, for ABB RAPID.
  !
  ! Part of depal. Licence: MIT OR Apache-2.0.
  ! Written from the public description of the commands; contains no vendor code.
  ! Not affiliated with ABB or with Mech-Mind Robotics.
  !
  ! Wire: TCP client, HEX frames, little-endian cells of four bytes.
  !   request  64 bytes, reply 660 bytes, both padded with zeros.
  !   counters, codes, labels, DO numbers: 32-bit integers.
  !   poses (mm, degrees), joints (degrees), sizes, plan numbers: 32-bit floats.
  !   Orientation on the wire: Rz, Ry, Rx as OrientZYX and EulerZYX use them.
  !
  ! Errors:
  !   A procedure with the output MM_Status never raises for the connection or
  !   for a refusal: MM_Status tells. The server's codes are passed through.
  !   Codes of the robot side:
  !     3099  the socket is not open, or could not be opened
  !     3098  no complete reply within the timeout of MM_Init_Socket
  !     3097  the server closed the connection
  !     3096  the reply answers another command, or its status is no status code
  !           (wrong port, wrong byte order)
  !   A procedure without MM_Status raises instead:
  !     MM_ERR_COMM    connection trouble, one of the four codes above
  !     MM_ERR_STATUS  the server refused, the code is in MM_Last_Status
  !     MM_ERR_INDEX   no data stored under the index that was asked for
  !   After 3096, 3097 and 3098 the socket is closed: a late reply must not be
  !   taken for the next one. Call MM_Open_Socket again.
  !
  ! Poses carry no arm configuration on the wire: robconf is that of the robot
  ! when the data came in, external axes are 9E9 (not in use).
  !===========================================================================

  CONST errnum MM_ERR_COMM:=71;
  CONST errnum MM_ERR_STATUS:=72;
  CONST errnum MM_ERR_INDEX:=73;

  ! Custom data and plan data of the waypoint stored last by
  ! MM_Get_PlanPose, MM_Get_PlanJps or MM_Get_DyPose.
  VAR num MM_UserData{50};
  VAR num MM_Plan_Results{21};
  ! Status code of the command executed last.
  VAR num MM_Last_Status:=0;

  ! Whether each command opens and closes the connection itself.
  LOCAL CONST bool MM_EACH_COMMAND:=FALSE;

  LOCAL CONST num MM_REQUEST_LEN:=64;
  LOCAL CONST num MM_REPLY_LEN:=660;
  LOCAL CONST num MM_MAX_POINTS:=100;

  LOCAL CONST num MM_NOT_OPEN:=3099;
  LOCAL CONST num MM_NO_REPLY:=3098;
  LOCAL CONST num MM_CLOSED:=3097;
  LOCAL CONST num MM_WRONG_REPLY:=3096;

  LOCAL VAR socketdev MM_Socket;
  LOCAL VAR bool MM_Connected:=FALSE;
  LOCAL VAR string MM_Address:="127.0.0.1";
  LOCAL VAR num MM_Port:=50000;
  LOCAL VAR num MM_Timeout:=60;

  LOCAL VAR rawbytes MM_Request;
  LOCAL VAR rawbytes MM_Reply;
  ! One empty request, to fill others up.
  LOCAL VAR rawbytes MM_Padding;

  ! The list received last. All parts of a reply in several parts are joined.
  LOCAL VAR num MM_Count:=0;
  LOCAL VAR num MM_Values{100,6};
  LOCAL VAR num MM_Labels{100};
  LOCAL VAR num MM_Speeds{100};
  LOCAL VAR num MM_IsVisMove{100};
  LOCAL VAR num MM_MoveTypes{100};
  LOCAL VAR num MM_ToolNums{100};
  LOCAL VAR num MM_PlanData{100,21};
  LOCAL VAR num MM_CustomCount{100};
  LOCAL VAR num MM_Custom{100,50};
  LOCAL VAR robtarget MM_Here;
  LOCAL VAR num MM_DoList{64};

  !------------------------------------------------------------ connection --

  ! Sets where the vision system listens and how long to wait for it, seconds.
  PROC MM_Init_Socket(string IP_Address,num Server_Port,num Time_Out)
    MM_Address:=IP_Address;
    MM_Port:=Server_Port;
    MM_Timeout:=Time_Out;
  ENDPROC

  ! Connects. Raises MM_ERR_COMM and leaves 3099 in MM_Last_Status if that fails.
  PROC MM_Open_Socket()
    OpenLink;
    IF NOT MM_Connected RAISE MM_ERR_COMM;
  ENDPROC

  ! Closes the connection; harmless if there is none.
  PROC MM_Close_Socket()
    CloseLink;
  ENDPROC

  !--------------------------------------------------- vision project: 10x ---

  ! 101: starts a vision project. SendPos_Type 0 no pose, 1 joints and flange
  ! pose of the robot, 2 flange pose, 3 the joints of MM_J.
  PROC MM_Start_Vis(num Job,num Pos_Num_Need,num SendPos_Type,jointtarget MM_J)
    VAR num status;

    BeginRequest 101;
    AddInt Job;
    AddInt Pos_Num_Need;
    AddInt SendPos_Type;
    TEST SendPos_Type
    CASE 1:
      AddJoints CJointT();
      AddFlange;
    CASE 2:
      AddFlange;
    CASE 3:
      AddJoints MM_J;
    DEFAULT:
      AddZeros 6;
    ENDTEST
    Transact 101,status;
    Demand status,1102;
  ENDPROC

  ! 102: the vision points of a project, all parts.
  PROC MM_Get_VisData(num Job,INOUT num Pos_Num,INOUT num MM_Status)
    VAR num vision_move;

    FetchList 102,Job,0,1100,Pos_Num,vision_move,MM_Status;
  ENDPROC

  ! 103: switches the parameter recipe.
  PROC MM_Switch_Model(num Job,num Model_Number)
    VAR num status;

    BeginRequest 103;
    AddInt Job;
    AddInt Model_Number;
    Transact 103,status;
    Demand status,1107;
  ENDPROC

  ! 105: the path planned by a vision project. Jps_Pos 1 joints, 2 TCP.
  PROC MM_Get_VisPath(num Job,num Jps_Pos,INOUT num Pos_Num,INOUT num VisPos_Num,INOUT num MM_Status)
    FetchList 105,Job,Jps_Pos,1103,Pos_Num,VisPos_Num,MM_Status;
  ENDPROC

  ! 100: runs a vision project and stores its result, all in one exchange; at most
  ! one reply's worth of points. Recipe 0 keeps the recipe. Jps_Pos 1 vision points,
  ! 2 one point with custom data, 3 path of joints, 4 path of TCPs.
  ! MM_J: joints to report instead of those of the robot.
  PROC MM_Lite_Vis(num Job,num Recipe,num Jps_Pos,INOUT num MM_Status\jointtarget MM_J\INOUT num Pos_Num\INOUT num VisPos_Num)
    VAR num vision_move:=0;

    ForgetList;
    BeginRequest 100;
    AddInt Job;
    AddInt Recipe;
    AddInt Jps_Pos;
    IF Present(MM_J) THEN
      AddJoints MM_J;
    ELSE
      AddJoints CJointT();
    ENDIF
    AddFlange;
    Transact 100,MM_Status;
    IF MM_Status=1100 OR MM_Status=1103 THEN
      IF Jps_Pos=2 THEN
        KeepCustomPoint;
      ELSE
        vision_move:=CellInt(5);
        KeepPart;
      ENDIF
    ENDIF
    IF Present(Pos_Num) Pos_Num:=MM_Count;
    IF Present(VisPos_Num) VisPos_Num:=vision_move;
  ENDPROC

  ! 110: vision points with the data of the custom ports, one point a reply.
  PROC MM_Get_DyData(num Job,INOUT num Pos_Num,INOUT num MM_Status)
    VAR num last;

    ForgetList;
    Pos_Num:=0;
    last:=0;
    WHILE last=0 AND MM_Count<MM_MAX_POINTS DO
      BeginRequest 110;
      AddInt Job;
      Transact 110,MM_Status;
      IF MM_Status<>1100 THEN
        ForgetList;
        Pos_Num:=0;
        RETURN;
      ENDIF
      last:=CellInt(3);
      KeepCustomPoint;
    ENDWHILE
    Pos_Num:=MM_Count;
  ENDPROC

  ! 501: box size for a vision project, mm.
  PROC MM_Set_BoxSize(num Job,num Length,num Width,num Height)
    VAR num status;

    BeginRequest 501;
    AddInt Job;
    AddReal Length;
    AddReal Width;
    AddReal Height;
    Transact 501,status;
    Demand status,1108;
  ENDPROC

  !----------------------------------------------------- Viz project: 20x ----

  ! 201: starts the Viz project. SendPos_Type 0 no pose, 1 joints and flange
  ! pose of the robot, 2 the joints of MM_J as start of the planned path.
  PROC MM_Start_Viz(num SendPos_Type,jointtarget MM_J)
    VAR num status;

    BeginRequest 201;
    AddInt SendPos_Type;
    TEST SendPos_Type
    CASE 1:
      AddJoints CJointT();
      AddFlange;
    CASE 2:
      AddJoints MM_J;
    DEFAULT:
      AddZeros 6;
    ENDTEST
    Transact 201,status;
    Demand status,2103;
  ENDPROC

  ! 202: stops the Viz project; 2104 also when none runs.
  PROC MM_Stop_Viz(INOUT num MM_Status)
    BeginRequest 202;
    Transact 202,MM_Status;
  ENDPROC

  ! 203: chooses the exit of a Branch by Msg step; N takes exit N-1.
  PROC MM_Set_Branch(num Branch_Num,num Export_Num)
    VAR num status;

    BeginRequest 203;
    AddInt Branch_Num;
    AddInt Export_Num;
    Transact 203,status;
    Demand status,2105;
  ENDPROC

  ! 204: sets the current index of an index-type step; N sets N-1.
  PROC MM_Set_Index(num Skill_Num,num Index_Num)
    VAR num status;

    BeginRequest 204;
    AddInt Skill_Num;
    AddInt Index_Num;
    Transact 204,status;
    Demand status,2106;
  ENDPROC

  ! 205: the path of the Viz project. Jps_Pos 1 joints, 2 TCP.
  PROC MM_Get_VizData(num Jps_Pos,INOUT num Pos_Num,INOUT num VisPos_Num,INOUT num MM_Status)
    FetchList 205,Jps_Pos,0,2100,Pos_Num,VisPos_Num,MM_Status;
  ENDPROC

  ! 200: starts the Viz project, chooses a branch (Branch_Num 0: none) and stores the
  ! path, all in one exchange; at most one reply's worth of waypoints.
  PROC MM_Lite_Viz(num Branch_Num,num Export_Num,num Jps_Pos,INOUT num MM_Status\INOUT num Pos_Num\INOUT num VisPos_Num)
    VAR num vision_move:=0;

    ForgetList;
    BeginRequest 200;
    AddInt Branch_Num;
    AddInt Export_Num;
    AddInt Jps_Pos;
    AddJoints CJointT();
    AddFlange;
    Transact 200,MM_Status;
    IF MM_Status=2100 THEN
      vision_move:=CellInt(5);
      KeepPart;
    ENDIF
    IF Present(Pos_Num) Pos_Num:=MM_Count;
    IF Present(VisPos_Num) VisPos_Num:=vision_move;
  ENDPROC

  ! 207: reads the step parameter behind a configuration id.
  PROC MM_Get_Property(num Get_Id,INOUT num MM_Status,INOUT num MM_Viz_Prop)
    MM_Viz_Prop:=0;
    BeginRequest 207;
    AddInt Get_Id;
    Transact 207,MM_Status;
    IF MM_Status=2109 MM_Viz_Prop:=CellReal(3);
  ENDPROC

  ! 208: writes the step parameters behind a configuration id.
  PROC MM_Set_Property(num Set_Id,INOUT num MM_Status)
    BeginRequest 208;
    AddInt Set_Id;
    Transact 208,MM_Status;
  ENDPROC

  ! 210 (Resource 0) or 111 (Resource = vision project): the path with motion
  ! types, tools, velocities and plan data, one waypoint a reply.
  PROC MM_get_plandata(num Resource,num Jps_Pos,INOUT num Pos_Num,INOUT num VisPos_Num,INOUT num MM_Status)
    VAR num last;
    VAR num custom_cell;

    ForgetList;
    Pos_Num:=0;
    VisPos_Num:=0;
    last:=0;
    WHILE last=0 AND MM_Count<MM_MAX_POINTS DO
      IF Resource=0 THEN
        BeginRequest 210;
        AddInt Jps_Pos;
        Transact 210,MM_Status;
      ELSE
        BeginRequest 111;
        AddInt Resource;
        AddInt Jps_Pos;
        Transact 111,MM_Status;
      ENDIF
      IF (Resource=0 AND MM_Status<>2100) OR (Resource<>0 AND MM_Status<>1103) THEN
        ForgetList;
        Pos_Num:=0;
        VisPos_Num:=0;
        RETURN;
      ENDIF
      last:=CellInt(3);
      MM_Count:=MM_Count+1;
      MM_IsVisMove{MM_Count}:=CellInt(4);
      FOR i FROM 1 TO 6 DO
        MM_Values{MM_Count,i}:=CellReal(4+i);
      ENDFOR
      MM_MoveTypes{MM_Count}:=CellInt(11);
      MM_ToolNums{MM_Count}:=CellInt(12);
      MM_Speeds{MM_Count}:=CellInt(13);
      MM_CustomCount{MM_Count}:=0;
      IF MM_IsVisMove{MM_Count}=1 THEN
        IF VisPos_Num=0 VisPos_Num:=MM_Count;
        custom_cell:=14;
        FOR i FROM 1 TO 21 DO
          MM_PlanData{MM_Count,i}:=0;
        ENDFOR
        IF Resource<>0 OR Jps_Pos>=3 THEN
          FOR i FROM 1 TO 21 DO
            MM_PlanData{MM_Count,i}:=CellReal(13+i);
          ENDFOR
          custom_cell:=35;
        ENDIF
        KeepCustom custom_cell+1,CellInt(custom_cell);
      ENDIF
    ENDWHILE
    Pos_Num:=MM_Count;
  ENDPROC

  !------------------------------------------- stored lists, index from 1 ----

  ! Stores TCP, label and velocity of a point.
  PROC MM_Get_Pose(num Serial,INOUT robtarget MM_P,INOUT num MM_Label,INOUT num MM_Speed)
    CheckIndex Serial;
    StorePose Serial,MM_P;
    MM_Label:=MM_Labels{Serial};
    MM_Speed:=MM_Speeds{Serial};
  ENDPROC

  ! Stores joints, label and velocity of a waypoint.
  PROC MM_Get_Jps(num Serial,INOUT jointtarget MM_J,INOUT num MM_Label,INOUT num MM_Speed)
    CheckIndex Serial;
    StoreJoints Serial,MM_J;
    MM_Label:=MM_Labels{Serial};
    MM_Speed:=MM_Speeds{Serial};
  ENDPROC

  ! Stores TCP and label of a point, its custom data in MM_UserData.
  PROC MM_Get_DyPose(num Serial,INOUT robtarget MM_P,INOUT num MM_Label)
    CheckIndex Serial;
    StorePose Serial,MM_P;
    MM_Label:=MM_Labels{Serial};
    StoreUserData Serial;
  ENDPROC

  ! Stores a waypoint of MM_get_plandata with Jps_Pos 2 or 4.
  PROC MM_Get_PlanPose(num Serial,num Jps_Pos,INOUT robtarget MM_P,INOUT num MM_MoveType,INOUT num MM_ToolNum,INOUT num MM_Speed)
    CheckIndex Serial;
    StorePose Serial,MM_P;
    MM_MoveType:=MM_MoveTypes{Serial};
    MM_ToolNum:=MM_ToolNums{Serial};
    MM_Speed:=MM_Speeds{Serial};
    StorePlan Serial;
  ENDPROC

  ! Stores a waypoint of MM_get_plandata with Jps_Pos 1 or 3.
  PROC MM_Get_PlanJps(num Serial,num Jps_Pos,INOUT jointtarget MM_J,INOUT num MM_MoveType,INOUT num MM_ToolNum,INOUT num MM_Speed)
    CheckIndex Serial;
    StoreJoints Serial,MM_J;
    MM_MoveType:=MM_MoveTypes{Serial};
    MM_ToolNum:=MM_ToolNums{Serial};
    MM_Speed:=MM_Speeds{Serial};
    StorePlan Serial;
  ENDPROC

  !-------------------------------------------------- gripper and status -----

  ! 206 (Resource 0) or 106 (Resource = vision project): the gripper's DO list.
  PROC MM_Get_DoList(num Resource)
    VAR num status;

    FetchDoList Resource,0,status;
    IF Resource=0 Demand status,2102;
    IF Resource<>0 Demand status,1106;
  ENDPROC

  ! Switches on the listed DOs of one group of 16; others keep their value.
  ! DO number d is bit d MOD 16 (lowest first) of group d DIV 16 + 1.
  PROC MM_Set_DoList(num Serial,VAR signalgo Go16)
    SwitchOn 1,64,Serial,Go16;
  ENDPROC

  ! 601: the message of a notify step; 0 if none came within the server's time.
  PROC MM_Get_Notify(INOUT num MM_Message)
    VAR num value;

    MM_Message:=0;
    BeginRequest 601;
    Transact 601,value\NoStatus;
    Demand MM_Last_Status,0;
    MM_Message:=value;
  ENDPROC

  ! 901: 1101 when the vision project is ready.
  PROC MM_Get_Status(INOUT num MM_Status)
    BeginRequest 901;
    Transact 901,MM_Status;
  ENDPROC

  !---------------------------------------------------------- calibration ----

  ! 701: drives the robot through the poses of a hand-eye calibration.
  ! Move_Type 1 linear, 2 joint motion. Pos_Jps 1 flange poses, 2 joints.
  ! Wait_Time: seconds of rest before each capture. Ext: position of external axis a.
  ! Connects for itself if nothing is open, and then closes again.
  ! Returns when the robot is back where it began; a pose that it cannot reach is
  ! reported to the server, and ends the calibration with MM_ERR_STATUS.
  PROC MM_Calib(num Move_Type,num Pos_Jps,num Wait_Time\num Ext)
    VAR num status;
    VAR num state:=0;
    VAR num done:=0;
    VAR robtarget pose;
    VAR jointtarget joints;
    VAR bool reachable;
    VAR bool connects;

    connects:=NOT (MM_Connected OR MM_EACH_COMMAND);
    IF connects THEN
      OpenLink;
      IF NOT MM_Connected RAISE MM_ERR_COMM;
    ENDIF
    WHILE done=0 DO
      BeginRequest 701;
      AddInt state;
      AddFlange;
      AddJoints CJointT();
      Transact 701,status;
      Demand status,7101;
      done:=CellInt(3);
      ForgetList;
      MM_Count:=1;
      FOR i FROM 1 TO 6 DO
        MM_Values{1,i}:=CellReal(3+i);
      ENDFOR
      StorePose 1,pose;
      FOR i FROM 1 TO 6 DO
        MM_Values{1,i}:=CellReal(9+i);
      ENDFOR
      StoreJoints 1,joints;
      ForgetList;
      IF Present(Ext) THEN
        pose.extax.eax_a:=Ext;
        joints.extax.eax_a:=Ext;
      ENDIF
      reachable:=TRUE;
      IF Pos_Jps=1 CheckReach pose,reachable;
      state:=2;
      IF reachable THEN
        state:=1;
        IF Pos_Jps=2 AND Move_Type=2 THEN
          MoveAbsJ joints,v200,fine,tool0\WObj:=wobj0;
        ELSEIF Move_Type=2 THEN
          MoveJ pose,v200,fine,tool0\WObj:=wobj0;
        ELSE
          MoveL pose,v200,fine,tool0\WObj:=wobj0;
        ENDIF
        WaitTime Wait_Time;
      ELSE
        ! The answer to state 2 is a refusal and ends the loop.
        done:=0;
      ENDIF
    ENDWHILE
    IF connects CloseLink;
  ENDPROC

  LOCAL PROC CheckReach(robtarget pose,INOUT bool reachable)
    VAR jointtarget joints;

    reachable:=TRUE;
    joints:=CalcJointT(pose,tool0\WObj:=wobj0);
  ERROR
    IF ERRNO=ERR_ROBLIMIT THEN
      reachable:=FALSE;
      RETURN;
    ENDIF
    RAISE;
  ENDPROC

  !------------------------------------------------------------ internals ----

  LOCAL PROC BeginRequest(num command)
    ClearRawBytes MM_Request;
    AddInt command;
  ENDPROC

  LOCAL PROC AddInt(num value)
    PackRawBytes value,MM_Request,RawBytesLen(MM_Request)+1\IntX:=DINT;
  ENDPROC

  LOCAL PROC AddReal(num value)
    PackRawBytes value,MM_Request,RawBytesLen(MM_Request)+1\Float4;
  ENDPROC

  LOCAL PROC AddZeros(num cells)
    FOR i FROM 1 TO cells DO
      AddReal 0;
    ENDFOR
  ENDPROC

  LOCAL PROC AddJoints(jointtarget joints)
    AddReal joints.robax.rax_1;
    AddReal joints.robax.rax_2;
    AddReal joints.robax.rax_3;
    AddReal joints.robax.rax_4;
    AddReal joints.robax.rax_5;
    AddReal joints.robax.rax_6;
  ENDPROC

  LOCAL PROC AddFlange()
    VAR robtarget flange;

    flange:=CRobT(\Tool:=tool0\WObj:=wobj0);
    AddReal flange.trans.x;
    AddReal flange.trans.y;
    AddReal flange.trans.z;
    AddReal EulerZYX(\Z,flange.rot);
    AddReal EulerZYX(\Y,flange.rot);
    AddReal EulerZYX(\X,flange.rot);
  ENDPROC

  ! Connects; MM_Connected tells, MM_Last_Status is 0 or 3099.
  LOCAL PROC OpenLink()
    VAR bool failed:=FALSE;

    IF MM_Connected CloseLink;
    TryConnect failed;
    IF failed THEN
      MM_Last_Status:=MM_NOT_OPEN;
      TPWrite "MM: no connection to "+MM_Address+" port "\Num:=MM_Port;
      RETURN;
    ENDIF
    ClearRawBytes MM_Padding;
    FOR i FROM 1 TO MM_REQUEST_LEN DIV 4 DO
      PackRawBytes 0,MM_Padding,RawBytesLen(MM_Padding)+1\IntX:=DINT;
    ENDFOR
    MM_Connected:=TRUE;
    MM_Last_Status:=0;
  ENDPROC

  LOCAL PROC TryConnect(INOUT bool failed)
    failed:=FALSE;
    SocketCreate MM_Socket;
    SocketConnect MM_Socket,MM_Address,MM_Port\Time:=MM_Timeout;
  ERROR
    IF ERRNO=ERR_SOCK_TIMEOUT OR ERRNO=ERR_SOCK_CLOSED THEN
      failed:=TRUE;
      SocketClose MM_Socket;
      RETURN;
    ENDIF
    RAISE;
  ENDPROC

  LOCAL PROC CloseLink()
    MM_Connected:=FALSE;
    SocketClose MM_Socket;
  ENDPROC

  ! Sends the request and gathers its reply, on a connection of its own where each command has one.
  ! NoStatus: the second cell is a value, and MM_Last_Status is 0 if it came.
  LOCAL PROC Transact(num command,INOUT num status\switch NoStatus)
    status:=MM_NOT_OPEN;
    MM_Last_Status:=status;
    IF MM_EACH_COMMAND OpenLink;
    IF NOT MM_Connected RETURN;
    Exchange command,status\NoStatus?NoStatus;
    IF MM_EACH_COMMAND CloseLink;
  ENDPROC

  ! One request and one whole reply: TCP may deliver it in pieces.
  LOCAL PROC Exchange(num command,INOUT num status\switch NoStatus)
    VAR rawbytes piece;
    VAR num got:=0;
    VAR num arrived:=0;

    got:=RawBytesLen(MM_Request);
    IF got<MM_REQUEST_LEN CopyRawBytes MM_Padding,1,MM_Request,got+1\NoOfBytes:=MM_REQUEST_LEN-got;
    got:=0;
    ClearRawBytes MM_Reply;
    SocketSend MM_Socket\RawData:=MM_Request;
    WHILE got<MM_REPLY_LEN DO
      SocketReceive MM_Socket\RawData:=piece\ReadNoOfBytes:=MM_REPLY_LEN-got\NoRecBytes:=arrived\Time:=MM_Timeout;
      CopyRawBytes piece,1,MM_Reply,got+1\NoOfBytes:=arrived;
      got:=got+arrived;
    ENDWHILE
    status:=CellInt(2);
    ! A server of the other byte order echoes the command as it was sent: look at the status, too.
    IF CellInt(1)<>command OR ((NOT Present(NoStatus)) AND (status<1 OR status>9999)) THEN
      status:=MM_WRONG_REPLY;
      CloseLink;
    ELSEIF Present(NoStatus) THEN
      MM_Last_Status:=0;
      RETURN;
    ENDIF
    MM_Last_Status:=status;
  ERROR
    IF ERRNO=ERR_SOCK_TIMEOUT THEN
      status:=MM_NO_REPLY;
    ELSEIF ERRNO=ERR_SOCK_CLOSED THEN
      status:=MM_CLOSED;
    ELSE
      RAISE;
    ENDIF
    CloseLink;
    MM_Last_Status:=status;
    RETURN;
  ENDPROC

  ! 206 or 106; sections 0 asks for the list as it is. All slots are -1 if it does not come.
  LOCAL PROC FetchDoList(num resource,num sections,INOUT num status)
    FOR i FROM 1 TO 64 DO
      MM_DoList{i}:=-1;
    ENDFOR
    IF resource=0 THEN
      BeginRequest 206;
      IF sections>0 AddInt sections;
      Transact 206,status;
      IF status<>2102 RETURN;
    ELSE
      BeginRequest 106;
      AddInt resource;
      IF sections>0 AddInt sections;
      Transact 106,status;
      IF status<>1106 RETURN;
    ENDIF
    FOR i FROM 1 TO 64 DO
      MM_DoList{i}:=CellInt(2+i);
    ENDFOR
  ENDPROC

  ! Switches on the DOs of some slots of the list that lie in one group of 16.
  LOCAL PROC SwitchOn(num first,num last,num serial,VAR signalgo go16)
    VAR num value;
    VAR num power;
    VAR num number;

    value:=GOutput(go16);
    FOR i FROM first TO last DO
      number:=MM_DoList{i};
      IF number>=0 THEN
        IF number DIV 16+1=serial THEN
          power:=1;
          WHILE number MOD 16>0 DO
            power:=power*2;
            number:=number-1;
          ENDWHILE
          IF (value DIV power) MOD 2=0 value:=value+power;
        ENDIF
      ENDIF
    ENDFOR
    SetGO go16,value;
  ENDPROC

  ! For procedures without a status output: anything but success is raised.
  LOCAL PROC Demand(num status,num success)
    IF status=success RETURN;
    TPWrite "MM: command refused, status "\Num:=status;
    IF status>=MM_WRONG_REPLY AND status<=MM_NOT_OPEN RAISE MM_ERR_COMM;
    RAISE MM_ERR_STATUS;
  ENDPROC

  LOCAL FUNC num CellInt(num index)
    VAR num value;

    UnpackRawBytes MM_Reply,4*index-3,value\IntX:=DINT;
    RETURN value;
  ENDFUNC

  LOCAL FUNC num CellReal(num index)
    VAR num value;

    UnpackRawBytes MM_Reply,4*index-3,value\Float4;
    RETURN value;
  ENDFUNC

  LOCAL PROC ForgetList()
    MM_Count:=0;
    MM_Here:=CRobT(\Tool:=tool0\WObj:=wobj0);
  ENDPROC

  ! Lists of eight cells a point: 102, 105, 205. Asks again until all parts came.
  LOCAL PROC FetchList(num command,num first,num second,num success,INOUT num points,INOUT num vision_move,INOUT num status)
    VAR num last:=0;

    ForgetList;
    points:=0;
    vision_move:=0;
    WHILE last=0 AND MM_Count<MM_MAX_POINTS DO
      BeginRequest command;
      AddInt first;
      AddInt second;
      Transact command,status;
      IF status<>success THEN
        ForgetList;
        points:=0;
        vision_move:=0;
        RETURN;
      ENDIF
      last:=CellInt(3);
      ! The place counts from the first point of this part.
      IF vision_move=0 AND CellInt(5)>0 vision_move:=MM_Count+CellInt(5);
      IF CellInt(4)<1 last:=1;
      KeepPart;
    ENDWHILE
    points:=MM_Count;
  ENDPROC

  ! Adds the points of one reply to the list.
  LOCAL PROC KeepPart()
    VAR num part;
    VAR num cell:=6;

    part:=CellInt(4);
    WHILE part>0 AND MM_Count<MM_MAX_POINTS DO
      MM_Count:=MM_Count+1;
      FOR i FROM 1 TO 6 DO
        MM_Values{MM_Count,i}:=CellReal(cell+i-1);
      ENDFOR
      MM_Labels{MM_Count}:=CellInt(cell+6);
      MM_Speeds{MM_Count}:=CellInt(cell+7);
      cell:=cell+8;
      part:=part-1;
    ENDWHILE
  ENDPROC

  ! Adds the one point with custom data of a reply to the list.
  LOCAL PROC KeepCustomPoint()
    MM_Count:=MM_Count+1;
    FOR i FROM 1 TO 6 DO
      MM_Values{MM_Count,i}:=CellReal(4+i);
    ENDFOR
    MM_Labels{MM_Count}:=CellInt(11);
    KeepCustom 12,CellInt(4);
  ENDPROC

  ! Custom data of the point received last; at most 50 elements fit.
  LOCAL PROC KeepCustom(num first_cell,num elements)
    IF elements>50 elements:=50;
    MM_CustomCount{MM_Count}:=elements;
    IF elements<1 RETURN;
    FOR i FROM 1 TO elements DO
      MM_Custom{MM_Count,i}:=CellReal(first_cell+i-1);
    ENDFOR
  ENDPROC

  LOCAL PROC CheckIndex(num index)
    IF index<1 OR index>MM_Count THEN
      TPWrite "MM: nothing stored under index "\Num:=index;
      RAISE MM_ERR_INDEX;
    ENDIF
  ENDPROC

  LOCAL PROC StorePose(num index,INOUT robtarget target)
    target.trans.x:=MM_Values{index,1};
    target.trans.y:=MM_Values{index,2};
    target.trans.z:=MM_Values{index,3};
    target.rot:=OrientZYX(MM_Values{index,4},MM_Values{index,5},MM_Values{index,6});
    target.robconf:=MM_Here.robconf;
    target.extax:=[9E9,9E9,9E9,9E9,9E9,9E9];
  ENDPROC

  LOCAL PROC StoreJoints(num index,INOUT jointtarget target)
    target.robax.rax_1:=MM_Values{index,1};
    target.robax.rax_2:=MM_Values{index,2};
    target.robax.rax_3:=MM_Values{index,3};
    target.robax.rax_4:=MM_Values{index,4};
    target.robax.rax_5:=MM_Values{index,5};
    target.robax.rax_6:=MM_Values{index,6};
    target.extax:=[9E9,9E9,9E9,9E9,9E9,9E9];
  ENDPROC

  ! Only a Vision Move waypoint carries plan and custom data; others leave them.
  LOCAL PROC StorePlan(num index)
    IF MM_IsVisMove{index}<>1 RETURN;
    FOR i FROM 1 TO 21 DO
      MM_Plan_Results{i}:=MM_PlanData{index,i};
    ENDFOR
    StoreUserData index;
  ENDPROC

  LOCAL PROC StoreUserData(num index)
    FOR i FROM 1 TO 50 DO
      IF i<=MM_CustomCount{index} THEN
        MM_UserData{i}:=MM_Custom{index,i};
      ELSE
        MM_UserData{i}:=0;
      ENDIF
    ENDFOR
  ENDPROC
ENDMODULE
