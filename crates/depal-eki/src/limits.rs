/// What an XML document may be at most. Nothing is allocated beyond these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of one document, with what stands before its root.
    pub bytes: usize,
    /// Elements inside one another; the root is 1.
    pub depth: usize,
    /// Attributes of one tag.
    pub attributes: usize,
}

impl Default for Limits {
    /// 16 KiB, as the controller's default; 16 deep; 64 attributes.
    fn default() -> Self {
        Self {
            bytes: 16_384,
            depth: 16,
            attributes: 64,
        }
    }
}
