use crate::Span;

/// A name as spelled, with its place.
#[derive(Debug, Clone, Default)]
pub struct Name {
    /// As spelled.
    pub text: String,
    /// Where.
    pub span: Span,
}

impl Name {
    /// The name as it is compared: lower case.
    pub fn key(&self) -> String {
        self.text.to_lowercase()
    }
}

/// Trees are equal if they say the same, wherever it stands.
impl PartialEq for Name {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

/// A piece of a tree, a statement or an expression, with its place.
#[derive(Debug, Clone)]
pub struct Node<K> {
    /// What it says.
    pub kind: K,
    /// Where.
    pub span: Span,
}

/// Trees are equal if they say the same, wherever it stands.
impl<K: PartialEq> PartialEq for Node<K> {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
    }
}
