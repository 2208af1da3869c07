//! Values that are written as one of a few words.

use std::marker::PhantomData;

use serde_json::{Value as Json, json};

use crate::document::Node;
use crate::reader::{Reader, Rule, nearest};
use crate::rules::text_of;

/// An enum that is written as one of a few words.
pub(crate) trait Choice: Sized + Copy + 'static {
    /// Word and value, in the order of the documentation.
    const WORDS: &'static [(&'static str, Self)];
}

/// One of the words of a [`Choice`].
pub(crate) struct OneOf<C>(PhantomData<C>);

/// One of the words of a [`Choice`].
pub(crate) const fn one_of<C>() -> OneOf<C> {
    OneOf(PhantomData)
}

impl<C: Choice> Rule for OneOf<C> {
    type Output = C;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<C> {
        let text = text_of(node, reader);
        let found = text
            .as_deref()
            .and_then(|text| C::WORDS.iter().find(|(word, _)| *word == text));
        if let Some((_, value)) = found {
            return Some(*value);
        }
        let words: Vec<&str> = C::WORDS.iter().map(|(word, _)| *word).collect();
        let message = format!(
            "expected one of {}, found {}",
            words.join(", "),
            node.described()
        );
        let hint = text
            .map(|text| nearest(&text, &words))
            .filter(|hint| hint.starts_with("did"));
        reader.problem(&node.place, key, message, hint);
        None
    }

    fn schema(&self) -> Json {
        let words: Vec<&str> = C::WORDS.iter().map(|(word, _)| *word).collect();
        json!({"type": "string", "enum": words})
    }
}

/// Declares an enum and its words.
macro_rules! choice {
    (
        $(#[doc = $doc:literal])*
        pub enum $Name:ident {
            $( $(#[doc = $variant_doc:literal])* $Variant:ident = $word:literal, )*
        }
    ) => {
        $(#[doc = $doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
        pub enum $Name {
            $( $(#[doc = $variant_doc])* #[serde(rename = $word)] $Variant, )*
        }

        impl $Name {
            /// The word in a scene file.
            pub fn word(self) -> &'static str {
                match self { $( Self::$Variant => $word, )* }
            }
        }

        impl $crate::choice::Choice for $Name {
            const WORDS: &'static [(&'static str, Self)] = &[$( ($word, Self::$Variant), )*];
        }
    };
}
pub(crate) use choice;
