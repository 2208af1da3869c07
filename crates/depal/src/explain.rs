//! `depal explain`: the page of a message's code.

use crate::failure::Failure;

/// Prints the page of a code, or all codes with their titles.
pub fn explain(code: Option<&str>) -> Result<(), Failure> {
    let Some(code) = code else {
        for page in depal_rapid::pages() {
            say!("{}  {}", page.code, page.title);
        }
        return Ok(());
    };
    match depal_rapid::explain(code) {
        Some(page) => {
            say!("{}", page.markdown().trim_end());
            Ok(())
        }
        None => Err(Failure::Input(format!(
            "there is no message with the code {code:?}; `depal explain` lists all codes"
        ))),
    }
}
