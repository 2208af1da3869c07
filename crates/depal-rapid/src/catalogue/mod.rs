//! One page for each message about a program: what it means, an example, how to mend it.
//!
//! The tests check that every code of this crate has a page, that each example gives its own code, and that the
//! mended example does not.

mod declarations;
mod statements;
mod syntax;

use std::fmt::Write;

/// What there is to know about one code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Page {
    /// `RAPID0104`.
    pub code: &'static str,
    /// What is wrong, in a few words.
    pub title: &'static str,
    /// Why it is wrong, and how the controller sees it.
    pub meaning: &'static str,
    /// A program, or statements of one, with the mistake. Empty where it would be too long to be of use.
    pub example: &'static str,
    /// The same, mended.
    pub mended: &'static str,
}

impl Page {
    /// The page as Markdown, with a heading.
    pub fn markdown(&self) -> String {
        let mut text = format!("## {}: {}\n\n{}\n", self.code, self.title, self.meaning);
        for (heading, example) in [("Wrong:", self.example), ("Mended:", self.mended)] {
            if !example.is_empty() {
                let _ = write!(text, "\n{heading}\n\n```rapid\n{example}\n```\n");
            }
        }
        text
    }
}

const fn page(
    code: &'static str,
    title: &'static str,
    meaning: &'static str,
    example: &'static str,
    mended: &'static str,
) -> Page {
    Page {
        code,
        title,
        meaning,
        example,
        mended,
    }
}

/// All pages, by code.
pub fn pages() -> Vec<Page> {
    let parts: [&[Page]; 3] = [&syntax::PAGES, &declarations::PAGES, &statements::PAGES];
    let mut pages = parts.concat();
    pages.sort_by_key(|page| page.code);
    pages
}

/// The page of a code, in any case, with or without `RAPID`: `104` will do.
pub fn explain(code: &str) -> Option<Page> {
    let digits = code.trim().to_ascii_uppercase();
    let digits = digits.strip_prefix("RAPID").unwrap_or(&digits);
    let number: u32 = digits.parse().ok()?;
    let wanted = format!("RAPID{number:04}");
    pages().into_iter().find(|page| page.code == wanted)
}

#[cfg(test)]
pub(crate) mod tests;
