//! A recording is whole or it is not there.
