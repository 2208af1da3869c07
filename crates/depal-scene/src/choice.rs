//! Values that are written as one of a few words.

use std::marker::PhantomData;

use serde_json::{Value as Json, json};

use crate::document::{Node, Value};
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

/// Words of a [`Choice`], each at most once: a list, or one word alone. On the command line a list may
/// also be written without quotes, as in `shadow,bowl`, because shells take quotes away.
pub(crate) struct WordsOf<C>(PhantomData<C>);

/// Words of a [`Choice`], each at most once.
pub(crate) const fn words_of<C>() -> WordsOf<C> {
    WordsOf(PhantomData)
}

/// The bare words of an override; `None` for what was written as a value of its own.
fn bare_words(node: &Node, reader: &Reader<'_>) -> Option<Vec<Node>> {
    let Value::Text(text) = &node.value else {
        return None;
    };
    reader.sources[node.place.source].override_value.as_ref()?;
    let inside = text
        .trim()
        .strip_prefix('[')
        .and_then(|t| t.strip_suffix(']'));
    let words = inside.unwrap_or(text).split(',').map(str::trim);
    let each = words.filter(|word| !word.is_empty()).map(|word| Node {
        value: Value::Text(word.to_owned()),
        place: node.place.clone(),
    });
    Some(each.collect())
}

impl<C: Choice + PartialEq> Rule for WordsOf<C> {
    type Output = Vec<C>;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<Vec<C>> {
        let bare = bare_words(node, reader);
        let items = match &node.value {
            _ if bare.is_some() => bare.as_deref().unwrap_or_default(),
            Value::List(items) => items,
            Value::Text(text) if text.contains(',') => {
                let words: Vec<&str> = text.split(',').map(str::trim).collect();
                let message = format!("expected a list of words, found {}", node.described());
                let hint = Some(format!("write {words:?}"));
                reader.problem(&node.place, key, message, hint);
                return None;
            }
            _ => std::slice::from_ref(node),
        };
        let mut read = Vec::with_capacity(items.len());
        let mut whole = true;
        for item in items {
            match one_of::<C>().read(item, key, reader) {
                Some(value) if read.contains(&value) => {
                    let message =
                        format!("expected each word once, found {} again", item.described());
                    reader.problem(&item.place, key, message, None);
                    whole = false;
                }
                Some(value) => read.push(value),
                None => whole = false,
            }
        }
        whole.then_some(read)
    }

    fn schema(&self) -> Json {
        let one = one_of::<C>().schema();
        json!({"oneOf": [one.clone(), {"type": "array", "items": one, "uniqueItems": true}]})
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
