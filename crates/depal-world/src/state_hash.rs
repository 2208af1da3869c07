/// FNV-1a over 64-bit words: equal states give equal figures, on any run of the same build.
pub(crate) struct StateHash(u64);

impl StateHash {
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    pub fn value(&mut self, value: f64) {
        self.word(value.to_bits());
    }

    pub fn finish(self) -> u64 {
        self.0
    }
}
