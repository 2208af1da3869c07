use crate::s7::*;

/// Each register begins where the one before it ends, and the last one ends the block.
#[test]
fn offsets_follow_from_the_types() {
    let mut next = 0;
    for (place, line) in Field::TABLE.iter().enumerate() {
        assert_eq!(line.offset, next, "{}", line.name);
        assert_eq!(line.field as usize, place);
        let is_command = line.offset < COMMAND_BYTES;
        assert_eq!(line.side == Side::Plc, is_command, "{}", line.name);
        next += line.bytes();
    }
    assert_eq!(next, BLOCK_BYTES);
    assert_eq!(Field::Reserved.offset(), COMMAND_BYTES);
    assert_eq!(Field::TABLE.len(), 33);
}

/// The published offsets, typed in once more from the page as byte and name.
#[test]
fn offsets_are_the_published_ones() {
    let published = [
        (0, "Command Trigger"),
        (12, "Joint Position"),
        (60, "Branch Name"),
        (80, "External Input Pose"),
        (106, "Depalletize Tool Section Count"),
        (194, "Trigger Acknowledge"),
        (196, "Notify"),
        (198, "Heartbeat"),
        (200, "Status Code"),
        (202, "Status of Pose Sent"),
        (204, "Number of Pose Sent"),
        (206, "Index of Vision Picking Point"),
        (208, "Target Pose"),
        (1168, "Target Label"),
        (1248, "Target Tool ID"),
        (1328, "Digital Output"),
        (1456, "Custom Vision Output"),
        (3056, "Target IsVisualMove"),
        (3136, "Target Move Type"),
        (3216, "Speed Percentage"),
        (3296, "VisualMove Planning Result"),
    ];
    for (offset, name) in published {
        let field = Field::at(offset).expect("inside the block");
        assert_eq!((field.spec().name, field.offset()), (name, offset));
    }
    assert_eq!(Field::at(BLOCK_BYTES), None);
    assert_eq!(Field::at(BLOCK_BYTES - 1), Some(Field::PlanResult));
}

#[test]
fn values_are_big_endian() {
    let mut block = DataBlock::new();
    block.set_bool(Field::Trigger, true);
    block.set_int(Field::Command, 0, 205);
    block.set_int(Field::PoseType, 0, 1);
    assert_eq!(block.bytes(0, 8), Some(&[1, 0, 0, 0xcd, 0, 1, 0, 0][..]));
    block.set_int(Field::Status, 0, 1102);
    assert_eq!(block.bytes(200, 2), Some(&[0x04, 0x4e][..]));
    block.set_real(Field::Joints, 0, 549.56);
    assert_eq!(block.bytes(12, 4), Some(&[0x44, 0x09, 0x63, 0xd7][..]));
    block.set_real(Field::TargetPose, 1, 1.5);
    assert_eq!(block.bytes(212, 4), Some(&[0x3f, 0xc0, 0, 0][..]));
    block.set_int(Field::DigitalOutput, 63, -1);
    assert_eq!(block.bytes(1454, 2), Some(&[0xff, 0xff][..]));
    block.set_real(Field::PlanResult, 1599, -2.0);
    assert_eq!(block.bytes(9692, 4), Some(&[0xc0, 0, 0, 0][..]));
    assert_eq!(block.int(Field::DigitalOutput, 63), -1);
    assert_eq!(block.real(Field::PlanResult, 1599), -2.0);
    assert_eq!(block.reals::<2>(Field::TargetPose), [0.0, 1.5]);
    assert!(block.bool(Field::Trigger) && !block.bool(Field::Acknowledge));
}

#[test]
fn the_block_has_an_end() {
    let mut block = DataBlock::new();
    assert_eq!(block.bytes(9694, 2).map(<[u8]>::len), Some(2));
    assert_eq!(block.bytes(9695, 2), None);
    assert_eq!(block.bytes(usize::MAX, 2), None);
    assert!(!block.write(9695, &[1, 2]));
    assert!(!block.write(usize::MAX, &[1, 2]));
    assert_eq!(block, DataBlock::new());
    assert!(block.write(9695, &[7]));
    assert_eq!(block.as_bytes()[9695], 7);
}

#[test]
#[should_panic(expected = "Target Label holds 40 elements")]
fn an_element_past_the_end_is_our_bug() {
    DataBlock::new().set_int(Field::TargetLabel, 40, 1);
}
