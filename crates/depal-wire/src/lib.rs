//! Standard-interface messages: bytes to typed values and back.
