mod plain;

use crate::{RAW_BYTES_LIMIT, RawBytes};

#[test]
fn raw_bytes_grow_with_zeros_up_to_their_limit() {
    let mut raw = RawBytes::default();
    assert!(raw.write(2, &[7]));
    assert_eq!(raw.as_slice(), [0, 0, 7]);
    assert!(raw.write(RAW_BYTES_LIMIT - 1, &[1]));
    assert!(!raw.write(RAW_BYTES_LIMIT - 1, &[1, 2]));
}
